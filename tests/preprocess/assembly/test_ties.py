"""Matrices on the dofs that rigid frames leave, made in pieces, against the products T^T A T."""

import numpy as np
import pytest
from duhamel.preprocess.assembly.interfaces import attachments
from duhamel.preprocess.assembly.ties import reduced, tie
from duhamel.preprocess.sources.reading import read_source

BOTH = {name: {"group": name, "kind": "rigid"} for name in ("root", "tip")}


def assert_reduced(body):
    source = read_source(body)
    frames = attachments("interfaces", body.interfaces, source)
    left, T, _ = tie(source.nodes, frames)
    n_tied = 6 * sum(frame.rigid for frame in frames.values())
    assert n_tied
    for matrix in source.matrices():
        found = reduced(matrix, T, n_tied)
        expected = T.T @ matrix @ T
        assert found.shape == expected.shape == (left.n_dofs,) * 2
        assert found.format == "csc"
        assert found.has_canonical_format
        assert (found != found.T).nnz == 0
        assert found.indices.dtype == np.int32
        assert abs(found - expected).max() < 1e-14 * abs(expected).max()


@pytest.mark.parametrize("interfaces", [BOTH, BOTH | {"tip": {"group": "tip"}}])
def test_nodes_of_solids_follow_frames(solid_body, box, kind, interfaces):
    assert_reduced(solid_body(box(kind, divisions=(3, 2, 2)), interfaces=interfaces))


def test_nodes_with_rotations_follow_frames(beam_body, lines, section):
    """Dofs of free nodes before, between and behind those that are tied."""
    points = np.random.default_rng(0).normal(size=(9, 3))
    points[[2, 4, 7]] += 10.0
    rigid = {"hub": {"box": {"corners": [[5, 5, 5], [15, 15, 15]]}, "kind": "rigid"}}
    assert_reduced(beam_body(lines(points), section, interfaces=rigid))
