"""The solver against time stepping of the unreduced model: equal to rounding, whatever the load."""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Force,
    Function,
    Steps,
    Torque,
    simulate,
)
from scipy.spatial.transform import Rotation

from .monolithic import Reference

H = 2e-4
PULSE = Function(lambda t: np.sin(np.pi * t / 0.05) ** 2 if t < 0.05 else 0.0)
STEPS = Steps((0.0, 0.05, 0.1), (1.0, -1.0, 0.0))
LIFT = np.array([0.3, 0.0, 1.0])
DISPLACEMENTS = [0, 1, 2, 6, 7, 8]
"""among the twelve dofs of the two interfaces"""


def reference_of(model, beam, **settings):
    hub = model.bodies["hub"]
    rim = hub.frames["rim"].position
    return Reference(
        beam.structure,
        hub.inertia,
        hub.mass,
        rim,
        model.settings.step,
        model.settings.rho_inf,
        **settings,
    )


ROUNDING_OF_FORCE = 2.16e7 / 0.05 * 4 * 2.2e-16 * 0.55
"""[N] of the clamp: the axial stiffness of an element times a few roundings of positions within
reach of the beam
"""
DEFLECTION = 0.01
"""[m] the lever of that force about the clamp"""


def rounding_of_modes(modes):
    """What computed modes have of one another: the stiffness of the stiffest, rounded, over that of
    the softest, by the perturbation of symmetric eigenproblems.
    """
    return np.finfo(float).eps * (modes.omega[-1] / modes.omega[0]) ** 2


def rotations(quaternions):
    return Rotation.from_quat(quaternions, scalar_first=True)


def samples(load, t, h):
    return np.outer(load.signal.samples(t, h), load.direction)


def assert_equal_motions(model, reference):
    """Angles, elastic displacements, velocities and the wrench of the clamp, to 1e-10 of their
    largest values and the rounding of the modes.

    The wrench has the rounding of positions, too, seen through the stiffness of one element.
    """
    results = simulate(model)
    loads = [samples(load, results.time, model.settings.step) for load in model.loads]
    R, u, v, wrench = reference.run(
        loads[0][:, 2], *loads[1:], spin=model.bodies["hub"].start.angular_velocity
    )
    R = Rotation.from_matrix(R)
    found_u = np.hstack([results.frame("beam.root").u, results.frame("beam.tip").u])
    clamp = results.joint("clamp")
    pairs = {
        "angle": (
            (rotations(results.body("hub").R) * R.inv()).as_rotvec() + R.as_rotvec(),
            R.as_rotvec(),
        ),
        "displacements": (found_u[:, DISPLACEMENTS], u[:, DISPLACEMENTS]),
        "small rotations": (
            np.delete(found_u, DISPLACEMENTS, axis=1),
            np.delete(u, DISPLACEMENTS, axis=1),
        ),
        "spin of the hub": (results.body("hub").v[:, 3:], v[:, 3:6]),
        "velocity of the beam": (results.body("beam").v[:, :3], v[:, 6:9]),
    }
    errors = {
        name: np.abs(found - expected).max() / np.abs(expected).max()
        for name, (found, expected) in pairs.items()
    }
    tolerance = 1e-10 + rounding_of_modes(model.bodies["beam"].superelement.modes)
    assert max(errors.values()) < tolerance, errors
    for found, expected, lever in (
        (clamp.force, wrench[:, :3], 1.0),
        (clamp.moment, wrench[:, 3:], DEFLECTION),
    ):
        assert (
            np.abs(found - expected).max()
            < tolerance * np.abs(expected).max() + lever * ROUNDING_OF_FORCE
        )


@pytest.mark.parametrize("rho_inf", [0.9, 0.5])
@pytest.mark.parametrize(("phi", "signal"), [(4.0, STEPS), (0.5, PULSE)], ids=["steps", "pulse"])
def test_a_rotating_beam_moves_like_its_unreduced_model(beam, hub_and_beam, phi, signal, rho_inf):
    torque = Torque("hub", [0, 0, 2 * phi**0.5], signal)
    model = hub_and_beam(beam, phi, loads=(torque,), t_end=600 * H, step=H, rho_inf=rho_inf)
    assert_equal_motions(model, reference_of(model, beam))


def test_a_thousand_steps_of_the_papers_second_case(beam, hub_and_beam):
    torque = Torque("hub", [0, 0, 1], STEPS)
    model = hub_and_beam(beam, 0.5, loads=(torque,), t_end=1000 * 6e-5, step=6e-5, rho_inf=0.9)
    assert_equal_motions(model, reference_of(model, beam))


@pytest.mark.parametrize("rho_inf", [0.9, 0.5])
def test_a_beam_swings_in_space_like_its_unreduced_model(coarse_beam, hub_and_beam, rho_inf):
    """On a spherical pivot, spinning, under gravity, with damping and a force across the plane from
    t = 0 on.
    """
    torque, lift = (
        Torque("hub", [0, 0, 0.2], PULSE),
        Force("beam.tip", LIFT, Constant(0.5)),
    )
    gravity, spin = np.array([0, -3.0, -9.81]), (1.0, 2.0, 5.0)
    settings = {
        "loads": (torque, lift),
        "t_end": 600 * H,
        "step": H,
        "rho_inf": rho_inf,
        "gravity": gravity,
    }
    model = hub_and_beam(coarse_beam, 0.5, "spherical", spin, **settings)
    reference = reference_of(model, coarse_beam, revolute=False, gravity=gravity, zeta=0.02)
    assert_equal_motions(model, reference)
