"""A part as its mesh answers a hammer: modes at its interfaces, and where it is hit and measured.

    H(s) = R_o M^-1 R_i^T + Phi_o diag(s^2 / (s^2 + 2 zeta omega s + omega^2 c)) Phi_i^T

Accelerances [1/kg] of motions `o` by loads `i`, with their rigid motions R and modes Phi; c: of
material damping, else 1. Source: docs/theory.md, Frequency response tests.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from ...files.arrays import Array, Complex
from ...superelement import Interface, Modes
from ...superelement.transfer import laplace_stiffness
from ..assembly.structure import assemble_on
from ..body.body import Body
from ..body.impulse import Impulse
from ..elements.location import locate
from ..elements.sampling import displacement_rows, gradient_rows
from ..errors import BodyError, MeasurementError
from ..plausibility import doubts_of_body, doubts_of_source
from ..progress import Stages
from ..responses.impulse import impulse_responses
from ..sources.reading import read_source
from ..sources.solids import SolidSource
from ..threads import blas_threads

BAND_OF_MODES = 1.2
"""of the highest frequency of the test: up to there all responses are right"""


class PlaceMotion(NamedTuple):
    """Rigid motions (n, 6) about the center, and modes (n, m) [1/sqrt(kg)], of n motions."""

    rigid: Array
    phi: Array

    def along(self, rows: Array) -> "PlaceMotion":
        """Combinations rows (k, n) of the motions."""
        return PlaceMotion(rows @ self.rigid, rows @ self.phi)


@dataclass(frozen=True, eq=False)
class StruckPart:
    """A part at its interfaces, and at n points.

    modes: at the interfaces; phi (n, 3, m) and gradients (n, 3, 3, m) [1/m] of modes at the points
    (n, 3) [m] from the center of mass.
    """

    name: str
    mass: float
    J_rot: Array
    center: Array
    interfaces: tuple[Interface, ...]
    modes: Modes
    points: Array
    phi: Array
    gradients: Array

    @property
    def M(self) -> Array:
        """Mass and inertia (6, 6) about the center of mass."""
        M = np.zeros((6, 6))
        M[:3, :3], M[3:, 3:] = self.mass * np.eye(3), self.J_rot
        return M

    @property
    def damping(self) -> Array:
        """Damping ratios of all modes (m,), with the losses of the material."""
        return np.asarray(self.modes.zeta + 0.5 * self.modes.loss_factors)

    def at(self, k: int, offset: Array) -> PlaceMotion:
        """The motion along x, y, z beside the point k, by the gradient there."""
        phi = self.phi[k] + np.einsum("ijm,j->im", self.gradients[k], offset)
        return PlaceMotion(rigid_rows(self.points[k] + offset), phi)

    def at_interface(self, name: str) -> PlaceMotion:
        first = 0
        for interface in self.interfaces:
            n = 6 if interface.rotations else 3
            if interface.name == name:
                # Rotations of a frame are those of the whole part.
                turns = np.hstack([np.zeros((3, 3)), np.eye(3)])
                rigid = np.vstack([rigid_rows(interface.X), turns])[:n]
                return PlaceMotion(rigid, self.modes.phi[first : first + n])
            first += n
        known = ", ".join(interface.name for interface in self.interfaces)
        raise MeasurementError(f"{self.name} has no interface {name!r}; there are: {known}")

    def accelerance(self, s: Complex, out: PlaceMotion, into: PlaceMotion) -> Complex:
        """H (k, n_o, n_i) at s (k,)."""
        h = (s[:, None] ** 2 / laplace_stiffness(self.modes, s)).T
        # One product of matrices for all pairs: an order of magnitude faster than einsum.
        pairs = (out.phi[:, None] * into.phi).reshape(-1, len(h))
        shape = (len(s), len(out.phi), len(into.phi))
        elastic = (pairs @ h.real + 1j * (pairs @ h.imag)).T.reshape(shape)
        return np.asarray(elastic + out.rigid @ np.linalg.solve(self.M, into.rigid.T))


def stacked_motions(motions: list[PlaceMotion]) -> PlaceMotion:
    return PlaceMotion(*(np.vstack(parts) for parts in zip(*motions, strict=True)))


def rigid_rows(X: Array) -> Array:
    """(3, 6): u + theta x X."""
    turn = np.array([[0.0, X[2], -X[1]], [-X[2], 0.0, X[0]], [X[1], -X[0], 0.0]])
    return np.hstack([np.eye(3), turn])


def solids_of(body: Body) -> SolidSource:
    """The mesh of a body; `BodyError` unless it is one of solids."""
    if body.matrices is None and isinstance(source := read_source(body), SolidSource):
        return source
    raise BodyError("a hammer test takes a mesh of solids, whose surface is hit, found another")


def struck_part(body: Body, points: dict[str, Array], highest: float, stages: Stages) -> StruckPart:
    """The part of a body file at points (3,) [m] in its axes, right up to a frequency [Hz].

    `MeasurementError` names a point that is not on the mesh.
    """
    with stages.stage("mesh"):
        source = solids_of(body)
        for doubt in (*doubts_of_body(body), *doubts_of_source(body, source)):
            stages.warn(doubt)
        places = {}
        for name, point in points.items():
            try:
                places[name] = locate(source.mesh, point)
            except BodyError as error:
                raise MeasurementError(f"{name}: {error}") from error
    with stages.stage("assembly"):
        # Load patterns and sensors of the body have no part in its test.
        structure = assemble_on(body.model_copy(update={"loads": {}, "sensors": {}}), source)
        rows = [displacement_rows(source.mesh, place) @ structure.T for place in places.values()]
        slopes = [gradient_rows(source.mesh, place) @ structure.T for place in places.values()]
    # Loads are at the points too, whose static responses modes of the interfaces would not have.
    impulse = Impulse(
        step=0.25 / (BAND_OF_MODES * highest), steps=1, tolerance=body.impulse.tolerance
    )
    everywhere = sp.vstack([structure.P_C, *rows], format="csr")
    with stages.stage("modes"), blas_threads(structure.n_u):
        found = impulse_responses(
            replace(structure, P_C=everywhere, surfaces=None),
            # Fields of the whole body would take many more modes.
            body.model_copy(update={"impulse": impulse, "surfaces": {}, "recovery": None}),
            stages,
        )
    assert found.modes is not None
    assert found.shapes is not None
    n, m = len(places), len(found.modes.omega)
    rigid = structure.rigid
    return StruckPart(
        body.name,
        rigid.mass,
        rigid.J_rot,
        rigid.center,
        structure.interfaces,
        replace(found.modes, phi=found.modes.phi[: structure.n_c]),
        np.array(list(points.values())).reshape(-1, 3) - rigid.center,
        found.modes.phi[structure.n_c :].reshape(n, 3, m),
        found.shapes(sp.vstack(slopes, format="csr")).reshape(n, 3, 3, m),
    )
