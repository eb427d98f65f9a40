"""Many drawings in one page: common parts are stored once, with numbers rounded to visible digits.

matplotlib writes the shapes of all letters into every drawing, a style at every line, and places
to a millionth of a point. That is three quarters of a drawing and more.
"""

from __future__ import annotations

import html
import re
import xml.etree.ElementTree as ElementTree

_SPACE = "{http://www.w3.org/2000/svg}"
_LINK = "{http://www.w3.org/1999/xlink}href"
_NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")
_AROUND_COMMANDS = re.compile(r"\s*([A-Za-z])\s*")
_DROPPED = ("metadata", "style", "title")
_SHAPED = ("d", "x", "y", "width", "height", "transform", "points", "cx", "cy", "r")


class Sheet:
    """What the drawings of a page share; taken in drawing by drawing, then written once."""

    def __init__(self) -> None:
        self._shapes: dict[str, str] = {}
        self._styles: dict[str, str] = {}

    def take(self, svg: bytes, title: str) -> str:
        """Give a drawing as a part of the page; its `title` is for those who cannot see it."""
        root = ElementTree.fromstring(svg)
        names: dict[str, str] = {}
        for definitions in root.iter(f"{_SPACE}defs"):
            for shape in list(definitions):
                name = shape.attrib.pop("id", None)
                if name is not None:
                    names[name] = self._share(shape)
        inside = "".join(self._text(child, names) for child in root)
        box = root.attrib["viewBox"]
        _, _, width, height = box.split()
        return (
            f'<svg viewBox="{box}" width="{width}" height="{height}" role="img" '
            f'aria-label="{html.escape(title)}">{inside}</svg>'
        )

    def definitions(self) -> str:
        """What the drawings refer to, to stand anywhere in the page."""
        styles = "".join(f".{name}{{{style}}}" for style, name in self._styles.items())
        shapes = "".join(
            shape.replace(" ", f' id="{name}" ', 1) for shape, name in self._shapes.items()
        )
        return (
            f"<style>{styles}</style>"
            f'<svg width="0" height="0" style="position:absolute"><defs>{shapes}</defs></svg>'
        )

    def _share(self, shape: ElementTree.Element) -> str:
        return self._shapes.setdefault(self._text(shape, {}), f"d{len(self._shapes)}")

    def _text(self, element: ElementTree.Element, names: dict[str, str]) -> str:
        """Element without what is not seen; `names` are the new ones of what it refers to."""
        tag = element.tag.removeprefix(_SPACE)
        if tag in (*_DROPPED, "defs"):
            return ""
        attributes = self._attributes(element, names)
        inside = "".join(self._text(child, names) for child in element)
        if tag == "g" and not attributes:
            return inside
        end = f">{inside}</{tag}>" if inside else "/>"
        # a blank even where there is no attribute: the name of a shared one is put there
        return f"<{tag} {attributes}{end}"

    def _attributes(self, element: ElementTree.Element, names: dict[str, str]) -> str:
        found = []
        for name, value in element.attrib.items():
            if name == "id":
                continue
            if name == _LINK:
                name = "href"
                value = f"#{names[value[1:]]}" if value.startswith("#") else value
            elif name == "clip-path":
                value = f"url(#{names[value[5:-1]]})"
            elif name == "style":
                name, value = "class", self._style(value)
            elif name in _SHAPED:
                value = _shortened(value)
            found.append(f'{name}="{html.escape(value)}"')
        return " ".join(found)

    def _style(self, style: str) -> str:
        short = re.sub(r"\s*([:;])\s*", r"\1", style).rstrip(";")
        return self._styles.setdefault(short, f"s{len(self._styles)}")


def _shortened(numbers: str) -> str:
    """Numbers to a hundredth of a point, small ones to four digits."""
    return _AROUND_COMMANDS.sub(r"\1", _NUMBER.sub(_short, numbers)).strip()


def _short(match: re.Match[str]) -> str:
    value = float(match[0])
    text = f"{value:.2f}".rstrip("0").rstrip(".") if abs(value) >= 1.0 else f"{value:.4g}"
    return "0" if text == "-0" else text
