"""Solutions without a factor beside those with one."""

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess import MethodError, assemble
from duhamel.preprocess.solving.aggregates import largest_block_eigenvalue, panel_multigrid
from duhamel.preprocess.solving.factor import factorize
from duhamel.preprocess.solving.gradients import Columns, Goal, converge
from duhamel.preprocess.solving.loops import PANEL_WIDTH
from duhamel.preprocess.solving.multigrid import Multigrid, largest_eigenvalue
from duhamel.preprocess.solving.panels import in_blocks
from duhamel.preprocess.solving.refined import RefinedGradients
from duhamel.preprocess.solving.solver import condition, factorized, iterated
from duhamel.superelement import GeneralizedAlpha
from scipy.sparse.linalg import eigsh

SCHEME = GeneralizedAlpha(0.9)


def energy(S, x):
    return np.sqrt(np.einsum("ik,ik->k", x, S @ x))


def error(structure, shift, solve, b):
    """The relative error of solutions in energy (k,)."""
    S = structure.K + shift * structure.M
    exact = factorize(S, "S")(b)
    return energy(S, solve(b) - exact) / energy(S, exact)


@pytest.fixture
def structure(solid_body, box, kind):
    return assemble(solid_body(box(kind, size=(0.4, 0.2, 0.1), divisions=(8, 4, 2))))


@pytest.mark.parametrize("h", [1e-6, 1e-5, 3e-4])
def test_solutions_are_as_accurate_as_is_asked_for(structure, h):
    """From steps that a few products solve to those that take multigrid."""
    shift = SCHEME.beta_prime(h)
    for accuracy in (1e-2, 1e-5, 1e-10):
        solve = iterated(structure, shift, "S", accuracy)
        assert (solve.multigrid is not None) == (h > 1e-4)
        assert error(structure, shift, solve, structure.loads).max() < accuracy


def test_multigrid_takes_few_steps_whatever_the_step(solid_body, box):
    structure = assemble(solid_body(box("tetra10", size=(0.4, 0.1, 0.1), divisions=(24, 6, 6))))
    steps = []
    for h in (1e-5, 1e-4, 1e-3):
        solve = iterated(structure, SCHEME.beta_prime(h), "S", 1e-5)
        if solve.multigrid is None:
            solve.multigrid = panel_multigrid(solve.blocks, structure.U)
        assert error(structure, SCHEME.beta_prime(h), solve, structure.loads).max() < 1e-5
        steps.append(solve.iterations[0])
    assert max(steps) < 30


def test_cycles_know_the_largest_eigenvalue(solid_body, box):
    """Of D^-1 S, D the blocks on its diagonal; with less of it cycles would not be positive."""
    structure = assemble(solid_body(box("tetra10", size=(0.4, 0.1, 0.1), divisions=(24, 6, 6))))
    shift = SCHEME.beta_prime(1e-5)
    S = sp.bsr_array(structure.K + shift * structure.M, blocksize=(3, 3))
    node = np.repeat(np.arange(len(S.indptr) - 1), np.diff(S.indptr))
    own = node == S.indices
    each = np.arange(own.sum() + 1)
    D, inverse = (
        sp.bsr_array((blocks, node[own], each), shape=S.shape)
        for blocks in (S.data[own], np.linalg.inv(S.data[own]))
    )
    (exact,) = eigsh(S, 1, D, Minv=inverse, return_eigenvectors=False)
    found = largest_block_eigenvalue(in_blocks(structure.K, structure.M, shift))
    assert 1.03 * exact <= found <= 1.06 * exact  # the margin is for harder meshes


def test_many_columns_and_none_of_them(solid_body, box):
    """Panels are filled up with zeros, which are solutions of themselves."""
    structure = assemble(solid_body(box("tetra10", divisions=(3, 3, 3))))
    shift = SCHEME.beta_prime(1e-5)
    solve = iterated(structure, shift, "S", 1e-6)
    b = np.random.default_rng(0).standard_normal((structure.n_u, PANEL_WIDTH + 5))
    b[:, 3] = 0.0
    exact = factorized(structure, shift, "S", 0.0)(b)
    np.testing.assert_allclose(solve(b), exact, atol=1e-5 * np.abs(exact).max())
    assert (solve(b)[:, 3] == 0.0).all()
    np.testing.assert_array_equal(solve(b[:, 1]), solve(b[:, 1:2])[:, 0])


@pytest.mark.parametrize("size", [1e-25, 1e25])
def test_units_do_not_matter(solid_body, box, size):
    """Single precision ends at 1e-38 and 1e38: loads and matrices are scaled before."""
    structure = assemble(solid_body(box("tetra10")))
    shift = SCHEME.beta_prime(1e-5)
    K, M = size * structure.K, size * structure.M
    solve = RefinedGradients("S", in_blocks(K, M, shift), lambda X: K @ X + shift * (M @ X), 1e-8)
    loads = structure.loads / size
    exact = factorized(structure, shift, "S", 0.0)(structure.loads) / size**2
    np.testing.assert_allclose(solve(loads), exact, atol=1e-6 * np.abs(exact).max())


@pytest.mark.parametrize("n", [20, 21, 22])
def test_unknowns_that_are_no_nodes(n):
    """A matrix of any size is filled up to blocks of three."""
    rng = np.random.default_rng(1)
    K, M = sp.random(n, n, 0.2, rng=rng), sp.diags_array(rng.uniform(1.0, 2.0, n)).tocsc()
    K = (K @ K.T).tocsc()
    solve = RefinedGradients("S", in_blocks(K, M, 3.0), lambda X: K @ X + 3.0 * (M @ X), 1e-11)
    b = rng.standard_normal((n, 2))
    np.testing.assert_allclose(solve(b), np.linalg.solve((K + 3.0 * M).toarray(), b), rtol=1e-8)


@pytest.mark.parametrize(
    ("thickness", "n", "refused"),
    [
        (1e-2, 4, ""),
        (1e-3, 4, ""),
        (1e-4, 4, r"digits of single precision are not enough: .* far too flat"),
        (1e-2, 10, ""),
        (1e-3, 10, r"1000 steps of conjugate gradients are not enough: .* far too flat"),
    ],
)
def test_flat_elements_are_solved_or_refused(solid_body, box, thickness, n, refused):
    """Single precision may miss the bending of flat elements: further solutions tell."""
    structure = assemble(solid_body(box("tetra10", (1.0, 1.0, thickness), (n, n, 1))))
    shift = SCHEME.beta_prime(1e-4)
    if not refused:
        solve = iterated(structure, shift, "S", 1e-5)
        assert error(structure, shift, solve, structure.loads).max() < 1e-5
        return
    with pytest.raises(MethodError, match=refused):
        iterated(structure, shift, "S", 1e-5)(structure.loads)


def test_multigrid_is_the_same_each_time(solid_body, box):
    """Whatever random numbers others have drawn, and they go on drawing theirs."""
    structure = assemble(solid_body(box("tetra10", size=(0.4, 0.1, 0.1), divisions=(16, 4, 4))))
    shift, found, drawn = SCHEME.beta_prime(1e-3), [], []
    for seed in (1, 2):
        np.random.seed(seed)  # noqa: NPY002
        found.append(iterated(structure, shift, "S", 1e-6)(structure.loads))
        drawn.append(np.random.random())  # noqa: NPY002
    np.testing.assert_array_equal(*found)
    expected = [np.random.RandomState(seed).random_sample() for seed in (1, 2)]
    np.testing.assert_array_equal(drawn, expected)


def test_an_indefinite_matrix_is_refused():
    """Not solved by zero."""
    S = sp.diags_array([1.0, 2.0, -1.0]).tocsc()
    solve = RefinedGradients("S", in_blocks(S, 0.0 * S, 0.0), lambda X: S @ X, 1e-5)
    with pytest.raises(MethodError, match=r"S \(3 unknowns\): .* not enough"):
        solve(np.array([0.0, 0.0, 1.0]))


def test_what_does_not_converge_is_refused(solid_body, box):
    structure = assemble(solid_body(box("tetra10")))
    solve = iterated(structure, SCHEME.beta_prime(1e-5), "the matrix of the time step", 1e-8)
    assert solve.max_steps == 1000
    solve.max_steps = 5
    with pytest.raises(MethodError, match=r"time step \(.* unknowns\): 5 steps of .*factor"):
        solve(structure.loads)


def test_the_condition_tells_the_steps(solid_body, box):
    structure = assemble(solid_body(box("tetra10", size=(0.2, 0.2, 0.2), divisions=(8, 8, 8))))
    for h in (3e-6, 1e-5, 3e-5):
        shift = SCHEME.beta_prime(h)
        solve = RefinedGradients(
            "S",
            in_blocks(structure.K, structure.M, shift),
            lambda X, s=shift: structure.K @ X + s * (structure.M @ X),
            1e-3,
        )
        solve(structure.loads)
        expected = 0.5 * np.sqrt(condition(structure, shift)) * np.log(2e3)
        assert 0.5 < expected / solve.iterations[0] < 2.0


def columns(S, inverse=None):
    return Columns(lambda P: S @ P, inverse or (lambda R: R / S.diagonal()[:, None]))


def test_columns_in_double_precision():
    """What processes of MPI and factors in single precision solve with."""
    rng = np.random.default_rng(2)
    S = sp.random(60, 60, 0.1, rng=rng)
    S = (S @ S.T + 0.1 * sp.eye_array(60)).tocsr()
    B = rng.standard_normal((60, 3)) * [1.0, 0.0, 1e-20]
    found = converge(columns(S), B.copy(), Goal("S", 60, 1e-9))
    exact = np.linalg.solve(S.toarray(), B)
    np.testing.assert_allclose(energy(S, found.X - exact), 0.0, atol=1e-9 * energy(S, exact)[0])
    np.testing.assert_allclose(found.energy, np.einsum("ik,ik->k", B, exact), rtol=1e-12)
    assert (found.left <= 1e-18 * found.energy).all()


def test_columns_of_an_indefinite_matrix_are_refused():
    S, b = np.diag([1.0, 2.0, -1.0]), np.eye(3)[:, 2:]
    with pytest.raises(MethodError, match="digits of double precision are not enough"):
        converge(columns(S, lambda R: 1.0 * R), b, Goal("S", 3, 1e-5))
    with pytest.raises(np.linalg.LinAlgError, match="not positive definite"):
        largest_eigenvalue(columns(S, lambda R: 1.0 * R), np.ones((3, 1)))


def test_a_cycle_of_two_levels_by_hand():
    """One sweep on both sides of an exact correction: I - T S is a product of projections."""
    S = (2.0 * np.eye(5) - np.eye(5, k=1) - np.eye(5, k=-1)) * 3.0
    P = np.array([[0.5, 0], [1, 0], [0.5, 0.5], [0, 1], [0, 0.5]])

    class ByHand:
        weights = (0.7,)

        def residual(self, R, Z, T):
            T[:] = R - S @ Z

        def relax(self, weight, R, Z):
            Z += weight * R / 6.0

        def restrict(self, T):
            return P.T @ T

        def prolong(self, correction, Z):
            Z += P @ correction

    def coarsest(R, Z):
        Z[:] = np.linalg.solve(P.T @ S @ P, R)

    T = np.empty((5, 5))
    Multigrid([ByHand()], coarsest)(np.eye(5), T)
    smooth = np.eye(5) - 0.7 / 6.0 * S
    corrected = np.eye(5) - P @ np.linalg.solve(P.T @ S @ P, P.T @ S)
    np.testing.assert_allclose(np.eye(5) - T @ S, smooth @ corrected @ smooth, atol=1e-14)
    np.testing.assert_allclose(T, T.T, atol=1e-15)
