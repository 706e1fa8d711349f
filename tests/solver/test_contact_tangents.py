"""Rows of contacts, stops and friction, and the Newton matrix with them, against differences."""

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Contact,
    Cylindrical,
    ForceTable,
    Hertz,
    Impact,
    JointFriction,
    Stop,
    Stribeck,
)

from .test_tangents import (  # noqa: F401 - fixtures
    AXIS,
    PAIRS,
    Point,
    assert_tangents,
    difference,
    make_body,
    make_pair,
    step_residuals,
    whole_matrix,
)


def oval(a, b, n=16):
    angles = np.linspace(0.0, 2.0 * np.pi, n + 1)
    points = np.column_stack([a * np.cos(angles), b * np.sin(angles)])
    points[-1] = points[0]
    return points


SHAPES = {
    "plane": {"shape": "plane", "axis": AXIS, "ball": 8.0},
    "sphere": {"shape": "sphere", "radius": 4.0, "ball": 4.0},
    "cylinder": {"shape": "cylinder", "axis": AXIS, "radius": 4.0, "ball": 4.0},
    "profile": {"shape": "profile", "axis": AXIS, "points": oval(0.2, 0.15), "ball": 8.0},
    "hollow sphere": {"shape": "sphere", "radius": 0.2, "ball": 0.1, "hollow": True},
    "hollow cylinder": {
        "shape": "cylinder",
        "axis": AXIS,
        "radius": 0.2,
        "ball": 0.1,
        "hollow": True,
    },
}
"""in which a ball is deep wherever it is"""
COMPLIANCES = {
    "linear": {"impact": Impact(stiffness=30.0)},
    "power": {"impact": Impact(stiffness=30.0, exponent=1.5, restitution=0.6, slow=2.0)},
    "table": {"impact": Impact(law=ForceTable((0.0, 1.0, 40.0), (0.0, 5.0, 90.0)), damping=0.1)},
    "hertz": {"hertz": Hertz([30.0, 50.0], [0.3, 0.2]), "impact": Impact(damping=0.02)},
    "patch": {"hertz": Hertz([3e3, 5e3], [0.3, 0.2]), "patch": [0.0, 9.0]},
}
FRICTIONS = {
    "none": {},
    "sticks": {"friction": 500.0},
    "slips": {"friction": 0.2},
    "stribeck": {"friction": Stribeck(0.4, 0.2, 3.0)},
}


@pytest.fixture(autouse=True)
def deep(monkeypatch):
    """Balls may start as deep as they like."""
    monkeypatch.setattr(Contact, "check_depth", lambda contact, depth, size: None)


def contact(shape="plane", compliance="linear", friction="none", between=("a.i0", "b.i0")):
    rubs = {} if friction == "none" else {"tangential_stiffness": 3.0, "tangential_damping": 0.2}
    return Contact(
        "contact",
        between,
        **SHAPES[shape],
        **COMPLIANCES[compliance],
        **FRICTIONS[friction],
        **rubs,
    )


def closed(model, seed=0):
    """A point in a step, at which the contact is closed and its bristle is bent."""
    point = Point.of(model, seed)
    rng = np.random.default_rng(seed + 1)
    couplings, work = point.state.couplings, point.work.couplings
    work.elapsed[:] = point.system.scheme.h
    couplings.rate[:] = rng.uniform(-1.0, 1.0, len(couplings.rate))
    couplings.bristle[:] = rng.uniform(-0.3, 0.3, len(couplings.bristle))
    work.slip_axis[:] += rng.uniform(-0.3, 0.3, work.slip_axis.shape)
    return point.evaluated()


def assert_newton_matrix(point):
    n = point.n_q + len(point.active) + len(point.state.couplings.lam)
    expected = np.vstack(difference(lambda z: step_residuals(point, z), n, h=1e-4))
    point.evaluated()
    found = whole_matrix(point)
    rows = np.abs(expected).max(axis=1, keepdims=True)
    np.testing.assert_allclose(found / rows, expected / rows, rtol=0, atol=3e-9)


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
@pytest.mark.parametrize("shape", SHAPES)
def test_the_gap_and_its_wrench(make_pair, shape, kinds):  # noqa: F811
    assert_tangents(make_pair(kinds, contacts=(contact(shape),)))


@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("shape", SHAPES)
def test_the_newton_matrix_of_a_contact(make_pair, shape, friction):  # noqa: F811
    model = make_pair(("rigid", "flexible"), contacts=(contact(shape, "power", friction),))
    point = closed(model)
    sticks = {"none": 1, "sticks": 1, "slips": 2, "stribeck": 2}
    assert point.work.couplings.status[0] == sticks[friction]
    assert_newton_matrix(point)


@pytest.mark.parametrize("compliance", COMPLIANCES)
def test_the_newton_matrix_of_a_law(make_pair, compliance):  # noqa: F811
    model = make_pair(("flexible", "rigid"), contacts=(contact("sphere", compliance, "slips"),))
    assert_newton_matrix(closed(model, seed=2))


@pytest.mark.parametrize("coordinate", ["angle", "distance"])
def test_the_newton_matrix_of_a_stop(make_pair, coordinate):  # noqa: F811
    joint = Cylindrical("a.i0", "b.i0", AXIS, name="joint")
    stop = Stop("stop", "joint", coordinate, [10.0, 11.0], Impact(stiffness=30.0, exponent=1.5))
    assert_newton_matrix(closed(make_pair(("rigid", "flexible"), (joint,), stops=(stop,))))


@pytest.mark.parametrize("coefficient", [0.01, 500.0], ids=["slips", "sticks"])
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_the_newton_matrix_of_friction_in_a_joint(make_pair, kind, coefficient):  # noqa: F811
    radius = 0.2 if kind == "revolute" else None
    stribeck = Stribeck(2.0 * coefficient, coefficient, 3.0)
    friction = JointFriction(stribeck, radius, 0.5, 0.1, 0.3, 3.0, 0.6)
    joint = JOINTS[kind]("a.i0", "b.i0", AXIS, name="joint", friction=friction)
    point = closed(make_pair(("rigid", "flexible"), (joint,)), seed=3)
    assert point.work.couplings.status[0] == (2 if coefficient < 1.0 else 1)
    assert_newton_matrix(point)


@pytest.mark.parametrize("elapsed", [0.0, np.inf])
def test_the_newton_matrix_at_a_start_where_friction_does_not_act(make_pair, elapsed):  # noqa: F811
    point = closed(make_pair(("rigid", "flexible"), contacts=(contact(friction="slips"),)))
    point.work.couplings.elapsed[:] = elapsed
    assert_newton_matrix(point)
