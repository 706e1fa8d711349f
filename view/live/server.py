"""A page in the browser that follows a run, and by which one holds, continues and stops it.

It is served to this machine alone, at an address that holds a secret.
"""

import hmac
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any
from urllib.parse import parse_qs, urlsplit

from ..errors import PictureError
from ..report import libraries
from .watched_run import Control, WatchedRun

LOCAL_HOST = "127.0.0.1"
SECONDS_TO_TELL = 15.0
"""that a run which has failed waits for its page to ask"""
# Programs of the page stand in it, nothing else may be loaded or asked.
CONTENT_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval' blob:; style-src 'unsafe-inline';"
    " img-src data: blob:; font-src data: 'self'; connect-src 'self'; worker-src blob:;"
    " base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


@contextmanager
def watched(
    control: Control, target: Path, title: str, t_end: float, tell: Callable[[str], object]
) -> Iterator[WatchedRun]:
    """Serve the page of a run until it ends, and as long afterwards as a page is open.

    control: of the run, which writes to `target`; t_end [s]; tell: is told the address.
    """
    for name in ("plotly", "k3d", "jinja2"):
        libraries.package(name)
    watch = WatchedRun(control, target, title, t_end)
    try:
        server = _Server((LOCAL_HOST, 0), _handler(watch))
    except OSError as error:
        raise PictureError(f"no page: cannot serve on {LOCAL_HOST}: {error}") from error
    Thread(target=server.serve_forever, name="watch", daemon=True).start()
    try:
        tell(f"http://{LOCAL_HOST}:{server.server_port}/{watch.token}/")
        try:
            yield watch
        except KeyboardInterrupt:
            watch.end("stopped")
            watch.wait_until_closed(SECONDS_TO_TELL)
            raise
        except BaseException as error:
            watch.end(f"failed: {error}")
            watch.wait_until_closed(SECONDS_TO_TELL)
            raise
        watch.end("finished")
        # The run has ended well, whatever ends the waiting.
        with suppress(KeyboardInterrupt):
            watch.wait_until_closed()
    finally:
        server.shutdown()
        server.server_close()


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Browsers leave in the middle of an answer: no reason for a traceback."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


def _handler(watch: WatchedRun) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        """Answers to the page of a watch, and to nobody else."""

        # Browsers wait for the end of an answer without a length.
        protocol_version = "HTTP/1.1"

        def do_GET(self) -> None:
            address = self._asked()
            if address is None:
                return
            path, query = address
            if path == "":
                self._answer(watch.page().encode("utf-8", "backslashreplace"), "text/html")
            elif path == "news":
                first = query.get("first", ["0"])[0]
                if not first.isdecimal():
                    self._refuse(HTTPStatus.BAD_REQUEST)
                    return
                self._answer(json.dumps(watch.news(int(first))).encode(), "application/json")
            elif path == "curves":
                curves = watch.curves(query.get("plot", []))
                self._answer(json.dumps(curves).encode(), "application/json")
            else:
                self._refuse(HTTPStatus.NOT_FOUND)

        def do_POST(self) -> None:
            address = self._asked()
            if address is None:
                return
            order = watch.orders.get(address[0])
            # Other pages in the browser may send forms to any address, but not this header.
            if order is None or self.headers.get("X-Duhamel") != watch.token:
                self._refuse(HTTPStatus.FORBIDDEN)
                return
            order()
            self._answer(b"{}", "application/json")

        def _asked(self) -> tuple[str, dict[str, list[str]]] | None:
            """The path below the secret and the query; None where the secret or host is wrong."""
            try:
                address = urlsplit(self.path)
            except ValueError:  # no address at all, as http://[
                self._refuse(HTTPStatus.FORBIDDEN)
                return None
            _, token, path = (*address.path.split("/", 2), "", "")[:3]
            assert isinstance(self.server, _Server)
            port = self.server.server_port
            # A name of the attacker that leads here would make his page one of this host.
            known = self.headers.get("Host", "") in (f"{LOCAL_HOST}:{port}", f"localhost:{port}")
            if not known or not hmac.compare_digest(token.encode(), watch.token.encode()):
                self._refuse(HTTPStatus.FORBIDDEN)
                return None
            return path, parse_qs(address.query)

        def _answer(self, content: bytes, kind: str) -> None:
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", f"{kind}; charset=utf-8")
            self.send_header("Content-Length", str(len(content)))
            self.send_header("Cache-Control", "no-store")
            self.send_header("Referrer-Policy", "no-referrer")
            self.send_header("X-Content-Type-Options", "nosniff")
            self.send_header("Content-Security-Policy", CONTENT_POLICY)
            self.end_headers()
            self.wfile.write(content)

        def _refuse(self, status: HTTPStatus) -> None:
            self.send_response(status)
            self.send_header("Content-Length", "0")
            self.send_header("Connection", "close")
            self.end_headers()
            self.close_connection = True

        def log_message(self, *told: Any) -> None:
            """Nothing on stderr, where the run shows its progress."""

    return Handler
