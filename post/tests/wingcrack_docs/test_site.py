"""The site is built without a warning, asks no other machine for anything, and can be shown."""

from __future__ import annotations

import json
import re
import threading
import urllib.request
from html.parser import HTMLParser
from http.server import ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote

import pytest

from wingcrack.command_line import main, understand
from wingcrack_docs import cli, fortran
from wingcrack_docs.links import is_elsewhere
from wingcrack_docs.places import DOCS, SITE, DocsError


class _Page(HTMLParser):
    """What a page loads, where its links lead, and its anchors."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(file.read_text("utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what matters of an element."""
        given = {name: value for name, value in attrs if value is not None}
        if "id" in given:
            self.anchors.add(given["id"])
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        elif tag == "link" and given.get("rel") not in ("canonical", "prev", "next"):
            self.loads.append(given["href"])
        elif "src" in given:
            self.loads.append(given["src"])


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site without the Fortran modules; a warning would have failed."""
    folder = tmp_path_factory.mktemp("site")
    cli.build_site(folder, fortran=False)
    return folder


@pytest.fixture(scope="module")
def pages(built: Path) -> dict[Path, _Page]:
    """All pages of the site."""
    return {file: _Page(file) for file in built.rglob("*.html") if file.name != "404.html"}


def test_every_page_of_docs_is_there(built: Path) -> None:
    for page in DOCS.glob("*.md"):
        assert (built / page.with_suffix(".html").name).is_file()
    for name in ("index", "changelog", "contributing", "python_api", "cases/wing_crack_c2"):
        assert (built / f"{name}.html").is_file()
    assert (built / "inputs" / "paper_c" / "onset.nml").is_file()


def test_nothing_is_loaded_from_elsewhere(built: Path, pages: dict[Path, _Page]) -> None:
    for file, page in pages.items():
        assert not [place for place in page.loads if is_elsewhere(place)], file
    for style in built.rglob("*.css"):
        text = style.read_text("utf-8")
        assert not re.search(r"(@import|url\()\s*['\"]?(https?:)?//", text), style


def test_links_of_the_site_lead_somewhere(pages: dict[Path, _Page]) -> None:
    assert len(pages) > 100
    for file, page in pages.items():
        for link in page.links:
            if is_elsewhere(link) or link.startswith("javascript:"):
                continue
            path, _, anchor = unquote(link).partition("#")
            meant = (file.parent / path).resolve() if path else file
            assert meant.exists(), f"{file.name}: {link}"
            if anchor and meant in pages and anchor != "__skip":
                assert anchor in pages[meant].anchors, f"{file.name}: {link}"


def test_the_search_ranks_the_manual_above_cases_and_scenes(built: Path) -> None:
    entries = json.loads((built / "search" / "search_index.json").read_text("utf-8"))["docs"]
    boost = {entry["location"].partition("#")[0]: entry.get("boost", 1.0) for entry in entries}
    assert boost["input.html"] == 1.0
    assert {boost[place] for place in boost if place.startswith("cases/")} == {0.2}


def test_equations_are_drawn_by_the_browser(built: Path) -> None:
    text = (built / "theory.html").read_text("utf-8")
    assert text.count("<math ") >= 20
    assert "<mfrac>" in text
    assert "```math" not in text
    assert "\\frac" not in re.sub(r"<annotation.*?</annotation>", "", text)


def test_nested_lists_are_lists(built: Path) -> None:
    text = (built / "architecture.html").read_text("utf-8")
    assert re.search(r"<li><code>wingcrack_solver: run</code>: arguments\s*<ul>", text)
    assert "<p>- " not in text


def test_names_of_the_python_package_are_described(built: Path) -> None:
    page = _Page(built / "python_api.html")
    assert {"wingcrack.Run", "wingcrack.Run.plot_map", "wingcrack.Scene.run"} <= page.anchors


def test_a_warning_of_mkdocs_is_a_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text("[nowhere](none.md)\n")
    (tmp_path / "mkdocs.yml").write_text("site_name: broken\n")
    monkeypatch.setattr(cli, "CONFIGURATION", tmp_path / "mkdocs.yml")
    with pytest.raises(DocsError, match="1 warnings in strict mode"):
        cli.build_site(tmp_path / "out", fortran=False)
    assert main(["docs", "--no-fortran", "--out", str(tmp_path / "out")]) == 1
    assert "wingcrack docs: the site was not built" in capsys.readouterr().err


def test_pages_of_ford_stay_at_home(tmp_path: Path) -> None:
    head = (
        '<link href="https://cdn.example/npm/bootstrap@5/dist/css/bootstrap.min.css" rel="x"\n'
        '  integrity="sha384-x" crossorigin="anonymous">\n'
        '<script src="https://cdn.example/js/bootstrap.bundle.min.js" integrity="x"></script>\n'
        '<script type="text/x-mathjax-config">MathJax.Hub()</script>\n'
        '<script src="https://cdn.example/MathJax.js?config=T" async></script>\n'
    )
    for folder in ("css", "js", "module"):
        (tmp_path / folder).mkdir()
    (tmp_path / "module" / "a.html").write_text(head)
    (tmp_path / "index.html").write_text(head)
    fortran.keep_at_home(tmp_path)
    for page, home in (("module/a.html", "../"), ("index.html", "./")):
        text = (tmp_path / page).read_text()
        assert text.count(home) == 2
        assert not re.search("https|integrity|crossorigin|MathJax", text)
    assert (tmp_path / "css" / "bootstrap.min.css").stat().st_size > 100_000


def test_ford_that_fails_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "fortran").mkdir()
    monkeypatch.setattr(fortran, "TOP", tmp_path)
    monkeypatch.setattr(fortran, "FORTRAN_PAGES", tmp_path / "pages")
    monkeypatch.setattr("sys.executable", "/bin/false")
    with pytest.raises(DocsError, match="FORD failed: it gave no reason"):
        fortran.make_fortran_pages()


def test_the_site_is_shown_to_this_machine_only(
    built: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[object] = []

    def serve(server: ThreadingHTTPServer) -> None:
        thread = threading.Thread(target=server.handle_request)
        thread.start()
        address = f"http://127.0.0.1:{server.server_port}/gallery.html"
        with urllib.request.urlopen(address, timeout=30) as answer:
            seen.extend((server.server_address[0], b"Gallery" in answer.read()))
        thread.join()

    monkeypatch.setattr(ThreadingHTTPServer, "serve_forever", serve)
    cli.serve_site(built, 0)
    assert seen == ["127.0.0.1", True]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--port", "0"], "'0' is no whole number from 1 to 65535"),
        (["--port", "x"], "'x' is no whole number from 1 to 65535"),
        (["--pictures", "--serve"], "do not go with it"),
        (["--nothing"], "no such option '--nothing'"),
        (["--out", __file__], "it is no folder"),
    ],
)
def test_what_is_not_understood_is_refused(
    words: list[str], reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        understand(["docs", *words])
    assert ended.value.code == 2
    assert reason in capsys.readouterr().err


def test_the_site_goes_to_the_build_folder() -> None:
    assert SITE.parts[-2:] == ("build", "site")
