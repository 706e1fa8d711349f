"""Factorizations: every library against the matrix, what happens when one fails, and what does not
fit.
"""

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess import assemble, build
from duhamel.preprocess.errors import MemoryShortageError, MeshError, MethodError
from duhamel.preprocess.solving.factor import _cholmod, _rslab, _superlu, factorize
from duhamel.superelement import GeneralizedAlpha


@pytest.fixture(params=["beam", "askew beam", "solid in meters", "solid in millimeters"])
def structure(request, beam_body, beam, lines, solid_body, box):
    """Rotations beside displacements, on and off the axes, and solids whose numbers are small or
    large.
    """
    match request.param:
        case "beam":
            return assemble(beam_body(beam(100)))
        case "askew beam":
            return assemble(
                beam_body(lines(np.cumsum(np.random.default_rng(1).normal(size=(40, 3)), axis=0)))
            )
        case "solid in meters":
            return assemble(solid_body(box("tetra10", size=(0.4, 0.1, 0.1), divisions=(8, 2, 2))))
        case _:
            return assemble(
                solid_body(box("tetra10", size=(400.0, 100.0, 100.0), divisions=(8, 2, 2)))
            )


@pytest.fixture(params=["M", "K + M / h^2, fine", "K + M / h^2, coarse"])
def matrix(request, structure):
    """What the methods factorize."""
    steps = {"K + M / h^2, fine": 1e-7, "K + M / h^2, coarse": 1e-2}
    if request.param == "M":
        return structure.M
    return structure.K + GeneralizedAlpha(0.9).beta_prime(steps[request.param]) * structure.M


def backward_error(A, x, b):
    """The largest over all equations, relative to the size of the terms of each (Oettli and
    Prager).
    """
    return (np.abs(A @ x - b) / (np.abs(A) @ np.abs(x) + np.abs(b))).max()


def test_every_equation_is_solved_to_rounding(matrix):
    """In any units, for one right-hand side and for many, stored in either order."""
    factor = factorize(matrix, "A")
    assert (factor.backend, factor.passed_over, factor.summary) == ("rslab", (), "rslab")
    assert factor.residual < 1e-12
    B = np.random.default_rng(2).normal(size=(matrix.shape[0], 12))
    for b in (B[:, 0], B, np.asfortranarray(B), B[:, ::2]):
        x = factor(b)
        assert x.shape == b.shape
        assert backward_error(matrix, x, b) < 1e-12


@pytest.mark.parametrize("attempt", [_rslab, _cholmod, _superlu])
def test_every_library_solves(attempt, matrix):
    if attempt is _cholmod:
        pytest.importorskip("sksparse")
    B = np.random.default_rng(3).normal(size=(matrix.shape[0], 5))
    solve = attempt(matrix.tocsc(), "the matrix")
    for b in (B[:, 0], B):
        x = solve(b)
        assert x.shape == b.shape
        assert backward_error(matrix, x, b) < 1e-12


def without_cholmod(monkeypatch):
    monkeypatch.setattr("duhamel.preprocess.solving.factor.find_spec", lambda name: None)


class Singular:
    """An rslab whose factorization gives up."""

    def factor(self, A):
        raise RuntimeError("zero pivot in column 3")

    def memory_plan(self, nrhs):
        return {"peak_bytes": 1}


def test_superlu_steps_in_where_rslab_gives_up(monkeypatch):
    without_cholmod(monkeypatch)
    monkeypatch.setattr("rslab.analyze", lambda A, path, threads: Singular())
    factor = factorize(laplacian(50), "A")
    assert factor.backend == "superlu"
    assert factor.passed_over == ("rslab: zero pivot in column 3",)
    assert factor.summary == "superlu; not rslab: zero pivot in column 3"
    assert factor.residual < 1e-12


def test_inaccurate_solutions_are_found_and_passed_over(monkeypatch):
    """A relative error of 1e-6 in one unknown of fifty is enough."""
    without_cholmod(monkeypatch)

    def spoiled(A, name, beside):
        solve = _rslab(A, name)
        return lambda b: solve(b) * np.where(np.arange(len(b)) == 7, 1.0 + 1e-6, 1.0)

    monkeypatch.setattr("duhamel.preprocess.solving.factor._rslab", spoiled)
    factor = factorize(laplacian(50), "A")
    assert factor.backend == "superlu"
    assert "rslab: relative residual" in factor.passed_over[0]

    monkeypatch.setattr("duhamel.preprocess.solving.factor._superlu", spoiled)
    expected = (
        r"the stiffness \(50 unknowns\) could not be factorized: "
        r"rslab: relative residual .*; superlu: relative"
    )
    with pytest.raises(MethodError, match=expected):
        factorize(laplacian(50), "the stiffness")


def test_a_matrix_that_is_not_definite_is_refused_by_its_pivots():
    """Two negative eigenvalues; a solution would be accurate nonetheless."""
    A = laplacian(50).tolil()
    A[10, 10] = A[30, 30] = -1.0
    with pytest.raises(
        MeshError,
        match=r"the mass \(50 unknowns\): expected a positive definite matrix, found 2 neg",
    ):
        factorize(A, "the mass")


@pytest.mark.parametrize("attempt", [_rslab, _cholmod, _superlu])
def test_what_does_not_fit_is_refused_before_it_starts(attempt, monkeypatch):
    if attempt is _cholmod:
        pytest.importorskip("sksparse")
    monkeypatch.setattr("duhamel.preprocess.memory.available", lambda: 10_000)
    with pytest.raises(
        MemoryShortageError, match=r"factorization of K \(900 unknowns\) needs .* 1e-05 GB are"
    ) as error:
        attempt(grid(30).tocsc(), "K")
    assert error.value.needed > error.value.available == 10_000


@pytest.mark.parametrize(
    ("method", "matrix", "needs"),
    [
        ("march", "the matrix of the time step", "GB of memory, 6e-05"),
        (
            "krylov",
            "the matrix of a low shift",
            r"GB of memory and the Krylov basis 0.000345 GB, 6e-05",
        ),
    ],
)
def test_a_body_that_does_not_fit_is_refused(beam_body, beam, monkeypatch, method, matrix, needs):
    """The basis of 6 + 12 (20 + 8) vectors of 126 unknowns along with the factor."""
    monkeypatch.setattr("duhamel.preprocess.memory.available", lambda: 60_000)
    body = beam_body(beam(20), impulse={"step": 6e-5, "steps": 10, "method": method})
    message = (
        rf"factorization of {matrix} \(126 unknowns\) needs "
        rf"\S+ {needs} GB are available: use a"
    )
    with pytest.raises(MemoryShortageError, match=message):
        build(body)


def test_a_superelement_says_what_factorized_it(beam_body, beam, monkeypatch):
    march = {"step": 6e-5, "steps": 10, "method": "march"}
    assert build(beam_body(beam(5), impulse=march)).provenance.versions["factorization"] == "rslab"

    without_cholmod(monkeypatch)
    monkeypatch.setattr("rslab.analyze", lambda A, path, threads: Singular())
    summary = build(beam_body(beam(5), impulse=march)).provenance.versions["factorization"]
    assert summary == "superlu; not rslab: zero pivot in column 3"


def laplacian(n):
    return sp.diags_array([-1.0, 2.5, -1.0], offsets=[-1, 0, 1], shape=(n, n)).tocsc()


def grid(n):
    line, one = laplacian(n), sp.eye_array(n)
    return sp.kron(line, one) + sp.kron(one, line)
