"""A camera that sees all frames of a film from one place, or follows what travels."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..superelement.validation import Array
from .errors import PictureError

# About the axes of the picture across and up: seen straight on, bodies of a plane motion would be
# flat outlines.
PLANE_MOTION_TILT = np.radians(12.0), np.radians(-10.0)
# Over its width: a thicker motion is one in space, which a look along its normal would hide.
MAX_PLANE_THICKNESS = 0.12
# Lines and marks at the rim are wider than the points that the camera knows.
FITTED_MARGIN = 1.06
MAX_TRAVEL = 2.5
"""height of all frames over the largest one: a rod that turns about its end has 2"""
FOLLOWED_SHARE = 0.8
"""of what is seen, across and up, where bodies stay while the camera follows them"""
PATH_ROUNDS = 400
"""of smoothing"""
# Onto planes: towards the eye, and up.
NAMED_VIEWS = {
    "xy": ((0, 0, 1), (0, 1, 0)),
    "xz": ((0, -1, 0), (0, 0, 1)),
    "yz": ((1, 0, 0), (0, 0, 1)),
}
# Towards the eye. No two axes are seen under the same angle, so that edges of boxes do not hide
# each other.
ISOMETRIC_EYE = np.array([1.0, -1.35, 0.8])
UPWARD = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Camera:
    """A parallel projection.

    axes (3, 3): right, up and towards the eye as rows, in space; focus (3,) [m], the middle of the
    picture; height: of what is seen [m]; depth: half of what is seen along the line of sight [m].
    """

    axes: Array
    focus: Array
    height: float
    depth: float

    def seen(self, points: Array) -> Array:
        """Points (..., 3) in space as (..., 2) from the middle of the picture, over its height."""
        flat: Array = (points - self.focus) @ self.axes[:2].T / self.height
        return flat


def axes_towards(eye: Array, up: Array) -> Array:
    """Right, up and towards the eye as rows (3, 3); up is as near as can be to the given one."""
    towards = np.asarray(eye, dtype=float) / np.linalg.norm(eye)
    right = np.cross(up, towards)
    if np.linalg.norm(right) < 1e-6:
        right = np.cross(np.eye(3)[int(np.abs(towards).argmin())], towards)
    right = right / np.linalg.norm(right)
    return np.array([right, np.cross(towards, right), towards])


def chosen_axes(view: str, spread: Array, gravity: Array | None) -> Array:
    """The axes of the camera: those of a view by name or direction, or by how the points spread.

    view: "" for the choice, "iso", "xy", "xz", "yz" or "x,y,z", towards the eye; spread (3, 3):
    covariance of the points of all frames; gravity (3,), or None: against it is up.
    """
    up = UPWARD
    if gravity is not None and np.linalg.norm(gravity) > 0.0:
        up = -np.asarray(gravity, dtype=float) / np.linalg.norm(gravity)
    if view in NAMED_VIEWS:
        eye, over = (np.array(direction, dtype=float) for direction in NAMED_VIEWS[view])
        return axes_towards(eye, over)
    if view == "iso":
        return axes_towards(_isometric(up), up)
    if view:
        return axes_towards(direction_of(view), up)
    return _by_spread(spread, up, gravity is not None)


def direction_of(view: str) -> Array:
    """The direction of "x,y,z"; PictureError if it is none."""
    try:
        direction = np.array([float(number) for number in view.split(",")])
    except ValueError:
        direction = np.zeros(0)
    if direction.shape != (3,) or not np.isfinite(direction).all() or not direction.any():
        known = ", ".join(["iso", *NAMED_VIEWS])
        raise PictureError(f"--view: expected {known} or a direction x,y,z, found {view!r}")
    direction /= np.abs(direction).max()
    unit: Array = direction / np.linalg.norm(direction)
    return unit


def _isometric(up: Array) -> Array:
    """The usual direction towards the eye, where this is up."""
    if abs(up[2]) > 0.9:
        return np.array([ISOMETRIC_EYE[0], ISOMETRIC_EYE[1], np.sign(up[2]) * ISOMETRIC_EYE[2]])
    # x stays to the right where it can
    ahead = np.cross([1.0, 0.0, 0.0] if abs(up[0]) < 0.9 else [0.0, 1.0, 0.0], up)
    side = np.cross(up, ahead)
    eye: Array = -ISOMETRIC_EYE[1] * ahead + ISOMETRIC_EYE[0] * side + ISOMETRIC_EYE[2] * up
    return eye


def _by_spread(spread: Array, up: Array, falls: bool) -> Array:
    widths, directions = np.linalg.eigh(spread)
    widths = np.sqrt(np.maximum(widths, 0.0))
    flat = widths[0] < MAX_PLANE_THICKNESS * widths[2] and widths[0] < 0.5 * widths[1]
    normal = directions[:, 0]
    if not flat or (falls and abs(normal @ up) > 0.7):
        return axes_towards(_isometric(up), up)
    normal = _outward(normal)
    if not falls and abs(normal[2]) > 0.7:
        up = np.array([0.0, 1.0, 0.0])
    straight = axes_towards(normal, up)
    above, aside = PLANE_MOTION_TILT
    eye = straight[2] + np.tan(above) * straight[1] + np.tan(aside) * straight[0]
    return axes_towards(eye, straight[1])


def _outward(normal: Array) -> Array:
    """Of both normals of a plane the one that is looked against: +z, -y, +x."""
    along = int(np.abs(normal).argmax())
    wanted = (1.0, -1.0, 1.0)[along]
    outward: Array = normal * np.sign(normal[along]) * wanted
    return outward


class Fitting:
    """Takes the points of all frames, and gives the camera that holds them."""

    def __init__(self, axes: Array) -> None:
        self._axes = axes
        self._low, self._high = np.full(3, np.inf), np.full(3, -np.inf)

    def take(self, points: Array, around: float = 0.0) -> None:
        """Points (..., 3) with what is around them [m]."""
        flat = points.reshape(-1, 3) @ self._axes.T
        if len(flat):
            self._low = np.minimum(self._low, flat.min(axis=0) - around)
            self._high = np.maximum(self._high, flat.max(axis=0) + around)

    @property
    def box(self) -> tuple[Array, Array]:
        """Its smallest and largest coordinates (3,), (3,) along the axes of the camera [m]."""
        return self._low, self._high

    @property
    def extent(self) -> Array:
        """The edges (3,) of the box: across, up and along the line of sight [m]."""
        extent: Array = self._high - self._low
        return extent

    def camera(self, aspect: float) -> Camera:
        """For pictures of this width over height."""
        across, up, _ = self.extent
        height = FITTED_MARGIN * max(up, across / aspect)
        return self.camera_of_height(height if height > 0.0 else 1.0)

    def camera_of_height(self, height: float) -> Camera:
        """One that looks at the middle of the points, and sees this height [m]."""
        middle = 0.5 * (self._low + self._high)
        depth = 0.5 * self.extent[2] + 0.1 * height
        return Camera(self._axes, middle @ self._axes, float(height), float(depth))


def following(
    boxes: list[tuple[Array, Array]], whole: Camera, aspect: float
) -> tuple[float, Array]:
    """The height of what is seen [m] and the shifts (k, 3) of a camera in each frame [m].

    It stays where it holds all frames without making bodies small. Else it sees a height between
    those of the largest frame and of all, nearer to the first, and moves as little as holds the
    bodies in the middle.

    boxes: the corners (3,), (3,) of the bodies of each frame along the axes of the camera; whole:
    the camera that holds all frames; aspect: width over height.
    """
    low, high = (np.array(ends)[:, :2] for ends in zip(*boxes, strict=True))
    per_height = np.array([aspect, 1.0])
    largest = FITTED_MARGIN * float(((high - low) / per_height).max())
    still = np.zeros((len(boxes), 3))
    if largest <= 0.0 or whole.height <= MAX_TRAVEL * largest:
        return whole.height, still
    height = largest * float(np.cbrt(whole.height / largest))
    room = 0.5 * FOLLOWED_SHARE * height * per_height
    path = 0.5 * (low + high)
    for _ in range(PATH_ROUNDS):
        around = np.vstack([path[:1], path, path[-1:]])
        path = np.clip(0.5 * (around[:-2] + around[2:]), high - room, low + room)
    shifts: Array = (path - whole.axes[:2] @ whole.focus) @ whole.axes[:2]
    return height, shifts


def spread_of(samples: Iterable[Array]) -> Array:
    """Covariance (3, 3) of points (..., 3)."""
    points = np.concatenate([sample.reshape(-1, 3) for sample in samples])
    centered = points - points.mean(axis=0)
    covariance: Array = centered.T @ centered / len(points)
    return covariance
