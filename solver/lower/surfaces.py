"""Contacts of surfaces as arrays: their points of integration, dual functions, and flexibility."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...superelement import Surface
from ..arrays import Array, Index, as_index, as_rows
from ..couplings.surface_contacts import SurfaceContact
from ..history.layout import Stepping
from ..history.packing import packed
from ..history.shares import shares_of
from ..model.model import Model
from ..step.records.elastic import Elastic
from ..step.records.surfaces import Patches, SurfaceBodies, SurfaceContacts, Surfaces
from .facets import RuleOfFacets, rule_of
from .numbering import NumberedFrames, carrier_name

MOST_NODES = 9
"""nodes of a facet, the most of all types"""
MOST_CORNERS = 4


@dataclass(frozen=True, eq=False)
class Patch:
    """A surface of a body of a model, with its rows and points of integration."""

    body: str
    surface: Surface

    @cached_property
    def rule(self) -> RuleOfFacets:
        return rule_of(self.surface.facet_type)

    @cached_property
    def corners(self) -> Index:
        """The nodes that have rows, by their numbers on the surface."""
        return np.unique(self.surface.facets[:, : self.rule.n_corners])

    @property
    def points_per_facet(self) -> int:
        return len(self.rule.weights)

    @property
    def n_points(self) -> int:
        return len(self.surface.facets) * self.points_per_facet

    @cached_property
    def weights(self) -> Array:
        """w_q (n_facets, points) of the undeformed surface [m^2]."""
        x = self.surface.X[self.surface.facets]
        tangents = np.einsum("qdk,fkc->fqdc", self.rule.slopes, x)
        normals = np.cross(tangents[:, :, 0], tangents[:, :, 1])
        return np.linalg.norm(normals, axis=2) * self.rule.weights

    @cached_property
    def dual(self) -> Array:
        """Dual functions (n_facets, points, corners): psi = D M^-1 L of the corners' functions L.

        M = sum_q w L L^T,   D = diag(sum_q w L)
        """
        L, w = self.rule.corner_functions, self.weights
        M = np.einsum("fq,qi,qj->fij", w, L, L)
        D = np.einsum("fq,qi->fi", w, L)
        A = D[:, :, None] * np.linalg.inv(M)
        return np.einsum("fij,qj->fqi", A, L)

    @cached_property
    def areas(self) -> Array:
        """A_i of the rows [m^2]."""
        areas = np.zeros(len(self.corners))
        per_facet = np.einsum("fq,fqi->fi", self.weights, self.dual)
        np.add.at(areas, self.rows_of_facets, per_facet)
        return areas

    @cached_property
    def rows_of_facets(self) -> Index:
        """The rows of the corners of each facet (n_facets, corners)."""
        return np.searchsorted(self.corners, self.surface.facets[:, : self.rule.n_corners])

    @cached_property
    def supports(self) -> list[Index]:
        """The nodes of the facets around each row."""
        around: list[set[int]] = [set() for _ in self.corners]
        for rows, nodes in zip(self.rows_of_facets, self.surface.facets, strict=True):
            for i in rows:
                around[i].update(nodes.tolist())
        return [as_index(sorted(nodes)) for nodes in around]


@dataclass(frozen=True, eq=False)
class SurfaceLayout:
    """The patches and islands of a model, as far as they do not depend on the step."""

    contacts: tuple[SurfaceContact, ...]
    patches: list[Patch]
    """each surface once, those of a body together"""
    islands: list[list[int]]
    """contacts by island"""
    island_bodies: list[list[int]]
    """bodies by island"""

    def patch_of(self, contact: SurfaceContact) -> int:
        names = [(patch.body, patch.surface.name) for patch in self.patches]
        return names.index((contact.body, contact.surface))


def plan_surfaces(model: Model, frames: NumberedFrames) -> SurfaceLayout:
    """The surfaces in contact, body by body, and the islands that are solved for together."""
    contacts = model.surface_contacts
    used = {(contact.body, contact.surface) for contact in contacts}
    patches = [
        Patch(name, surface)
        for name, body in model.flexible_bodies.items()
        if body.superelement.surfaces is not None
        for surface in body.superelement.surfaces.patches
        if (name, surface.name) in used
    ]
    islands: dict[str, list[int]] = {}
    for c, contact in enumerate(contacts):
        islands.setdefault(contact.body, []).append(c)
    numbers = {name: b for b, name in enumerate(model.bodies)}
    bodies = []
    for body, members in islands.items():
        carriers = {int(frames.arrays.body[carrier_of(frames, contacts[c])]) for c in members}
        bodies.append([numbers[body], *sorted(carriers - {-1, numbers[body]})])
    return SurfaceLayout(contacts, patches, list(islands.values()), bodies)


def carrier_of(frames: NumberedFrames, contact: SurfaceContact) -> int:
    """The number of the frame that carries the shape of a contact."""
    return frames.number(carrier_name(contact))


def lay_out_surfaces(
    model: Model,
    layout: SurfaceLayout,
    frames: NumberedFrames,
    elastic: Elastic,
    stepping: Stepping,
) -> Surfaces:
    """All arrays of the contacts of surfaces, in steps of a size."""
    owners = list(dict.fromkeys(patch.body for patch in layout.patches))
    patches = _lay_out_patches(model, layout, owners)
    return Surfaces(
        patches=patches,
        bodies=_lay_out_bodies(model, layout, owners, elastic, stepping),
        contacts=_lay_out_contacts(layout, frames, elastic, patches),
    )


def _lay_out_patches(model: Model, layout: SurfaceLayout, owners: Sequence[str]) -> Patches:
    numbers = {name: b for b, name in enumerate(model.bodies)}
    patches = layout.patches
    node = _starts(patch.surface.n for patch in patches)
    row = _starts(len(patch.corners) for patch in patches)
    point = _starts(patch.n_points for patch in patches)
    tables = [
        _points(patch, *starts) for patch, *starts in zip(patches, node, row, point, strict=False)
    ]
    around = [_around(patch, first) for patch, first in zip(patches, point.tolist(), strict=False)]
    centers = [_center(patch.surface.X) for patch in patches]
    supports = [
        first + nodes
        for patch, first in zip(patches, node.tolist(), strict=False)
        for nodes in patch.supports
    ]
    return Patches(
        body=as_index([numbers[patch.body] for patch in patches]),
        owner=as_index([owners.index(patch.body) for patch in patches]),
        node=node,
        row=row,
        point=point,
        center=as_rows(centers),
        radius=np.array(
            [
                np.linalg.norm(patch.surface.X - center, axis=1).max()
                for patch, center in zip(patches, centers, strict=True)
            ],
            dtype=np.float64,
        ),
        X=np.concatenate([np.empty((0, 3)), *(patch.surface.X for patch in patches)]),
        area=np.concatenate([np.empty(0), *(patch.areas for patch in patches)]),
        width=max((patch.rule.n_nodes for patch in patches), default=0),
        nodes=_joined([table[0] for table in tables], MOST_NODES, np.int64),
        N=_joined([table[1] for table in tables], MOST_NODES, np.float64),
        rows=_joined([table[2] for table in tables], MOST_CORNERS, np.int64),
        weight=_joined([table[3] for table in tables], MOST_CORNERS, np.float64),
        row_point=_starts(len(one.points) for rows in around for one in rows),
        point_of_row=as_index([q for rows in around for one in rows for q in one.points]),
        weight_of_row=np.array(
            [w for rows in around for one in rows for w in one.weights], dtype=np.float64
        ),
        slot_of_row=_joined([one.slots for rows in around for one in rows], MOST_NODES, np.int64),
        support_range=_starts(len(nodes) for nodes in supports),
        support=as_index([k for nodes in supports for k in nodes]),
    )


def _points(patch: Patch, node: int, row: int, point: int) -> tuple[Array, Array, Array, Array]:
    """Nodes, shape functions, rows and weights of all points of a patch, padded."""
    rule, n = patch.rule, patch.n_points
    per = patch.points_per_facet
    nodes, N = np.full((n, MOST_NODES), -1), np.zeros((n, MOST_NODES))
    rows, weight = np.full((n, MOST_CORNERS), -1), np.zeros((n, MOST_CORNERS))
    nodes[:, : rule.n_nodes] = np.repeat(patch.surface.facets, per, axis=0) + node
    N[:, : rule.n_nodes] = np.tile(rule.functions, (len(patch.surface.facets), 1))
    rows[:, : rule.n_corners] = np.repeat(patch.rows_of_facets, per, axis=0) + row
    scaled = patch.weights[:, :, None] * patch.dual / patch.areas[patch.rows_of_facets][:, None]
    weight[:, : rule.n_corners] = scaled.reshape(n, -1)
    return nodes, N, rows, weight


@dataclass(frozen=True, eq=False)
class _Around:
    """The points of the facets around a row, its weights there, and their nodes in its support."""

    points: list[int]
    weights: list[float]
    slots: Index


def _around(patch: Patch, point: int) -> list[_Around]:
    per, facets = patch.points_per_facet, patch.surface.facets
    scaled = patch.weights[:, :, None] * patch.dual / patch.areas[patch.rows_of_facets][:, None]
    points: list[list[int]] = [[] for _ in patch.corners]
    weights: list[list[float]] = [[] for _ in patch.corners]
    slots: list[list[Index]] = [[] for _ in patch.corners]
    for f, rows in enumerate(patch.rows_of_facets):
        for corner, i in enumerate(rows.tolist()):
            places = np.full(MOST_NODES, -1)
            places[: facets.shape[1]] = np.searchsorted(patch.supports[i], facets[f])
            for q in range(per):
                points[i].append(point + f * per + q)
                weights[i].append(float(scaled[f, q, corner]))
                slots[i].append(places)
    return [
        _Around(own, weight, as_index(slot).reshape(-1, MOST_NODES))
        for own, weight, slot in zip(points, weights, slots, strict=True)
    ]


def _lay_out_bodies(
    model: Model,
    layout: SurfaceLayout,
    owners: Sequence[str],
    elastic: Elastic,
    stepping: Stepping,
) -> SurfaceBodies:
    flexible = list(model.flexible_bodies)
    numbers = [flexible.index(name) for name in owners]
    motions = [
        _motion(model, layout, name, e, elastic, stepping)
        for name, e in zip(owners, numbers, strict=True)
    ]
    counts = [sum(p.surface.n for p in layout.patches if p.body == name) for name in owners]
    each = range(len(owners))
    phi, phi_start = packed([motion.phi for motion in motions], each)
    T, T_start = packed([motion.T for motion in motions], each)
    G, G_start = packed([motion.G for motion in motions], each)
    return SurfaceBodies(
        flexible=as_index(numbers),
        node=_starts(counts),
        phi=phi,
        phi_start=phi_start,
        T=T,
        T_start=T_start,
        G=G,
        G_start=G_start,
        reach=np.array([motion.reach for motion in motions], dtype=np.float64),
    )


@dataclass(frozen=True, eq=False)
class _Motion:
    """How the nodes of a body move: see `SurfaceBodies`."""

    phi: Array
    T: Array
    G: Array
    reach: float


def _motion(
    model: Model,
    layout: SurfaceLayout,
    name: str,
    e: int,
    elastic: Elastic,
    stepping: Stepping,
) -> _Motion:
    element = model.flexible_bodies[name].superelement
    surfaces, modes = element.surfaces, element.modes
    assert surfaces is not None and modes is not None
    names = [patch.surface.name for patch in layout.patches if patch.body == name]
    dofs = np.concatenate([np.arange(*_bounds(surfaces.rows(surface))) for surface in names])
    shapes = surfaces.phi[dofs]
    residual = surfaces.H[np.ix_(dofs, dofs)] - (shapes / modes.omega**2) @ shapes.T
    phi = shares_of(element, stepping.shortest).shapes(shapes)
    own = slice(int(elastic.modes.range[e]), int(elastic.modes.range[e + 1]))
    h, beta = stepping.h, stepping.scheme.beta
    per_mode = beta * h * h / elastic.modes.step_stiffness[own]
    n_c, m = int(elastic.dof[e + 1] - elastic.dof[e]), phi.shape[1]
    start = int(elastic.modes.phi_start[e])
    phi_J = elastic.modes.phi[start : start + n_c * m].reshape(n_c, m)
    active = elastic.active[elastic.active_range[e] : elastic.active_range[e + 1]]
    phi_J = phi_J[active - elastic.dof[e]]
    G_CJ, G_JJ = (phi * per_mode) @ phi_J.T, (phi_J * per_mode) @ phi_J.T
    T = np.linalg.solve(G_JJ, G_CJ.T).T if len(active) else np.empty((len(dofs), 0))
    G = (phi * per_mode) @ phi.T + residual - T @ G_CJ.T
    squares = ((phi / np.sqrt(elastic.modes.stiffness[own])) ** 2).sum(axis=1)
    reach = float(np.sqrt(2.0 * squares.reshape(-1, 3).sum(axis=1).max()))
    return _Motion(phi, T, 0.5 * (G + G.T), reach)


def _lay_out_contacts(
    layout: SurfaceLayout, frames: NumberedFrames, elastic: Elastic, patches: Patches
) -> SurfaceContacts:
    contacts = layout.contacts
    patch = [layout.patch_of(contact) for contact in contacts]
    carriers = [carrier_of(frames, contact) for contact in contacts]
    axes = [contact.axes_of_shape(frames.poses[carrier_name(contact)].R) for contact in contacts]
    parameters = [contact.shape_parameters() for contact in contacts]
    widths = [[_coordinates(b, elastic) for b in bodies] for bodies in layout.island_bodies]
    totals = [sum(width) for width in widths]
    coordinate = np.full((len(contacts), 2), -1)
    for members, bodies, width in zip(layout.islands, layout.island_bodies, widths, strict=True):
        first = dict(zip(bodies, _starts(width).tolist(), strict=False))
        for c in members:
            coordinate[c, 0] = first[int(patches.body[patch[c]])]
            coordinate[c, 1] = first.get(int(frames.arrays.body[carriers[c]]), -1)
    supports = np.diff(patches.support_range[patches.row])
    return SurfaceContacts(
        patch=as_index(patch),
        frame=as_index(carriers),
        shape=as_index([contact.kind.number for contact in contacts]),
        side=np.array([-1.0 if contact.hollow else 1.0 for contact in contacts]),
        axis=as_rows([axis for axis, _ in axes]),
        across=as_rows([across for _, across in axes]),
        first=_starts(map(len, parameters)),
        parameters=np.array([x for numbers in parameters for x in numbers], dtype=np.float64),
        margin=np.array(
            [np.nan if c.margin is None else c.margin for c in contacts], dtype=np.float64
        ),
        layer=np.array(
            [0.0 if c.layer is None else 1.0 / c.layer for c in contacts], dtype=np.float64
        ),
        row=_starts(len(layout.patches[p].corners) for p in patch),
        support=_starts(supports[patch].tolist()),
        island_range=_starts(map(len, layout.islands)),
        island=as_index([c for members in layout.islands for c in members]),
        coordinate=as_index(coordinate).reshape(-1, 2),
        body_range=_starts(map(len, layout.island_bodies)),
        body=as_index([b for bodies in layout.island_bodies for b in bodies]),
        body_coordinate=as_index([i for width in widths for i in _starts(width)[:-1]]),
        body_width=as_index([n for width in widths for n in width]),
        coordinates=as_index(totals),
        stiffness_start=_starts(n * n for n in totals)[:-1].copy(),
        block_range=_starts(len(bodies) ** 2 for bodies in layout.island_bodies),
    )


def sizes_of_surfaces(surfaces: Surfaces) -> Mapping[str, int]:
    """The dimensions of the state and the scratch of contacts of surfaces."""
    contacts, patches, bodies = surfaces.contacts, surfaces.patches, surfaces.bodies
    rows = np.diff(contacts.row)
    members = np.split(contacts.island, contacts.island_range[1:-1])
    return {
        "n_contacts": len(contacts.patch),
        "n_bodies": len(bodies.flexible),
        "n_nodes": len(patches.X),
        "n_contact_rows": int(contacts.row[-1]),
        "n_islands": len(members) if len(contacts.patch) else 0,
        "n_most_points": int(np.diff(patches.point).max(initial=0)),
        "n_contact_supports": int(contacts.support[-1]),
        "n_most_rows": max((int(rows[own].sum()) for own in members), default=0),
        "n_most_coordinates": int(contacts.coordinates.max(initial=0)),
        "n_stiffness": int((contacts.coordinates**2).sum()),
        "n_most_displacements": 3 * int(np.diff(bodies.node).max(initial=0)),
    }


def _coordinates(body: int, elastic: Elastic) -> int:
    e = int(elastic.of_body[body])
    return 6 if e < 0 else 6 + int(elastic.active_range[e + 1] - elastic.active_range[e])


def _center(X: Array) -> Array:
    return 0.5 * (X.min(axis=0) + X.max(axis=0))


def _bounds(rows: slice) -> tuple[int, int]:
    return rows.start, rows.stop


def _starts(lengths: Iterator[int] | Sequence[int] | map) -> Index:  # type: ignore[type-arg]
    return as_index(np.cumsum([0, *lengths]))


def _joined(tables: Sequence[Array | Index], columns: int, kind: type) -> Array:
    return np.concatenate([np.empty((0, columns), dtype=kind), *tables]).astype(kind)
