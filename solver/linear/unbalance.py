"""Responses of rotors to unbalance over the spin, in axes fixed in space.

An unbalance u = m e [kg m] at a frame of the shaft, at an angle phi from e_1 to e_2, is the force

    F(t) = Re(u Omega^2 exp(i phi) (e_1 - i e_2) exp(i Omega t))

which turns with the rotor. The answer is synchronous, Re(x exp(i Omega t)): every point of the
shaft moves on an ellipse. Source: docs/theory.md, Rotors.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...files.blas import one_blas_thread
from ...files.progress import Progress, Work
from ..arrays import Array
from ..errors import ModelError, about
from ..model.model import Model
from .inputs import channels, forcing, with_loads
from .modes import Complex
from .rotors import rotor_at, rotor_axes

# relative, of a peak over both its neighbors
LEAST_PEAK = 1e-9


@dataclass(frozen=True, eq=False)
class UnbalanceResponse:
    """Orbits of the points of a rotor under unbalance. See `unbalance_response` for an example.

    Parameters
    ----------
    spins : (n,) [rad/s]
    names : tuple of str
        Bodies, then frames.
    motion : (n, n_names, 2) complex [m]
        Amplitudes along e_1 and e_2, fixed in space, of Re(x exp(i Omega t)).
    axes : (2, 3)
        e_1 and e_2 in space: e_1 of the first bearing, and with the axis right-handed.
    """

    spins: Array
    names: tuple[str, ...]
    motion: Complex
    axes: Array

    def amplitude(self, name: str) -> Array:
        """The long semiaxis of the orbit of a point over the spin (n,) [m]."""
        forward, backward = self.circles(name)
        return np.abs(forward) + np.abs(backward)

    def circles(self, name: str) -> tuple[Complex, Complex]:
        """Amplitudes (n,) [m] of the circles with the spin and against it, which make the orbit."""
        if name not in self.names:
            known = ", ".join(self.names)
            raise ModelError(f"unbalance: no point {name!r}; there are: {known}")
        y, z = self.motion[:, self.names.index(name)].T
        return 0.5 * (y + 1j * z), 0.5 * np.conj(y - 1j * z)

    def peaks(self, name: str) -> list[tuple[float, float]]:
        """Spins [rad/s] at which the orbit of a point is largest, and how large it is there [m].

        By a parabola through the highest of the spins and its neighbors.
        """
        size, spins = self.amplitude(name), self.spins
        found = []
        for k in range(1, len(size) - 1):
            before, top, after = size[k - 1 : k + 2]
            if top <= before * (1.0 + LEAST_PEAK) or top < after:
                continue
            a, b, c = np.polyfit(spins[k - 1 : k + 2] - spins[k], size[k - 1 : k + 2], 2)
            found.append((float(spins[k] - 0.5 * b / a), float(c - 0.25 * b * b / a)))
        return found


def unbalance_response(
    model: Model,
    unbalance: Mapping[str, complex],
    spins: Sequence[float],
    progress: bool = False,
) -> UnbalanceResponse:
    """Synchronous orbits of a rotor on bearings under unbalance, over its spin.

    Parameters
    ----------
    model : Model
    unbalance : mapping of complex [kg m]
        By frames of the shaft: mass times eccentricity, at an angle from e_1 to e_2.
    spins : sequence of float [rad/s]
        Increasing, above zero.
    progress : bool
        Report progress on stderr.

    Returns
    -------
    UnbalanceResponse

    Raises
    ------
    ModelError
        For a name that there is not, a spin at which the rotor resonates without damping, and what
        `rotor_at` refuses.

    Examples
    --------
    A disk of 10 kg on 4e5 N/m, by 1 g m, at its critical speed of 200 rad/s with a damping ratio of
    0.05:

    >>> from duhamel.solver import Bearing, Frame, Model, RigidBody
    >>> disk = RigidBody(10.0, [0.1, 0.1, 0.2])
    >>> film = Bearing("film", ["ground.hub", "disk"], [0.0, 0.0, 1.0], 4e5, 200.0)
    >>> model = Model({"disk": disk}, bearings=[film], ground_frames={"hub": Frame()})
    >>> response = unbalance_response(model, {"disk": 1e-3}, [100.0, 200.0])
    >>> response.amplitude("disk").round(6).tolist()
    [3.3e-05, 0.001]
    """
    speeds = np.asarray(spins, dtype=np.float64)
    if not (len(speeds) and np.isfinite(speeds).all() and (speeds > 0.0).all()):
        raise ModelError("spins: expected numbers above 0")
    if (np.diff(speeds) <= 0.0).any():
        raise ModelError("spins: expected numbers that increase")
    if not unbalance:
        raise ModelError("unbalance: expected at least one frame of the shaft, got none")
    for name, value in unbalance.items():
        if not np.isfinite(complex(value)):
            raise ModelError(f"unbalance: {name}: expected a number in kg m, got {value}")
    with about(model.path):
        axes = rotor_axes(model).across
        inputs = [f"force:{name}:{k}" for name in unbalance for k in "xyz"]
        loaded = with_loads(model, inputs)
    # e_1 - i e_2: a force along e_1 now is along e_2 a quarter turn later.
    turning = axes[0] - 1j * axes[1]
    columns = np.concatenate([complex(u) * turning for u in unbalance.values()])
    names: tuple[str, ...] = ()
    rows = []
    with Progress(Work("unbalance response", len(speeds), "speeds"), shown=progress) as work:
        for spin in speeds.tolist():
            linear = rotor_at(loaded, spin)
            with one_blas_thread(), about(model.path):
                form, pose = linear.first_order, linear.equations.pose
                forced = form.forced(forcing(pose, channels(model, pose.lowered, inputs)))
                state = form.synchronous(forced @ (spin**2 * columns)[:, None])
                motion = linear.motion(form.split(state)[0])
            names = motion.names
            rows.append(np.einsum("nck,ac->na", motion.translations, axes))
            work.advance()
    return UnbalanceResponse(speeds, names, np.array(rows), axes)
