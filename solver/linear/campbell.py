"""Campbell diagrams: frequencies of a mechanism in steady rotation over its spin.

Points on the axis move as y + i z = p exp(i omega t) + m exp(-i omega t) in axes that turn with
the mechanism; in space they whirl with omega + spin and spin - omega. The larger of p and m says
which one a mode has: with the spin (forward) or against it (backward). Modes that leave the axis
where it is keep the frequency that the mechanism sees.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..model.model import Model
from ..model.settings import SteadyRotation
from .linearize import LinearModel, linearize
from .modes import LARGEST
from .motion import Motion

STILL = 1e-8
"""of the largest spin, at which pairs of modes at rest are told apart"""
ON_AXIS = 1e-3
"""distance from the axis, relative to the size of the model, of points that whirl with it"""
FAINT = 1e-3
"""share of the axis in the motion of a mode, below which it does not whirl"""
FORWARD, BACKWARD, NONE = "forward", "backward", "none"


@dataclass(frozen=True)
class Line:
    """A line of a Campbell diagram.

    whirl: "forward", "backward" or "none"; frequencies (n,) in space [Hz], or those that the
    mechanism sees where it does not whirl; ratios (n,): of damping; NaN where the line has ended.
    """

    whirl: str
    frequencies: Array
    ratios: Array


@dataclass(frozen=True)
class Crossing:
    """A speed at which a line meets an engine order: spin [rad/s], frequency [Hz]."""

    line: int
    order: float
    spin: float
    frequency: float


@dataclass(frozen=True, eq=False)
class Campbell:
    """Frequencies over spins (n,) [rad/s], as lines in the order of their frequencies."""

    spins: Array
    lines: tuple[Line, ...]

    def crossings(self, order: float = 1.0) -> list[Crossing]:
        """Where lines meet order * spin / (2 pi), in the order of the spins."""
        return sorted(
            (
                Crossing(k, order, spin, order * spin / (2.0 * np.pi))
                for k, line in enumerate(self.lines)
                for spin in _roots(self.spins, line.frequencies, order)
            ),
            key=lambda crossing: crossing.spin,
        )


def _roots(spins: Array, frequencies: Array, order: float) -> Iterator[float]:
    """Spins at which a line meets an order, by a cubic through its points."""
    from scipy.interpolate import CubicSpline

    known = np.isfinite(frequencies)
    if known.sum() < 2:
        return
    x = spins[known]
    apart = CubicSpline(x, frequencies[known] - order * x / (2.0 * np.pi))
    for root in apart.roots(extrapolate=False).tolist():
        if root > 0.0:
            yield root


def campbell(model: Model, spins: Sequence[float], modes: int = 8) -> Campbell:
    """The first modes of a model over spins [rad/s], about the axis of its steady rotation.

    ModelError for a model without `steady_rotation`, whose axis and center count, and what
    `linearize` refuses.
    """
    rotation = model.settings.steady_rotation
    if rotation is None or not np.any(rotation.angular_velocity):
        raise ModelError("simulation: a Campbell diagram needs the axis of a steady_rotation")
    speeds = np.asarray(spins, dtype=np.float64)
    if not len(speeds) or (speeds < 0.0).any() or (np.diff(speeds) <= 0.0).any():
        raise ModelError("spins: expected numbers >= 0 that increase")
    axis = rotation.angular_velocity / np.linalg.norm(rotation.angular_velocity)
    points = []
    for speed in np.maximum(speeds, STILL * speeds[-1]).tolist():
        turned = SteadyRotation(speed * axis, rotation.center)
        points.append(_points(linearize(model, turned), modes))
    return Campbell(speeds, tuple(_lines(points, modes)))


Point = tuple[str, float, float]
"""whirl, frequency [Hz] and damping ratio of a mode"""


def _points(linear: LinearModel, n: int) -> list[Point]:
    """The n slowest modes in space, of four times as many: others are slow in the mechanism."""
    form, spin = linear.first_order, linear.spin
    modes = linear.modes(None if form.n <= LARGEST else 4 * n)
    motion = linear.motion(modes.y)
    points = []
    for k in range(len(modes)):
        omega = abs(float(modes.values[k].imag))
        whirl = _whirl(linear, motion, k)
        seen = {FORWARD: spin + omega, BACKWARD: spin - omega, NONE: omega}[whirl]
        if whirl != NONE:
            whirl = FORWARD if seen > 0.0 else BACKWARD
        if omega > 0.0:
            points.append((whirl, abs(seen) / (2.0 * np.pi), float(modes.ratios[k])))
    return sorted(points, key=lambda point: point[1])[:n]


def _whirl(linear: LinearModel, motion: Motion, k: int) -> str:
    pose = linear.equations.pose
    axis = pose.angular_velocity / pose.speed
    first, second = _across(axis)
    arms = motion.points - pose.center
    off = np.linalg.norm(arms - np.outer(arms @ axis, axis), axis=1)
    near = off <= ON_AXIS * pose.system.bodies.size
    size = pose.system.bodies.size
    moved = np.vstack([motion.translations[near, :, k], size * motion.rotations[near, :, k]])
    y, z = moved @ first, moved @ second
    with_spin = float((np.abs(y + 1j * z) ** 2).sum())
    against = float((np.abs(y - 1j * z) ** 2).sum())
    whole = float((np.abs(motion.translations[:, :, k]) ** 2).sum())
    if with_spin + against <= FAINT * whole:
        return NONE
    return FORWARD if with_spin >= against else BACKWARD


def _across(axis: Array) -> tuple[Array, Array]:
    """Two axes across, in the sense of a rotation about it."""
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def _lines(points: Sequence[Sequence[Point]], n: int) -> Iterator[Line]:
    """Lines of the modes of each kind of whirl, by their order."""
    found = []
    for whirl in (FORWARD, BACKWARD, NONE):
        sets = [[p for p in spin if p[0] == whirl] for spin in points]
        for k in range(max(map(len, sets))):
            rows = [one[k][1:] if k < len(one) else (np.nan, np.nan) for one in sets]
            frequencies, ratios = np.array(rows).T
            found.append(Line(whirl, frequencies, ratios))
    found.sort(key=lambda line: float(np.nanmin(line.frequencies)))
    yield from found
