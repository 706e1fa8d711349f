"""Matrices of straight beams in space, all elements at once."""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.polynomial.polynomial import polyder, polyval

from ...superelement.validation import Array
from ..body.material import Section
from ..errors import MeshError
from ..mesh.mesh import Mesh

MIN_SINE_TO_VERTICAL = 1e-3  # to e_z, below which a beam counts as vertical
BEAM_GAUSS_POINTS = (0.5 * (leggauss(4)[0] + 1.0), 0.5 * leggauss(4)[1])
"""Gauss points in [0, 1] and their weights, exact for the mass and all else of an element."""


@dataclass(frozen=True, eq=False)
class BeamProperties:
    """Section values of every element, each (n,), with Phi = 12 EI / (GA L^2), 0 without shear."""

    EA: Array
    EI_y: Array
    EI_z: Array
    GJ: Array
    mass: Array
    polar: Array
    rotary_y: Array
    rotary_z: Array
    Phi_y: Array
    """of deflection along y, so with EI_z and GA_y"""
    Phi_z: Array
    """of deflection along z, so with EI_y and GA_z"""


def beam_matrices(mesh: Mesh, sections: list[Section]) -> tuple[Array, Array]:
    """Stiffness and mass (n, 12, 12) of every line, in mesh axes.

    Dofs of a node: 3 displacements [m], 3 rotations [rad].

    Euler-Bernoulli (cubic Hermite) or Timoshenko bending with the shapes that solve the static
    problem between the nodes exactly, linear shapes for stretch and twist; consistent mass.
    Frequencies of bending err with the fourth power of the length of the elements; with its square
    where shear matters, for the shear strain is constant within an element; and with the square in
    stretch and twist. `sections` has one section per line. Source: J. S. Przemieniecki, Theory of
    Matrix Structural Analysis (1968), ch. 5 and 11; Z. Friedman and J. B. Kosmatka, Computers and
    Structures 47 (1993) 473-481.
    """
    L, axes = lengths_and_axes(mesh, sections)
    properties = beam_properties(sections, L)
    turn = np.kron(np.eye(4), axes)  # (n, 12, 12): mesh axes to local axes, node by node
    K, M = local_stiffness(L, properties), _local_mass(L, properties)
    back = turn.transpose(0, 2, 1)
    return back @ K @ turn, back @ M @ turn


def lengths(mesh: Mesh) -> Array:
    """The length (n,) [m] of every line."""
    ends = mesh.points[mesh.cells["line"]]
    return np.asarray(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))


def lengths_and_axes(mesh: Mesh, sections: list[Section]) -> tuple[Array, Array]:
    """Lengths (n,) and local axes (n, 3, 3), whose rows are x, y and z."""
    ends = mesh.points[mesh.cells["line"]]
    along = ends[:, 1] - ends[:, 0]
    lengths = np.linalg.norm(along, axis=1)
    if (short := np.flatnonzero(lengths <= 1e-12 * mesh.size)).size:
        raise MeshError(
            f"{mesh.name}: line {short[0]} has no length: "
            f"both ends are at {ends[short[0], 0].tolist()}"
        )
    x = along / lengths[:, None]

    horizontal = np.cross([0.0, 0.0, 1.0], x)
    vertical = np.linalg.norm(horizontal, axis=1) < MIN_SINE_TO_VERTICAL
    y = np.where(vertical[:, None], [0.0, 1.0, 0.0], horizontal)
    for i, section in enumerate(sections):
        if section.orientation is not None:
            y[i] = np.array(section.orientation) / max(
                np.linalg.norm(section.orientation), np.finfo(float).tiny
            )
    # What is left is across the beam; nothing is left of a vector along it, which is refused.
    y -= np.einsum("ei,ei->e", x, y)[:, None] * x
    norm = np.linalg.norm(y, axis=1)
    if (parallel := np.flatnonzero(norm < 1e-6)).size:
        i = int(parallel[0])
        raise MeshError(
            f"{mesh.name}: line {i} runs along {x[i].tolist()}: the orientation of its section "
            f"must not be parallel to it, found {sections[i].orientation}"
        )
    y /= norm[:, None]
    return lengths, np.stack([x, y, np.cross(x, y)], axis=1)


def beam_properties(sections: list[Section], L: Array) -> BeamProperties:
    def column(name: str) -> Array:
        return np.array([getattr(section, name) for section in sections], dtype=float)

    EA, EI_y, EI_z, mass = column("EA"), column("EI_y"), column("EI_z"), column("mass_per_length")
    GA_y, GA_z = column("GA_y"), column("GA_z")  # NaN where there is none

    def rotary(name: str, EI: Array, GA: Array) -> Array:
        homogeneous = np.where(np.isnan(GA), 0.0, mass * EI / EA)
        return np.where(np.isnan(column(name)), homogeneous, column(name))

    return BeamProperties(
        EA=EA,
        EI_y=EI_y,
        EI_z=EI_z,
        GJ=column("GJ"),
        mass=mass,
        polar=column("polar_inertia_per_length"),
        rotary_y=rotary("rotary_inertia_y", EI_y, GA_z),
        rotary_z=rotary("rotary_inertia_z", EI_z, GA_y),
        Phi_y=np.nan_to_num(12.0 * EI_z / (GA_y * L**2), nan=0.0),
        Phi_z=np.nan_to_num(12.0 * EI_y / (GA_z * L**2), nan=0.0),
    )


# The local dofs of one kind of motion. About y, a positive rotation lowers the far end, hence the
# signs.
STRETCH, TWIST = [0, 6], [3, 9]
ALONG_Y, ALONG_Z = [1, 5, 7, 11], [2, 4, 8, 10]
SIGNS_Y, SIGNS_Z = np.array([1.0, 1.0, 1.0, 1.0]), np.array([1.0, -1.0, 1.0, -1.0])


def local_stiffness(L: Array, p: BeamProperties) -> Array:
    K = np.zeros((len(L), 12, 12))
    bar = np.array([[1.0, -1.0], [-1.0, 1.0]])
    _place(K, STRETCH, (p.EA / L)[:, None, None] * bar)
    _place(K, TWIST, (p.GJ / L)[:, None, None] * bar)
    for dofs, signs, EI, Phi in (
        (ALONG_Y, SIGNS_Y, p.EI_z, p.Phi_y),
        (ALONG_Z, SIGNS_Z, p.EI_y, p.Phi_z),
    ):
        _place(K, dofs, _bending_stiffness(L, EI, Phi) * np.outer(signs, signs))
    return K


def _place(matrices: Array, dofs: list[int], blocks: Array) -> None:
    """Write blocks (n, k, k) into the rows and columns `dofs` of matrices (n, 12, 12)."""
    matrices[:, np.array(dofs)[:, None], dofs] = blocks


def _bending_stiffness(L: Array, EI: Array, Phi: Array) -> Array:
    """(n, 4, 4) for deflection and slope at both ends."""
    one, zero = np.ones_like(L), np.zeros_like(L)
    s, a, b = 6.0 * L, (4.0 + Phi) * L**2, (2.0 - Phi) * L**2
    rows = [
        [12.0 * one, s, -12.0 * one, s],
        [zero, a, -s, b],
        [zero, zero, 12.0 * one, -s],
        [zero, zero, zero, a],
    ]
    upper = np.array(rows).transpose(2, 0, 1)
    factor = EI / (L**3 * (1.0 + Phi))
    return np.asarray(factor[:, None, None] * (upper + np.triu(upper, 1).transpose(0, 2, 1)))


def _local_mass(L: Array, p: BeamProperties) -> Array:
    M = np.zeros((len(L), 12, 12))
    bar = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
    _place(M, STRETCH, (p.mass * L)[:, None, None] * bar)
    _place(M, TWIST, (p.polar * L)[:, None, None] * bar)
    for dofs, signs, rotary, Phi in (
        (ALONG_Y, SIGNS_Y, p.rotary_z, p.Phi_y),
        (ALONG_Z, SIGNS_Z, p.rotary_y, p.Phi_z),
    ):
        _place(M, dofs, _bending_mass(L, p.mass, rotary, Phi) * np.outer(signs, signs))
    return M


def _bending_mass(L: Array, mass: Array, rotary: Array, Phi: Array) -> Array:
    """(n, 4, 4): integral of mass N^T N + rotary T^T T."""
    M = np.zeros((len(L), 4, 4))
    for xi, weight in zip(*BEAM_GAUSS_POINTS, strict=True):
        N, T = _bending_shapes(xi, L, Phi)
        M += (weight * mass * L)[:, None, None] * N[:, :, None] * N[:, None, :]
        M += (weight * rotary * L)[:, None, None] * T[:, :, None] * T[:, None, :]
    return M


def section_motion(xi: float, L: Array, p: BeamProperties, derivative: int = 0) -> Array:
    """Displacement and rotation (n, 6, 12) of the section at xi in [0, 1], in local axes.

    Or a derivative of them by the arc length.
    """
    motion = np.zeros((len(L), 6, 12))
    ends = polyval(xi, polyder(np.array([[1.0, 0.0], [-1.0, 1.0]]), derivative, axis=0))
    motion[:, 0, STRETCH] = motion[:, 3, TWIST] = ends / L[:, None] ** derivative
    N, T = _bending_shapes(xi, L, p.Phi_y, derivative)
    motion[:, 1, ALONG_Y], motion[:, 5, ALONG_Y] = N * SIGNS_Y, T * SIGNS_Y
    N, T = _bending_shapes(xi, L, p.Phi_z, derivative)
    motion[:, 2, ALONG_Z], motion[:, 4, ALONG_Z] = N * SIGNS_Z, -T * SIGNS_Z
    return motion


def _bending_shapes(xi: float, L: Array, Phi: Array, derivative: int = 0) -> tuple[Array, Array]:
    """Deflection N and rotation T (n, 4) at xi in [0, 1] under unit deflection and rotation of the
    ends, or a derivative of them by the arc length.
    """
    o, one, half = np.zeros_like(L), np.ones_like(L), 0.5 * Phi
    # By rows the coefficients of 1, xi, xi^2, xi^3.
    N = [
        [one + Phi, o, o, o],
        [-Phi, L * (1.0 + half), Phi, -L * half],
        [-3.0 * one, -L * (2.0 + half), 3.0 * one, L * (half - 1.0)],
        [2.0 * one, L, -2.0 * one, L],
    ]
    T = [
        [o, one + Phi, o, o],
        [-6.0 / L, -4.0 - Phi, 6.0 / L, Phi - 2.0],
        [6.0 / L, 3.0 * one, -6.0 / L, 3.0 * one],
    ]
    scale = ((1.0 + Phi) * L**derivative)[:, None]
    values, slopes = (polyval(xi, polyder(np.array(c), derivative, axis=0)).T for c in (N, T))
    return values / scale, slopes / scale
