"""Chains in free flight: reactions of every joint of the table between flexible frames, momenta and
energy.
"""

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Constant,
    Cylindrical,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Model,
    Revolute,
    RigidBody,
    Settings,
    Spherical,
    Start,
    Torque,
    Universal,
    simulate,
)
from scipy.spatial.transform import Rotation

from .frameworks import bar, framework
from .linkages import n_axes
from .models import model_of

FORCE, G = np.array([0.4, -0.3, 0.5]), np.array([0.0, 0.0, -9.81])
AXIS, SECOND = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([2.0, -2.0, 1.0]) / 3.0


def rotations(motion):
    return Rotation.from_quat(motion.R, scalar_first=True)


def pair(kind, left, right, **settings):
    """Two flexible bodies that fly, tumbling, with one joint between them."""
    axes = {0: {}, 1: {"axis": AXIS}, 2: {"axis": AXIS, "second_axis": SECOND}}[n_axes(kind)]
    lead = {"lead": 0.1} if kind == "screw" else {}
    turn = Rotation.from_rotvec([0.3, -0.2, 0.5])
    place = left.interface("right").X - turn.as_matrix() @ right.interface("left").X
    return model_of(
        bodies={
            "a": FlexibleBody(
                left, Start(velocity=[1.0, 0.5, 2.0], angular_velocity=[2.0, -1.0, 3.0])
            ),
            "b": FlexibleBody(
                right, Start(place, turn.as_rotvec(), angular_velocity=[-1.0, 2.0, 1.0])
            ),
        },
        joints=(JOINTS[kind]("a.right", "b.left", name="joint", **axes, **lead),),
        **settings,
    )


@pytest.mark.parametrize("kind", sorted(JOINTS.keys() - {"rod", "rolling_disc"}))
def test_reactions_between_flexible_frames_are_in_equilibrium(kind, tmp_path):
    """At every step: m x'' = F and J omega' + omega x J omega = M of what acts on a body's frames.

    Both sides of the joint feel opposite wrenches; the momentum of the whole is that of the loads
    on it.
    """
    points = {"left": (0, 0, 0), "right": (0.2, 0.1, 0.0), "wing": (0.1, 0.0, 0.2)}
    bars = [((0, 0, 0), (0.1, 0, 0)), ((0.1, 0, 0), points["right"]), ((0.1, 0, 0), points["wing"])]
    elements = {
        "a": bar(tmp_path, 0.2, stiffness=0.1),
        "b": framework(tmp_path, bars, points, stiffness=0.1),
    }
    loads = (
        Force("b.wing", FORCE, Constant(1.0)),
        Torque("a.left", [0.0, 0.01, 0.02], Harmonic(1.0, 30.0), follower=True),
    )
    model = pair(kind, elements["a"], elements["b"], loads=loads, gravity=G, t_end=0.1)
    results = simulate(model)
    assert min(np.abs(results.frame(name).u).max() for name in ("a.right", "b.left")) > 1e-5

    for name, element in elements.items():
        motion = results.body(name)
        wrench = np.zeros((len(results.time), 6))
        for interface in element.interfaces:
            frame = results.frame(f"{name}.{interface.name}")
            arm = np.cross(frame.position - motion.x, frame.force[:, :3])
            wrench += np.hstack([frame.force[:, :3], frame.force[:, 3:] + arm])
        wrench[:, :3] += element.mass * G
        omega, omega_dot = motion.v[:, 3:], motion.v_dot[:, 3:]
        spin = omega_dot @ element.J_rot + np.cross(omega, omega @ element.J_rot)
        rates = np.hstack([element.mass * motion.v_dot[:, :3], rotations(motion).apply(spin)])
        # accelerations are positions over h^2, and so is their rounding
        np.testing.assert_allclose(
            rates, wrench, rtol=0, atol=1e-14 * element.mass / results.solver["h"] ** 2
        )

    joint, A, B = results.joint("joint"), results.frame("a.right"), results.frame("b.left")
    assert np.abs(joint.force).max() > 0.05
    np.testing.assert_allclose(A.force[:, :3], -joint.force, rtol=0, atol=1e-10)
    np.testing.assert_allclose(B.force[:, :3], joint.force, rtol=0, atol=1e-10)
    turned = joint.moment + np.cross(B.position - A.position, joint.force)
    np.testing.assert_allclose(A.force[:, 3:], -turned, rtol=0, atol=1e-10)
    np.testing.assert_allclose(B.force[:, 3:], joint.moment, rtol=0, atol=1e-10)

    linear, mass = results.momentum.linear, sum(element.mass for element in elements.values())
    expected = linear[0] + np.outer(results.time, FORCE + mass * G)
    np.testing.assert_allclose(linear, expected, rtol=0, atol=1e-11 * np.abs(linear).max())


def flying_chain(folder, **settings):
    """Rigid on flexible, flexible on flexible, rigid on rigid, flexible on rigid, each on a joint
    of its own.
    """
    link = bar(folder, 0.2, stiffness=0.002)
    ends = {"near": Frame([-0.1, 0, 0]), "far": Frame([0.1, 0, 0])}
    inertia = [4e-5, 1e-4, 8e-5]

    def start(k, omega):
        return Start([0.1 + 0.2 * k, 0, 0], velocity=[0.0, 0.0, 0.3 * k], angular_velocity=omega)

    bodies = {
        "a": RigidBody(0.03, inertia, ends, start(0, [8.0, 0.0, 4.0])),
        "b": FlexibleBody(link, start(1, [0.0, 4.0, -5.0])),
        "c": FlexibleBody(link, start(2, [-8.0, 3.0, 0.0])),
        "d": RigidBody(0.02, inertia, ends, start(3, [0.0, -6.0, 2.0])),
        "e": RigidBody(0.03, inertia, ends, start(4, [3.0, 2.0, 1.0])),
        "f": FlexibleBody(link, start(5, [0.0, 0.0, 7.0])),
    }
    joints = (
        Spherical("a.far", "b.left", name="ab"),
        Universal("b.right", "c.left", [0, 1, 0], [0, 0, 1], name="bc"),
        Revolute("c.right", "d.near", [0, 1, 1], name="cd"),
        Cylindrical("d.far", "e.near", [1, 0, 0], name="de"),
        Revolute("e.far", "f.left", [0, 1, 0], name="ef"),
    )
    return Model(bodies=bodies, joints=joints, settings=Settings(t_end=0.1, **settings))


@pytest.mark.parametrize("history", ["recursive", "direct"])
def test_a_chain_in_free_flight_keeps_its_momenta_and_energy(history, tmp_path):
    """Linear momentum to rounding; angular momentum and the balance of energy to order two."""
    angular, balance = [], []
    for h in (4e-4, 2e-4, 1e-4):
        results = simulate(flying_chain(tmp_path, step=h, history=history))
        linear = results.momentum.linear
        assert np.abs(linear - linear[0]).max() < 1e-12 * np.abs(linear[0]).max()
        size = np.abs(results.momentum.angular).max()
        angular.append(np.abs(results.momentum.angular - results.momentum.angular[0]).max() / size)
        balance.append(np.abs(results.energy.balance).max() / results.energy.kinetic[0])
    assert np.abs(results.frame("b.right").u[:, 3:]).max() > 1e-3
    for drift in (angular, balance):
        np.testing.assert_allclose(
            np.log2(np.array(drift[:-1]) / drift[1:]), 2.0, atol=0.1, err_msg=str(drift)
        )
