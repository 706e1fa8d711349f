"""Responses of rotors to unbalance over the spin, in axes fixed in space.

An unbalance u = m e [kg m] at a frame of the shaft, at an angle phi from e_1 to e_2, is the force

    F(t) = Re(u Omega^2 exp(i phi) (e_1 - i e_2) exp(i Omega t))

which turns with the rotor. The answer is synchronous, Re(x exp(i Omega t)): every point of the
shaft moves on an ellipse. Source: docs/theory.md, Rotors.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...files.blas import one_blas_thread
from ...files.progress import Progress, Work
from ..arrays import Array
from ..errors import ModelError, about
from ..model.model import Model
from ..model.speed_ratios import speed_ratios
from .inputs import channels, forcing, with_loads
from .modes import Complex
from .motion import Motion
from .rotors import rotor_at, rotor_axes

# relative, of a peak over both its neighbors
LEAST_PEAK = 1e-9
# relative, of the size of a peak from one solution to the next
PEAK_TOLERANCE = 1e-4
# of a peak, after which nothing limits it
MAX_SOLUTIONS = 40
# of the wider side of a bracket: a spin that counts as solved, and another one in its place
NEAREST, CUT = 1e-6, 0.38


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
    at : function
        The motion (n_names, 2) at any other spin [rad/s].
    """

    spins: Array
    names: tuple[str, ...]
    motion: Complex
    axes: Array
    at: Callable[[float], Complex]

    def amplitude(self, name: str) -> Array:
        """The long semiaxis of the orbit of a point over the spin (n,) [m]."""
        return _long_semiaxis(*self._along(name))

    def circles(self, name: str) -> tuple[Complex, Complex]:
        """Amplitudes (n,) [m] of the circles with the spin and against it, which make the orbit."""
        y, z = self._along(name)
        return 0.5 * (y + 1j * z), 0.5 * np.conj(y - 1j * z)

    def _along(self, name: str) -> Complex:
        """The motion of a point along e_1 and e_2 (2, n)."""
        if name not in self.names:
            known = ", ".join(self.names)
            raise ModelError(f"unbalance: no point {name!r}; there are: {known}")
        return self.motion[:, self.names.index(name)].T

    def peaks(self, name: str) -> list[tuple[float, float]]:
        """Spins [rad/s] at which the orbit of a point is largest, and how large it is there [m].

        Those between the spins: the response is solved at more spins beside each until its size
        changes by less than 1e-4. inf where nothing damps it.
        """
        size, spins = self.amplitude(name), self.spins
        number = self.names.index(name)

        def amplitude(spin: float) -> float:
            return float(_long_semiaxis(*self.at(spin)[number]))

        found = []
        for k in range(1, len(size) - 1):
            before, top, after = size[k - 1 : k + 2]
            if top <= before * (1.0 + LEAST_PEAK) or top < after:
                continue
            found.append(_peak(amplitude, spins[k - 1 : k + 2].tolist(), [before, top, after]))
        return found


def _long_semiaxis(y: Complex, z: Complex) -> Array:
    size: Array = 0.5 * (np.abs(y + 1j * z) + np.abs(y - 1j * z))
    return size


def _peak(
    amplitude: Callable[[float], float], spins: list[float], sizes: list[float]
) -> tuple[float, float]:
    """The spin of the largest size, and the size; the middle one of three spins has the largest."""
    for _ in range(MAX_SOLUTIONS):
        (low, middle, high), top = spins, sizes[1]
        # About a resonance 1 / size^2 is a parabola, however narrow the peak is beside the spins.
        inverse = (top / np.maximum(sizes, LEAST_PEAK * top)) ** 2
        a, b, c = np.polyfit(np.subtract(spins, middle), inverse, 2).tolist()
        spin = middle - 0.5 * b / a if a > 0.0 else middle
        wider = max(high - middle, low - middle, key=abs)
        if not low < spin < high or abs(spin - middle) < NEAREST * abs(wider):
            spin = middle + CUT * wider
        try:
            size = amplitude(spin)
        except ModelError:
            return spin, np.inf  # it resonates without damping
        away = spin - middle
        foreseen = (a * away**2 + b * away + c) * (size / top) ** 2
        # That it foresees what had not been solved shows that the parabola is that of the peak.
        if abs(foreseen - 1.0) < 2.0 * PEAK_TOLERANCE:
            return max((spin, size), (middle, top), key=lambda found: found[1])
        if size > top:
            spins = [middle, spin, high] if away > 0.0 else [low, spin, middle]
            sizes = [top, size, sizes[2]] if away > 0.0 else [sizes[0], size, top]
        else:
            spins = [low, middle, spin] if away > 0.0 else [spin, middle, high]
            sizes = [sizes[0], top, size] if away > 0.0 else [size, top, sizes[2]]
        if not spins[0] < spins[1] < spins[2]:
            break
    return spins[1], np.inf


def unbalance_response(
    model: Model, unbalance: Mapping[str, complex], spins: Sequence[float], progress: bool = False
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
        ratio = _common_ratio(model, unbalance)
    # e_1 - i e_2: a force along e_1 now is along e_2 a quarter turn later.
    turning = axes[0] - 1j * axes[1]
    columns = np.concatenate([complex(u) * turning for u in unbalance.values()])

    def motion_at(spin: float) -> Motion:
        linear = rotor_at(loaded, spin)
        with one_blas_thread(), about(model.path):
            form, pose = linear.first_order, linear.equations.pose
            forced = form.forced(forcing(pose, channels(model, pose.lowered, inputs)))
            state = form.synchronous(forced @ ((ratio * spin) ** 2 * columns)[:, None], ratio)
            return linear.motion(form.split(state)[0])

    def across(motion: Motion) -> Complex:
        along: Complex = np.einsum("nck,ac->na", motion.translations, axes)
        return along

    names: tuple[str, ...] = ()
    rows = []
    with Progress(Work("unbalance response", len(speeds), "speeds"), shown=progress) as work:
        for spin in speeds.tolist():
            motion = motion_at(spin)
            names = motion.names
            rows.append(across(motion))
            work.advance()
    return UnbalanceResponse(
        speeds, names, np.array(rows), axes, lambda spin: across(motion_at(spin))
    )


def _common_ratio(model: Model, unbalance: Mapping[str, complex]) -> float:
    """The speed of the shaft that carries the unbalance over the spin; ModelError for several."""
    ratios = speed_ratios(model, model.settings.steady_rotation)
    found = {name: ratios[name.partition(".")[0]] for name in unbalance}
    (first, ratio), *others = found.items()
    if ratio == 0.0:
        raise ModelError(f"unbalance: {first}: expected a frame of a shaft, which turns")
    for name, other in others:
        if other != ratio:
            raise ModelError(
                f"unbalance: {first} and {name} turn at different speeds: expected unbalance of "
                "one shaft"
            )
    return ratio
