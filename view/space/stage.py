"""What is on stage in a film: bodies with their values, and marks, at all its times."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...results import Results
from ...results.steps import batches
from ...superelement.validation import Array
from ..errors import PictureError
from ..field_kinds import FIELD_WORDS
from ..prefixes import rounded_down
from .bodies import Body, bodies_on_stage
from .marks import MARK_LEGEND, Mark, Placing, largest_force, marks_of
from .tracks import Tracks

Single = NDArray[np.float32]
NO_FIELD = "none"
# Points of all bodies times frames: some 50 MB of positions and values.
BATCH_POINT_FRAMES = 3_000_000
# Of positions and values of all frames, which every pass needs again.
MAX_KEPT_BYTES = 1 << 29
# Over the size of the model: what is larger is seen as it is.
VISIBLE_DEFORMATION = 0.02
# Over the size of the model, when it is magnified: clear, and no caricature.
WANTED_DEFORMATION = 0.05
# Over the size of the model: nothing to be magnified.
ROUNDING_DEFORMATION = 1e-8
# Over the size of the model.
MARK_RADIUS = 0.009
# Of slender beams, which would be lines whose colors nobody sees, over the size of the model.
LEAST_BEAM_RADIUS = 0.007


@dataclass(frozen=True, eq=False)
class Batch:
    """Some frames: positions (k, p, 3) of each body, and values (k, p) or None.

    Positions are from the middle of the stage, so that single precision serves far from the origin.
    """

    rows: slice
    positions: tuple[Single, ...]
    values: tuple[Single | None, ...]

    def __len__(self) -> int:
        return int(self.rows.stop) - int(self.rows.start)


class Stage:
    """Bodies and marks of a run at times (k,) [s].

    field: one of `FIELD_WORDS`, "none", or None for the choice: stresses where all flexible bodies
    know them, else displacements where one is flexible. magnify: of deformation, None for the
    choice. limit: where colors end, None for the largest value.
    """

    def __init__(
        self,
        results: Results,
        times: Array,
        field: str | None = None,
        magnify: float | None = None,
        marks: bool = True,
        limit: float | None = None,
    ) -> None:
        self.times = times
        self._limit = limit
        tracks = Tracks(results, times)
        self.bodies = bodies_on_stage(results, tracks)
        if not self.bodies:
            raise PictureError("the run recorded the motion of no body: nothing can be drawn")
        self.size = size_of(self.bodies)
        for body in self.bodies:
            body.thicken(LEAST_BEAM_RADIUS * self.size)
        points = sum(len(body.X) for body in self.bodies)
        self.rows = batches(len(times), BATCH_POINT_FRAMES // max(points, 1))
        # All passes over the frames need the same positions, which is most of the work.
        self._keeps = 16 * points * len(times) <= MAX_KEPT_BYTES
        self._kept: dict[int, Batch] = {}
        self.middle: Array = np.mean([body.track.position[0] for body in self.bodies], axis=0)
        remarks = (results.outline_remark(body.name) for body in self.bodies)
        self.remarks = tuple(remark for remark in remarks if remark)
        self.field = chosen_field(self.bodies, field)
        self.untold = unknown(self.bodies, self.field) if self.field else {}
        chosen = chosen_magnification(self.bodies, self.rows) if magnify is None else magnify
        self.magnification = chosen
        self.placing = Placing(tracks, self.bodies, self.magnification)
        self.radius = MARK_RADIUS * self.size
        self.marks: tuple[Mark, ...] = ()
        self.largest_force = 0.0
        if marks:
            self.marks = marks_of(results, self.placing, self.radius, self.size)
            self.largest_force = largest_force(results, tracks)

    @cached_property
    def largest(self) -> float:
        """The largest value of all frames."""
        found = (
            float(values.max(initial=0.0))
            for batch in (self.batches() if self.field else ())
            for values in batch.values
            if values is not None
        )
        return max(found, default=0.0)

    @property
    def limit(self) -> float:
        """The end of the scale of colors."""
        return self.largest if self._limit is None else self._limit

    @property
    def legend(self) -> tuple[tuple[str, str], ...]:
        """The kinds of marks that there are, with their colors."""
        kinds = {mark.kind for mark in self.marks}
        return tuple((kind, color) for kind, color in MARK_LEGEND.items() if kind in kinds)

    @property
    def told(self) -> tuple[Body, ...]:
        """The bodies that show the field."""
        shown = self.colored() if self.field else ()
        return tuple(body for body in shown if body.name not in self.untold)

    def colored(self) -> tuple[Body, ...]:
        return colored(self.bodies, self.field)

    def batches(self) -> Iterator[Batch]:
        """All frames, a few at once; they are kept where there is room, else the last ones."""
        for number, rows in enumerate(self.rows):
            if number not in self._kept:
                if not self._keeps:
                    self._kept.clear()
                self._kept[number] = self._batch(rows)
            yield self._kept[number]

    def mark_positions(self, rows: slice) -> Iterator[Array]:
        """Positions (k, p, 3) of the points of each mark, from the middle of the stage."""
        for mark in self.marks:
            yield mark.position(rows) - self.middle

    def _batch(self, rows: slice) -> Batch:
        positions = (
            (body.position(rows, self.magnification) - self.middle).astype(np.float32)
            for body in self.bodies
        )
        values = (
            body.values(rows, self.field).astype(np.float32) if body in self.told else None
            for body in self.bodies
        )
        return Batch(rows, tuple(positions), tuple(values))


def size_of(bodies: tuple[Body, ...]) -> float:
    """The diagonal of the box around all bodies at the first time [m]."""
    points = np.concatenate([body.position(slice(0, 1), 1.0)[0] for body in bodies])
    return float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0


def chosen_magnification(bodies: tuple[Body, ...], rows: Iterable[slice]) -> float:
    """By the largest deformation of all bodies in all rows."""
    found = (body.largest_deformation(some) for some in rows for body in bodies)
    return magnification(max(found, default=0.0), size_of(bodies))


def magnification(largest: float, size: float) -> float:
    """1 where the largest deformation is seen, else 1, 2 or 5 times a power of ten that shows it.

    largest, size: of deformation and model [m].
    """
    if largest >= VISIBLE_DEFORMATION * size or largest <= ROUNDING_DEFORMATION * size:
        return 1.0
    return rounded_down(WANTED_DEFORMATION * size / largest)


def chosen_field(bodies: tuple[Body, ...], field: str | None) -> str:
    """The name of a field, "" for none; PictureError if there is no such field."""
    if field == NO_FIELD:
        return ""
    if field is not None:
        if field not in FIELD_WORDS:
            known = ", ".join([*FIELD_WORDS, NO_FIELD])
            raise PictureError(f"--field: expected {known}, found {field!r}")
        return field
    flexible = [body for body in bodies if body.flexible]
    if not flexible:
        return ""
    unknown = any(body.why_unknown("von_mises") for body in flexible)
    return "displacement" if unknown else "von_mises"


def colored(bodies: tuple[Body, ...], field: str) -> tuple[Body, ...]:
    """The bodies that a field belongs to: all move, but only flexible ones deform."""
    return tuple(body for body in bodies if field == "velocity" or body.flexible)


def unknown(bodies: tuple[Body, ...], field: str) -> dict[str, str]:
    """Why bodies that a field belongs to have none; PictureError where that is so of all."""
    whys = {body.name: body.why_unknown(field) for body in colored(bodies, field)}
    if not whys:
        raise PictureError(f"--field {field}: no body whose deformation the run recorded")
    if all(whys.values()):
        raise PictureError(f"--field {field}: {next(iter(whys.values()))}")
    return {name: why for name, why in whys.items() if why}
