"""All that a run carries from one step to the next, as arrays by name."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ..compiler.struct import Struct
from ..errors import StateError

Arrays = Mapping[str, Any]
"""arrays by name, as "state/bodies/x" """
BY_STEP = frozenset({"state/past/p", "state/past/u_ahead"})
"""arrays with a column for each step that is kept: longer runs have more of them"""
FMUS_PREFIX = "fmus/"
"""names of what FMUs carry on begin with it"""


def carried(**records: Struct) -> dict[str, Any]:
    """The arrays of records, by the name of the record and of the field."""
    return {
        f"{name}/{field}": array
        for name, record in records.items()
        for field, array in record.leaves()
        if isinstance(array, np.ndarray)
    }


def with_prefix(prefix: str, arrays: Arrays) -> dict[str, Any]:
    """Arrays by longer names, so that others can stand beside them."""
    return {f"{prefix}{name}": array for name, array in arrays.items()}


class Snapshot(NamedTuple):
    """Copies of arrays after a step."""

    step: int
    arrays: Arrays

    @classmethod
    def of(cls, step: int, live: Arrays) -> "Snapshot":
        return cls(step, {name: array.copy() for name, array in live.items()})

    def split(self, prefix: str) -> "tuple[Snapshot, dict[str, Any]]":
        """The arrays whose names do not begin with a prefix, and the others without it."""
        own = {name: array for name, array in self.arrays.items() if not name.startswith(prefix)}
        others = self.arrays.keys() - own.keys()
        return Snapshot(self.step, own), {
            name.removeprefix(prefix): self.arrays[name] for name in others
        }

    def put_back(self, live: Arrays) -> None:
        """Let arrays have the values of these; `StateError` where the shapes do not fit."""
        # Arrays of one side alone: the state is of another version, and all else would be a guess.
        if odd := sorted(self.arrays.keys() ^ live.keys()):
            raise StateError(f"state: expected the arrays of this version, found others: {odd[0]}")
        for name, array in live.items():
            fit(name, self.arrays[name], array)


def fit(name: str, kept: Any, array: Any) -> None:
    """Copy an array that was kept; columns of steps that it has not are zero."""
    if name in BY_STEP and kept.ndim == array.ndim and len(kept) == len(array):
        n = min(kept.shape[1], array.shape[1])
        # Columns of later steps may still have values of the run that is left.
        array[...] = 0.0
        array[:, :n] = kept[:, :n]
    elif kept.shape == array.shape and kept.dtype == array.dtype:
        array[...] = kept
    else:
        raise StateError(
            f"{name}: expected {array.dtype} {array.shape}, found {kept.dtype} {kept.shape}"
        )
