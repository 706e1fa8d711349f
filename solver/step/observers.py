"""Joint coordinates that are only observed; angles are continued over full turns."""

from ..arrays import Array
from ..compiler.marks import compiled, entry
from .frames import pull_back_pair
from .rows import evaluate_row
from .system import Rows, State, System, Workspace


@compiled
def follow_coordinates(observers: Rows, state: State, work: Workspace) -> None:
    """Coordinates of a step that is not recorded, from which the next ones are continued."""
    values, gradient = state.observers.value, work.observers.gradient
    for i in range(len(observers.kind)):
        values[i] = evaluate_row(observers, i, 0.0, values[i], work, gradient)


@compiled
def observe(observers: Rows, state: State, work: Workspace, values: Array, rates: Array) -> None:
    """Coordinates and their rates."""
    gradient, V = work.observers.gradient, work.frames.V
    for i in range(len(observers.kind)):
        f, g = observers.frame_a[i], observers.frame_b[i]
        values[i] = evaluate_row(observers, i, 0.0, state.observers.value[i], work, gradient)
        state.observers.value[i] = values[i]
        rates[i] = 0.0
        for k in range(6):
            rates[i] += gradient[k] * V[f, k] + gradient[6 + k] * V[g, k]


@entry
def linearize_observers(system: System, state: State, work: Workspace) -> None:
    """Coordinates nearest to those of the last step, and their derivatives B."""
    observers, out = system.observers, work.observers
    for i in range(len(observers.kind)):
        f, g = observers.frame_a[i], observers.frame_b[i]
        near = state.observers.value[i]
        out.value[i] = evaluate_row(observers, i, 0.0, near, work, out.gradient)
        pull_back_pair(system.frames, (f, g), out.gradient, state, work, out.B[i])
