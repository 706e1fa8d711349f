"""Dependent rows found body by body, beside singular values of the whole matrix."""

import numpy as np
import pytest
from duhamel.solver import (
    Frame,
    Model,
    Revolute,
    RigidBody,
    Settings,
    Start,
)
from duhamel.solver.start import dependence
from duhamel.solver.start.dependence import dependences, least_solution, rows_to_leave_out
from duhamel.solver.start.initial import initialize
from scipy.sparse import csr_array

TOLERANCE = 1e-9
Z = np.array([0.0, 0.0, 1.0])


def joints_of_chain(random, bodies, repeated):
    """Rows of unit length between bodies beside one another, some of which repeat what is there."""
    owners = np.repeat(np.arange(bodies), 6)
    J = np.zeros((4 * bodies, 6 * bodies))
    for k in range(bodies):
        beside = slice(max(0, 6 * k - 6), 6 * k + 6)
        J[4 * k : 4 * k + 4, beside] = random.standard_normal((4, beside.stop - beside.start))
    pairs = random.integers(0, len(J), (repeated, 2))
    repeats = [J[a] - 2.0 * J[b] for a, b in pairs.tolist()]
    J = np.vstack([J, *repeats, np.zeros(J.shape[1])])
    J = J[random.permutation(len(J))]
    length = np.linalg.norm(J, axis=1)
    return J / np.where(length > 0.0, length, 1.0)[:, None], owners


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("form", [np.asarray, csr_array])
def test_dependences_span_the_left_null_space(form, seed):
    random = np.random.default_rng(seed)
    J, owners = joints_of_chain(random, 1 + 2 * seed, 2 * seed)
    null = dependences(form(J), owners, TOLERANCE)
    left, values, _ = np.linalg.svd(J)
    exact = left[:, np.count_nonzero(values > TOLERANCE) :]
    assert null.shape == exact.shape
    np.testing.assert_allclose(null @ null.T, exact @ exact.T, rtol=0, atol=1e-10)
    kept = np.delete(J, rows_to_leave_out(null), axis=0)
    assert np.linalg.matrix_rank(kept, tol=TOLERANCE) == len(kept) == len(J) - null.shape[1]


@pytest.mark.parametrize("seed", range(6))
def test_the_least_solution_is_that_of_the_pseudo_inverse(seed):
    """Also where the right-hand side is out of reach."""
    random = np.random.default_rng(seed)
    A, owners = joints_of_chain(random, 1 + 2 * seed, 2 * seed)
    b = random.standard_normal(len(A))
    x = least_solution(csr_array(A), b, owners, TOLERANCE)
    np.testing.assert_allclose(x, np.linalg.pinv(A, rcond=TOLERANCE) @ b, rtol=0, atol=1e-8)


def bar(p, q):
    way = np.subtract(q, p)
    L, angle = np.linalg.norm(way), np.arctan2(way[1], way[0])
    frames = {"left": Frame([-L / 2, 0, 0]), "right": Frame([L / 2, 0, 0])}
    return RigidBody(
        1.0, L**2 * np.array([0.01, 0.08, 0.08]), frames, Start(p + way / 2, angle * Z)
    )


def four_bars_in_a_row(n):
    """Each shares a rocker on the ground with the next; the first pivots are not quite closed."""
    feet = [np.array([k, 0.0, 0.0]) for k in range(n + 1)]
    tips = [np.array([k + 0.3, 1.0 + 0.01 * (k % 7), 0.0]) for k in range(n + 1)]
    bodies = {f"rocker{k}": bar(*ends) for k, ends in enumerate(zip(feet, tips, strict=True))}
    bodies |= {f"coupler{k}": bar(tips[k], tips[k + 1] + 1e-5) for k in range(n)}
    joints = [Revolute(f"ground.{k}", f"rocker{k}.left", Z, name=f"foot{k}") for k in range(n + 1)]
    for k in range(n):
        coupler = f"coupler{k}"
        joints.append(Revolute(f"rocker{k}.right", f"{coupler}.left", Z, name=f"A{k}"))
        joints.append(Revolute(f"{coupler}.right", f"rocker{k + 1}.right", Z, name=f"B{k}"))
    return Model(
        bodies,
        joints,
        ground_frames={str(k): Frame(foot) for k, foot in enumerate(feet)},
        settings=Settings(t_end=0.01, step=1e-3, redundant="remove"),
    )


def test_a_row_of_four_bars_starts_by_matrices_of_a_few_bodies(monkeypatch):
    """One degree of freedom, three redundant constraints in each loop, and closed joints."""
    svd, largest = np.linalg.svd, [0]

    def watched(matrix, *arguments, **options):
        largest.append(max(matrix.shape[-2:]))
        return svd(matrix, *arguments, **options)

    monkeypatch.setattr(dependence.np.linalg, "svd", watched)
    start = initialize(four_bars_in_a_row(30))
    assert start.degrees_of_freedom == 1
    assert len(start.removed.rows) == 90
    hard = start.lowered.system.couplings.compliant == 0
    assert np.abs(start.work.couplings.phi[hard]).max() < 1e-12
    assert 0 < max(largest) < 60
