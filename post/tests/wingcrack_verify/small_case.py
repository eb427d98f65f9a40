"""A small sound case with a stand-in for the solver, for tests to break in one place."""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass, field
from pathlib import Path

from wingcrack_verify.execute import Programs, Runner
from wingcrack_verify.judge import CaseReport
from wingcrack_verify.suite import JudgedSuite, judge_suite, read_suite

# The stand-in copies prepared results. What it does beside that is the text after `! do:` in the
# scene, so that a scene decides how its run ends.
_SOLVER = """\
#!/bin/bash
# run SCENE --out DIR --quiet
while read -r key _ value; do
  if [ "$key" = name ]; then name=${value//\\'/}; fi
done <"$2"
echo "$name" >>@CALLS@
cp -r @RESULTS@/"$name"/. .
if [ -f do.sh ]; then . ./do.sh; fi
"""

# Nine points of p = 2 x^2 with an error of size^2 (1 + x) on top: second order.
_X = [0.125 * i for i in range(9)]

CHECK_TOML = """\
title = "Parabola"
group = "flow"
source = "arithmetic"
quick = true

[constants]
factor = 2.0

[[run]]
name = "coarse"
method = "plain"
size = 0.2
scene = "scene.nml"
set = { "scene.name" = "coarse" }

[[run]]
name = "middle"
method = "plain"
size = 0.1
scene = "scene.nml"
set = { "scene.name" = "middle" }

[[run]]
name = "fine"
method = "plain"
size = 0.05
default = true
scene = "scene.nml"
set = { "scene.name" = "fine" }

"""

CHECKS = {
    "absolute": """\
[[check]]
quantity = "pressure at the end"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", at = { x_m = 1.0 } }
reference = 2.0
metric = "absolute"
tolerance = 0.02
""",
    "relative": """\
[[check]]
quantity = "largest pressure"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", take = "max" }
reference = { file = "reference.csv", column = "p_pa", at = { x_m = 1.0 } }
metric = "relative"
tolerance = 0.01
""",
    "ratio": """\
[[check]]
quantity = "pressure half way"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", interpolate = { x_m = 0.5 } }
reference = { run_file = "exact.csv", column = "factor*x_m**2", at = { x_m = 0.5 } }
metric = "ratio"
tolerance = 0.02
""",
    "max_relative": """\
[[check]]
quantity = "profile, largest error"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", x = "x_m" }
reference = { expression = "factor*x**2" }
metric = "max_relative"
tolerance = 0.01
""",
    "l2_relative": """\
[[check]]
quantity = "profile"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", x = "x_m" }
reference = { file = "reference.csv", column = "p_pa", x = "x_m" }
metric = "l2_relative"
tolerance = 0.01
order = { expected = 2.0, within = 0.1 }
work_precision = true
""",
    "range": """\
[[check]]
quantity = "pressure within bounds"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", at = { x_m = 1.0 } }
reference = { lower = 1.9, upper = 2.1 }
metric = "range"
""",
    "monotonic": """\
[[check]]
quantity = "pressure rises"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", x = "x_m" }
reference = "rising"
metric = "monotonic"
tolerance = 1.0e-6
""",
    "at_least": """\
[[check]]
quantity = "no less than the range of a line"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", take = "max" }
reference = { run_file = "exact.csv", column = "factor*x_m + 5", take = "span" }
metric = "at_least"
tolerance = 1.0e-6
""",
    "at_most": """\
[[check]]
quantity = "no more than the range of a line"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", take = "max" }
reference = { run_file = "exact.csv", column = "factor*x_m + 5", take = "max" }
metric = "at_most"
tolerance = 1.0e-6
""",
    "path": """\
[[check]]
quantity = "curve"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", x = "x_m" }
reference = { file = "reference.csv", column = "p_pa", x = "x_m" }
metric = "path"
tolerance = 0.01
scale = 1.0
order = { expected = 2.0, within = 0.1 }
""",
    "of another run": """\
[[check]]
quantity = "profile beside that of a coarser run"
unit = "Pa"
runs = ["fine"]
result = { file = "profile.csv", column = "p_pa", x = "x_m" }
reference = { run = "middle", file = "profile.csv", column = "p_pa", x = "x_m" }
metric = "max_relative"
tolerance = 0.01
""",
    "residual": """\
[[check]]
quantity = "mass error"
unit = "-"
result = { file = "run.json", key = "mass_error_relative" }
reference = 0.0
metric = "absolute"
tolerance = 1.0e-8
scale = 1.0
""",
}


# Not among the checks of the sound case: its runs must tell their unknowns.
ECONOMY_CHECK = """\
[[check]]
quantity = "largest, with few unknowns"
unit = "Pa"
judged = ["fine"]
result = { file = "profile.csv", column = "p_pa", take = "max" }
reference = 2.0
metric = "relative"
tolerance = 0.01
work_precision = true
economy = { method = "plain", than = "poor", error = 0.005, at_most = 0.9 }
"""


@dataclass
class SmallCase:
    """A folder of cases with one case in it, and the results that its runs will give."""

    root: Path
    toml: str
    results: Path = field(init=False)
    case: Path = field(init=False)

    def __post_init__(self) -> None:
        """Write all files of the sound case."""
        self.results = self.root / "results"
        self.case = self.root / "verification" / "parabola"
        self.case.mkdir(parents=True)
        (self.case / "README.md").write_text("# Parabola\n\n| a | b |\n|---|---|\n| 1 | 2 |\n")
        (self.case / "scene.nml").write_text("&scene\n  name = 'none'\n/\n")
        exact = [f"{x},{2.0 * x * x}" for x in _X]
        (self.case / "reference.csv").write_text(lines("x_m,p_pa", exact))
        for name, size in (("coarse", 0.2), ("middle", 0.1), ("fine", 0.05)):
            folder = self.results / name
            folder.mkdir(parents=True)
            rows = [f"{x},{2.0 * x * x + size**2 * (1.0 + x)}" for x in _X]
            (folder / "profile.csv").write_text(lines("x_m,p_pa", rows))
            (folder / "exact.csv").write_text(lines("x_m", [str(x) for x in _X]))
            self.write_record(name, cpu_s=0.01 / size)
        self.write_solver()

    @property
    def calls(self) -> list[str]:
        """Names of the runs that the stand-in was started for."""
        file = self.root / "calls"
        return file.read_text().split() if file.exists() else []

    def write_solver(self, remark: str = "") -> None:
        """Write the stand-in for the solver."""
        program = self.root / "build" / "fortran" / "app" / "wingcrack-solver"
        program.parent.mkdir(parents=True, exist_ok=True)
        text = _SOLVER.replace("@RESULTS@", str(self.results))
        program.write_text(text.replace("@CALLS@", str(self.root / "calls")) + remark)
        program.chmod(0o755)

    def write_record(self, name: str, **changes: object) -> None:
        """Write run.json of a run."""
        record = {"status": "finished", "cpu_s": 0.1, "mass_error_relative": 1.0e-12} | changes
        (self.results / name / "run.json").write_text(json.dumps(record))

    def edit(self, name: str, old: str, new: str) -> None:
        """Replace a text that must be there in a file of the case or of the results."""
        file = self.case / name if (self.case / name).exists() else self.results / name
        text = file.read_text()
        assert old in text
        file.write_text(text.replace(old, new))

    def ends_with(self, name: str, script: str) -> None:
        """Let a run end as a shell script says, after its files are there."""
        (self.results / name / "do.sh").write_text(script)

    def judge(self) -> CaseReport:
        """Run and judge the case."""
        return self.judge_all().cases[0]

    def judge_all(self, names: tuple[str, ...] = (), quick: bool = False) -> JudgedSuite:
        """Run and judge everything."""
        (self.case / "check.toml").write_text(self.toml)
        suite = read_suite(self.root / "verification", names, quick)
        runner = Runner(
            Programs(self.root / "build", self.case.parent / "programs"), self.root / "cache", 2
        )
        return judge_suite(suite, runner.run_all(suite.jobs, lambda _job, _outcome: None))

    def forget(self) -> None:
        """Throw away what earlier runs left."""
        shutil.rmtree(self.root / "cache", ignore_errors=True)


def lines(head: str, rows: list[str]) -> str:
    """Text of a CSV file."""
    return "\n".join([head, *rows, ""])


def small_case(root: Path, *checks: str) -> SmallCase:
    """Make the case with the named checks; without names, with all of them."""
    known = CHECKS | {"economy": ECONOMY_CHECK}
    return SmallCase(root, CHECK_TOML + "\n".join(known[name] for name in checks or CHECKS))
