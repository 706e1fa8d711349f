"""The destination of the results of a run, and the notes at its head."""

import os
from collections.abc import Iterator
from dataclasses import replace
from math import isfinite
from pathlib import Path
from typing import Any, cast

from ...files import FileError, require_regular
from ...files.outputs import clash, in_words
from ...results.contents import Contents
from ...results.file import Extent, FileSource, FileWriter
from ...results.results import Results
from ...results.source import Memory, Source, Writer
from ...superelement import Superelement, sha256
from ..checkpoint.carried import Snapshot
from ..checkpoint.file import STATE_SUFFIX, StateFile
from ..errors import ResultsError
from ..lower.lower import LoweredModel
from ..model.bodies import FlexibleBody, RigidSuperelement
from ..model.model import Model
from ..model.settings import StartFrom
from ..signals.recorded import records_of
from ..start.damping import damping_of
from ..start.initial import InitialState
from .columns import requested
from .inputs import drifts
from .size import check_memory
from .space import space_of
from .validity import ValidityMonitor, finest_step


def check_output(path: Path, model: Model) -> None:
    """`ResultsError` for a path that cannot hold results, or that is an input of the run."""
    if not path.parent.is_dir():
        raise ResultsError(f"{path}: no folder {path.parent}")
    try:
        require_regular(path)
    except FileNotFoundError:
        return
    except (FileError, OSError) as error:
        raise ResultsError(f"{path}: cannot be written: {in_words(error)}") from error
    inputs: dict[str | os.PathLike[str], str] = {model.path: "the model file"}
    for name, body in model.bodies.items():
        if isinstance(body, FlexibleBody | RigidSuperelement):
            inputs[body.source] = f"the superelement of body {name!r}"
    for record in records_of(model):
        inputs[record.file] = "a record that the model follows"
    for fmu in model.fmus:
        inputs[fmu.file] = "an FMU of the model"
    if isinstance(start := model.settings.start, StartFrom):
        run = Path(start.path)
        inputs[run] = "the run that the model starts from"
        inputs[run.with_name(run.name + STATE_SUFFIX)] = "the state that the model starts from"
    if found := clash([path], inputs):
        raise ResultsError(f"{found}, which the results would replace")


def make_writer(
    path: Path | None, initial: InitialState, steps: int, monitor: ValidityMonitor
) -> Writer:
    """A writer to the file at a path, or to memory where the path is None.

    `ResultsError` for a file that cannot be written.
    """
    lowered, model = initial.lowered, initial.lowered.model
    contents, notes = contents_of(lowered, monitor), _notes(initial, steps)
    if path is None:
        every = lowered.ratio * model.settings.output.every
        check_memory(contents, steps // every + 1)
        return Memory(contents, notes, model.source)
    durable = model.settings.checkpoint is not None
    return FileWriter(path, contents, notes, model.source, rows_of(lowered), durable)


def resume_writer(
    path: Path, lowered: LoweredModel, state: StateFile, monitor: ValidityMonitor
) -> FileWriter:
    """A writer that goes on with the file at a path after the rows of a state.

    `ResultsError` for a file that does not belong to the state.
    """
    extent = extent_at(state.snapshot, int(state.notes["first"]), lowered)
    steps = lowered.n_steps // lowered.ratio
    notes = {"steps": steps, "truncation": _truncation(lowered), "finished": False}
    notes |= _notes_of_signals(lowered, lowered.n_steps)
    contents, source = contents_of(lowered, monitor), lowered.model.source
    return FileWriter.resume(path, contents, notes, source, extent, state.run)


def contents_of(lowered: LoweredModel, monitor: ValidityMonitor) -> Contents:
    """The requested contents, the checks of validity, and the bodies in space."""
    contents = requested(lowered, monitor.names)
    bodies = contents.axes["body"].names if "body" in contents.axes else ()
    return replace(contents, space=space_of(lowered, bodies))


def _truncation(lowered: LoweredModel) -> float:
    return float(lowered.responses.truncations.max(initial=0.0))


def read_back(writer: Writer, model: Model) -> Results:
    """The results that were written."""
    source = FileSource(writer.path) if isinstance(writer, FileWriter) else writer
    return Results(cast(Source, source), _superelements(model))


def rows_of(lowered: LoweredModel) -> int:
    """The number of rows that a run records, first and last step included, or one more."""
    return lowered.n_steps // (lowered.ratio * lowered.model.settings.output.every) + 2


def recorded_every(state: Snapshot, lowered: LoweredModel) -> int:
    """The interval of the rows before a state, in steps as the run counts them."""
    in_flight = bool(state.arrays["state/in_flight"][0])
    return lowered.model.settings.output.every * (lowered.ratio if in_flight else 1)


def extent_at(state: Snapshot, first: int, lowered: LoweredModel) -> Extent:
    """The rows and events of a run up to a state, whose last step is recorded in any case."""
    arrays, step = state.arrays, state.step
    last = first < step == lowered.n_steps and step % recorded_every(state, lowered) > 0
    rows = 1 + int(arrays["state/recorded"][0]) + int(last)
    return Extent(rows, int(arrays["state/contacts/ended"].sum()))


def _superelements(model: Model) -> dict[str, Superelement]:
    """The superelements that are in memory with all that fields need.

    Others are read again from their files when a field is asked for.
    """
    return {
        name: body.superelement
        for name, body in model.flexible_bodies.items()
        if body.superelement.recovery is not None or not body.source
    }


def _notes(initial: InitialState, steps: int) -> dict[str, Any]:
    lowered, model = initial.lowered, initial.lowered.model
    start = model.settings.start
    return (
        {
            "h": lowered.longest_step,
            "rho_inf": lowered.scheme.rho_inf,
            "steps": steps // lowered.ratio,
            "rule": model.settings.rule,
            "start": str(start.path if isinstance(start, StartFrom) else start),
            "every": model.settings.output.every,
            "finished": False,
            "degrees_of_freedom": initial.degrees_of_freedom,
            "assembly_error": initial.assembly_error.opening,
            "assembly_error_at": initial.assembly_error.opening_at,
            "velocity_error": initial.assembly_error.velocity,
            "velocity_error_at": initial.assembly_error.velocity_at,
            "moved": initial.moved,
            "velocity_correction": initial.velocity_correction,
            "removed": initial.removed.names,
            "truncation": _truncation(lowered),
            "damping": damping_of(initial),
            "finest_step": finest_step(lowered),
        }
        | _notes_of_contacts(lowered)
        | _notes_of_signals(lowered, steps)
    )


def _surfaces(model: Model) -> Iterator[str]:
    for contact in model.surface_contacts:
        yield f"{contact.surfaces[0]} {contact.name}"
        if contact.meets_surface:
            yield f"{contact.surfaces[1]} "


def _notes_of_contacts(lowered: LoweredModel) -> dict[str, Any]:
    """The step in contacts, of runs with two sizes of steps."""
    return {} if lowered.flight is None else {"contact_step": lowered.h}


def _notes_of_signals(lowered: LoweredModel, steps: int) -> dict[str, Any]:
    """Notes that only some runs have.

    drift: lines about coordinates that are driven by their velocity or acceleration; records: the
    digests of the files of recorded signals, and of the superelements of rigid bodies; bands: a
    line for each flexible body whose superelement is right up to a frequency [Hz]; surfaces: a line
    for each surface in contact, with the contact that has rows at its nodes.
    """
    bands = [element.band for element in lowered.superelements]
    of_bodies = zip(bands, lowered.model.flexible_bodies, strict=True)
    bodies = lowered.model.bodies.values()
    rigid = [b.source for b in bodies if isinstance(b, RigidSuperelement) and b.source]
    files = {record.digest for record in records_of(lowered.model)} | set(map(sha256, rigid))
    files |= {fmu.digest for fmu in lowered.model.fmus}
    notes = {
        "contact_h": lowered.h if lowered.flight else None,
        "drift": "\n".join(map(str, drifts(lowered, steps * lowered.h))),
        "records": " ".join(sorted(files)),
        "surfaces": "\n".join(_surfaces(lowered.model)),
        "bands": "\n".join(f"{band!r} {name}" for band, name in of_bodies if isfinite(band)),
    }
    return {name: note for name, note in notes.items() if note}
