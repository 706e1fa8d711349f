"""The parts: A, an angle of steel plate that is tested, and B, a plate on its foot, by meshes.

Both are of hex20. What is called true of A are all modes of its mesh, with damping of their own.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import duhamel as du
import meshio
import numpy as np
from duhamel.superelement import GeneralizedAlpha, Modes, Superelement, sample_kernel
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

STEEL = du.Material(E=210e9, nu=0.3, rho=7850.0)
STEP, STEPS, RHO_INF = 2e-5, 16, 0.9
"""of impulse responses, which nothing here uses: modes are known"""
LEAST_DAMPING, DAMPING, MOST_DAMPING = 0.003, 0.01, 0.02
"""of modes of A in the band of the test: each has its own"""
DAMPED_APART = 20
"""modes, those up to twice the band"""
DAMPING_OF_PLATE = 0.005
INTERFACES = "foot", "top"
LEG = 0.01
"""[m] of plate, the thickness of both legs of A"""
THICKER, SOFTER = 1.04, 202e9
"""legs of a mesh that is made of drawings, over those of the part, and its modulus [Pa]"""
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
EDGES = np.array(
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
)


@dataclass(frozen=True, eq=False)
class Motion:
    """What some coordinates are of rigid motion about the center, rigid (n, 6), and of modes,
    phi (n, m).
    """

    rigid: Array
    phi: Array

    def along(self, rows: ArrayLike) -> "Motion":
        """Combinations (k, n) of the coordinates."""
        return Motion(np.asarray(rows) @ self.rigid, np.asarray(rows) @ self.phi)

    @staticmethod
    def all_of(motions: "list[Motion]") -> "Motion":
        return Motion(np.vstack([m.rigid for m in motions]), np.vstack([m.phi for m in motions]))


@dataclass(frozen=True, eq=False)
class FreePart:
    """A superelement whose modes have damping, without supports."""

    element: Superelement

    @cached_property
    def mass(self) -> Array:
        """(6, 6), about the center."""
        M = np.zeros((6, 6))
        M[:3, :3], M[3:, 3:] = self.element.mass * np.eye(3), self.element.J_rot
        return M

    def motion(self, name: str) -> Motion:
        """That of an interface: displacements, and rotations if it has some."""
        interface, own = self.element.interface(name), self.element.rows(name)
        rigid = np.hstack([np.eye(3), -cross(interface.X)])
        if interface.rotations:
            rigid = np.vstack([rigid, np.eye(6)[3:]])
        return Motion(rigid, self._modes.phi[own.start : own.stop])

    def place(self, name: str) -> Array:
        """Of an interface, in the axes of the mesh [m]."""
        return np.asarray(self.element.interface(name).X + self.element.center)

    def accelerance(self, s: ComplexArray, out: Motion, into: Motion) -> ComplexArray:
        """(k, n_o, n_i) at s (k,) [1/s]:

        U_o M^-1 U_i^T + phi_o diag(s^2 / (s^2 + 2 zeta omega s + omega^2)) phi_i^T
        """
        omega, zeta = self._modes.omega, self._modes.zeta
        h = s[:, None] ** 2 / (s[:, None] ** 2 + 2.0 * zeta * omega * s[:, None] + omega**2)
        rigid = out.rigid @ np.linalg.solve(self.mass, into.rigid.T)
        return np.asarray((out.phi * h[:, None, :]) @ into.phi.T + rigid)

    @property
    def _modes(self) -> Modes:
        assert self.element.modes is not None
        return self.element.modes


@dataclass(frozen=True, eq=False)
class Truth:
    """Part A with an interface at each sensor and hit, and the part alone."""

    whole: FreePart
    part: FreePart = field(repr=False)


@lru_cache(maxsize=1)
def true_angle(places: tuple[tuple[str, tuple[float, float, float]], ...]) -> Truth:
    """A, and what its mesh does at places by name."""
    angle = _angle(angle_mesh(), STEEL)
    for name, place in places:
        angle.interface(name, place)
    element = angle.superelement(step=STEP, duration=STEPS * STEP, method="modal")
    assert element.modes is not None
    spread = np.random.default_rng(7).standard_normal(len(element.modes.omega))
    zeta = np.clip(DAMPING * np.exp(0.5 * spread), LEAST_DAMPING, MOST_DAMPING)
    zeta[DAMPED_APART:] = DAMPING
    return Truth(
        *(
            FreePart(_with_modes(element, names, zeta))
            for names in (tuple(x.name for x in element.interfaces), INTERFACES)
        )
    )


def wrong_angle() -> du.Part:
    """A as a mesh has it that was made before the part: thicker legs, a softer steel."""
    mesh = angle_mesh()
    for axis in (0, 2):
        leg = mesh.points[:, axis] <= LEG + 1e-9
        mesh.points[leg, axis] *= THICKER
    return _angle(mesh, du.Material(E=SOFTER, nu=STEEL.nu, rho=STEEL.rho))


@lru_cache(maxsize=1)
def plate() -> FreePart:
    """B: its face `root` lies on the foot of A, its corner `tip` is free."""
    part = du.Part(plate_mesh(), STEEL, name="plate")
    part.interface("root", du.plane(z=0.03) & du.box([0.26, -0.02, 0.03], [0.3, 0.07, 0.03]))
    part.interface("tip", (0.48, 0.07, 0.042))
    part.damping(modal=DAMPING_OF_PLATE)
    return FreePart(part.superelement(step=STEP, duration=STEPS * STEP, method="modal"))


def _angle(mesh: meshio.Mesh, material: du.Material) -> du.Part:
    angle = du.Part(mesh, material, name="angle")
    angle.interface("foot", du.plane(z=0.03) & du.box([0.26, 0.0, 0.03], [0.3, 0.05, 0.03]))
    angle.interface("top", du.plane(x=0.025) & du.box([0.025, 0.0, 0.115], [0.025, 0.05, 0.15]))
    return angle


def _with_modes(element: Superelement, names: tuple[str, ...], zeta: Array) -> Superelement:
    """Some interfaces of a superelement, and the damping of its modes."""
    assert element.modes is not None
    rows = np.concatenate([np.arange(q.start, q.stop) for q in map(element.rows, names)])
    modes = Modes(element.modes.omega, zeta, element.modes.phi[rows])
    kernel = sample_kernel(modes, STEP, GeneralizedAlpha(RHO_INF), STEPS)
    return Superelement(
        element.name,
        element.mass,
        element.J_rot,
        element.center,
        tuple(element.interface(name) for name in names),
        kernel,
        modes,
        modes.compliance,
        modes.accelerance,
    )


def angle_mesh() -> meshio.Mesh:
    """Two legs of 10 mm plate, 300 and 150 mm long, with blocks at their ends."""
    along = [0.0, 10.0, 25.0, *np.linspace(45.0, 260.0, 11), 280.0, 300.0]
    up = [0.0, 10.0, 30.0, *np.linspace(47.0, 115.0, 5), 132.5, 150.0]
    return _blocks(
        (along, np.linspace(0.0, 50.0, 4), up),
        lambda x, _, z: z < 10 or x < 10 or (x > 260 and z < 30) or (z > 115 and x < 25),
    )


def plate_mesh() -> meshio.Mesh:
    """220 x 90 x 12 mm."""
    axes = np.linspace(260.0, 480.0, 12), np.linspace(-20.0, 70.0, 5), [30.0, 42.0]
    return _blocks(axes, lambda *_: True)


def _blocks(
    axes: tuple[ArrayLike, ...], is_solid: Callable[[float, float, float], bool]
) -> meshio.Mesh:
    """Hex20 of the cells of a grid [mm] that are solid at their middle; in m."""
    ticks = [np.asarray(axis, dtype=float) for axis in axes]
    halves = [np.sort([*axis, *(0.5 * (axis[1:] + axis[:-1]))]) for axis in ticks]
    cells = [
        cell
        for cell in np.ndindex(*(len(axis) - 1 for axis in ticks))
        if is_solid(*(half[2 * k + 1] for half, k in zip(halves, cell, strict=True)))
    ]
    local = np.vstack([2 * CORNERS, CORNERS[EDGES].sum(axis=1)])
    every = (2 * np.array(cells)[:, None] + local).reshape(-1, 3)
    nodes, numbers = np.unique(every, axis=0, return_inverse=True)
    points = 1e-3 * np.column_stack([half[k] for half, k in zip(halves, nodes.T, strict=True)])
    return meshio.Mesh(points, [("hexahedron20", numbers.reshape(-1, 20))])


def cross(r: ArrayLike) -> Array:
    """(3, 3) of which the product with x is r x x."""
    x, y, z = np.asarray(r, dtype=float)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
