"""Records and arrays as numba has them in code that is built: their types and operations.

A record is an opaque pointer to its words, an array its address and dimensions: nothing is passed
by value but a few numbers. To import this file tells numba.
"""

import operator
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_builtin, lower_getattr_generic
from numba.core.typing import signature
from numba.core.typing.templates import (
    AbstractTemplate,
    AttributeTemplate,
    infer_getattr,
    infer_global,
)
from numba.extending import intrinsic, models, register_model

from . import dual
from .dual import DOUBLE, Dual
from .struct import ArrayField, Struct

WORD, INDEX_TYPE = ir.IntType(64), ir.IntType(32)


class StructType(types.Type):  # type: ignore[misc]
    """A pointer to the words of a `Struct`, whose numbers have k derivatives."""

    def __init__(self, cls: type[Struct], k: int) -> None:
        self.cls, self.k = cls, k
        super().__init__(name=f"{cls.__module__}.{cls.__name__}({k})")


class View(types.Type):  # type: ignore[misc]
    """A C-contiguous array: address and dimensions; indices are neither checked nor negative."""

    def __init__(self, dtype: Any, ndim: int) -> None:
        self.dtype, self.ndim = dtype, ndim
        super().__init__(name=f"View({dtype}, {ndim})")


# Records: a field is loaded from its word where it is read.

register_model(StructType)(models.OpaqueModel)


def numba_type(kind: Any, k: int) -> Any:
    """Of an argument or a field; numbers of arrays have k derivatives, unless they are real."""
    if kind in (float, int, bool):
        return {float: types.float64, int: types.int64, bool: types.int64}[kind]
    if not isinstance(kind, ArrayField):
        return StructType(kind, k)
    number = types.float64 if kind.is_real or not k else Dual(k)
    return View(number if kind.dtype == np.float64 else types.int64, len(kind.dims))


@infer_getattr
class _FieldTypes(AttributeTemplate):  # type: ignore[misc]
    key = StructType

    def generic_resolve(self, typ: Any, attr: str) -> Any:
        # A bool is a word like all numbers: memory has no smaller pieces.
        field = typ.cls.layout.get(attr)
        return None if field is None else numba_type(field[1], typ.k)


@lower_getattr_generic(StructType)  # type: ignore[untyped-decorator]
def _field(context: Any, builder: Any, typ: Any, pointer: Any, attr: str) -> Any:
    first, kind = typ.cls.layout[attr]

    def word(k: int, type_: Any) -> Any:
        place = builder.gep(pointer, [INDEX_TYPE(8 * k)], inbounds=True)
        value = builder.load(builder.bitcast(place, type_.as_pointer()), align=8)
        # words never change while compiled code runs: LLVM may move and merge these loads
        value.set_metadata("invariant.load", builder.module.add_metadata([]))
        return value

    if kind in (float, int, bool):
        return word(first, DOUBLE if kind is float else WORD)
    if not isinstance(kind, ArrayField):
        return builder.gep(pointer, [INDEX_TYPE(8 * first)], inbounds=True)
    view = numba_type(kind, typ.k)
    data = word(first, context.get_value_type(types.CPointer(view.dtype)))
    numbers = iter(range(first + 1, first + kind.n_words))
    shape = [WORD(dim) if isinstance(dim, int) else word(next(numbers), WORD) for dim in kind.dims]
    return packed_view(context, builder, view, data, shape)


# Arrays: elements, rows, one slice at the end of an index, one number for a whole view, len.


@register_model(View)
class _ViewModel(models.StructModel):  # type: ignore[misc]
    def __init__(self, manager: Any, type_: Any) -> None:
        dims = [(f"n{i}", types.int64) for i in range(type_.ndim)]
        super().__init__(manager, type_, [("data", types.CPointer(type_.dtype)), *dims])


def packed_view(context: Any, builder: Any, type_: Any, data: Any, shape: list[Any]) -> Any:
    value = ir.Constant(context.get_value_type(type_), ir.Undefined)
    for i, part in enumerate((data, *shape)):
        value = builder.insert_value(value, part, i)
    return value


def _indices(index: Any) -> tuple[Any, ...]:
    return tuple(index) if isinstance(index, types.BaseTuple) else (index,)


def _taken(array: Any, index: Any) -> Any:
    """The type of array[index]; None if there is no such thing."""
    if not isinstance(array, View):
        return None
    indices = _indices(index)
    rest = array.ndim - len(indices)
    if rest < 0 or any(isinstance(i, types.SliceType) for i in indices[:-1]):
        return None
    if isinstance(indices[-1], types.SliceType):
        return View(array.dtype, rest + 1)
    return View(array.dtype, rest) if rest else array.dtype


@infer_global(operator.getitem)
class _GetItem(AbstractTemplate):  # type: ignore[misc]
    def generic(self, args: Any, kws: Any) -> Any:
        taken = _taken(*args)
        return taken and signature(taken, *args)


@infer_global(operator.setitem)
class _SetItem(AbstractTemplate):  # type: ignore[misc]
    def generic(self, args: Any, kws: Any) -> Any:
        taken = _taken(*args[:2])
        value = args[0].dtype if taken else None
        if isinstance(args[2], Dual) and value == types.float64:
            value = args[2]  # its derivatives are dropped
        return taken and signature(types.none, args[0], args[1], value)


@infer_global(len)
class _Len(AbstractTemplate):  # type: ignore[misc]
    def generic(self, args: Any, kws: Any) -> Any:
        return signature(types.intp, *args) if isinstance(args[0], View) else None


@lower_builtin(len, View)  # type: ignore[untyped-decorator]
def _len(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.extract_value(args[0], 1)


@lower_builtin(operator.getitem, View, types.Any)  # type: ignore[untyped-decorator]
def _getitem(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    place, shape = _place(context, builder, sig, args)
    if shape:
        return packed_view(context, builder, sig.return_type, place, shape)
    if isinstance(sig.return_type, Dual):
        return dual.load(builder, place, sig.return_type.k)
    return builder.load(place, align=8)


@lower_builtin(operator.setitem, View, types.Any, types.Any)  # type: ignore[untyped-decorator]
def _setitem(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    place, shape = _place(context, builder, sig, args)
    kind = sig.args[0].dtype
    if isinstance(sig.args[2], Dual) and kind == types.float64:
        value, _ = dual.split(builder, args[2])
    else:
        value = context.cast(builder, args[2], sig.args[2], kind)

    def store(at: Any) -> None:
        if isinstance(kind, Dual):
            dual.store(builder, value, at, kind.k)
        else:
            builder.store(value, at, align=8)

    if not shape:
        store(place)
        return
    with cgutils.for_range(builder, _product(builder, shape)) as loop:
        store(builder.gep(place, [loop.index], inbounds=True))


def _place(context: Any, builder: Any, sig: Any, args: Any) -> tuple[Any, list[Any]]:
    """The address of array[index], and the dimensions of what is there: none of an element."""
    type_, index_type, array, index = sig.args[0], sig.args[1], args[0], args[1]
    kinds, values = _indices(index_type), [index]
    if isinstance(index_type, types.BaseTuple):
        values = [builder.extract_value(index, i) for i in range(len(kinds))]
    shape = [builder.extract_value(array, 1 + i) for i in range(type_.ndim)]
    rest = shape[len(values) :]
    if isinstance(kinds[-1], types.SliceType):
        part = context.make_helper(builder, kinds[-1], values[-1])
        n = shape[len(values) - 1]
        # A slice ends with the array, as in numpy; its start is not checked.
        stop = builder.select(builder.icmp_signed("<", part.stop, n), part.stop, n)
        values[-1] = part.start
        kinds = (*kinds[:-1], types.int64)
        rest = [builder.sub(stop, part.start, flags=["nsw"]), *rest]
    offset = WORD(0)
    for i, n in enumerate(shape):
        # Horner's rule over the dimensions; nsw lets LLVM reckon with indices that do not overflow.
        offset = builder.mul(offset, n, flags=["nsw"])
        if i < len(values):
            value = context.cast(builder, values[i], kinds[i], types.int64)
            offset = builder.add(offset, value, flags=["nsw"])
    return builder.gep(builder.extract_value(array, 0), [offset], inbounds=True), rest


def _product(builder: Any, numbers: list[Any]) -> Any:
    product = numbers[0]
    for n in numbers[1:]:
        product = builder.mul(product, n, flags=["nsw"])
    return product


@intrinsic  # type: ignore[untyped-decorator]
def copy_view(typing: Any, source: Any, out: Any) -> Any:
    """out[...] = source"""
    if source.dtype != out.dtype:
        raise TypeError(f"copy: {source} is not {out}")
    numbers = 1 + source.dtype.k if isinstance(source.dtype, Dual) else 1

    def generate(context: Any, builder: Any, _: Any, args: Any) -> Any:
        shape = [builder.extract_value(args[0], 1 + i) for i in range(source.ndim)]
        to, from_ = (builder.extract_value(arg, 0) for arg in (args[1], args[0]))
        cgutils.raw_memcpy(builder, to, from_, _product(builder, shape), WORD(8 * numbers))
        return context.get_dummy_value()

    return types.none(source, out), generate


def address_and_length(context: Any, builder: Any, type_: Any, value: Any) -> tuple[Any, Any]:
    """Address and length of a view of one dimension."""
    return builder.extract_value(value, 0), builder.extract_value(value, 1)
