"""Pages of the Fortran modules, made by FORD."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

from wingcrack_docs.places import FORTRAN_PAGES, TOP, DocsError

_SETTINGS = """\
project: wingcrack
summary: The modules of the solver. Modules of a component begin with its name.
author: The wingcrack developers
src_dir: {sources}
exclude_dir: {sources}/*/tests
output_dir: {pages}
preprocess: false
graph: false
search: false
source: false
incl_src: false
print_creation_date: false
display: public
quiet: true
---
The components and how they use each other are explained on the page
[Architecture](../architecture.html).
"""
_MATHS = re.compile(r"<script[^>]*(?:x-mathjax-config|MathJax\.js)[^>]*>.*?</script>", re.DOTALL)
_GUARDS = re.compile(r'\s+(?:integrity="[^"]*"|crossorigin="[^"]*")')
_BOOTSTRAP = re.compile(r'https://[^"]*/(css|js)/(bootstrap[^"/]*)')
_THEIRS = ("css/bootstrap.min.css", "js/bootstrap.bundle.min.js")


def make_fortran_pages() -> bool:
    """Make the pages unless they are newer than every module; return whether they were made.

    Raises `DocsError` if FORD fails.
    """
    sources = TOP / "fortran"
    index = FORTRAN_PAGES / "index.html"
    newest = max(path.stat().st_mtime for path in (*sources.rglob("*.f90"), Path(__file__)))
    if index.is_file() and index.stat().st_mtime > newest:
        return False
    new = FORTRAN_PAGES.with_name("fortran_pages_new")
    shutil.rmtree(new, ignore_errors=True)
    new.parent.mkdir(parents=True, exist_ok=True)
    settings = new.with_suffix(".md")
    settings.write_text(_SETTINGS.format(sources=sources, pages=new), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "ford", str(settings)], capture_output=True, text=True, check=False
    )
    if done.returncode != 0 or not (new / "index.html").is_file():
        words = (done.stderr or done.stdout).strip().splitlines()
        raise DocsError(f"FORD failed: {words[-1] if words else 'it gave no reason'}")
    keep_at_home(new)
    shutil.rmtree(FORTRAN_PAGES, ignore_errors=True)
    new.rename(FORTRAN_PAGES)
    return True


def keep_at_home(pages: Path) -> None:
    """Let pages of FORD ask no other machine for anything.

    Bootstrap comes from MkDocs, which brings the same one; there is no mathematics to set.
    """
    import mkdocs

    theme = Path(mkdocs.__file__).parent / "themes" / "mkdocs"
    for name in _THEIRS:
        shutil.copy(theme / name, pages / name)
    for page in pages.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        home = "../" * (len(page.relative_to(pages).parts) - 1) or "./"
        text = _GUARDS.sub("", _MATHS.sub("", text))
        page.write_text(_BOOTSTRAP.sub(rf"{home}\1/\2", text), encoding="utf-8")
