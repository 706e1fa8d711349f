"""A part as its mesh answers a hammer: modes at its interfaces, and where it is hit and sensed."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from ...files.arrays import Array
from ..assembly.structure import assemble_on
from ..body.body import Body
from ..body.impulse import Impulse
from ..elements.location import locate
from ..elements.sampling import displacement_rows, gradient_rows
from ..errors import BodyError, MeasurementError
from ..measured.coordinates import space_rows
from ..measured.rigid import RigidProperties
from ..plausibility import doubts_of_body, doubts_of_source
from ..progress import Stages
from ..responses.impulse import impulse_responses
from ..sources.reading import read_source
from ..sources.solids import SolidSource
from ..threads import blas_threads
from .free_part import FreePart, PlaceMotion

BAND_OF_MODES = 1.2
"""of the highest frequency of the test: up to there all responses are right"""


@dataclass(frozen=True, eq=False)
class StruckPart(FreePart):
    """A part at n points too.

    phi (n, 3, m) and gradients (n, 3, 3, m) [1/m] of modes at the points (n, 3) [m] from the center
    of mass.
    """

    points: Array
    phi: Array
    gradients: Array

    def at(self, k: int, offset: Array) -> PlaceMotion:
        """The motion along x, y, z beside the point k, by the gradient there."""
        phi = self.phi[k] + np.einsum("ijm,j->im", self.gradients[k], offset)
        return PlaceMotion(space_rows(self.points[k] + offset), phi)


def solids_of(body: Body) -> SolidSource:
    """The mesh of a body; `BodyError` unless it is one of solids."""
    if body.matrices is None and isinstance(source := read_source(body), SolidSource):
        return source
    found = "a mesh with lines or shells" if body.matrices is None else "[matrices]"
    raise BodyError(f"expected a mesh of solids, whose surface a hammer hits, found {found}")


def struck_part(
    body: Body, points: dict[str, Array], pushes: dict[str, Array], highest: float, stages: Stages
) -> StruckPart:
    """The part of a body file at points (3,) [m] in its axes, right up to a frequency [Hz].

    pushes (3,): the direction in which a point is hit, of those that are loaded in no other one.
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
    # Loads are at the points too, whose static responses modes of the interfaces would not have. A
    # hit along one direction is one load, not three: fewer loads make far fewer modes.
    loads = [
        pushes[name][None] @ row if name in pushes else row
        for name, row in zip(places, rows, strict=True)
    ]
    impulse = Impulse(
        step=0.25 / (BAND_OF_MODES * highest), steps=1, tolerance=body.impulse.tolerance
    )
    everywhere = sp.vstack([structure.P_C, *(sp.csr_matrix(load) for load in loads)], format="csr")
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
        RigidProperties(rigid.mass, rigid.center, rigid.J_rot),
        structure.interfaces,
        replace(found.modes, phi=found.modes.phi[: structure.n_c]),
        np.array(list(points.values())).reshape(-1, 3) - rigid.center,
        found.shapes(sp.vstack(rows, format="csr")).reshape(n, 3, m),
        found.shapes(sp.vstack(slopes, format="csr")).reshape(n, 3, 3, m),
    )
