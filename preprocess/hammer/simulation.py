"""A hammer test of a mesh, with the errors that a test has."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from ...files.arrays import Array, Complex
from ..measured.channels import ChannelTable
from ..measured.frequency_data import FrequencyData
from ..measured.hits import HitTable
from .free_part import PlaceMotion, stacked_motions
from .struck_part import StruckPart

CORD_PLACES = 3


@dataclass(frozen=True)
class HammerErrors:
    """What is wrong in a test, as standard deviations, each drawn by the seed.

    Parameters
    ----------
    noise : float
        Of each response, relative to it.
    floor : float
        Noise that does not depend on the response, relative to 1 / mass.
    angle : float [deg]
        Of sensors and hits.
    place : float [m]
        Of sensors and hits.
    gain : float
        Of sensors, relative.
    cords : float [Hz]
        The frequency of the part on the cords that it hangs on; 0: it is free.
    seed : int

    Examples
    --------
    >>> HammerErrors(place=2e-3, seed=3).place
    0.002
    """

    noise: float = 0.02
    floor: float = 0.005
    angle: float = 2.0
    place: float = 1e-3
    gain: float = 0.01
    cords: float = 0.0
    seed: int = 1


NO_ERRORS = HammerErrors(noise=0.0, floor=0.0, angle=0.0, place=0.0, gain=0.0)


def hammer_test(
    part: StruckPart,
    channels: ChannelTable,
    hits: HitTable,
    f: Array,
    errors: HammerErrors,
    window: float = 0.0,
    sensor_mass: float = 0.0,
) -> FrequencyData:
    """The accelerances that a test of a part measures, at f (k,) [Hz].

    The part has the points of all sensors, in the order of their first channels, and then those of
    the hits. Sensors load it in all hits.
    """
    # Drawn in one order, so that one error alone has the draws that it has with all others.
    rng, labels = np.random.default_rng(errors.seed), list(channels.sensors)
    s = np.asarray(2j * np.pi * f + window, dtype=complex)
    places, turned = {}, {}
    for k, label in enumerate(labels):
        gain = 1.0 + errors.gain * rng.standard_normal()
        turned[label] = gain * _rotation(errors, rng)
        places[label] = part.at(k, _offset(errors, rng))
    outputs = [
        places[label].along((direction @ turned[label])[None])
        for label, direction in zip(channels.labels, channels.directions, strict=True)
    ]
    inputs = []
    # A hammer pushes with what its own sensor says: hits have no gain.
    for k, direction in enumerate(hits.directions, start=len(labels)):
        pushed = direction @ _rotation(errors, rng)
        inputs.append(part.at(k, _offset(errors, rng)).along(pushed[None]))
    out, into = stacked_motions(outputs), stacked_motions(inputs)
    H = part.accelerance(s, out, into)
    mounted = _mounted(part, s, len(labels), errors, sensor_mass)
    if mounted is not None:
        # What is mounted pushes back with Z times its acceleration.
        at, Z = mounted
        own = np.eye(Z.shape[1]) / Z[:, None, :] + part.accelerance(s, at, at)
        H = H - part.accelerance(s, out, at) @ np.linalg.solve(own, part.accelerance(s, at, into))

    def noise() -> Complex:
        real, imaginary = rng.standard_normal((2, *H.shape))
        return np.asarray((real + 1j * imaginary) / np.sqrt(2.0))

    return FrequencyData(
        f, H * (1.0 + errors.noise * noise()) + errors.floor / part.rigid.mass * noise()
    )


def _mounted(
    part: StruckPart, s: Complex, sensors: int, errors: HammerErrors, sensor_mass: float
) -> tuple[PlaceMotion, Complex] | None:
    """Where sensors and cords are, and Z (k, n): their mass, or stiffness / s^2."""
    places: list[tuple[int, Complex]] = []
    if sensor_mass:
        places += [(k, np.full(len(s), sensor_mass, dtype=complex)) for k in range(sensors)]
    if errors.cords:
        # Springs in all directions, as cords hold a part that swings little.
        stiffness = part.rigid.mass * (2.0 * np.pi * errors.cords) ** 2 / CORD_PLACES
        places += [(k, stiffness / s**2) for k in far_apart(part.points[:sensors], CORD_PLACES)]
    if not places:
        return None
    at = stacked_motions([part.at(k, np.zeros(3)) for k, _ in places])
    return at, np.repeat(np.array([Z for _, Z in places]), 3, axis=0).T


def far_apart(points: Array, count: int) -> list[int]:
    """Points (count,) of (n, 3), each as far from those before it as one can be."""
    chosen = [int(np.linalg.norm(points - points.mean(axis=0), axis=1).argmax())]
    while len(chosen) < count:
        apart = np.linalg.norm(points[:, None] - points[chosen], axis=2).min(axis=1)
        chosen.append(int(apart.argmax()))
    return chosen


def _rotation(errors: HammerErrors, rng: np.random.Generator) -> Array:
    axis = rng.standard_normal(3)
    size = np.deg2rad(errors.angle) * abs(rng.standard_normal())
    turn: Array = Rotation.from_rotvec(size * axis / np.linalg.norm(axis)).as_matrix()
    return turn


def _offset(errors: HammerErrors, rng: np.random.Generator) -> Array:
    # So that the distance, of three components, is that of `place` in the plane of a surface.
    return np.asarray(errors.place * np.sqrt(0.5) * rng.standard_normal(3))
