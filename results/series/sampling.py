"""Time series at equal steps, which filters and spectra need."""

from dataclasses import dataclass

import numpy as np

from ...files.arrays import Array
from ..errors import SeriesError

# Files have times as numbers of a few digits, so steps that are equal differ by rounding.
RELATIVE_STEP_ROUNDING = 1e-4
# 160 MB a series; a single short step among long ones would ask for any number.
MAX_RESAMPLED_SAMPLES = 20_000_000


@dataclass(frozen=True, eq=False)
class Sampled:
    """A series at equal steps, see `sampled` for an example.

    Parameters
    ----------
    time : (n,) [s]
    values : (n,) or (n, k)
    coarsest : float [s]
        The longest step before the series was resampled, or the step.
    """

    time: Array
    values: Array
    coarsest: float

    @property
    def step(self) -> float:
        """The time step [s]."""
        return float((self.time[-1] - self.time[0]) / (len(self.time) - 1))

    @property
    def rate(self) -> float:
        """Samples in a second [Hz]."""
        return 1.0 / self.step


def sampled(time: Array, values: Array) -> Sampled:
    """Bring a series to equal steps, where it has steps of two sizes.

    A shorter last step is left out with its sample. Steps that are multiples of the shortest one,
    as in a run with `contact_step`, are filled linearly. Every sample is kept, and for shock
    spectra, which assume a line from sample to sample, nothing changes.

    Parameters
    ----------
    time : (n,) [s]
    values : (n,) or (n, k)
        One series a column.

    Returns
    -------
    Sampled

    Raises
    ------
    SeriesError
        For steps of other ratios, times that do not increase, fewer than three samples, and values
        that are not finite.

    Examples
    --------
    >>> import numpy as np
    >>> series = sampled(np.array([0.0, 1.0, 2.0, 4.0]), np.array([0.0, 1.0, 2.0, 6.0]))
    >>> series.time.tolist(), series.values.tolist(), series.coarsest
    ([0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 2.0, 4.0, 6.0], 2.0)
    """
    time, values = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    _check(time, values)
    steps = np.diff(time)
    # Runs end at t_end, which is rarely a multiple of the step.
    if len(steps) > 1 and steps[-1] < (1.0 - RELATIVE_STEP_ROUNDING) * steps[-2]:
        time, values, steps = time[:-1], values[:-1], steps[:-1]
    shortest, coarsest = float(steps.min()), float(steps.max())
    if coarsest <= (1.0 + RELATIVE_STEP_ROUNDING) * shortest:
        return Sampled(time, values, coarsest)
    return _filled(time, values, steps)


def _filled(time: Array, values: Array, steps: Array) -> Sampled:
    """Linear between the samples, at multiples of the shortest step."""
    shortest, coarsest = float(steps.min()), float(steps.max())
    # Positions are counted in whole shortest steps, so that rounding does not add up.
    ratios = np.round(steps / shortest)
    if np.abs(steps / shortest - ratios).max() > RELATIVE_STEP_ROUNDING * coarsest / shortest:
        raise SeriesError(
            f"expected equal time steps, or multiples of the shortest one, "
            f"found steps from {shortest:.6g} to {coarsest:.6g} s"
        )
    whole = np.concatenate([[0.0], np.cumsum(ratios)])
    if whole[-1] >= MAX_RESAMPLED_SAMPLES:
        raise SeriesError(
            f"steps from {shortest:.6g} to {coarsest:.6g} s: expected at most "
            f"{MAX_RESAMPLED_SAMPLES} samples "
            f"of the shortest one, found {whole[-1]:.6g}"
        )
    fine = np.arange(whole[-1] + 1.0)
    # np.interp takes one column at a time.
    columns = values.reshape(len(time), -1)
    filled = np.stack([np.interp(fine, whole, column) for column in columns.T], axis=1)
    return Sampled(
        time[0] + (time[-1] - time[0]) * fine / whole[-1],
        filled.reshape(len(fine), *values.shape[1:]),
        coarsest,
    )


def _check(time: Array, values: Array) -> None:
    if time.ndim != 1 or values.shape[:1] != time.shape or values.ndim > 2:
        raise SeriesError(
            f"expected time (n,) and values (n,) or (n, k), found {time.shape} and {values.shape}"
        )
    if len(time) < 3:
        raise SeriesError(f"expected a series of three or more samples, found {len(time)}")
    if not (np.isfinite(time).all() and np.isfinite(values).all()):
        raise SeriesError("expected numbers in a time series, found infinite ones or none")
    if (least := float(np.diff(time).min())) <= 0.0:
        raise SeriesError(f"expected times that increase, found a step of {least:.6g} s")
