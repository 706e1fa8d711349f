"""Second order of beams: strain energy to third order, inertia to second, in the dofs of nodes."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from ...superelement.validation import Array
from ..body.material import Section
from ..errors import BodyError
from ..mesh.mesh import IntArray, Mesh
from ..mesh.nodes import node_dofs
from .beam import (
    BEAM_GAUSS_POINTS,
    BeamProperties,
    beam_properties,
    lengths_and_axes,
    local_stiffness,
    section_motion,
)
from .inertia import Moved, Pieces, cross

BEAM_BATCH = 2**22  # numbers in the second order strains of a batch of elements
# Six at each station, and the motion of its ends.
BEAM_STRAIN_ROWS = 6 * len(BEAM_GAUSS_POINTS[0]) + 12
AXIS_OF_BEAM = np.array([1.0, 0.0, 0.0])
ROTATION_HALVES = np.array([1.0, 0.5, 1.0, 0.5])[:, None, None]
"""A turn w adds w x u to displacements, and 1/2 w x theta to rotation vectors."""


@dataclass(frozen=True, eq=False)
class _State:
    """Motions of elements in local axes, to first order.

    stress (n_rows, r): what works on second order strains, in their order: N, Q, M at the stations,
    with weights, and the loads on the ends. What is left of the motion once the element is turned
    back: slope u', rotation w and curvature w' of sections (3, n_stations, r). spin (3, 1, n, r):
    the rotation of the element; ends (3, 4, n, r): displacements and rotations of both ends, half
    turned back.
    """

    stress: Array
    slope: Array
    rotation: Array
    curvature: Array
    spin: Array
    ends: Array


@dataclass(frozen=True, eq=False)
class BeamTensors:
    """n beams with sections; motions (n_dofs, r) are columns on the six dofs of each node.

    dofs (n, 12); axes (n, 3, 3): local axes as rows; ends (n, 2, 3): positions [m] from the center
    of mass.
    """

    strain_energy: ClassVar[bool] = True

    n_dofs: int
    dofs: IntArray
    axes: Array
    L: Array
    ends: Array
    properties: BeamProperties

    def inertia_loads(self) -> Array:
        """F (n_dofs, 6): the first order change of the inertia is F^T u."""
        changes, motion = self._sections().changes(), self._section_motions()
        loads = np.einsum("pdi,pij->pjd", changes, motion, optimize=True)
        F = np.zeros((self.n_dofs, 6))
        np.add.at(F, np.tile(self.dofs, (len(BEAM_GAUSS_POINTS[0]), 1)), loads)
        return F

    def inertia(self, motions: Array) -> Array:
        """Q (6, r, r): the second derivative of the inertia by motions."""
        return self._sections().second(*self._at_sections(motions))

    def gyroscopic(self, motions: Array) -> Array:
        """h (3, r, r): the angular momentum h(q, q') of motions."""
        return self._sections().momentum(*self._at_sections(motions))

    def third(self, u: Array, motions: Array) -> Array:
        """D3(u; psi_k, psi_l) (n, r, r): the third derivative of the strain energy.

            D3(a; b, c) = 2 int sigma(a).e2(b, c) + sigma(b).e2(a, c) + sigma(c).e2(a, b)

        with the second order strains e2 of Reissner's beam for what is left of a motion once the
        element (its chord, and its mean twist) is turned back, and for the turn w of the element

            D3(U w; b, c) = -b^T K S c - (S b)^T K c,    S = [w~, 0; 0, 1/2 w~] at each node

        which is exact, where Hermite's shapes are not frame indifferent. Shear forces are those of
        equilibrium, Q = -M', so that they are there without shear strains. Source: J. C. Simo,
        Computer Methods in Applied Mechanics and Engineering 49 (1985) 55-70.
        """
        r = motions.shape[1]
        total = np.zeros((u.shape[1], r, r))
        for part in self._batches(BEAM_STRAIN_ROWS * r * (r + u.shape[1])):
            a, b = part._state(u), part._state(motions)
            total += np.einsum("ia,ikl->akl", a.stress, _second_strains(b, b), optimize=True)
            mixed = np.einsum("ik,ial->akl", b.stress, _second_strains(a, b), optimize=True)
            total += mixed + mixed.transpose(0, 2, 1)
        return total

    def quartic(self, motions: Array, moved: Moved | None) -> tuple[Array, Array]:
        """`BodyError`: the squares of the slopes of beams would lock against their stretch."""
        raise BodyError("lines: expected solids for the strain energy of fourth order")

    def _batches(self, numbers: int) -> Iterator["BeamTensors"]:
        """Some elements at a time, of each of which so many numbers are made."""
        size = max(1, BEAM_BATCH // numbers)
        for first in range(0, len(self.L), size):
            yield self._part(slice(first, first + size))

    def _part(self, rows: slice) -> "BeamTensors":
        fields = vars(self.properties).items()
        properties = BeamProperties(**{name: values[rows] for name, values in fields})
        return replace(
            self,
            dofs=self.dofs[rows],
            axes=self.axes[rows],
            L=self.L[rows],
            ends=self.ends[rows],
            properties=properties,
        )

    def _sections(self) -> Pieces:
        """The sections at all stations as rigid pieces, stations first."""
        p, (xi, weights) = self.properties, BEAM_GAUSS_POINTS
        local = np.stack([p.polar, p.rotary_y, p.rotary_z], axis=1)
        inertia = np.einsum("eai,ea,eaj->eij", self.axes, local * self.L[:, None], self.axes)
        X = np.einsum("gk,eki->gei", np.stack([1.0 - xi, xi], axis=1), self.ends)
        return Pieces(
            np.outer(weights, p.mass * self.L).ravel(),
            np.einsum("g,eij->geij", weights, inertia).reshape(-1, 3, 3),
            X.reshape(-1, 3),
        )

    def _section_motions(self) -> Array:
        """Displacement and rotation of the sections from the dofs of their elements (p, 6, 12), in
        mesh axes.
        """
        local = [section_motion(xi, self.L, self.properties) for xi in BEAM_GAUSS_POINTS[0]]
        back = np.kron(np.eye(2), self.axes.transpose(0, 2, 1))
        return np.concatenate([back @ motion @ self._turn for motion in local])

    def _at_sections(self, motions: Array) -> tuple[Array, Array]:
        """Displacements and rotations (3, p, r) of the sections."""
        stations = np.tile(motions[self.dofs], (len(BEAM_GAUSS_POINTS[0]), 1, 1))
        fields = np.transpose(self._section_motions() @ stations, (1, 0, 2))
        return fields[:3], fields[3:]

    @property
    def _turn(self) -> Array:
        """(n, 12, 12): mesh axes to local axes."""
        return np.asarray(np.kron(np.eye(4), self.axes))

    def _state(self, motions: Array) -> _State:
        d = self._turn @ motions[self.dofs]
        ends = d.reshape(len(d), 4, 3, -1).transpose(2, 1, 0, 3)
        turned, spin = self._turned(ends)
        left = (ends - turned).transpose(2, 1, 0, 3).reshape(d.shape)
        motion, first, second = (self._fields(left, derivative) for derivative in range(3))
        loads = (local_stiffness(self.L, self.properties) @ d).reshape(len(d), 4, 3, -1)
        return _State(
            np.concatenate(
                [_rows(self._forces(first, second)), _rows(loads.transpose(2, 1, 0, 3))]
            ),
            first[:3],
            motion[3:],
            first[3:],
            spin,
            ends - 0.5 * turned,
        )

    def _turned(self, ends: Array) -> tuple[Array, Array]:
        """What the ends (3, 4, n, r) do as the element turns, and its rotation (3, 1, n, r)."""
        chord = cross(AXIS_OF_BEAM[:, None, None], ends[:, 2] - ends[:, 0]) / self.L[:, None]
        spin = chord + 0.5 * AXIS_OF_BEAM[:, None, None] * (ends[:, 1] + ends[:, 3])
        arm = np.outer(AXIS_OF_BEAM, self.L)[:, :, None]
        return np.stack([0.0 * spin, spin, cross(spin, arm), spin], axis=1), spin[:, None]

    def _fields(self, d: Array, derivative: int) -> Array:
        """Displacement and rotation (6, p, r) of sections in local axes, or a derivative."""
        stations = [
            section_motion(xi, self.L, self.properties, derivative) for xi in BEAM_GAUSS_POINTS[0]
        ]
        return np.concatenate([motion @ d for motion in stations]).transpose(1, 0, 2)

    def _forces(self, first: Array, second: Array) -> Array:
        """N, Q, M (6, p, r), times the weight of each station."""
        p = self.properties
        stiffness = np.stack([p.EA, -p.EI_z, p.EI_y, p.GJ, p.EI_y, p.EI_z]) * self.L
        weighted = np.einsum("g,ie->ige", BEAM_GAUSS_POINTS[1], stiffness).reshape(6, -1, 1)
        return np.asarray(weighted * np.stack([first[0], second[5], second[4], *first[3:]]))


def beam_tensors(mesh: Mesh, sections: list[Section], center: Array) -> BeamTensors:
    """The beams of a mesh of lines, one section for each line, about the center of mass."""
    L, axes = lengths_and_axes(mesh, sections)
    lines = mesh.cells["line"]
    return BeamTensors(
        6 * len(mesh.points),
        node_dofs(lines, 6),
        axes,
        L,
        mesh.points[lines] - center,
        beam_properties(sections, L),
    )


def _second_strains(a: _State, b: _State) -> Array:
    """Twice the second order strains (n_rows, r_a, r_b) of two states."""
    # Motions of a are rows, those of b columns of what each product makes.
    ua, wa, ka, sa, da = (x[..., None] for x in (a.slope, a.rotation, a.curvature, a.spin, a.ends))
    ub, wb, kb, sb, db = (
        x[..., None, :] for x in (b.slope, b.rotation, b.curvature, b.spin, b.ends)
    )
    e1 = AXIS_OF_BEAM[:, None, None, None]
    stretch = 0.5 * (cross(wa, cross(wb, e1)) + cross(wb, cross(wa, e1)))
    stretch -= cross(wa, ub) + cross(wb, ua)
    bending = -0.5 * (cross(wa, kb) + cross(wb, ka))
    turning = -ROTATION_HALVES[..., None] * (cross(sa, db) + cross(sb, da))
    return np.concatenate(
        [part.reshape(-1, *part.shape[-2:]) for part in (stretch, bending, turning)]
    )


def _rows(x: Array) -> Array:
    """All but the last axis as one."""
    return x.reshape(-1, x.shape[-1])
