"""`wingcrack docs`: the site, or its pictures."""

from __future__ import annotations

import sys
import time
from types import SimpleNamespace

from wingcrack_docs.places import SITE


def docs(given: SimpleNamespace) -> int:
    """Make what is asked for; give the exit status: 0 done, 1 failed, 3 something lacks."""
    if given.pictures:
        return _pictures()
    from wingcrack_docs.errors import PagesError, SiteError
    from wingcrack_docs.fortran import make_fortran_pages
    from wingcrack_docs.site import build_site, serve_site
    from wingcrack_docs.tables import write_pages

    out = given.out or SITE
    begin = time.perf_counter()
    write_pages()
    try:
        if not given.no_fortran and make_fortran_pages():
            print(f"pages of the Fortran modules: {time.perf_counter() - begin:.0f} s", flush=True)
        build_site(out, fortran=not given.no_fortran)
    except (PagesError, SiteError) as reason:
        print(f"wingcrack docs: {reason}", file=sys.stderr)
        return 1
    print(f"{out / 'index.html'} is built ({time.perf_counter() - begin:.0f} s)", flush=True)
    if given.serve:
        try:
            serve_site(out, given.port)
        except OSError as reason:
            said = f"port {given.port} cannot be served: {reason.strerror}; --port takes another"
            print(f"wingcrack docs: {said}", file=sys.stderr)
            return 1
    return 0


def _pictures() -> int:
    from wingcrack_docs.errors import PicturesError
    from wingcrack_docs.pictures import make_pictures

    try:
        make_pictures()
    except PicturesError as reason:
        print(f"wingcrack docs: {reason}", file=sys.stderr)
        return 1
    print("docs/gallery.md and docs/pictures are written", flush=True)
    return 0
