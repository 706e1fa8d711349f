"""Mass, center and inertia of a tested part: as given, of a superelement, or by its mass line.

About any point the rigid motion is A = R_X M^-1 R_F^T, with a row [e, X x e] of R_X for each
channel and of R_F for each hit, so that

    M^-1 = R_X^+ A (R_F^+)^T,      M = [[m I, -m [c]], [m [c], J - m [c]^2]]

of those that agree, lest one wrong channel spoils it. Source: docs/theory.md, Frequency response
tests.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...files.arrays import Array
from ...superelement import SuperelementError, read
from ..body.measured_body import BY_RESPONSES, FrequencyTest, is_inertia
from ..errors import MeasurementError, about
from .channels import ChannelTable
from .coordinates import SPACE_AXES, rigid_rows, space_rows
from .first_resonance import FirstResonance
from .frequency_data import FrequencyData
from .hits import HitTable
from .mass_line import ROBUST_FLOOR, ROBUST_STEPS, is_too_high, mass_line, too_few_lines

LARGEST_RIGID_CONDITION = 1e3
"""of the motions of channels or the wrenches of hits, lengths scaled by their extent: above it
errors of places are those of the inertia"""

OUTLYING_ERROR = 3.0
"""errors over their median, from which on a channel or a hit counts for little"""
LEAST_ERROR = 1e-300


@dataclass(frozen=True, eq=False)
class RigidProperties:
    """The bare part as a rigid body: mass [kg], center (3,) [m], inertia (3, 3) about it [kg m^2].

    told: where they are from, as provenance says it; "" where the body file has them.
    """

    mass: float
    center: Array
    inertia: Array
    told: str = ""

    @property
    def matrix(self) -> Array:
        """M (6, 6) about the center."""
        M = np.zeros((6, 6))
        M[:3, :3], M[3:, 3:] = self.mass * SPACE_AXES, self.inertia
        return M


def rigid_properties(
    asked: FrequencyTest,
    channels: ChannelTable,
    hits: HitTable,
    data: FrequencyData,
    first: FirstResonance | None,
) -> RigidProperties:
    """Those of the body file, or from where it says; `MeasurementError` where that has none."""
    given = asked.rigid
    if isinstance(given.source, Path):
        return _of_superelement(given.source)
    if given.source == BY_RESPONSES:
        return _by_mass_line(asked, channels, hits, data, first)
    if given.mass is None or given.center is None or given.inertia is None:
        raise MeasurementError("measured.rigid: expected mass, center and inertia, or from")
    return RigidProperties(given.mass, np.array(given.center), np.array(given.inertia))


def _of_superelement(path: Path) -> RigidProperties:
    with about(path, MeasurementError, "file", "not a superelement", (SuperelementError,)):
        element = read(path, recovery=False)
    told = f"mass, center and inertia of {path.name}"
    return RigidProperties(element.mass, element.center, element.J_rot, told)


def _by_mass_line(
    asked: FrequencyTest,
    channels: ChannelTable,
    hits: HitTable,
    data: FrequencyData,
    first: FirstResonance | None,
) -> RigidProperties:
    line = mass_line(data.laplace(asked.window), data.H)
    if line is None or is_too_high(data.f[0], first):
        raise MeasurementError(f'{asked.frf}: measured.rigid.from = "frf": {too_few_lines(first)}')
    every = np.vstack([channels.points, hits.points])
    origin, extent = every.mean(axis=0), float(np.ptp(every, axis=0).max())
    motions = rigid_rows(channels.points - origin, channels.directions)
    wrenches = rigid_rows(hits.points - origin, hits.directions)
    for rows, kind, table in (
        (motions, "the motions of its channels", asked.channels),
        (wrenches, "the wrenches of its hits", asked.hits),
    ):
        found = np.linalg.cond(rows / np.repeat([1.0, extent], 3))
        if len(rows) < 6 or not found < LARGEST_RIGID_CONDITION:
            raise MeasurementError(
                f'{table}: measured.rigid.from = "frf": {kind} do not tell mass, center and '
                f"inertia: expected six or more with a condition below "
                f"{LARGEST_RIGID_CONDITION:g}, found {len(rows)} with {found:.1e}"
            )
    M = np.asarray(np.linalg.inv(_inverse_mass(line.rigid, motions, wrenches)))
    for X in channels.sensors.values():
        seen = space_rows(X - origin)
        M -= asked.sensor_mass * seen.T @ seen
    return _body_of(M, origin, asked)


def _inverse_mass(A: Array, motions: Array, wrenches: Array) -> Array:
    """M^-1 (6, 6) of channels and hits that agree."""
    # A channel in mm would outweigh all others.
    by_channel = 1.0 / (np.linalg.norm(A, axis=1) + LEAST_ERROR)
    by_hit = np.ones(len(wrenches))
    q = np.zeros((6, 6))
    for k in range(2 * ROBUST_STEPS):
        weighted = by_channel[:, None] * A * by_hit
        left = np.linalg.pinv(by_channel[:, None] * motions)
        q = left @ weighted @ np.linalg.pinv(by_hit[:, None] * wrenches).T
        error = A - motions @ q @ wrenches.T
        of_channels = np.linalg.norm(error * by_hit, axis=1)
        of_hits = np.linalg.norm(error * by_channel[:, None], axis=0)
        # The least sum of errors finds what is wrong, but is drawn by it still.
        weights = _of_least_sum if k < ROBUST_STEPS else _of_those_that_agree
        by_channel, by_hit = weights(of_channels), weights(of_hits)
    # Noise makes it a little unsymmetric, which no mass is.
    return np.asarray(0.5 * (q + q.T))


def _of_least_sum(errors: Array) -> Array:
    weights = 1.0 / np.sqrt(np.maximum(errors, ROBUST_FLOOR * np.median(errors) + LEAST_ERROR))
    return np.asarray(weights / weights.max())


def _of_those_that_agree(errors: Array) -> Array:
    return 1.0 / (1.0 + (errors / (OUTLYING_ERROR * np.median(errors) + LEAST_ERROR)) ** 2)


def _body_of(M: Array, origin: Array, asked: FrequencyTest) -> RigidProperties:
    """The body of a mass matrix about an origin."""
    mass = float(np.trace(M[:3, :3])) / 3.0
    moments = 0.5 * (M[3:, :3] - M[:3, 3:])
    # m [c], whose antisymmetric part alone a body can have.
    c = 0.5 * np.array([moments[2, 1] - moments[1, 2], moments[0, 2] - moments[2, 0],
                        moments[1, 0] - moments[0, 1]]) / mass  # fmt: skip
    inertia = M[3:, 3:] - mass * (c @ c * SPACE_AXES - np.outer(c, c))
    if not mass > 0.0 or not is_inertia(inertia):
        principal = ", ".join(f"{J:.3g}" for J in np.linalg.eigvalsh(inertia))
        raise MeasurementError(
            f"{asked.frf}: by its mass line the part has {mass:.3g} kg and the principal moments "
            f"{principal} kg m^2, which no body has: are channels and hits where the "
            "tables say, and are its cords soft (measured.suspension)?"
        )
    told = f"{mass:.4g} kg, center and inertia by the mass line"
    if asked.rigid.mass is not None:
        # A scale is more exact than the gains of sensors and hammer, which are in both.
        inertia, mass = inertia * asked.rigid.mass / mass, asked.rigid.mass
        told += ", scaled to the given mass"
    return RigidProperties(mass, origin + c, inertia, told)
