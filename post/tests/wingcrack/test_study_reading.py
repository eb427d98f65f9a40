"""What a study's file may say, and how what it may not is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from small_study import HEAD, LINES, ONSET, OVER, PRESSURE, SOUND, small_study
from wingcrack.errors import CaseError
from wingcrack.studies.study import Study, read_study
from wingcrack.studies.units import column_name, pretty_number, spoken, unit_of_path

TOP = Path(__file__).resolve().parents[3]
DRAW = """\
[draw]
count = 4
seed = 1
[draw.parameters]
"injection.rate" = { uniform = [1.0e-9, 2.0e-9] }
"""
KEY = '[[quantity]]\nname = "n"\nunit = "-"\nfile = "run.json"\nkey = "steps"\n'


def read(folder: Path, text: str, quick: bool = False) -> Study:
    return read_study(small_study(folder, text).file, quick)


def test_the_last_axis_changes_first(tmp_path: Path) -> None:
    over = '[over]\n"injection.rate" = [1e-9, 2e-9]\n"fracture.f1.friction" = [0.3, 0.4]\n'
    study = read(tmp_path, HEAD + over)
    values = [
        (run.values["injection.rate"], run.values["fracture.f1.friction"]) for run in study.runs
    ]
    assert values == [(1e-9, 0.3), (1e-9, 0.4), (2e-9, 0.3), (2e-9, 0.4)]
    assert "friction = 0.4" in study.runs[1].text
    assert [parameter.heading for parameter in study.parameters] == [
        "injection_rate_m2_s",
        "fracture_f1_friction",
    ]


def test_lists_of_one_table_go_side_by_side(tmp_path: Path) -> None:
    text = HEAD + (
        "[over.setting]\nrate = [1e-9, 2e-9]\nfriction = [0.3, 0.4]\n"
        '[set]\n"injection.rate" = "{rate}"\n"fracture.1.friction" = "{friction}"\n'
    )
    study = read(tmp_path, text)
    assert [run.values for run in study.runs] == [
        {"rate": 1e-9, "friction": 0.3},
        {"rate": 2e-9, "friction": 0.4},
    ]
    assert [parameter.unit for parameter in study.parameters] == ["m2/s", "-"]


def test_without_parameters_there_is_one_run(tmp_path: Path) -> None:
    study = read(tmp_path, HEAD + PRESSURE)
    assert [(run.label, run.values) for run in study.runs] == [("the scene", {})]


def test_draws_are_repeated_at_each_place_of_a_grid(tmp_path: Path) -> None:
    grid = '[over]\n"fracture.f1.friction" = [0.3, 0.4]\n'
    study = read(tmp_path, HEAD + grid + DRAW)
    rates = [run.values["injection.rate"] for run in study.runs]
    assert len(rates) == 8
    assert rates[:4] == rates[4:]
    assert study.runs[5].label == "fracture.f1.friction = 0.4, sample = 2"
    assert study.quantiles == (0.1, 0.5, 0.9)


def test_quick_replaces_what_it_gives(tmp_path: Path) -> None:
    quick = '[quick]\ncount = 2\nset = { "scene.title" = "short" }\n'
    study = read(tmp_path, HEAD + DRAW + quick, quick=True)
    assert len(study.runs) == 2
    assert "'short'" in study.runs[0].text


def test_a_byte_order_mark_is_no_matter(tmp_path: Path) -> None:
    sound = small_study(tmp_path, SOUND).file
    sound.write_bytes(b"\xef\xbb\xbf" + sound.read_bytes())
    assert len(read_study(sound).runs) > 0


BAD = {
    "lists in lists": (SOUND + f"x = {'[' * 900}{']' * 900}\n", "more than 100 deep within"),
    "tables in tables": (SOUND + f"[{'.'.join('a' * 900)}]\n", "more than 100 deep within"),
    "a number of 400 digits": (SOUND + f"[constants]\na = {'9' * 400}\n", "larger than 1.8e+308"),
    "a number of 5000 digits": (SOUND + f"a = {'9' * 5000}\n", "has more than 309 digits"),
    "a name that is too long": (
        SOUND.replace('scene = "', f'scene = "{"a" * 300}'),
        "there is no scene file",
    ),
    "a date": (SOUND + '[set]\n"time.end" = 1979-05-27\n', "must be numbers, texts or truth"),
    "a key that is unknown": (SOUND + "[colour]\n", "'colour' is unknown"),
    "a path without quotes": (
        HEAD + "[over]\ninjection.rate = [1e-9]\n",
        "give the path of a namelist entry in quotes",
    ),
    "a number instead of a list": (HEAD + '[over]\n"injection.rate" = 1e-9\n', "must be a list"),
    "an empty list": (HEAD + '[over]\n"injection.rate" = []\n', "at least one value"),
    "a value twice": (
        HEAD + '[over]\n"injection.rate" = [1e-9, 1.0e-9]\n',
        "the run 'injection.rate = 1e-09' stands twice",
    ),
    "a name that nobody uses": (HEAD + "[over]\nsize = [1, 2]\n", "nothing uses 'size'"),
    "a template without its name": (
        SOUND + '[set]\n"time.end" = "{end}"\n',
        "'end' in '{end}' is no name here",
    ),
    "a value given twice": (
        SOUND + '[set]\n"injection.rate" = 1e-9\n',
        "both [set] and the parameters give 'injection.rate'",
    ),
    "no unit": (
        HEAD + '[over]\nx = [1, 2]\n[set]\n"injection.rate" = "{1e-9*x}"\n',
        "units: 'x' is missing",
    ),
    "a unit of nothing": (SOUND + '[units]\nrate = "m"\n', "there is no parameter 'rate'"),
    "a unit that is a number": (
        SOUND + '[units]\n"injection.rate" = 3\n',
        "must be a text",
    ),
    "two columns of one name": (SOUND + PRESSURE, "two columns 'pressure_mpa'"),
    "a column of the table": (
        SOUND + PRESSURE.replace('"pressure"', '"cpu"').replace('"MPa"', '"s"'),
        "two columns 'cpu_s'",
    ),
    "a profile as a quantity": (
        HEAD + PRESSURE.replace('take = "max"', 'x = "time_s"'),
        "one value is needed",
    ),
    "a figure of no quantity": (
        SOUND + '[[figure]]\nname = "a"\nkind = "histogram"\nquantity = "lenght"\n',
        "there is no quantity 'lenght'",
    ),
    "a figure of no parameter": (
        SOUND + LINES.replace('"pressure"', '"b"') + 'by = ["friction"]\n',
        "there is no parameter 'friction'",
    ),
    "a figure of no kind": (SOUND + LINES.replace('"lines"', '"pie"'), "'pie' is no kind"),
    "a figure twice": (SOUND + LINES + LINES, "figure 'pressure' stands twice"),
    "a figure that names a path": (
        SOUND + LINES.replace('"pressure"', '"../pressure"'),
        "it names a file",
    ),
    "lines without x": (HEAD + OVER + LINES.replace('x = "time_s"\n', ""), "'x' is missing"),
    "a quick count without draws": (SOUND + "[quick]\ncount = 2\n", "is for a study with [draw]"),
    "quantiles beyond 1": ("quantiles = [0.5, 1.5]\n" + SOUND, "numbers from 0 to 1"),
    "quantiles that fall": ("quantiles = [0.9, 0.1]\n" + SOUND, "that increase"),
    "a time limit of none": ("time_limit_s = 0\n" + SOUND, "must be positive"),
    "no workers": (SOUND + "[cluster]\nworkers = 0\n", "'workers' must be a whole number"),
    "a cluster of no kind": (SOUND + '[cluster]\nkind = "moon"\n', "'moon' is no kind"),
    "draws of a name that is taken": (
        HEAD + OVER + DRAW,
        "two axes give 'injection.rate'",
    ),
    "an infinite value": (
        HEAD + '[over]\nx = [0.0, 1.0]\n[set]\n"injection.rate" = "{1/x}"\n',
        "'1/x' is inf",
    ),
    "more runs than anyone can want": (
        HEAD + DRAW.replace("count = 4", "count = 10001"),
        "10001 runs are more than 10000",
    ),
    "more runs than memory could hold": (
        HEAD + DRAW.replace("count = 4", "count = 100000000"),
        "100000000 runs are more than 10000",
    ),
    "a grid of more than a thousand million runs": (
        HEAD + "[over]\n" + "".join(f"{name} = {list(range(200))}\n" for name in "abcd"),
        "1600000000 runs are more than 10000",
    ),
    "a grid of too many draws": (
        HEAD + '[over]\n"fracture.f1.friction" = [0.3, 0.4]\n' + DRAW.replace("= 4", "= 6000"),
        "12000 runs are more than 10000",
    ),
    "a misspelt column": (
        HEAD + OVER + PRESSURE.replace("well_pressure_pa", "well_presure_pa"),
        "history.csv has no column 'well_presure_pa' (docs/output.md); did you mean 'well_pres",
    ),
    "a misspelt column of a condition": (
        HEAD + OVER + ONSET.replace("{ kind", "{ kinds"),
        "events.csv has no column 'kinds'",
    ),
    "a misspelt column of a figure": (
        SOUND + LINES.replace('"time_s"', '"time_min"'),
        "history.csv has no column 'time_min'",
    ),
    "a misspelt key": (
        HEAD + KEY.replace("steps", "stepps"),
        "run.json has no key 'stepps' (docs/output.md); did you mean 'steps'?",
    ),
    "a column of runs without a fluid": (
        HEAD + PRESSURE.replace("well_pressure_pa", "load_factor"),
        "history.csv has the column 'load_factor' only without a fluid",
    ),
    "a file that no run writes": (
        HEAD + PRESSURE.replace("history.csv", "histories.csv"),
        "'histories.csv' is no file of a run that can be read; there are: history.csv",
    ),
    "a file outside of the run": (
        HEAD + PRESSURE.replace("history.csv", "../input.csv"),
        "'../input.csv' is no file of a run",
    ),
    "a file of the machine": (
        HEAD + KEY.replace("run.json", "/etc/shadow"),
        "'/etc/shadow' is no file of a run",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_what_a_study_may_not_say(tmp_path: Path, name: str) -> None:
    text, reason = BAD[name]
    with pytest.raises(CaseError) as caught:
        read(tmp_path, text)
    assert reason in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    study = small_study(tmp_path)
    study.file.write_bytes(b"\xff\xfe\x00title")
    with pytest.raises(CaseError, match=r"study\.toml"):
        read_study(study.file)


def test_constants_parameters_and_probes_can_be_read(tmp_path: Path) -> None:
    probe = PRESSURE.replace("history.csv", "probes.csv").replace(
        "well_pressure_pa/1e6", "a-b_p_pa"
    )
    study = read(
        tmp_path,
        "constants = { half = 0.5 }\n" + HEAD + "[over]\nrate = [1e-9, 2e-9]\n"
        '[set]\n"injection.rate" = "{rate}"\n'
        + PRESSURE.replace("well_pressure_pa/1e6", "half*well_pressure_pa/rate")
        + probe.replace('"pressure"', '"probed"')
        + KEY,
    )  # fmt: skip
    assert [item.file for item in study.quantities] == [
        "history.csv",
        "probes.csv",
        "run.json",
    ]


def test_words_of_any_script_are_kept(tmp_path: Path) -> None:
    study = read(tmp_path, HEAD.replace("Small", "Störung 断层") + ONSET + OVER)
    assert study.title == "Störung 断层"


@pytest.mark.parametrize(
    "file", sorted((TOP / "inputs" / "studies").glob("*.toml")), ids=lambda f: f.stem
)
def test_shipped_studies_are_sound_and_have_a_short_form(file: Path) -> None:
    whole, quick = read_study(file), read_study(file, quick=True)
    assert 1 < len(quick.runs) <= 6
    assert len(quick.runs) < len(whole.runs)
    assert whole.quantities
    assert whole.plots
    assert file.read_text(encoding="utf-8").startswith("# ")


@pytest.mark.parametrize(
    ("name", "unit", "column"),
    [
        ("injection.rate", "m2/s", "injection_rate_m2_s"),
        ("onset", "h", "onset_h"),
        ("largest K", "MPa sqrt(m)", "largest_k_mpa_sqrtm"),
        ("steps", "-", "steps"),
        ("time_s", "s", "time_s"),
    ],
)
def test_columns_carry_their_unit(name: str, unit: str, column: str) -> None:
    assert column_name(name, unit) == column


def test_units_come_from_the_table_of_the_input() -> None:
    assert unit_of_path("injection.1.rate") == "m2/s"
    assert unit_of_path("Material.Young") == "Pa"
    assert unit_of_path("fracture.main.friction") == "-"
    assert unit_of_path("fracture.colour") is None


def test_values_that_differ_are_spoken_differently() -> None:
    assert spoken(0.1) == "0.1"
    assert spoken(0.1 + 1e-12) != spoken(0.1)
    assert spoken([1.0, 2.5]) == "1 2.5"
    assert (pretty_number(1e-7), pretty_number(2.5e-9)) == ("$10^{-7}$", r"$2.5\times10^{-9}$")
    assert (pretty_number(0.25), pretty_number(-3), pretty_number("paris")) == (
        "0.25",
        "-3",
        "paris",
    )
