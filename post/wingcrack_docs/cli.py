"""`wingcrack docs`: the site, or its pictures."""

from __future__ import annotations

import logging
import os
import sys
import time
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from types import SimpleNamespace

from wingcrack_docs.places import CONFIGURATION, SITE, DocsError


def docs(given: SimpleNamespace) -> int:
    """Make the site or the pictures; exit status: 0 done, 1 failed, 3 something is missing."""
    from wingcrack_docs.fortran import make_fortran_pages
    from wingcrack_docs.tables import write_pages

    out = given.out or SITE
    begin = time.perf_counter()
    try:
        if given.pictures:
            from wingcrack_docs.pictures import make_pictures

            make_pictures()
            print("docs/gallery.md and docs/pictures are written", flush=True)
            return 0
        write_pages()
        if not given.no_fortran and make_fortran_pages():
            print(f"pages of the Fortran modules: {time.perf_counter() - begin:.0f} s", flush=True)
        build_site(out, fortran=not given.no_fortran)
        print(f"{out / 'index.html'} is built ({time.perf_counter() - begin:.0f} s)", flush=True)
        if given.serve:
            serve_site(out, given.port)
    except DocsError as reason:
        print(f"wingcrack docs: {reason}", file=sys.stderr)
        return 1
    except OSError as reason:
        if not given.serve:
            raise
        said = f"port {given.port} cannot be served: {reason.strerror}; --port takes another"
        print(f"wingcrack docs: {said}", file=sys.stderr)
        return 1
    return 0


def build_site(out: Path, *, fortran: bool) -> None:
    """Build the site into a folder; any warning is a failure.

    Raises `DocsError` if MkDocs warns of something or cannot build the site.

    `out`: its contents are replaced. `fortran`: whether the pages of the Fortran modules, made
    before, belong to it.
    """
    os.environ["NO_MKDOCS_2_WARNING"] = "true"  # the theme's remark about a later MkDocs
    from mkdocs.commands.build import build
    from mkdocs.config import load_config
    from mkdocs.exceptions import Abort, ConfigurationError

    logging.basicConfig(format="%(levelname)s: %(message)s", level=logging.WARNING)
    try:
        settings = load_config(str(CONFIGURATION), strict=True, site_dir=str(out.resolve()))
        settings.extra["fortran"] = fortran
        settings.plugins.on_startup(command="build", dirty=False)
        build(settings)
        settings.plugins.on_shutdown()
    except (Abort, ConfigurationError) as reason:
        raise DocsError(f"the site was not built: {reason}") from None


def serve_site(folder: Path, port: int) -> None:
    """Show a folder to the browsers of this machine, and only to them, until interrupted."""
    handler = partial(_Quiet, directory=str(folder))
    with ThreadingHTTPServer(("127.0.0.1", port), handler) as server:
        print(f"http://127.0.0.1:{server.server_port}/ shows the site; ctrl-C ends", flush=True)
        server.serve_forever()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, format: str, *args: object) -> None:  # noqa: A002
        """Say nothing of each request."""
