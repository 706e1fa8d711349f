"""Errors of a test that its mass line shows: wrong wires, gains, places, directions and masses.

Well below the first resonance a free part moves as a rigid one. What it then does under each hit is
known from its mass, so that each sensor and each hit can be compared with all others:

    A = R_o U M^-1 U^T R_i^T,      Re H(f) = A + B f^2 / (f_1^2 - f^2)  below 0.75 f_1

with the real part of the first mode, if that is heavily damped, in place of the fraction.

Fits are robust, lest one wrong sensor makes all hits wrong. Source: docs/theory.md, Frequency
response tests.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...files.arrays import Array, Complex
from ..identification.responses import Measurement
from .channels import ChannelTable
from .coordinates import rigid_rows, space_rows
from .first_resonance import FirstResonance, first_resonance
from .hits import HitTable

LEAST_OF_LINE = 8
"""how many lines the mass line must have"""
LEAST_SPAN = 1.5
"""of its highest line over its lowest: noise of a shorter one is far more at f = 0"""
LARGEST_GAIN_ERROR, LARGEST_ANGLE = 0.1, 10.0
"""relative, and in degrees; honest tests are within 0.06 and 5"""
LARGEST_OFFSET = 0.03
"""of the extent of the part; honest tests are within 0.026"""
ROBUST_STEPS = 30
ROBUST_FLOOR = 0.01
"""of the median error, below which errors count as none"""
LEAST_CHANNELS = 6
"""that must be right to tell what a hit did"""
KNOWN_GAINS = {1.0 / 9.80665: "in g?", 9.80665: "in g?", 1e-3: "in mm?", 1e3: "in mm?"}
SAME_GAIN = 0.05


@dataclass(frozen=True, eq=False)
class MassLine:
    """The lines below the first resonance.

    f (k,) [Hz]; by_mode (k,): what the first mode adds, but for its size; H (k, n_o, n_i): real
    parts.
    """

    f: Array
    by_mode: Array
    H: Array

    @cached_property
    def rigid(self) -> Array:
        """A (n_o, n_i): what the rigid motion is of the responses."""
        # Polynomials in x, which have a third term, carry five times the noise to f = 0.
        functions = np.column_stack([np.ones_like(self.f), self.by_mode])
        values = self.H.reshape(len(self.f), -1)
        found = np.linalg.lstsq(functions, values, rcond=None)[0]
        return np.asarray(found[0].reshape(self.H.shape[1:]))


def mass_line(s: Complex, H: Complex) -> MassLine | None:
    """The mass line of accelerances (k, n_o, n_i) at s (k,), None where it has too few lines."""
    if len(s) < LEAST_OF_LINE:
        return None
    f = s.imag / (2.0 * np.pi)
    first = first_resonance(f, H)
    if first is None or is_too_high(f[0], first):
        return None
    lines = f < first.end
    if lines.sum() < LEAST_OF_LINE:
        return None
    return MassLine(f[lines], first.real_part(f[lines]), H[lines].real)


def is_too_high(lowest: float, first: FirstResonance | None) -> bool:
    """Whether lines from a frequency [Hz] on make no mass line below a resonance."""
    return first is None or first.end < LEAST_SPAN * lowest


def too_few_lines(first: FirstResonance | None) -> str:
    """Why there is no mass line below a resonance, and what it takes."""
    if first is None:
        return "no resonance is in the band"
    return (
        f"too few lines below the first resonance, at {first.f:.4g} Hz: expected {LEAST_OF_LINE} "
        f"or more, from {first.end / LEAST_SPAN:.3g} Hz or less on"
    )


def not_checked(first: FirstResonance | None) -> str:
    """What to say where there is no mass line."""
    return f"whether channels, hits and mass are right cannot be checked: {too_few_lines(first)}"


def doubts_of_mass_line(
    measured: Measurement, channels: ChannelTable, hits: HitTable, center: Array
) -> Iterator[str]:
    """What does not fit to the rigid motion of the part, a line for each sensor or hit.

    One line for the mass where it is that which is wrong.
    """
    line = mass_line(measured.s, measured.H)
    if line is None:
        yield not_checked(first_resonance(measured.s.imag / (2.0 * np.pi), measured.H))
        return
    A = line.rigid
    # By their own levers, which points without rotations leave out of the coordinates.
    outputs = rigid_rows(channels.points - center, channels.directions)
    given = rigid_rows(hits.points - center, hits.directions)
    forces = [_wrench(outputs, a, measured.M) for a in A.T]
    mass = float(np.median([np.linalg.norm(wrench[:3]) for wrench in forces]))
    if abs(mass - 1.0) > LARGEST_GAIN_ERROR:
        yield (
            f"the mass line says that the part has {measured.M[0, 0] / mass:.4g} kg with what is "
            f"mounted on it, and [measured] has {measured.M[0, 0]:.4g} kg{_all_in(mass)}"
        )
        # Inertia is then wrong too, and so is the place of everything.
        return
    by_wrench = np.asarray(np.linalg.solve(measured.M, given.T))
    size = float(np.linalg.norm(np.ptp(np.vstack([channels.points, hits.points]), axis=0)))
    places = hits.points - center
    # Hits that do not fit at first sight say nothing of sensors, unless most of them do not.
    fit = np.ones(len(hits.labels), dtype=bool)
    for j, label in enumerate(hits.labels):
        fit[j] = not list(_of_hit(forces[j], given[j], places[j], label, size))
    used = fit if 2 * fit.sum() > len(fit) else np.ones(len(fit), dtype=bool)
    right = np.ones(len(A), dtype=bool)
    for label in dict.fromkeys(channels.labels):
        rows = [k for k, other in enumerate(channels.labels) if other == label]
        readings = A[rows][:, used]
        found = list(_of_sensor(readings, by_wrench[:, used], channels, rows, center, size))
        right[rows] = not found
        yield from found
    if right.sum() < LEAST_CHANNELS:
        return
    # What wrong sensors say of hits counts no longer.
    for j, label in enumerate(hits.labels):
        wrench = _wrench(outputs[right], A[right, j], measured.M)
        yield from _of_hit(wrench, given[j], places[j], label, size)


def _robust(rows: Array, values: Array) -> Array:
    """X (n, k) of the least sum of |rows X - values| over the rows (m, n), (m, k)."""
    weights = np.ones(len(rows))
    found = np.zeros((rows.shape[1], values.shape[1]))
    for _ in range(ROBUST_STEPS):
        weighted = weights[:, None] * rows, weights[:, None] * values
        found = np.asarray(np.linalg.lstsq(*weighted, rcond=None)[0])
        errors = np.linalg.norm(rows @ found - values, axis=1)
        weights = 1.0 / np.sqrt(np.maximum(errors, ROBUST_FLOOR * np.median(errors) + 1e-300))
    return found


def _wrench(outputs: Array, readings: Array, M: Array) -> Array:
    """The force and the moment (6,) about the center that channels (n, 6) say a hit had."""
    rows = np.linalg.solve(M, outputs.T).T
    # Forces and moments become alike by the radius of gyration.
    scale = np.sqrt(M[0, 0] / np.diag(M))
    return np.asarray(_robust(rows / scale, readings[:, None])[:, 0] / scale)


def _of_sensor(
    A: Array, by_wrench: Array, channels: ChannelTable, rows: list[int], center: Array, size: float
) -> Iterator[str]:
    label, X = channels.labels[rows[0]], channels.points[rows[0]] - center
    directions = channels.directions[rows]
    # What channels would read there, and what combinations of these they do read.
    at_place = space_rows(X) @ by_wrench
    seen = _robust(at_place.T, A.T).T
    own = seen @ np.linalg.pinv(directions) if len(rows) == 3 else None
    names = [channels.names[k].rpartition(":")[2] for k in rows]
    if own is not None and (said := _as_wired(label, own, names)):
        yield from said
        return
    for k, name in enumerate(names if own is None else ()):
        gain = float(seen[k] @ directions[k])
        if abs(gain + 1.0) < LARGEST_GAIN_ERROR:
            yield f"sensor {label}: channel {name} is reversed"
        elif abs(gain - 1.0) > LARGEST_GAIN_ERROR:
            yield f"sensor {label}: channel {name} reads {gain:.2g} of what it should{_unit(gain)}"
    if own is None:
        return
    moved = _robust(by_wrench.T, A.T).T
    place = _place(moved)
    if place is not None and np.linalg.norm(place - X) > LARGEST_OFFSET * size:
        there = np.linalg.norm(channels.points - center - place, axis=1)
        nearest = channels.labels[int(there.argmin())]
        what = "is not where the table has it"
        if nearest != label and there.min() < LARGEST_OFFSET * size:
            what = f"is where the table has sensor {nearest}"
        yield (
            f"sensor {label}: {what}: {1e3 * np.linalg.norm(place - X):.0f} mm away, by its "
            "readings"
        )


def _as_wired(label: str, own: Array, names: list[str]) -> list[str]:
    """What is wrong with the channels of a sensor that reads own @ what it should."""
    sizes = np.linalg.norm(own, axis=1)
    which = np.abs(own).argmax(axis=1)
    signs = np.sign(own[np.arange(3), which])
    angles = np.rad2deg(np.arccos(np.clip(np.abs(own).max(axis=1) / sizes, -1.0, 1.0)))
    if angles.max() > LARGEST_ANGLE or len(set(which.tolist())) < 3:
        # Another sensor is then in its place, or it points elsewhere: its place tells.
        return []
    found = []
    swapped = [names[k] for k in range(3) if which[k] != k]
    if swapped:
        found.append(f"sensor {label}: {' and '.join(swapped)} are exchanged")
    found += [
        f"sensor {label}: channel {names[k]} is reversed"
        for k in range(3)
        if signs[k] < 0.0 and which[k] == k
    ]
    gain = float(np.median(sizes))
    if abs(gain - 1.0) > LARGEST_GAIN_ERROR:
        found.append(f"sensor {label}: reads {gain:.2g} of what it should{_unit(gain)}")
    else:
        found += [
            f"sensor {label}: channel {names[k]} reads {sizes[k]:.2g} of what it should"
            f"{_unit(float(sizes[k]))}"
            for k in range(3)
            if abs(sizes[k] - 1.0) > LARGEST_GAIN_ERROR
        ]
    return found


def _all_in(gain: float) -> str:
    """The unit in which all channels may be."""
    unit = _unit(gain)
    return f"{unit[:2]}are all channels {unit[2:]}" if unit else ""


def _unit(gain: float) -> str:
    for known, question in KNOWN_GAINS.items():
        if abs(abs(gain) / known - 1.0) < SAME_GAIN:
            return f": {question}"
    return ""


def _place(moved: Array) -> Array | None:
    """Where a sensor is whose channels move as the rows (3, 6) say; None where that is not told."""
    e, turned = moved[:, :3], moved[:, 3:]
    sizes = np.linalg.norm(e, axis=1)
    if not sizes.min() > 0.0:
        return None
    # X x e = t for all three: -[e]_x X = t.
    equations = np.vstack([-_cross(row) for row in e / sizes[:, None]])
    return np.asarray(np.linalg.lstsq(equations, (turned / sizes[:, None]).ravel(), rcond=None)[0])


def _of_hit(wrench: Array, given: Array, X: Array, label: str, size: float) -> Iterator[str]:
    force, strength = wrench[:3], float(np.linalg.norm(wrench[:3]))
    if not strength > 0.0:
        yield f"hit {label}: no channel has seen it"
        return
    cosine = float(force @ given[:3]) / strength
    angle = float(np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0))))
    if angle > 180.0 - LARGEST_ANGLE:
        yield f"hit {label} has the other direction: the table wants that of the force on the part"
        return
    if angle > LARGEST_ANGLE:
        yield f"hit {label}: {angle:.0f} degrees off the direction in the table"
        return
    if abs(strength - 1.0) > LARGEST_GAIN_ERROR:
        yield f"hit {label}: a force of {strength:.2g} of what it should be{_unit(strength)}"
    # The moment about its point, over the force, is how far its line of action passes it.
    beside = float(np.linalg.norm(wrench[3:] - np.cross(X, force))) / strength
    if beside > LARGEST_OFFSET * size:
        yield f"hit {label}: {1e3 * beside:.0f} mm beside its place, by what it did"


def _cross(v: Array) -> Array:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
