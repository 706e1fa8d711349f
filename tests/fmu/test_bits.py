"""An export steps as a `Simulator` does, to the last bit."""

import numpy as np
import pytest
from duhamel.fmu.variables import output_names
from duhamel.solver import Simulator
from duhamel.solver.output.columns import views
from duhamel.solver.phases import Phases
from duhamel.solver.signals.curves import Input
from duhamel.solver.simulation import signals
from duhamel.solver.step.loop import is_contact_near
from duhamel.solver.step.record import record
from duhamel.solver.stepper import Stepper

from .machines import MACHINES, TWO_SIZES, box, values

ALL = ["*"]


def simulated(model, inputs, every=1):
    """All outputs at the start and after every so many steps, with the inputs held between."""
    simulator = Simulator(model, output_names(Stepper(model, ()).lowered, ALL))
    rows = [simulator.outputs]
    for n in range(len(inputs)):
        found = simulator.step([inputs[n // every * every]])
        if (n + 1) % every == 0:
            rows.append(found)
    return np.array(rows)


def stepped(instance, h, inputs, every=1, start=0.0):
    rows = [instance.values()]
    for n in range(0, len(inputs), every):
        instance.set(inputs__u=inputs[n])
        instance.step(start + n * h, every * h)
        rows.append(instance.values())
    return np.array(rows)


@pytest.mark.parametrize("version", [3, 2])
@pytest.mark.parametrize("machine", MACHINES)
def test_an_export_is_a_simulator_to_the_last_bit(machine, version, exported, slave):
    make, more = MACHINES[machine]
    model = make(**more)
    made = exported(model, outputs=ALL, version=version)
    inputs = values(model, 600)
    for every, start in ((1, 0.0), (10, 0.0), (10, 7.0)):
        instance = slave(made.path, start=start)
        found = stepped(instance, made.experiment.step, inputs, every, start)
        np.testing.assert_array_equal(found, simulated(model, inputs, every))
        assert np.ptp(found, axis=0).any()


def phased(model, inputs):
    """The outputs after every long step, and the sizes of all steps, as a run takes them."""
    stepper = Stepper(model, ())
    lowered, run = stepper.lowered, stepper.run
    columns = [v for name in output_names(lowered, ALL) for v in views(lowered, name, run.output)]
    phases, done, sizes = Phases(lowered, run.state, run.work, run.output), 0, []
    record(run, 0)
    rows = [np.concatenate(columns)]
    for value in inputs:
        end = done + lowered.ratio
        while done < end:
            stride, n = phases.begin(end - done)
            steps = done + stride * np.arange(1, n + 1)
            given = signals(lowered, steps[0], np.where(steps == end, 0, -1), stride)
            for column, signal in zip(given.load.T, lowered.load_signals, strict=True):
                column[:] = value if isinstance(signal, Input) else column
            for column, signal in zip(given.motor.T, lowered.motor_signals, strict=True):
                column[:] = value if isinstance(signal, Input) else column
            run.state.contacts.n_events[0] = 0
            taken, _, failed = phases.advance(given)
            assert not failed
            done += stride * taken
            sizes += taken * [stride]
        rows.append(np.concatenate(columns))
    return np.array(rows), sizes


@pytest.mark.parametrize("machine", TWO_SIZES)
def test_steps_of_two_sizes_are_those_of_a_run_to_the_last_bit(machine, exported, slave):
    make, more = TWO_SIZES[machine]
    model = make(**more)
    inputs = values(model, 600)
    expected, sizes = phased(model, inputs)
    assert len(set(sizes)) == 2
    instance, h = slave(exported(model, outputs=ALL).path), model.settings.step
    np.testing.assert_array_equal(stepped(instance, h, inputs), expected)


def test_a_long_step_in_which_a_contact_closes_is_taken_back(exported, slave):
    """The box begins at rest, less above the floor than it falls in the first long step."""
    model = box(height=1e-8, contact_step=2e-5)
    stepper = Stepper(model, ())
    lowered, run = stepper.lowered, stepper.run
    record(run, 0)
    assert not is_contact_near(lowered.system, lowered.longest_step, run.state, run.work)
    inputs = values(model, 50)
    expected, sizes = phased(model, inputs)
    assert set(sizes) == {1}
    instance = slave(exported(model, outputs=ALL).path)
    np.testing.assert_array_equal(stepped(instance, model.settings.step, inputs), expected)


def test_a_state_keeps_the_size_of_steps(exported, slave):
    make, more = TWO_SIZES["box"]
    model = make(**more)
    inputs, h = values(model, 600), model.settings.step
    instance = slave(exported(model, outputs=ALL).path)
    stepped(instance, h, inputs[:200])
    # In flight: the box has not met the floor.
    state = instance.fmu.getFMUState()
    expected = stepped(instance, h, inputs[200:], start=200 * h)
    instance.fmu.setFMUState(state)
    np.testing.assert_array_equal(stepped(instance, h, inputs[200:], start=200 * h), expected)
    assert np.ptp(expected, axis=0).any()
