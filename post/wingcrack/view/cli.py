"""`wingcrack view`: a run in the browser."""

from __future__ import annotations

import os
import sys
import webbrowser
from http.server import ThreadingHTTPServer
from pathlib import Path
from types import SimpleNamespace

_INTERRUPTED = 130


def view(given: SimpleNamespace) -> int:
    """Serve the page until it is interrupted; 130 then, 2 where there is nothing to show."""
    try:
        return _show(given.directory, given.port, browser=not given.no_browser)
    except KeyboardInterrupt:
        return _INTERRUPTED


def _show(directory: Path, port: int, *, browser: bool) -> int:
    # late, so that --help and mistakes in the call answer at once
    from wingcrack.errors import AbsentError, RunError
    from wingcrack.view.content import Content
    from wingcrack.view.server import serve

    content = Content(directory)
    try:
        content.overview()
        server = serve(content, port)
    except (RunError, AbsentError) as reason:
        print(f"wingcrack view: {reason}", file=sys.stderr)
        return 2
    except OSError as reason:
        print(
            f"wingcrack view: port {port} cannot be had ({reason.strerror});"
            " another --port may be free, and without one a free one is taken",
            file=sys.stderr,
        )
        return 2
    _announce(server, directory, browser=browser)
    with server:
        server.serve_forever()
    return 0


def _announce(server: ThreadingHTTPServer, directory: Path, *, browser: bool) -> None:
    address = f"http://127.0.0.1:{server.server_address[1]}/"
    print(f"{directory} is shown at {address}; Ctrl-C ends this.", flush=True)
    if browser and _has_display():
        webbrowser.open(address)


def _has_display() -> bool:
    """Whether a window can open: a browser for text would take the terminal away."""
    if sys.platform != "linux":
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
