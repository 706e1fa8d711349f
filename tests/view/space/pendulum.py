"""A run in closed form, as results tell it: a flexible bar swings about z on a rigid post.

The bar of length 1 turns by angle(t) = t about the origin, and bends by u = b t x^2 across, x from
its root. The post stands at the origin.
"""

from types import SimpleNamespace
from typing import Any

import numpy as np
from duhamel.results import Connection, RecoveryError
from duhamel.results.search import Extremes
from duhamel.superelement import Outline

BEND = 1e-3
LENGTH = 1.0
TIME = np.linspace(0.0, 1.0, 101)
CENTER = np.array([0.5, 0.0, 0.0])
QUADS = np.array(
    [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
)


def box(lengths: Any) -> Outline:
    corners = [(i, j, k) for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)]
    return Outline(np.array(corners) * lengths, QUADS)


class Pendulum:
    """What `Results` answers of such a run.

    bend: of the bar [1/m]; origin (3,): of the whole [m]; gravity: in the model.
    """

    frames = ("bar.root", "bar.tip")

    def __init__(self, bend: float = BEND, origin: Any = (0, 0, 0), gravity: str = "") -> None:
        self.bend, self.origin = bend, np.asarray(origin, dtype=float)
        self.time, self.bodies = TIME, ("post", "bar")
        self.recorded: tuple[str, ...] = (
            "bodies/post",
            "bodies/bar",
            "frames/bar.root",
            "frames/bar.tip",
        )
        self.model = f"[simulation]\ngravity = {gravity}\n" if gravity else ""
        self.couplings = (
            Connection("pin", "joints", "revolute", ("ground", "bar.root"), np.array([0, 0, 1.0])),
        )
        self.ground_frames: dict[str, Any] = {}
        self.known: tuple[str, ...] = ("displacement", "velocity")

    def body(self, name: str) -> Any:
        return SimpleNamespace(x=self._x(name, TIME), R=self._R(name, TIME))

    def frame(self, name: str) -> Any:
        end = np.array([[-0.5 if name.endswith("root") else 0.5, 0.0, 0.0]])
        u = self._bent(end, TIME)[:, 0]
        slope = 2.0 * self.bend * TIME * (end[0, 0] + 0.5)
        turned = np.stack([0 * TIME, 0 * TIME, slope], axis=1)
        return SimpleNamespace(
            position=self._x("bar", TIME) + spun(TIME, (end + u[:, None])[:, 0][:, None])[:, 0],
            rotation=self._R("bar", TIME),
            u=np.hstack([u, turned]),
            force=np.column_stack([3.0 * TIME, *np.zeros((5, len(TIME)))]),
        )

    def outline(self, name: str) -> Outline:
        return box([LENGTH, 0.04, 0.04]) if name == "bar" else box([0.1, 0.1, 0.2])

    def outline_remark(self, body):
        return ""

    def outline_source(self, name: str) -> str:
        return "recovery" if name == "bar" else "rigid"

    def outline_displacement(self, name: str, t: Any) -> Any:
        points = self.outline(name).points
        if name == "post":
            return np.zeros((*np.shape(t), *points.shape))
        return self._bent(points, np.atleast_1d(t)).reshape(*np.shape(t), *points.shape)

    def outline_field(self, body: str, t: Any, name: str) -> Any:
        if name not in self.known:
            raise RecoveryError(f"body {body!r}: no {name}")
        return np.linalg.norm(self.outline_displacement(body, t), axis=-1)

    def field_extremes(self, body: str, name: str, rows: slice) -> Extremes:
        over_time = self.outline_field(body, TIME[rows], name).max(axis=1)
        return Extremes(over_time.max(), rows.start + int(over_time.argmax()), 0, 0.0, 0)

    def _bent(self, points: Any, t: Any) -> Any:
        u = np.zeros((len(t), *points.shape))
        # of a body whose axes move with the middle: the root moves too
        u[:, :, 1] = self.bend * t[:, None] * ((points[:, 0] + 0.5) ** 2 - 0.2)
        return u

    def _x(self, name: str, t: Any) -> Any:
        at = spun(t, np.broadcast_to(CENTER, (len(t), 1, 3)))[:, 0] if name == "bar" else 0.0
        return self.origin + at + np.zeros((len(t), 3))

    def _R(self, name: str, t: Any) -> Any:
        half = 0.5 * t * (name == "bar")
        return np.stack([np.cos(half), 0 * t, 0 * t, np.sin(half)], axis=1)


def spun(t: Any, X: Any) -> Any:
    """X (k, p, 3) turned about z by angles t (k,)."""
    c, s = np.cos(t)[:, None], np.sin(t)[:, None]
    x, y, z = np.moveaxis(X, -1, 0)
    return np.stack([c * x - s * y, s * x + c * y, z + 0 * c], axis=-1)
