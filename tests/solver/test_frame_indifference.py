"""The whole model turned and moved gives the turned and moved result."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Model,
    Place,
    Planar,
    Polynomial,
    PrescribedDisplacement,
    PrescribedRotation,
    Prismatic,
    Results,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    Steps,
    Torque,
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
            Revolute("ground.post", "hub", [0.1, 0.2, 1.0], name="pivot", angle=Harmonic(0.4, 3.0)),
            Fixed("hub.rim", "beam.root", name="clamp"),
            Prismatic("beam.tip", "weight.eye", [0.0, 1.0, 0.3], name="slider", distance=slide),
            Planar("ground", "bob", [0.0, 0.3, 1.0], name="rest"),
        ),
        loads=(
            Force("weight", [0.2, 0.1, 0.3], Steps((0.0, 0.03), (1.0, -1.0))),
            Torque("beam.tip", [0.002, 0.0, 0.001], Constant(1.0), follower=True),
            Force("bob", [0.0, 0.01, 0.0], Constant(1.0), follower=True),
            Torque("hub", [0.0, 0.01, 0.0], Constant(1.0)),
        ),
        ground_frames={"post": Frame([0.1, 0.0, 0.2], [0.1, 0.2, 0.3])},
        gravity=[0.5, -1.0, -9.7],
        settings=Settings(t_end=0.06, step=2e-4, rho_inf=0.6),
    )


def differences(model, shift):
    """Of motions of the model and of it turned and moved, over the sizes of these."""
    here, there = simulate(model), simulate(turned(model, Q, shift))
    errors = {}
    for name in model.bodies:
        a, b = here.body(name), there.body(name)
        errors[f"{name}.x"] = np.abs(b.x - Q.apply(a.x) - shift).max()
        rotations = [Rotation.from_quat(motion.R, scalar_first=True) for motion in (a, b)]
        errors[f"{name}.R"] = (rotations[1].inv() * Q * rotations[0]).magnitude().max()
        expected = np.hstack([Q.apply(a.v[:, :3]), a.v[:, 3:]])
        errors[f"{name}.v"] = np.abs(b.v - expected).max() / np.abs(expected).max()
    for name in ("beam.root", "beam.tip"):
        a, b = here.frame(name).u, there.frame(name).u
        errors[f"{name}.u"] = np.abs(b - a).max() / np.abs(a).max()
    assert np.abs(here.frame("beam.tip").u).max() > 1e-3
    return here, there, errors


def test_a_model_turned_and_moved_gives_the_turned_and_moved_result(beam):
    here, there, errors = differences(crane(beam), SHIFT)
    assert max(errors.values()) < 1e-9, errors
    # a force is a position over h^2, and so is its rounding
    a, b = here.joint("pivot").force, there.joint("pivot").force
    assert np.abs(b - Q.apply(a)).max() < 1e-7 * np.abs(a).max()


@pytest.mark.parametrize(
    ("shift", "tolerance"), [(SHIFT, 1e-9), ([600.0, -800.0, 100.0], 1e-6)], ids=["near", "far"]
)
def test_so_does_one_of_second_order(beam, with_second_order, shift, tolerance):
    """Also a kilometer away, where positions are rounded to 1e-13 m."""
    model = crane(replace(beam, element=with_second_order(beam.element)))
    _, _, errors = differences(model, np.array(shift))
    assert max(errors.values()) < tolerance, errors


@pytest.mark.parametrize("part", ["kinetic", "elastic", "work"])
def test_energies_do_not_depend_on_the_frame(beam, part):
    model = crane(beam)
    here, there = (getattr(simulate(m).energy, part) for m in (model, turned(model, Q, SHIFT)))
    np.testing.assert_allclose(there, here, rtol=0, atol=1e-9 * np.abs(here).max())


UNEVEN = [900.0, 300.0, 2000.0, 8.0, 3.0, 15.0]
COUPLINGS = {
    name: JOINTS[name]("a.f", "b.g", name="j", **axes)
    for name, axes in {
        "fixed": {},
        "spherical": {},
        "revolute": {"axis": [0, 0, 1]},
        "universal": {"axis": [0, 0, 1], "second_axis": [1, 0, 0]},
        "cylindrical": {"axis": [0.1, 0.2, 1]},
        "prismatic": {"axis": [1, 0, 0]},
        "planar": {"axis": [0, 0, 1]},
    }.items()
} | {
    "planar on the ground": Planar("ground.post", "b.g", [0, 1, 0], name="j"),
    "planar on the bare ground": Planar("ground", "b.g", [0, 1, 1], name="j"),
    "started": Planar(
        "a.f", "b.g", [0, 0, 1], name="j", start={"distance": 0.05, "second_distance_rate": 0.3}
    ),
    "driven": Revolute("ground.post", "b.g", [0, 0, 1], name="j", angle=Harmonic(0.5, 2.0)),
    "path": PrescribedDisplacement("j", "b.g", [0, 0.6, 0.8], Polynomial((0.0, 0.0, 1.0))),
    "turn": PrescribedRotation("j", "b.g", [0, 0.6, 0.8], Polynomial((0.0, 0.0, 1.0))),
    "point": Spring("j", "point", ("a", "b"), stiffness=300.0, damping=1.0),
    "torsion": Spring("j", "torsion", ("a.f", "b.g"), [0, 0, 1], stiffness=20.0, damping=0.1),
    "bushing": Spring("j", "bushing", ("a.f", "b.g"), stiffness=UNEVEN),
    "bushing with an axis": Spring("j", "bushing", ("a.f", "b.g"), [0, 0, 1], stiffness=UNEVEN),
    "bushing with an axis along x": Spring(
        "j", "bushing", ("ground.post", "b.g"), [1, 0, 0], stiffness=UNEVEN
    ),
    "bushing with two axes": Spring(
        "j", "bushing", ("a.f", "b.g"), [0, 0, 1], UNEVEN, second_axis=[0, 1, 0]
    ),
    "bushing on the bare ground": Spring("j", "bushing", ("ground", "b.g"), stiffness=UNEVEN),
}


def pair(coupling):
    """Two bodies that move and turn, with axes of their own, and what couples them."""
    parts = {"joints": (), "springs": (), "motions": ()}
    a = RigidBody(
        1.0,
        [0.01, 0.02, 0.015],
        {"f": Frame([0.1, 0.05, -0.1], [0.0, 0.0, 0.3])},
        Start(
            [0, 0, 0], [0.2, 0.1, -0.3], velocity=[0.3, 0, 0.1], angular_velocity=[0.5, 1.0, -0.4]
        ),
    )
    b = RigidBody(2.0, [0.02, 0.01, 0.015], {"g": Frame([-0.1, 0.04, 0.1])}, Start([0.3, 0.2, 0.1]))
    return Model(
        {"a": a, "b": b},
        loads=[
            Force("b.g", [3.0, -2.0, 5.0], Constant(1.0)),
            Torque("a", [0.1, 0.05, 0.1], Constant(1.0), follower=True),
        ],
        gravity=[1.0, 2.0, -9.0],
        ground_frames={"post": Frame([0.1, -0.1, 0.2], [0.0, 0.0, 0.3])},
        settings=Settings(t_end=0.2, step=1e-3, assemble=True, tolerance=1e-12),
        **(parts | {coupling.group: (coupling,)}),
    )


@pytest.mark.parametrize("name", COUPLINGS)
def test_no_joint_spring_or_motion_depends_on_the_axes_of_space(name):
    """Motions and forces turn with the model; coordinates and multipliers stay what they are."""
    model = pair(COUPLINGS[name])
    here, there = simulate(model), simulate(turned(model, Q, SHIFT))
    for body in model.bodies:
        a, b = here.body(body), there.body(body)
        np.testing.assert_allclose(b.x, Q.apply(a.x) + SHIFT, rtol=0, atol=1e-10)
        np.testing.assert_allclose(b.v[:, 3:], a.v[:, 3:], rtol=0, atol=1e-8)
    read = Results.spring if model.springs else Results.joint
    a, b = read(here, "j"), read(there, "j")
    np.testing.assert_allclose(b.force, Q.apply(a.force), rtol=0, atol=1e-6)
    np.testing.assert_allclose(b.multipliers, a.multipliers, rtol=0, atol=1e-6)
    for coordinate, values in a.coordinates.items():
        np.testing.assert_allclose(b.coordinates[coordinate], values, rtol=0, atol=1e-8)
