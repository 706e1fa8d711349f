"""Mechanisms whose parameters are keys and functions."""

import duhamel as du
import pytest
from duhamel.study import StudyError

G = 10.0


def flying() -> du.Mechanism:
    m = du.Mechanism(gravity=[0.0, 0.0, -G])
    m.add(du.RigidBody(2.0, [0.1] * 3), name="ball")
    m.settings = du.solver.Settings(t_end=1.0, step=0.1)
    return m


def push(m: du.Mechanism, force: float) -> None:
    m.add(du.loads.Force(m["ball"], "z", du.signals.Constant(force)))


def test_functions_change_copies_and_keys_what_these_have():
    """z = (F / m - g) / 2 within a second: F = 2 m with g = 9, z = -3.5, and 24 N with g = 10."""
    m = flying()
    parameters = {
        "force": du.Parameter(push, bounds=(0.0, 40.0), start=4.0),
        "g": "simulation.gravity.2",
    }
    made = m.with_values(parameters, {"force": 4.0, "g": -9.0})
    assert made.simulate()["ball"].position[-1, 2] == pytest.approx(-3.5)
    assert repr(m) == "<Mechanism: bodies ball>"
    for values, told in (
        ({"force": 4.0, "g": -9.0, "h": 1.0}, "values.h: no such parameter; there are: force, g"),
        ({"force": 4.0}, "values.g: has no value; there are: force, g"),
        ({"force": 4.0, "g": "low"}, "g: expected a number, found 'low'"),
    ):
        with pytest.raises(StudyError, match=told):
            m.with_values(parameters, values)
    found = m.optimize(
        {"force": parameters["force"]},
        {"end": "final ball.position.z"},
        minimize="force",
        constraints={"end": (1.0, None)},
    )
    assert found.converged
    assert found.values["force"] == pytest.approx(24.0, rel=1e-6)


def test_a_function_is_fitted_as_a_key_is():
    t = [0.5, 1.0]
    found = flying().fit(
        {"force": du.Parameter(push, start=4.0)},
        {"ball.position.z": (t, [0.5 * (7.0 / 2.0 - G) * x**2 for x in t])},
    )
    assert found.values["force"] == pytest.approx(7.0, rel=1e-6)


def test_what_is_wrong_with_parameters_is_named():
    m = flying()
    with pytest.raises(StudyError, match=r"parameters.force: of a function expected a start"):
        m.sensitivities({"force": du.Parameter(push)}, ["final ball.position.z"])
    with pytest.raises(StudyError, match=r"parameters.bodies.bell.mass: .*bell"):
        m.optimize({"m": "bodies.bell.mass"}, minimize="m")
    with pytest.raises(StudyError, match=r"parameters.m: expected bounds that rise"):
        m.optimize({"m": du.Parameter("bodies.ball.mass", bounds=(3.0, 1.0))}, minimize="m")
    with pytest.raises(StudyError, match=r"series 'position:ball:z': expected times and values"):
        m.fit({"m": "bodies.ball.mass"}, {"ball.position.z": ([0.0, 1.0], [0.0])})


def test_derivatives_by_dual_numbers_and_an_unknown_method():
    """z = g t^2 / 2: half a meter for each m/s^2."""
    arguments = {"g": "simulation.gravity.2"}, {"end": "final ball.position.z"}
    found = flying().sensitivities(*arguments, method="dual")
    assert found.derivative[0, 0] == pytest.approx(0.5, rel=1e-9)
    with pytest.raises(StudyError, match="method: expected differences or dual, found 'exact'"):
        flying().sensitivities(*arguments, method="exact")


def test_values_leave_the_settings_of_the_last_run_alone():
    m = flying()
    m.simulate(t_end=0.5)
    m.with_values({"mass": "bodies.ball.mass"}, {"mass": 3.0})
    assert m._last.t_end == 0.5
