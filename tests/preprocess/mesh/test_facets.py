"""Facets by keys of their nodes, against sets of them."""

import numpy as np
import pytest
from duhamel.preprocess.mesh import facets as module
from duhamel.preprocess.mesh.cells import FACET_TYPES, SOLID_TYPES
from duhamel.preprocess.mesh.facets import facets_of
from duhamel.preprocess.mesh.mesh import Mesh

from ..blocks import solid_cells


@pytest.fixture(params=[None, 10_000], ids=["keys of all nodes", "keys of keys"])
def largest(request, monkeypatch):
    """Keys as they are in small meshes, and in those whose nodes do not fit into one number."""
    if request.param is not None:
        monkeypatch.setattr(module, "MAX_ROW_KEY", request.param)


def shuffled(kind):
    grid, cells = solid_cells(kind, (3, 2, 2))
    numbers = np.random.default_rng(0).permutation(len(grid))
    points = np.empty(grid.shape)
    points[numbers] = grid
    return Mesh("box", points, {kind: numbers[cells]}, {}, (kind,))


def test_every_face_is_there_once(kind, largest):
    mesh = shuffled(kind)
    facets = facets_of(mesh)
    beside: dict[frozenset[int], list[int]] = {}
    for element, nodes in enumerate(mesh.cells[kind]):
        for facet, locals_ in SOLID_TYPES[kind].facets.items():
            for local in locals_:
                corners = nodes[local[: FACET_TYPES[facet].corners]]
                beside.setdefault(frozenset(corners.tolist()), []).append(element)
    found = [
        frozenset(row[: FACET_TYPES[facet].corners].tolist())
        for facet, rows in facets.nodes.items()
        for row in rows
    ]
    assert len(found) == len(beside)
    assert set(found) == set(beside)
    assert facets.boundary.tolist() == [len(beside[corners]) == 1 for corners in found]
    for element, sides in enumerate(facets.sides[kind]):
        assert all(element in beside[found[side]] for side in sides.tolist())


def test_facets_are_found_by_their_corners_in_any_order(kind, largest):
    facets = facets_of(shuffled(kind))
    rng = np.random.default_rng(1)
    for facet, rows in facets.nodes.items():
        corners = rows[::3, : FACET_TYPES[facet].corners]
        turned = rng.permuted(corners, axis=1)
        strange = turned[:1].copy()
        strange[0, 0] = turned.max() + 5
        found = facets.matching(facet, np.concatenate([turned, strange]))
        expected = facets.first[facet] + np.arange(0, len(rows), 3)
        assert found.tolist() == [*expected.tolist(), -1]
