"""Bodies that are none: several pieces, mechanisms."""

import meshio
import numpy as np
import pytest
from duhamel.preprocess import MeshError, assemble

CUBE = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    dtype=float,
)


def blocks(corners):
    """Unit cubes at the given corners that share the nodes where they touch; no groups."""
    per_cell = np.array(corners)[:, None, :] + CUBE
    points, cells = np.unique(per_cell.reshape(-1, 3), axis=0, return_inverse=True)
    return meshio.Mesh(points, [("hexahedron", cells.reshape(-1, 8))], cell_data={}, field_data={})


def body_of(solid_body, mesh):
    return solid_body(mesh, interfaces={"root": {"node": [0, 0, 0]}})


@pytest.mark.parametrize(
    ("corners", "motions", "joint"),
    [
        ([(0, 0, 0), (1, 1, 0)], 7, "hinge: one shared edge"),
        ([(0, 0, 0), (1, 1, 1)], 9, "ball: one shared corner"),
        ([(0, 0, 0), (1, 1, 0), (2, 2, 0)], 8, "two hinges in a row"),
        ([(0, 0, 0), (1, 1, 0), (1, 1, 1), (2, 2, 1)], 8, "two hinges with a pair between"),
    ],
)
def test_mechanisms(solid_body, corners, motions, joint):
    with pytest.raises(
        MeshError,
        match=f"mesh.msh: the body is a mechanism: it has {motions} motions .*, expected 6",
    ):
        assemble(body_of(solid_body, blocks(corners)))


def test_the_count_of_motions_is_that_of_zero_eigenvalues(solid_body, monkeypatch):
    """The same bodies with the check out of the way: K has as many zero eigenvalues."""
    monkeypatch.setattr(
        "duhamel.preprocess.sources.solids.check_no_mechanism", lambda mesh, facets: None
    )
    for corners, motions in (([(0, 0, 0), (1, 1, 0)], 7), ([(0, 0, 0), (1, 1, 1)], 9)):
        K = assemble(body_of(solid_body, blocks(corners))).K.toarray()
        assert np.linalg.matrix_rank(K, tol=1e-10 * K.max()) == len(K) - motions


def test_a_ring_of_hinges_is_stiff(solid_body):
    """Blocks that touch at edges and corners alone, yet cannot move: three edges along different
    axes.
    """
    corners = [(0, 0, 0), (1, 1, 0), (1, 0, 1), (0, 1, 1)]
    K = assemble(body_of(solid_body, blocks(corners))).K.toarray()
    assert np.linalg.matrix_rank(K, tol=1e-10 * K.max()) == len(K) - 6


def test_several_pieces(solid_body, beam_body, lines):
    with pytest.raises(
        MeshError, match=r"mesh.msh: expected one connected body, found 2 pieces of 2, 1 elements"
    ):
        assemble(body_of(solid_body, blocks([(0, 0, 0), (1, 0, 0), (5, 0, 0)])))
    # Two beams that end at the same place, but at a node each.
    points = [[0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0]]
    with pytest.raises(
        MeshError,
        match=r"found 2 pieces of 1, 1 elements, which hold the points .*\[1.0, 0.0, 0.0\]",
    ):
        assemble(beam_body(lines(points, [[0, 1], [2, 3]])))
