"""Campbell diagrams: frequencies of a mechanism in steady rotation over its spin.

Points on the axis move as y + i z = p exp(i omega t) + m exp(-i omega t) in axes that turn with
the mechanism; in space they whirl with omega + spin and spin - omega. The larger of p and m says
which one a mode has: with the spin (forward) or against it (backward). Modes that leave the axis
where it is keep the frequency that the mechanism sees.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...files.progress import Progress, Work
from ..arrays import Array
from ..couplings.joint import basis_about
from ..errors import ModelError, about
from ..model.model import Model
from ..model.settings import SteadyRotation
from .campbell_lines import (
    BACKWARD,
    FORWARD,
    NONE,
    Line,
    Point,
    followed_lines,
    lines_by_whirl,
    whirling_alike,
)
from .linearize import LinearModel, linearize
from .modes import Complex, LinearModes
from .motion import Motion
from .pose import Pose
from .rotors import rotor_at
from .validity import LinearValidity

# of the largest spin: pairs of modes at rest, which coincide, are told apart there
NEGLIGIBLE_SPIN = 1e-8
# of the largest spin: at rest modes of unequal planes whirl neither way, but here they do
LEAST_WHIRLING_SPIN = 1e-4
ON_AXIS = 1e-3
"""distance from the axis, relative to the size of the model, of points that whirl with it"""
# of the axis in the motion of a mode; below, it does not whirl
MIN_AXIS_SHARE = 1e-3
# relative difference of eigenvalues
COINCIDENT_MODES = 1e-4
# of modes that coincide, above which they are taken as they are
MAX_MODE_CONDITION = 1e6
# more than asked for, so that modes that cross are followed
MIN_MODES_SOUGHT = 12
# relative: a motion in a plane, which whirls neither way, counts as forward at every spin
EVEN_CIRCLES = 1e-6


@dataclass(frozen=True)
class Crossing:
    """A speed at which a line meets an engine order: spin [rad/s], frequency [Hz]."""

    line: int
    order: float
    spin: float
    frequency: float


@dataclass(frozen=True, eq=False)
class Campbell:
    """Frequencies over spins, as lines in the order of their frequencies.

    See `campbell` for an example.

    Parameters
    ----------
    spins : (n,) [rad/s]
    lines : tuple of Line
    unstable : (n,) bool
        Whether a mode grows at each spin.
    validity : LinearValidity
        At the largest spin.
    """

    spins: Array
    lines: tuple[Line, ...]
    unstable: NDArray[np.bool_]
    """whether a mode grows at each spin (n,)"""
    validity: LinearValidity
    """at the largest spin"""

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


def campbell(
    model: Model, spins: Sequence[float], modes: int = 8, progress: bool = False
) -> Campbell:
    """The first modes of a model over spins about the axis of its steady rotation.

    Drives that turn the model follow the spin.

    Parameters
    ----------
    model : Model
    spins : sequence of float [rad/s]
    modes : int
        The number of lines.
    progress : bool
        Report progress on stderr.

    Returns
    -------
    Campbell

    Raises
    ------
    ModelError
        For a model without bearings or a `steady_rotation`, whose axis and center count, and for
        what `linearize` or, with bearings, `rotor_at` refuses.

    Examples
    --------
    A rotor on a flexible mount, whose backward and forward whirl part with the spin:

    >>> from duhamel.solver import Model, RigidBody, Settings, Spherical, Spring, SteadyRotation
    >>> disk = RigidBody(1.0, [0.1, 0.1, 0.2], {"left": [0.0, 0.0, -0.2], "right": [0.0, 0.0, 0.2]})
    >>> mount = Spring("mount", "bushing", ["ground", "disk.right"], axis=[0.0, 0.0, 1.0],
    ...                stiffness=[4e4, 4e4, 4e4, 0.0, 0.0, 0.0])
    >>> steady = SteadyRotation((0.0, 0.0, 5.0))
    >>> diagram = campbell(Model(
    ...     {"disk": disk}, joints=[Spherical("ground", "disk.left")], springs=[mount],
    ...     settings=Settings(t_end=1.0, step=1e-3, start="equilibrium", steady_rotation=steady),
    ... ), [0.0, 10.0])
    >>> [(line.whirl, line.frequencies.round(2).tolist()) for line in diagram.lines]
    [('backward', [34.03, 32.91]), ('forward', [34.03, 35.18])]
    """
    linear_at = _linear_at(model)
    speeds = np.asarray(spins, dtype=np.float64)
    if not len(speeds) or (speeds < 0.0).any() or (np.diff(speeds) <= 0.0).any():
        raise ModelError("spins: expected numbers >= 0 that increase")
    found = []
    with Progress(Work("Campbell diagram", len(speeds), "speeds"), shown=progress) as work:
        # At exactly zero, forward and backward modes coincide and would be mixed at random.
        for speed in np.maximum(speeds, NEGLIGIBLE_SPIN * speeds[-1]).tolist():
            linear = linear_at(speed)
            found.append(_slowest_in_space(linear, modes))
            work.advance()
        slow = LEAST_WHIRLING_SPIN * float(speeds[-1])
        if speeds[0] < slow:
            whirling, _ = _slowest_in_space(linear_at(slow), 2 * modes)
            still, grows_at_rest = found[0]
            found[0] = whirling_alike(still, whirling, slow), grows_at_rest
    grows = np.array([unstable for _, unstable in found])
    points = [points for points, _ in found]
    highest = [point.frequency for of_spin in points for point in of_spin]
    if linear.in_space:
        # Whirl in unequal bearings may change its sense along a line: shapes tell what goes on.
        lines = followed_lines(speeds, points, modes)
    else:
        lines = list(lines_by_whirl(points, modes))
    return Campbell(speeds, tuple(lines), grows, linear.validity(None, highest))


def _linear_at(model: Model) -> Callable[[float], LinearModel]:
    """What linearizes a model at a spin: in axes fixed in space where not all turns as one."""
    rotation = model.settings.steady_rotation
    if model.bearings or (rotation is not None and rotation.speed_ratios):
        return lambda spin: rotor_at(model, spin)
    if rotation is None or not np.any(rotation.angular_velocity):
        with about(model.path):
            raise ModelError("simulation: a Campbell diagram needs the axis of a steady_rotation")
    axis, center = rotation.angular_velocity, rotation.center
    axis = axis / np.linalg.norm(axis)
    return lambda spin: linearize(model, SteadyRotation(spin * axis, center))


def _slowest_in_space(linear: LinearModel, n: int) -> tuple[list[Point], bool]:
    """The n modes that are slowest in space, and whether a mode grows.

    A mode at f in space is seen at up to f + spin from the mechanism: so far modes are found.
    """
    asked = max(2 * n, MIN_MODES_SOUGHT)
    while True:
        modes = linear.modes(asked)
        # Lines that follow shapes need modes beyond the first, with which these change places.
        kept = 2 * n if linear.in_space else n
        points = sorted(_points(linear, modes), key=lambda point: point.frequency)[:kept]
        # All modes of the model have been found.
        if len(modes) < asked:
            break
        # Modes that have not been found are faster than this in space, too.
        carried = 0.0 if linear.in_space else linear.spin
        reach = (float(np.abs(modes.values[-1])) - carried) / (2.0 * np.pi)
        if len(points) >= n and points[n - 1].frequency <= reach:
            break
        asked *= 2
    return points, bool(modes.unstable.any())


def _points(linear: LinearModel, modes: LinearModes) -> Iterator[Point]:
    spin = linear.spin
    for members in _alike(modes):
        for whirl, value, shape in _whirls(linear, modes, members):
            omega = abs(value.imag)
            seen = omega
            if not linear.in_space:
                seen = {FORWARD: spin + omega, BACKWARD: spin - omega, NONE: omega}[whirl]
            if whirl != NONE and not linear.in_space:
                # A backward mode that is slower than the spin is carried forward by it.
                whirl = FORWARD if seen > 0.0 else BACKWARD
            if omega > 0.0:
                yield Point(whirl, abs(seen) / (2.0 * np.pi), -value.real / abs(value), shape)


def _alike(modes: LinearModes) -> Iterator[list[int]]:
    """Numbers of modes, those whose eigenvalues nearly coincide together."""
    group: list[int] = []
    for k in range(modes.rigid, len(modes)):
        value = modes.values[k]
        if group and abs(value - modes.values[group[-1]]) > COINCIDENT_MODES * abs(value):
            yield group
            group = []
        group.append(k)
    if group:
        yield group


def _whirls(
    linear: LinearModel, modes: LinearModes, members: list[int]
) -> Iterator[tuple[str, complex, Complex]]:
    """Whirl, eigenvalue and shape of modes that nearly coincide.

    Their motions y + i z = p exp(i omega t) + m exp(-i omega t) are combined to those in which
    |p|^2 - |m|^2 over the axis is least and largest: so two planes at rest become two circles.
    """
    form, pose = linear.first_order, linear.equations.pose
    y = modes.y[:, members]
    # Of coinciding modes any combination is a mode: those of unit kinetic energy are comparable.
    a = form.coordinates @ y  # the inertia is a unit matrix there
    R = np.linalg.qr(a)[1]
    if np.linalg.cond(R) > MAX_MODE_CONDITION:
        R = np.eye(len(members))
    motion = linear.motion(y @ np.linalg.inv(R))
    with_spin, against, whole = _circles(motion, pose)
    # A motion of modes alone may not move any point: the product would be singular.
    whole = whole + np.eye(len(members)) / float(pose.system.bodies.mass.sum())
    _, combined = np.linalg.eigh(_square(with_spin) - _square(against))
    values = R @ np.diag(modes.values[members]) @ np.linalg.inv(R)
    for x in combined.T:
        p, m = (float((np.abs(part @ x) ** 2).sum()) for part in (with_spin, against))
        value = complex(x.conj() @ values @ x)
        shape = a @ np.linalg.solve(R, x)
        if p + m <= MIN_AXIS_SHARE * float((x.conj() @ whole @ x).real):
            yield NONE, value, shape
        else:
            yield FORWARD if p >= (1.0 - EVEN_CIRCLES) * m else BACKWARD, value, shape


def _square(matrix: Complex) -> Complex:
    square: Complex = matrix.conj().T @ matrix
    return square


def _circles(motion: Motion, pose: Pose) -> tuple[Complex, Complex, Complex]:
    """Circles of points on the axis with the spin and against it (n, k), and the square of all.

    Of translations and of rotations times the size of the model. The last (k, k) are products of
    all points, whose turning about the axis and motion along it counts: torsion does not whirl.
    """
    size, axis = pose.system.bodies.size, pose.angular_velocity / pose.speed
    first, second, _ = basis_about(axis, np.eye(3)).T
    arms = motion.points - pose.center
    off = np.linalg.norm(arms - np.outer(arms @ axis, axis), axis=1)
    # Supports shake, but the rotor alone whirls.
    near = (off <= ON_AXIS * size) & (pose.ratios[motion.bodies] != 0.0)
    # Rotations across the axis whirl as displacements do: shafts between bearings bend so.
    moved = np.concatenate([motion.translations[near], size * motion.rotations[near]])
    y, z = np.einsum("nck,c->nk", moved, first), np.einsum("nck,c->nk", moved, second)
    everything = np.concatenate([motion.translations, size * motion.rotations])
    return y + 1j * z, y - 1j * z, _square(everything.reshape(-1, everything.shape[2]))
