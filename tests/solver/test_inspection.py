"""`check`: what it foretells, against closed forms and against the run itself."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from duhamel.solver import (
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    ModelError,
    Prismatic,
    ResultsError,
    RigidBody,
    Spring,
    Start,
    TabulatedLaw,
    check,
    simulate,
)
from duhamel.solver.inspection import MIN_STEPS_IN_PERIOD
from duhamel.solver.signals.curves import Constant

from .models import model_of

EI, LENGTH, MASS_PER_LENGTH = 5.5, 0.5, 0.0858
"""of the paper's beam"""
CANTILEVER = np.array([1.8751041, 4.6940911, 7.8547574])
"""beta L of a clamped and free beam"""
WALL = {"wall": Frame([-0.25, 0, 0])}


def ball(**settings):
    return RigidBody(2.0, [0.1, 0.1, 0.1], **settings)


def clamped(element, **settings):
    return model_of(
        bodies={"beam": FlexibleBody(element)},
        joints=(Fixed("ground.wall", "beam.root", name="clamp"),),
        ground_frames=WALL,
        t_end=0.3,
        **settings,
    )


def test_the_frequencies_of_a_clamped_beam(beam):
    found = check(clamped(beam.element)).frequencies
    expected = CANTILEVER**2 * np.sqrt(EI / (MASS_PER_LENGTH * LENGTH**4)) / (2 * np.pi)
    np.testing.assert_allclose(found[:6], np.repeat(expected, 2), rtol=5e-4)


@pytest.mark.parametrize("gravity", [(-9.81, 0.0, 0.0), (0.0, 0.0, -9.81)])
def test_a_vibration_that_gravity_starts_is_told_with_its_cause(beam, gravity):
    """A bar that hangs: gravity along it excites its fast stretching, at rest it is still."""
    model = clamped(beam.element, gravity=gravity)
    slow = replace(model, settings=replace(model.settings, step=1e-4, t_end=0.01))
    warned = [w for w in check(slow).warnings if "fastest vibration" in w]
    along = gravity[0] != 0.0
    assert len(warned) == along
    assert all("gravity acts suddenly at t = 0" in line for line in warned)
    still = replace(slow, settings=replace(slow.settings, start="equilibrium"))
    assert not [w for w in check(still).warnings if "fastest vibration" in w]


def test_a_blow_that_gravity_does_not_cause_is_not_told_as_such(beam):
    model = clamped(
        beam.element,
        loads=(Force("beam.tip", (1.0, 0.0, 0.0), Constant(1.0)),),
        gravity=(-9.81, 0.0, 0.0),
    )
    fast = replace(model, settings=replace(model.settings, step=1e-4, t_end=0.01))
    (line,) = (w for w in check(fast).warnings if "fastest vibration" in w)
    assert "gravity" not in line
    assert "take a smaller step in [simulation]: step = " in line


def test_the_order_of_each_flexible_body_is_told(beam, with_second_order):
    element = with_second_order(beam.element)
    orders = {"auto": "3", "full": "3", "off": "off"}
    for second_order, told in orders.items():
        body = FlexibleBody(element, second_order=second_order)
        checked = check(model_of(bodies={"b": body}, t_end=0.01))
        assert f"terms of second order, coordinates: b {told}" in str(checked).splitlines()
    checked = check(clamped(beam.element))
    assert "terms of second order, coordinates: beam none" in str(checked).splitlines()
    assert "second order" not in str(check(model_of(bodies={"ball": ball()}, step=1e-3)))


def test_the_frequency_of_a_mass_on_springs():
    """A linear one and the slope of a law beside it, at the deformation of the start."""
    law = TabulatedLaw((-1.0, 0.0, 1.0), (-30.0, 0.0, 70.0))
    spring = Spring("s", "point", ("ground.post", "ball"), stiffness=50.0, rest=0.5, law=law)
    rail = Prismatic("ground", "ball", [1, 0, 0], name="rail")
    model = model_of(
        bodies={"ball": ball(start=Start(position=[0.9, 0, 0]))},
        joints=(rail,),
        springs=(spring,),
        ground_frames={"post": Frame()},
        step=1e-3,
    )
    found = check(model)
    np.testing.assert_allclose(found.frequencies, np.sqrt((50.0 + 70.0) / 2.0) / (2 * np.pi))
    assert found.degrees_of_freedom == 1


def test_what_nothing_resists_has_no_frequency():
    found = check(model_of(bodies={"ball": ball()}, step=1e-3))
    assert found.frequencies.tolist() == []
    assert "natural frequencies [Hz]: none" in str(found)


def test_a_body_without_modes_leaves_the_frequencies_unknown(beam, measured):
    found = check(clamped(measured(beam.element)))
    assert found.frequencies is None
    assert "not known" in str(found)


def test_a_step_that_is_long_for_the_first_frequency_is_told(beam):
    first = check(clamped(beam.element)).frequencies[0]
    step = 2.0 / (MIN_STEPS_IN_PERIOD * first)
    (warning,) = check(clamped(beam.element, step=step)).warnings
    assert f"has {MIN_STEPS_IN_PERIOD / 2:.2g} steps in a period" in warning
    assert check(clamped(beam.element, step=0.4 * step)).warnings == ()


def test_redundant_constraints_are_named():
    joints = tuple(Fixed("ground", "ball", name=name) for name in ("first", "second"))
    model = model_of(bodies={"ball": ball()}, joints=joints, step=1e-3)
    with pytest.raises(ModelError, match="redundant"):
        check(model)
    assert "second (translation 1" in check(model.with_settings(redundant="remove")).removed


def test_what_a_run_refuses_is_refused_by_the_same_words():
    load = Force("ball", [1, 0, 0], Constant(1.0))
    falls = model_of(bodies={"ball": ball()}, loads=(load,), start="equilibrium", step=1e-3)
    asks = model_of(bodies={"ball": ball()}, step=1e-3)
    asks = asks.with_settings(output=type(asks.settings.output)(quantities=("nonsense",)))
    for model in (falls, asks):
        with pytest.raises(ModelError) as of_run:
            simulate(model)
        with pytest.raises(ModelError) as of_check:
            check(model)
        assert str(of_check.value) == str(of_run.value)


def test_a_check_writes_nothing_and_refuses_an_output_that_cannot_be(beam, tmp_path):
    check(clamped(beam.element), tmp_path / "results.h5")
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(ResultsError, match="no folder"):
        check(clamped(beam.element), tmp_path / "nowhere" / "results.h5")


def test_the_size_of_the_results_is_that_of_the_file(beam, tmp_path):
    model, path = clamped(beam.element), tmp_path / "results.h5"
    found = check(model)
    results = simulate(model, output=path)
    assert found.rows == len(results.time)
    assert found.results_size == pytest.approx(Path(path).stat().st_size, rel=0.1)


def test_the_steps_are_those_of_the_run(beam):
    model = clamped(beam.element)
    assert check(model).steps == simulate(model).solver["steps"]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"t_end": 1e99, "step": 1e-3}, "simulation: t_end: expected less than 1e"),
        ({"t_end": 1e9, "step": 1e-3}, "output: results of 100000000000\\d steps"),
    ],
)
def test_a_run_that_no_machine_holds_is_refused_before_it_starts(settings, message):
    model = model_of(bodies={"ball": ball()}, **settings)
    for function in (check, simulate):
        with pytest.raises(ModelError, match=message):
            function(model)


def test_a_history_that_memory_does_not_hold_is_refused(beam):
    model = clamped(beam.element, history="direct").with_settings(t_end=1e6)
    with pytest.raises(ModelError, match=r"body 'beam': its history of \d+ steps needs .* GB"):
        simulate(model)


def test_results_that_the_disk_does_not_hold_are_told(tmp_path):
    model = model_of(bodies={"ball": ball()}, t_end=1e9, step=1e-3)
    (warning,) = check(model, tmp_path / "results.h5").warnings
    assert "results of 100000000000" in warning
    assert "the disk has" in warning
