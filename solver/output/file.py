"""The results file as a run writes it.

Every dataset has the recorded steps, t = 0 included, along its first axis and its units as an
attribute. Between writes the file is closed, so that others can read it and a run that is killed
leaves what it had: the first `written` rows, an attribute of /solver.
"""

import io
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from typing import Any

import h5py

from ...results.results import FORMAT, VERSION, Results
from ...superelement import sha256
from ..arrays import Array, Index
from ..errors import ResultsError
from ..lower.lower import LoweredModel
from ..step.system import Output
from .columns import requested_columns

PATIENCE = 10.0
"""seconds to wait for others that have the file open, to read it"""
CHUNK = 1024
"""rows that HDF5 keeps together"""


class ResultsFile:
    """Appends rows of output to a file, or to memory where no path is given.

    `ResultsError` where the file cannot be written, or is no longer the one that this run began.
    """

    def __init__(self, path: Path | None, lowered: LoweredModel) -> None:
        self._path = path
        self._memory = None if path else h5py.File(io.BytesIO(), "w")
        self._columns = requested_columns(lowered)
        self._balanced = lowered.model.settings.output.selects("energy")
        self._h = lowered.h
        # Those of a file are left there until a field is asked for, unless all of them is here
        # already.
        self._superelements = {
            name: body.superelement
            for name, body in lowered.model.flexible_bodies.items()
            if body.superelement.recovery is not None or not body.source
        }
        self._energy_start: tuple[float, float] | None = None
        self._written = 0
        self._run = uuid.uuid4().hex
        with self._open("w") as file:
            _describe(file, lowered, self._run)

    def append(self, steps: Index, output: Output) -> None:
        """Write the first rows of the output: those of the steps (n,)."""
        first, n = self._written, len(steps)
        if n == 0:
            return
        with self._own() as file:
            _extend(file, "time", "s", self._h * steps, first)
            for name, column in self._columns.items():
                _extend(file, name, column.units, column.rows(output, n), first)
            if self._balanced:
                for name, values in self._balances(output, n).items():
                    _extend(file, f"energy/{name}", "J", values, first)
        # Rows count once they are all in the file: a run can be killed while it writes them.
        self.note(written=first + n)
        self._written = first + n

    def note(self, **attributes: Any) -> None:
        """Attributes of the group /solver."""
        with self._own() as file:
            file["solver"].attrs.update(attributes)

    def results(self) -> Results:
        return Results(self._memory or self._path, self._superelements)

    def _balances(self, output: Output, n: int) -> dict[str, Array]:
        """What dampers took, and what is missing in the sum of all energies; both 0 at the start."""
        kinetic, elastic, springs, potential, work, compliance_work, _ = output.energy[:n].T
        if self._energy_start is None:
            self._energy_start = (springs[0], (kinetic + elastic + springs + potential)[0])
        springs_start, total_start = self._energy_start
        dissipated = -compliance_work - (springs - springs_start)
        balance = kinetic + elastic + springs + potential + dissipated - work - total_start
        return {"dissipated": dissipated, "balance": balance}

    @contextmanager
    def _own(self) -> Iterator[h5py.File]:
        """The file, if it is still that of this run: another run may have replaced it."""
        with self._open("r+") as file:
            if "solver" not in file or file["solver"].attrs.get("run") != self._run:
                raise ResultsError(
                    f"{self._path}: another run writes to this file now; this one stops, {self._written} rows long"
                )
            yield file

    @contextmanager
    def _open(self, mode: str) -> Iterator[h5py.File]:
        if self._memory is not None:
            yield self._memory
            return
        try:
            with _opened(self._path, mode) as file:
                yield file
        except OSError as error:
            raise ResultsError(f"{self._path}: cannot be written: {error}") from error


def check_folder(path: Path) -> None:
    if not path.parent.is_dir():
        raise ResultsError(f"{path}: no folder {path.parent}")


def _opened(path: Path | None, mode: str) -> h5py.File:
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            return h5py.File(path, mode)
        except BlockingIOError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.02)


def _describe(file: h5py.File, lowered: LoweredModel, run: str) -> None:
    model = lowered.model
    file.attrs.update(
        format=FORMAT,
        version=VERSION,
        units="SI",
        created_by=f"duhamel {metadata.version('duhamel')}",
        model=model.source,
    )
    for group in ("bodies", "frames", "joints", "springs", "energy", "momentum"):
        file.create_group(group)
    hashes = file.create_group("superelements")
    for name, body in model.flexible_bodies.items():
        hashes.attrs[name] = sha256(body.source) if body.source else ""
    files = hashes.create_group("files")
    files.attrs.update(
        {
            name: str(Path(b.source).resolve())
            for name, b in model.flexible_bodies.items()
            if b.source
        }
    )
    file.create_group("solver").attrs.update(
        h=lowered.h,
        rho_inf=lowered.scheme.rho_inf,
        steps=lowered.n_steps,
        rule=model.settings.rule,
        start=model.settings.start,
        every=model.settings.output.every,
        finished=False,
        written=0,
        run=run,
    )


def _extend(file: h5py.File, name: str, units: str, rows: Any, first: int) -> None:
    """Rows from `first` on, in place of any that an interrupted attempt left there."""
    dataset = file.get(name)
    if dataset is None:
        shape = rows.shape[1:]
        # a joint may have lost all its rows; HDF5 then wants room for one
        maxshape, chunks = (
            (None, *(width or None for width in shape)),
            (CHUNK, *(width or 1 for width in shape)),
        )
        file.create_dataset(name, data=rows, maxshape=maxshape, chunks=chunks).attrs["units"] = (
            units
        )
    else:
        dataset.resize(first + len(rows), axis=0)
        dataset[first:] = rows
