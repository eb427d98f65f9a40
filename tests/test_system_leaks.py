"""Memory that nothing refers to any more when a run ends, by LeakSanitizer before the program."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from system_scene import GROWING, SCENE, TOP, bare

pytestmark = pytest.mark.usefixtures("program")

SCENES = {
    "two levels": SCENE,
    "growth": GROWING,
    "mechanics": (TOP / "inputs/paper_b/edge_mode1.nml").read_text(),
}


@pytest.fixture(scope="module")
def sanitizer() -> str:
    """Give the library, which belongs to the compiler."""
    asked = ["gcc", "-print-file-name=liblsan.so"]
    path = subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()
    if not Path(path).is_file():
        pytest.skip("the compiler has no LeakSanitizer")
    return path


@pytest.mark.parametrize("scene", SCENES)
def test_a_run_loses_no_memory(scene: str, sanitizer: str, tmp_path: Path) -> None:
    (tmp_path / "small.nml").write_text(SCENES[scene])
    variables = {"LD_PRELOAD": sanitizer, "LSAN_OPTIONS": "log_threads=1"}
    done = bare(tmp_path, "run", "small.nml", "--out", "out", "--quiet", **variables)
    assert "Processing thread" in done.stderr  # it has looked
    assert "leak" not in done.stderr, done.stderr
    assert done.returncode == 0
