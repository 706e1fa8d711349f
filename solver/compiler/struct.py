"""Records of numbers and arrays that machine code takes as one pointer.

In memory a record is a row of words of 8 bytes: a number is one word; an array is its address,
followed by those of its dimensions that are not constant; a record within lies in place. The words
do not change while the record lives: what moves are the elements of its arrays.
"""

import operator
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, NamedTuple, Self, dataclass_transform

import numpy as np

from ..arrays import Array, Index


class ArrayField(NamedTuple):
    """A C-contiguous array; a dimension is constant (a number) or has a name."""

    dims: tuple[int | str, ...]
    dtype: Any

    @property
    def n_words(self) -> int:
        return 1 + sum(not isinstance(dim, int) for dim in self.dims)

    def words(self, array: Any) -> list[int]:
        """Address and variable dimensions; `TypeError` where the array is not of this kind."""
        if not isinstance(array, np.ndarray):
            raise TypeError(f"expected an array {self}, found {type(array).__name__}")
        shape = array.shape
        fits = len(shape) == len(self.dims) and all(
            n == dim for n, dim in zip(shape, self.dims, strict=True) if isinstance(dim, int)
        )
        if array.dtype != self.dtype or not fits:
            raise TypeError(f"expected an array {self}, found {array.dtype} {shape}")
        if not array.flags.c_contiguous:
            raise TypeError(f"expected a contiguous array {self}, found strides {array.strides}")
        # Constant dimensions are part of the compiled code, and need no word.
        variable = [n for n, dim in zip(shape, self.dims, strict=True) if isinstance(dim, str)]
        return [array.__array_interface__["data"][0], *variable]

    def zeros(self, sizes: Mapping[str, int]) -> Any:
        shape = [dim if isinstance(dim, int) else sizes[dim] for dim in self.dims]
        return np.zeros(shape, dtype=self.dtype)

    def __str__(self) -> str:
        return f"{np.dtype(self.dtype)} ({', '.join(map(str, self.dims))})"


def array(*dims: int | str) -> Any:
    """Declares the dimensions of an array in a `Struct`: `x: Array = array("n_b", 3)`."""
    return dims


def field_kind(annotation: Any, dims: tuple[int | str, ...] = ("n",)) -> Any:
    """float, int, bool, an `ArrayField`, or the class of a `Struct`; `TypeError` for all else."""
    if annotation in (float, int, bool):
        return annotation
    if isinstance(annotation, type) and issubclass(annotation, Struct):
        return annotation
    if annotation == Array:
        return ArrayField(dims, np.float64)
    if annotation == Index:
        return ArrayField(dims, np.int64)
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
            kind = field_kind(annotation, cls.__dict__.get(name, ("n",)))
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
        words = np.zeros(max(self.n_words, 1), dtype=np.int64)
        for name, (first, kind) in self.layout.items():
            try:
                own = _words(kind, values[name])
            except TypeError as error:
                raise TypeError(f"{type(self).__name__}.{name}: {error}") from error
            words[first : first + len(own)] = own
        # Past __setattr__, which forbids to bind a field anew; the arrays must live as long as the
        # words.
        self.__dict__.update(values)
        self.__dict__["words"] = words
        self.__dict__["address"] = words.__array_interface__["data"][0]

    @classmethod
    def allocate(cls, sizes: Mapping[str, int]) -> Self:
        """A record of zeros, with the sizes of all named dimensions."""
        values: dict[str, Any] = {}
        for name, (_, kind) in cls.layout.items():
            if isinstance(kind, ArrayField):
                values[name] = kind.zeros(sizes)
            elif isinstance(kind, type) and issubclass(kind, Struct):
                values[name] = kind.allocate(sizes)
            else:
                values[name] = kind(0)
        return cls(**values)

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


def _made(cls: type[Struct], values: dict[str, Any]) -> Struct:
    return cls(**values)


def _words(kind: Any, value: Any) -> Any:
    """What a field of this kind is in memory; `TypeError` where the value is of another."""
    if isinstance(kind, ArrayField):
        return kind.words(value)
    if kind is float:
        return np.array([value], dtype=np.float64).view(np.int64)
    if kind is int:
        return [operator.index(value)]
    if kind is bool:
        return [int(bool(value))]
    if type(value) is not kind:
        raise TypeError(f"expected {kind.__name__}, found {type(value).__name__}")
    # A record without words has one word for its address: it is not copied.
    return value.words[: kind.n_words]
