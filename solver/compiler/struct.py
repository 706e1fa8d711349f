"""Records of numbers and arrays that machine code takes as one pointer.

In memory a record is a row of words of 8 bytes: a number is one word; an array is its address,
followed by those of its dimensions that are not constant; a record within lies in place. The words
do not change while the record lives: what moves are the elements of its arrays.
"""

import ctypes
import math
import operator
import struct
from collections.abc import Iterator, Mapping
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self, dataclass_transform

import numpy as np

from ..arrays import Array, Index

# A number of floating point is a word by its bits.
_DOUBLE, _WORD = struct.Struct("=d"), struct.Struct("=q")
WORD_BYTES, LINE_WORDS = 8, 8
NO_BYTES = ctypes.c_char * 0
MAX_SMALL = 1 << 10
"""elements of an array that shares its memory with others"""


class ArrayField(NamedTuple):
    """A C-contiguous array; a dimension is constant (a number) or has a name."""

    dims: tuple[int | str, ...]
    dtype: Any
    is_real: bool = False
    """without derivatives where other arrays have them"""

    @property
    def n_words(self) -> int:
        return 1 + len(_dimensions(self.dims)[1])

    def words(self, array: Any) -> list[int]:
        """Address and variable dimensions; `TypeError` where the array is not of this kind."""
        if not isinstance(array, np.ndarray):
            raise TypeError(f"expected an array {self}, found {type(array).__name__}")
        constant, variable = _dimensions(self.dims)
        shape = array.shape
        fits = len(shape) == len(self.dims)
        if array.dtype != self.dtype or not (fits and all(shape[i] == n for i, n in constant)):
            raise TypeError(f"expected an array {self}, found {array.dtype} {shape}")
        if not array.flags.c_contiguous:
            raise TypeError(f"expected a contiguous array {self}, found strides {array.strides}")
        # Constant dimensions are part of the compiled code, and need no word.
        return [_address(array), *[shape[i] for i in variable]]

    def shape(self, sizes: Mapping[str, int]) -> list[int]:
        return [dim if isinstance(dim, int) else sizes[dim] for dim in self.dims]

    def n_elements(self, sizes: Mapping[str, int]) -> int:
        return math.prod(self.shape(sizes))

    def __str__(self) -> str:
        return f"{np.dtype(self.dtype)} ({', '.join(map(str, self.dims))})"


@cache
def _dimensions(
    dims: tuple[int | str, ...],
) -> tuple[tuple[tuple[int, int], ...], tuple[int, ...]]:
    """The dimensions that are constant, with their lengths, and those that are not, by number."""
    constant = tuple((i, dim) for i, dim in enumerate(dims) if isinstance(dim, int))
    return constant, tuple(i for i, dim in enumerate(dims) if not isinstance(dim, int))


class Declared(NamedTuple):
    """An array in a `Struct`, as `array` declares it."""

    dims: tuple[int | str, ...]
    is_real: bool = False


ONE_DIMENSION = Declared(("n",))


def array(*dims: int | str, real: bool = False) -> Any:
    """Declares the dimensions of an array in a `Struct`: `x: Array = array("n_b", 3)`.

    real: where numbers have derivatives, these have none. They are dropped from what is put there:
    for what results do not depend on, as Newton's matrix.
    """
    return Declared(dims, real)


def field_kind(annotation: Any, declared: Declared = ONE_DIMENSION) -> Any:
    """float, int, bool, an `ArrayField`, or the class of a `Struct`; `TypeError` for all else."""
    if annotation in (float, int, bool):
        return annotation
    if isinstance(annotation, type) and issubclass(annotation, Struct):
        return annotation
    if annotation == Array:
        return ArrayField(declared.dims, np.float64, declared.is_real)
    if annotation == Index:
        return ArrayField(declared.dims, np.int64)
    raise TypeError(f"expected float, int, bool, Array, Index or a Struct, found {annotation}")


@dataclass_transform(kw_only_default=True)
class Struct:
    """A record declared like a dataclass, by annotations and `array(...)`.

        class Bodies(Struct):
            mass: Array = array("n_b")
            J_rot: Array = array("n_b", 3, 3)

    Fields are attributes and cannot be bound anew: `bodies.mass[...] = 1.0` fills the array.
    """

    layout: ClassVar[dict[str, tuple[int, Any]]] = {}
    """first word and kind of every field"""
    n_words: ClassVar[int] = 0
    words: Index
    """(n_words,) the record in memory"""
    address: int
    """of the words"""

    def __init_subclass__(cls, fields: Mapping[str, Any] | None = None) -> None:
        """fields: more of them by name, as `ArrayField`s."""
        cls.layout, cls.n_words = {}, 0
        for name, array_field in (fields or {}).items():
            cls.layout[name] = cls.n_words, array_field
            cls.n_words += array_field.n_words
        for name, annotation in cls.__annotations__.items():
            kind = field_kind(annotation, cls.__dict__.get(name, ONE_DIMENSION))
            if name in cls.__dict__:
                # The default, dimensions, would hide a field that is missing in an instance.
                delattr(cls, name)
            cls.layout[name] = cls.n_words, kind
            is_number = kind in (float, int, bool)
            cls.n_words += 1 if is_number else kind.n_words

    def __init__(self, **values: Any) -> None:
        if missing := self.layout.keys() - values.keys():
            raise TypeError(f"{type(self).__name__}: no {', '.join(sorted(missing))}")
        if unknown := values.keys() - self.layout.keys():
            raise TypeError(f"{type(self).__name__} has no {', '.join(sorted(unknown))}")
        found: list[int] = []
        for name, (_, kind) in self.layout.items():
            try:
                found += _words(kind, values[name])
            except TypeError as error:
                raise TypeError(f"{type(self).__name__}.{name}: {error}") from error
        self._keep(values, found)

    def _keep(self, values: Mapping[str, Any], found: list[int]) -> None:
        # A record without fields has one word too: it has an address.
        words = np.array(found or [0], dtype=np.int64)
        # Past __setattr__, which forbids to bind a field anew; the arrays must live as long as the
        # words.
        self.__dict__.update(values)
        self.__dict__["words"] = words
        self.__dict__["address"] = _address(words)

    @classmethod
    def allocate(cls, sizes: Mapping[str, int]) -> Self:
        """A record of zeros, with the sizes of all named dimensions."""
        plan = _plan(cls, tuple(sizes.items()))  # type: ignore[arg-type]
        words, block = plan.words.copy(), np.zeros(plan.n_small, dtype=np.int64)
        first = _address(block)
        words[plan.small] += first
        large = {at: np.zeros(n, dtype=np.int64) for at, n in plan.large}
        for at, array in large.items():
            words[at] = _address(array)
        made = cls.__new__(cls)
        by_address = {int(words[at]): array for at, array in large.items()}
        made._lie_in(words, _Memory(block, first, by_address))
        return made

    def _lie_in(self, words: Index, memory: "_Memory") -> None:
        """Take these words, whose arrays are in this memory: fields are made when asked for."""
        self.__dict__.update(words=words, address=_address(words), _memory=memory)

    if not TYPE_CHECKING:  # else any name would pass the check of types

        def __getattr__(self, name: str) -> Any:
            """A field of an allocated record: few of its arrays are ever seen from Python."""
            if name not in self.layout or "_memory" not in self.__dict__:
                raise AttributeError(f"{type(self).__name__} has no {name}")
            found = self.__dict__[name] = self._field(*self.layout[name])
            return found

    def _field(self, at: int, kind: Any) -> Any:
        memory: _Memory = self.__dict__["_memory"]
        if isinstance(kind, ArrayField):
            return memory.array(kind, self.words[at : at + kind.n_words].tolist())
        if issubclass(kind, Struct):
            record = kind.__new__(kind)
            record._lie_in(self.words[at : at + kind.n_words], memory)
            return record
        return kind(0)

    @classmethod
    def n_elements(cls, sizes: Mapping[str, int]) -> int:
        """The elements of all arrays that `allocate` makes of these sizes."""
        return sum(
            kind.n_elements(sizes)
            for _, kind in cls.layout.values()
            if kind not in (float, int, bool)
        )

    @classmethod
    def description(cls) -> str:
        """The layout in words, records within included: what machine code for it depends on."""
        parts = [
            f"{name} {kind.description() if hasattr(kind, 'description') else kind}"
            for name, (_, kind) in cls.layout.items()
        ]
        return f"{cls.__name__}({', '.join(parts)})"

    def replace(self, **values: Any) -> Self:
        """A record with other values of some fields, which shares all other arrays."""
        return type(self)(**{name: getattr(self, name) for name in self.layout} | values)

    @classmethod
    def array_fields(cls, first: int = 0) -> Iterator[tuple[int, ArrayField]]:
        """All arrays, those of records within included, by their first words.

        first: the first word of this record.
        """
        for at, kind in cls.layout.values():
            if isinstance(kind, ArrayField):
                yield first + at, kind
            elif kind not in (float, int, bool):
                yield from kind.array_fields(first + at)

    def pointers(self, first: int = 0) -> Iterator[tuple[int, Any]]:
        """All arrays, those of records within included, with the words that have their addresses.

        first: the first word of this record.
        """
        for name, (at, kind) in self.layout.items():
            value = getattr(self, name)
            if isinstance(value, Struct):
                yield from value.pointers(first + at)
            elif isinstance(kind, ArrayField):
                yield first + at, value

    def leaves(self) -> Iterator[tuple[str, Any]]:
        """All arrays and numbers with their names, "bodies/mass", in the order of declaration."""
        for name in self.layout:
            value = getattr(self, name)
            if isinstance(value, Struct):
                yield from ((f"{name}/{below}", leaf) for below, leaf in value.leaves())
            else:
                yield name, value

    def arrays(self) -> list[Any]:
        """All arrays, those of records within included, in the order of their declaration."""
        return [leaf for _, leaf in self.leaves() if isinstance(leaf, np.ndarray)]

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(
            f"{type(self).__name__}.{name} cannot be bound anew: {name}[...] = ..."
        )

    def __reduce__(self) -> Any:
        """A copy has words of its own, which point to its own arrays."""
        return _made, (type(self), {name: getattr(self, name) for name in self.layout})


class _Memory(NamedTuple):
    """Zeros: a block from which small arrays are cut, and large ones, by their addresses.

    To ask for each small array takes longer than a step.
    """

    block: Index
    address: int
    large: dict[int, Index]

    def array(self, kind: ArrayField, words: list[int]) -> Any:
        """The array of a field with these words."""
        address, *lengths = words
        variable = iter(lengths)
        shape = [dim if isinstance(dim, int) else next(variable) for dim in kind.dims]
        if (own := self.large.get(address)) is not None:
            return own.view(kind.dtype).reshape(shape)
        return np.ndarray(shape, kind.dtype, self.block, address - self.address)


class _Plan(NamedTuple):
    """What a record of zeros of some sizes is made of.

    words: with the places of small arrays in their block in place of addresses; small: which words
    these are; n_small: words of the block; large: word and number of elements of each other array.
    """

    words: Index
    small: Index
    n_small: int
    large: list[tuple[int, int]]


@lru_cache(maxsize=64)
def _plan(cls: type[Struct], sizes: tuple[tuple[str, int], ...]) -> _Plan:
    """Runs of one model after the other, as of a study, have records of the same sizes."""
    words = np.zeros(max(cls.n_words, 1), dtype=np.int64)
    small, large, used, by_name = [], [], 0, dict(sizes)
    for at, kind in cls.array_fields():
        shape = kind.shape(by_name)
        words[at + 1 : at + kind.n_words] = [shape[i] for i in _dimensions(kind.dims)[1]]
        if (n := math.prod(shape)) > MAX_SMALL:
            large.append((at, n))
            continue
        small.append(at)
        words[at] = WORD_BYTES * used
        # Each begins a line of the cache.
        used += -(-n // LINE_WORDS) * LINE_WORDS
    return _Plan(words, np.array(small, dtype=np.int64), used, large)


def _address(array: Any) -> int:
    try:
        # Numpy's own interface makes a table of all it knows, which takes six times as long.
        return ctypes.addressof(NO_BYTES.from_buffer(array))
    except TypeError:  # an array that must not be written
        found: int = array.__array_interface__["data"][0]
        return found


def _made(cls: type[Struct], values: dict[str, Any]) -> Struct:
    return cls(**values)


def _words(kind: Any, value: Any) -> list[int]:
    """What a field of this kind is in memory; `TypeError` where the value is of another."""
    if isinstance(kind, ArrayField):
        return kind.words(value)
    if kind is float:
        return [_WORD.unpack(_DOUBLE.pack(value))[0]]
    if kind is int:
        return [operator.index(value)]
    if kind is bool:
        return [int(bool(value))]
    if type(value) is not kind:
        raise TypeError(f"expected {kind.__name__}, found {type(value).__name__}")
    # A record without words has one word for its address: it is not copied.
    return value.words[: kind.n_words].tolist()  # type: ignore[no-any-return]
