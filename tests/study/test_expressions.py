"""Arithmetic of study files: values, and what is refused."""

import math

import pytest
from duhamel.study import StudyError
from duhamel.study.expressions import evaluate, names_in

VALUES = {"a": 3.0, "n": 7, "v": [1, 2], "path": "x.h5", "bodies.hub.inertia.2": 4.0, "yes": True}


def value(text: str):
    return evaluate(text, VALUES.__getitem__)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1 + 2 * a ** 2", 19.0),
        ("-a ** 2", -9.0),
        ("a / 2 - 1", 0.5),
        ("sqrt(a * 12) + cos(pi)", 5.0),
        ("bodies.hub.inertia[2] / 2", 2.0),
        ("atan2(1, 1) + hypot(3, 4)", math.pi / 4 + 5),
        (" max(1, a) ", 3.0),
        ("2e-3 * a", 6e-3),
        ("pi", math.pi),
        ("v", [1, 2]),
        ("path", "x.h5"),
    ],
)
def test_it_is_that_of_python(text, expected):
    assert value(text) == expected


@pytest.mark.parametrize("text", ["2 * n", "round(a / 2)", "n ** 2", "-n"])
def test_integers_stay_integers(text):
    assert isinstance(value(text), int)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected arithmetic, found ''"),
        ("a +", "expected arithmetic, found 'a +'"),
        ("a; a", "expected arithmetic"),
        ("__import__('os')", "no function '__import__'"),
        ("a.__class__.mro()", "no function 'a.__class__.mro'"),
        ("(1).real", "expected numbers, names"),
        ("[a for a in v]", "expected numbers, names"),
        ("a if n else 2", "expected numbers, names"),
        ("n < 3", "expected numbers, names"),
        ("n % 3", "expected numbers, names"),
        ("'a' * 3", "expected a number, found 'a'"),
        ("b'a'", "expected a number, found b'a'"),
        ("2 * v", "expected a number, found v = [1, 2]"),
        ("2 * yes", "expected a number, found yes = True"),
        ("sqrt(-a)", "expected arithmetic, found 'sqrt(-a)'"),
        ("(-a) ** 0.5", "a root of a negative number"),
        ("sqrt(1, 2)", "expected arithmetic"),
        ("sqrt(x=1)", "expected numbers, names"),
        ("1 / (n - 7)", "zero"),
        ("9 ** 9 ** 9 ** 9", "expected arithmetic"),
        ("1e308 * 10", "expected a finite number, found inf"),
        ("-" * 20000 + "1", "expected at most 1000 characters, found 20001"),
        ("9" * 900, "expected a finite number, found an integer of"),
        ("round(1e300)", "expected a finite number, found an integer of"),
        ("9" * 900 + " * 1.0", "expected arithmetic"),
        ("(" * 400 + "1" + ")" * 400, "expected arithmetic"),
        ("1(2)", "no function '1'"),
    ],
)
def test_all_else_is_refused_in_one_line(text, message):
    with pytest.raises(StudyError) as error:
        value(text)
    assert message in str(error.value)
    assert len(str(error.value).splitlines()) == 1
    assert len(str(error.value)) < 1000


def test_names_are_those_that_stand_for_values():
    assert set(names_in("sqrt(k / bodies.hub.mass) * pi + k")) == {"k", "bodies"}
