"""The choice of the history: by what it costs, wherever that leads."""

import pytest
from duhamel.solver.history.cost import cheapest_history, history_costs


@pytest.mark.parametrize("n_c", [6, 24])
def test_modes_carry_long_runs_and_many_lags_go_by_blocks(n_c):
    assert cheapest_history(n_c, n_c, 400, 100_000, 100_001) == "recursive"
    assert cheapest_history(n_c, n_c, None, 100_000, 100_001) == "fft"
    assert cheapest_history(n_c, n_c, None, 100, 101) == "direct"


def test_a_short_memory_is_cheaper_than_many_modes():
    assert cheapest_history(6, 6, 3000, 100_000, 200) == "direct"


def test_costs_of_long_runs_grow_as_said():
    """recursive not at all, direct in proportion, fft by the square of a logarithm."""
    short, long = (history_costs(6, 6, 60, n, n + 1) for n in (10_000, 160_000))
    assert long["recursive"] == short["recursive"]
    assert long["direct"] / short["direct"] == pytest.approx(16.0, rel=0.02)
    assert 1.0 < long["fft"] / short["fft"] < (17.3 / 13.3) ** 2


def test_a_model_that_only_starts_has_a_history():
    assert cheapest_history(12, 6, 60, 0, 1) == "recursive"
    assert cheapest_history(12, 6, None, 0, 1) == "direct"
