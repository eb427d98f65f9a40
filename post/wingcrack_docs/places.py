"""Where the documentation is in the tree, and its error."""

from __future__ import annotations

from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
DOCS = TOP / "docs"
SCENES = TOP / "inputs"
PICTURES = DOCS / "pictures"
SITE = TOP / "build" / "site"
FORTRAN_PAGES = TOP / "build" / "fortran_pages"
CONFIGURATION = TOP / "mkdocs.yml"


class DocsError(Exception):
    """Pages or pictures cannot be made; the message is one sentence for the user."""
