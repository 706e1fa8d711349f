"""Marks of functions that run as machine code: `compiled`, and `entry` for those that Python calls.

Compiled code reads records and arrays and returns numbers. It allocates nothing, raises nothing,
takes no negative index (none is wrapped) and no slice but at the end of an index. With
NUMBA_DISABLE_JIT=1 in the environment all of it runs as plain Python, for debugging and coverage.
"""

import ctypes
import inspect
from collections.abc import Callable
from typing import Any, TypeVar, cast, get_args

from .struct import ArrayField, Struct, field_kind

Function = TypeVar("Function", bound=Callable[..., Any])

COMPILED: dict[Callable[..., Any], None] = {}
"""all functions that are compiled, entries included, in the order of their definition"""
ENTRIES: dict[str, "Entry"] = {}
"""entries by the name that they have in the object file"""


def compiled(function: Function) -> Function:
    """Register a function that compiled code calls; called from Python, it runs as Python."""
    COMPILED[function] = None
    return function


def entry(function: Function) -> Function:
    """Register a compiled function that Python calls too, with the arguments that it annotates."""
    COMPILED[function] = None
    made = Entry(function)
    ENTRIES[made.symbol] = made
    return cast(Function, made)


class Entry:
    """Calls the machine code of a function, which is found or built at the first call.

    In the object file it is a function of words: `void symbol(double *results, words...)`; a record
    is its address, an array its address and variable dimensions.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.symbol = f"{function.__module__}.{function.__name__}".replace(".", "_")
        self.__name__, self.__doc__ = function.__name__, function.__doc__
        signature = inspect.signature(function)
        self.kinds = [field_kind(p.annotation) for p in signature.parameters.values()]
        returned = signature.return_annotation
        parts = get_args(returned) or (() if returned is None else (returned,))
        self.returned: list[type] = [float if part is float else part for part in parts]
        self.call: Callable[..., Any] | None = None
        """the function in the object file"""
        self.direct: Callable[..., Any] | None = None
        """takes the arguments as they are, in place of the object file"""
        self._takes_records_alone = all(
            isinstance(kind, type) and issubclass(kind, Struct) for kind in self.kinds
        )
        self._results = ctypes.c_double * max(1, len(parts))

    def __call__(self, *args: Any) -> Any:
        if self.call is None:
            if self.direct is None:
                self.bind()
            if self.direct is not None:
                return self.direct(*args)
        if self._takes_records_alone:
            words = [record.address for record in args]
        else:
            words = self._words(args)
        results = self._results()
        self.call(results, *words)  # type: ignore[misc]
        if not self.returned:
            return None
        if len(self.returned) == 1:
            return self.returned[0](results[0])
        return tuple(kind(value) for kind, value in zip(self.returned, results, strict=True))

    def bind(self) -> None:
        """Load the machine code of all entries, or build it."""
        from .object_file import load

        load()

    @property
    def is_bound(self) -> bool:
        return self.call is not None or self.direct is not None

    def _words(self, args: Any) -> list[Any]:
        words: list[Any] = []
        for kind, value in zip(self.kinds, args, strict=True):
            if isinstance(kind, ArrayField):
                words += kind.words(value)
            elif isinstance(value, Struct):
                words.append(value.address)
            else:
                words.append(value)
        return words

    @property
    def argument_types(self) -> list[Any]:
        """Of the function in the object file, for ctypes."""
        types: list[Any] = [ctypes.POINTER(ctypes.c_double)]
        for kind in self.kinds:
            if isinstance(kind, ArrayField):
                types += [ctypes.c_int64] * kind.n_words
            else:
                types.append(ctypes.c_double if kind is float else ctypes.c_int64)
        return types
