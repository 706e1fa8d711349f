"""The run that a page follows: what the page is told of it, and the orders that it may give."""

import json
import secrets
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from math import inf
from pathlib import Path
from threading import Lock
from typing import Any, Protocol

from ...results import ResultsError
from ..report import libraries
from ..report.markup import Markup, read, rendered
from ..report.scene import scene
from .follower import RunFollower, plots_and_validity, told

LEAST_PAUSE = 0.5
"""seconds from an answer to the next question"""
PAUSE_OVER_WORK = 3.0
"""each of both kinds of questions takes a quarter of one core at most"""
SECONDS_UNSEEN = 4.0
"""after which a page that does not ask any more is taken to be closed"""
SECONDS_TO_LOAD = 20.0
"""from the answer with the page to its first question"""
MAX_QUANTITIES = 12


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
    """What the page of a run is told, and the orders that it may give."""

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
        # As long as an answer takes, and the page to load, it is there.
        self._expected = inf
        packed = {"plotly": libraries.plotly(), "k3d": libraries.k3d()}
        with self._moving:
            found = self._motion(0)
        rows = 0
        if found is not None:
            motion, rows = found
            packed["scene"] = libraries.text(scene(motion))
        data = {"rows": rows, "t_end": self._t_end, "motion": found and told(found[0])}
        packed["data"] = libraries.packed(json.dumps(data).encode())
        self._expected = time.monotonic() + SECONDS_TO_LOAD
        return rendered(
            "live.html",
            title=self._title,
            style=Markup(read("page.css")),
            packed={name: Markup(text) for name, text in packed.items()},
            script=Markup(read("viewer.js") + read("live.js")),
        )

    def news(self, first: int) -> dict[str, Any]:
        """How the run is, and its motion since a row."""
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
