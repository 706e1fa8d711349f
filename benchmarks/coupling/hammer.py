"""A simulated hammer test of A: sensors and hits sit at nodes of the mesh; what is reported of
them has errors.
"""

import csv
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from .parts import Array, ComplexArray, Motion, Truth, cross, true_angle

Place = tuple[float, float, float]

SENSORS: dict[str, Place] = {
    "1": (0.3, 0.0, 0.02),
    "2": (0.3, 0.05, 0.02),
    "3": (0.28, 0.025, 0.0),
    "4": (0.0, 0.0, 0.1325),
    "5": (0.0, 0.05, 0.1325),
    "6": (0.025, 0.025, 0.15),
    "7": (0.14175, 0.0, 0.0),
    "8": (0.0, 0.05, 0.064),
}
AROUND = {"foot": ("1", "2", "3"), "top": ("4", "5", "6")}
HITS: dict[str, tuple[Place, tuple[int, int, int]]] = {
    "101": ((0.3, 0.0, 0.0), (0, 0, 1)),
    "102": ((0.3, 0.05, 0.0), (0, 0, 1)),
    "103": ((0.26, 0.0, 0.0), (0, 0, 1)),
    "104": ((0.26, 0.05, 0.0), (0, 0, 1)),
    "105": ((0.3, 0.0, 0.005), (-1, 0, 0)),
    "106": ((0.3, 0.05, 0.02), (-1, 0, 0)),
    "107": ((0.28, 0.0, 0.005), (0, 1, 0)),
    "108": ((0.26, 0.05, 0.02), (0, -1, 0)),
    "109": ((0.3, 0.05, 0.005), (0, -1, 0)),
    "110": ((0.3, 0.1 / 3.0, 0.03), (-1, 0, 0)),
    "111": ((0.28, 0.05 / 3.0, 0.0), (0, 0, 1)),
    "112": ((0.26, 0.1 / 3.0, 0.0), (0, 0, 1)),
    "201": ((0.0, 0.0, 0.15), (1, 0, 0)),
    "202": ((0.0, 0.05, 0.15), (1, 0, 0)),
    "203": ((0.0, 0.0, 0.115), (1, 0, 0)),
    "204": ((0.0, 0.05, 0.115), (1, 0, 0)),
    "205": ((0.005, 0.0, 0.15), (0, 0, -1)),
    "206": ((0.0175, 0.05, 0.15), (0, 0, -1)),
    "207": ((0.005, 0.0, 0.1325), (0, 1, 0)),
    "208": ((0.0175, 0.05, 0.115), (0, -1, 0)),
    "209": ((0.01, 0.05, 0.15), (0, -1, 0)),
    "210": ((0.025, 0.1 / 3.0, 0.15), (0, 0, -1)),
    "211": ((0.0, 0.05 / 3.0, 0.1325), (1, 0, 0)),
    "212": ((0.0, 0.1 / 3.0, 0.115), (1, 0, 0)),
    "301": ((0.14175, 0.0, 0.0), (0, 0, 1)),
    "302": ((0.0, 0.05, 0.064), (1, 0, 0)),
    "303": ((0.12025, 0.05, 0.0), (0, -1, 0)),
}
STRUCK = {"foot": "1", "top": "2"}
"""first digit of the hits around each interface"""
SIX_AT_EACH = tuple(f"{first}{k:02d}" for first in (1, 2) for k in (1, 2, 3, 5, 7, 9))
"""hits that suffice, as few as can be, and none elsewhere"""
BAND = 20.0, 5000.0
FINE_BELOW = 700.0
"""[Hz] lines of 1 Hz, of 4 Hz above: two or three in the width of a peak"""


@dataclass(frozen=True)
class Errors:
    """Of a test: relative noise and its floor [1/kg]; degrees and meters of sensors and hits; gain
    of sensors.
    """

    noise: float = 0.0
    floor: float = 0.0
    angle: float = 0.0
    place: float = 0.0
    gain: float = 0.0
    seed: int = 1


NOISE = Errors(noise=0.02, floor=2e-3)
ALL = replace(NOISE, angle=2.0, place=1e-3, gain=0.01)


@dataclass(frozen=True, eq=False)
class HammerTest:
    """Frequencies (k,) [Hz] and accelerances (k, n_o, n_i) of sensors along x, y, z by hits."""

    f: Array
    H: ComplexArray
    hits: tuple[str, ...]

    def with_hits(self, hits: tuple[str, ...]) -> "HammerTest":
        """Some of the hits."""
        return HammerTest(self.f, self.H[:, :, [self.hits.index(hit) for hit in hits]], hits)

    def hits_of(self, interface: str) -> tuple[str, ...]:
        return tuple(hit for hit in self.hits if hit[0] == STRUCK[interface])

    def write(self, folder: Path) -> Path:
        """Tables, responses and the body file, angle.toml; its path."""
        _write_table(
            folder / "channels.csv",
            ["label", "x", "y", "z", "axis"],
            [[label, *X, axis] for label, X in SENSORS.items() for axis in "xyz"],
        )
        _write_table(
            folder / "hits.csv",
            ["label", "x", "y", "z", "dx", "dy", "dz"],
            [[hit, *HITS[hit][0], *HITS[hit][1]] for hit in self.hits],
        )
        np.savez(folder / "angle.npz", f=self.f, H=self.H, quantity="accelerance")
        part = truth().part
        interfaces = "".join(
            f"[interfaces.{name}]\nat = {part.place(name).tolist()}\n"
            f"channels = {list(AROUND[name])}\nhits = {list(self.hits_of(name))}\n"
            for name in AROUND
        )
        path = folder / "angle.toml"
        path.write_text(
            f'name = "angle"\n[measured]\nfrf = "angle.npz"\nchannels = "channels.csv"\n'
            f'hits = "hits.csv"\nband = {list(BAND)}\n'
            f"[measured.rigid]\nmass = {part.element.mass}\n"
            f"center = {part.element.center.tolist()}\ninertia = {part.element.J_rot.tolist()}\n"
            f"{interfaces}[impulse]\nstep = 2e-5\nsteps = 100\n"
        )
        return path


def truth() -> Truth:
    """What is tested."""
    sensors = ((f"s{label}", place) for label, place in SENSORS.items())
    hits = ((f"h{label}", place) for label, (place, _) in HITS.items())
    return true_angle((*sensors, *hits))


def hammer_test(errors: Errors) -> HammerTest:
    """Responses of the truth with the errors of a test."""
    part, rng = truth().whole, np.random.default_rng(errors.seed)
    low, high = BAND
    f = np.concatenate([np.arange(low, FINE_BELOW), np.arange(FINE_BELOW, high + 1.0, 4.0)])
    out = Motion.all_of([_sensed(part.motion(f"s{label}"), errors, rng) for label in SENSORS])
    into = Motion.all_of(
        [
            _shifted(part.motion(f"h{label}"), errors, rng).along(
                _rotation(errors, rng).apply(direction)[None]
            )
            for label, (_, direction) in HITS.items()
        ]
    )
    H = part.accelerance(2j * np.pi * f, out, into)

    def noise() -> ComplexArray:
        parts = rng.standard_normal((2, *H.shape)) / np.sqrt(2.0)
        return np.asarray(parts[0] + 1j * parts[1])

    return HammerTest(f, H * (1.0 + errors.noise * noise()) + errors.floor * noise(), tuple(HITS))


def _write_table(path: Path, head: list[str], rows: list[list[object]]) -> None:
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([head, *rows])


def _rotation(errors: Errors, rng: np.random.Generator) -> Rotation:
    axis = rng.standard_normal(3)
    size = np.deg2rad(errors.angle) * abs(rng.standard_normal())
    return Rotation.from_rotvec(size * axis / np.linalg.norm(axis))


def _shifted(motion: Motion, errors: Errors, rng: np.random.Generator) -> Motion:
    """Beside its place, on a part that is stiff there."""
    off = errors.place * np.sqrt(0.5) * rng.standard_normal(3)
    by_turn = np.hstack([np.zeros((3, 3)), -cross(off)])
    return Motion(motion.rigid + by_turn, motion.phi)


def _sensed(motion: Motion, errors: Errors, rng: np.random.Generator) -> Motion:
    gain = 1.0 + errors.gain * rng.standard_normal()
    return _shifted(motion, errors, rng).along(gain * _rotation(errors, rng).as_matrix().T)
