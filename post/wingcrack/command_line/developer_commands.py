"""Commands that measure, test, build and document the program."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

from wingcrack.command_line.declaring import TOP, Parameter, UsageError, command, flag, load
from wingcrack.command_line.values import absolute, whole

_SOLVER = TOP / "build" / "release" / "fortran" / "app" / "wingcrack-solver"
_NAMES = Parameter("names", "[NAME...]", many=True)
_FOLDERS = tuple(
    Parameter(name, "DIR", help, absolute, TOP / path)
    for name, path, help in (  # noqa: A001
        ("--cases", "verification", "where the cases are"),
        ("--build", "build/release", "where the solver was built"),
        ("--cache", "build/verification", "where the files of the runs are kept"),
    )
)


@command(
    "verify",
    "wingcrack_verify.cli:verify",
    Parameter("names", "[CASE...]", many=True),
    flag("--quick", "only the quick cases"),
    Parameter("--jobs", "N", "runs at a time (2)", whole(1, 64), 2),
    *_FOLDERS,
    Parameter("--report", "DIR", "where the report goes", absolute, TOP / "verification/report"),
    about="""\
Runs the verification cases, measures their errors and writes verification/report/ with index.html,
report.json and, where Chromium or Chrome is installed, report.pdf. What has not changed since an
earlier call is not run again.
""",
    statuses="""\
0 all passed or known gaps; 1 a case failed or is in error; 2 bad usage; 3 not built;
130 interrupted: what is done is kept.""",
    example="""\
./wingcrack verify --quick
./wingcrack verify onset_c1 stability
""",
)
def verify(given: SimpleNamespace) -> None:
    """Verification cases: errors, orders, run times, stability."""
    there = load("wingcrack_verify:case_folders")(given.cases)
    for name in given.names:
        if name not in there:
            known = ", ".join(sorted(there)) or "none"
            raise UsageError(f"there is no case '{name}' (there are: {known})")
    if given.report.exists() and not given.report.is_dir():
        raise UsageError(f"the report cannot go to {given.report}, which is a file")


_PAPERS = ("paper_a", "paper_b", "paper_c", "paper_d")


@command(
    "reproduce",
    "wingcrack_verify.reproduce:reproduce",
    Parameter("paper", "|".join(_PAPERS), required=True),
    Parameter("--out", "DIR", "for the results (default: out/PAPER)", Path),
    flag("--quick", "some of the numbers and figures, in seconds"),
    Parameter("--jobs", "N", "runs at a time (2)", whole(1, 64), 2),
    Parameter("--papers", "DIR", "where their files are", absolute, TOP / "inputs/papers"),
    *_FOLDERS,
    about="""\
Runs all scenes and studies of a paper of the thesis (Dang 2023), draws its figures, and writes a
table of every number that it prints: the thesis' value, that of an experiment where it quotes one,
ours with its stated error, and the exact one where it is known (docs/reproduce.md). Results are
index.html, table.csv, figures/ and studies/. Runs of an earlier call or of `verify` are not
repeated.
""",
    statuses="""\
0 done; 1 a run, a number or a figure failed (the last lines say which); 2 bad usage; 3 not
built; 130 interrupted: what is done is kept.""",
    example="""\
./wingcrack reproduce paper_b
./wingcrack reproduce paper_c --quick --out /tmp/paper_c
""",
)
def reproduce(given: SimpleNamespace) -> None:
    """Reproduce a paper of the thesis: scenes, studies, figures, printed numbers."""
    if given.paper not in _PAPERS:
        raise UsageError(f"there is no paper '{given.paper}' (there are: {', '.join(_PAPERS)})")
    name = given.paper + ("_quick" if given.quick else "")
    given.out = (given.out or Path("out") / name).resolve()
    if given.out.exists() and not given.out.is_dir():
        raise UsageError(f"results cannot go to {given.out}, which is a file")


@command(
    "bench",
    "wingcrack_verify.bench.cli:bench",
    _NAMES,
    Parameter("--repeat", "N", "runs of each but the longest; the median counts (3)", whole(1), 3),
    flag("--quick", "the short form, for CI"),
    flag("--instructions", "count instructions too"),
    flag("--store", "keep the counts to compare with"),
    Parameter("--against", "SOLVER", "another build of the solver to pair with", Path),
    Parameter("--out", "DIR", "for bench.json (default: out/bench)", Path, Path("out/bench")),
    Parameter("--solver", "SOLVER", "the solver that is measured", Path, _SOLVER),
    Parameter(
        "--baseline", "FILE", "the stored counts", Path, TOP / "tools" / "bench_baseline.json"
    ),
    about="""\
Measures the CPU time of scenes on one thread: median and spread of several runs, phases, the first
and the further steps, memory, and how cost grows with size; prints tables and writes bench.json.
The measurements are listed in tools/benchmarks.toml.

  --instructions  counts them with valgrind, and compares with what --store has kept in
                  tools/bench_baseline.json: more than 10 % above that is a loss
  --against       runs another build of the solver in turn with this one: a median of CPU times
                  more than 25 % above the other's is a loss
  --quick         the smallest scenes, whose instructions are counted: seconds. CI judges by these,
                  and only where compilers and libraries are those of the stored counts
""",
    statuses="""\
0 all measured; 1 a run failed, or a loss was found; 2 bad usage; 3 valgrind is not
there.""",
    example="""\
./wingcrack bench
./wingcrack bench b4 b6 --repeat 5
./wingcrack bench c1 --against /tmp/before/wingcrack-solver
""",
)
def bench(given: SimpleNamespace) -> None:
    """Measure how long scenes take, and where the time goes."""
    known, _ = load("wingcrack_verify.bench.catalogue:read_benchmarks")()
    for name in given.names:
        if name not in known:
            raise UsageError(f"there is no measurement '{name}' (there are: {', '.join(known)})")
    if given.out.exists() and not given.out.is_dir():
        raise UsageError(f"results cannot go to {given.out}, which is a file")
    if given.against is not None and not given.against.is_file():
        raise UsageError(f"there is no program {given.against} to compare with")
    if given.store and given.against is not None:
        raise UsageError("--store keeps counts, which --against does not make")
    if given.quick and given.names:
        raise UsageError("--quick has measurements of its own; leave out the names, or --quick")
    if not given.names:
        given.names = [name for name, entry in known.items() if entry.quick == given.quick]
        if not given.quick:
            given.names += [name for name, entry in known.items() if name == "b1"]


@command(
    "docs",
    "wingcrack_docs.cli:docs",
    flag("--serve", "show it to this machine's browsers until ctrl-C"),
    Parameter("--port", "N", "of --serve (default: 8000)", whole(1, 65535), 8000),
    flag("--no-fortran", "without the Fortran modules"),
    flag("--pictures", "make gallery and pictures again, no site"),
    Parameter("--out", "DIR", "where the site goes (default: build/site)", Path),
    about="""\
The site is in build/site; it asks no other machine for anything. Pages of the Fortran modules are
made by FORD, and made again only when a module has changed. docs/input.md, output.md and limits.md
are first written again from post/wingcrack/names.json.

--pictures runs the scenes of inputs/ and those of the tutorial (minutes; what has run is not run
again) and writes docs/gallery.md and docs/pictures, which are kept with the sources.
""",
    example="./wingcrack docs --serve --no-fortran\n",
)
def docs(given: SimpleNamespace) -> None:
    """Build the documentation as a site."""
    if given.pictures and (given.serve or given.out):
        raise UsageError("--pictures writes into docs/, so --serve and --out do not go with it")
    if given.out is not None and given.out.exists() and not given.out.is_dir():
        raise UsageError(f"the site cannot go to {given.out}: it is no folder")


# Steps of a developer: understood here, done by the launcher (tools/*.sh).


@command(
    "test",
    "",
    _NAMES,
    about="""\
Checks formats and linters, then builds and runs all tests: CTest on the debug build (bounds and
initialisation checked), CTest on the release build, pytest. With names, only the linters, CTests
and pytests that have one of them in their name or are in a file of that name; compiled tests are
built as far as they are run. At the end it lists the tests that were skipped, with the reasons.

With CI=true in the environment, warnings of the compilers are errors, and what optional tests take
is installed as far as it is small: MPI, valgrind, poppler-utils, EGL. With WINGCRACK_ALL_TESTS=1 a
browser is installed, too, and a test that is skipped is a failure.
""",
    example="""\
./wingcrack test
./wingcrack test test_scene_faults command_line
""",
)
def test(given: SimpleNamespace) -> None:
    """Run all tests and linters, or those with a NAME in theirs."""


@command(
    "build",
    "",
    flag("--debug", "in build/debug: bounds, pointers and initialisation are checked at run time"),
    about="""\
Builds the program, the verification programs and all tests in build/release, and shows what the
compilers say.
""",
    example="./wingcrack build --debug\n",
)
def build(given: SimpleNamespace) -> None:
    """Build everything and show the compilers' warnings."""


@command(
    "format",
    "",
    about="Fortran with fprettify, C++ with clang-format, Python with ruff.\n",
    example="./wingcrack format\n",
)
def format_sources(given: SimpleNamespace) -> None:
    """Format all sources in place."""


@command(
    "lint",
    "",
    about="""\
shellcheck, fprettify, dependencies of components, fortitude, clang-format, clang-tidy, ruff, mypy.
Changes nothing. One alone: ./wingcrack test mypy
""",
    example="./wingcrack lint\n",
)
def lint(given: SimpleNamespace) -> None:
    """Check formats and run the linters, without the tests."""
