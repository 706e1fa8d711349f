"""What is doubtful about a test: what it says before its fit, and what the fit says."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..body.measured_body import BY_RESPONSES, LINES_OVER_SUSPENSION
from ..identification.complexity import OutOfPhase
from ..identification.identify import Identification
from ..identification.responses import Measurement
from .coherence import doubts_of_coherence
from .delays import Delays
from .first_resonance import BEYOND_CORDS, first_resonance
from .mass_line import LARGEST_OFFSET, doubts_of_mass_line, is_too_high, not_checked
from .part_test import PartTest
from .suspension import stiff_suspension

DOUBTED_MISFIT = 0.1
"""of a fit, of which a warning tells"""
DOUBTED_SIGN = 0.9
"""of the driving points of a mode: of true ones it is above 0.99"""
DOUBTED_SHARE, LARGEST_SHARE = 0.1, 0.3
"""of a mode that is out of phase: of real ones it is within 0.01"""
REFINED_POLE = 0.02
"""relative change of a given pole by the fit, beyond which it is that of another mode"""
SEEN_MODE = 0.2
"""of noise in the residue of a mode: of true ones it is within 0.05"""
BAND_OF_TEST = 0.9
"""of the highest frequency: above it the flanks of modes beyond the band are missing"""


def doubts_of_test(test: PartTest, measurement: Measurement) -> Iterator[str]:
    """A line for each thing that is wrong with channels, hits, mass or cords."""
    asked = test.body.measured
    yield from doubts_of_coherence(test.data, test.channels.names, test.hits.labels)
    yield from _levers_not_counted(test)
    if asked.lowest > asked.band[0]:
        yield (
            f"lines below {asked.lowest:g} Hz are not used: on its cords the part has up to "
            f"{asked.suspension:g} Hz, by measured.suspension"
        )
        # Lines from beyond its first resonance on would have the next as their first.
        if is_too_high(asked.lowest, test.first):
            yield not_checked(test.first)
            return
    elif asked.suspension is None and (f_s := stiff_suspension(measurement)):
        yield (
            f"the part has {f_s:.2g} Hz on its cords, too much for lines from "
            f"{test.data.f[0]:g} Hz on: give measured.suspension, the highest of its six "
            "frequencies there"
        )
        # What cords do would be errors of all channels and hits, or is in the mass already.
        beyond = test.data.lines(np.flatnonzero(test.data.f > BEYOND_CORDS * f_s))
        first, lowest = first_resonance(beyond.f, beyond.H), LINES_OVER_SUSPENSION * f_s
        free = test.data.f > lowest
        measurement = replace(measurement, s=measurement.s[free], H=measurement.H[free])
        by_responses = asked.rigid.source == BY_RESPONSES
        if by_responses or is_too_high(lowest, first):
            return
    yield from doubts_of_mass_line(measurement, test.channels, test.hits, test.rigid.center)


def _levers_not_counted(test: PartTest) -> Iterator[str]:
    """A line for each point without rotations whose sensors or hits are not at it."""
    points = np.vstack([test.channels.points, test.hits.points])
    labels = (*test.channels.labels, *test.hits.labels)
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    for name, point in test.body.interfaces.items():
        own = [k for k, label in enumerate(labels) if label in (*point.channels, *point.hits)]
        apart = np.linalg.norm(points[own] - point.at, axis=1)
        if not point.rotations and (far := float(apart.max())) > LARGEST_OFFSET * size:
            yield (
                f"interfaces.{name}: rotations = false, but {labels[own[int(apart.argmax())]]} is "
                f"{1e3 * far:.0f} mm from its at: levers are not counted"
            )


def doubts_of_fit(
    test: PartTest,
    measurement: Measurement,
    found: Identification,
    delays: Delays,
    phases: OutOfPhase,
) -> Iterator[str]:
    """A line for each thing in which a fit is unlike that of a right test."""
    fit, refused = found.fit, found.fit.misfit > test.body.measured.accept
    if not refused:
        yield from delays.told(test.channels.names, test.hits.labels)
    if fit.misfit > DOUBTED_MISFIT:
        yield (
            f"the responses of {len(fit.omega)} modes differ from those measured by "
            f"{fit.misfit:.2f} of these"
        )
    # Of a fit that is none, nothing else is told.
    if refused:
        return
    # Poles of a search come and go, those of a user are meant.
    if (given := test.body.measured.poles) is not None:
        for frequency, _ in found.dropped:
            yield f"measured.poles: no mode is found at {frequency:.5g} Hz"
        for frequency in fit.frequencies:
            if min(abs(pole / frequency - 1.0) for pole, _ in given) > REFINED_POLE:
                yield f"measured.poles: the mode at {frequency:.5g} Hz has none, and is added"
    if said := too_complex(measurement, found, phases, DOUBTED_SHARE):
        yield said
    # A mode that is hidden in noise has any shape, and so has one whose flank alone is in the band.
    seen = (phases.noise < SEEN_MODE) & (fit.omega < measurement.highest)
    for frequency in fit.frequencies[seen & (found.signs < DOUBTED_SIGN)]:
        yield (
            f"the mode at {frequency:.5g} Hz has another shape by hits than by sensors: are all of "
            "them where the tables say?"
        )


def too_complex(
    measurement: Measurement, found: Identification, phases: OutOfPhase, most: float
) -> str:
    """What is said of the mode that is most out of phase if that is too much, else ""."""
    k, share = most_out_of_phase(measurement, found, phases)
    # What a poor fit leaves is out of phase too.
    if share <= max(most, found.fit.misfit):
        return ""
    return (
        f"the mode at {found.fit.frequencies[k]:.5g} Hz is out of phase by {100.0 * share:.2g} % "
        "of its shape, as by a damper at one place: the superelement has real shapes"
    )


def most_out_of_phase(
    measurement: Measurement, found: Identification, phases: OutOfPhase
) -> tuple[int, float]:
    """The mode of the band that is most out of phase, and how much."""
    within = found.fit.omega < BAND_OF_TEST * measurement.highest
    shares = np.where(within, phases.shares, 0.0)
    k = int(shares.argmax()) if len(shares) else 0
    return k, float(shares.max(initial=0.0))
