"""Drawings that share what they have in common, and still show the same."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from wingcrack_verify.page import Sheet

POST = Path(__file__).resolve().parents[2]
_HEAD = (
    '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
    'viewBox="0 0 30 20">'
)


def svg(inside: str) -> bytes:
    return f"{_HEAD}{inside}</svg>".encode()


LETTER = '<defs><path id="{name}" d="M 1 2 \nL 3 4 \nz\n" transform="scale(0.015625)"/></defs>'
USE = '<g id="text_1"><use xlink:href="#{name}" x="1.000000" y="-0.000001"/></g>'


def test_the_same_shape_under_two_names_stands_once() -> None:
    sheet = Sheet()
    for name in ("DejaVuSans-13", "small-7"):
        drawn = sheet.take(svg((LETTER + USE).format(name=name)), "one")
        assert '<use href="#d0" x="1" y="-1e-06"/>' in drawn
    assert sheet.definitions().count('d="M1 2L3 4z"') == 1
    assert 'transform="scale(0.01562)"' in sheet.definitions()


def test_shapes_that_differ_stay_apart_under_one_name() -> None:
    sheet = Sheet()
    first = sheet.take(svg((LETTER + USE).format(name="a")), "one")
    second = sheet.take(svg((LETTER + USE).format(name="a").replace("3 4", "3 5")), "two")
    assert re.findall('href="#(d[0-9])"', first + second) == ["d0", "d1"]


def test_styles_and_clips_are_found_again() -> None:
    sheet = Sheet()
    drawn = sheet.take(
        svg(
            '<defs><clipPath id="p"><rect x="0" y="0" width="5" height="6"/></clipPath></defs>'
            '<path d="M 1.23456 -2.345678" clip-path="url(#p)" style="fill: none; stroke: #000"/>'
        ),
        "one",
    )
    assert '<path d="M1.23 -2.35" clip-path="url(#d0)" class="s0"/>' in drawn
    assert ".s0{fill:none;stroke:#000}" in sheet.definitions()
    assert '<clipPath id="d0" ><rect x="0" y="0" width="5" height="6"/>' in sheet.definitions()


def test_a_title_is_text_whatever_it_says() -> None:
    drawn = Sheet().take(svg('<path d="M 0 0"/>'), 'a "b" <script>')
    assert 'aria-label="a &quot;b&quot; &lt;script&gt;"' in drawn


@pytest.mark.parametrize("dropped", ["<metadata><a/></metadata>", "<title>x</title>", "<style/>"])
def test_what_is_not_seen_is_left_out(dropped: str) -> None:
    assert Sheet().take(svg(dropped), "x").endswith(">" + "</svg>")


def test_reading_cases_does_not_wait_for_what_draws() -> None:
    code = "import sys, wingcrack_verify.judge; assert 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], cwd=POST, check=True)
