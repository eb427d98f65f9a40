"""Building the site with MkDocs, and showing it to this machine."""

from __future__ import annotations

import logging
import os
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from wingcrack_docs.errors import SiteError
from wingcrack_docs.places import CONFIGURATION


def build_site(out: Path, *, fortran: bool) -> None:
    """Build the site into a folder; any warning is a failure.

    Parameters
    ----------
    out : Path
        What it holds is replaced.
    fortran : bool
        Whether the pages of the Fortran modules, made before, belong to it.

    Raises
    ------
    SiteError
        If MkDocs warns of something or cannot build the site.
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
        raise SiteError(f"the site was not built: {reason}") from None


def serve_site(folder: Path, port: int) -> None:
    """Show a folder to the browsers of this machine, and only to them, until interrupted."""
    handler = partial(_Quiet, directory=str(folder))
    with ThreadingHTTPServer(("127.0.0.1", port), handler) as server:
        print(f"http://127.0.0.1:{server.server_port}/ shows the site; ctrl-C ends", flush=True)
        server.serve_forever()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, format: str, *args: object) -> None:  # noqa: A002
        """Say nothing of each request."""
