"""A part on the bench: where its plan measures and hits it, and what is measured."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...files.arrays import Array
from ..assembly.structure import attach
from ..body.body import Body
from ..body.measured_body import MeasuredBody
from ..errors import MeasurementError
from ..measured.channels import ChannelTable, read_channels
from ..measured.frequency_data import LEAST_LINES, FrequencyData
from ..measured.hits import HitTable, read_hits
from ..progress import Stages
from .made_plan import made_plan
from .plan_files import PlannedFiles
from .simulation import HammerErrors, hammer_test
from .struck_part import StruckPart, solids_of, struck_part

LINES_OF_TEST = 3200
"""from zero to the highest frequency, as analyzers have them"""
PLACE_OF_INTERFACE = 1e-3
"""of the extent of the part, within which a point is that of the mesh"""
FIRST_LINE = 0.1
"""of the first resonance: below, the cords of the part are in the responses"""


@dataclass(frozen=True, eq=False)
class HammerBench:
    """A plan and the part that it tests, at the points of its tables."""

    plan: MeasuredBody
    channels: ChannelTable
    hits: HitTable
    part: StruckPart

    def lines(self, count: int = LINES_OF_TEST) -> Array:
        """Frequencies [Hz] in the band of the plan, of `count` from zero to its end."""
        low, high = self.plan.measured.band
        f = np.arange(1.0, count + 1.0) * (high / count)
        inside = np.asarray(f[f >= low])
        if len(inside) < LEAST_LINES:
            raise MeasurementError(
                f"the band from {low:g} to {high:g} Hz has {len(inside)} lines of {count}, "
                f"expected {LEAST_LINES} or more: take a wider band, or more lines"
            )
        return inside

    def measured(self, errors: HammerErrors, f: Array) -> FrequencyData:
        """What the test measures at frequencies f (k,) [Hz]."""
        asked = self.plan.measured
        return hammer_test(
            self.part, self.channels, self.hits, f, errors, asked.window, asked.sensor_mass
        )

    def doubts(self, f: Array) -> Iterator[str]:
        """Points that are not where the mesh has its interfaces, and peaks between the lines."""
        places = {one.name: one.X + self.part.rigid.center for one in self.part.interfaces}
        size = float(np.linalg.norm(np.ptp(self.part.points, axis=0)))
        for name, point in self.plan.interfaces.items():
            apart = float(np.linalg.norm(places[name] - point.at))
            if apart > PLACE_OF_INTERFACE * size:
                yield (
                    f"interfaces.{name}.at: the mesh has it at {places[name].round(6).tolist()}, "
                    f"the plan {1e3 * apart:.3g} mm from there"
                )
        modes, asked = self.part.modes, self.plan.measured
        frequencies, apart = modes.resonances / (2.0 * np.pi), float(f[1] - f[0])
        width = 2.0 * self.part.damping * frequencies + asked.window / np.pi
        inside = (frequencies > f[0]) & (frequencies < f[-1])
        if (narrow := inside & (width < apart)).any():
            k = int(np.flatnonzero(narrow)[0])
            yield (
                f"the peak at {frequencies[k]:.4g} Hz is {width[k]:.2g} Hz wide, and lines are "
                f"{apart:.2g} Hz apart: expected two or three in it: take more lines, or a window"
            )


def bench_of(body: Body, plan: MeasuredBody, stages: Stages) -> HammerBench:
    """The bench of a plan that is given; `MeasurementError` for places that the mesh lacks."""
    # Errors are compared there: a name that the mesh lacks is refused before the work.
    for name in plan.interfaces:
        if name not in body.interfaces:
            known = ", ".join(body.interfaces)
            raise MeasurementError(f"interfaces.{name}: the mesh has none; there are: {known}")
    channels, hits = read_channels(plan.measured.channels), read_hits(plan.measured.hits)
    part = _part_of(body, channels, hits, plan.measured.band[1], stages)
    return HammerBench(plan, channels, hits, part)


def _part_of(
    body: Body, channels: ChannelTable, hits: HitTable, highest: float, stages: Stages
) -> StruckPart:
    if not body.damping.model_fields_set and not any(body.loss_factors.values()):
        raise MeasurementError(
            "damping: a part that is tested needs some, or its peaks would have no width: expected "
            "[damping] or a loss_factor, found none"
        )
    points = {f"sensor {label}": X for label, X in channels.sensors.items()}
    points |= {f"hit {label}": X for label, X in zip(hits.labels, hits.points, strict=True)}
    pushes = {f"hit {label}": d for label, d in zip(hits.labels, hits.directions, strict=True)}
    return struck_part(body, points, pushes, highest, stages)


def planned_bench(
    body: Body,
    files: PlannedFiles,
    stages: Stages,
    band: tuple[float | None, float | None] = (None, None),
) -> HammerBench:
    """A bench of a plan that is made for the interfaces of a body, and written to files.

    band [Hz]: from a tenth of the first resonance up to the band of the superelement, unless given.
    """
    with stages.stage("plan"):
        source = solids_of(body)
        plan = made_plan(source, attach(body, source).frames)
        files.write_tables(plan)
    channels, hits = read_channels(files.channels), read_hits(files.hits)
    # Up to where the superelement of the mesh would be right, if nobody says otherwise.
    high = band[1] or body.impulse.band or 0.25 / body.impulse.step
    part = _part_of(body, channels, hits, high, stages)
    first = float(part.modes.resonances.min()) / (2.0 * np.pi)
    low = band[0] or float(f"{FIRST_LINE * first:.1g}")
    return HammerBench(files.write_tested(body, part, plan, (low, high)), channels, hits, part)
