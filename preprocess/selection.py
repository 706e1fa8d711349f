"""What a body file selects on a mesh."""

from typing import Literal, Self

from pydantic import PositiveFloat, model_validator

from ..inputs import Table, Vector


class Plane(Table):
    """The facets of the boundary that lie in a plane, within `tolerance` times the size of the mesh."""

    point: Vector
    normal: Vector
    tolerance: PositiveFloat = 1e-6

    @model_validator(mode="after")
    def _has_direction(self) -> Self:
        if not any(self.normal):
            raise ValueError("normal: expected a vector that is not zero")
        return self


class InterfaceSelection(Table):
    """Where a body meets others: the node nearest to a point, a named group of the mesh, or the facets in a plane.

    A node of a solid gives three dofs; a node of a beam, and any set of facets, gives a frame of six.
    kind: "average", the frame follows the facets as their mean motion does, without stiffening them; "rigid", the
    facets follow the frame. at: the place of the frame; the centroid of the facets unless given.
    tolerance: the distance allowed between `node` and the nearest node, as a fraction of the size of the mesh.
    """

    node: Vector | None = None
    group: str | None = None
    plane: Plane | None = None
    kind: Literal["average", "rigid"] = "average"
    at: Vector | None = None
    tolerance: PositiveFloat = 1e-3

    @model_validator(mode="after")
    def _one_selection(self) -> Self:
        given = [key for key in ("node", "group", "plane") if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError(f"expected one of node, group and plane, found {' and '.join(given) or 'none'}")
        if self.node is not None and self.model_fields_set & {"kind", "at"}:
            raise ValueError("kind and at belong to a group or a plane, found them with node")
        return self
