"""Warnings about the signals of a run: unresolved areas and frequencies, and drift."""

from collections.abc import Iterator

import numpy as np

from ..arrays import distinct
from ..lower.lower import LoweredModel
from ..model.loads import Load, PatternLoad
from ..signals.curves import Impulse, Input
from ..signals.drives import Drift, IntegratedDrive, drift_of
from ..signals.orientations import OrientationDrive
from ..signals.quadrature import Integrals
from ..signals.recorded import Recorded, RecordedSpline
from ..signals.signal import (
    Signal,
    SmoothSignal,
    breaks_of,
    corners_of,
    is_any,
    parts_of,
    values_of,
)

# of the area under the size of a load
MISSED_AREA = 0.01
# between the breaks of a signal, or in a period: from here on samples follow it
RESOLVED_STEPS = 8
# Longer runs would wait noticeably for a warning.
MAX_COMPARED_STEPS = 1_000_000
# of the largest value: rounding of signals
NEGLIGIBLE_VALUE = 1e-9


def drifts(lowered: LoweredModel, t_end: float) -> Iterator[Drift]:
    """Where coordinates end that are driven by their velocity or acceleration."""
    lengths = lowered.measures_lengths
    for i, d in enumerate(lowered.system.couplings.drive.tolist()):
        unit = "m" if lengths[i] else "rad"
        for about, drive in _followed(lowered, d):
            if isinstance(drive, IntegratedDrive):
                yield drift_of(drive, lowered.owner_of(i) + about, unit, t_end)


def _followed(lowered: LoweredModel, d: int) -> Iterator[tuple[str, SmoothSignal]]:
    """The drive of this number, if there is one; of an orientation, whose first row it is, three.

    Each with what names it beside its owner.
    """
    drive = lowered.drives[d] if d >= 0 else None
    if isinstance(drive, OrientationDrive):
        named = zip((" about x", " about y", " about z"), drive.angles, strict=True)
        # All three rows of an orientation follow the same three angles, which are named once.
        yield from named if drive.row == 0 else ()
    elif drive is not None:
        yield "", drive


def signal_warnings(lowered: LoweredModel) -> Iterator[str]:
    """Lines about signals that the steps do not resolve, and records that end before the run."""
    for load in lowered.model.loads:
        yield from _missed_area(load, lowered)
        yield from _warnings(f"{load.owner}: its signal", load.signal, lowered)
    for i, d in enumerate(lowered.system.couplings.drive.tolist()):
        for about, drive in _followed(lowered, d):
            signal = drive.signal if isinstance(drive, IntegratedDrive) else drive
            yield from _warnings(f"{lowered.owner_of(i)}: its drive{about}", signal, lowered)


def _missed_area(load: Load | PatternLoad, lowered: LoweredModel) -> Iterator[str]:
    """A line about a load whose samples have another area than its signal."""
    signal, h, t_end = load.signal, lowered.h, lowered.h * lowered.n_steps
    # Long steps in flight become short ones about corners.
    step = h if corners_of(signal) else lowered.longest_step
    breaks = distinct([time for time in breaks_of(signal) if 0.0 <= time <= t_end])
    if is_any(signal, Impulse) or is_any(signal, Input) or len(breaks) < 2:
        return
    if np.diff(breaks).min() >= RESOLVED_STEPS * step:
        return
    first = max(int(breaks[0] / step) - 1, 0)
    last = min(int(breaks[-1] / step) + 2, int(t_end / step + 0.5), first + MAX_COMPARED_STEPS)
    t = step * np.arange(first, last + 1, dtype=np.float64)
    samples = signal.samples(t, h)
    # The trapezoidal rule is what linear interpolation of the samples integrates to.
    found = step * (samples.sum() - 0.5 * (samples[0] + samples[-1]))
    once, _ = Integrals(signal)(t[[0, -1]])
    fine = distinct(np.concatenate([t, breaks]))
    # Between them too: a pulse within a step is zero at both ends.
    fine = np.sort(np.concatenate([fine, 0.5 * (fine[1:] + fine[:-1])]))
    # Not the area itself: that of a sine over its periods is zero.
    scale = float(np.trapezoid(np.abs(values_of(signal, fine)), fine))
    if abs(found - (once[1] - once[0])) > MISSED_AREA * scale:
        yield (
            f"{load.owner}: its signal has an area of {once[1] - once[0]:.4g} from t = {t[0]:.6g} "
            f"to {t[-1]:.6g} s, its samples at steps of {step:.6g} s have {found:.4g}: take "
            "smaller steps in [simulation], or a profile such as half_sine, whose area is exact"
        )


def _warnings(owner: str, signal: Signal, lowered: LoweredModel) -> Iterator[str]:
    t_end, step = lowered.h * lowered.n_steps, lowered.longest_step
    if isinstance(signal, Recorded | RecordedSpline):
        times, values = signal.points
        # A record that ends at zero goes on as anybody expects.
        if times[-1] < t_end - step and abs(values[-1]) > NEGLIGIBLE_VALUE * np.abs(values).max():
            goes_on = "straight" if isinstance(signal, RecordedSpline) else "with its last value"
            yield (
                f"{owner}: the record ends at t = {times[-1]:.6g} s, before t_end = {t_end:.6g} s: "
                f"it goes on {goes_on}, {values[-1]:.4g}"
            )
    frequency = float(getattr(signal, "highest_frequency", 0.0))
    if frequency * step * RESOLVED_STEPS > 1.0:
        yield (
            f"{owner} has frequencies of up to {frequency:.4g} Hz, {1.0 / (frequency * step):.3g} "
            f"steps of {step:.6g} s in a period"
        )
    for part in parts_of(signal):
        yield from _warnings(owner, part, lowered)
