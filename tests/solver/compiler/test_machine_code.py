"""Machine code against the Python functions that it is made from.

Functions of this file are compiled by themselves, so that each small function of the time step can
be called with random data.
"""

import dis

import numpy as np
import pytest
from duhamel.solver import laws
from duhamel.solver.arrays import Array, Index
from duhamel.solver.compiler import marks, object_file
from duhamel.solver.compiler.memory import copy
from duhamel.solver.compiler.struct import Struct, array
from duhamel.solver.step import elimination, measure, rotations, vectors

from ..laws import LAWS


class Part(Struct):
    rows: Array = array("n", 3)
    cube: Array = array("n", 3, 3)
    index: Index = array("n_i")


class Given(Struct):
    number: float
    count: int
    flag: bool
    part: Part


def take(given: Given) -> tuple[float, int, bool, bool]:
    """One result of every type, out of every type of field."""
    part, total = given.part, 0.0
    for i in range(len(part.rows)):
        row = part.rows[i]
        for j in range(3):
            total += row[j] * part.cube[i, j, 2]
    return total + given.number, given.count + part.index[1], given.flag, not given.flag


def is_positive(number: float, count: int, flag: bool) -> bool:
    return number * count > 0.0 and flag


def fill(values: Array, index: Index, first: int) -> None:
    """A slice to the end, a slice with two ends, and a number for both."""
    values[first:] = 2.0
    values[: index[0]] = -1.0
    values[first : index[1]] = index[2]


def copy_rows(given: Given, to: Part) -> int:
    copy(given.part.rows, to.rows)
    copy(given.part.cube[1], to.cube[0])
    copy(given.part.index, to.index)
    return len(to.rows)


def rotate(psi: Array, moment: Array, out: Part) -> float:
    """Every function of rotations, its result in a row or a matrix of its own."""
    rotations.exponential(psi, out.cube[0])
    rotations.tangent(psi, out.cube[1])
    rotations.tangent_inverse(psi, out.cube[2])
    rotations.tangent_derivative(psi, moment, out.cube[3])
    rotations.relative_rotation(out.cube[0], out.cube[1], out.rows[0])
    return rotations.square_norm(psi)


def turn(psi: Array, q: Array, product: Array, out: Part) -> float:
    half = out.cube[5]
    rotations.quaternion_exponential(psi, q)
    rotations.quaternion_product(q, q, product)
    for i in range(4):
        product[i] *= 3.0
    rotations.normalize(product)
    rotations.quaternion_matrix(product, half)
    c0, c1, c2, c3, c4, c5 = rotations.stumpff(rotations.square_norm(psi))
    return c0 + c1 + c2 + c3 + c4 + c5


def combine(out: Part, i: int, scale: float) -> float:
    """Every function of vectors."""
    a, b = vectors.row(out.rows, i), vectors.triple(out.rows[i + 1], 0)
    c = vectors.cross(vectors.add(a, b), vectors.subtract(a, vectors.scale(scale, b)))
    d = vectors.rotate(out.cube, i, c)
    e = vectors.multiply(out.cube[i + 1], vectors.rotate_back(out.cube, i + 2, d))
    vectors.add_to_row(out.rows, i + 2, 0, e)
    return vectors.dot(c, e) + vectors.inner(out.rows[i], out.rows[i + 1])


def of_a_law(
    number: int, parameters: Array, memory: Array, c: float
) -> tuple[float, float, float, float]:
    return laws.evaluate_law(number, parameters, memory, 1e-3, c, 0.3)


def remember_it(number: int, parameters: Array, memory: Array, c: float) -> None:
    laws.remember_law(number, parameters, memory, 1e-3, c, 0.3)


def of_no_law(parameters: Array, c: float) -> tuple[float, float, float, float]:
    return laws.evaluate_law(-1, parameters, parameters[:0], 1e-3, c, 0.3)


def weigh(residual: float, scale: float) -> float:
    return measure.relative(residual, scale, 1e-12, 1e-6)


def subtract(factor: float, source: Array, target: Array) -> None:
    elimination._subtract(factor, source, target)


FUNCTIONS = (
    take,
    is_positive,
    fill,
    copy_rows,
    rotate,
    turn,
    combine,
    of_a_law,
    remember_it,
    of_no_law,
    weigh,
    subtract,
)


@pytest.fixture(scope="module")
def machine_code():
    """The entries of this file, by name."""
    from duhamel.solver.compiler.build import build
    from duhamel.solver.compiler.targets import CodeTarget

    compiled, entries = dict(marks.COMPILED_FUNCTIONS), dict(marks.COMPILED_ENTRIES)
    marks.COMPILED_ENTRIES.clear()
    try:
        made = {function.__name__: marks.entry(function) for function in FUNCTIONS}
        engine = object_file.engine_of(*build([CodeTarget(is_loaded=True)]))
    finally:
        for registry, content in (
            (marks.COMPILED_FUNCTIONS, compiled),
            (marks.COMPILED_ENTRIES, entries),
        ):
            registry.clear()
            registry.update(content)
    for entry in made.values():
        entry.bind(engine.get_function_address(entry.symbol))
    return made


@pytest.fixture(params=range(5))
def rng(request):
    return np.random.default_rng(request.param)


@pytest.fixture
def part(rng):
    return Part(
        rows=rng.normal(size=(6, 3)),
        cube=rng.normal(size=(6, 3, 3)),
        index=rng.integers(-9, 9, 4),
    )


@pytest.fixture
def compare(machine_code):
    """Call a function both ways: the same results, and the same left in all arrays."""

    def compare(function, *args):
        entry = machine_code[function.__name__]
        others = [np.copy(arg) if isinstance(arg, np.ndarray) else arg for arg in args]
        others = [
            type(arg)(**{name: np.copy(getattr(arg, name)) for name in arg.layout})
            if isinstance(arg, Part)
            else arg
            for arg in others
        ]
        found, expected = entry(*args), function(*others)
        if expected is None:
            assert found is None
        else:
            assert found == pytest.approx(expected, rel=1e-14, abs=1e-14)
        for arg, other in zip(args, others, strict=True):
            pairs = [(arg, other)]
            if isinstance(arg, Struct):
                pairs = list(zip(arg.arrays(), other.arrays(), strict=True))
            for a, b in pairs:
                np.testing.assert_allclose(a, b, rtol=1e-13, atol=1e-14)

    return compare


def test_fields_and_results_of_every_type(compare, part, rng):
    for flag in (False, True):
        compare(take, Given(number=rng.normal(), count=-(2**40), flag=flag, part=part))


def test_results_are_of_the_annotated_types(machine_code, part):
    given = Given(number=0.5, count=3, flag=True, part=part)
    assert [type(result) for result in machine_code["take"](given)] == [float, int, bool, bool]
    assert machine_code["is_positive"](1.0, 1, True) is True
    assert machine_code["subtract"](1.0, np.ones(2), np.ones(2)) is None


def test_numbers_as_arguments(compare, rng):
    for number in (*rng.normal(size=3), 0.0):
        compare(is_positive, float(number), int(rng.integers(-3, 4)), True)
        compare(is_positive, float(number), 2, False)


def test_arrays_as_arguments_and_slices(compare, rng):
    compare(fill, rng.normal(size=12), np.array([3, 8, 5]), 4)
    compare(fill, rng.normal(size=6), np.array([3, 80, 5]), 4)


def test_copies(compare, part, rng):
    given = Given(number=0.0, count=0, flag=False, part=part)
    compare(copy_rows, given, Part.allocate({"n": 6, "n_i": 4}))


@pytest.mark.parametrize("size", [0.0, 1e-9, 0.3, 0.999, 1.001, 3.0])
def test_rotations(compare, part, rng, size):
    psi = rng.normal(size=3)
    psi *= size / np.linalg.norm(psi)
    compare(rotate, psi, rng.normal(size=3), part)
    compare(turn, psi, np.zeros(4), np.zeros(4), part)


def test_vectors(compare, part, rng):
    compare(combine, part, 2, rng.normal())


@pytest.mark.parametrize("c", [-2.0, -0.5, 0.25, 1.0, 7.0])
@pytest.mark.parametrize("name", LAWS)
def test_laws(compare, name, c):
    law = LAWS[name]
    parameters, memory = np.array(law.parameters()), np.array(law.memories(), float)
    compare(of_no_law, parameters, c)
    compare(of_a_law, law.number, parameters, memory, c)
    compare(remember_it, law.number, parameters, memory, c)
    compare(of_a_law, law.number, parameters, memory, 0.5 * c)


@pytest.mark.parametrize("residual", [0.0, 1e-13, 1e-3, 1.0, np.inf, np.nan])
def test_sizes_of_residuals(compare, residual):
    compare(weigh, residual, 1e-9)
    compare(weigh, residual, 2.0)


@pytest.mark.parametrize("n", [0, 1, 3, 4, 17])
def test_rows_of_elimination(compare, rng, n):
    compare(subtract, rng.normal(), rng.normal(size=n), rng.normal(size=n))


def test_an_argument_of_another_kind_is_refused_by_its_name(machine_code, part):
    with pytest.raises(TypeError, match="take: given: expected Given, found Part"):
        machine_code["take"](part)
    with pytest.raises(TypeError, match="fill: index: expected an array int64"):
        machine_code["fill"](np.zeros(3), np.zeros(3), 0)
    with pytest.raises(TypeError, match="argument"):
        machine_code["take"]()


def test_compiled_functions_raise_nothing():
    """An exception would be lost, and its function would have stopped halfway."""
    raising = [
        function.__qualname__
        for function in marks.COMPILED_FUNCTIONS
        if any(step.opname == "RAISE_VARARGS" for step in dis.get_instructions(function))
    ]
    assert raising == []
