"""The page's server: bound to this machine; requests of pages of other hosts are refused.

A page of another host that is open in the browser could reach this server through a host name that
resolves to 127.0.0.1 (DNS rebinding); such requests carry that name and are refused. Without such a
name the browser does not let the page read the answers, as no header here allows it.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

from wingcrack.errors import AbsentError, RunError
from wingcrack.view.content import Content

_ADDRESS = "127.0.0.1"
_NAMES = (_ADDRESS, "localhost")  # any port: it may come through a tunnel of ssh
_PAGE = Path(__file__).parent / "page"
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
_JSON, _BINARY = "application/json", "application/octet-stream"
_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}
_ANEW = "no-store"
_FOR_GOOD = "private, max-age=86400, immutable"  # the address holds a stamp of the file


def serve(content: Content, port: int) -> ThreadingHTTPServer:
    """Give a server for a run, on a port of this machine or, for 0, on a free one.

    Raises `OSError` if the port is taken or not allowed.
    """

    class Handler(_Handler):
        answers = _answers(content)

    return _Server((_ADDRESS, port), Handler)


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that has gone away is no news; anything else is a fault of ours, and shown."""
        if not isinstance(sys.exc_info()[1], ConnectionError | TimeoutError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """One request; `answers` gives each path's message from its query."""

    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True  # else each answer waits 40 ms for word from the browser
    timeout = 60.0  # [s] after which a silent connection is closed
    answers: dict[str, Callable[[dict[str, str]], tuple[str, bytes, str]]]

    def do_GET(self) -> None:
        """Answer, or say in one sentence why not."""
        host = self.headers.get("Host", "").rpartition(":")
        if (host[0] or host[2]) not in _NAMES:
            self._refuse(HTTPStatus.MISDIRECTED_REQUEST, "this page is for this machine only")
            return
        address = urlsplit(self.path)
        query = {name: values[-1] for name, values in parse_qs(address.query).items()}
        answer = self.answers.get(address.path)
        if answer is None:
            self._refuse(HTTPStatus.NOT_FOUND, f"there is nothing at {address.path}")
            return
        try:
            kind, message, keep = answer(query)
        except AbsentError as reason:
            self._refuse(HTTPStatus.NOT_FOUND, str(reason))
        except RunError as reason:
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE, str(reason))
        except (KeyError, ValueError):
            self._refuse(HTTPStatus.BAD_REQUEST, f"{self.path} is no request of this page")
        else:
            self._send(HTTPStatus.OK, kind, message, keep)

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 (the library's name)
        """Keep the terminal quiet."""

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self._send(status, _JSON, json.dumps({"why": why}).encode(), _ANEW)

    def _send(self, status: HTTPStatus, kind: str, message: bytes, keep: str) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(message)))
        self.send_header("Cache-Control", keep)
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(message)


def _answers(content: Content) -> dict[str, Callable[[dict[str, str]], tuple[str, bytes, str]]]:
    """What there is at each path; a query without what it needs is a KeyError or ValueError."""

    def page(path: Path) -> Callable[[dict[str, str]], tuple[str, bytes, str]]:
        return lambda _: (_TYPES[path.suffix], path.read_bytes(), _ANEW)

    def overview(_: dict[str, str]) -> tuple[str, bytes, str]:
        return _JSON, content.overview(), _ANEW

    def state(query: dict[str, str]) -> tuple[str, bytes, str]:
        message = content.state(int(query["place"]), query["field"], query["stamp"])
        return _BINARY, message, _FOR_GOOD

    def mesh(query: dict[str, str]) -> tuple[str, bytes, str]:
        return _BINARY, content.mesh(int(query["place"]), query["stamp"]), _FOR_GOOD

    def scale(query: dict[str, str]) -> tuple[str, bytes, str]:
        return _JSON, content.scale(query["field"]), _ANEW

    def history(query: dict[str, str]) -> tuple[str, bytes, str]:
        return _BINARY, content.history(query["column"]), _ANEW

    files = {f"/{path.name}": page(path) for path in sorted(_PAGE.iterdir())}
    return {
        **files,
        "/": files["/index.html"],
        "/overview": overview,
        "/state": state,
        "/mesh": mesh,
        "/scale": scale,
        "/history": history,
    }
