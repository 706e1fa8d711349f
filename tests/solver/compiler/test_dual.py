"""Numbers with derivatives in compiled code: each operation, its kinks, and every force law."""

import ctypes
import math

import numpy as np
import pytest
from duhamel.solver import BoucWenLaw, UserLaw, laws
from duhamel.solver.arrays import Array
from duhamel.solver.compiler import marks, object_file
from duhamel.solver.compiler.dual_calls import address_with_derivatives
from duhamel.solver.compiler.foreign import address_of
from duhamel.solver.compiler.parts import filled_parts, larger_parts, largest_part, n_parts, part
from duhamel.solver.compiler.struct import Struct, array
from duhamel.solver.derivatives.records import DualRecord

from ..laws import LAWS


class Given(Struct):
    x: Array = array("n")
    y: Array = array("n")
    dropped: Array = array("n", real=True)


class Point(Struct):
    parameters: Array = array("n")
    memory: Array = array("n_m")
    motion: Array = array(2)
    out: Array = array(4)


def operate(given: Given) -> int:
    """Each operation of x = (0.7, -1.3), into y; how many there are."""
    a, b, y = given.x[0], given.x[1], given.y
    y[0] = a + b - 2.0 * b
    y[1] = (a - 3.0) * b / (a * a + 2)
    y[2] = a**1.5 + b**2 + a**b
    y[3] = math.atan2(a, b) + math.sqrt(a) * abs(b)
    y[4] = math.sin(a) * math.cos(b) + math.exp(-a) * math.log(a)
    y[5] = max(a, b, 0.1) + min(a, b) + 1.0 / a
    y[6] = round(3.0 * a) * b + int(4.0 * b)
    c = 1.0
    for _ in range(3):
        c *= -a
    y[7] = c if b > a or a == b else 2.0 * c
    given.dropped[0] = a * b
    y[8] = given.dropped[0]
    return 9


def meet_kinks(given: Given) -> None:
    """At x = (0, 0), with derivatives."""
    a, b, y = given.x[0], given.x[1], given.y
    y[0] = abs(a)
    y[1] = math.sqrt(a * a + b * b)
    # What is zero with a derivative is not skipped as zero.
    y[2] = 1.0 if a == 0.0 else 2.0
    y[3] = 1.0 if a - a == 0.0 else 2.0
    y[4] = 1.0 if a != 0.0 else 2.0


def take_parts(given: Given) -> tuple[int, float, float]:
    a, y = given.x[0], given.y
    y[0] = larger_parts(a, given.x[1])
    y[1] = filled_parts(a, 7.0)
    return n_parts(a), part(a, 2), largest_part(a)


def of_a_law(given: Point, number: int) -> None:
    c, rate, out = given.motion[0], given.motion[1], given.out
    force, by_c, by_rate, energy = laws.evaluate_law(
        number, given.parameters, given.memory, 1e-3, c, rate
    )
    out[0], out[1], out[2], out[3] = force, by_c, by_rate, energy


FUNCTIONS = (operate, meet_kinks, take_parts, of_a_law)
K = 2


@pytest.fixture(scope="module")
def call():
    """Calls of functions of this file with numbers that have two derivatives."""
    from duhamel.solver.compiler.build import build
    from duhamel.solver.compiler.targets import CodeTarget

    registries = (marks.COMPILED_FUNCTIONS, marks.COMPILED_ENTRIES, marks.DIFFERENTIABLE_ENTRIES)
    kept = [dict(registry) for registry in registries]
    marks.COMPILED_ENTRIES.clear()
    marks.DIFFERENTIABLE_ENTRIES.clear()
    try:
        symbols = {f: marks.differentiable(marks.entry(f)).symbol for f in FUNCTIONS}
        engine = object_file.engine_of(*build([CodeTarget(is_loaded=True, derivatives=K)]))
    finally:
        for registry, content in zip(registries, kept, strict=True):
            registry.clear()
            registry.update(content)

    def call(function, record, *numbers):
        kinds = [ctypes.c_void_p, ctypes.c_void_p, *[ctypes.c_int64] * len(numbers)]
        results = (ctypes.c_double * 4)()
        code = ctypes.CFUNCTYPE(None, *kinds)(engine.get_function_address(symbols[function]))
        code(ctypes.addressof(results), record.address, *numbers)
        return list(results)

    return call


def given(x, derivatives):
    record = Given(x=np.array(x), y=np.zeros(9), dropped=np.zeros(1))
    return DualRecord(record, K, {"x": np.array(derivatives)})


def test_operations_have_the_derivatives_of_differences(call):
    """By x and by a direction of both numbers."""
    directions = np.array([[1.0, 0.4], [0.0, -0.9]])
    record = given([0.7, -1.3], directions)
    n = int(call(operate, record)[0])
    found = record.arrays["y"]

    def plain(x):
        values = Given(x=x, y=np.zeros(9), dropped=np.zeros(1))
        operate(values)
        return values.y

    np.testing.assert_allclose(found[:n, 0], plain(np.array([0.7, -1.3])), rtol=1e-14)
    for i in range(K):
        d = 1e-6 * directions[:, i]
        x = np.array([0.7, -1.3])
        expected = (plain(x + d) - plain(x - d)) / 2e-6
        expected[8] = 0.0  # of a field without derivatives
        np.testing.assert_allclose(found[:n, 1 + i], expected, atol=1e-8)


def test_at_a_kink_the_derivative_is_the_mean_of_both_sides(call):
    record = given([0.0, 0.0], [[1.0, 0.0], [0.0, 1.0]])
    call(meet_kinks, record)
    y = record.arrays["y"]
    np.testing.assert_array_equal(y[:2], np.zeros((2, 3)))
    assert y[2:5, 0].tolist() == [2.0, 1.0, 1.0]


def test_parts_of_a_number(call):
    record = given([-0.5, 0.25], [[2.0, -9.0], [-3.0, 4.0]])
    assert call(take_parts, record)[:3] == [3.0, -9.0, 9.0]
    assert record.arrays["y"][:2].tolist() == [[0.5, 3.0, 9.0], [7.0, 7.0, 7.0]]


@pytest.mark.parametrize("name", LAWS)
def test_each_law_has_the_slopes_that_it_says(call, name):
    """Of force by coordinate and rate: to rounding, where differences have only eight digits."""
    law = LAWS[name]
    # Its slope is that of a differential equation, which is solved by steps.
    by_steps = isinstance(law, BoucWenLaw) and law.exponent != 1.0
    tolerance = 1e-6 if by_steps else 1e-11
    parameters = np.array(law.parameters(), dtype=float)
    if isinstance(law, UserLaw):
        functions = enumerate(parameters[:2].astype(int).tolist())
        parameters[:2] = [one and address_with_derivatives(one, i == 0, K) for i, one in functions]
    for c, rate in ((0.13, 0.3), (-0.31, -0.2), (0.62, 1.7), (-0.04, 2.5)):
        point = Point(
            parameters=parameters,
            memory=np.array(law.memories(), dtype=float),
            motion=np.array([c, rate]),
            out=np.zeros(4),
        )
        record = DualRecord(point, K, {"motion": np.eye(2)})
        call(of_a_law, record, law.number)
        force, by_c, by_rate, _ = record.arrays["out"]
        scale = abs(by_c[0]) + abs(by_rate[0]) + abs(force[0])
        np.testing.assert_allclose(force[1:], [by_c[0], by_rate[0]], atol=tolerance * scale)


def of_everything(parameters, memory, h, c, rate):
    """Functions that laws of users alone call, by the standard library and by numpy."""
    x, y = c + parameters[0], rate * parameters[1]
    library = math.tan(x) + math.atan(y) * math.sinh(x) - math.cosh(y) * math.tanh(x * y)
    arrays = np.exp(x) * np.sin(y) + np.cos(x) * np.sqrt(x) + np.log(x) * np.abs(y) * np.tanh(y)
    return library, arrays, math.fabs(y) * x, len(memory)


def test_functions_of_users_have_all_slopes():
    at = np.array([0.3, 1.4, 0.5, -0.8])
    out, parameters, motion = np.zeros((4, 5)), np.zeros((2, 5)), np.zeros((2, 5))
    parameters[:, 0], motion[:, 0] = at[:2], at[2:]
    parameters[:, 1:3] = motion[:, 3:5] = np.eye(2)
    address = address_with_derivatives(int(address_of(of_everything, True)), True, 4)
    words = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64]
    code = ctypes.CFUNCTYPE(None, *words, ctypes.c_double, ctypes.c_void_p)(address)
    arrays = (out.ctypes.data, parameters.ctypes.data, 2, out.ctypes.data, 0)
    code(*arrays, 1e-3, motion.ctypes.data)

    def plain(x):
        return np.array(of_everything(x[:2], np.zeros(0), 1e-3, *x[2:]))

    np.testing.assert_allclose(out[:, 0], plain(at), rtol=1e-14)
    for i, d in enumerate(1e-6 * np.eye(4)):
        expected = (plain(at + d) - plain(at - d)) / 2e-6
        np.testing.assert_allclose(out[:, 1 + i], expected, atol=1e-8)
