"""Records whose numbers have derivatives, for code that is compiled with them."""

import ctypes
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from ..arrays import Array, Index
from ..compiler import marks
from ..compiler.object_file import BuildError, compiler, engine_of, object_files
from ..compiler.struct import ArrayField, Struct
from ..compiler.targets import target_with_derivatives
from ..errors import DerivativeError

MAX_RESULTS = 4
"""numbers that an entry returns"""


class DualRecord:
    """The words of a record, with copies of its arrays in which k derivatives follow each number.

    arrays: by their names in the record, as "bodies/mass", (..., 1 + k) where numbers have
    derivatives.
    """

    def __init__(
        self,
        record: Struct,
        k: int,
        seeds: Mapping[str, Array],
        beside: "DualRecord | None" = None,
    ) -> None:
        """seeds (..., k): the derivatives of arrays by name; others are constant.

        beside: that of a record with which this one shares arrays.
        """
        self.words: Index = record.words.copy()
        self.arrays: dict[str, Any] = {}
        self._record = record
        cls: Any = type(record)
        names = array_names(cls)
        for name, (at, array), (_, field) in zip(
            names, record.pointers(), cls.array_fields(), strict=True
        ):
            made = array.copy()
            if beside is not None and beside._record.words[at] == record.words[at]:
                made = beside.arrays[name]
            elif has_derivatives(field):
                made = np.zeros((*array.shape, 1 + k))
                made[..., 0] = array
                if name in seeds:
                    made[..., 1:] = seeds[name]
            self.arrays[name] = made
            self.words[at] = made.ctypes.data

    @property
    def address(self) -> int:
        return int(self.words.ctypes.data)

    def part(self, name: str) -> int:
        """The address of a record within this."""
        return self.address + self.words.itemsize * int(self._record.layout[name][0])


def has_derivatives(field: ArrayField) -> bool:
    """Whether the numbers of an array have them."""
    return bool(field.dtype == np.float64) and not field.is_real


@cache
def array_names(cls: type[Struct]) -> tuple[str, ...]:
    """The names of all arrays of a record, in the order of `Struct.array_fields`."""
    found: list[str] = []
    for name, (_, kind) in cls.layout.items():
        if isinstance(kind, ArrayField):
            found.append(name)
        elif kind not in (float, int, bool):
            found += [f"{name}/{below}" for below in array_names(kind)]
    return tuple(found)


def entry_symbol(entry: Any) -> str:
    """The name of an entry in object files."""
    return str(entry.symbol)


@cache
def entry_with_derivatives(symbol: str, k: int, surfaces: bool) -> Callable[..., list[float]]:
    """An entry of numbers with k derivatives, by its symbol; surfaces: with their contacts.

    It is built at its first use. `DerivativeError` where numba cannot build it.
    """
    if (found := compiler()) in ("none", "stock"):
        how = "as Python" if found == "none" else "by numba's public interface"
        raise DerivativeError(f"the time step runs {how} here, without derivatives")
    target = target_with_derivatives(k, surfaces)
    try:
        code = object_files([target])[target]
    except BuildError as error:
        raise DerivativeError(f"the time step cannot be built with derivatives: {error}") from error
    entry = marks.DIFFERENTIABLE_ENTRIES[symbol]
    numbers: dict[Any, Any] = {int: ctypes.c_int64, float: ctypes.c_double}
    kinds: list[Any] = [numbers.get(kind, ctypes.c_void_p) for kind in entry.arguments.values()]
    function = ctypes.CFUNCTYPE(None, ctypes.c_void_p, *kinds)(
        _engine(code).get_function_address(symbol)
    )

    def call(*arguments: DualRecord | float) -> list[float]:
        results = (ctypes.c_double * MAX_RESULTS)()
        words = [one.address if isinstance(one, DualRecord) else one for one in arguments]
        function(ctypes.addressof(results), *words)
        return list(results)

    return call


@cache
def _engine(code: bytes) -> Any:
    return engine_of(code)
