"""`wingcrack view` in a browser without a window: Chromium, driven by selenium."""

from __future__ import annotations

import os
import re
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wingcrack
from synthetic_run import STEPS, times
from test_browser_server import cut_series, served

_PATIENCE = 60.0  # [s]
_BROWSERS = ("chromium", "chromium-browser", "google-chrome")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Give a browser; the tests are left out where there is none."""
    selenium = pytest.importorskip(
        "selenium.webdriver", reason="selenium is not installed (requirements_browser.txt)"
    )
    program = next(filter(None, map(shutil.which, _BROWSERS)), None)
    driver = shutil.which("chromedriver")
    if program is None or driver is None:
        pytest.skip("chromium or chromedriver is not installed (Debian: chromium-driver)")
    options = selenium.ChromeOptions()
    options.binary_location = program
    for argument in ("--headless=new", "--disable-gpu", "--hide-scrollbars"):
        options.add_argument(argument)
    if os.geteuid() == 0:
        options.add_argument("--no-sandbox")  # root has none
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    found = selenium.Chrome(options=options, service=selenium.ChromeService(driver))
    yield found
    found.quit()


class Window:
    """The page of a run at a size of the window [px]."""

    def __init__(self, browser: Any, port: int, width: int = 1280, height: int = 800) -> None:
        self._browser = browser
        browser.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600},
        )
        browser.get(f"http://127.0.0.1:{port}/")
        self.wait(lambda: self.place() >= 0)

    def run(self, script: str, *arguments: Any) -> Any:
        """Give what a script returns."""
        return self._browser.execute_script(script, *arguments)

    def wait(self, holds: Callable[[], bool]) -> None:
        """Wait until something holds."""
        until = time.monotonic() + _PATIENCE
        while not holds():
            assert time.monotonic() < until, self.text("note") or self.text("moment")
            time.sleep(0.05)

    def wait_for(self, place: int) -> None:
        """Wait until the map shows this state."""
        self.wait(lambda: self.place() == place)

    def text(self, name: str) -> str:
        """Words of a part of the page."""
        return str(self.run("return document.getElementById(arguments[0]).textContent", name))

    def place(self) -> int:
        """Number of the state that the map shows, -1 before the first."""
        return int(self.run("return document.body.dataset.place ?? -1"))

    def choose(self, name: str, value: Any) -> None:
        """Give a list or the slider another value."""
        self.run(
            "const part = document.getElementById(arguments[0]); part.value = arguments[1];"
            "part.dispatchEvent(new Event(part.type === 'range' ? 'input' : 'change'))",
            name,
            value,
        )

    def click(self, name: str) -> None:
        """Press a button."""
        self._browser.find_element("id", name).click()

    def point_near_middle(self) -> str:
        """Point a few pixels beside the middle of the map, and give what the page says."""
        from selenium.webdriver import ActionChains

        chart = self._browser.find_element("id", "chart")
        plot = self._browser.find_element("id", "map")
        # the room for the axes is wider at the left and below (map.js)
        ActionChains(self._browser).move_to_element(chart).move_to_element_with_offset(
            plot, 21 + 9, -14 - 4
        ).perform()
        return self.text("here")

    def colours(self) -> int:
        """How many colours the map has."""
        return int(
            self.run(
                "const map = document.getElementById('map');"
                "const found = map.getContext('2d').getImageData(0, 0, map.width, map.height);"
                "return new Set(new Uint32Array(found.data.buffer)).size"
            )
        )

    def complaints(self) -> list[str]:
        """Errors that the browser has noted."""
        log = self._browser.get_log("browser")
        return [entry["message"] for entry in log if entry["level"] == "SEVERE"]

    def hosts(self) -> set[str]:
        """Whom the page has asked."""
        entries = self.run("return performance.getEntriesByType('resource').map((one) => one.name)")
        return {entry.split("/")[2].split(":")[0] for entry in entries}


def cell_pressure(run: Path, place: int, x: float, y: float) -> float:
    """Pressure of the cell around a place [Pa]."""
    found = wingcrack.open(run).fields(times()[place])
    a, b, c = np.moveaxis(found.points[found.triangles], 1, 0)
    sides = np.stack((b - a, c - a), axis=2)
    share = np.linalg.solve(sides, (np.array([x, y]) - a)[:, :, None])[:, :, 0]
    inside = np.column_stack((share, 1.0 - share.sum(axis=1))).min(axis=1)
    return float(found.rock["pressure"][np.argmax(inside)])


def test_states_fields_and_values(browser: Any, wet_run: Path) -> None:
    with served(wet_run) as page:
        window = Window(browser, page.port)
        assert window.place() == STEPS - 1
        assert window.text("title") == "synthetic: one fracture / two wings"
        assert window.text("moment") == f"time {times()[-1] / 3600:.4g} h, {STEPS} of {STEPS}"
        assert window.colours() > 20
        for place in (0, STEPS // 2):
            window.choose("slider", place)
            window.wait_for(place)
            here = window.point_near_middle()
            x, y, pressure = re.findall(r"[-\d.]+", here.partition("=")[2])[:3]
            expected = cell_pressure(wet_run, place, float(x), float(y)) / 1e6
            assert float(pressure) == pytest.approx(expected, abs=0.001)
            assert " · flaw, " in here
        window.choose("field", "stress.xx")
        window.wait(lambda: window.run("return document.body.dataset.field") == "stress.xx")
        assert "stress, xx -20 MPa" in window.point_near_middle()
        assert window.text("label") == "stress, xx [MPa]"
        window.choose("column", "max_slip_m")
        assert window.complaints() == []
        assert window.hosts() == {"127.0.0.1"}


def test_views_and_playing(browser: Any, wet_run: Path) -> None:
    with served(wet_run) as page:
        window = Window(browser, page.port)
        before = window.text("ticks")
        window.choose("range", "view")
        window.wait(lambda: window.text("ticks") != before)
        whole = window.text("ticks")
        window.click("near")
        assert window.text("ticks") != whole
        window.click("whole")
        assert window.text("ticks") == whole
        for _ in range(40):
            window.run("document.getElementById('closer').click()")  # stops where cells are large
        assert window.colours() > 1
        for _ in range(90):
            window.run("document.getElementById('farther').click()")
        assert window.colours() > 1
        window.click("play")
        window.wait(lambda: window.place() < STEPS - 1)
        window.wait(lambda: window.text("play") == "▶")
        assert window.place() == STEPS - 1
        assert window.complaints() == []


def test_events_appear_when_they_have_happened(browser: Any, own_run: Path) -> None:
    middle = 0.5 * (times()[2] + times()[3])
    (own_run / "events.csv").write_text(
        f"time_s,kind,fracture,x_m,y_m,detail\n{middle},arrest,1,1.0,1.0,far\n", encoding="utf-8"
    )
    with served(own_run) as page:
        window = Window(browser, page.port)
        for place, shows in ((2, False), (3, True)):
            window.choose("slider", place)
            window.wait_for(place)
            assert ("arrest" in window.text("legend")) == shows
        window.choose("events", "none")
        window.wait(lambda: "arrest" not in window.text("legend"))
        assert window.complaints() == []


def test_a_narrow_screen_needs_no_scrolling_sideways(browser: Any, wet_run: Path) -> None:
    with served(wet_run) as page:
        window = Window(browser, page.port, 390, 844)
        assert window.run("return document.documentElement.scrollWidth") <= 390
        assert window.run("return document.getElementById('map').clientWidth") > 300
        # the slider stays in sight
        assert (
            window.run("return document.getElementById('slider').getBoundingClientRect().top") < 844
        )


def test_a_run_that_goes_on_is_followed(browser: Any, own_run: Path) -> None:
    before = cut_series(own_run, 2)
    with served(own_run) as page:
        window = Window(browser, page.port)
        assert (window.place(), window.text("status")[:8]) == (1, "running:")
        whole = before.pop(own_run / "run.json")
        for path, series in before.items():
            path.write_bytes(series)
        window.wait_for(STEPS - 1)
        window.choose("slider", 4)  # who looks at an earlier state is left there
        window.wait_for(4)
        (own_run / "run.json").write_bytes(whole)
        window.wait(lambda: window.text("status") == "finished")
        assert window.place() == 4
        for path in own_run.glob("matrix_*"):
            path.unlink()
        window.choose("field", "displacement.x")
        window.choose("slider", 7)
        window.wait(lambda: "written again" in window.text("note"))
    assert wingcrack.open(own_run).status == "finished"
