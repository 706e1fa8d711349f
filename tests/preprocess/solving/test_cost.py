"""The fitted cost of factorizations against what the analysis of rslab plans, and how it grows."""

import numpy as np
import pytest
import rslab
from duhamel.preprocess import assemble
from duhamel.preprocess.solving.cost import factor_cost, factorization_cost, krylov_cost


@pytest.mark.parametrize(
    ("kind", "n"), [("tetra", 14), ("tetra10", 7), ("hexahedron20", 8), ("hexahedron27", 7)]
)
def test_bytes_of_cubes(solid_body, box, kind, n):
    K = assemble(solid_body(box(kind, divisions=(n, n, n)))).K
    planned = rslab.analyze(K, path="ldlt", threads=1).memory_plan(nrhs=12)["peak_bytes"]
    assert 0.9 < factorization_cost(K.shape[0], K.nnz).bytes / planned < 1.35


def test_slender_bodies_take_less(solid_body, box):
    K = assemble(solid_body(box("tetra10", divisions=(40, 3, 3)))).K
    planned = rslab.analyze(K, path="ldlt", threads=1).memory_plan(nrhs=12)["peak_bytes"]
    assert planned < factorization_cost(K.shape[0], K.nnz).bytes


def test_growth(monkeypatch):
    """Time with the square of the unknowns, memory with their power 4/3, of meshes with as many
    entries in a row.
    """
    monkeypatch.setattr("duhamel.preprocess.solving.cost.threads", lambda: 2)
    sizes = np.array([1e7, 1e8])
    costs = [factorization_cost(int(n), int(80 * n)) for n in sizes]
    assert np.log10(costs[1].seconds / costs[0].seconds) == pytest.approx(2.0, abs=0.01)
    assert np.log10(costs[1].bytes / costs[0].bytes) == pytest.approx(4.0 / 3.0, abs=0.12)


def test_a_build_is_more_than_its_parts_and_grows_with_each():
    n, nnz = 100_000, 8_000_000

    def cost(n, nnz, n_c, steps, blocks):
        return krylov_cost(n, nnz, n_c, steps, factor_cost(n, nnz, n_c, blocks), blocks)

    least = cost(n, nnz, 12, 1000, 30)
    assert least.bytes > factorization_cost(n, nnz).bytes + 8 * n * 12 * 30
    assert least.seconds > factorization_cost(n, nnz).seconds
    for more in ((2 * n, 2 * nnz, 12, 1000, 30), (n, nnz, 24, 1000, 30), (n, nnz, 12, 1000, 60)):
        dearer = cost(*more)
        assert (dearer.seconds > least.seconds, dearer.bytes > least.bytes) == (True, True)
    assert cost(n, nnz, 12, 100_000, 30).bytes > least.bytes
