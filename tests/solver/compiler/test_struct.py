"""Records as machine code sees them."""

import copy
import gc
import pickle
import weakref

import numpy as np
import pytest
from duhamel.solver.arrays import Array, Index
from duhamel.solver.compiler.struct import Struct, array


class Inner(Struct):
    scale: float
    matrix: Array = array("n", 3)


class Outer(Struct):
    count: int
    flag: bool
    inner: Inner
    number: Index = array("n")
    fixed: Array = array(2, 2)


def an_outer(**changes):
    inner = Inner(scale=0.5, matrix=np.arange(12.0).reshape(4, 3))
    values = {
        "count": 7,
        "flag": True,
        "inner": inner,
        "number": np.arange(5),
        "fixed": np.eye(2),
    }
    return Outer(**values | changes)


def address(array):
    return array.__array_interface__["data"][0]


def test_words_are_numbers_addresses_and_variable_dimensions_in_order():
    record = an_outer(count=-7)
    assert record.words.tolist() == [
        -7,
        1,
        np.float64(0.5).view(np.int64),
        address(record.inner.matrix),
        4,
        address(record.number),
        5,
        address(record.fixed),
    ]
    assert record.address == address(record.words)
    assert Outer.layout["number"][0] == 5
    assert Outer.n_words == 8


def test_fields_are_what_was_given():
    matrix = np.zeros((2, 3))
    assert Inner(scale=1.0, matrix=matrix).matrix is matrix


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("number", np.arange(5.0), r"expected an array int64 \(n\), found float64 \(5,\)"),
        ("number", np.arange(5, dtype=np.int32), "found int32"),
        ("number", [1, 2], "expected an array .* found list"),
        ("fixed", np.eye(3), r"expected an array float64 \(2, 2\), found float64 \(3, 3\)"),
        ("fixed", np.zeros(4), r"found float64 \(4,\)"),
        ("fixed", np.eye(2, dtype=">f8"), "found >f8"),
        ("fixed", np.eye(4)[::2, ::2], "expected a contiguous array .* found strides"),
        ("fixed", np.asfortranarray([[1.0, 2.0], [3.0, 4.0]]), "expected a contiguous array"),
        ("inner", np.eye(2), "expected Inner, found ndarray"),
        ("count", 1.5, "'float' object cannot be interpreted as an integer"),
    ],
)
def test_a_value_of_another_kind_is_refused_by_the_name_of_its_field(name, value, message):
    with pytest.raises(TypeError, match=rf"^Outer\.{name}: .*{message}"):
        an_outer(**{name: value})


def test_fields_that_are_missing_or_unknown_are_named():
    with pytest.raises(TypeError, match="Inner: no matrix, scale"):
        Inner()
    with pytest.raises(TypeError, match="Inner has no other"):
        Inner(scale=1.0, matrix=np.zeros((1, 3)), other=2)


def test_a_field_of_another_type_cannot_be_declared():
    with pytest.raises(TypeError, match="found <class 'str'>"):
        type("Wrong", (Struct,), {"__annotations__": {"name": str}})


def test_a_record_of_zeros_is_allocated_from_the_sizes_of_its_dimensions():
    record = Outer.allocate({"n": 3})
    assert record.inner.matrix.shape == (3, 3)
    assert record.number.dtype == np.int64
    assert [part.any() for part in record.arrays()] == [False] * 3
    assert (record.count, record.flag, record.inner.scale) == (0, False, 0.0)


def test_a_replaced_record_shares_the_other_arrays():
    record = an_outer()
    other = record.replace(count=8)
    assert other.words.tolist() == [8, *record.words[1:].tolist()]
    assert other.fixed is record.fixed
    assert record.count == 7


def test_a_field_cannot_be_bound_anew():
    record = an_outer()
    with pytest.raises(AttributeError, match=r"Outer\.fixed cannot be bound anew: fixed\[\.\.\.\]"):
        record.fixed = np.eye(2)
    record.fixed[...] = 2.0
    assert record.fixed.sum() == 8.0


def test_a_record_keeps_its_arrays():
    record = Inner(scale=1.0, matrix=np.zeros((1000, 3)))
    alive = weakref.ref(record.matrix)
    gc.collect()
    assert alive() is not None
    del record
    assert alive() is None


@pytest.mark.parametrize(
    "copied", [copy.deepcopy, lambda record: pickle.loads(pickle.dumps(record))]
)
def test_a_copy_points_to_its_own_arrays(copied):
    record = an_outer()
    other = copied(record)
    assert other.words[7] == address(other.fixed) != address(record.fixed)
    assert other.words[3] == address(other.inner.matrix)
    np.testing.assert_array_equal(other.fixed, record.fixed)
