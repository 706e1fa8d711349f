"""The whole model turned and moved gives the turned and moved result."""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Frame,
    Harmonic,
    Joint,
    Load,
    Model,
    Place,
    Polynomial,
    RigidBody,
    Settings,
    Start,
    Steps,
    simulate,
)
from scipy.spatial.transform import Rotation

from .transformed import turned

Q, SHIFT = Rotation.from_rotvec([1.1, -2.0, 0.7]), np.array([0.3, -0.4, 0.2])


def crane(beam):
    """A hub on a driven pivot carries a beam with a slider at its tip, which a load drags across
    the plane.
    """
    rim, eye = Frame([0.05, 0, 0], [0.2, 0, 0.4]), Frame([0.01, 0.02, 0.0])
    on_rim = Start(place=Place("root", "hub.rim"), angular_velocity=[0.0, 0.0, 1.0])
    afloat = Start([0.9, 0.3, -0.3], [0.4, 0, 0], velocity=[0.1, 0, 0.2])
    slide = Polynomial((0.0, 0.02, 0.1))
    return Model(
        bodies={
            "hub": RigidBody(
                0.5, [2e-3, 3e-3, 4e-3], {"rim": rim}, Start([0.1, 0.0, 0.2], [0.3, 0.1, -0.2])
            ),
            "beam": FlexibleBody(beam.element, on_rim),
            "weight": RigidBody(
                0.05, [1e-5, 2e-5, 3e-5], {"eye": eye}, Start(place=Place("eye", "beam.tip"))
            ),
            "bob": RigidBody(0.02, [1e-6, 1e-6, 1e-6], {}, afloat),
        },
        joints=(
            Joint(
                "pivot",
                "revolute",
                ("ground.post", "hub"),
                [0.1, 0.2, 1.0],
                angle=Harmonic(0.4, 3.0),
            ),
            Joint("clamp", "fixed", ("hub.rim", "beam.root")),
            Joint(
                "slider", "prismatic", ("beam.tip", "weight.eye"), [0.0, 1.0, 0.3], distance=slide
            ),
            Joint("rest", "planar", ("ground", "bob"), [0.0, 0.3, 1.0]),
        ),
        loads=(
            Load("force", "weight", [0.2, 0.1, 0.3], Steps((0.0, 0.03), (1.0, -1.0))),
            Load("torque", "beam.tip", [0.002, 0.0, 0.001], Constant(1.0), follower=True),
            Load("force", "bob", [0.0, 0.01, 0.0], Constant(1.0), follower=True),
            Load("torque", "hub", [0.0, 0.01, 0.0], Constant(1.0)),
        ),
        ground_frames={"post": Frame([0.1, 0.0, 0.2], [0.1, 0.2, 0.3])},
        gravity=[0.5, -1.0, -9.7],
        settings=Settings(t_end=0.06, step=2e-4, rho_inf=0.6),
    )


def test_a_model_turned_and_moved_gives_the_turned_and_moved_result(beam):
    model = crane(beam)
    here, there = simulate(model), simulate(turned(model, Q, SHIFT))
    errors = {}
    for name in model.bodies:
        a, b = here.body(name), there.body(name)
        errors[f"{name}.x"] = np.abs(b.x - Q.apply(a.x) - SHIFT).max()
        rotations = [Rotation.from_quat(motion.R, scalar_first=True) for motion in (a, b)]
        errors[f"{name}.R"] = (rotations[1].inv() * Q * rotations[0]).magnitude().max()
        expected = np.hstack([Q.apply(a.v[:, :3]), a.v[:, 3:]])
        errors[f"{name}.v"] = np.abs(b.v - expected).max() / np.abs(expected).max()
    for name in ("beam.root", "beam.tip"):
        a, b = here.frame(name).u, there.frame(name).u
        errors[f"{name}.u"] = np.abs(b - a).max() / np.abs(a).max()
    assert np.abs(here.frame("beam.tip").u).max() > 1e-3
    assert max(errors.values()) < 1e-9, errors
    # a force is a position over h^2, and so is its rounding
    a, b = here.joint("pivot").force, there.joint("pivot").force
    assert np.abs(b - Q.apply(a)).max() < 1e-7 * np.abs(a).max()


@pytest.mark.parametrize("part", ["kinetic", "elastic", "work"])
def test_energies_do_not_depend_on_the_frame(beam, part):
    model = crane(beam)
    here, there = (getattr(simulate(m).energy, part) for m in (model, turned(model, Q, SHIFT)))
    np.testing.assert_allclose(there, here, rtol=0, atol=1e-9 * np.abs(here).max())
