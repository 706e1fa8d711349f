"""Numbers with derivatives in compiled code: the type, in registers and in memory.

In memory a number is 1 + k doubles, its value first; in registers a double and a vector of k, which
one instruction multiplies. `dual_arithmetic` says what is done with them.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core.datamodel.models import DataModel
from numba.core.typeconv import Conversion
from numba.extending import register_model

DOUBLE, LANE = ir.DoubleType(), ir.IntType(32)
NUMBER_TYPES = (types.Float, types.Integer, types.Boolean)

Number = tuple[Any, Any]
"""a value and its derivatives, which are None where all are zero"""


class Dual(types.Type):  # type: ignore[misc]
    """A number with k derivatives."""

    def __init__(self, k: int) -> None:
        self.k = k
        super().__init__(name=f"Dual({k})")

    def can_convert_from(self, typingctx: Any, other: Any) -> Any:
        return Conversion.safe if isinstance(other, NUMBER_TYPES) else None

    def unify(self, typingctx: Any, other: Any) -> Any:
        return self if isinstance(other, NUMBER_TYPES) else None


def lanes(k: int) -> Any:
    """The LLVM type of k derivatives."""
    return DOUBLE if k == 1 else ir.VectorType(DOUBLE, k)


@register_model(Dual)
class _DualModel(DataModel):  # type: ignore[misc]
    def get_value_type(self) -> Any:
        return ir.LiteralStructType([DOUBLE, lanes(self._fe_type.k)])

    def get_data_type(self) -> Any:
        return ir.ArrayType(DOUBLE, 1 + self._fe_type.k)

    def get_argument_type(self) -> Any:
        return DOUBLE, lanes(self._fe_type.k)

    def get_return_type(self) -> Any:
        return self.get_value_type()

    def as_argument(self, builder: Any, value: Any) -> Any:
        return split(builder, value)

    def from_argument(self, builder: Any, value: Any) -> Any:
        return joined(builder, *value)

    def as_return(self, builder: Any, value: Any) -> Any:
        return value

    def from_return(self, builder: Any, value: Any) -> Any:
        return value

    def as_data(self, builder: Any, value: Any) -> Any:
        x, dx = split(builder, value)
        data = builder.insert_value(ir.Constant(self.get_data_type(), ir.Undefined), x, 0)
        for i in range(self._fe_type.k):
            data = builder.insert_value(data, lane_of(builder, dx, i), 1 + i)
        return data

    def from_data(self, builder: Any, value: Any) -> Any:
        found = [builder.extract_value(value, 1 + i) for i in range(self._fe_type.k)]
        return joined(builder, builder.extract_value(value, 0), gathered(builder, found))

    def traverse(self, builder: Any) -> Any:
        return []

    def inner_models(self) -> Any:
        return []

    def get_nrt_meminfo(self, builder: Any, value: Any) -> Any:
        return None


# Numbers in registers and in memory


def joined(builder: Any, x: Any, dx: Any) -> Any:
    """A number of its value and derivatives."""
    value = ir.Constant(ir.LiteralStructType([DOUBLE, dx.type]), ir.Undefined)
    return builder.insert_value(builder.insert_value(value, x, 0), dx, 1)


def split(builder: Any, value: Any) -> Number:
    """The value and the derivatives of a number."""
    return builder.extract_value(value, 0), builder.extract_value(value, 1)


def load(builder: Any, place: Any, k: int) -> Any:
    """The number at an address."""
    first, rest = _places(builder, place, k)
    return joined(builder, builder.load(first, align=8), builder.load(rest, align=8))


def store(builder: Any, value: Any, place: Any, k: int) -> None:
    """Write a number to an address."""
    for part_of_it, at in zip(split(builder, value), _places(builder, place, k), strict=True):
        builder.store(part_of_it, at, align=8)


def _places(builder: Any, place: Any, k: int) -> tuple[Any, Any]:
    first = builder.bitcast(place, DOUBLE.as_pointer())
    rest = builder.gep(first, [LANE(1)], inbounds=True)
    return first, builder.bitcast(rest, lanes(k).as_pointer())


def lane_of(builder: Any, dx: Any, i: int) -> Any:
    """Derivative i."""
    return dx if dx.type == DOUBLE else builder.extract_element(dx, LANE(i))


def gathered(builder: Any, numbers: list[Any]) -> Any:
    """Derivatives of single numbers."""
    if len(numbers) == 1:
        return numbers[0]
    found = ir.Constant(lanes(len(numbers)), ir.Undefined)
    for i, number in enumerate(numbers):
        found = builder.insert_element(found, number, LANE(i))
    return found
