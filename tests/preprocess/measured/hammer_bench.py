"""A simulated hammer test: an angle of steel plate on soft cords, as its mesh answers.

Sensors and hits sit at nodes of the mesh; what the test reports of them has errors.
"""

import csv
import runpy
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import duhamel as du
import meshio
import numpy as np
from scipy.spatial.transform import Rotation

MESHES = Path(__file__).parents[3] / "meshes"
STEEL = du.Material(E=210e9, nu=0.3, rho=7850.0)
SENSORS = {
    "1": (0.30, 0.0, 0.02),
    "2": (0.30, 0.05, 0.02),
    "3": (0.28, 0.025, 0.0),
    "4": (0.0, 0.0, 0.1325),
    "5": (0.0, 0.05, 0.1325),
    "6": (0.0175, 0.025, 0.15),
    "7": (0.1525, 0.0, 0.0),
    "8": (0.0, 0.05, 0.06),
}
AROUND = {"foot": ("1", "2", "3"), "top": ("4", "5", "6")}
HITS = {
    "101": ((0.30, 0.0, 0.0), (0, 0, 1)),
    "102": ((0.30, 0.05, 0.0), (0, 0, 1)),
    "103": ((0.26, 0.0, 0.0), (0, 0, 1)),
    "104": ((0.26, 0.05, 0.0), (0, 0, 1)),
    "105": ((0.30, 0.0, 0.005), (-1, 0, 0)),
    "106": ((0.30, 0.05, 0.02), (-1, 0, 0)),
    "107": ((0.28, 0.0, 0.005), (0, 1, 0)),
    "108": ((0.26, 0.05, 0.02), (0, -1, 0)),
    "109": ((0.30, 0.05, 0.005), (0, -1, 0)),
    "201": ((0.0, 0.0, 0.15), (1, 0, 0)),
    "202": ((0.0, 0.05, 0.15), (1, 0, 0)),
    "203": ((0.0, 0.0, 0.115), (1, 0, 0)),
    "204": ((0.0, 0.05, 0.115), (1, 0, 0)),
    "205": ((0.005, 0.0, 0.15), (0, 0, -1)),
    "206": ((0.0175, 0.05, 0.15), (0, 0, -1)),
    "207": ((0.005, 0.0, 0.1325), (0, 1, 0)),
    "208": ((0.0175, 0.05, 0.115), (0, -1, 0)),
    "209": ((0.01, 0.05, 0.15), (0, -1, 0)),
    "301": ((0.1525, 0.0, 0.0), (0, 0, 1)),
    "302": ((0.0, 0.05, 0.06), (1, 0, 0)),
}
STRUCK = {"foot": "1", "top": "2"}
"""first digit of the hits around each interface"""
CORDS = "h301", "h302", "s1"
"""where the part hangs"""
CORNERS = "h101", "h201"
"""between which a dashpot may be"""
BAND = 20.0, 5000.0
FASTEST = 6400.0
"""half the rate of responses over time [Hz]"""


@dataclass(frozen=True)
class Errors:
    """Of a test: relative noise and its floor [1/kg], degrees and meters of sensors and hits, gain.

    mass: of each sensor [kg]; window [1/s]; cords: the frequency of the part on them [Hz];
    dashpot [N s/m]: between two corners, along their line; damping: the ratio of all modes in place
    of their own.
    """

    noise: float = 0.0
    floor: float = 0.0
    angle: float = 0.0
    place: float = 0.0
    gain: float = 0.0
    mass: float = 0.0
    window: float = 0.0
    cords: float = 0.0
    dashpot: float = 0.0
    damping: float = 0.0
    seed: int = 1


ALL = Errors(noise=0.02, floor=2e-3, angle=2.0, place=1e-3, gain=0.01)


@dataclass(frozen=True, eq=False)
class Truth:
    """The part as its mesh has it: its superelement with an interface at each sensor and hit."""

    element: du.Superelement
    zeta: np.ndarray = field(repr=False)

    def rows(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Rigid motion (n, 6) and modes (n, m) of an interface."""
        X = self.element.interface(name).X
        turn = np.array([[0.0, X[2], -X[1]], [-X[2], 0.0, X[0]], [X[1], -X[0], 0.0]])
        rigid = np.hstack([np.eye(3), turn])
        own = self.element.rows(name)
        if self.element.interface(name).rotations:
            rigid = np.vstack([rigid, np.hstack([np.zeros((3, 3)), np.eye(3)])])
        return rigid, self.element.modes.phi[own.start : own.stop]

    def between(self, first: str, second: str) -> tuple[np.ndarray, np.ndarray]:
        """Rigid motion and modes (1, m) of the distance of two interfaces."""
        apart = self.element.interface(first).X - self.element.interface(second).X
        e = apart / np.linalg.norm(apart)
        pairs = zip(self.rows(first), self.rows(second), strict=True)
        return tuple((e @ (one - other))[None] for one, other in pairs)

    def accelerance(self, s: np.ndarray, out, into) -> np.ndarray:
        M = np.zeros((6, 6))
        M[:3, :3], M[3:, 3:] = self.element.mass * np.eye(3), self.element.J_rot
        omega = self.element.modes.omega
        h = s[:, None] ** 2 / (s[:, None] ** 2 + 2 * self.zeta * omega * s[:, None] + omega**2)
        return np.einsum("am,km,bm->kab", out[1], h, into[1], optimize=True) + (
            out[0] @ np.linalg.solve(M, into[0].T)
        )


@lru_cache
def truth() -> Truth:
    part = du.Part(angle_mesh(), STEEL, name="angle")
    part.interface("foot", du.plane(z=0.03) & du.box([0.26, 0.0, 0.03], [0.3, 0.05, 0.03]))
    part.interface("top", du.plane(x=0.025) & du.box([0.025, 0.0, 0.115], [0.025, 0.05, 0.15]))
    for label, place in SENSORS.items():
        part.interface(f"s{label}", place)
    for label, (place, _) in HITS.items():
        part.interface(f"h{label}", place)
    element = part.superelement(step=2e-5, duration=3.2e-4, method="modal")
    # Modes have damping ratios of their own, from 0.3 to 2 per cent.
    spread = np.random.default_rng(7).standard_normal(len(element.modes.omega))
    zeta = np.clip(0.01 * np.exp(0.5 * spread), 0.003, 0.02)
    zeta[20:] = 0.01
    return Truth(element, zeta)


def angle_mesh() -> meshio.Mesh:
    """Two legs of 10 mm plate, 300 and 150 mm long, with blocks at their ends, in hex20."""
    made: meshio.Mesh = runpy.run_path(str(MESHES / "angle" / "make_mesh.py"))["angle_mesh"]()
    return made


@dataclass(frozen=True, eq=False)
class Bench:
    """Frequencies (k,) [Hz], responses (k, n_o, n_i), and what the test reports of its geometry."""

    f: np.ndarray
    H: np.ndarray
    errors: Errors

    def write(self, folder: Path, frf: str = "angle.npz", rigid: str = "", **keys: object) -> Path:
        """Tables, responses and the body file angle.toml; its path.

        rigid: lines in place of the mass, center and inertia of the part.
        """
        write_tables(folder)
        if frf.endswith(".npz"):
            np.savez(folder / frf, f=self.f, H=self.H, quantity="accelerance")
        element = truth().element
        interfaces = "".join(
            f"[interfaces.{name}]\n"
            f"at = {(element.interface(name).X + element.center).tolist()}\n"
            f"channels = {list(labels)}\n"
            f"hits = {[hit for hit in HITS if hit[0] == STRUCK[name]]}\n"
            for name, labels in AROUND.items()
        )
        further = {"sensor_mass": self.errors.mass, "window": self.errors.window, **keys}
        lines = "".join(f"{key} = {value}\n" for key, value in further.items() if value)
        rigid = rigid or (
            f"mass = {element.mass}\ncenter = {element.center.tolist()}\n"
            f"inertia = {element.J_rot.tolist()}"
        )
        path = folder / "angle.toml"
        path.write_text(
            f'name = "angle"\n[measured]\nfrf = "{frf}"\nchannels = "channels.csv"\n'
            f'hits = "hits.csv"\nband = [20, 5000]\n{lines}'
            f"[measured.rigid]\n{rigid}\n{interfaces}"
            "[impulse]\nstep = 2e-5\nsteps = 100\n"
        )
        return path


def write_tables(folder: Path) -> None:
    with (folder / "channels.csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["label", "x", "y", "z", "axis"])
        rows.writerows([k, *X, axis] for k, X in SENSORS.items() for axis in "xyz")
    with (folder / "hits.csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["label", "x", "y", "z", "dx", "dy", "dz"])
        rows.writerows([label, *X, *d] for label, (X, d) in HITS.items())


@lru_cache
def measure(errors: Errors = Errors(), resolution: float = 0.0) -> Bench:
    """Responses of the truth with the errors of a test; sensors load the part in all hits.

    resolution [Hz]: of even lines from 0 to FASTEST; else there are more of them below 700 Hz.
    """
    part, rng = truth(), np.random.default_rng(errors.seed)
    if errors.damping:
        part = replace(part, zeta=np.full(len(part.zeta), errors.damping))
    f = np.concatenate([np.arange(BAND[0], 700.0, 1.0), np.arange(700.0, BAND[1] + 1.0, 4.0)])
    if resolution:
        f = np.arange(0.0, FASTEST + 0.5 * resolution, resolution)
    s = 2j * np.pi * f + errors.window
    outputs = [_turned(part.rows(f"s{label}"), errors, rng) for label in SENSORS]
    inputs = []
    for label, (_, direction) in HITS.items():
        d = _rotation(errors, rng).apply(direction)
        rigid, phi = _shifted(part.rows(f"h{label}"), errors, rng)
        inputs.append((d @ rigid, d @ phi))
    out = tuple(np.vstack(rows) for rows in zip(*outputs, strict=True))
    into = tuple(np.vstack(rows) for rows in zip(*inputs, strict=True))
    H = part.accelerance(s, out, into)
    if errors.mass or errors.cords or errors.dashpot:
        # What is mounted pushes back with Z times its acceleration: its mass, k / s^2 of a cord, or
        # c / s of a dashpot.
        mounted = [(part.rows(f"s{label}"), np.full(len(s), errors.mass)) for label in SENSORS]
        stiffness = part.element.mass * (2.0 * np.pi * errors.cords) ** 2 / len(CORDS)
        mounted += [(part.rows(name), stiffness / s**2) for name in CORDS]
        mounted += [(part.between(*CORNERS), errors.dashpot / s)]
        mounted = [one for one in mounted if np.abs(one[1]).max() > 0.0]
        at = tuple(np.vstack(rows) for rows in zip(*(rows for rows, _ in mounted), strict=True))
        Z = np.vstack([np.tile(pushed, (len(rows[0]), 1)) for rows, pushed in mounted]).T
        own = np.eye(Z.shape[1]) / Z[:, None, :] + part.accelerance(s, at, at)
        still = np.linalg.solve(own, part.accelerance(s, at, into))
        H = H - part.accelerance(s, out, at) @ still

    def noise() -> np.ndarray:
        return (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape)) / np.sqrt(2.0)

    return Bench(f, H * (1.0 + errors.noise * noise()) + errors.floor * noise(), errors)


def _rotation(errors: Errors, rng: np.random.Generator) -> Rotation:
    axis = rng.standard_normal(3)
    size = np.deg2rad(errors.angle) * abs(rng.standard_normal())
    return Rotation.from_rotvec(size * axis / np.linalg.norm(axis))


def _shifted(rows, errors: Errors, rng: np.random.Generator):
    """A sensor or hit beside its place, on a part that is stiff there."""
    rigid, phi = rows
    e = errors.place * 0.7 * rng.standard_normal(3)
    turn = np.array([[0.0, e[2], -e[1]], [-e[2], 0.0, e[0]], [e[1], -e[0], 0.0]])
    shift = np.zeros((3, 6))
    shift[:, 3:] = turn
    return rigid + shift, phi


def _turned(rows, errors: Errors, rng: np.random.Generator):
    rigid, phi = _shifted(rows, errors, rng)
    B = (1.0 + errors.gain * rng.standard_normal()) * _rotation(errors, rng).as_matrix().T
    return B @ rigid, B @ phi


def with_fault(bench: Bench, change) -> Bench:
    H = bench.H.copy()
    change(H)
    return replace(bench, H=H)
