"""Matrices on the dofs that rigid frames leave, made in pieces, against the products T^T A T."""

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess.assembly.interfaces import Attachment, attachments
from duhamel.preprocess.assembly.ties import reduced, tie
from duhamel.preprocess.mesh.nodes import Nodes
from duhamel.preprocess.sources.reading import read_source

RIGID = {name: {"group": name, "kind": "rigid"} for name in ("root", "tip")}


def assert_reduced(nodes, frames, matrices):
    left, T, _ = tie(nodes, frames)
    n_tied = 6 * sum(frame.rigid for frame in frames.values())
    assert n_tied
    for matrix in matrices:
        found = reduced(matrix, T, n_tied)
        expected = T.T @ matrix @ T
        assert found.shape == expected.shape == (left.n_dofs,) * 2
        assert found.format == "csc"
        assert found.has_canonical_format
        assert (found != found.T).nnz == 0
        assert found.indices.dtype == np.int32
        assert abs(found - expected).max() < 1e-14 * abs(expected).max()


@pytest.mark.parametrize("interfaces", [RIGID, RIGID | {"tip": {"group": "tip"}}])
def test_nodes_of_solids_follow_frames(solid_body, box, kind, interfaces):
    body = solid_body(box(kind, divisions=(3, 2, 2)), interfaces=interfaces)
    source = read_source(body)
    frames = attachments("interfaces", body.interfaces, source)
    assert_reduced(source.nodes, frames, source.matrices())


def test_nodes_with_rotations_follow_frames_too():
    """Of nodes with and without, free ones stand before, between and behind those that are tied."""
    rng = np.random.default_rng(0)
    points = rng.normal(size=(9, 3))
    nodes = Nodes(points, np.arange(9) % 3 == 1)
    hub, rim = np.array([2, 4, 7]), np.array([1, 5])
    rows = sp.csr_array((6, nodes.n_dofs))
    frames = {
        "hub": Attachment(points[hub].mean(axis=0), rows, hub, rigid=True),
        "rim": Attachment(points[rim].mean(axis=0), rows, rim, rigid=True),
    }
    half = sp.random_array((nodes.n_dofs,) * 2, density=0.3, rng=rng)
    assert_reduced(nodes, frames, [(half + half.T).tocsc()])
