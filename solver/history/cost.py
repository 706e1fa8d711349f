"""Cost per step of each form of the history of a flexible body, and the cheapest form.

The constants are nanoseconds, fitted to what `benchmarks/history.py` prints; their ratios matter,
which machines share.
"""

import math

from .dyadic import DIRECT_STEPS

MODE_COST = 2.8
"""free and forced response of a mode in one step"""
CHAIN_COST = 1.3
"""a Maxwell element beside a mode"""
TERM_COST = 0.11
"""a term of a sum over modes"""
PRODUCT_COST = 0.2
"""a multiplication and addition in the time loop"""
SAMPLE_COST = 0.1
"""one of a matrix product, which makes a kernel from modes"""
UPDATE_COST = 2e5
"""an update of the convolution in blocks, whatever its size, and the return to the loop"""
TRANSFORM_COST = 1.2
"""a number in a Fourier transform, per doubling"""
SPECTRUM_COST = 2.0
"""a number of a spectrum times loads"""


def cheapest_history(
    n_c: int, n_active: int, m: int | None, n_steps: int, lags: int, elements: int = 0
) -> str:
    """The form of history that costs the least, by `history_costs`."""
    costs = history_costs(n_c, n_active, m, n_steps, lags, elements)
    return min(costs, key=lambda history: costs[history])


def history_costs(
    n_c: int, n_active: int, m: int | None, n_steps: int, lags: int, elements: int = 0
) -> dict[str, float]:
    """Nanoseconds per step of "direct", "fft" and, with modes, "recursive" history.

    n_c: interface dofs, of which n_active are loaded; m: modes (None: no modes); lags: of the
    kernels, which are sampled from the modes if there are any; elements: of the chain of the modes.
    """
    n_steps = max(n_steps, 1)  # a model that only starts
    sampling = 0.0 if m is None else SAMPLE_COST * m * n_c**2 * min(lags, n_steps) / n_steps
    costs = {
        "direct": sampling + PRODUCT_COST * n_c * n_active * _mean_reach(n_steps, lags),
        "fft": sampling + _block_cost(n_c, n_active, n_steps, lags),
    }
    if m is not None:
        costs["recursive"] = m * (MODE_COST + CHAIN_COST * elements + TERM_COST * (n_c + n_active))
    return costs


def _mean_reach(n_steps: int, lags: int) -> float:
    """Mean number of past loads in the sum of a step."""
    if lags >= n_steps:
        return 0.5 * n_steps
    # The sum grows to `lags` terms, then stays; the mean over the run.
    return lags * (1.0 - 0.5 * lags / n_steps)


def _block_cost(n_c: int, n_active: int, n_steps: int, lags: int) -> float:
    levels = max(math.ceil(math.log2(min(lags, n_steps) / DIRECT_STEPS)), 0) + 1
    doublings = math.log2(DIRECT_STEPS) + 0.5 * levels
    # a level is updated half as often as the one below, and is twice as long
    transforms = TRANSFORM_COST * levels * (n_c + n_active) * doublings
    spectra = (
        2.0
        * TRANSFORM_COST
        * n_c
        * n_active
        * min(lags / n_steps, 1.0)
        * (doublings + 0.5 * levels)
    )
    return (
        UPDATE_COST / DIRECT_STEPS
        + PRODUCT_COST * n_c * n_active * 0.5 * DIRECT_STEPS
        + transforms
        + spectra
        + SPECTRUM_COST * levels * n_c * n_active
    )
