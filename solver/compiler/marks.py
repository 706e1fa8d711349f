"""Marks of functions that run as machine code: `compiled`, and `entry` for those that Python calls.

Compiled code reads records and arrays and returns numbers. It allocates nothing, raises nothing,
takes no negative index (none is wrapped) and no slice but at the end of an index. With
NUMBA_DISABLE_JIT=1 in the environment all of it runs as plain Python, for debugging and coverage.
"""

import ctypes
import inspect
from collections.abc import Callable, Iterator
from typing import Any, TypeVar, cast, get_args

from .struct import ArrayField, Struct, field_kind

Function = TypeVar("Function", bound=Callable[..., Any])

COMPILED_FUNCTIONS: dict[Callable[..., Any], None] = {}
"""all functions that are compiled, entries included, in the order of their definition"""
OBJECT_MARK = b"object file of duhamel\n"
"""what the process that builds writes ahead of the object file"""
COMPILED_ENTRIES: dict[str, "Entry"] = {}
"""entries by the name that they have in the object file"""
SURFACE_FUNCTIONS: set[Callable[..., Any]] = set()
"""those that code with derivatives has only for models with contacts of surfaces"""
DIFFERENTIABLE_ENTRIES: dict[str, "Entry"] = {}
"""those of them that are also compiled with derivatives"""


def compiled(function: Function) -> Function:
    """Register a function that compiled code calls; called from Python, it runs as Python."""
    COMPILED_FUNCTIONS[function] = None
    return function


def of_surfaces(function: Function) -> Function:
    """Mark a compiled function that does nothing, or returns False, without contacts of surfaces.

    Code with derivatives for such models leaves it out: to compile it takes as long as all else.
    """
    SURFACE_FUNCTIONS.add(function)
    return function


def entry(function: Function) -> Function:
    """Register a compiled function that Python calls too, with the arguments that it annotates."""
    COMPILED_FUNCTIONS[function] = None
    made = Entry(function)
    COMPILED_ENTRIES[made.symbol] = made
    return cast(Function, made)


def differentiable(made: Function) -> Function:
    """Register an entry that is also compiled with derivatives; no argument is an array."""
    of_records = cast("Entry", made)
    DIFFERENTIABLE_ENTRIES[of_records.symbol] = of_records
    return made


class Entry:
    """A function that Python calls and that runs as machine code, found or built at the first call.

    In the object file it is a function of words: `void symbol(double *results, words...)`; a record
    is its address, an array its address and variable dimensions. An array among the arguments must
    be contiguous and of the annotated type, for it is handed over as it is.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.symbol = f"{function.__module__}.{function.__name__}".replace(".", "_")
        self.__name__, self.__doc__ = function.__name__, function.__doc__
        signature = inspect.signature(function)
        self.arguments = {
            name: field_kind(parameter.annotation)
            for name, parameter in signature.parameters.items()
        }
        """name and kind of each"""
        returned = signature.return_annotation
        self.results: tuple[type, ...] = get_args(returned) or (
            () if returned is None else (returned,)
        )
        self.call: Callable[..., Any] = self._load_and_call
        """what runs: it loads at first, and then is the machine code or what stands in for it"""

    def __call__(self, *args: Any) -> Any:
        return self.call(*args)

    @property
    def is_bound(self) -> bool:
        return self.call != self._load_and_call

    def _load_and_call(self, *args: Any) -> Any:
        from .object_file import load

        load()
        return self.call(*args)

    def bind(self, address: int) -> None:
        """Call the machine code at an address from now on."""
        types = [ctypes.c_void_p]  # an address as c_void_p costs less than as c_int64
        for kind in self.arguments.values():
            types += _word_types(kind)
        names: dict[str, Any] = {
            "machine_code": ctypes.CFUNCTYPE(None, *types)(address),
            "Results": ctypes.c_double * max(1, len(self.results)),
        }
        words = []
        for i, (name, kind) in enumerate(self.arguments.items()):
            if isinstance(kind, ArrayField):
                names[f"words_{i}"] = self._words_of(name, kind)
                words.append(f"*words_{i}({name})")
            elif kind in (float, int, bool):
                words.append(name)
            else:
                names[f"R_{i}"], names[f"no_{i}"] = kind, self._refusal(name, kind)
                words.append(f"{name}.address if type({name}) is R_{i} else no_{i}({name})")
        # written out, for a loop over the arguments takes as long as the call
        lines = [
            f"def call({', '.join(self.arguments)}):",
            "    results = Results()",
            f"    machine_code(results, {', '.join(words)})",
            f"    return {self._result_expression()}",
        ]
        exec("\n".join(lines), names)
        self.call = names["call"]

    def _result_expression(self) -> str:
        casts = {float: "results[{}]", int: "int(results[{}])", bool: "results[{}] != 0.0"}
        parts = [casts[kind].format(i) for i, kind in enumerate(self.results)]
        return ", ".join(parts) or "None"

    def _words_of(self, name: str, kind: ArrayField) -> Callable[[Any], list[int]]:
        def words(value: Any) -> list[int]:
            try:
                return kind.words(value)
            except TypeError as error:
                raise TypeError(f"{self.__name__}: {name}: {error}") from error

        return words

    def _refusal(self, name: str, kind: type[Struct]) -> Callable[[Any], None]:
        def refuse(value: Any) -> None:
            found = type(value).__name__
            raise TypeError(f"{self.__name__}: {name}: expected {kind.__name__}, found {found}")

        return refuse


def _word_types(kind: Any) -> list[Any]:
    """Of an argument of machine code, for ctypes."""
    if isinstance(kind, ArrayField):
        return [ctypes.c_void_p] + [ctypes.c_int64] * (kind.n_words - 1)
    if kind in (float, int, bool):
        return [ctypes.c_double if kind is float else ctypes.c_int64]
    return [ctypes.c_void_p]


def records() -> Iterator[type[Struct]]:
    """The classes of the records that entries take, records within included."""
    waiting = [kind for entry in COMPILED_ENTRIES.values() for kind in entry.arguments.values()]
    found: set[Any] = set()
    while waiting:
        kind = waiting.pop()
        if isinstance(kind, type) and issubclass(kind, Struct) and kind not in found:
            found.add(kind)
            waiting += [inner for _, inner in kind.layout.values()]
            yield kind
