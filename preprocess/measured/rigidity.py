"""Up to which frequency interfaces move as rigid pieces, as virtual points do.

Of the responses H_v (k, n, n_i) of the n channels of an interface, whose rows R (n, 6) are

    |(I - R R^+) H_v| / |H_v|

is what no rigid motion of these channels explains; of hits likewise. It holds errors of places and
angles, which are the same at all frequencies, and from some frequency on the bending of the part.
Source: M. V. van der Seijs, D. D. van den Bosch, D. J. Rixen, D. de Klerk, Mechanical Systems and
Signal Processing 75 (2016) 148-167.
"""

from collections.abc import Iterator

import numpy as np

from ...files.arrays import Array, Complex
from ..identification.responses import Measurement

LARGEST_BENDING = 0.2
"""of the responses of an interface; errors of 2 degrees and 1 mm are within 0.12"""
SMOOTHED_PART = 0.05
"""of the lines, over which it is averaged: at antiresonances of a few channels it is large"""


def rigid_up_to(measured: Measurement, interfaces: dict[str, slice]) -> dict[str, float]:
    """The frequency [Hz] up to which each interface is rigid; infinite where it is in the band."""
    return {name: min(_limits(measured, own)) for name, own in interfaces.items()}


def doubts_of_rigidity(measured: Measurement, interfaces: dict[str, slice]) -> Iterator[str]:
    """A line for each interface that bends in the band.

    None for one that does not move as a rigid piece at the lowest lines either: there it is not the
    part that bends.
    """
    for name, own in interfaces.items():
        limits = dict(zip(("channels", "hits"), _limits(measured, own), strict=True))
        kind = min(limits, key=limits.__getitem__)
        if 0.0 < limits[kind] < np.inf:
            yield (
                f"interface {name} is no rigid piece above {limits[kind]:.0f} Hz: "
                f"{100.0 * LARGEST_BENDING:g} % of what its {kind} tell is bending between them: "
                "end the band there, or take places that are stiff to one another"
            )


def _limits(measured: Measurement, own: slice) -> tuple[float, float]:
    """By channels and by hits; 0 where it is none at the lowest lines."""
    by_hits = measured.H.transpose(0, 2, 1)
    return (
        _limit(measured, measured.outputs[:, own], measured.H),
        _limit(measured, measured.inputs[:, own], by_hits),
    )


def _limit(measured: Measurement, rows: Array, H: Complex) -> float:
    at = np.abs(rows).sum(axis=1) > 0.0
    R, seen = rows[at], H[:, at]
    left = np.eye(len(R)) - R @ np.linalg.pinv(R)
    squares = (np.abs(np.einsum("ab,kbi->kai", left, seen)) ** 2).sum(axis=(1, 2))
    # Of lines with much response much counts: no part bends in its antiresonances alone.
    window = max(1, int(SMOOTHED_PART * len(squares)))
    kernel = np.ones(window)
    whole = np.convolve((np.abs(seen) ** 2).sum(axis=(1, 2)), kernel, "valid")
    bent = np.sqrt(np.convolve(squares, kernel, "valid") / whole)
    too_much = np.flatnonzero(bent > LARGEST_BENDING)
    if not len(too_much):
        return np.inf
    first = int(too_much[0])
    return float(measured.s.imag[first + window // 2] / (2.0 * np.pi)) if first else 0.0
