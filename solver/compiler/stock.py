"""The same functions compiled by numba's public interface alone, in minutes.

Records become named tuples of numbers and arrays, which numba passes value by value: this is what
takes so long. `build` makes such code in seconds, by numba's internals; the results of both differ
by rounding, for sums may be reordered.
"""

from collections import namedtuple
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.extending import overload

from .calls import call_intrinsic
from .foreign import call_by_address
from .marks import COMPILED_ENTRIES, COMPILED_FUNCTIONS
from .struct import Struct

STOCK_OPTIONS: dict[str, Any] = {
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract"},
    "forceinline": True,
    "_nrt": False,
}


def bind(folder: Path | None) -> None:
    """Give every entry a function compiled at its first call; its code is cached in the folder."""
    entries = {entry.function: entry for entry in COMPILED_ENTRIES.values()}
    for function in COMPILED_FUNCTIONS:
        implementation = _returned(STOCK_INTRINSICS.get(function, function))
        overload(function, jit_options=STOCK_OPTIONS, strict=False)(implementation)
        if function in entries:
            overload(entries[function], jit_options=STOCK_OPTIONS, strict=False)(implementation)
    others, numba.config.CACHE_DIR = numba.config.CACHE_DIR, str(folder or "")
    try:
        for entry in COMPILED_ENTRIES.values():
            jitted = numba.njit(entry.function, cache=folder is not None, **STOCK_OPTIONS)
            entry.call = _unpacking(jitted)
    finally:
        numba.config.CACHE_DIR = others


def _vector(context: Any, builder: Any, type_: Any, value: Any) -> tuple[Any, Any]:
    """Address and length of an array of one dimension."""
    array = context.make_array(type_)(context, builder, value)
    return array.data, builder.extract_value(array.shape, 0)


_call = call_intrinsic(_vector)


def _call_by_address(
    address: float, parameters: Any, memory: Any, h: float, c: float, rate: float
) -> Any:
    return _call(address, parameters, memory, h, c, rate)


STOCK_INTRINSICS: dict[Any, Any] = {call_by_address: _call_by_address}


def _returned(function: Any) -> Any:
    def implementation(*args: Any) -> Any:
        return function

    return implementation


def _unpacking(jitted: Any) -> Any:
    def call(*args: Any) -> Any:
        return jitted(*(as_tuple(arg) if isinstance(arg, Struct) else arg for arg in args))

    return call


def as_tuple(record: Struct) -> Any:
    """A record as a named tuple, records within included; made once, for a record never changes."""
    if "as_tuple" not in record.__dict__:
        values = (getattr(record, name) for name in record.layout)
        parts = [as_tuple(value) if isinstance(value, Struct) else value for value in values]
        cls: Any = type(record)
        record.__dict__["as_tuple"] = _tuple_type(cls)(*parts)
    return record.__dict__["as_tuple"]


@cache
def _tuple_type(cls: Any) -> Any:
    return namedtuple(cls.__name__, cls.layout)
