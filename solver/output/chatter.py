"""Inputs that go up and down at every step, as by a controller whose gains are too large."""

import numpy as np

from ..arrays import Array

# White noise does not swing so fast by chance for `ENOUGH_STEPS` steps.
MIN_SWING_STEPS = 2
ENOUGH_STEPS = 128
# of the largest value of an input
NEGLIGIBLE_SWING = 1e-6


def chatters(values: Array, within: int = MIN_SWING_STEPS) -> bool:
    """Whether an input (n,) keeps going up and down within so many steps, or sooner."""
    changes = np.diff(values)
    moving = np.flatnonzero(changes)
    # Steps without a change are passed over: held inputs chatter too.
    turns = moving[1:][np.diff(np.sign(changes[moving])) != 0.0]
    if not len(turns) or np.diff(turns).max(initial=0) > within:
        return False
    # It must chatter from the beginning of the window to its end.
    if max(turns[0], len(changes) - turns[-1]) > 2 * within:
        return False
    sizes = np.abs(changes)
    first, last = sizes[: len(sizes) // 4].max(), sizes[-len(sizes) // 4 :].max()
    return bool(last > max(0.5 * first, NEGLIGIBLE_SWING * np.abs(values).max()))
