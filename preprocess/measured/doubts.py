"""What is doubtful about a test: what it says before its fit, and what the fit says."""

from collections.abc import Iterator
from dataclasses import replace

from ..body.measured_body import BY_RESPONSES, LINES_OVER_SUSPENSION
from ..identification.identify import Identification
from ..identification.responses import Measurement
from .mass_line import doubts_of_mass_line, mass_line
from .part_test import PartTest
from .suspension import stiff_suspension

DOUBTED_MISFIT = 0.1
"""of a fit, of which a warning tells"""
DOUBTED_SIGN = 0.9
"""of the driving points of a mode: of true ones it is above 0.99"""


def doubts_of_test(test: PartTest, measurement: Measurement) -> Iterator[str]:
    """A line for each thing that is wrong with channels, hits, mass or cords."""
    asked = test.body.measured
    if asked.lowest > asked.band[0]:
        yield (
            f"lines below {asked.lowest:g} Hz are not used: on its cords the part has up to "
            f"{asked.suspension:g} Hz, by measured.suspension"
        )
    elif asked.suspension is None and (f_s := stiff_suspension(measurement)):
        yield (
            f"the mass line says that the part has {f_s:.2g} Hz on its cords, too much for lines "
            f"from {test.data.f[0]:g} Hz on: give measured.suspension, the highest of its six "
            "frequencies there"
        )
        # What cords do would be errors of all channels and hits, or is in the mass already.
        free = test.data.f > LINES_OVER_SUSPENSION * f_s
        measurement = replace(measurement, s=measurement.s[free], H=measurement.H[free])
        by_responses = asked.rigid.source == BY_RESPONSES
        if by_responses or mass_line(measurement.s, measurement.H) is None:
            return
    yield from doubts_of_mass_line(measurement, test.channels, test.hits, test.rigid.center)


def doubts_of_fit(found: Identification) -> Iterator[str]:
    """A line for each thing in which a fit is unlike that of a right test."""
    fit = found.fit
    if fit.misfit > DOUBTED_MISFIT:
        yield (
            f"the responses of {len(fit.omega)} modes differ from those measured by "
            f"{fit.misfit:.2f} of these"
        )
    for frequency in fit.frequencies[found.signs < DOUBTED_SIGN]:
        yield (
            f"the mode at {frequency:.5g} Hz has another shape by hits than by sensors: are all of "
            "them where the tables say?"
        )
