"""Every component of the types of a state is stored in checkpoints, or listed here with the reason.

The component lists of the Fortran types are compared with the components that the procedures for
archives (`visit`) name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

FORTRAN = Path(__file__).resolve().parent.parent / "fortran"

# type: procedures that store it, as "module:procedure"
STORED = {
    "two_levels_t": (
        "twolevel_restart:visit",
        "twolevel_restart:visit_problem",
        "twolevel_restart:visit_control",
    ),
    "simulation_t": ("report_restart:visit_simulation",),
    "front_state_t": ("growth_archive:visit_front",),
    "front_t": ("report_restart:visit_simulation",),
    "summary_t": ("report_restart:visit_summary", "report_restart:visit_warnings"),
    "dof_block_t": ("report_restart:visit_summary",),
    "watch_t": ("report_watch:visit",),
    "slip_catalogue_t": ("report_slip_archive:visit",),
    "live_t": ("report_slip_archive:visit",),
    "shear_t": ("report_slip_archive:visit_shear",),
    "levels_state_t": ("twolevel_archive:visit_levels", "twolevel_restart:visit"),
    "heat_state_t": ("heat_state:visit",),
    "blurred_t": ("twolevel_heat_errors:visit",),
    "state_t": ("coarse_archive:visit_state",),
    "guess_t": ("coarse_archive:visit_state",),
    "step_report_t": ("coarse_archive:visit_report",),
    "network_t": ("mesh_archive:visit_network",),
    "fracture_mesh_t": ("mesh_archive:visit_fracture_mesh",),
    "lists_t": ("mesh_archive:visit_lists",),
    "interaction_t": ("growth_archive:visit_interaction",),
    "tip_groups_t": ("growth_archive:visit_groups",),
    "windows_state_t": ("twolevel_archive:visit_windows_state",),
    "window_history_t": ("twolevel_archive:visit_windows_state",),
    "contact_t": ("fine_archive:visit_contact",),
    "fine_mesh_t": ("fine_archive:visit_fine_mesh",),
    "fine_loads_t": ("fine_archive:visit_loads",),
    "face_conditions_t": ("fine_archive:visit_conditions",),
    "trend_t": ("twolevel_archive:visit_trend",),
    "stated_errors_t": ("twolevel_errors:visit",),
    "coarse_problem_t": ("twolevel_restart:visit", "twolevel_restart:visit_problem"),
    "coarse_values_t": ("twolevel_archive:visit_values",),
    "fracture_cells_t": ("coarse_archive:visit_cells",),
    "windows_t": ("twolevel_restart:visit_windows",),
    "window_t": (
        "twolevel_window_archive:visit",
        "twolevel_window_archive:visit_made",
        "twolevel_window_archive:visit_model",
    ),
    "made_for_t": ("twolevel_window_archive:visit_made",),
    "served_t": ("twolevel_window_archive:visit_served",),
    "last_step_t": ("twolevel_restart:visit_control",),
    "stepper_t": ("twolevel_archive:visit_stepper",),
    "notes_t": ("twolevel_notes:visit",),
    "jumps_t": ("twolevel_jumps:visit",),
    "stimulation_t": ("twolevel_stimulation:visit",),
    "well_results_t": ("twolevel_well_rows:visit",),
    "value_errors_t": ("twolevel_archive:visit_value_errors",),
    "followed_t": ("twolevel_archive:visit_followed",),
    "sparse_step_t": ("coarse_sparse_step:visit",),
    "condensed_t": ("coarse_archive:visit_factors",),
    "coarse_model_t": ("twolevel_restart:visit_problem", "coarse_archive:visit_step_values"),
    "rock_wells_t": ("coarse_archive:visit_step_values",),
    "wells_t": ("coarse_archive:visit_step_values",),
    "joints_t": ("coarse_archive:visit_step_values",),
    "mechanics_simulation_t": ("mechanics_simulation:visit",),
    "loaded_body_t": ("mechanics_simulation:visit",),
    "body_t": ("mechanics_body:visit",),
    "before_t": ("mechanics_body:visit",),
    "energy_error_t": ("mechanics_body:visit",),
    "increment_t": ("mechanics_equilibrium:visit",),
    "tries_t": ("mechanics_tries:visit",),
    "programme_t": ("mechanics_programme:visit",),
    "dead_load_t": ("mechanics_dead_load:visit",),
    "mesh_t": ("mesh_archive:visit_mesh",),
    "snapshot_t": ("report_fields_archive:visit_snapshot",),
    "matrix_fields_t": ("report_fields_archive:visit_matrix",),
    "fracture_fields_t": ("report_fields_archive:visit_fracture",),
    "fracture_errors_t": ("report_fields_archive:visit_fracture",),
    "intersection_fields_t": ("report_fields_archive:visit_intersection",),
    "run_output_t": ("report_run:visit",),
    "tables_t": ("report_tables:visit",),
    "series_t": ("report_series:visit",),
    "text_buffer_t": ("base_buffer:visit_length", "base_buffer:visit_text"),
    "snapshots_t": ("report_snapshots:visit",),
    "collection_t": ("report_snapshots:visit",),
    "network_record_t": ("report_network:visit",),
    "journal_t": ("app_run:visit",),
    "tape_t": ("base_tape:visit",),
    "pace_t": ("twolevel_pace:visit",),
}

_RULE = "follows from the scene, the mesh and what is stored, and is made again"
_EMPTY = "empty between two steps"
_HEAT = "these fields are stored without a fluid only, and so without heat"
_FILES = "of this process: places, clocks, and what is on disk"


def _each(names: str, reason: str) -> dict[str, str]:
    return dict.fromkeys(names.split(), reason)


# type: components that are not stored, with the reason
MADE_AGAIN = {
    "blurred_t": {"is_unsolved": "found in each step, and in the warnings since"},
    "fracture_errors_t": {"temperature": _HEAT},
    "two_levels_t": {
        "last": "the next step begins with it",
        "kept_problem": _EMPTY,
        "load_pressure": _RULE,
    },
    "summary_t": {"heat": "that of the state"},
    "matrix_fields_t": {"temperature": _HEAT, "temperature_error": _HEAT},
    "fracture_fields_t": {"temperature": _HEAT},
    "simulation_t": {
        "scene": "it is read again, and may be changed",
        "chronicle": _EMPTY,
        "end_time": _RULE,
    },
    "front_t": {"rules": _RULE},
    "coarse_problem_t": _each("joint_share path rock_cell entries well_of heat heat_field", _RULE)
    | _each("ahead asked steady", _RULE)
    | dict.fromkeys(["heat_after", "heat_span", "heat_flows"], "of the tries of a step"),
    "coarse_model_t": _each("rock sides in_situ regions matrix layers drained may_hold", _RULE)
    | {"rock_resistance": _RULE, "weight": _RULE},
    "condensed_t": _each("is_full stiffness coupling normal length n", _RULE)
    | {"layout": _RULE, "analysed": _RULE},
    "rock_wells_t": _each("n cell rings ring_number ring_of", _RULE),
    "wells_t": _each("entry n n_all number share joint_share path storage", _RULE)
    | _each("friction turbulence pressure_in_situ n_entries of_entry entry_loss", _RULE),
    "joints_t": _each("n point is_outlet pressure_in_situ branches cell joint way way_error", _RULE)
    | _each("end beyond side excess gross", _RULE),
    "sparse_step_t": {"solver": _RULE},
    "window_t": {
        "follows_other": _EMPTY,
        "sides": _RULE,
        "force_in_situ": _RULE,
        "pressure_in_situ": _RULE,
        "map": _RULE,
        "faces": _RULE,
    },
    "stated_errors_t": {"position": "set in each step"},
    "stepper_t": _each("longest shortest after_growth", "a setting of the scene")
    | {"tolerance": "a setting of the scene"},
    "loaded_body_t": {"turns": _RULE},
    "body_t": {"model": _RULE, "probe": _RULE},
    "programme_t": {"ends": _RULE, "steps": _RULE},
    "run_output_t": _each("place keeps_earlier_run log_written clock_begin last_flush", _FILES)
    | {"record_written": _FILES}
    | {"flush_cost": _FILES, "writes_vtu": _RULE, "interval": _RULE},
    "tables_t": {"probe_names": _RULE, "pressure_names": _RULE},
    "series_t": _each("path written", _FILES)
    | {"names": _RULE, "column": _EMPTY, "fault": "the run fails with it"}
    | _each("is_written is_past", "those of the first line of the text"),
    "snapshots_t": {"directory": _FILES, "material": _RULE, "counts": _RULE},
    "snapshot_t": {"windows": "of scenes with a fluid, whose fields are made again"},
    "collection_t": {"path": _FILES, "is_falling": _RULE},
    "network_record_t": {"path": _FILES, "names": _RULE, "clock": _RULE},
    "tape_t": _each("own own_mark taken_mark", _EMPTY) | {"is_recording": _RULE},
    "pace_t": _each("recorded recorded_end since recorded_since is_bound has_joined misfit", _EMPTY)
    | _each("why_not tries last_dt last_misfit", _EMPTY),
    "journal_t": {
        "progress": _FILES,
        "has_state": _FILES,
        "shown": _FILES,
        "checkpoints": _FILES,
    },
}

_TYPE = re.compile(r"^ +type(?:, [\w() ,]+)? :: (\w+)\n(.*?)^ +end type", re.MULTILINE | re.DOTALL)


def _source(path: Path) -> str:
    """Source without comments and continuations."""
    text = re.sub(r"!.*", "", path.read_text())
    return re.sub(r"&\s*\n\s*&?", "", text)


@cache
def _types() -> dict[str, tuple[list[str], list[str]]]:
    """Components, and lines that declare them, of all types by their names."""
    found: dict[str, tuple[list[str], list[str]]] = {}
    for path in sorted(FORTRAN.glob("*/*.f90")):
        for name, body in _TYPE.findall(_source(path)):
            lines = [line for line in body.split("\n   contains")[0].splitlines() if "::" in line]
            found[name] = ([each for line in lines for each in _names(line)], lines)
    return found


def _names(line: str) -> Iterator[str]:
    """Names that a line declares."""
    declared = re.sub(r"\([^()]*(?:\([^()]*\)[^()]*)*\)|\[.*?\]", "", line.partition("::")[2])
    for part in declared.split(","):
        if name := re.match(r"\s*(\w+)", part):
            yield name[1]


def _procedure(place: str) -> str:
    module, _, name = place.partition(":")
    (path,) = FORTRAN.glob(f"*/{module}.f90")
    match = re.search(
        rf"^ +(?:module )?(subroutine|procedure) {name}\b.*?end \1 {name}\b",
        _source(path).split("\ncontains", 1)[1],
        re.MULTILINE | re.DOTALL,
    )
    assert match, place
    return match[0]


@pytest.mark.parametrize("name", sorted(STORED))
def test_every_component_is_stored_or_made_again(name: str) -> None:
    components, _ = _types()[name]
    assert components, name
    text = "\n".join(_procedure(place) for place in STORED[name])
    stored = {each for each in components if re.search(rf"%{each}\b", text)}
    made = set(MADE_AGAIN.get(name, ()))
    assert set(components) - stored - made == set(), "neither stored nor made again"
    assert made - set(components) == set(), "no component of this name"


def test_bytes_are_stored_only_of_types_without_allocatable_components() -> None:
    plain: set[str] = set()
    for path in FORTRAN.glob("*/*.f90"):
        for target in re.findall(r"%plain\(\"?\w+\"?, c_loc\(([\w%()]+)\)", _source(path)):
            plain.add(target.rpartition("%")[2])
    types = {
        kind
        for _, lines in _types().values()
        for line in lines
        for kind in re.findall(r"^\s*type\((\w+)\)", line)
        if plain & set(_names(line))
    }
    assert types
    for kind in sorted(types & set(_plain_kinds())):
        _check_plain(kind)


def _plain_kinds() -> list[str]:
    """Types whose values are stored as bytes."""
    return [
        *("tip_t", "segment_t", "window_tip_t", "approach_t", "contact_law_t", "face_law_t"),
        *("accumulated_error_t", "followed_step_t", "history_errors_t", "fluid_totals_t"),
        *("slip_event_t", "amount_t", "patch_t"),
    ]


def _check_plain(kind: str) -> None:
    for line in _types()[kind][1]:
        assert "allocatable" not in line, kind
        assert "pointer" not in line, kind
        for part in re.findall(r"^\s*type\((\w+)\)", line):
            _check_plain(part)
