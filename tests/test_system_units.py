"""Results depend on the dimensionless groups of a scene alone, also while fractures grow."""

from __future__ import annotations

from pathlib import Path

import pytest
from scaled_scene import Units, differences, in_units, table
from system_scene import TOP, run

pytestmark = pytest.mark.usefixtures("program")

# A fracture of 20 m at 45 degrees that jumps until its wings are arrested, and then grows.
SCENE = """\
&domain x_min = 0.0, x_max = 400.0, y_min = 0.0, y_max = 400.0 /
&material
  young = 40.0e9, poisson = 0.2
  biot = 0.8, porosity = 0.01, permeability = 1.0e-18
  toughness = 1.5e6
/
&fluid compressibility = 4.0e-10, viscosity = 3.0e-4 /
&fracture
  name = 'f1'
  x = 192.92893218813452, 207.07106781186548
  y = 192.92893218813452, 207.07106781186548
  friction = 0.5, dilation_deg = 1.0, aperture = 2.0e-4
/
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'right', x_traction = -20.0e6 /
&side name = 'top', y_traction = -10.0e6 /
&injection fracture = 'f1', rate = 1.0e-5 /
&time end = 1.0e7 /
&coarse size_fracture = 2.0, size_boundary = 40.0 /
&fine window = 100.0 /
&growth enabled = .true., stop_gain = 0.25 /
&output vtu = .false. /
"""

# Sums that must vanish, the last residuals of iterations, a small difference of large contents, and
# errors by slopes between the last tries, whose number rounding may decide.
ROUNDING = (
    "mass_error_relative",
    "contact_residual",
    "forward_error_bound",
    "rock_fluid_m2",
    "fracture_length_error_m",
    "well_pressure_error_pa",
    # which contain the error of the length, or that of the fluid balance
    "position_error_m",
    *(f"{name}_error_m2" for name in ("injected", "produced", "leakoff", "outflow")),
    *(f"{name}_error_m2" for name in ("fracture_fluid", "rock_fluid", "rock_outflow")),
    "fracture_volume_error_m2",
    "max_slip_error_m",
    "max_opening_error_m",
    "seismic_moment_error_nm",
    "injectivity_error_m2_s_pa",
    *(f"{name}_error_m" for name in ("stimulated_length", "connected_length")),
    "connected_stimulated_error_m",
)


@pytest.fixture(scope="module")
def given(program: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files of the scene in metres, pascals and seconds."""
    return run(tmp_path_factory.mktemp("given"), in_units(SCENE, Units()))


@pytest.mark.parametrize(
    "units",
    [
        Units(length=0.0625, stress=4.0, time=1.0),
        Units(length=4.0**6, stress=1.0, time=4.0**8),
    ],
    ids=["1.25 m", "82 km"],
)
def test_growth_in_other_units(tmp_path: Path, given: Path, units: Units) -> None:
    """Factors that are powers of 4 change rounding alone: nothing absolute is in the results.

    The run ends at a gain of 0.25 m: at 0.28 m an advance, which is rounded to 1e-7 of the segment,
    is on either side of such a number, and the pressures differ by 4e-8 from there on.
    """
    out = run(tmp_path, in_units(SCENE, units))
    for name in ("history.csv", "tips.csv"):
        wanted, found = table(given / name), table(out / name, units)
        assert max(row.get("fracture_length_m", 20.5) for row in wanted) > 20.3
        # K of the first steps is that of thin layers, a small difference: it has 5 digits
        for since, most in ((0.0, 1.0e-5), (0.1, 1.0e-7)):
            late = [[row for row in rows if row["time_s"] >= since] for rows in (wanted, found)]
            apart = differences(late[0], late[1], ROUNDING)
            assert len(apart) > 15
            assert {column: error for column, error in apart.items() if not error <= most} == {}


def test_growth_by_cold_water_in_other_units(tmp_path: Path) -> None:
    """With heat, too, no length is absolute."""
    text = SCENE
    for old, new in (
        ("1.5e6", "1.5e7, heat_capacity = 2.2e6, heat_conductivity = 2.6, heat_expansion = 2.4e-5"),
        ("viscosity = 3.0e-4", "viscosity = 3.0e-4, heat_capacity = 4.2e6"),
        ("rate = 1.0e-5 /", "rate = 1.0e-5, temperature = 350.0 /\n&heat temperature = 400.0 /"),
        ("stop_gain = 0.25", "stop_gain = 0.005"),
    ):
        assert old in text
        text = text.replace(old, new)
    units = Units(length=4.0**5)
    one = run(tmp_path, in_units(text, Units()), "one")
    other = run(tmp_path, in_units(text, units), "other")
    # The sides are far: 1e-34 of the heat of the well goes through them.
    through_sides, by_well = (
        max(abs(row[f"heat_by_{of}_j"]) for row in table(one / "history.csv"))
        for of in ("sides", "wells")
    )
    assert through_sides < 1.0e-20 * by_well
    rounding = (*ROUNDING, "heat_by_sides_j", "heat_error_relative")
    for name in ("history.csv", "tips.csv"):
        found = differences(table(one / name), table(other / name, units), rounding)
        assert {column: error for column, error in found.items() if not error <= 1.0e-7} == {}


@pytest.mark.parametrize("scene", ["crossing", "l_panel"])
def test_shipped_scenes_in_other_units(tmp_path: Path, scene: str) -> None:
    """A network with flow, slip and joints, and a body without a fluid: no length is absolute."""
    text = (TOP / f"inputs/examples/{scene}.nml").read_text()
    units = Units(length=4.0, stress=0.25, time=16.0)
    one = run(tmp_path, in_units(text, Units()), "one")
    other = run(tmp_path, in_units(text, units), "other")
    for name in ("history.csv", "tips.csv"):
        found = differences(table(one / name), table(other / name, units), ROUNDING)
        assert {column: error for column, error in found.items() if not error <= 1.0e-12} == {}


def test_growth_without_toughness(tmp_path: Path) -> None:
    """With K_IC = 0 the fracture runs to its end too, and is longer than with K_IC."""
    end = SCENE.replace("end = 1.0e7", "end = 0.2").replace("stop_gain = 0.25", "stop_gain = 50.0")
    last = {
        toughness: table(run(tmp_path, text, toughness) / "history.csv")[-1]
        for toughness in ("0.0", "1.5e6")
        for text in [end.replace("toughness = 1.5e6", f"toughness = {toughness}")]
    }
    assert all(row["time_s"] == 0.2 for row in last.values())
    error = last["1.5e6"]["fracture_length_error_m"]
    assert last["0.0"]["fracture_length_m"] > last["1.5e6"]["fracture_length_m"] + error
