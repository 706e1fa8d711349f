"""Runs: the motion of a mechanism, its parts by name, and pictures, films and reports of it."""

import os
from collections.abc import Callable, Collection, Sequence
from typing import Any, Self

from duhamel import view
from duhamel.results import QuantityError, Results
from duhamel.results.exports.data_frames import to_pandas
from duhamel.results.peaks import Peak, peaks
from duhamel.results.quantities import KINDS_BY_NAME
from duhamel.results.spelling import owner_in, quantity_of
from duhamel.results.validity import Validity
from duhamel.superelement.validation import Array

from .pictures import Picture


class Peaks(tuple[Peak, ...]):
    """Peaks of a run: a tuple that is shown as a table."""

    __slots__ = ()

    def __repr__(self) -> str:
        table = [("quantity", "unit", "largest", "at", "smallest", "at")]
        table += [
            (
                peak.quantity,
                peak.unit,
                f"{peak.largest:.4g}",
                f"{peak.at_largest:.5g} {peak.base}",
                f"{peak.smallest:.4g}",
                f"{peak.at_smallest:.5g} {peak.base}",
            )
            for peak in self
        ]
        widths = [max(map(len, column)) for column in zip(*table, strict=True)]
        sides = [str.ljust, str.ljust, *[str.rjust] * 4]
        return "\n".join(
            "  ".join(
                side(cell, width) for side, cell, width in zip(sides, row, widths, strict=True)
            )
            for row in table
        )


class Run:
    """The motion of a mechanism over time.

    `run["rod"]` is the motion of a body, `run["rod.tip"]` that of a frame, `run["hinge"]` a joint,
    spring, contact, stop, motor, coupler, FMU, sensor or load pattern. All arrays have a row for
    each recorded step, at the times of `run.time`.

    Examples
    --------
    >>> import duhamel as du
    >>> m = du.Mechanism()
    >>> body = m.add(du.RigidBody(2.0, [0.1, 0.1, 0.1]), name="body")
    >>> m.add(du.loads.Force(body, "x", du.signals.Constant(4.0))).type
    'force'
    >>> run = m.simulate(1.0, step=0.1)
    >>> round(float(run["body"].x[-1, 0]), 6)
    1.0
    """

    def __init__(self, results: Results) -> None:
        self.results = results
        """all that was recorded, see `duhamel.results.Results`"""

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Self:
        """The run of a results file; `ResultsError` names the file and what is wrong with it."""
        return cls(Results.read(path))

    @property
    def time(self) -> Array:
        """The recorded times (n,) [s]."""
        return self.results.time

    @property
    def energy(self) -> Any:
        """Energies over time (n,) [J]: kinetic, elastic, potential, external, dissipated, ..."""
        return self.results.energy

    @property
    def validity(self) -> Validity:
        """How far the run is to be trusted: `print(run.validity)` shows a table."""
        return self.results.validity

    def __getitem__(self, name: Any) -> Any:
        """The motion of a body, frame, joint, ... by its name or its handle."""
        name = getattr(name, "frame_name", getattr(name, "name", name))
        found = self._owners().get(name)
        if found is None:
            known = ", ".join(self._owners()) or "none"
            owner, words = owner_in(str(name), self._owners()) or ("", [""])
            has_it = bool(owner) and hasattr(self[owner], words[0])
            meant = f"did you mean run[{owner!r}].{words[0]}? " if has_it else ""
            raise QuantityError(f"nothing is named {name!r}; {meant}there are: {known}")
        return found(name)

    def __repr__(self) -> str:
        last = self.time[-1] if len(self.time) else 0.0
        return (
            f"<Run: {len(self.time)} rows to {last:g} s, bodies {', '.join(self.results.bodies)}>"
        )

    def plot(self, *quantities: str, title: str = "") -> Picture:
        """Draw quantities over time, a panel each.

        Parameters
        ----------
        *quantities : str
            "hinge.angle", "rod.tip.elastic_displacement.y", "energy.kinetic"; several of one unit,
            joined by commas, are in one panel. Without any what moved and what pushed. The names of
            `duhamel plot` ("angular_velocity:hub:z") are understood too.
        title : str
        """
        names = [
            ", ".join(self._quantity(part.strip()) for part in panel.split(","))
            for panel in quantities
        ] or [", ".join(panel) for panel in view.overview_quantities(self.results)]
        runs = [view.Run("", self.results, self.results.name)]
        return Picture(view.draw(self.time, [view.panel(runs, name) for name in names], title))

    def animate(self, path: str | os.PathLike[str], **options: Any) -> view.Film:
        """Write a film (.mp4, .gif), or a picture of one time (.png, with `at`).

        Parameters
        ----------
        path
        **options
            Those of `duhamel.view.animate`: field, magnify, start, end, at, fps, seconds, size,
            view, marks, title.
        """
        return view.animate(self.results, path, **options)

    def report(self, path: str | os.PathLike[str], title: str = "", field: str = "") -> None:
        """Write one page of HTML with all of the run, for any browser; see `view.write_report`."""
        view.write_report(self.results, path, title, field)

    def peaks(self, *quantities: str) -> "Peaks":
        """The largest values of quantities, when and where, or of all that may matter.

        A tuple of `duhamel.results.peaks.Peak`, which is shown as a table.
        """
        return Peaks(peaks(self.results, [self._quantity(name) for name in quantities]))

    def to_pandas(self, *quantities: str) -> Any:
        """Quantities as a pandas.DataFrame, by time or frequency.

        `ExportError` without pandas, and for quantities over different times or frequencies.
        """
        return to_pandas(self.results, [self._quantity(name) for name in quantities])

    def _quantity(self, text: str) -> str:
        joints = self.results.joints

        def coordinates(owner: str) -> Collection[str]:
            return self.results.joint(owner).coordinates if owner in joints else ()

        return quantity_of(text, KINDS_BY_NAME, self._owners(), coordinates)

    def _owners(self) -> dict[str, Callable[[str], Any]]:
        """What has a motion, forces or readings, by name, and how it is read."""
        results = self.results
        kinds: Sequence[tuple[Any, Callable[[str], Any]]] = (
            (results.patterns, results.pattern),
            (results.sensors, results.sensor),
            (results.couplers, results.coupler),
            (results.motors, results.motor),
            (results.fmus, results.fmu),
            (results.stops, results.stop),
            (results.contacts, results.contact),
            (results.surface_contacts, results.surface_contact),
            (results.springs, results.spring),
            (results.joints, results.joint),
            (results.frames, results.frame),
            (results.bodies, results.body),
        )
        return {name: read for names, read in kinds for name in names}
