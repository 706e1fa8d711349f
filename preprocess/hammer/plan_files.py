"""The files of a plan that is made: tables of channels and hits, and the body file of the test."""

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...files import renamed_when_whole
from ...files.arrays import Array
from ..body.body import Body
from ..body.measured_body import MeasuredBody
from ..body.writing import write_body
from ..errors import MeasurementError
from .made_plan import MadePlan
from .struck_part import StruckPart

DIGITS_OF_SIZE = 6
"""of the extent of a part, in which places are written"""
FIRST_SENSOR, FIRST_HIT, NEXT_INTERFACE = 1, 101, 100
"""labels are numbers, as UFF files have them: hits 101, 102 ... at the first interface, 201 ... at
the second"""
STORED_RESPONSES = 100
"""impulse responses of the superelement that the test makes"""
TableLine = list[str | float]


@dataclass(frozen=True, eq=False)
class PlannedFiles:
    """channels.csv, hits.csv and tested.toml in a folder, for responses in a file there.

    window [1/s] and sensor_mass [kg]: of the test.
    """

    folder: Path
    responses: str
    window: float = 0.0
    sensor_mass: float = 0.0

    @property
    def channels(self) -> Path:
        return self.folder / "channels.csv"

    @property
    def hits(self) -> Path:
        return self.folder / "hits.csv"

    @property
    def tested(self) -> Path:
        return self.folder / "tested.toml"

    def write_tables(self, plan: MadePlan) -> None:
        """The tables of sensors and hits."""
        surface, decimals = plan.surface, _decimals(plan.surface.points)
        channels, hits = list[TableLine](), list[TableLine]()
        for group in _labelled(plan):
            for label, k in group.sensors.items():
                X = _rounded(surface.points[k], decimals)
                channels += [[label, *X, axis] for axis in "xyz"]
            for label, k in group.hits.items():
                X = _rounded(surface.points[k], decimals)
                hits.append([label, *X, *_rounded(surface.inwards[k], DIGITS_OF_SIZE)])
        for path, last, rows in (
            (self.channels, ["axis"], channels),
            (self.hits, ["dx", "dy", "dz"], hits),
        ):
            with (
                renamed_when_whole(path, failure=MeasurementError) as temporary,
                temporary.open("w", encoding="utf-8", newline="") as file,
            ):
                csv.writer(file).writerows([["label", "x", "y", "z", *last], *rows])

    def write_tested(
        self, body: Body, part: StruckPart, plan: MadePlan, band: tuple[float, float]
    ) -> MeasuredBody:
        """The body file of a part with the mass, the center and the inertia of its mesh."""
        decimals = _decimals(plan.surface.points)
        test = {"window": self.window, "sensor_mass": self.sensor_mass}
        interfaces = {
            name: {
                "at": _rounded(one.at, decimals),
                "channels": list(group.sensors),
                "hits": list(group.hits),
            }
            for (name, one), group in zip(plan.interfaces.items(), _labelled(plan), strict=False)
        }
        tested = MeasuredBody.model_validate(
            {
                "name": body.name,
                "measured": {
                    "frf": self.folder / self.responses,
                    "channels": self.channels,
                    "hits": self.hits,
                    "band": list(band),
                    **{key: value for key, value in test.items() if value},
                    "rigid": {
                        "mass": float(f"{part.rigid.mass:.{DIGITS_OF_SIZE}g}"),
                        "center": _rounded(part.rigid.center, decimals),
                        "inertia": _rounded(
                            part.rigid.inertia, _decimals_of(np.abs(part.rigid.inertia).max())
                        ),
                    },
                },
                "interfaces": interfaces,
                "impulse": {
                    **body.impulse.model_dump(include={"step", "rho_inf"}, exclude_unset=True),
                    "steps": STORED_RESPONSES,
                },
            }
        )
        write_body(tested, self.tested)
        return tested


@dataclass(frozen=True)
class LabelledGroup:
    """The points of sensors and hits by their labels, of an interface or of none."""

    sensors: dict[str, int]
    hits: dict[str, int]


def _labelled(plan: MadePlan) -> Iterator[LabelledGroup]:
    """Of each interface, and then of the further ones."""
    sensor = FIRST_SENSOR
    groups = [(one.sensors, one.hits) for one in plan.interfaces.values()]
    for number, (sensors, hits) in enumerate([*groups, (plan.sensors, plan.hits)]):
        yield LabelledGroup(
            {str(sensor + i): int(k) for i, k in enumerate(sensors)},
            {str(FIRST_HIT + NEXT_INTERFACE * number + i): int(k) for i, k in enumerate(hits)},
        )
        sensor += len(sensors)


def _decimals(points: Array) -> int:
    """Of places: the digits of a printed number are those of the size of the part."""
    return _decimals_of(float(np.linalg.norm(np.ptp(points, axis=0))))


def _decimals_of(size: float) -> int:
    return DIGITS_OF_SIZE - int(np.floor(np.log10(size)))


def _rounded(values: Array, decimals: int) -> list[Any]:
    # Adding zero makes zeros of negative ones.
    rounded: list[Any] = (values.round(decimals) + 0.0).tolist()
    return rounded
