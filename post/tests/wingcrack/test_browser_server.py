"""`wingcrack view`: what the server gives, to whom, and how it ends."""

from __future__ import annotations

import http.client
import json
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from threading import Thread
from typing import Any
from urllib.parse import urlencode

import numpy as np
import numpy.typing as npt
import pytest

import wingcrack
from synthetic_run import HOUR, STEPS, fracture_cells, times, well_pressure
from wingcrack.command_line import main
from wingcrack.runs.fields import read_fields
from wingcrack.view import content
from wingcrack.view.content import Content
from wingcrack.view.server import serve

POST = Path(__file__).resolve().parents[2]
_KINDS = {"Float32Array": "<f4", "Float64Array": "<f8", "Uint32Array": "<u4", "Uint8Array": "u1"}


class Page:
    """A served run, asked as a browser would."""

    def __init__(self, port: int) -> None:
        self.port = port

    def get(self, path: str, host: str | None = None, **query: Any) -> tuple[int, bytes]:
        """Status and message."""
        answer, body = self.answer(path, host, **query)
        return answer.status, body

    def answer(
        self, path: str, host: str | None = None, method: str = "GET", **query: Any
    ) -> tuple[http.client.HTTPResponse, bytes]:
        """Give the whole answer."""
        line = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30.0)
        name = f"127.0.0.1:{self.port}" if host is None else host
        line.request(method, f"{path}?{urlencode(query)}", headers={"Host": name})
        answer = line.getresponse()
        body = answer.read()
        line.close()
        return answer, body

    def json(self, path: str, **query: Any) -> Any:
        """Give what was asked for in JSON."""
        status, body = self.get(path, **query)
        assert status == 200, body
        return json.loads(body)

    def arrays(self, path: str, **query: Any) -> tuple[Any, dict[str, npt.NDArray[Any]]]:
        """Head and arrays."""
        status, body = self.get(path, **query)
        assert status == 200, body
        return unpack(body)

    def why(self, path: str, **query: Any) -> tuple[int, str]:
        """Status and reason of what is refused."""
        status, body = self.get(path, **query)
        return status, json.loads(body)["why"]


def unpack(message: bytes) -> tuple[Any, dict[str, npt.NDArray[Any]]]:
    """Take a message apart as the page does, which needs every array at a multiple of eight."""
    begin = 4 + int.from_bytes(message[:4], "little")
    head = json.loads(message[4:begin])
    arrays = {}
    for name, (kind, offset, size) in head["arrays"].items():
        assert (begin + offset) % 8 == 0
        arrays[name] = np.frombuffer(message, _KINDS[kind], size, begin + offset)
    return head, arrays


@contextmanager
def served(directory: Path) -> Iterator[Page]:
    with serve(Content(directory), 0) as server:
        thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        try:
            yield Page(server.server_address[1])
        finally:
            server.shutdown()
            thread.join()


@pytest.fixture(scope="module")
def page(wet_run: Path) -> Iterator[Page]:
    with served(wet_run) as found:
        yield found


def test_overview_says_what_there_is(page: Page) -> None:
    run = page.json("/overview")
    assert (run["status"], run["field"], run["column"]) == (
        "finished",
        "pressure",
        "well_pressure_pa",
    )
    assert run["moment"] == {"name": "time", "unit": "h", "size": HOUR}
    assert np.allclose(run["moments"], times())
    assert run["origin"] == [1.0, 1.0]
    assert ["pressure", "pore pressure"] in run["fields"]
    assert [name for name, _ in run["states"]] == ["stick", "slip", "open"]
    assert list(run["fractures"].values()) == ["flaw"]
    assert len(set(run["stamps"])) == len(run["moments"])


def test_events_of_growth_and_slip(own_run: Path) -> None:
    events = own_run / "events.csv"
    events.write_text(events.read_text() + f"{HOUR},arrest,1,1.5,0.5,far\n")
    (own_run / "slip_events.csv").write_text(
        "time_s,end_s,kind,fracture,x_m,y_m,moment_nm,magnitude\n"
        f"0,{HOUR},aseismic,1,1,1,1e9,-0.07\n0,{2 * HOUR},seismic,1,1,0.75,1e12,1.93\n"
    )
    with served(own_run) as page:
        found = page.json("/overview")["events"]
    assert [row[:5] for row in found] == [
        ["aseismic slip", 0.0, 0.0, HOUR, 0.0],
        ["seismic event", 0.0, -0.25, 2 * HOUR, 1.0],
        ["arrest", 0.5, -0.5, HOUR, 0.0],
    ]
    assert found[1][5] == "seismic slip, moment 1e+12 N m, magnitude 1.93"


def test_a_run_without_fluid_has_no_pressure(dry_run: Path) -> None:
    with served(dry_run) as page:
        run = page.json("/overview")
        assert (run["field"], run["column"]) == ("stress.mean", "fracture_length_m")
        assert all(name != "pressure" for name, _ in run["fields"])
        assert page.why("/state", place=0, field="pressure", stamp=run["stamps"][0])[0] == 404


def test_numbers_are_those_of_the_files(page: Page, wet_run: Path) -> None:
    run = page.json("/overview")
    place = len(run["moments"]) - 1
    query = {"place": place, "stamp": run["stamps"][place]}
    found = wingcrack.open(wet_run).fields()
    head, state = page.arrays("/state", field="pressure", **query)
    name, mesh = page.arrays("/mesh", **query)
    assert name["mesh"] == head["mesh"]
    assert np.array_equal(state["values"], found.rock["pressure"].astype(np.float32))
    assert np.allclose(mesh["points"].reshape(-1, 2) + 1.0, found.points)
    assert np.array_equal(mesh["triangles"].reshape(-1, 3), found.triangles)
    assert np.allclose(state["segments"].reshape(-1, 2, 2) + 1.0, found.segments)
    assert np.array_equal(state["states"], found.fractures["state"])
    assert head["columns"][:3] == [["opening", "m"], ["slip", "m"], ["pressure", "Pa"]]
    slip = state["on_fractures"].reshape(len(head["columns"]), -1)[1]
    assert np.allclose(slip, fracture_cells(STEPS - 1).jump_t)
    scale = page.json("/scale", field="pressure")
    assert scale["unit"] == "MPa"
    assert scale["high"] == pytest.approx(state["values"].max() / 1e6, rel=1e-6)
    assert len(scale["colours"]) == len(scale["plain"]) == 3 * 256
    title, history = page.arrays("/history", column="well_pressure_pa")
    assert title["label"] == "well pressure [MPa]"
    assert np.allclose(history["moments"], times())
    assert np.allclose(history["values"], [well_pressure(k) / 1e6 for k in range(STEPS)])


def test_coordinates_of_a_survey_keep_their_digits(
    wet_run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    away = np.array([512345.0, 6712345.0])

    def far(*given: Any) -> Any:
        found = read_fields(*given)
        return replace(found, points=found.points + away, segments=found.segments + away)

    monkeypatch.setattr(content, "read_fields", far)
    run = Content(wet_run)
    overview = json.loads(run.overview())
    assert np.allclose(overview["origin"], away + 1.0)
    _, mesh = unpack(run.mesh(0, overview["stamps"][0]))
    near = wingcrack.open(wet_run).fields(0.0).points - 1.0
    assert np.abs(mesh["points"].reshape(-1, 2) - near).max() < 1e-6


@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:80", "127.0.0.1.evil.example:8040", "localhost.evil", "", ":"],
)
@pytest.mark.parametrize("path", ["/", "/overview"])
def test_other_hosts_are_refused(page: Page, path: str, host: str) -> None:
    status, body = page.get(path, host)
    assert (status, json.loads(body)["why"]) == (421, "this page is for this machine only")


@pytest.mark.parametrize("host", ["localhost", "localhost:9999", "127.0.0.1", "127.0.0.1:80"])
def test_this_machine_is_welcome_through_a_tunnel_too(page: Page, host: str) -> None:
    assert page.get("/overview", host)[0] == 200


def test_only_this_machine_reaches_the_port(page: Page) -> None:
    with socket.socket() as other:
        other.settimeout(5.0)
        # 127.0.0.2 is this machine too, and shows to which address the port is bound
        assert other.connect_ex(("127.0.0.2", page.port)) != 0


def test_pages_of_other_hosts_cannot_use_what_they_fetch(page: Page) -> None:
    answer, _ = page.answer("/overview")
    assert answer.headers["Content-Security-Policy"].startswith("default-src 'self'")
    assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"
    assert "Access-Control-Allow-Origin" not in answer.headers
    for file in (POST / "wingcrack" / "view" / "page").iterdir():
        text = file.read_text(encoding="utf-8").replace("http://www.w3.org/2000/svg", "")
        assert not re.search(r"https?://|//[a-z]+\.[a-z]+/", text), file


@pytest.mark.parametrize(
    ("path", "query", "status", "why"),
    [
        ("/nothing", {}, 404, "there is nothing at /nothing"),
        ("/../server.py", {}, 404, "there is nothing at /../server.py"),
        ("/page/main.js", {}, 404, "there is nothing"),
        ("/state", {}, 400, "is no request of this page"),
        ("/state", {"place": "x", "field": "pressure", "stamp": "a"}, 400, "is no request"),
        ("/state", {"place": 99, "field": "pressure", "stamp": "a"}, 404, "there is no state 99"),
        ("/state", {"place": -1, "field": "pressure", "stamp": "a"}, 404, "there is no state -1"),
        ("/state", {"place": 0, "field": "pressure", "stamp": "old"}, 404, "written again"),
        ("/scale", {"field": "heat"}, 404, "the rock has no field 'heat'"),
        ("/scale", {"field": "stress"}, 404, "'stress' needs one of stress.xx"),
        ("/history", {"column": "nothing"}, 503, "there is no column 'nothing'"),
    ],
)
def test_what_is_not_there_is_said(
    page: Page, path: str, query: dict[str, Any], status: int, why: str
) -> None:
    page.json("/overview")
    found = page.why(path, **query)
    assert found[0] == status
    assert why in found[1]


def test_nothing_can_be_sent(page: Page) -> None:
    assert page.answer("/overview", method="POST")[0].status == 501


def test_states_are_kept_by_the_browser_and_lists_are_not(page: Page) -> None:
    run = page.json("/overview")
    query = {"place": 0, "field": "pressure", "stamp": run["stamps"][0]}
    assert "immutable" in page.answer("/state", **query)[0].headers["Cache-Control"]
    assert page.answer("/overview")[0].headers["Cache-Control"] == "no-store"


def test_a_browser_that_goes_away_is_no_news(
    page: Page, capsys: pytest.CaptureFixture[str]
) -> None:
    for sent in (b"", b"GET /overview HTTP/1.1\r\nHost: localhost\r\n\r\n", b"\0\xff nonsense\r\n"):
        with socket.create_connection(("127.0.0.1", page.port)) as line:
            # with what is not read yet: the other side hears of a reset
            line.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            line.sendall(sent)
    assert page.json("/overview")["status"] == "finished"
    assert capsys.readouterr().err == ""


def cut_series(directory: Path, count: int) -> dict[Path, bytes]:
    """Leave the first states only, and no record: a run that goes on. Gives what was there."""
    before = {directory / name: (directory / name).read_bytes() for name in ("run.json",)}
    (directory / "run.json").unlink()
    for name in ("matrix.pvd", "fractures.pvd"):
        path = directory / name
        before[path] = path.read_bytes()
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        entries = [line for line in lines if "<DataSet" in line]
        path.write_text(
            "".join(line for line in lines if line not in entries[count:]), encoding="utf-8"
        )
    return before


def test_a_run_that_goes_on_brings_new_states(own_run: Path) -> None:
    before = cut_series(own_run, 3)
    with served(own_run) as page:
        run = page.json("/overview")
        assert (run["status"], len(run["moments"])) == ("running", 3)
        for path, whole in before.items():
            path.write_bytes(whole)
        run = page.json("/overview")
        assert (run["status"], len(run["moments"])) == ("finished", STEPS)
        assert page.json("/scale", field="pressure")["high"] > 0.0


def test_a_damaged_file_is_named_until_it_is_whole_again(own_run: Path) -> None:
    with served(own_run) as page:
        page.json("/overview")
        path = own_run / "matrix.pvd"
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) // 2])
        status, why = page.why("/overview")
        assert (status, "matrix.pvd: the file is no valid PVD collection" in why) == (503, True)
        path.write_bytes(whole)
        assert page.json("/overview")["status"] == "finished"
        shutil.rmtree(own_run)  # as a new run into the same folder does
        status, why = page.why("/overview")
        assert (status, "there is no such folder" in why) == (503, True)


def test_ctrl_c_ends_it_with_its_status(wet_run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "wingcrack", "view", str(wet_run), "--no-browser"],
        cwd=POST,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    ) as process:
        assert process.stdout is not None
        line = process.stdout.readline()
        found = re.fullmatch(
            rf"{re.escape(str(wet_run))} is shown at http://127\.0\.0\.1:(\d+)/;"
            r" Ctrl-C ends this\.\n",
            line,
        )
        assert found is not None, line
        assert Page(int(found[1])).get("/")[0] == 200
        assert main(["view", str(wet_run), "--port", found[1], "--no-browser"]) == 2
        why = capsys.readouterr().err
        assert f"port {found[1]} cannot be had (Address already in use)" in why
        process.send_signal(signal.SIGINT)
        out, error = process.communicate(timeout=60)
    assert (process.returncode, out, error) == (130, "", "")


@pytest.mark.parametrize(
    ("take", "why"),
    [
        ("*", "this folder contains no run"),
        ("matrix*", "has no fields to show"),
        ("matrix*.vtu", "the file is missing, though its PVD collection names it"),
        ("history.csv", "has no history.csv"),
    ],
)
def test_a_folder_without_what_it_shows_is_refused(
    own_run: Path, take: str, why: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for path in list(own_run.glob(take)):
        path.unlink()
    assert main(["view", str(own_run)]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.startswith("wingcrack view: ")
    assert why in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(("display", "opened"), [("", []), (":0", ["http://127.0.0.1:1/"])])
def test_a_browser_opens_where_there_is_a_display(
    display: str, opened: list[str], wet_run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    addresses: list[str] = []
    monkeypatch.setattr("webbrowser.open", addresses.append)
    monkeypatch.setattr("wingcrack.view.server.serve", lambda *_: _Ended())
    monkeypatch.setenv("DISPLAY", display)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert main(["view", str(wet_run)]) == 0
    assert addresses == opened


class _Ended:
    """A server that has been asked to end before its first request."""

    server_address = ("127.0.0.1", 1)

    def __enter__(self) -> None: ...

    def __exit__(self, *_: object) -> None: ...

    def serve_forever(self) -> None: ...
