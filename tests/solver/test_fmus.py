"""FMUs in a model: controllers beside the time loop."""

import numpy as np
import pytest
from duhamel.solver import (
    FMU,
    Input,
    Model,
    Motor,
    Revolute,
    RigidBody,
    Settings,
    Table,
    simulate,
)

from .controller_fmu import controller

H, J = 6e-5, 0.019
INPUTS = {"angle": "joints/pivot/angle", "rate": "joints/pivot/angle_rate"}


@pytest.fixture(scope="session", params=[2, 3], ids=["FMI 2", "FMI 3"])
def drive(request, tmp_path_factory):
    return controller(tmp_path_factory.mktemp("fmus") / "drive.fmu", request.param)


@pytest.fixture(scope="session")
def drive3(tmp_path_factory):
    return controller(tmp_path_factory.mktemp("fmus") / "drive.fmu", 3)


def hub(motor, *fmus, steps=300, **settings):
    return Model(
        {"hub": RigidBody(0.01, [0.0095, 0.0095, J])},
        joints=[Revolute("ground", "hub", [0, 0, 1], name="pivot")],
        motors=[motor],
        fmus=fmus,
        settings=Settings(t_end=steps * H, step=H, **settings),
    )


def driven(file, steps=300, settings=None, **more):
    parameters = more.pop("parameters", {})
    fmu = FMU("drive", file, INPUTS, {"torque": "tau"}, parameters, **more)
    motor = Motor("m", "pivot", "angle", torque=Input("tau"))
    return hub(motor, fmu, steps=steps, **(settings or {}))


def servo(kp, kd, steps=300):
    reference = Table([0.0, 1.0], [1.0, 1.0])
    gains = {"stiffness": kp, "damping": kd}
    return hub(Motor("m", "pivot", "angle", reference=reference, **gains), steps=steps)


def error(model, kp, kd, steps=300):
    found = simulate(model).joint("pivot").angle
    exact = simulate(servo(kp, kd, steps)).joint("pivot").angle
    return np.abs(found - exact).max() / np.abs(exact).max()


def test_a_controller_moves_a_hub_as_a_servo_does(drive):
    assert error(driven(drive), 50.0, 0.5) < 2e-3
