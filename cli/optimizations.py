"""Searches of a study as tables, JSON and a picture."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..study import OptimizedConstraint, Optimum
from ..view import GoalHistory, draw_optimization
from .tables import table

PARAMETER_COLUMNS = ("parameter", "start", "end", "")
GOAL_COLUMNS = ("", "start", "end", "limit", "multiplier")


def parameter_table(title: str, found: Optimum) -> Any:
    """The parameters before and after."""
    rows = [
        (one.name, f"{one.start:.6g}", f"{one.value:.8g}", "at a bound" if one.at_bound else "")
        for one in found.parameters
    ]
    return table(title, PARAMETER_COLUMNS, rows, "tnnt")


def goal_table(found: Optimum) -> Any:
    """The objective, what has limits, and the other outputs, before and after."""
    return table("", GOAL_COLUMNS, _goals(found), "tnntn")


def _goals(found: Optimum) -> Iterator[tuple[str, ...]]:
    goal = "maximize" if found.maximize else "minimize"
    numbers = _number(found.start, found.unit), _number(found.value, found.unit)
    yield f"{goal} {found.objective}", *numbers, "", ""
    for limited in found.constraints:
        yield (
            limited.output,
            *(_number(end, limited.unit) for end in (limited.start, limited.value)),
            f"{_limit(limited)}{', active' if limited.is_active else ''}",
            f"{limited.multiplier:.4g}" if limited.multiplier else "",
        )
    told = {found.objective, *(one.output for one in found.constraints)}
    for name, (start, end) in found.outputs.items():
        if name not in told:
            unit = found.units[name]
            yield name, _number(start, unit), _number(end, unit), "", ""


def _number(value: float, unit: str) -> str:
    return f"{value:.6g} {unit}".rstrip()


def _limit(one: OptimizedConstraint) -> str:
    if one.low == one.high:
        return f"= {one.low:.6g}"
    low = f"min {one.low:.6g}" if np.isfinite(one.low) else ""
    high = f"max {one.high:.6g}" if np.isfinite(one.high) else ""
    return ", ".join(part for part in (low, high) if part)


def optimum_picture(title: str, found: Optimum) -> Any:
    trials = found.trials
    objective = GoalHistory(
        found.objective, np.array([one.objective for one in trials]), found.unit
    )
    limited = [
        GoalHistory(
            one.output,
            np.array([trial.constraints[n] for trial in trials]),
            one.unit,
            one.low,
            one.high,
        )
        for n, one in enumerate(found.constraints)
    ]
    kept = np.array([one.is_feasible for one in trials])
    best = next(n for n, one in enumerate(trials) if one.values == found.values)
    return draw_optimization(objective, limited, kept, best, title)
