"""Many runs at once: results as one after the other, failures and warnings by run."""

import _thread
import threading
import warnings
from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    ConvergenceError,
    Frame,
    Function,
    Harmonic,
    Model,
    ModelError,
    OutputRequest,
    Results,
    Revolute,
    RigidBody,
    Settings,
    Start,
    Torque,
    ValidityWarning,
    simulate,
    simulate_many,
)


def arm(torque, t_end=0.5, step=1e-3, **more):
    body = RigidBody(1.0, [0.1, 0.1, 0.1], {"pin": Frame([-0.5, 0, 0])}, Start([0.5, 0, 0]))
    return Model(
        {"arm": body},
        [Revolute("ground", "arm.pin", [0, 0, 1], name="hinge")],
        loads=[Torque("arm", [0, 0, 1], torque)],
        settings=Settings(t_end=t_end, step=step),
        **more,
    )


def arms():
    return [arm(Constant(float(k)), t_end=0.1 * (6 - k)) for k in range(1, 6)]


def bits(results):
    joint, energy = results.joint("hinge"), results.energy.kinetic
    return joint.angle.tobytes(), joint.multipliers.tobytes(), energy.tobytes(), results.solver


def without_times(found):
    return [
        (*arrays, {key: note for key, note in notes.items() if key != "seconds"})
        for *arrays, notes in map(bits, found)
    ]


@pytest.mark.parametrize("workers", [None, 1, 2, 8])
def test_results_are_to_the_bit_those_of_one_after_the_other_in_their_order(workers):
    alone = without_times(simulate(model) for model in arms())
    together = without_times(simulate_many((model for model in arms()), workers=workers))
    assert together == alone
    # Those that end first are given last.
    assert len({angle for angle, *_ in alone}) == len(alone)


def broken():
    """A run that fails on its way: its torque is no number from some time on."""
    return arm(Function(lambda t: 1.0 if t < 0.05 else np.nan))


def impossible():
    """A model that does not start: its arm has two hinges about one axis."""
    hinges = [Revolute("ground", "arm.pin", [0, 0, 1], name=name) for name in ("hinge", "second")]
    return replace(arm(Constant(1.0)), joints=hinges, path="impossible.toml")


def test_a_run_that_fails_stops_no_other_and_is_named():
    models = [arm(Constant(1.0)), broken(), arm(Constant(2.0)), impossible(), arm(Constant(3.0))]
    with pytest.raises(ExceptionGroup) as caught:
        simulate_many(models, workers=2)
    assert caught.value.message == "runs failed: run 2 of 5, run 4 of 5 (impossible.toml)"
    assert [type(one) for one in caught.value.exceptions] == [ConvergenceError, ModelError]
    assert caught.value.exceptions[1].__notes__ == ["in run 4 of 5 (impossible.toml)"]

    found = simulate_many(models, workers=2, failures="keep")
    kinds = [type(one) for one in found]
    assert kinds == [Results, ConvergenceError, Results, ModelError, Results]
    # A failure reads as that of a run alone.
    with pytest.raises(ConvergenceError) as alone:
        simulate(broken())
    assert str(found[1]) == str(alone.value)
    assert bits(found[4])[:2] == bits(simulate(models[4]))[:2]


def shaken(frequency):
    """A run that warns as it starts of a torque with few steps in a period."""
    return arm(Harmonic(1.0, frequency), t_end=0.05)


def test_warnings_come_in_the_order_of_the_runs_and_name_theirs():
    models = [shaken(410.0), arm(Constant(1.0)), shaken(430.0), shaken(450.0)]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        filters = list(warnings.filters)
        simulate_many(models, workers=3)
        assert warnings.filters == filters
    first = [str(one.message) for one in caught if "highest frequency" in str(one.message)]
    assert [line.partition(":")[0] for line in first] == ["run 1 of 4", "run 3 of 4", "run 4 of 4"]
    assert ["410 Hz" in first[0], "430 Hz" in first[1], "450 Hz" in first[2]] == [True] * 3
    assert {one.category for one in caught} == {ValidityWarning}
    assert {one.filename for one in caught} == {__file__}


def test_a_warning_outside_is_none_of_a_run():
    with pytest.warns(ValidityWarning, match=r"^loads\.0\.signal: its highest frequency, 440 Hz"):
        simulate(shaken(440.0))


def test_an_interrupt_ends_all_runs_at_once():
    # Hours of steps, of which hardly a row is kept.
    endless = replace(arm(Constant(1.0)), settings=Settings(t_end=1e7, step=1e-3)).with_settings(
        output=OutputRequest(every=10**9)
    )
    threading.Timer(0.5, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        simulate_many([endless] * 6, workers=2)
    assert not [one for one in threading.enumerate() if one.name.startswith("simulate_many")]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"workers": 0}, "workers: expected 1 or more, got 0"),
        ({"failures": "skip"}, "failures: expected 'raise' or 'keep', got 'skip'"),
    ],
)
def test_arguments_are_checked_before_any_run(more, message):
    with pytest.raises(ValueError, match=message):
        simulate_many(iter(()), **more)


def test_no_models_have_no_results():
    assert simulate_many([]) == []
