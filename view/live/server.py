"""A page in the browser that follows a run, and by which one holds, continues and stops it.

It is served to this machine alone, at an address that holds a secret.
"""

import hmac
import json
import secrets
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from math import inf
from pathlib import Path
from threading import Lock, Thread
from typing import Any, Protocol
from urllib.parse import parse_qs, urlsplit

from ...results import ResultsError
from ..errors import PictureError
from ..report import libraries
from ..report.markup import Markup, read, rendered
from ..report.scene import scene
from .follower import RunFollower, plots_and_validity, told

LOCAL_HOST = "127.0.0.1"
LEAST_PAUSE = 0.5
"""seconds from an answer to the next question"""
PAUSE_OVER_WORK = 3.0
"""a question takes time from the run: a quarter of one core at most"""
SECONDS_UNSEEN = 4.0
"""after which a page that does not ask any more is taken to be closed"""
SECONDS_TO_TELL = 15.0
"""that a run which has failed waits for its page to ask"""
MAX_QUANTITIES = 12
# Programs of the page stand in it, nothing else may be loaded or asked.
CONTENT_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval' blob:; style-src 'unsafe-inline';"
    " img-src data: blob:; font-src data: 'self'; connect-src 'self'; worker-src blob:;"
    " base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


class Control(Protocol):
    """What a run is held, continued and stopped by."""

    @property
    def held(self) -> bool: ...
    @property
    def place(self) -> Path | None: ...
    def hold(self) -> None: ...
    def go_on(self) -> None: ...
    def stop(self) -> None: ...


class WatchedRun:
    """What the page of a run knows of it, and its address."""

    def __init__(self, control: Control, target: Path, title: str, t_end: float) -> None:
        self._control, self._target, self._title, self._t_end = control, target, title, t_end
        self._follower, self._moving, self._drawing = RunFollower(), Lock(), Lock()
        self._ended = ""
        self._expected = 0.0
        self.token = secrets.token_urlsafe(24)
        self.orders: dict[str, Callable[[], None]] = {
            "hold": control.hold,
            "go-on": control.go_on,
            "stop": control.stop,
        }

    def end(self, how: str) -> None:
        """Tell the page that the run is over, and how."""
        self._ended = how

    def page(self) -> str:
        """The page as HTML, with the motion so far."""
        packed = {"plotly": libraries.plotly(), "k3d": libraries.k3d()}
        with self._moving:
            found = self._motion(0)
        rows = 0
        if found is not None:
            motion, rows = found
            packed["scene"] = libraries.text(scene(motion))
        data = {"rows": rows, "t_end": self._t_end, "motion": found and told(found[0])}
        packed["data"] = libraries.packed(json.dumps(data).encode())
        return rendered(
            "live.html",
            title=self._title,
            style=Markup(read("page.css")),
            packed={name: Markup(text) for name, text in packed.items()},
            script=Markup(read("viewer.js") + read("live.js")),
        )

    def news(self, first: int) -> dict[str, Any]:
        """How the run is, and its motion since a row."""
        # As long as an answer takes, the page is there.
        self._expected = inf
        status = self._ended or ("held" if self._control.held else "running")
        news: dict[str, Any] = {"status": status, "over": bool(self._ended), "rows": first}
        try:
            with _paced(news), self._moving:
                if (found := self._motion(first)) is not None:
                    motion, news["rows"] = found
                    news["motion"] = told(motion)
        finally:
            self._expected = time.monotonic() + news.get("pause", LEAST_PAUSE)
        return news

    def curves(self, quantities: list[str]) -> dict[str, Any]:
        """Curves of the run so far, and its validity."""
        found: dict[str, Any] = {}
        with _paced(found), self._drawing:
            place = self._place()
            if place is not None:
                # The run may have no row yet, or just have moved its file to its place.
                with suppress(ResultsError):
                    found |= plots_and_validity(place, quantities[:MAX_QUANTITIES])
        return found

    def wait_until_closed(self, at_most: float = inf) -> None:
        """Wait as long as a page asks, which none may do at all."""
        until = time.monotonic() + at_most
        while time.monotonic() < min(until, self._expected + SECONDS_UNSEEN):
            time.sleep(0.1)

    def _motion(self, first: int) -> Any:
        place = self._place()
        try:
            return None if place is None else self._follower.motion(place, first)
        except ResultsError:
            return None

    def _place(self) -> Path | None:
        """The file of the rows, which moves when the run has ended well."""
        place = self._control.place
        return place if place is None or place.exists() else self._target


@contextmanager
def _paced(answer: dict[str, Any]) -> Iterator[None]:
    """Put into an answer how long the page is to wait [s] until it asks again."""
    started = time.perf_counter()
    yield
    answer["pause"] = max(LEAST_PAUSE, PAUSE_OVER_WORK * (time.perf_counter() - started))


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
