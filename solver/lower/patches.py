"""Surfaces of a model that take part in contacts: their rows, points and dual functions."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...superelement import Surface
from ..arrays import Array, Index, as_index, as_rows, starts
from ..step.records.surfaces import Facets, Patches
from .facets import MOST_CORNERS, MOST_NODES, NUMBERED_FACETS, SMOOTH_TYPES, RuleOfFacets, rule_of

NEGLIGIBLE_SINE_SQUARED = 1e-12
"""1 - c^2 of normals between which an edge is straight"""
MOST_BALLS = 8
"""spheres around the parts of a surface"""
FEATURE_ANGLE = math.radians(30.0)
"""angle between facets from which on the edge between them is sharp"""


@dataclass(frozen=True, eq=False)
class Patch:
    """A surface in a contact.

    body: the number of its body, -1 in space; owner: the number of its flexible body among those
    with surfaces in contact, -1 of a rigid surface; smooth: whether its facets are curved where it
    is a target.
    """

    name: str
    body: int
    owner: int
    surface: Surface
    smooth: bool

    @cached_property
    def rule(self) -> RuleOfFacets:
        return rule_of(self.surface.facet_type)

    @cached_property
    def corners(self) -> Index:
        """The nodes that have rows, by their numbers on the surface."""
        return as_index(self.surface.corner_nodes)

    @cached_property
    def rows_of_facets(self) -> Index:
        """The rows of the corners of each facet (n_facets, corners)."""
        rows: Index = np.searchsorted(self.corners, self.surface.corners)
        return rows

    @property
    def n_points(self) -> int:
        return len(self.surface.facets) * len(self.rule.weights)

    @cached_property
    def weights(self) -> Array:
        """w_q (n_facets, points) of the undeformed surface [m^2]."""
        x = self.surface.X[self.surface.facets]
        tangents = np.einsum("qdk,fkc->fqdc", self.rule.slopes, x)
        normals = np.cross(tangents[:, :, 0], tangents[:, :, 1])
        weights: Array = np.linalg.norm(normals, axis=2) * self.rule.weights
        return weights

    @cached_property
    def dual(self) -> Array:
        """Dual functions (n_facets, points, corners): psi = D M^-1 L of the corners' functions L.

        M = sum_q w L L^T,   D = diag(sum_q w L)
        """
        L, w = self.rule.corner_functions, self.weights
        M = np.einsum("fq,qi,qj->fij", w, L, L)
        D = np.einsum("fq,qi->fi", w, L)
        # sum_q w psi_i L_k is zero unless i = k: each row has the gap of its own corner.
        psi: Array = np.einsum("fij,qj->fqi", D[:, :, None] * np.linalg.inv(M), L)
        return psi

    @cached_property
    def areas(self) -> Array:
        """A_i of the rows [m^2]."""
        areas = np.zeros(len(self.corners))
        # Not with +=, by which a row that several facets share would count once.
        np.add.at(areas, self.rows_of_facets, np.einsum("fq,fqi->fi", self.weights, self.dual))
        return areas

    @cached_property
    def around(self) -> list[list[tuple[int, int]]]:
        """The facets around each row, and which of their corners it is."""
        around: list[list[tuple[int, int]]] = [[] for _ in self.corners]
        for f, rows in enumerate(self.rows_of_facets.tolist()):
            for corner, i in enumerate(rows):
                around[i].append((f, corner))
        return around

    @cached_property
    def supports(self) -> list[Index]:
        """The nodes of the facets around each row."""
        facets = self.surface.facets
        return [as_index(np.unique(facets[[f for f, _ in around]])) for around in self.around]

    @cached_property
    def beside(self) -> Index:
        """The facet behind the edge after each corner, -1 where there is none (n_facets, 4)."""
        beside = np.full((len(self.surface.facets), MOST_CORNERS), -1)
        waiting: dict[frozenset[int], tuple[int, int]] = {}
        for f, corners in enumerate(self.surface.corners.tolist()):
            for i, a in enumerate(corners):
                edge = frozenset((a, corners[(i + 1) % len(corners)]))
                # An edge waits for the other facet that has it; to the rim none comes.
                if edge in waiting:
                    g, k = waiting.pop(edge)
                    beside[f, i], beside[g, k] = g, f
                else:
                    waiting[edge] = f, i
        return beside

    @cached_property
    def facet_normals(self) -> Array:
        """Unit normals of the facets, by their corners (n_facets, 3)."""
        x = self.surface.X[self.surface.corners]
        # By the diagonals, for the corners of a quadrilateral need not lie in a plane.
        a, b = x[:, 2] - x[:, 0], x[:, -1] - x[:, 1]
        if x.shape[1] == 3:
            a, b = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
        normals = np.cross(a, b)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        return normals

    @cached_property
    def turned(self) -> list[list[int]]:
        """For each corner of each facet those around it that turn by less than a feature angle."""
        normals, limit = self.facet_normals, math.cos(FEATURE_ANGLE)
        lists: list[list[int]] = []
        for f, rows in enumerate(self.rows_of_facets.tolist()):
            for i in rows:
                # A flat target keeps its edges: its corners have the normals of their facets.
                around = [g for g, _ in self.around[i]] if self.smooth else [f]
                lists.append([g for g in around if normals[f] @ normals[g] > limit])
            # Four lists of each facet, so that compiled code finds them by the number of the facet.
            lists += [[] for _ in range(MOST_CORNERS - len(rows))]
        return lists

    @cached_property
    def rises(self) -> Array:
        """Heights of the arcs behind the corners of facets above their chords (n_facets, 4) [m].

        An arc is normal to the mean normals n, m of its ends, which are d apart: with c = n . m

            x(t) = x_1 + (d - k) t + k t^2,   k = (n (n.d + c m.d) - m (m.d + c n.d)) / (1 - c^2)

        so that its middle is k/4 off the chord. Source: T. Nagata, Simple local interpolation of
        surfaces using normal vectors, Computer Aided Geometric Design 22 (2005) 327-347.
        """
        corners, normals = self.surface.corners, self.facet_normals
        rises = np.zeros((len(corners), MOST_CORNERS))
        n_corners = corners.shape[1]
        for f, own in enumerate(corners.tolist()):
            lists = self.turned[MOST_CORNERS * f : MOST_CORNERS * f + n_corners]
            means = [normals[around].sum(axis=0) for around in lists]
            means = [mean / np.linalg.norm(mean) for mean in means]
            for i in range(n_corners):
                n, m = means[i], means[(i + 1) % n_corners]
                d = self.surface.X[own[(i + 1) % n_corners]] - self.surface.X[own[i]]
                c = float(n @ m)
                # Between parallel normals the arc is its chord, and k is 0 / 0.
                if 1.0 - c * c > NEGLIGIBLE_SINE_SQUARED:
                    k = n * (n @ d + c * (m @ d)) - m * (m @ d + c * (n @ d))
                    middle = (n + m) / np.linalg.norm(n + m)
                    rises[f, i] = -0.25 * float(k @ middle) / (1.0 - c * c)
        return rises

    @cached_property
    def center(self) -> Array:
        return sphere_around(self.surface.X)[:3]

    @property
    def radius(self) -> float:
        return float(sphere_around(self.surface.X)[3])

    @cached_property
    def balls(self) -> Array:
        """Centers and radii of spheres (n, 4) that together have all facets, each with some.

        The largest is divided in the middle, again and again: feet get spheres of their own.
        """
        x = self.surface.X[self.surface.facets]
        middles = x.mean(axis=1)
        groups = [np.arange(len(x))]
        while len(groups) < MOST_BALLS:
            radii = [sphere_around(x[group].reshape(-1, 3))[3] for group in groups]
            largest = groups.pop(int(np.argmax(radii)))
            low, high = middles[largest].min(axis=0), middles[largest].max(axis=0)
            axis = int(np.argmax(high - low))
            upper = middles[largest, axis] > 0.5 * (low + high)[axis]
            if not upper.any():
                groups.append(largest)
                break
            groups += [largest[~upper], largest[upper]]
        return np.array([sphere_around(x[group].reshape(-1, 3)) for group in groups])


def sphere_around(X: Array) -> Array:
    """Center and radius (4,) of a sphere around points (n, 3)."""
    # Of the box: a mean would lie where the mesh is fine.
    center = 0.5 * (X.min(axis=0) + X.max(axis=0))
    return np.append(center, np.linalg.norm(X - center, axis=1).max())


def lay_out_patches(patches: Sequence[Patch]) -> Patches:
    """The nodes, rows and points of all patches."""
    node, row = node_starts(patches), starts(len(patch.corners) for patch in patches)
    supports = [
        first + nodes
        for patch, first in zip(patches, node.tolist(), strict=False)
        for nodes in patch.supports
    ]
    facet = starts(len(patch.surface.facets) for patch in patches).tolist()
    around = [
        (first + f, corner)
        for patch, first in zip(patches, facet, strict=False)
        for facets in patch.around
        for f, corner in facets
    ]
    slots = [
        np.searchsorted(nodes, patch.surface.facets[f])
        for patch in patches
        for facets, nodes in zip(patch.around, patch.supports, strict=True)
        for f, _ in facets
    ]
    # Facets of a type have the same functions at their points, but dual ones of their own.
    tile = [len(patch.surface.facets) for patch in patches]
    return Patches(
        body=as_index([patch.body for patch in patches]),
        owner=as_index([patch.owner for patch in patches]),
        node=node,
        row=row,
        point=starts(patch.n_points for patch in patches),
        center=as_rows([patch.center for patch in patches]),
        radius=np.array([patch.radius for patch in patches], dtype=np.float64),
        ball_range=starts(len(patch.balls) for patch in patches),
        ball=np.concatenate([np.empty((0, 4)), *(patch.balls for patch in patches)]),
        X=np.concatenate([np.empty((0, 3)), *(patch.surface.X for patch in patches)]),
        area=joined(patch.areas for patch in patches),
        weight=joined(patch.weights.ravel() for patch in patches),
        N=in_one_table(
            [np.tile(p.rule.functions, (n, 1)) for p, n in zip(patches, tile, strict=True)],
            MOST_NODES,
        ),
        corner=in_one_table(
            [np.tile(p.rule.corner_functions, (n, 1)) for p, n in zip(patches, tile, strict=True)],
            MOST_CORNERS,
        ),
        dual=in_one_table(
            [patch.dual.reshape(patch.n_points, -1) for patch in patches], MOST_CORNERS
        ),
        around_range=starts(len(facets) for patch in patches for facets in patch.around),
        around=as_index(around).reshape(-1, 2),
        slot=in_one_table([own[None] for own in slots], MOST_NODES, np.int64),
        support_range=starts(map(len, supports)),
        support=as_index([k for nodes in supports for k in nodes]),
    )


def lay_out_facets(patches: Sequence[Patch]) -> Facets:
    """The facets of all patches."""
    node, row = node_starts(patches), starts(len(patch.corners) for patch in patches)
    facet = starts(len(patch.surface.facets) for patch in patches)
    turned = [
        [first + f for f in own]
        for patch, first in zip(patches, facet.tolist(), strict=False)
        for own in patch.turned
    ]
    kinds = [patch.surface.facet_type for patch in patches]
    # Arcs of edges need middle nodes, which linear facets do not have in the mesh.
    shaped = [
        SMOOTH_TYPES.get(kind, kind) if patch.smooth else kind
        for patch, kind in zip(patches, kinds, strict=True)
    ]
    return Facets(
        range=facet,
        kind=as_index([NUMBERED_FACETS.index(kind) for kind in kinds]),
        shaped=as_index([NUMBERED_FACETS.index(kind) for kind in shaped]),
        corners=as_index([patch.rule.n_corners for patch in patches]),
        n_nodes=as_index([patch.rule.n_nodes for patch in patches]),
        points=as_index([len(patch.rule.weights) for patch in patches]),
        nodes=in_one_table(
            [n + p.surface.facets for p, n in zip(patches, node.tolist(), strict=False)],
            MOST_NODES,
            np.int64,
        ),
        rows=in_one_table(
            [n + p.rows_of_facets for p, n in zip(patches, row.tolist(), strict=False)],
            MOST_CORNERS,
            np.int64,
        ),
        beside=in_one_table(
            [
                np.where(patch.beside < 0, -1, first + patch.beside)
                for patch, first in zip(patches, facet.tolist(), strict=False)
            ],
            MOST_CORNERS,
            np.int64,
        ),
        rise=in_one_table([patch.rises for patch in patches], MOST_CORNERS),
        around_range=starts(map(len, turned)),
        around=as_index([f for own in turned for f in own]),
    )


def node_starts(patches: Sequence[Patch]) -> Index:
    """The first node of each patch, and the number of all."""
    return starts(patch.surface.n for patch in patches)


def joined(arrays: Iterable[Array]) -> Array:
    # NumPy joins no empty list, which a model without surfaces has.
    return np.concatenate([np.empty(0), *arrays])


def in_one_table(tables: Sequence[Any], columns: int, kind: Any = np.float64) -> Any:
    """Tables one below the other, with so many columns: what lacks is 0, or -1 of integers."""
    fill = -1 if kind is np.int64 else 0
    wide = [np.full((len(table), columns), fill, dtype=kind) for table in tables]
    for table, own in zip(tables, wide, strict=True):
        own[:, : table.shape[1]] = table
    return np.concatenate([np.empty((0, columns), dtype=kind), *wide])
