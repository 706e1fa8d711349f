"""Warnings about a model that is unlike any machine, most often by a wrong unit.

They refuse nothing. Each is one line: the key, what was found there, what is usual.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .arrays import Array
from .errors import about
from .lower.scheme import stepping_of
from .model.bodies import Body, FlexibleBody
from .model.model import Model
from .signals.curves import Constant, Harmonic, Polynomial, Pulse, Steps
from .signals.noise import Noise, ShapedNoise
from .signals.profiles import Chirp, HalfSine, LogarithmicChirp, Sawtooth, Trapezoid
from .signals.signal import Signal, breaks_of, parts_of, values_of

FULL_TURN = 2.0 * np.pi
OTHER_UNITS = {
    "mm/s^2": (9780.0, 9833.0),
    "cm/s^2": (978.0, 983.3),
    "in/s^2": (385.0, 387.2),
    "ft/s^2": (32.08, 32.27),
    "km/s^2 or mm/ms^2": (9.78e-3, 9.833e-3),
}
"""Gravity on Earth, from equator to pole, in units that are not m/s^2."""
OSMIUM_DENSITY = 25_000.0
"""Density [kg/m^3], above that of any solid."""
MIN_INERTIA_RATIO = 1e-3
"""Trace of an inertia over that of a ball of osmium, below which it is taken for an error."""
MAX_GYRATION_RATIO = 100.0
"""Radius of gyration of a body over the size of the model, of no body."""
GYRATION_RADII = (1e-5, 100.0)
"""Radii of gyration of flexible bodies [m]."""
MAX_SIZE_RATIO = 1000.0
"""Ratio of those of two flexible bodies, as of meters and millimeters."""
MAX_PLAUSIBLE_SPEED = 5000.0
"""Speed [m/s] of bodies and their frames, about that of sound in steel."""
MAX_NYQUIST_RATIO = 10.0
"""First frequency of a free body over the Nyquist frequency of the step."""
MIN_SIGNAL_STEPS = 4.0
"""Steps in a period of a signal."""


SIGNAL_SAMPLES = 33
"""Times of a run at which a signal that begins after it is looked at."""

MIN_CLEARANCE_RATIO = 0.05
"""Clearance of a ball in a bore over its radius, below which the surfaces are nearly alike."""
SMALL_PATCH = 0.17
"""Size of Hertz's patch over the radius, up to which his law holds to 1 % (docs/validity.md)."""

PULSE_CLASSES = (HalfSine, Trapezoid, Sawtooth)
WITH_PHASE = (Harmonic, Chirp, LogarithmicChirp)


class Implausible(NamedTuple):
    """A line about a value that is implausible.

    Parameters
    ----------
    text : str
    severe : bool
        A run will almost certainly mean nothing.

    Examples
    --------
    >>> Implausible("ball: 1e+06 kg").severe
    False
    """

    text: str
    severe: bool = False


def plausibility_warnings(model: Model) -> tuple[Implausible, ...]:
    """Warnings about values that no machine has.

    Parameters
    ----------
    model : Model

    Returns
    -------
    tuple of Implausible

    Raises
    ------
    ModelError
        For a model without a step.

    Examples
    --------
    >>> from duhamel.solver import Model, RigidBody, Settings
    >>> ball = RigidBody(1.0, [0.1, 0.1, 0.1])
    >>> plausibility_warnings(Model({"ball": ball}, settings=Settings(t_end=1.0, step=0.1)))
    ()
    """
    with about(model.path):
        stepping = stepping_of(model)
    h = stepping.h * stepping.ratio
    return (
        *_of_gravity(model),
        *_of_bodies(model),
        *_of_sizes(model),
        *_of_angles(model),
        *_of_signals(model, h),
        *_of_contacts(model),
        *_of_step(model, h),
    )


def severe_warnings(model: Model) -> Iterator[str]:
    """The text of the warnings that every run repeats."""
    return (found.text for found in plausibility_warnings(model) if found.severe)


def _of_gravity(model: Model) -> Iterator[Implausible]:
    size = float(np.linalg.norm(model.gravity))
    for unit, (least, most) in OTHER_UNITS.items():
        if least <= size <= most:
            yield Implausible(
                f"simulation.gravity is {size:g} m/s^2, on Earth it is 9.81: is it in {unit}?",
                severe=True,
            )


def _of_bodies(model: Model) -> Iterator[Implausible]:
    size = _size(model)
    for name, body in model.bodies.items():
        yield from _of_inertia(name, body, size)
        yield from _of_speed(name, body)


def _of_inertia(name: str, body: Body, size: float) -> Iterator[Implausible]:
    """Warnings about an inertia: a mass that is too dense for it, or too light.

    Of all bodies of a mass and a density a ball has the least tr J = 6/5 m r^2.
    """
    is_flexible = isinstance(body, FlexibleBody)
    key = f"bodies.{name}.{'superelement' if is_flexible else 'inertia'}"
    trace, radius = float(np.trace(body.inertia)), _gyration(body)
    ball = (0.75 * body.mass / (np.pi * OSMIUM_DENSITY)) ** (1.0 / 3.0)
    if trace < MIN_INERTIA_RATIO * 1.2 * body.mass * ball**2:
        yield Implausible(
            f"{key}: {body.mass:g} kg with a radius of gyration of {radius:.2g} m would be denser "
            f"than any solid, usual is {ball:.2g} m or more: mass in t, inertia in other units?"
        )
    # A model that is a point has no size to compare with.
    if not is_flexible and size > GYRATION_RADII[0] and radius > MAX_GYRATION_RATIO * size:
        yield Implausible(
            f"{key}: a radius of gyration, sqrt(tr J / 2 m), of {radius:.3g} m in a model of "
            f"{size:.3g} m: is the inertia in kg mm^2, or the mass in t?"
        )


def _of_speed(name: str, body: Body) -> Iterator[Implausible]:
    # Spin alone is no speed: that of the farthest frame counts.
    tip = _length(body.start.angular_velocity) * _reach(body)
    for key, speed in (("velocity", _length(body.start.velocity)), ("angular_velocity", tip)):
        if speed > MAX_PLAUSIBLE_SPEED:
            yield Implausible(
                f"bodies.{name}.{key} makes {speed:.3g} m/s, as fast as sound in steel: "
                "usual is some 100 m/s: is it in other units?"
            )


def _size(model: Model) -> float:
    """The largest distance between what the model places, frames and bodies [m]; 0 for a point."""
    reaches = [_reach(body) for body in model.bodies.values()]
    reaches += [_gyration(body) for body in model.flexible_bodies.values()]
    placed = [body.start.position for body in model.bodies.values() if body.start.place is None]
    placed += [frame.position for frame in model.ground_frames.values()]
    extent = np.ptp(np.array(placed), axis=0) if placed else np.zeros(3)
    return max(*reaches, _length(extent))


def _of_sizes(model: Model) -> Iterator[Implausible]:
    """Warnings about the units of the meshes that superelements came from."""
    sizes = {name: _gyration(body) for name, body in model.flexible_bodies.items()}
    for name, size in sizes.items():
        # Meshes in mm that are read as m make parts of hundreds of meters.
        if not GYRATION_RADII[0] <= size <= GYRATION_RADII[1]:
            yield Implausible(
                f"bodies.{name}.superelement has a radius of gyration of {size:.3g} m, of parts "
                f"{GYRATION_RADII[0]:g} to {GYRATION_RADII[1]:g} m: was its mesh in other units "
                "(scale)?"
            )
    if sizes and max(sizes.values()) > MAX_SIZE_RATIO * min(sizes.values()):
        small, large = min(sizes, key=sizes.__getitem__), max(sizes, key=sizes.__getitem__)
        yield Implausible(
            f"bodies.{small}.superelement has a radius of gyration of {sizes[small]:.3g} m, "
            f"bodies.{large}.superelement of {sizes[large]:.3g} m: was one of their meshes in "
            "millimeters (scale = 1e-3)?"
        )


def _gyration(body: Body) -> float:
    """The radius of gyration sqrt(tr J / 2 m) [m]."""
    return float(np.sqrt(0.5 * np.trace(body.inertia) / body.mass))


def _reach(body: Body) -> float:
    """The largest distance of a frame from the center of mass [m]."""
    return max((_length(frame.position) for frame in body.frames.values()), default=0.0)


def _of_angles(model: Model) -> Iterator[Implausible]:
    """Angles of more than a turn, which are given in degrees more often than meant."""
    for key, angle in _angles(model):
        if np.isfinite(angle) and abs(angle) > FULL_TURN:
            yield Implausible(
                f"{key} is {angle:g} rad, {abs(angle) / FULL_TURN:.3g} turns, "
                "usual is one at most: "
                "is it in degrees?",
                severe=True,
            )


def _angles(model: Model) -> Iterator[tuple[str, float]]:
    """All numbers that are angles, with their keys."""
    for name, body in model.bodies.items():
        yield f"bodies.{name}.rotation", _length(body.start.rotation)
        if not isinstance(body, FlexibleBody):
            for frame, place in body.frames.items():
                yield f"bodies.{name}.frames.{frame}.rotation", _length(place.rotation)
    for frame, place in model.ground_frames.items():
        yield f"ground.frames.{frame}.rotation", _length(place.rotation)
    for coupling in model.couplings:
        for key, angle in coupling.given_angles():
            whole_key = f"{coupling.group}.{coupling.name}.{key}"
            if isinstance(angle, float):
                yield whole_key, angle
            else:
                yield from _angles_of_signal(whole_key, angle)


def _angles_of_signal(key: str, signal: Signal) -> Iterator[tuple[str, float]]:
    """What is an angle in a signal that drives one, and the jumps of one that a servo follows.

    Rates and tables may go on over many turns.
    """
    if isinstance(signal, Constant):
        yield key, signal.value
    elif isinstance(signal, Polynomial):
        yield f"{key}.polynomial[0]", signal.coefficients[0]
    elif isinstance(signal, Harmonic):
        yield f"{key}.amplitude", signal.amplitude
        yield f"{key}.offset", signal.offset
    elif isinstance(signal, Steps):
        yield f"{key}, its largest jump", float(np.abs(np.diff(signal.values, prepend=0.0)).max())
    elif isinstance(signal, Pulse):
        yield f"{key}.pulse", signal.value


def _length(vector: Array) -> float:
    return float(np.linalg.norm(vector))


def _of_signals(model: Model, h: float) -> Iterator[Implausible]:
    """Warnings about signals that the step does not resolve, and phases in degrees."""
    for key, signal in _signals(model):
        yield from _of_beginning(key, signal, model.settings.t_end)
        for part in _within(signal):
            yield from _of_signal(key, part, h)


def _of_beginning(key: str, signal: Signal, t_end: float) -> Iterator[Implausible]:
    """A warning about a signal that is zero until the end and begins afterwards."""
    breaks = breaks_of(signal)
    times = np.linspace(0.0, t_end, SIGNAL_SAMPLES)
    # Without the last sample: a signal may begin at t_end itself.
    if breaks and min(breaks) >= t_end and not values_of(signal, times[:-1]).any():
        yield Implausible(
            f"{key} begins at {min(breaks):g} s, and the run ends at t_end = {t_end:g} s: "
            "it does nothing",
            severe=True,
        )


def _of_signal(key: str, signal: Signal, h: float) -> Iterator[Implausible]:
    if (highest := _highest(signal)) * h * MIN_SIGNAL_STEPS > 1.0:
        yield Implausible(
            f"{key}: its highest frequency, {highest:g} Hz, has {1.0 / (highest * h):.2g} steps of "
            f"{h:g} s in a period, expected {MIN_SIGNAL_STEPS:g} or more: is it in rad/s or rpm?",
            severe=True,
        )
    if isinstance(signal, PULSE_CLASSES) and signal.duration < MIN_SIGNAL_STEPS * h:
        yield Implausible(
            f"{key}: a pulse of {signal.duration:g} s has {signal.duration / h:.2g} steps of "
            f"{h:g} s, expected {MIN_SIGNAL_STEPS:g} or more: it acts as an impulse"
        )
    if isinstance(signal, WITH_PHASE) and abs(signal.phase) > FULL_TURN:
        yield Implausible(
            f"{key}.phase is {signal.phase:g} rad, usual is one turn at most: is it in degrees?"
        )


def _within(signal: Signal) -> Iterator[Signal]:
    """A signal, and those that it is composed of."""
    yield signal
    for part in parts_of(signal):
        yield from _within(part)


def _highest(signal: Signal) -> float:
    """The highest frequency [Hz] of a signal that names one, 0 of others."""
    if isinstance(signal, Harmonic):
        return abs(signal.frequency)
    if isinstance(signal, Chirp | LogarithmicChirp):
        return max(map(abs, signal.frequencies))
    if isinstance(signal, Noise):
        return max(signal.band)
    if isinstance(signal, ShapedNoise):
        return max(frequency for frequency, _ in signal.spectrum)
    return 0.0


def _signals(model: Model) -> Iterator[tuple[str, Signal]]:
    """All signals with their keys."""
    for number, load in enumerate(model.loads):
        yield f"loads.{number}.signal", load.signal
    owners = (("joints", model.joints), ("motions", model.motions), ("motors", model.motors))
    for table, entries in owners:
        for entry in entries:
            for key, value in vars(entry).items():
                signals = value if isinstance(value, tuple) else (value,)
                yield from (
                    (f"{table}.{entry.name}.{key}", signal)
                    for signal in signals
                    # A protocol is slow to ask for: numbers, names and arrays are no functions.
                    if callable(signal) and isinstance(signal, Signal)
                )


def _of_contacts(model: Model) -> Iterator[Implausible]:
    """Hertz's law of surfaces that are nearly alike, whose patch is soon as large as the ball."""
    for contact in model.contacts:
        if contact.hertz is None or contact.radius is None or not contact.hollow:
            continue
        clearance = contact.radius / contact.ball - 1.0
        if clearance < MIN_CLEARANCE_RATIO:
            # The patch grows with the root of the depth.
            depth = (SMALL_PATCH / contact.patch_over_radius) ** 2
            force = contact.law().stiffness * depth**1.5
            yield Implausible(
                f"contacts.{contact.name}.hertz: a ball of {contact.ball:g} m in a {contact.shape} "
                f"of {contact.radius:g} m, a clearance of {100 * clearance:.2g} %: Hertz's law "
                f"holds up to {force:.3g} N, where its patch is {SMALL_PATCH:g} of the radius"
            )


def _of_step(model: Model, h: float) -> Iterator[Implausible]:
    """Flexible bodies whose modes are all far above the Nyquist frequency of the step.

    Joints lower them, of a beam that is clamped at one end to a sixth.
    """
    for name, body in model.flexible_bodies.items():
        modes = body.superelement.modes
        if modes is None or not len(modes.omega):
            continue
        first = float(modes.frequencies.min())
        if first * h > 0.5 * MAX_NYQUIST_RATIO:
            yield Implausible(
                f"bodies.{name}: its first elastic frequency, {first:.4g} Hz when free, is "
                f"{2.0 * first * h:.3g} times the Nyquist frequency of the step of {h:g} s, "
                "expected one at most: with this step it moves as a rigid body"
            )


Doubt, doubts = Implausible, plausibility_warnings
"""the former names"""
