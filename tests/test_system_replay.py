"""Runs take the decisions of another one from its record."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from system_scene import GROWING, SOLVER, varied

import wingcrack

pytestmark = pytest.mark.usefixtures("program")
TABLES = ("history.csv", "tips.csv", "fractures.csv", "wells.csv", "probes.csv", "network.json")


def solver(folder: Path, text: str, name: str) -> subprocess.CompletedProcess[str]:
    (folder / f"{name}.nml").write_text(text)
    return subprocess.run(
        [SOLVER, "run", folder / f"{name}.nml", "--out", folder / name, "--quiet"],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


def replaying(folder: Path, text: str = GROWING) -> str:
    return text.replace("&time ", f"&time replay = '{folder}', ")


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("replay")
    assert solver(folder, GROWING, "base").returncode == 0
    return folder / "base"


def test_a_run_replayed_by_itself_is_equal_bit_for_bit(base: Path, tmp_path: Path) -> None:
    done = solver(tmp_path, replaying(base), "again")
    assert done.returncode == 0, done.stderr
    for name in TABLES:
        assert (tmp_path / "again" / name).read_bytes() == (base / name).read_bytes(), name
    assert "left the record" not in (tmp_path / "again" / "run.log").read_text()


def test_differences_over_the_change_are_gradients(base: Path, tmp_path: Path) -> None:
    """Times of all states with 1e-7 and 3e-7 more toughness.

    On the short first segments after a jump the second derivative counts: gradients differ there
    from those at 1e-7 by 0.2 % at 3e-7, 0.7 % at 1e-6, 2 to 3 % at 3e-6, 9 to 14 % at 1e-5.
    """
    history = wingcrack.open(base).history
    toughness = wingcrack.open(base).scene["material.toughness"]
    gradients = []
    for change in (1e-7, 3e-7):
        text = replaying(base).replace(
            "toughness = 0.3e6", f"toughness = {toughness * (1.0 + change)!r}"
        )
        done = solver(tmp_path, text, f"tougher_{change}")
        assert done.returncode == 0, done.stderr
        other = wingcrack.open(tmp_path / f"tougher_{change}").history
        assert len(other) == len(history)
        gradients.append((other["time_s"] - history["time_s"]).to_numpy() / change)
    grown = np.abs(gradients[0]) > 1e-3 * np.abs(gradients[0]).max()
    assert grown.any()
    relative = np.abs(gradients[1][grown] / gradients[0][grown] - 1.0)
    assert relative.max() < 0.01


def test_a_run_that_leaves_the_record_says_so_and_goes_on(base: Path, tmp_path: Path) -> None:
    text = replaying(base).replace("rate = 5.0e-9", "rate = 2.5e-8")
    assert text != replaying(base)
    done = solver(tmp_path, text, "faster")
    assert done.returncode == 0, done.stderr
    events = wingcrack.open(tmp_path / "faster").events
    (detail,) = events.loc[events["kind"] == "replay", "detail"]
    assert detail.startswith("the replay has left the record: ")


@pytest.mark.parametrize(
    ("content", "said"),
    [(None, "has no record"), (b"", "is damaged"), (b"\1" * 100, "is damaged")],
)
def test_a_record_that_cannot_be_used_is_refused(
    tmp_path: Path, content: bytes | None, said: str
) -> None:
    (tmp_path / "other").mkdir()
    if content is not None:
        (tmp_path / "other" / "record.bin").write_bytes(content)
    done = solver(tmp_path, replaying(tmp_path / "other", varied()), "run")
    assert done.returncode == 2
    assert said in done.stderr
    assert not (tmp_path / "run").exists()


def test_a_cut_record_is_followed_up_to_its_last_whole_part(base: Path, tmp_path: Path) -> None:
    whole = (base / "record.bin").read_bytes()
    (tmp_path / "cut").mkdir()
    (tmp_path / "cut" / "record.bin").write_bytes(whole[: len(whole) // 2])
    done = solver(tmp_path, replaying(tmp_path / "cut"), "run")
    assert done.returncode == 0, done.stderr
    assert "left the record: it ends here" in (tmp_path / "run" / "events.csv").read_text()
