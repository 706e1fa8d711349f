"""The results file: netCDF-4, that is HDF5 with dimension scales, one variable a quantity.

A run changes the file in moments, about once a second, between which others can read it, and one
that is killed leaves what it had (journal.py): the first `written` rows, an attribute of the group
solver.
"""

import io
import time
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib import metadata
from pathlib import Path
from typing import Any, NamedTuple, Self

import h5py
import numpy as np

from ..files.arrays import Array
from ..files.hdf5 import failures_named, require_contained, require_kind, texts
from ..files.outputs import in_words, replace_durably, resolved
from .batches import Batch, EventRows
from .contents import EARLIEST_VERSION, RESULTS_FORMAT, RESULTS_VERSION, Contents, SuperelementFile
from .dimensions import DIMENSIONS, Axes, Axis
from .errors import ResultsError
from .journal import BusyError, Journal, JournaledFile, partial_of, recover, uninterrupted
from .motion import EVENT_NUMBER, EVENT_OWNER, EVENT_QUANTITIES, QUANTITIES
from .quantity import Quantity
from .source import ALL_ROWS, Selection, Source
from .space import Space
from .space_file import put_space, read_space

# Seconds to wait for other programs that have the file open.
LOCK_WAIT = 5.0
# Seconds that a run waits for them: rows can wait in memory, the time loop should not.
LOCK_WAIT_OF_RUN = 0.1
# 256 MiB of rows; then the run does wait for the file, as long as any writer.
MAX_WAITING_BYTES = 1 << 28
# About 256 KiB: HDF5 reads and compresses whole chunks.
ROW_CHUNK_BYTES = 1 << 18
# Also where a row of very many bodies alone is larger: series are read along the rows.
MIN_CHUNK_ROWS = 16
TEXT_OF_RESULTS = h5py.string_dtype()
CHUNK_EVENTS = 512
# Values of the validity criteria.
CHECK_VALUES_VARIABLE = "check_value"


class Extent(NamedTuple):
    """How much of a file counts."""

    rows: int
    events: int = 0

    def noted(self) -> dict[str, int]:
        """As attributes of the group solver."""
        return {"written": self.rows, "events": self.events}


class FileSource:
    """A results file that is read, closed between reads since a run may be writing it.

    The rows are those that stood in the file when it was first opened, so that arrays which are
    read one after the other belong together.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        with self._open() as file:
            require_contained(file, [one.name for one in QUANTITIES if one.sparse])
            _check_format(file)
            self.run = _run_of(file)
            self._contents = _read_contents(file)
            self._written = _extent_of(file)

    @property
    def name(self) -> str:
        return str(self._path)

    @property
    def extent(self) -> Extent:
        """How much of it counted when it was first opened."""
        return self._written

    def contents(self) -> Contents:
        return self._contents

    def model(self) -> str:
        with self._open() as file:
            return str(file.attrs["model"])

    def notes(self) -> dict[str, Any]:
        with self._open() as file:
            return dict(file["solver"].attrs)

    def read(self, selections: Sequence[Selection], rows: slice = ALL_ROWS) -> list[Array]:
        with self._open() as file:
            n = self._rows_that_count(file)
            axes = self._contents.axes
            return [
                _rows(file, axes, quantity, entries, n, rows) for quantity, entries in selections
            ]

    def events(self) -> EventRows:
        axes = self._contents.axes
        if "event_owner" not in axes:
            return EventRows.none()
        with self._open() as file:
            self._rows_that_count(file)
            n = self._written.events
            owner, *values = (
                _rows(file, axes, q, None, n) for q in (EVENT_OWNER, *EVENT_QUANTITIES)
            )
        # A damaged file; numbers out of range would count as those of other owners.
        if len(owner) and not 0 <= owner.min() <= owner.max() < len(axes["event_owner"]):
            raise ResultsError(f"{self._path}: variable 'event_of': names no entry of event_owner")
        return EventRows(owner.astype(np.int64), np.column_stack(values))

    def checks(self) -> Array:
        with self._open() as file:
            values: Array = (
                file[CHECK_VALUES_VARIABLE][()] if CHECK_VALUES_VARIABLE in file else np.empty(0)
            )
        return values

    def space(self) -> Space | None:
        with self._open() as file:
            return read_space(file)

    def _rows_that_count(self, file: h5py.File) -> int:
        """Those when it was first opened, or now if there were none."""
        if _run_of(file) != self.run:
            raise ResultsError("another run has replaced this file: read it again")
        if not self._written.rows:
            self._written = _extent_of(file)
        if not self._written.rows:
            raise ResultsError("no step has been written yet")
        return self._written.rows

    @contextmanager
    def _open(self) -> Iterator[h5py.File]:
        with failures_named(self._path, ResultsError):
            recover(resolved(self._path))
            with _opened(self._path, LOCK_WAIT) as file:
                yield file


def netcdf(source: Source) -> Any:
    """The file of results as others open it: its path, or that of results in memory as a stream."""
    if isinstance(source, FileSource):
        source.read([])
        return source.name
    contents, events = source.contents(), source.events()
    (time,) = source.read([(contents.quantities[0], None)])
    extent = Extent(len(time), len(events.owner))
    notes = {**source.notes(), **extent.noted()}
    stream = io.BytesIO(_image(contents, notes, source.model(), len(time)))
    with h5py.File(stream, "r+") as file:
        for quantity in contents.quantities:
            (rows,) = source.read([(quantity, None)])
            _extend(file, quantity.name, rows, 0)
        for name, column in _event_columns(events, 0) if len(events.owner) else ():
            _extend(file, name, column, 0)
        if len(checks := source.checks()):
            file[CHECK_VALUES_VARIABLE][...] = checks
    return stream


class FileWriter:
    """A results file that a run writes, which others can read at any moment, also of a killed run.

    rows: how many there will be, about. Results that stand at the path already stay there until
    this run has ended well: until then it writes to PATH.partial. durable: what was flushed is on
    the disk whatever becomes of the machine. Raises `ResultsError` where the file cannot be
    written, or another run writes it.
    """

    pause = 1.0
    _resumed = False

    def __init__(
        self,
        path: Path,
        contents: Contents,
        notes: Mapping[str, Any],
        model: str,
        rows: int,
        durable: bool = False,
    ) -> None:
        self.run = uuid.uuid4().hex
        # Made in memory first: HDF5 itself brings the process down when the disk is full.
        image = _image(contents, {**notes, **Extent(0).noted(), "run": self.run}, model, rows)
        with _failures_named(path):
            journal = Journal(resolved(path))
            # Earlier results stay until this run has ended well.
            self.place = partial_of(journal.target) if path.exists() else journal.target
            try:
                self.place.write_bytes(image)
            except OSError:
                self.place.unlink(missing_ok=True)
                journal.close()
                raise
        self._open(path, contents, journal, durable)

    @property
    def target(self) -> Path:
        """The file that the results have when the run has ended well."""
        return self._journal.target

    @classmethod
    def resume(
        cls,
        path: Path,
        contents: Contents,
        notes: Mapping[str, Any],
        model: str,
        extent: Extent,
        run: str,
    ) -> Self:
        """Go on with the file of a run that ended early, after so many rows and events.

        Others are dropped. run: the name of that run. `ResultsError` where the file is of another
        one, has other contents, or fewer rows.
        """
        writer = cls.__new__(cls)
        writer.run, writer._resumed = run, True
        with _failures_named(path):
            journal = Journal(resolved(path))
            writer.place = unfinished(journal.target)
            try:
                _check_same_run(writer.place, run, contents, extent)
            except ResultsError:
                journal.close()
                raise
        writer._open(path, contents, journal, durable=True)
        writer._drop(extent, model, notes)
        return writer

    def _open(self, path: Path, contents: Contents, journal: Journal, durable: bool) -> None:
        self.path, self._contents, self._journal = path, contents, journal
        self._store = JournaledFile(self.place, journal, durable)
        self._file = h5py.File(self._store, "r+")
        self.written = self.committed = _extent_of(self._file)
        # The first rows are committed at once, so that readers can open the file early.
        self._last = -np.inf

    def append(self, batch: Batch) -> None:
        axes, (first, n) = self._contents.axes, self.written
        events = batch.events
        with uninterrupted():
            if len(batch.steps):
                for quantity in self._contents.quantities:
                    _extend(self._file, quantity.name, quantity.take(batch, axes), first)
            if len(events.owner):
                for name, column in _event_columns(events, n):
                    _extend(self._file, name, column, n)
            self.written = Extent(first + len(batch.steps), n + len(events.owner))
        if self._store.waiting > MAX_WAITING_BYTES:
            self._commit(LOCK_WAIT)
        elif time.monotonic() - self._last > self.pause:
            with suppress(BusyError):
                self._commit(LOCK_WAIT_OF_RUN, can_wait=True)

    def check(self, values: Array) -> None:
        if len(values):
            with uninterrupted():
                self._file[CHECK_VALUES_VARIABLE][...] = values

    def flush(self) -> None:
        self._commit(LOCK_WAIT)

    def abandon(self) -> bool:
        # A file that was resumed holds rows of the run before.
        if self._resumed or self.place == self._journal.target:
            return False
        self._close()
        self.place.unlink(missing_ok=True)
        return True

    def note(self, **notes: Any) -> None:
        with uninterrupted():
            self._file["solver"].attrs.update(_plain(notes))
        self._commit(LOCK_WAIT)

    def where(self) -> str:
        if self.place == self.target or not self.place.exists():
            return ""
        return f"; its {self.committed.rows} rows are in {self.place}, for an earlier result stays"

    def finish(self) -> None:
        self._close()
        if self.place != self._journal.target:
            with _failures_named(self.path):
                replace_durably(self.place, self._journal.target)
            self.place = self._journal.target
        self._journal.close()

    def leave(self) -> None:
        self._close()
        if self.committed.rows == 0:  # such a file shows nothing
            self.place.unlink(missing_ok=True)
        self._journal.close()

    def _drop(self, extent: Extent, model: str, notes: Mapping[str, Any]) -> None:
        with uninterrupted():
            for quantity in self._contents.quantities:
                self._file[quantity.name].resize(extent.rows, axis=0)
            for quantity in _event_quantities(self._contents):
                self._file[quantity.name].resize(extent.events, axis=0)
            for name, values in _superelement_files(self._contents).items():
                self._file[name][...] = np.array(values, dtype=object)
            self._file.attrs["model"] = model
            self._file["solver"].attrs.update(_plain(notes))
        self.written = extent

    def _commit(self, patience: float, can_wait: bool = False) -> None:
        """Let all rows take place; unless they can wait, also if others never close the file."""
        with self._failures_named(), uninterrupted():
            # Readers count rows by these attributes: datasets are longer while rows are written.
            self._file["solver"].attrs.modify("written", self.written.rows)
            self._file["solver"].attrs.modify("events", self.written.events)
            self._file.flush()
            try:
                self._store.commit(patience)
            except BusyError:
                if can_wait:
                    raise
                self._store.move_to_copy()
                self._store.commit(patience)
        self.committed = self.written
        self._last = time.monotonic()

    @contextmanager
    def _failures_named(self) -> Iterator[None]:
        try:
            with _failures_named(self.place):
                yield
        except ResultsError as error:
            kept = f"; {self.committed.rows} rows are in it" if self.committed.rows else ""
            raise ResultsError(f"{error}{kept}") from error

    def _close(self) -> None:
        """Close without writing: what is not committed is lost."""
        with uninterrupted():
            self._file.close()
            self._store.close()


def unfinished(target: Path) -> Path:
    """The file of the last run to a path: PATH.partial, or the path where there is none."""
    partial = partial_of(target)
    return partial if partial.exists() else target


def _check_same_run(path: Path, run: str, contents: Contents, extent: Extent) -> None:
    source = FileSource(path)
    if source.run != run:
        raise ResultsError(f"{path}: these results are not of the run whose state is beside them")
    for name, found, least in zip(Extent._fields, source.extent, extent, strict=True):
        if found < least:
            raise ResultsError(
                f"{path}: expected {least} {name} or more, as in the state beside it, found {found}"
            )
    if difference := contents.difference(source.contents()):
        raise ResultsError(f"{path}: {difference}")


def _extend(file: h5py.File, name: str, rows: Array, first: int) -> None:
    """Put rows into a variable from `first` on, by the calls of HDF5 itself.

    With the indexing of h5py a write takes twice as long, and others wait for it.
    """
    dataset = h5py.h5d.open(file.id, name.encode())
    shape = rows.shape[1:]
    dataset.set_extent((first + len(rows), *shape))
    space = dataset.get_space()
    space.select_hyperslab((first, *(0 for _ in shape)), rows.shape)
    dataset.write(h5py.h5s.create_simple(rows.shape), space, np.ascontiguousarray(rows))


def _opened(path: Path, patience: float) -> h5py.File:
    """The file, as soon as nobody changes it; `ResultsError` after `patience` seconds."""
    deadline = time.monotonic() + patience
    while True:
        try:
            return h5py.File(path, "r")
        except OSError as error:
            # HDF5 says the one of another process, the other of this one
            held = isinstance(error, BlockingIOError) or "already open" in str(error)
            if not held:
                raise
            if time.monotonic() > deadline:
                raise ResultsError(f"cannot be read: others have it open: {error}") from error
            time.sleep(0.005)


@contextmanager
def _failures_named(path: Path) -> Iterator[None]:
    try:
        yield
    except BusyError:
        raise
    except ResultsError as error:
        raise ResultsError(f"{path}: {error}") from error
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written: {in_words(error)}") from error


def _check_format(file: h5py.File) -> None:
    require_kind(file, RESULTS_FORMAT)
    if not EARLIEST_VERSION <= (version := int(file.attrs.get("version", 0))) <= RESULTS_VERSION:
        raise ResultsError(
            f"results file of version {version}; this Duhamel reads versions {EARLIEST_VERSION} to "
            f"{RESULTS_VERSION}: run the model again"
        )


def _run_of(file: h5py.File) -> str:
    """The name of the run that wrote the file."""
    return str(file["solver"].attrs.get("run", ""))


def _extent_of(file: h5py.File) -> Extent:
    notes = file["solver"].attrs
    extent = Extent(int(notes["written"]), int(notes.get("events", 0)))
    for name, found in zip(("written", "events"), extent, strict=True):
        if found < 0:
            raise ResultsError(f"attribute {name}: expected 0 or more, found {found}")
    return extent


def _text(value: Any) -> Any:
    return value.decode() if isinstance(value, bytes) else value


def _require_distinct(dimension: str, names: tuple[str, ...]) -> None:
    """`ResultsError` for a dimension with two entries of one name, of which none can be found."""
    if len(set(names)) != len(names):
        twice = next(name for number, name in enumerate(names) if name in names[:number])
        raise ResultsError(f"{dimension}: expected different names, found {twice!r} more than once")


def _read_contents(file: h5py.File) -> Contents:
    axes = {name: Axis(_strings(file, name)) for name in DIMENSIONS if name in file}
    del axes["time"]
    axes.pop("event", None)
    for name, axis in axes.items():
        _require_distinct(name, axis.names)
    quantities = tuple(quantity for quantity in QUANTITIES if quantity.name in file)
    events = EVENT_QUANTITIES if "event_owner" in axes else ()
    for quantity in (*quantities, *events):
        if not isinstance(quantity.unit, str) and units_of(quantity) in file:
            name = quantity.measured
            units = {unit: number for number, unit in enumerate(quantity.unit)}
            angular = [units.get(unit, 0) for unit in _strings(file, units_of(quantity))]
            axes[name] = Axis(axes[name].names, tuple(angular))
    bodies = axes.pop("flexible_body", Axis(())).names
    superelements: dict[str, SuperelementFile] = {}
    if bodies:
        paths, digests = (_strings(file, f"superelement_{of}") for of in ("file", "sha256"))
        # Only files of runs with such bodies have it.
        varied = "superelement_variation" in file
        texts = _strings(file, "superelement_variation") if varied else [""] * len(paths)
        files = (
            SuperelementFile(path, digest, variation=text)
            for path, digest, text in zip(paths, digests, texts, strict=True)
        )
        superelements = dict(zip(bodies, files, strict=True))
    checks = axes.pop("check", Axis(())).names
    version = int(file.attrs["version"])
    return Contents(axes, quantities, superelements, checks, version=version)


def _strings(file: h5py.File, name: str) -> tuple[str, ...]:
    """The entries of a dimension; none of time, whose variable holds numbers."""
    dataset = file[name]
    if not isinstance(dataset, h5py.Dataset) or dataset.ndim != 1:
        raise ResultsError(f"variable {name!r}: expected a list")
    return tuple(texts(dataset)) if dataset.dtype.kind == "O" else ()


def _rows(
    file: h5py.File,
    axes: Axes,
    quantity: Quantity,
    entries: Any,
    written: int,
    rows: slice = ALL_ROWS,
) -> Array:
    first, last, _ = rows.indices(written)
    if isinstance(entries, slice) and entries.start == entries.stop:
        return np.zeros((last - first, 0))
    dataset = file.get(quantity.name)
    if not isinstance(dataset, h5py.Dataset) or dataset.dtype.kind not in "fi":
        raise ResultsError(f"variable {quantity.name!r}: expected numbers, found none")
    shape = quantity.shape(axes)
    if dataset.shape[1:] != shape or len(dataset) < written:
        raise ResultsError(
            f"variable {quantity.name!r}: expected shape {(written, *shape)}, found {dataset.shape}"
        )
    chosen: Array = dataset[first:last] if entries is None else dataset[first:last, entries]
    return chosen


def units_of(quantity: Quantity) -> str:
    """The variable with the units of its entries."""
    return f"{quantity.name}_units"


def _image(contents: Contents, notes: Mapping[str, Any], model: str, rows: int) -> bytes:
    """The bytes of a file without rows."""
    # HDF5 refuses a second file of the same name, such as that of a run in another thread.
    name = f"image-{notes.get('run', id(contents))}"
    with h5py.File(name, "w", driver="core", backing_store=False, track_order=True) as file:
        file.attrs.update(
            Conventions="CF-1.11",
            format=RESULTS_FORMAT,
            version=RESULTS_VERSION,
            created_by=f"duhamel {metadata.version('duhamel')}",
            model=model,
        )
        axes = dict(contents.axes)
        if contents.superelements:
            axes["flexible_body"] = Axis(tuple(contents.superelements))
        if contents.checks:
            axes["check"] = Axis(contents.checks)
        scales = {name: _put_strings(file, name, axis.names) for name, axis in axes.items()}
        scales["time"] = _create(file, contents.quantities[0], axes, rows)
        if _event_quantities(contents):
            scales["event"] = _create(file, EVENT_NUMBER, axes, rows)
        for name, scale in scales.items():
            scale.make_scale(name)
            if name != "time":
                scale.attrs["long_name"] = DIMENSIONS[name].description
        for quantity in (*contents.quantities[1:], *_event_quantities(contents)[1:]):
            _attach(_create(file, quantity, axes, rows), quantity.dimensions, scales)
            _put_units(file, quantity, axes, scales)
        for name, values in _superelement_files(contents).items():
            _attach(_put_strings(file, name, values), ("flexible_body",), scales)
        if contents.checks:
            values = file.create_dataset(
                CHECK_VALUES_VARIABLE, data=np.full(len(contents.checks), np.nan)
            )
            values.attrs["long_name"] = "what the run has passed at most"
            _attach(values, ("check",), scales)
        if contents.space is not None:
            put_space(file, contents.space)
        file.create_group("solver").attrs.update(_plain(notes))
        file.flush()
        image: bytes = file.id.get_file_image()
    return image


def _event_quantities(contents: Contents) -> tuple[Quantity, ...]:
    """The variables of events, if the run has any."""
    return (EVENT_NUMBER, EVENT_OWNER, *EVENT_QUANTITIES) if "event_owner" in contents.axes else ()


def _event_columns(events: EventRows, first: int) -> Iterator[tuple[str, Array]]:
    """The variables of events, whose numbers go on from the first."""
    m = len(events.owner)
    columns = (np.arange(first, first + m), events.owner, *events.values.T)
    for quantity, column in zip(
        (EVENT_NUMBER, EVENT_OWNER, *EVENT_QUANTITIES), columns, strict=True
    ):
        yield quantity.name, column.astype(_type_of(quantity))


def _type_of(quantity: Quantity) -> type:
    return np.int64 if quantity.integer else np.float64


def _put_units(
    file: h5py.File, quantity: Quantity, axes: Axes, scales: Mapping[str, h5py.Dataset]
) -> None:
    """The variable with the units of its entries, where they may differ."""
    if not isinstance(quantity.unit, str):
        units = _put_strings(file, units_of(quantity), quantity.units(axes))
        _attach(units, (quantity.measured,), scales)


def _create(file: h5py.File, quantity: Quantity, axes: Axes, rows: int) -> h5py.Dataset:
    """A variable without rows, of which there will be so many over time."""
    shape = quantity.shape(axes)
    if quantity.dimensions[0] != "time":
        rows = CHUNK_EVENTS
    dataset = file.create_dataset(
        quantity.name,
        shape=(0, *shape),
        maxshape=(None, *shape),
        chunks=chunks(shape, rows),
        dtype=_type_of(quantity),
        fillvalue=None if quantity.integer else np.nan,
        compression=1 if quantity.sparse else None,
    )
    dataset.attrs["long_name"] = quantity.description
    units = set(quantity.units(axes))
    if len(units) == 1:
        dataset.attrs["units"] = units.pop()
    if not isinstance(quantity.unit, str):
        dataset.attrs["ancillary_variables"] = units_of(quantity)
    return dataset


def chunks(shape: tuple[int, ...], rows: int) -> tuple[int, ...]:
    """The shape of chunks of about `ROW_CHUNK_BYTES` bytes for some rows of a shape.

    Wide rows are divided among the owners, so that one of many bodies is read without the others.
    """
    width = 8 * int(np.prod(shape))
    n = max(min(rows, max(ROW_CHUNK_BYTES // width, MIN_CHUNK_ROWS)), 1)
    if not shape:
        return (n,)
    owners = max(min(shape[0], ROW_CHUNK_BYTES * shape[0] // (n * width)), 1)
    return (n, owners, *shape[1:])


def _superelement_files(contents: Contents) -> dict[str, list[str]]:
    """Variables with the path and the digest of the superelement of each flexible body, if any."""
    files = [found.hashed() for found in contents.superelements.values()]
    if not files:
        return {}
    varied = [found.variation for found in files]
    return {
        "superelement_file": [found.path for found in files],
        "superelement_sha256": [found.digest for found in files],
        **({"superelement_variation": varied} if any(varied) else {}),
    }


def _put_strings(file: h5py.File, name: str, values: Sequence[str]) -> h5py.Dataset:
    return file.create_dataset(name, data=np.array(values, dtype=object), dtype=TEXT_OF_RESULTS)


def _attach(
    dataset: h5py.Dataset, dimensions: Sequence[str], scales: Mapping[str, h5py.Dataset]
) -> None:
    for axis, name in enumerate(dimensions):
        h5py.h5ds.attach_scale(dataset.id, scales[name].id, axis)


def _plain(notes: Mapping[str, Any]) -> dict[str, Any]:
    """Notes as netCDF can hold them, which has no booleans."""
    return {key: int(value) if isinstance(value, bool) else value for key, value in notes.items()}
