"""The folder of a run: whose files stay, and who may write into it."""

from __future__ import annotations

import os
import re
import resource
import signal
import subprocess
import time
from pathlib import Path

import pytest
from system_scene import SCENE, SOLVER, call, record, start, varied

pytestmark = pytest.mark.usefixtures("program")

COMMENTED = "! somebody's scene\n" + SCENE


def contents(folder: Path) -> dict[str, bytes]:
    """Give every file of a folder."""
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("link", ["none", "symbolic", "hard", "folder"])
def test_a_run_never_replaces_its_own_scene(link: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    scene = out / "scene.nml"
    scene.write_text(COMMENTED)
    given, named_out = scene, out
    if link == "symbolic":
        given = tmp_path / "link.nml"
        given.symlink_to(scene)
    elif link == "hard":
        given = tmp_path / "link.nml"
        given.hardlink_to(scene)
    elif link == "folder":
        named_out = tmp_path / "elsewhere"
        named_out.symlink_to(out)
    done = call(tmp_path, "run", given, "--out", named_out)
    assert done.returncode == 2
    assert done.stderr == (
        f"wingcrack: the run would replace {given} by its own scene.nml: "
        f"name another folder than {named_out} with --out\n"
    )
    assert contents(out) == {str(scene): COMMENTED.encode()}


def limited(place: Path, bytes_per_file: int) -> subprocess.CompletedProcess[str]:
    """Run the scene where files cannot grow beyond a size, as on a full disk."""
    return subprocess.run(
        [SOLVER, "run", "small.nml", "--out", "out", "--quiet"],
        cwd=place,
        preexec_fn=lambda: resource.setrlimit(
            resource.RLIMIT_FSIZE, (bytes_per_file, bytes_per_file)
        ),
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("fault", ["refused", "full disk", "no memory for the mesh"])
def test_results_stay_until_there_are_new_ones(fault: str, tmp_path: Path) -> None:
    scene = tmp_path / "small.nml"
    scene.write_text(SCENE)
    assert call(tmp_path, "run", "small.nml", "--out", "out", "--no-plot").returncode == 0
    before = contents(tmp_path / "out")
    status = 1
    if fault == "refused":
        scene.write_text(varied(("poisson = 0.2", "poisson = 0.5")))
        done = call(tmp_path, "run", "small.nml", "--out", "out")
        status = 2
    elif fault == "full disk":
        done = limited(tmp_path, 100)
        assert "cannot write out/scene.nml" in done.stderr
    else:
        fine = "size_fracture = 0.012, size_boundary = 0.012"
        scene.write_text(varied(("size_fracture = 0.02, size_boundary = 0.25", fine)))
        done = subprocess.run(
            ["bash", "-c", f"ulimit -v 440000; {SOLVER} run small.nml --out out --quiet"],
            cwd=tmp_path,
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            check=False,
        )
        assert "not enough memory" in done.stderr
    assert done.returncode == status
    assert contents(tmp_path / "out") == before


def test_a_second_run_into_a_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "small.nml").write_text(SCENE)
    (tmp_path / "long.nml").write_text(varied(("end = 18000.0", "end = 1.0e9")))
    first: list[str | Path] = [SOLVER, "run", "long.nml", "--out", "out", "--quiet"]
    with subprocess.Popen(first, cwd=tmp_path, stderr=subprocess.DEVNULL) as process:
        deadline = time.monotonic() + 60
        while not (tmp_path / "out" / "scene.nml").exists():
            assert time.monotonic() < deadline
            time.sleep(0.02)
        done = call(tmp_path, "run", "small.nml", "--out", "out", "--quiet")
        assert process.poll() is None
        process.kill()
    assert done.returncode == 2
    assert re.fullmatch(
        rf"wingcrack: another run \(process {process.pid}\) writes into out: "
        r"wait for its end, or name another folder with --out\n",
        done.stderr,
    )
    # One that was killed holds nothing.
    assert call(tmp_path, "run", "small.nml", "--out", "out", "--no-plot").returncode == 0
    assert record(tmp_path / "out")["status"] == "finished"


def test_a_stopped_run_gives_its_folder_back(tmp_path: Path) -> None:
    (tmp_path / "long.nml").write_text(varied(("end = 18000.0", "end = 1.0e9")))
    with start(tmp_path, "run", "long.nml", "--out", "out", "--quiet") as process:
        while not (tmp_path / "out" / "scene.nml").exists() and process.poll() is None:
            time.sleep(0.02)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
    assert process.returncode == 143
    (tmp_path / "small.nml").write_text(SCENE)
    assert call(tmp_path, "run", "small.nml", "--out", "out", "--no-plot").returncode == 0
