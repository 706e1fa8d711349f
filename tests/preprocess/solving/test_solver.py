"""The choice between a factor and conjugate gradients."""

import pytest
from duhamel.preprocess import BodyError, assemble, build
from duhamel.preprocess.errors import MemoryShortageError
from duhamel.preprocess.solving.cost import Cost, factor_cost, gradient_cost
from duhamel.preprocess.solving.solver import Costs, iterated
from duhamel.preprocess.survey import survey

LOTS = 1e12


@pytest.mark.parametrize(
    ("factor", "iterative", "room", "beside_basis", "chosen"),
    [
        ((100.0, 5e9), (10.0, 1e9), LOTS, LOTS, "iterative"),
        ((100.0, 5e9), (90.0, 1e9), LOTS, LOTS, "factor"),  # a body is no cube
        ((100.0, 5e9), (900.0, 1e9), 4e9, 4e9, "iterative"),
        ((100.0, 5e9), (900.0, 1e9), 6e9, 4e9, "iterative"),
        ((100.0, 5e9), (900.0, 6e9), 4e9, 4e9, "iterative"),  # refused in its own words
        ((100.0, 1e9), (10.0, 2e9), 1.5e9, 1.5e9, "factor"),
    ],
)
def test_the_quicker_one_that_there_is_room_for(factor, iterative, room, beside_basis, chosen):
    assert Costs(Cost(*factor), Cost(*iterative), room, beside_basis).cheaper == chosen


def test_small_steps_and_large_bodies_do_without_a_factor(monkeypatch):
    """At a million unknowns a factor needs 29 GB; at 100 thousand it is quicker for long steps."""
    monkeypatch.setattr("duhamel.preprocess.solving.cost.threads", lambda: 2)

    def costs(n, condition):
        sizes = n, 80 * n, 12
        return Costs(factor_cost(*sizes), gradient_cost(*sizes, condition, 1e-5), 24e9, 20e9)

    assert costs(1_000_000, 1e4).cheaper == "iterative"
    assert costs(100_000, 1e4).cheaper == "factor"
    assert costs(300_000, 4.0).cheaper == "iterative"


@pytest.mark.parametrize("solver", ["factor", "iterative"])
def test_a_body_says_which(solid_body, box, solver):
    impulse = {"step": 2e-5, "steps": 100, "method": "krylov", "solver": solver}
    body = solid_body(box("tetra10", (0.4, 0.1, 0.1), (8, 2, 2)), impulse=impulse)
    made = build(body).provenance.versions["factorization"]
    assert made.startswith({"factor": "rslab", "iterative": "conjugate gradients"}[solver])
    cost = survey(body).cost
    assert (cost.solver, cost.other) in {("factor", "iterative"), ("iterative", "factor")}
    assert cost.solver == solver


def test_a_solver_belongs_to_krylov(solid_body, box):
    impulse = {"step": 1e-5, "steps": 100, "method": "modal", "solver": "factor"}
    with pytest.raises((BodyError, ValueError), match="solver: expected only with method krylov"):
        solid_body(box("tetra10"), impulse=impulse)


def test_too_little_memory_is_refused_before_anything_is_solved(solid_body, box, monkeypatch):
    structure = assemble(solid_body(box("tetra10")))
    monkeypatch.setattr("duhamel.preprocess.memory.available", lambda: 1e5)
    message = (
        r"solving with the matrix of the time step \(\d+ unknowns\) without a factor needs .* "
        r"of memory, 0.0001 GB are available: use a coarser mesh"
    )
    with pytest.raises(MemoryShortageError, match=message):
        iterated(structure, 1e10, "the matrix of the time step", 1e-5)
