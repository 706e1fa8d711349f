"""The motions that joints block and those that they leave free."""

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Constant,
    Force,
    Frame,
    Model,
    Polynomial,
    Revolute,
    RigidBody,
    Settings,
    Start,
    Torque,
    Universal,
    simulate,
)
from scipy.spatial.transform import Rotation

AXIS, SECOND = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([2.0, -2.0, 1.0]) / 3.0
# translations along e1, e2, e3 and rotations that a joint leaves free, and its rows
EVERY_JOINT = {
    "fixed": ({}, [], 0, 6),
    "spherical": ({}, [], 3, 3),
    "revolute": ({"axis": AXIS}, [], 1, 5),
    "universal": ({"axis": AXIS, "second_axis": SECOND}, [], 2, 4),
    "cylindrical": ({"axis": AXIS}, [2], 1, 4),
    "prismatic": ({"axis": AXIS}, [2], 0, 5),
    "planar": ({"axis": AXIS}, [0, 1], 1, 3),
}


def rotations(quaternions):
    return Rotation.from_quat(quaternions, scalar_first=True)


def relative_motion(type_, axes):
    """Of frame B in the joint axes of frame A, from rest under arbitrary loads: translation (n, 3),
    rotation.
    """
    a = RigidBody(1.0, [1.0, 2.0, 1.5], {"f": Frame([0.3, 0.2, -0.1], [0.5, 0.1, -0.3])})
    b = RigidBody(
        2.0,
        [2.0, 1.0, 1.5],
        {"g": Frame([-0.2, 0.4, 0.1])},
        Start([0.5, -0.2, -0.2], [0.0, 0.0, 0.0]),
    )
    joint = JOINTS[type_]("a.f", "b.g", name="joint", **axes)
    loads = (
        Force("b", [3.0, -2.0, 5.0], Constant(1.0)),
        Torque("b", [1.0, 2.0, -1.5], Constant(1.0)),
        Torque("a", [-1.0, 0.5, 1.0], Constant(1.0)),
    )
    model = Model(
        {"a": a, "b": b},
        (joint,),
        loads,
        gravity=[0, 0, -9.81],
        settings=Settings(t_end=0.5, step=1e-3, rho_inf=0.9),
    )
    results = simulate(model)
    A, B = results.frame("a.f"), results.frame("b.g")
    turn_a = rotations(A.rotation) * rotations(A.rotation[0]).inv()
    turn_b = rotations(B.rotation) * rotations(B.rotation[0]).inv()
    basis = Rotation.from_matrix(joint.basis(rotations(A.rotation[0]).as_matrix()))
    axes_of_a = turn_a * basis
    translation = axes_of_a.inv().apply(B.position - A.position)
    relative = axes_of_a.inv() * turn_b * basis
    return results, translation, relative


@pytest.mark.parametrize("name", EVERY_JOINT)
def test_a_joint_blocks_what_it_should_and_nothing_else(name):
    axes, sliding, turning, rows = EVERY_JOINT[name]
    results, translation, relative = relative_motion(name, axes)
    assert results.joint("joint").multipliers.shape[1] == rows == 6 - len(sliding) - turning
    for k in range(3):
        if k in sliding:
            assert np.abs(translation[:, k]).max() > 1e-2
        else:
            assert np.abs(translation[:, k]).max() < 1e-12
    turned = relative.as_rotvec()
    if turning == 0:
        assert np.abs(turned).max() < 1e-12
    elif turning == 1:
        assert np.abs(turned[:, :2]).max() < 1e-12
        assert np.abs(turned[:, 2]).max() > 1e-2
    elif turning == 2:
        # e1 of A and e2 of B stay perpendicular while the rest turns
        assert np.abs(relative.as_matrix()[:, 0, 1]).max() < 1e-12
        assert np.abs(turned[:, :2]).max(axis=0).min() > 1e-2
    else:
        assert np.abs(turned).max(axis=0).min() > 1e-2
    # the joint does no work and its wrenches balance
    assert np.abs(results.energy.balance).max() < 1e-5 * results.energy.kinetic.max()


@pytest.mark.parametrize("name", EVERY_JOINT)
def test_a_joint_wrench_keeps_the_second_body_in_its_motion(name):
    """m x'' = force + loads on B, at every step."""
    results, _, _ = relative_motion(name, EVERY_JOINT[name][0])
    applied = np.array([3.0, -2.0, 5.0]) + 2.0 * np.array([0, 0, -9.81])
    expected = 2.0 * results.body("b").v_dot[:, :3] - applied
    np.testing.assert_allclose(results.joint("joint").force, expected, rtol=0, atol=1e-8)
    np.testing.assert_allclose(results.frame("b.g").force[:, :3], expected, rtol=0, atol=1e-8)


def test_a_revolute_joint_turns_more_than_half_a_turn():
    """A drive passes half a turn, and several whole ones."""
    drive = Polynomial((0.0, 0.0, 20.0))
    joint = Revolute("ground", "body", AXIS, name="motor", angle=drive)
    body = RigidBody(1.0, [1.0, 2.0, 1.5])
    results = simulate(
        Model({"body": body}, (joint,), settings=Settings(t_end=1.0, step=1e-3, rho_inf=0.9))
    )
    expected = Rotation.from_rotvec(np.outer([drive(t) for t in results.time], AXIS))
    assert (rotations(results.body("body").R) * expected.inv()).magnitude().max() < 1e-12


@pytest.mark.parametrize("ground_first", [True, False])
def test_a_universal_joint_keeps_its_axes_across_whichever_side_is_the_ground(ground_first):
    """`axis` is fixed in the first frame and `second_axis` in the second."""
    between = ("ground", "body") if ground_first else ("body", "ground")
    model = Model(
        {"body": RigidBody(1.0, [1.0, 2.0, 1.5], start=Start(angular_velocity=[1.0, 2.0, 0.0]))},
        [Universal(*between, [1, 0, 0], [0, 1, 0], name="cross")],
        [Torque("body", [0.5, 1.0, 2.0], Constant(1.0))],
        settings=Settings(t_end=1.0, step=1e-3),
    )
    results = simulate(model)
    R = Rotation.from_quat(results.body("body").R, scalar_first=True).as_matrix()
    ground, body = np.eye(3)[None], R
    first, second = (ground, body) if ground_first else (body, ground)
    across = np.einsum("ni,ni->n", *np.broadcast_arrays(first[:, :, 0], second[:, :, 1]))
    other = np.einsum("ni,ni->n", *np.broadcast_arrays(first[:, :, 1], second[:, :, 0]))
    np.testing.assert_allclose(across, 0.0, atol=1e-9)
    assert np.abs(other).max() > 0.1
    angle = results.joint("cross").coordinates["angle"]
    assert np.abs(angle).max() > 0.1
