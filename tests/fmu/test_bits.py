"""An export steps as a `Simulator` does, to the last bit."""

import numpy as np
import pytest
from duhamel.fmu.variables import output_names
from duhamel.solver import Simulator
from duhamel.solver.stepper import Stepper

from .machines import MACHINES, values

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
