"""Results as a MATLAB file (version 5): a structure for each group, with one for each owner."""

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from ...files.arrays import Array
from ...files.memory import gigabytes, shortage
from ..contents import attributes_of
from ..errors import ExportError
from ..motion import EVENT_QUANTITIES, OWNERS_OF_GROUP
from ..quantity import Quantity
from ..results import Results
from .folder import distinct, exported

# Files of version 5 count the bytes of a variable in a signed integer of 32 bits.
MAX_VARIABLE_BYTES = (1 << 31) - 1
# MATLAB's namelengthmax.
MAX_MATLAB_NAME = 63
# What cannot be a name: it begins with no letter, or is a keyword.
NO_MATLAB_NAME = re.compile(
    "[^A-Za-z].*|(break|case|catch|classdef|continue|else|elseif|end|for|function|global|if|"
    "otherwise|parfor|persistent|return|spmd|switch|try|while)?"
)
Struct = dict[str, Any]


def write_mat(results: Results, path: str | os.PathLike[str], rows: slice = slice(None)) -> Path:
    """Write all that was recorded as a MATLAB file of version 5.

    It has `time` (n, 1) [s], and structures: bodies.hub.v, frames.beam_tip.u, joints.pivot.angle,
    energy.kinetic, events.stop.peak, ... with the attributes of `Results.body` and its neighbors;
    in each the owner's own `name`, and `units` by attribute. `run` has the notes of the run,
    `model` the text of the model file.

    Parameters
    ----------
    results : Results
    path : path
    rows : slice
        Of the recorded steps.

    Returns
    -------
    Path

    Raises
    ------
    ExportError
        Where a group has more than 2 GB, or the file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import duhamel as du
    >>> from scipy.io import loadmat
    >>> m = du.Mechanism()
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.5).results
    >>> with TemporaryDirectory() as folder:
    ...     loadmat(write_mat(results, f"{folder}/run.mat"))["time"].ravel().tolist()
    [0.0, 0.5, 1.0]
    """
    from scipy.io import savemat

    target = Path(path)
    _require_room(results, target, rows)
    variables: Struct = {"time": _column(results.variable("time", rows)), **_owned(results, rows)}
    for group in ("energy", "momentum", "solver"):
        if found := _without_owners(results, group, rows):
            variables[group] = found
    if events := _events(results):
        variables["events"] = events
    variables["run"] = _struct(results.solver)
    variables["model"] = results.model
    with (
        exported(target.parent) as export,
        export.file(target.name) as temporary,
        temporary.open("wb") as file,
    ):
        savemat(file, variables, long_field_names=True)
    return target


def identifiers(names: Iterable[str]) -> list[str]:
    """Names as MATLAB takes them: letters, digits and `_`, a letter first, no two the same.

    Others become `_`, and an x stands before a name that begins with no letter or is a keyword.
    """
    words = [re.sub(r"\W", "_", name, flags=re.ASCII) for name in names]
    named = (f"x{word}" if NO_MATLAB_NAME.fullmatch(word) else word for word in words)
    return distinct(named, MAX_MATLAB_NAME)


def _require_room(results: Results, target: Path, rows: slice) -> None:
    axes, n = results.contents.axes, len(range(*rows.indices(len(results.time))))
    sizes: dict[str, int] = {}
    for quantity in results.contents.quantities:
        size = 8 * n * int(np.prod(quantity.shape(axes)))
        sizes[quantity.group] = sizes.get(quantity.group, 0) + size
    largest = max(sizes, key=lambda group: sizes[group])
    if sizes[largest] > MAX_VARIABLE_BYTES:
        raise ExportError(
            f"{target}: {largest} would take {gigabytes(sizes[largest])}, and a MATLAB file of "
            f"version 5 holds 2 GB a variable: export fewer steps, or read the results file itself "
            f"with MATLAB's ncread"
        )
    # once as arrays, once as the bytes of the largest group
    if lacking := shortage(sum(sizes.values()) + sizes[largest]):
        raise ExportError(f"{target}: {lacking}: export fewer steps")


def _owned(results: Results, rows: slice) -> Struct:
    """A structure for each group with owners."""
    contents = results.contents
    groups: Struct = {}
    for group, dimension in OWNERS_OF_GROUP.items():
        if dimension in contents.axes:
            owners = contents.axes[dimension].names
            variables = {
                quantity.name: results.variable(quantity.name, rows)
                for quantity in contents.quantities
                if quantity.group == group
            }
            structs = [_owner(results, group, owner, variables) for owner in owners]
            groups[group] = dict(zip(identifiers(owners), structs, strict=True))
    return groups


def _owner(results: Results, group: str, owner: str, variables: dict[str, Array]) -> Struct:
    """The attributes of an owner, those of one name joined along the last axis."""
    joined: dict[str, list[Array]] = {}
    contents = results.contents
    found = attributes_of(contents.quantities, contents.axes, group, owner)
    for attribute, quantity, entries in found:
        array = variables[quantity.name][:, entries]
        joined.setdefault(attribute, []).append(_column(array))
    arrays = {attribute: np.hstack(parts) for attribute, parts in joined.items()}
    units = {attribute: results.unit(group, owner, attribute) for attribute in arrays}
    return _struct({"name": owner, **arrays}, units)


def _without_owners(results: Results, group: str, rows: slice) -> Struct:
    found: list[Quantity] = [q for q in results.contents.quantities if q.group == group]
    arrays = {q.attribute: _column(results.variable(q.name, rows)) for q in found}
    return _struct(arrays, {q.attribute: str(q.unit) for q in found}) if arrays else {}


def _events(results: Results) -> Struct:
    """The events of each contact and stop."""
    events = results.events
    structs = []
    for owner, of_owner in events.items():
        arrays = {
            one.attribute: _column(getattr(of_owner, one.attribute)) for one in EVENT_QUANTITIES
        }
        units = {name: results.unit("events", owner, name) for name in arrays}
        structs.append(_struct({"name": owner, **arrays}, units))
    return dict(zip(identifiers(events), structs, strict=True))


def _struct(values: Struct, units: dict[str, str] | None = None) -> Struct:
    """Values, and their units, under names that MATLAB takes."""
    named = dict(zip(identifiers(values), values.values(), strict=True))
    if units is not None:
        named["units"] = dict(zip(identifiers(units), units.values(), strict=True))
    return named


def _column(array: Array) -> Array:
    """Numbers (n,) as a column (n, 1), as MATLAB has series."""
    return array[:, None] if array.ndim == 1 else array
