"""What a run writes its results to, and the notes that it begins with."""

from pathlib import Path
from typing import Any

from ...results.file import FileSource, FileWriter
from ...results.results import Results
from ...results.source import Memory, Writer
from ...superelement import Superelement
from ..errors import ResultsError
from ..lower.lower import CompiledModel
from ..model.model import Model
from ..start.initial import Beginning
from .columns import requested


def check_output(path: Path, model: Model) -> None:
    """`ResultsError` for a place where no results can be, and for an input of the run."""
    if not path.parent.is_dir():
        raise ResultsError(f"{path}: no folder {path.parent}")
    if not path.exists():
        return
    if not path.is_file():
        raise ResultsError(f"{path}: cannot be written: not a regular file")
    inputs = {str(model.path): "the model file"}
    for name, body in model.flexible_bodies.items():
        inputs[body.source] = f"the superelement of body {name!r}"
    for file, what in inputs.items():
        if file and Path(file).exists() and path.samefile(file):
            raise ResultsError(f"{path}: this is {what}, which the results would replace")


def make_writer(path: Path | None, beginning: Beginning, steps: int) -> Writer:
    """Of the file at a path, or of memory where there is none; `ResultsError` for a file that
    cannot be written.
    """
    compiled = beginning.compiled
    contents, notes = requested(compiled), _notes(beginning, steps)
    if path is None:
        return Memory(contents, notes, compiled.model.source)
    return FileWriter(path, contents, notes, compiled.model.source, rows_of(compiled))


def read_back(path: Path | None, writer: Writer, model: Model) -> Results:
    """The results that were written."""
    source = writer if isinstance(writer, Memory) else FileSource(path or Path())
    return Results(source, _superelements(model))


def rows_of(compiled: CompiledModel) -> int:
    """How many rows a run records, the first and the last step included, or one more."""
    return compiled.n_steps // compiled.model.output.every + 2


def _superelements(model: Model) -> dict[str, Superelement]:
    """The superelements that fields can be made of; those of a file are left there until a field is
    asked for, unless all of them is here already.
    """
    return {
        name: body.superelement
        for name, body in model.flexible_bodies.items()
        if body.superelement.recovery is not None or not body.source
    }


def _notes(beginning: Beginning, steps: int) -> dict[str, Any]:
    compiled, model = beginning.compiled, beginning.compiled.model
    return {
        "h": compiled.h,
        "rho_inf": compiled.scheme.rho_inf,
        "steps": steps,
        "rule": model.rule,
        "start": model.start,
        "every": model.output.every,
        "finished": False,
        "degrees_of_freedom": beginning.degrees_of_freedom,
        "opening": beginning.misfit.opening,
        "opening_at": beginning.misfit.opening_at,
        "velocity_misfit": beginning.misfit.velocity,
        "velocity_misfit_at": beginning.misfit.velocity_at,
        "moved": beginning.moved,
        "velocity_correction": beginning.velocity_correction,
        "removed": beginning.removed,
        "truncation": compiled.truncation,
    }
