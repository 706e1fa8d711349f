"""A flexible model of Duhamel as an FMU in another model."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel import fmu
from duhamel.solver import (
    FMU,
    Fixed,
    FlexibleBody,
    Frame,
    Input,
    Model,
    Motor,
    Place,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    Table,
    Torque,
    simulate,
)

from .test_restart import assert_same

H, STEPS = 5e-4, 120
STIFFNESS, DAMPING = 40.0, 0.02
"""of the shaft between the drum, in the model, and the rotor, in the FMU [N m/rad, N m s/rad]"""


def rotor(element):
    """A hub with a flexible beam, and its joints."""
    hub = RigidBody(0.01, [0.006, 0.007, 0.01], {"rim": Frame([0.05, 0, 0])})
    beam = FlexibleBody(element, Start(place=Place("root", "hub.rim")))
    turn = Revolute("ground", "hub", [0, 0, 1], name="turn")
    return {"hub": hub, "beam": beam}, [turn, Fixed("hub.rim", "beam.root", name="clamp")]


def drum(*loads, **more):
    """A drum that a torque turns."""
    return Model(
        {"drum": RigidBody(0.5, [0.02, 0.02, 0.03])},
        joints=[Revolute("ground", "drum", [0, 0, 1], name="pivot")],
        loads=[Torque("drum", [0, 0, 1], Table([0.0, 0.02], [0.0, 2.0])), *loads],
        settings=Settings(t_end=STEPS * H, step=H),
        **more,
    )


@pytest.fixture(scope="module")
def file(coarse, tmp_path_factory):
    bodies, joints = rotor(coarse)
    shaft = Motor(
        "shaft",
        "turn",
        "angle",
        reference=Input("angle"),
        reference_rate=Input("rate"),
        stiffness=STIFFNESS,
        damping=DAMPING,
    )
    path = tmp_path_factory.mktemp("rotor") / "rotor.fmu"
    settings = Settings(t_end=STEPS * H, step=H)
    model = Model(bodies, joints=joints, motors=[shaft], settings=settings)
    fmu.export_fmu(model, path, outputs=["motors/shaft/torque"])
    return path


@pytest.fixture(scope="module")
def coupled(file):
    """The drum with the rotor as an FMU, which turns back by the torque of the shaft."""
    part = FMU(
        "rotor",
        file,
        {"inputs.angle": "joints/pivot/angle", "inputs.rate": "joints/pivot/angle_rate"},
        {"motors.shaft.torque": "back"},
    )
    return drum(Torque("drum", [0, 0, -1], Input("back")), fmus=[part])


def test_the_model_and_the_fmu_move_as_one_model_does(coarse, coupled):
    bodies, joints = rotor(coarse)
    alone = drum()
    shaft = Spring(
        "shaft",
        "torsion",
        ("drum", "hub"),
        axis=[0, 0, 1],
        stiffness=STIFFNESS,
        damping=DAMPING,
    )
    whole = replace(
        alone, bodies={**alone.bodies, **bodies}, joints=[*alone.joints, *joints], springs=[shaft]
    )
    found, expected = (simulate(one).joint("pivot").angle for one in (coupled, whole))
    free = simulate(alone).joint("pivot").angle
    assert np.abs(free - expected).max() > 0.1 * np.abs(expected).max()
    assert np.abs(found - expected).max() < 0.01 * np.abs(expected).max()


def test_it_goes_on_to_the_bit(coupled, tmp_path):
    whole = coupled.with_settings(checkpoint={"every": 37})
    simulate(whole, output=tmp_path / "whole.h5")
    for number, end in enumerate((50, STEPS)):
        part = whole.with_settings(t_end=end * H)
        simulate(part, output=tmp_path / "parts.h5", resume=number > 0)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


def test_a_model_with_an_fmu_becomes_none_itself(coupled, tmp_path):
    with pytest.raises(fmu.FMUError, match="fmu 'rotor': an FMU cannot run another one"):
        fmu.export_fmu(coupled, tmp_path / "all.fmu")
