"""Checkpoints with a right checksum and wrong values are refused, or the run fails or goes on."""

from __future__ import annotations

import random
import shutil
import struct
import subprocess
import zlib
from pathlib import Path

import pytest
from system_scene import GROWING, SOLVER, varied

from wingcrack.runs.checkpoint import entry_places

pytestmark = pytest.mark.usefixtures("program")

EVERY_STATE = "\n&scene name = 'a_run' /\n&output checkpoint_states = 1, vtu = .false. /\n"
SCENES = {
    "steps": varied(("end = 18000.0", "end = 7200.0")),
    "growth": GROWING.replace("stop_gain = 0.015", "stop_gain = 0.002"),
}
FORGERIES = {"steps": 50, "growth": 25}
WRONG = {
    "r8": [struct.pack("<d", x) for x in (0.0, -1.0, 1e300, float("nan"), float("inf"))],
    "i4": [struct.pack("<i", i) for i in (0, -1, 1, 2, 1000, 2**31 - 1, -(2**31))],
    "n8": [struct.pack("<q", i) for i in (0, -1, 1, 2, 10**9)],
}


def forged(body: bytes, source: random.Random) -> tuple[str, bytes]:
    """Change a value of an entry, or remove all its values or the last part of them."""
    places = [
        place
        for place in entry_places(body)
        if place.kind != "g0" and not place.name.startswith(("about/", "texts/"))
    ]
    place = source.choice(places)
    wrong = WRONG.get(place.kind, WRONG["i4"])
    size = len(wrong[0])
    count = (place.end - place.values) // size
    values = body[place.values : place.end]
    shape = place.shape
    how = source.choice(("value", "value", "none", "fewer"))
    if how == "none" and shape:
        head, values = body[: place.rank] + struct.pack("<i", -1), b""
    elif how == "fewer" and shape and shape[-1] > 0:
        head = body[: place.values - 8] + struct.pack("<q", shape[-1] - 1)
        values = values[: len(values) // shape[-1] * (shape[-1] - 1)]
    else:
        head = body[: place.values]
        if count > 0:
            at = size * source.randrange(count)
            values = values[:at] + source.choice(wrong) + values[at + size :]
    return f"{how} of {place.name}", head + values + body[place.end :]


@pytest.mark.parametrize("name", list(SCENES))
def test_no_forged_checkpoint_ends_the_program(name: str, tmp_path: Path) -> None:
    def solver(*words: str | Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [SOLVER, "run", *words, "--quiet"],
            capture_output=True,
            text=True,
            check=False,
            errors="replace",
            timeout=60,
        )

    (tmp_path / "scene.nml").write_text(SCENES[name] + EVERY_STATE)
    base = tmp_path / "base"
    assert solver(tmp_path / "scene.nml", "--out", base).returncode == 0
    body = (base / "checkpoint_old.bin").read_bytes()[32:]
    (base / "checkpoint.bin").unlink()
    (base / "checkpoint_old.bin").unlink()
    source = random.Random(name)
    for number in range(FORGERIES[name]):
        what, wrong = forged(body, source)
        run = shutil.copytree(base, tmp_path / str(number))
        head = struct.pack("<qq", len(wrong), zlib.crc32(wrong))
        (run / "checkpoint.bin").write_bytes(b"wingcrack state\n" + head + wrong)
        done = solver("--restart", run)
        assert done.returncode in {0, 1, 2}, f"{what}: {done.stderr}"
        assert "runtime error" not in done.stderr, f"{what}: {done.stderr}"
        shutil.rmtree(run)
