"""Shells of the body file: their thickness, materials and plies."""

from typing import Annotated

from pydantic import Field, PositiveFloat

from ...inputs import Table, Vector, rule


class Ply(Table):
    """A layer of a laminate: its thickness [m], material, and angle [deg] of the fibers.

    material: a name in [materials], none where [material] is that of all. angle: from axis 1 of the
    shell, about its normal.
    """

    thickness: PositiveFloat
    material: str | None = None
    angle: float = 0.0


class Shell(Table):
    """A shell on triangles and quadrangles of the mesh: one material, or plies.

    thickness [m]; material: a name in [materials], none where [material] is that of all. plies:
    layers in place of both, from the lower face to the upper one, to which the normal points.
    offset [m]: of the middle of the thickness from the nodes, along the normal. orientation: a
    vector in mesh axes, whose projection on the shell is axis 1, that of fibers at the angle 0;
    needed where a material is orthotropic.
    """

    thickness: PositiveFloat | None = None
    material: str | None = None
    plies: Annotated[tuple[Ply, ...], Field(min_length=1)] | None = None
    offset: float = 0.0
    orientation: Vector | None = None

    @rule
    def _one_build(self) -> None:
        if self.plies is None and self.thickness is None:
            raise ValueError("expected thickness or plies, found neither")
        if self.plies is not None:
            others = [key for key in ("thickness", "material") if getattr(self, key) is not None]
            if others:
                raise ValueError(
                    f"plies have thicknesses and materials of their own, found {others[0]} too"
                )

    @rule
    def _has_direction(self) -> None:
        if self.orientation is not None and not any(self.orientation):
            raise ValueError("orientation: expected a vector that is not zero")

    @property
    def layers(self) -> tuple[Ply, ...]:
        """The plies; a single one of a shell of one material."""
        if self.plies is not None:
            return self.plies
        assert self.thickness is not None
        return (Ply(thickness=self.thickness, material=self.material),)

    @property
    def total(self) -> float:
        """The whole thickness [m]."""
        return sum(ply.thickness for ply in self.layers)
