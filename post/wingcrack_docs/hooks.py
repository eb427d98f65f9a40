"""Settings of MkDocs in addition to mkdocs.yml: pages outside docs/, and targets of links.

The pages are written for the tree: README.md is the site's first page, scenes are files beside
them. Here each of them gets its place in the site, and links are changed to those places.
"""

from __future__ import annotations

import os.path
import shutil
import tomllib
from pathlib import Path, PurePosixPath
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

import wingcrack
from wingcrack_docs.links import change_links, is_elsewhere, resolve, to_python_markdown
from wingcrack_docs.places import FORTRAN_PAGES, TOP

_PAGES = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
}
_ALONE = ("LICENSE", "CITATION.cff")  # files that are offered as they are
_FOLDERS = ("inputs", "packaging")
_FORTRAN = "fortran/index.html"
_BOOST = 0.2  # of cases, scenes and the changelog in the search, the manual has 1


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Leave the Fortran modules out of the menu where there are no pages of them."""
    if not _with_fortran(config):
        config.nav = _without(config.nav, _FORTRAN)
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add what lies outside docs/."""
    for source, place in _PAGES.items():
        text = (TOP / source).read_text(encoding="utf-8")
        files.append(File.generated(config, place, content=text))
    for source in _offered():
        place = str(_place(PurePosixPath(source)))
        files.append(File.generated(config, place, abs_src_path=str(TOP / source)))
    for case in _cases():
        files.append(File.generated(config, f"cases/{case}.md", content=_case_page(case)))
    files.append(File.generated(config, "cases/index.md", content=_case_list()))
    files.append(File.generated(config, "python_api.md", content=_python_page()))
    if _with_fortran(config):
        index = str(FORTRAN_PAGES / "index.html")
        files.append(File.generated(config, _FORTRAN, abs_src_path=index))
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let links lead to the places in the site, and lists be lists."""
    del config, files
    place = PurePosixPath(page.file.src_uri)
    # the manual is what is looked for; of what is in the tree as it is every word is found, too
    if place.parts[0] in ("cases", "inputs") or place.name == "changelog.md":
        page.meta["search"] = {"boost": _BOOST}
    source = _source(place)
    if source is not None:
        markdown = change_links(markdown, lambda target: _relinked(source, place, target))
    return to_python_markdown(markdown)


def on_post_build(*, config: MkDocsConfig) -> None:
    """Put the pages of the Fortran modules with the others."""
    if _with_fortran(config):
        shutil.copytree(FORTRAN_PAGES, Path(config.site_dir) / "fortran", dirs_exist_ok=True)


def _with_fortran(config: MkDocsConfig) -> bool:
    return bool(config.extra.get("fortran")) and (FORTRAN_PAGES / "index.html").is_file()


def _without(nav: Any, place: str) -> Any:
    if isinstance(nav, list):
        return [_without(entry, place) for entry in nav if not _is_entry(entry, place)]
    if isinstance(nav, dict):
        return {title: _without(entry, place) for title, entry in nav.items()}
    return nav


def _is_entry(entry: Any, place: str) -> bool:
    return isinstance(entry, dict) and place in entry.values()


def _offered() -> list[str]:
    files = [name for name in _ALONE if (TOP / name).is_file()]
    for folder in _FOLDERS:
        paths = sorted((TOP / folder).rglob("*"))
        files += [path.relative_to(TOP).as_posix() for path in paths if path.is_file()]
    return files


def _cases() -> list[str]:
    return sorted(page.parent.name for page in (TOP / "verification").glob("*/README.md"))


def _case_title(case: str) -> str:
    for name in ("check.toml", "stability.toml"):
        path = TOP / "verification" / case / name
        if path.is_file():
            title = tomllib.loads(path.read_text(encoding="utf-8")).get("title")
            if title:
                return str(title)
    return case.replace("_", " ")


def _case_page(case: str) -> str:
    text = (TOP / "verification" / case / "README.md").read_text(encoding="utf-8")
    return f"# {_case_title(case)}\n\nCase `{case}`: `./wingcrack verify {case}`\n\n{text}"


def _case_list() -> str:
    rows = "".join(f"| [{case}]({case}.md) | {_case_title(case)} |\n" for case in _cases())
    return (
        "# Verification cases\n\n"
        "Each is a folder of `verification/`; [Verification](../verification.md) says how they"
        f" work, `./wingcrack verify` runs them.\n\n| case | shows |\n|---|---|\n{rows}"
    )


def _python_page() -> str:
    names = sorted(wingcrack.__all__, key=lambda name: (name[0].isupper(), name))
    entries = "".join(f"::: wingcrack.{name}\n\n" for name in names)
    return (
        "# Python, all names\n\n"
        "From the docstrings of the package `wingcrack`; [python.md](python.md) is an"
        f" introduction.\n\n{entries}"
    )


def _place(source: PurePosixPath) -> PurePosixPath | None:
    """Where a file of the tree is in the site; None: nowhere."""
    name = str(source)
    if name in _PAGES:
        return PurePosixPath(_PAGES[name])
    if name in _ALONE:
        return PurePosixPath("files", name)
    if source.parts[0] == "docs":
        return source.relative_to("docs")
    if source.parts[0] in _FOLDERS:
        return source
    if source.parts[0] == "verification" and source.name == "README.md":
        return PurePosixPath("cases", f"{source.parts[1]}.md")
    return None


def _source(place: PurePosixPath) -> PurePosixPath | None:
    """Where a page of the site is in the tree; None: it is written for the site."""
    for source, page in _PAGES.items():
        if str(place) == page:
            return PurePosixPath(source)
    if place.parts[0] == "cases":
        return (
            None
            if place.stem == "index"
            else PurePosixPath("verification", place.stem, "README.md")
        )
    if str(place) == "python_api.md":
        return None
    return place if place.parts[0] in _FOLDERS else PurePosixPath("docs", place)


def _relinked(source: PurePosixPath, page: PurePosixPath, target: str) -> str:
    """A link as the site has it; one that leads nowhere stays, and MkDocs complains."""
    path, mark, anchor = target.partition("#")
    if not path or is_elsewhere(target):
        return target
    meant = resolve(source, path)
    place = _place(meant) if meant is not None else None
    if place is None:
        return target
    return os.path.relpath(place, page.parent) + mark + anchor
