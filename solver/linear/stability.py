"""Speeds at which rotors on bearings become unstable."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...files.progress import Progress, Work
from ..arrays import Array
from ..errors import ModelError
from ..model.model import Model
from .modes import MIN_GROWTH
from .rotors import rotor_at

# relative, of a spin from the threshold, by which its slope is found
BESIDE_THRESHOLD = 1e-3


@dataclass(frozen=True, eq=False)
class StabilityMap:
    """How fast the least damped mode of a rotor grows; see `stability_map` for an example.

    Parameters
    ----------
    spins : (n,) [rad/s]
    growth : (n,) [1/s]
        The largest real part of the eigenvalues of modes; negative: all decay.
    frequencies : (n,) [Hz]
        Of that mode.
    thresholds : (m,) [rad/s]
        Spins between which stability changes.
    """

    spins: Array
    growth: Array
    frequencies: Array
    thresholds: Array

    @property
    def unstable(self) -> NDArray[np.bool_]:
        """Whether a mode grows at each spin (n,)."""
        grows: NDArray[np.bool_] = self.growth > MIN_GROWTH * 2.0 * np.pi * self.frequencies
        return grows


def stability_map(
    model: Model, spins: Sequence[float], modes: int = 12, progress: bool = False
) -> StabilityMap:
    """The growth of the least damped mode of a rotor on bearings, over its spin.

    Parameters
    ----------
    model : Model
    spins : sequence of float [rad/s]
        Increasing, above zero. A change that comes and goes between two of them is not found.
    modes : int
        How many of the slowest modes are watched.
    progress : bool
        Report progress on stderr.

    Raises
    ------
    ModelError
        For what `rotor_at` refuses.

    Examples
    --------
    Damping c_i that turns with the shaft, beside c_e of the bearings, is cross coupling that grows
    with the spin. It wins above sqrt(k / m) (1 + c_e / c_i), here 200 rad/s times 1.5:

    >>> from duhamel.solver import Bearing, Frame, Model, RigidBody
    >>> disk = RigidBody(10.0, [0.1, 0.1, 0.2])
    >>> film = Bearing("film", ["ground.hub", "disk"], [0.0, 0.0, 1.0],
    ...                [[4e5, 0.0, 0.0, 4e5], [4e5, 8e4, -8e4, 4e5]],
    ...                [[300.0, 0.0, 0.0, 300.0]] * 2, speeds=[0.0, 400.0])
    >>> model = Model({"disk": disk}, bearings=[film], ground_frames={"hub": Frame()})
    >>> stability_map(model, [100.0, 400.0]).thresholds.round(3).tolist()
    [300.0]
    """
    speeds = np.asarray(spins, dtype=np.float64)
    if not len(speeds) or not (speeds > 0.0).all() or (np.diff(speeds) <= 0.0).any():
        raise ModelError("spins: expected numbers above 0 that increase")
    with Progress(Work("stability map", len(speeds), "speeds"), shown=progress) as work:
        found = []
        for spin in speeds.tolist():
            found.append(_least_damped(model, spin, modes))
            work.advance()
    margins = np.array([_margin(value) for value in found])
    changes = np.flatnonzero(margins[:-1] * margins[1:] < 0.0).tolist()
    thresholds = [_threshold(model, speeds[k], speeds[k + 1], modes) for k in changes]
    growth = np.array([value.real for value in found])
    frequencies = np.array([abs(value.imag) for value in found]) / (2.0 * np.pi)
    return StabilityMap(speeds, growth, frequencies, np.array(thresholds))


def _threshold(model: Model, low: float, high: float, modes: int) -> float:
    """The spin between two at which the least damped mode neither grows nor decays."""
    from scipy.optimize import brentq

    near = float(
        brentq(lambda spin: _margin(_least_damped(model, spin, modes)), low, high, rtol=1e-9)
    )
    # There the mode grows by the margin: its own line leads to where it does not.
    value, before = _least_damped(model, near, modes), near * (1.0 - BESIDE_THRESHOLD)
    values = rotor_at(model, before).modes(modes).values
    other = complex(values[np.argmin(np.abs(values - value))])
    return near - value.real * (near - before) / (value.real - other.real)


def _least_damped(model: Model, spin: float, modes: int) -> complex:
    """The eigenvalue with the largest real part among the slowest modes that something resists."""
    found = rotor_at(model, spin).modes(modes)
    values = found.values[found.rigid :]
    if not len(values):
        raise ModelError("stability: expected a mode that a bearing resists, found none")
    return complex(max(values.tolist(), key=_margin))


def _margin(value: complex) -> float:
    """How much faster a mode grows than rounding lets modes without damping grow [1/s]."""
    return value.real - MIN_GROWTH * abs(value)
