"""Joint coordinates that are only observed; angles are continued over full turns."""

from ..compiler.marks import compiled, entry
from .frames import pull_back_pair
from .records.couplings import Rows
from .rows import evaluate_row, nearest_turn
from .system import State, System, Workspace


@compiled
def follow_coordinates(system: System, state: State, work: Workspace) -> None:
    """Coordinates at the end of a step and their rates.

    Angles are the nearest to what their mean rate over the step makes of the last ones.
    """
    observers, seen, half = system.observers, state.observers, 0.5 * system.scheme.h
    missed = state.extremes.missed
    for i in range(len(observers.kind)):
        before, rate_n = seen.value[i], seen.rate[i]
        _observe(observers, i, state, work)
        expected = before + half * (rate_n + seen.rate[i])
        seen.value[i] = nearest_turn(observers, i, seen.value[i], expected)
        missed[i] = max(missed[i], abs(seen.value[i] - expected))


@compiled
def start_coordinates(observers: Rows, state: State, work: Workspace) -> None:
    """Coordinates nearest to those that the state holds, and their rates."""
    for i in range(len(observers.kind)):
        _observe(observers, i, state, work)


@compiled
def _observe(observers: Rows, i: int, state: State, work: Workspace) -> None:
    gradient, V, seen = work.observers.gradient, work.frames.V, state.observers
    f, g = observers.frame_a[i], observers.frame_b[i]
    seen.value[i] = evaluate_row(observers, i, 0.0, seen.value[i], work, gradient)
    rate = 0.0
    for k in range(6):
        rate += gradient[k] * V[f, k] + gradient[6 + k] * V[g, k]
    seen.rate[i] = rate


@entry
def linearize_observers(system: System, state: State, work: Workspace) -> None:
    """Coordinates nearest to those of the last step, and their derivatives B."""
    observers, out = system.observers, work.observers
    for i in range(len(observers.kind)):
        f, g = observers.frame_a[i], observers.frame_b[i]
        near = state.observers.value[i]
        out.value[i] = evaluate_row(observers, i, 0.0, near, work, out.gradient)
        pull_back_pair(system.frames, (f, g), out.gradient, state, work, out.B[i])
