"""The kinds of values that the fields of a model take.

To a type checker, kinds of arrays are descriptors: arguments may be lists and tuples, attributes
are arrays.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from pydantic import AfterValidator, AllowInfNan

from ... import inputs
from ...inputs import expected
from ..arrays import Array
from .entry import LARGEST_NUMBER, DefaultInFile, FieldSpec, ItemOf, real

ZERO_VECTOR: Any = (0.0, 0.0, 0.0)
"""the default of a `Vector`"""
NO_ITEMS: Any = ()
"""the default of `Several`"""
NO_ARRAY: Any = None
"""the default of an optional array"""
# A vector that was normalized before differs from 1 by a few roundings. It must stay as it is, or
# files would not read back to equal models.
UNIT_LENGTH_TOLERANCE = 1e-15
AXIS_WORDS = {
    f"{sign}{axis}": tuple((-1.0 if sign else 1.0) * (k == n) for k in range(3))
    for n, axis in enumerate("xyz")
    for sign in ("", "-")
}
"""the axes of space in words"""
# relative to the largest entry: what a file written with ten digits leaves
SYMMETRY_TOLERANCE = 1e-9
Item = TypeVar("Item")
Stored = TypeVar("Stored", covariant=True)
Accepted = TypeVar("Accepted", contravariant=True)


def number(what: str, kind: type, allowed: Callable[[Any], bool]) -> FieldSpec:
    """A number within limits."""

    def store(value: Any) -> Any:
        stored = kind(value)
        # int(2.5) would pass as 2.
        if stored != value or not allowed(stored):
            raise ValueError
        return stored

    return FieldSpec(what, store, Annotated[kind, AfterValidator(store), expected(what)])


def _is_positive(x: float) -> bool:
    return 1.0 / LARGEST_NUMBER <= x <= LARGEST_NUMBER


Positive = Annotated[float, number("a positive number, 1e-100 to 1e100", float, _is_positive)]
PositiveTime = Annotated[float, number("a positive time, 1e-100 to 1e100", float, _is_positive)]
_NOT_ZERO = "a number other than 0, of magnitude 1e-100 to 1e100"
NotZero = Annotated[float, number(_NOT_ZERO, float, lambda x: _is_positive(abs(x)))]
_NOT_NEGATIVE = "a number of at least 0, up to 1e100"
NotNegative = Annotated[float, number(_NOT_NEGATIVE, float, lambda x: 0.0 <= x <= LARGEST_NUMBER)]
_ZERO_OR_POSITIVE = "0, or a number from 1e-100 to 1e100"
ZeroOrPositive = Annotated[
    float, number(_ZERO_OR_POSITIVE, float, lambda x: x == 0.0 or _is_positive(x))
]
AtLeastOne = Annotated[float, number("a number from 1 to 100", float, lambda x: 1.0 <= x <= 100.0)]
Fraction = Annotated[float, number("a number from 0 to 1", float, lambda x: 0.0 <= x <= 1.0)]
Tolerance = Annotated[float, number("a number between 0 and 1", float, lambda x: 0.0 < x < 1.0)]
Count = Annotated[int, number("1 to 1e9", int, lambda n: 1 <= n <= 10**9)]
Iterations = Annotated[int, number("1 to 1000", int, lambda n: 1 <= n <= 1000)]


def reals(value: Any) -> Array:
    """An array of any shape of numbers that `real` takes."""
    entries = np.array(value, dtype=np.float64)
    if not (np.abs(entries) <= LARGEST_NUMBER).all():
        raise ValueError
    return entries


def vector(value: Any) -> Array:
    components = reals(value)
    if components.shape != (3,):
        raise ValueError
    return components


def axis_or_vector(value: Any) -> Array:
    """Three numbers; "x", "-z", ... are the axes and their opposites."""
    # An unknown word goes on to `vector`, whose error says what is expected.
    return vector(AXIS_WORDS.get(value, value) if isinstance(value, str) else value)


def direction(value: Any) -> Array:
    """The unit vector along a vector; one that has unit length to rounding stays as it is."""
    along = axis_or_vector(value)
    largest = float(np.abs(along).max())
    if largest == 0.0:
        raise ValueError
    # Squares of components of 1e-200 would vanish: they are scaled first.
    length = largest * float(np.linalg.norm(along / largest))
    return (
        along
        if abs(length - 1.0) <= UNIT_LENGTH_TOLERANCE
        else along / largest / (length / largest)
    )


def points(value: Any) -> Array:
    pairs = reals(value)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise ValueError
    return pairs


def array(value: Any) -> Array:
    return np.atleast_1d(reals(value))


def numbers(value: Any) -> tuple[float, ...]:
    return tuple(map(real, value))


def numbers_by_name(value: Any) -> dict[str, float]:
    return {str(name): real(number) for name, number in dict(value).items()}


def some_numbers(value: Any) -> tuple[float, ...]:
    # Checked after conversion: an iterator has no length.
    if len(stored := numbers(value)) == 0:
        raise ValueError
    return stored


def frame_name(value: Any) -> str:
    """The name of a frame, or of what has one, as handles of bodies and frames do."""
    return name_of(value, "frame_name")


def name_of(value: Any, attribute: str = "name") -> str:
    """A name, or that of what has one, as a joint or the handle of a body."""
    name = getattr(value, attribute, value)
    if not isinstance(name, str):
        raise TypeError
    return name


def names(value: Any) -> tuple[str, ...]:
    # A string is a sequence of strings: "pin" would become three names.
    if isinstance(value, str):
        raise TypeError
    return tuple(map(name_of, value))


def pair(value: Any) -> tuple[str, str]:
    first, second = value
    return frame_name(first), frame_name(second)


def limits(value: Any) -> tuple[float, float]:
    """A lower and a higher number, of which one may be infinite."""
    # `real` refuses infinities, which are meant here: no limit on this side.
    lower, upper = (x if math.isinf(x) else real(x) for x in map(float, value))
    if not lower < upper or (math.isinf(lower) and math.isinf(upper)):
        raise ValueError
    return lower, upper


def inertia(value: Any) -> Array:
    entries = reals(value)
    matrix = np.diag(entries) if entries.shape == (3,) else entries
    if matrix.shape != (3, 3) or not is_symmetric(matrix):
        raise ValueError
    return matrix


def is_symmetric(matrix: Array) -> bool:
    """True up to rounding, which is relative to the largest entry."""
    return bool(np.abs(matrix - matrix.T).max() <= SYMMETRY_TOLERANCE * np.abs(matrix).max())


def shortest(matrix: Array) -> Any:
    """A matrix as a file gives it: a number, a diagonal, or rows."""
    matrix = np.diag(matrix) if matrix.ndim == 1 else matrix
    diagonal = np.diag(matrix)
    if (matrix != np.diag(diagonal)).any():
        return matrix.tolist()
    # A zero matrix is written as 0, which stands for one of any size.
    return diagonal.tolist() if diagonal.any() and len(diagonal) > 1 else float(diagonal[0])


def of_bearing(matrices: Array) -> Any:
    """Matrices (n, 2, 2) of a bearing as a file gives them: one by rows, several by a row each."""
    if not matrices.any():
        return 0.0
    return matrices[0].tolist() if len(matrices) == 1 else matrices.reshape(-1, 4).tolist()


_Point = Annotated[tuple[float, float], expected("two numbers")]
_Coefficients = Annotated[
    float | tuple[float, ...] | tuple[tuple[float, ...], ...],
    expected("a number, six numbers or a 6x6 matrix"),
]
_BearingCoefficients = Annotated[
    float | tuple[float, ...] | tuple[tuple[float, ...], ...],
    expected("a number, two numbers, a 2x2 matrix, or a row of four for each speed"),
]
_Inertia = Annotated[
    inputs.Vector | tuple[inputs.Vector, inputs.Vector, inputs.Vector],
    expected("three numbers or a 3x3 matrix"),
]


def some_non_zero(value: Any) -> tuple[float, ...]:
    if 0.0 in (stored := some_numbers(value)):
        raise ValueError
    return stored


def _in_files_too(what: str, store: Callable[[Any], Any]) -> FieldSpec:
    return FieldSpec(what, store, Annotated[tuple[float, ...], AfterValidator(store)])


SomeNonZero = Annotated[
    tuple[float, ...], _in_files_too("one or more numbers other than 0", some_non_zero)
]
Name = Annotated[str, DefaultInFile("")]
"""a name; what has none in a file is numbered"""
NumbersByName = Annotated[
    Mapping[str, float], FieldSpec("numbers by name", numbers_by_name, dict[str, float])
]
Infinite = Annotated[float, AllowInfNan(True), inputs.Shown(lambda: {"type": ["number", "null"]})]
"""a number in a file that may be infinite, which editors take for null: JSON has no infinity"""
_LIMITS = "a lower and a higher number, of which one may be infinite"
_TwoLimits = Annotated[tuple[Infinite, Infinite], expected("two numbers")]
Limits = Annotated[tuple[float, float], FieldSpec(_LIMITS, limits, _TwoLimits)]
Words = Annotated[tuple[str, ...], FieldSpec("names", names, tuple[str, ...])]


class Framed(Protocol):
    """An object that has a frame, such as the handle of a frame or a body of a mechanism."""

    @property
    def frame_name(self) -> str: ...


class Named(Protocol):
    """An object that has a name, such as a joint or the handle of a body."""

    @property
    def name(self) -> str: ...


if TYPE_CHECKING:

    class Converted(Generic[Stored, Accepted]):
        """A field to type checkers: it takes arguments of one type, and stores another."""

        def __get__(self, owner: Any, kind: Any = None) -> Stored: ...
        def __set__(self, owner: Any, value: Accepted) -> None: ...

    # Each: what an attribute is, and what an argument may be.
    FrameName = Converted[str, str | Framed]
    FrameA = FrameName
    FrameB = FrameName
    BodyName = Converted[str, str | Named]
    JointName = BodyName
    JointNames = Converted[tuple[str, ...], Sequence[str | Named]]
    Pair = Converted[tuple[str, str], Sequence[str | Framed]]
    Vector = Converted[Array, ArrayLike]
    Inertia = Vector
    Coefficients = Vector
    BearingCoefficients = Vector
    Direction = Converted[Array, ArrayLike | str]
    AxisOrVector = Direction
    OptionalDirection = Converted[Array | None, ArrayLike | str | None]
    OptionalPoints = Converted[Array | None, ArrayLike | None]
    OptionalArray = OptionalPoints
    Numbers = Converted[tuple[float, ...], Sequence[float] | Array]
    SomeNumbers = Numbers
    Several = Converted[tuple[Item, ...], Iterable[Item]]
else:
    _TwoFrames = Annotated[tuple[str, str], expected("the names of two frames")]
    FrameName = Annotated[str, FieldSpec("the name of a frame", frame_name, str)]
    FrameA = Annotated[FrameName, ItemOf("between", 0, _TwoFrames)]
    FrameB = Annotated[FrameName, ItemOf("between", 1, _TwoFrames)]
    Pair = Annotated[tuple[str, str], FieldSpec("two frames", pair, _TwoFrames)]
    BodyName = Annotated[str, FieldSpec("the name of a body", name_of, str)]
    JointName = Annotated[str, FieldSpec("the name of a joint", name_of, str)]
    JointNames = Annotated[tuple[str, ...], FieldSpec("names of joints", names, tuple[str, ...])]

    class Several:
        def __class_getitem__(cls, item: Any) -> Any:
            return Annotated[tuple, FieldSpec("a sequence", tuple, tuple)]

    Vector = Annotated[np.ndarray, FieldSpec("three numbers", vector, inputs.Vector)]
    AxisOrVector = Annotated[np.ndarray, FieldSpec("three numbers", axis_or_vector, inputs.Vector)]
    Direction = Annotated[
        np.ndarray, FieldSpec("three numbers that are not all zero", direction, inputs.Vector)
    ]
    OptionalDirection = Direction | None
    _ARRAY = FieldSpec("numbers", array, float | tuple[float, ...])
    OptionalArray = Annotated[np.ndarray, _ARRAY] | None
    _POINTS = FieldSpec("pairs of numbers", points, tuple[_Point, ...])
    OptionalPoints = Annotated[np.ndarray, _POINTS] | None
    Numbers = Annotated[tuple[float, ...], FieldSpec("numbers", numbers, tuple[float, ...])]
    SomeNumbers = Annotated[tuple[float, ...], _in_files_too("one or more numbers", some_numbers)]
    _INERTIA = "three principal values or a symmetric 3x3 matrix"
    Inertia = Annotated[np.ndarray, FieldSpec(_INERTIA, inertia, _Inertia, shortest)]
    Coefficients = Annotated[np.ndarray, FieldSpec("numbers", array, _Coefficients, shortest)]
    BearingCoefficients = Annotated[
        np.ndarray, FieldSpec("numbers", array, _BearingCoefficients, of_bearing)
    ]
