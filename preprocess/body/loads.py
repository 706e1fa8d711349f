"""Load patterns of the body file: loads that are spread over a surface, a volume or lines."""

import numpy as np

from ...inputs import Vector, rule
from .selection import FEATURE_KEYS, SHAPE_KEYS, Selection

LOAD_KINDS = ("pressure", "traction", "force_per_volume", "force_per_length")


class LoadPattern(Selection):
    """A distribution of loads, of which a signal is the amplitude: one of four kinds.

    pressure [Pa], against the outward normal, or traction (3,) [Pa] on facets of solids;
    force_per_volume (3,) [N/m^3] in solids; force_per_length (3,) [N/m] on lines. Vectors are in
    mesh axes and turn with the body.
    """

    pressure: float | None = None
    traction: Vector | None = None
    force_per_volume: Vector | None = None
    force_per_length: Vector | None = None

    @rule
    def _one_kind(self) -> None:
        found = self.given(*LOAD_KINDS)
        if len(found) != 1:
            raise ValueError(
                f"expected one of {', '.join(LOAD_KINDS)}, found {' and '.join(found) or 'none'}"
            )
        if not np.any(found[self.kind]):
            raise ValueError(f"{self.kind}: expected a load, found none")

    @rule
    def _of_extent(self) -> None:
        if self.node is not None or self.nodes is not None or "at" in self.model_fields_set:
            raise ValueError(
                "expected a group, hole, face, plane, box, sphere or cylinder: a load at one point "
                "acts on an interface"
            )
        if self.kind in ("pressure", "traction") and not self.selectors:
            raise ValueError(
                f"{self.kind}: expected what it acts on: group, hole, face, plane, box, sphere or "
                "cylinder, found none"
            )
        # Shapes select facets or nodes; which elements lie in one would be a matter of taste.
        on_facets = self.given(*FEATURE_KEYS, *SHAPE_KEYS)
        if self.kind not in ("pressure", "traction") and on_facets:
            raise ValueError(
                f"{self.kind}: expected a group of elements, or none for the whole body, found "
                f"{', '.join(on_facets)}"
            )

    @property
    def kind(self) -> str:
        """The key that says what the load is."""
        return next(iter(self.given(*LOAD_KINDS)))
