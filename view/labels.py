"""The heights of labels beside a picture."""

import numpy as np

from ..superelement.validation import Array


def apart(heights: Array, distance: float, limit: float) -> Array:
    """Heights (n,) in [-limit, limit] near the given ones, `distance` apart, in the same order.

    Less apart if they do not fit. Of all such heights these are the nearest to the given ones, in
    the sense of least squares: those that are too close move as one block to their mean (pool
    adjacent violators).
    """
    order = np.argsort(heights, kind="stable")
    distance = min(distance, 2.0 * limit / max(len(heights) - 1, 1))
    steps = distance * (np.arange(len(heights)) - 0.5 * (len(heights) - 1))
    blocks: list[list[float]] = []  # mean and size of blocks that rise
    for height in (heights[order] - steps).tolist():
        blocks.append([height, 1])
        while len(blocks) > 1 and blocks[-2][0] >= blocks[-1][0]:
            mean, size = blocks.pop()
            blocks[-1] = [
                (blocks[-1][0] * blocks[-1][1] + mean * size) / (blocks[-1][1] + size),
                blocks[-1][1] + size,
            ]
    rising = np.repeat([mean for mean, _ in blocks], [int(size) for _, size in blocks])
    reach = limit - 0.5 * distance * (len(heights) - 1)
    fitted = np.empty(len(heights))
    fitted[order] = np.clip(rising, -reach, reach) + steps
    return fitted
