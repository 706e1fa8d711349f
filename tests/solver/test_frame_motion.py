"""Velocities and accelerations of frames: derivatives in time of their positions and rotations."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Model,
    RigidBody,
    Settings,
    Spherical,
    Start,
    Torque,
    Universal,
    simulate,
)
from duhamel.superelement import GeneralizedAlpha
from scipy.spatial.transform import Rotation

STEPS = (1e-3, 5e-4, 2.5e-4)
FRAMES = ("rigid.f", "flexible.i0", "flexible.i1", "flexible.free")


def swinging(element, **settings):
    """A rigid body on a pivot carries a flexible one on a universal joint; all motions are smooth
    from rest on.
    """
    carrier = RigidBody(
        1.5,
        [0.1, 0.2, 0.15],
        {"pivot": Frame([-0.2, 0, 0]), "f": Frame([0.2, 0.1, 0.0], [0.4, 0.2, -0.5])},
    )
    flexible = FlexibleBody(element, Start(np.array([0.2, 0.1, 0.0]) - element.interface("i0").X))
    return Model(
        {"rigid": carrier, "flexible": flexible},
        (
            Spherical("ground", "rigid.pivot", name="pivot"),
            Universal("rigid.f", "flexible.i0", [1, 0, 0], [0, 1, 0], name="cross"),
        ),
        (
            # starts with s = s' = 0, so that no derivative jumps at t = 0
            Force("flexible.i1", [2.0, 3.0, -1.0], Harmonic(-6.0, 1.5, 0.5 * np.pi, 6.0)),
            Torque(
                "rigid.f", [1.0, -1.0, 2.0], Harmonic(-3.0, 2.0, 0.5 * np.pi, 3.0), follower=True
            ),
        ),
        settings=Settings(t_end=0.5, rho_inf=0.6, **settings),
    )


@pytest.fixture(scope="module")
def element(random_element):
    """Slow modes, so that elastic rates are of the order of the others; its third interface is only
    watched.
    """
    made = random_element(7, (True, False, True), omega=(10.0, 40.0))
    interfaces = (*made.interfaces[:2], replace(made.interfaces[2], name="free"))
    return replace(
        made,
        interfaces=interfaces,
        modes=replace(made.modes, phi=0.2 * made.modes.phi),
        **scaled(made),
    )


def scaled(element):
    """Statics and kernel of modes that are a fifth as large."""
    kernel = replace(
        element.kernel, g=0.04 * element.kernel.g, g_initial=0.04 * element.kernel.g_initial
    )
    return {
        "compliance": 0.04 * element.compliance,
        "accelerance": 0.04 * element.accelerance,
        "kernel": kernel,
    }


def misses(results, h):
    """Central differences in time less velocities and accelerations, of all frames (4 kinds,
    frames).
    """
    found = []
    for name in FRAMES:
        frame = results.frame(name)
        turns = Rotation.from_quat(frame.rotation, scalar_first=True)
        velocity = (frame.position[2:] - frame.position[:-2]) / (2 * h)
        # in space: R(t + h) R(t - h)^T
        spin = (turns[2:] * turns[:-2].inv()).as_rotvec() / (2 * h)
        change = (frame.velocity[2:] - frame.velocity[:-2]) / (2 * h)
        late = slice(len(spin) // 4, None)
        found.append(
            [
                np.abs(velocity - frame.velocity[1:-1, :3])[late].max(),
                np.abs(spin - frame.velocity[1:-1, 3:])[late].max(),
                np.abs(change - frame.acceleration[1:-1])[late, :3].max(),
                np.abs(change - frame.acceleration[1:-1])[late, 3:].max(),
            ]
        )
    return np.transpose(found)


@pytest.mark.parametrize("memory", ["recursive", "direct", "measured"])
def test_velocities_and_accelerations_of_frames(element, measured, memory):
    """Order two, on rigid offsets, on interfaces with and without rotations, and on one that
    nothing acts on.
    """
    errors = []
    for h in STEPS:
        if memory == "measured":
            known = replace(element, kernel=element.kernel_for(h, GeneralizedAlpha(0.6), 2100))
            model = swinging(measured(known), step=h)
        else:
            model = swinging(element, step=h, history=memory)
        results = simulate(model)
        errors.append(misses(results, h))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 1.85).all(), orders
    # elastic motion is part of it
    u = results.frame("flexible.free").u
    rates = np.abs(np.diff(u, axis=0) / STEPS[-1]).max(axis=0)
    assert rates[:3].max() > 0.05
    assert rates[3:].max() > 0.05


def test_the_start_has_velocities_and_accelerations():
    """Of a point off the center of a spinning body: v + omega x r and omega x (omega x r)."""
    omega, X = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.2, -0.1])
    R = Rotation.from_rotvec([0.4, 0.3, -0.8])
    start = Start([1.0, 2.0, 3.0], R.as_rotvec(), velocity=[0.1, 0.2, 0.3], angular_velocity=omega)
    body = RigidBody(1.0, np.ones(3), {"f": Frame(X, [0.1, 0.2, 0.3])}, start)
    frame = simulate(Model({"body": body}, settings=Settings(t_end=0.01, step=1e-3))).frame(
        "body.f"
    )
    expected = np.array([0.1, 0.2, 0.3]) + R.apply(np.cross(omega, X))
    np.testing.assert_allclose(frame.velocity[0], [*expected, *R.apply(omega)], rtol=0, atol=1e-14)
    centripetal = R.apply(np.cross(omega, np.cross(omega, X)))
    np.testing.assert_allclose(frame.acceleration[0], [*centripetal, 0, 0, 0], rtol=0, atol=1e-14)
