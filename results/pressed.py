"""The pressures that a run recorded of surfaces in contact, at their nodes and on outlines."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from ..files.arrays import Array
from ..superelement import Outline, Superelement, Surface
from .contents import Contents
from .errors import RecoveryError

if TYPE_CHECKING:
    from scipy.sparse import csr_array

SAME_PLACE = 1e-6
"""distance of a node of a surface from a point of an outline that is the same, over their size"""


class Run(Protocol):
    """What `Results` say of surfaces in contact."""

    @property
    def contents(self) -> Contents: ...
    @property
    def bodies(self) -> tuple[str, ...]: ...
    @property
    def surface_contacts(self) -> tuple[str, ...]: ...
    @property
    def pressed_surfaces(self) -> tuple[tuple[str, str, str], ...]: ...
    def superelement(self, body: str) -> Superelement: ...


class Pressed(NamedTuple):
    """A surface whose rows were recorded, of a body that was, with the name of its contact."""

    contact: str
    body: str
    surface: Surface

    @property
    def by_rows(self) -> Array:
        """Values at its nodes from those of its rows (n, k): middle nodes are between corners."""
        surface, corners = self.surface, self.surface.corners.shape[1]
        row = np.full(surface.n, -1)
        row[surface.corner_nodes] = np.arange(len(surface.corner_nodes))
        sums = np.zeros((surface.n, len(surface.corner_nodes)))
        for place in range(surface.facets.shape[1]):
            # The middle of a facet is behind those of its edges.
            at = [place] if place < corners else [place % corners, (place + 1) % corners]
            for corner in range(corners) if place == 2 * corners else at:
                sums[surface.facets[:, place], row[surface.facets[:, corner]]] = 1.0
        weights: Array = sums / sums.sum(axis=1, keepdims=True)
        return weights


def pressed_surfaces(results: Run) -> tuple[Pressed, ...]:
    """Those that can be drawn: recorded with `nodes`, and with their superelement at hand."""
    if not any(one.name == "surface_contact_pressure" for one in results.contents.quantities):
        return ()
    return tuple(_pressed(results))


def _pressed(results: Run) -> Iterator[Pressed]:
    for body, surface, contact in results.pressed_surfaces:
        # The second surface of a contact has no rows.
        if contact in results.surface_contacts and body in results.bodies:
            try:
                yield Pressed(contact, body, results.superelement(body).surface(surface))
            except RecoveryError:
                continue


def rows_of_outline(results: Run, body: str, outline: Outline) -> "dict[str, csr_array]":
    """For each contact that presses a body, pressures at its outline (p, k) from those of its rows.

    0 where the outline has no node of the surface. `RecoveryError` where no pressures are known.
    """
    # Only pictures need them, and a run should start at once.
    from scipy.sparse import csr_array
    from scipy.spatial import KDTree

    own = [one for one in pressed_surfaces(results) if one.body == body]
    if not own:
        raise RecoveryError(
            f"body {body!r}: no pressures: expected a contact in which its surface is the first, "
            "and [output] nodes = true"
        )
    # By places, for outlines have no numbers of nodes.
    tree, size = KDTree(outline.points), float(np.ptp(outline.points, axis=0).max())
    found: dict[str, csr_array] = {}
    for one in own:
        distance, point = tree.query(one.surface.X)
        nodes = np.flatnonzero(distance <= SAME_PLACE * size)
        if not len(nodes):
            raise RecoveryError(
                f"body {body!r}: no pressures: its outline has no node of surface "
                f"{one.surface.name!r}"
            )
        shape = len(outline.points), one.surface.n
        at = csr_array((np.ones(len(nodes)), (point[nodes], nodes)), shape=shape)
        found[one.contact] = csr_array(at @ one.by_rows)
    return found
