"""Symmetric sparse matrices from pieces of their rows, and the type of their indices."""

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess import sparse
from duhamel.preprocess.sparse import index_type, stacked

N = 30


@pytest.fixture(scope="module")
def symmetric():
    half = sp.random_array((N, N), density=0.1, rng=np.random.default_rng(0))
    return (half + half.T).tocsr()


def pieces(matrix):
    return (matrix[a:b] for a, b in ((0, 11), (11, 12), (12, N)))


def test_pieces_make_the_matrix(symmetric):
    found = stacked(pieces(symmetric), N, symmetric.nnz + 7)
    assert found.format == "csc"
    assert found.nnz == symmetric.nnz
    assert (found != symmetric).nnz == 0
    assert found.has_canonical_format


@pytest.mark.parametrize(("limit", "kind"), [(None, np.int32), (N, np.int64)])
def test_indices_are_as_long_as_the_entries_need(symmetric, monkeypatch, limit, kind):
    """A limit below the number of entries stands for more than 2^31 of them."""
    if limit is not None:
        monkeypatch.setattr(sparse, "LARGEST_INDEX", limit)
    found = stacked(pieces(symmetric), N, symmetric.nnz)
    assert found.indices.dtype == found.indptr.dtype == kind
    assert (found @ symmetric != symmetric @ symmetric).nnz == 0


def test_the_last_index_of_four_bytes():
    assert index_type(2**31 - 1) == np.int32
    assert index_type(2**31) == np.int64
