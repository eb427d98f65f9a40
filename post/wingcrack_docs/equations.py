"""Equations of the pages: blocks of LaTeX as MathML, which browsers draw without a script."""

from __future__ import annotations

from typing import Any

from latex2mathml.converter import convert


def fence(source: str, language: str, css_class: str, *_rest: Any, **_kwargs: Any) -> str:
    """HTML of a block ``math`` (the format of a custom fence of pymdownx.superfences)."""
    del language
    lines = [line for line in source.split("\n\n") if line.strip()]
    drawn = "".join(convert(line, display="block") for line in lines)
    return f'<div class="{css_class}">{drawn}</div>'
