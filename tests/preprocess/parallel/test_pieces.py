"""The pieces of a body, put together again: needs no MPI."""

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess import MethodError, assemble, read_body
from duhamel.preprocess.assembly.channels import selected_channels
from duhamel.preprocess.assembly.structure import attach
from duhamel.preprocess.parallel.pieces import numbered, pieces
from duhamel.preprocess.sources.reading import read_source


def dealt(body, size):
    """The numbering and the pieces of a body whose elements are dealt out along x."""
    source = read_source(body)
    attached = attach(body, source)
    channels = selected_channels(body, source, attached.T)
    x = np.concatenate(
        [source.mesh.points[cells].mean(axis=1)[:, 0] for cells in source.mesh.elements.values()]
    )
    parts = np.minimum((size * (x - x.min()) / np.ptp(x)).astype(int), size - 1)
    numbering = numbered(source, attached, channels, parts, size)
    return numbering, list(pieces(source, numbering))


@pytest.fixture(scope="module")
def body(bar):
    return read_body(bar())


@pytest.mark.parametrize("size", [1, 2, 3])
def test_rows_of_all_pieces_are_those_of_the_whole(body, size):
    structure = assemble(body)
    numbering, found = dealt(body, size)
    # Where an unknown of the whole is in the numbering of the pieces, by the frames and points.
    left, right = structure.nodes, numbering.attached.nodes
    order = np.lexsort(left.points.T)[np.argsort(np.lexsort(right.points.T))]
    np.testing.assert_array_equal(left.points[order], right.points)
    np.testing.assert_array_equal(left.rotations[order], right.rotations)
    counts = np.where(left.rotations, 6, 3)
    dofs = np.concatenate([left.first[node] + np.arange(counts[node]) for node in order])

    def joined(matrix_of):
        return sp.vstack([matrix_of(piece) for piece in found]).toarray()

    K = structure.K.toarray()[np.ix_(dofs, dofs)]
    M = structure.M.toarray()[np.ix_(dofs, dofs)]
    own_K = joined(lambda piece: piece.rows(piece.source.sums()[0]))
    own_M = joined(lambda piece: piece.rows(piece.source.sums()[1]) + piece.lumped)
    np.testing.assert_allclose(own_K, K, rtol=0, atol=1e-14 * np.abs(K).max())
    np.testing.assert_allclose(own_M, M, rtol=0, atol=1e-14 * np.abs(M).max())
    P_C = sp.hstack([piece.P_C for piece in found]).toarray()
    np.testing.assert_array_equal(P_C, structure.P_C.toarray()[:, dofs])


def test_each_unknown_belongs_to_one_piece(body):
    numbering, found = dealt(body, 3)
    assert [piece.own.start for piece in found] == numbering.starts[:-1].tolist()
    assert found[-1].own.stop == numbering.starts[-1] == found[0].n_u
    assert all(len(piece.own) == piece.nodes.n_dofs > 0 for piece in found)


def test_more_pieces_than_there_is_work_for_are_refused(body):
    """Here along x, where some hundreds have no element, or none with a node of their own."""
    with pytest.raises(MethodError, match=r"144 elements are too few for 300 processes: use fewer"):
        dealt(body, 300)


def test_a_piece_has_few_elements_beside_its_own(body):
    whole = read_source(body).mesh.n_elements
    _, found = dealt(body, 3)
    assert sum(piece.source.mesh.n_elements for piece in found) < 2 * whole
    assert max(piece.source.mesh.n_elements for piece in found) < whole


def test_elements_of_a_piece_keep_their_material(body):
    source = read_source(body)
    mesh, owners = source.mesh, source.materials.owners
    of_point = {
        tuple(point): owner
        for point, owner in zip(
            mesh.points[mesh.cells["tetra10"]].mean(axis=1), owners, strict=True
        )
    }
    _, found = dealt(body, 3)
    for piece in found:
        part = piece.source.mesh
        middles = part.points[part.cells["tetra10"]].mean(axis=1)
        expected = [of_point[tuple(middle)] for middle in middles]
        np.testing.assert_array_equal(piece.source.materials.owners, expected)
