"""Records of numbers and arrays that machine code takes as one pointer.

In memory a record is a row of words of 8 bytes: a number is one word; an array is its address,
followed by those of its dimensions that are not constant; a record within lies in place. The words
do not change while the record lives: what moves are the elements of its arrays.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple, Self, dataclass_transform

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
        """Address and variable dimensions; `TypeError` where the array is another."""
        shape = array.shape
        fits = array.dtype == self.dtype and len(shape) == len(self.dims)
        if not fits or not (array.flags.c_contiguous or not array.size):
            raise TypeError(f"expected a contiguous array {self}, found {array.dtype} {shape}")
        words = [array.__array_interface__["data"][0]]
        for n, dim in zip(shape, self.dims, strict=True):
            if not isinstance(dim, int):
                words.append(n)
            elif n != dim:
                raise TypeError(f"expected a contiguous array {self}, found shape {shape}")
        return words

    def zeros(self, sizes: Mapping[str, int]) -> Any:
        shape = [dim if isinstance(dim, int) else sizes[dim] for dim in self.dims]
        return np.zeros(shape, dtype=self.dtype)

    def __str__(self) -> str:
        return f"{np.dtype(self.dtype)} ({', '.join(map(str, self.dims))})"


def array(*dims: int | str) -> Any:
    """Declares an array field of a `Struct` with these dimensions, as in `x: Array = array("n_b", 3)`."""
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

    `layout` has (first word, kind) of every field, `words` (n,) are the record in memory, `address`
    is where they stand. Fields are attributes; they cannot be bound anew.
    """

    layout: dict[str, tuple[int, Any]] = {}
    n_words = 0
    words: Index
    address: int

    def __init_subclass__(cls, fields: Mapping[str, Any] | None = None) -> None:
        """fields: more of them by name, as `ArrayField`s."""
        cls.layout, cls.n_words = {}, 0
        for name, array_field in (fields or {}).items():
            cls.layout[name] = cls.n_words, array_field
            cls.n_words += array_field.n_words
        for name, annotation in cls.__annotations__.items():
            kind = field_kind(annotation, cls.__dict__.get(name, ("n",)))
            if name in cls.__dict__:
                delattr(cls, name)
            cls.layout[name] = cls.n_words, kind
            is_number = kind in (float, int, bool)
            cls.n_words += 1 if is_number else kind.n_words

    def __init__(self, **values: Any) -> None:
        if values.keys() != self.layout.keys():
            raise TypeError(f"{type(self).__name__}: {sorted(values.keys() ^ self.layout.keys())}")
        words = np.zeros(max(self.n_words, 1), dtype=np.int64)
        for name, (first, kind) in self.layout.items():
            value = values[name]
            if kind is float:
                words[first : first + 1].view(np.float64)[0] = value
            elif kind in (int, bool):
                words[first] = value
            elif isinstance(kind, ArrayField):
                try:
                    words[first : first + kind.n_words] = kind.words(value)
                except TypeError as error:
                    raise TypeError(f"{type(self).__name__}.{name}: {error}") from error
            else:
                words[first : first + kind.n_words] = value.words
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

    def arrays(self) -> list[Any]:
        """All arrays, those of records within included, in the order of their declaration."""
        found: list[Any] = []
        for name, (_, kind) in self.layout.items():
            value = getattr(self, name)
            if isinstance(value, Struct):
                found += value.arrays()
            elif isinstance(kind, ArrayField):
                found.append(value)
        return found

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(
            f"{type(self).__name__}.{name} cannot be bound anew: {name}[...] = ..."
        )
