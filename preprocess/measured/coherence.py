"""Coherences of a test: which channels and hits are noise, and whether all of it is."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from ..errors import MeasurementError
from .frequency_data import FrequencyData

DOUBTED_COHERENCE, LEAST_COHERENCE = 0.8, 0.5
"""medians over the band: of a channel or a hit that a warning names, of a test that is refused;
noise of half the response makes 0.8"""


def require_coherence(path: Path, data: FrequencyData) -> None:
    """`MeasurementError` where most of the responses are noise."""
    if data.coherence is None or not data.coherence.size:
        return
    if (median := float(np.median(data.coherence))) < LEAST_COHERENCE:
        raise MeasurementError(
            f"{path}: coherence: expected a median of {LEAST_COHERENCE:g} or more in the band, "
            f"found {median:.2f}: most of the responses are noise"
        )


def doubts_of_coherence(
    data: FrequencyData, channels: Sequence[str], hits: Sequence[str]
) -> Iterator[str]:
    """A line for each channel and hit that has little coherence, one where most have."""
    if data.coherence is None:
        return
    for kind, names, others in (("channel", channels, (0, 2)), ("hit", hits, (0, 1))):
        medians = np.median(data.coherence, axis=others)
        low = medians < DOUBTED_COHERENCE
        if 2 * low.sum() > len(names):
            yield (
                f"{low.sum()} of {len(names)} {kind}s have a median coherence below "
                f"{DOUBTED_COHERENCE:g}: {np.median(medians[low]):.2f}"
            )
            # The same noise is in channels and in hits.
            return
        for k in np.flatnonzero(low).tolist():
            yield (
                f"{kind} {names[k]} has a median coherence of {medians[k]:.2f}, expected "
                f"{DOUBTED_COHERENCE:g} or more"
            )
