"""Impulse responses over time as frequency responses.

    H = step sum_n response_n exp(-i omega n step)

Source: docs/theory.md, Frequency response tests.
"""

from pathlib import Path

import numpy as np

from ...files.arrays import Array, Complex
from ..errors import MeasurementError

LEAST_TIMES = 40
END_OF_RESPONSE, LARGEST_END = (0.7, 0.8, 0.9), 1e-2
"""parts of a response, and what the last of them may have of a line: a mode then has 1 % of its
vibration left, which leaks into other lines; the last tenth may be times before the hit"""
LEAST_PRODUCT = 1e-300
SAME_STEP = 1e-3
"""of a step, by which times may differ from even ones: files print six digits"""


def transformed(path: Path, response: Array, step: float) -> tuple[Array, Complex]:
    """f (k,) [Hz] and accelerances (k, n_o, n_i) [1/kg] of impulse responses (n, n_o, n_i).

    response [1/(kg s)] at 0, step, 2 step ... [s], the last tenth of which may be times before the
    hit. `MeasurementError` where they go on at their end.
    """
    if response.ndim != 3 or len(response) < LEAST_TIMES:
        raise MeasurementError(
            f"{path}: response: expected {LEAST_TIMES} times or more, by channels and hits, "
            f"found {response.shape}"
        )
    _require_decay(path, response)
    f = np.asarray(np.fft.rfftfreq(len(response), step), dtype=float)
    return f, step * np.fft.rfft(response, axis=0)


def from_the_hit(where: str, times: Array, response: Array) -> tuple[Array, float]:
    """Responses (n, ...) with those before t = 0 at their end, and their step [s].

    `MeasurementError` where times (n,) [s] are uneven, or begin after the hit.
    """
    step = float(np.median(np.diff(times))) if len(times) > 1 else 0.0
    if not step > 0.0 or np.abs(times - times[0] - step * np.arange(len(times))).max() > (
        SAME_STEP * step * len(times)
    ):
        raise MeasurementError(f"{where}: expected even times [s], ascending, found others")
    before = -times[0] / step
    if before < -SAME_STEP or abs(before - round(before)) > SAME_STEP * max(before, 1.0):
        raise MeasurementError(
            f"{where}: expected times with the hit at t = 0 among them, found {times[0]:g} s first"
        )
    return np.roll(response, -round(before), axis=0), step


def _require_decay(path: Path, response: Array) -> None:
    """`MeasurementError` where impulse responses go on at their end.

    A vibration turns by one phase in all responses from the eighth tenth to the ninth, noise does
    not: of its product with what was before, hardly anything is left.
    """
    start, middle, stop = (round(part * len(response)) for part in END_OF_RESPONSE)
    whole, before, end = (
        np.fft.rfft(part, len(response), axis=0)
        for part in (response, response[start:middle], response[middle:stop])
    )
    # Over time slow modes are hidden by fast ones: by lines they are not.
    sizes = [np.sqrt(np.sum(np.abs(part) ** 2, axis=(1, 2))) for part in (whole, before)]
    common = np.abs(np.einsum("kab,kab->k", before.conj(), end))
    left = common / np.maximum(sizes[0] * sizes[1], LEAST_PRODUCT)
    if (largest := float(left.max())) > LARGEST_END:
        raise MeasurementError(
            f"{path}: response: its ninth tenth has {largest:.1%} of some line, "
            f"expected at most {LARGEST_END:.0%}: it has not come to rest; measure longer, or with "
            "an exponential window (measured.window)"
        )
