"""One model with every kind of part: quick build, plain Python and stock compiler give the same."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from duhamel.solver.compiler import marks

from . import every_part

RATES = ("velocity", "rate", "energy", "work", "momentum")
"""words in the names of outputs that are of the order of rates"""
ACCELERATIONS = ("acceleration", "force", "moment", "multiplier", "torque", "power")


def order_of(name):
    """The number of time derivatives of positions that an output is like."""
    if name.endswith("momentum") or any(word in name for word in RATES):
        return 1
    return 2 if any(word in name for word in ACCELERATIONS) else 0


def run(path, **environment):
    """The output of the model, in a process of its own."""
    program = [sys.executable, str(Path(every_part.__file__)), str(path)]
    environment = os.environ | environment
    done = subprocess.run(program, env=environment, check=True, capture_output=True, text=True)
    with np.load(path) as file:
        return dict(file), done.stderr


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    return run(tmp_path_factory.mktemp("quick") / "results.npz")[0]


def test_the_model_has_every_part():
    model = every_part.make_model()
    types = {joint.type for joint in model.joints}
    assert types == {name for name in every_part.EVERY_JOINT if not name.startswith("driven")}
    from duhamel.solver import JOINTS, UserLaw
    from duhamel.solver.couplings.springs import SPRING_TYPES
    from duhamel.solver.laws.law import FORCE_LAWS

    assert types == set(JOINTS)
    assert {spring.type for spring in model.springs} == set(SPRING_TYPES)
    laws = {law.number for spring in model.springs for row in spring.laws_of_rows for law in row}
    known = {form.kind.number for forms in FORCE_LAWS.forms.values() for form in forms}
    assert laws == known | {UserLaw.number}


def assert_same(found, expected):
    """Up to rounding: 1e-12 of positions is 1e-12 / h of rates, and so on."""
    for name, array in expected.items():
        size = max(1.0, np.abs(array).max(initial=0.0))
        tolerance = 1e-12 / every_part.H ** order_of(name) * size
        np.testing.assert_allclose(found[name], array, rtol=0, atol=tolerance, err_msg=name)


def test_plain_python_gives_the_same(quick, tmp_path):
    plain, _ = run(tmp_path / "plain.npz", NUMBA_DISABLE_JIT="1")
    assert_same(plain, quick)
    assert np.abs(quick["body_position"][-1] - quick["body_position"][0]).max() > 1e-2


@pytest.mark.validation
def test_the_stock_compiler_gives_the_same(quick, tmp_path):
    """Not to the last bit: sums may be reordered, and are, after other functions were inlined."""
    stock, said = run(
        tmp_path / "stock.npz", DUHAMEL_COMPILER="stock", DUHAMEL_CACHE=str(tmp_path / "cache")
    )
    assert "numba's public interface" in said
    assert_same(stock, quick)


def test_every_compiled_function_is_of_the_time_step():
    """Others would be compiled with every change of theirs."""
    places = {function.__module__ for function in marks.COMPILED_FUNCTIONS}
    allowed = ("step.", "laws", "compiler.memory", "compiler.foreign", "compiler.parts")
    allowed = tuple(f"duhamel.solver.{room}" for room in allowed)
    assert [place for place in places if not place.startswith(allowed)] == []
