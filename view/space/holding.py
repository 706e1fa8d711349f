"""How flexible bodies are held, and their deformation as it is seen from there."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ...results import Results
from ...superelement.validation import Array
from .tracks import GROUND_NAME, Track

# Couplings of these groups hold a body in its place; contacts let it go.
HOLDING_GROUPS = ("joints", "motions", "springs", "bearings")
# A body that does not turn in a joint is seen from its frame there alone.
TURNLESS_JOINTS = ("fixed", "prismatic")


class Hold:
    """The frames of a flexible body that magnified deformation leaves where they are.

        u'(X) = u(X) - d - w x X

    is what it deforms, seen from there. d, w (k, 3): by one frame, with its displacement and its
    rotation; by several, the rigid motion that is nearest to their displacements [m, rad].
    """

    def __init__(self, body: Track, frames: Sequence[Track]) -> None:
        u = np.stack([frame.u for frame in frames if frame.u is not None], axis=1)
        X = np.array([place_of(body, frame) for frame in frames])
        if len(frames) == 1:
            self._turned: Array = u[:, 0, 3:]
            self._moved: Array = u[:, 0, :3] - np.cross(self._turned, X[0])
            return
        motions = [np.hstack([np.eye(3), np.cross(np.eye(3), place).T]) for place in X]
        rigid = u[..., :3].reshape(len(u), -1) @ np.linalg.pinv(np.vstack(motions)).T
        self._moved, self._turned = rigid[:, :3], rigid[:, 3:]

    def seen(self, u: Array, X: Array, rows: slice) -> Array:
        """Displacements u (k, p, 3) at X (p, 3) as they are seen from there."""
        relative: Array = u - self._moved[rows, None] - np.cross(self._turned[rows, None], X)
        return relative


def place_of(body: Track, frame: Track) -> Array:
    """The place (3,) of a frame at rest, from the center of mass in body axes [m]."""
    assert frame.u is not None
    at_first: Array = body.seen_from(frame.position)[0] - frame.u[0, :3]
    return at_first


class _End(NamedTuple):
    """Of a coupling: the body at its other end, the frame on this one, and its type."""

    other: str
    frame: str
    type: str


def holding_frames(results: Results) -> dict[str, tuple[str, ...]]:
    """The frames by which each body is held, of those that hang on the ground.

    That by which it hangs there, by the fewest couplings, if it does not turn in it or hangs by it
    alone; else all that lead to the ground without it, as both pins of a connecting rod.
    """
    ends = _ends(results)
    parents = _parents(ends)
    found = {}
    for body, by in parents.items():
        led = [end.frame for end in ends[body] if parents.get(end.other, by).other != body]
        alone = by.type in TURNLESS_JOINTS or len(set(led)) < 2
        found[body] = (by.frame,) if alone else tuple(dict.fromkeys(led))
    return found


def _ends(results: Results) -> Mapping[str, list[_End]]:
    ends: dict[str, list[_End]] = {GROUND_NAME: []}
    for coupling in results.couplings:
        if coupling.group in HOLDING_GROUPS:
            a, b = coupling.between
            ends.setdefault(body_of(a), []).append(_End(body_of(b), a, coupling.type))
            ends.setdefault(body_of(b), []).append(_End(body_of(a), b, coupling.type))
    return ends


def _parents(ends: Mapping[str, list[_End]]) -> dict[str, _End]:
    """The end of each body by which it hangs on the ground."""
    found: dict[str, _End] = {}
    waiting = [GROUND_NAME]
    while waiting:
        holder = waiting.pop(0)
        for end in ends[holder]:
            if end.other != GROUND_NAME and end.other not in found:
                found[end.other] = next(own for own in ends[end.other] if own.other == holder)
                waiting.append(end.other)
    return found


def body_of(frame: str) -> str:
    return frame.partition(".")[0]
