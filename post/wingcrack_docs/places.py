"""Where things are in the tree."""

from __future__ import annotations

from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
DOCS = TOP / "docs"
SCENES = TOP / "inputs"
PICTURES = DOCS / "pictures"
SITE = TOP / "build" / "site"
FORTRAN_PAGES = TOP / "build" / "fortran_pages"
CONFIGURATION = TOP / "mkdocs.yml"
