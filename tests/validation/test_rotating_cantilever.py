"""Beams that turn about their clamped end: frequencies out of the plane of rotation (flap) and in
it (lag), with one body.

The tip is kicked by a millionth of the length while the beam turns steadily, and the frequencies
of what follows are read off. Reference: the rotating beam of Euler and Bernoulli by finite
elements, in `beam_theory.py`. Steps of h make a frequency too low by (omega h)^2 / 12 and a little
more, 6e-5 for the highest here.
"""

import numpy as np
import pytest
from duhamel.solver import (
    FlexibleBody,
    Force,
    Model,
    Polynomial,
    Pulse,
    Revolute,
    Settings,
    Start,
    SteadyRotation,
    simulate,
)

from .beam_theory import rotating_cantilever
from .nonlinear_solid import SolidBox
from .solid_bar import solid_superelement
from .spectrum import frequency
from .straight_beam import along, beam_superelement

Z = np.array([0.0, 0.0, 1.0])
KICK = np.array([0.0, 1e-4, 1e-4])
STEP, T_END = 1e-3, 30.0
"""of sqrt(m L^4 / EI)"""
SLENDER = {
    "EA": 1e6,
    "EI_y": 1.0,
    "EI_z": 1.0,
    "GJ": 1.0,
    "mass_per_length": 1.0,
    "rotary_inertia_y": 1e-6,
    "rotary_inertia_z": 1e-6,
    "polar_inertia_per_length": 2e-6,
}
FROM_ROOT = {"modes": 4, "soft": "auto", "loaded": ["root"]}


def kicked(beam, gamma, step=STEP, t_end=T_END, unit=1.0):
    """The tip in the axes of the drive (n_t, 3), after a kick across both planes.

    unit: of forces, EI / L^2.
    """
    root = beam.interface("root").X
    model = Model(
        bodies={"beam": FlexibleBody(beam, Start(-root))},
        joints=(Revolute("ground", "beam.root", Z, name="drive", angle=Polynomial((0.0, gamma))),),
        loads=(Force("beam.tip", unit * KICK, Pulse(1.0, 0.0, 50 * step), follower=True),),
        settings=Settings(
            t_end=t_end,
            step=step,
            rho_inf=0.9,
            start="equilibrium",
            steady_rotation=SteadyRotation(gamma * Z),
        ),
    )
    results = simulate(model)
    tip, angle = results.frame("beam.tip").position, gamma * results.time
    cos, sin = np.cos(angle), np.sin(angle)
    return np.column_stack(
        [cos * tip[:, 0] + sin * tip[:, 1], cos * tip[:, 1] - sin * tip[:, 0], tip[:, 2]]
    )


def found_and_exact(beam, gamma, count=2):
    """Frequencies of flap and of lag (2, count), and those of the theory."""
    tip = kicked(beam, gamma)
    exact = np.array([f[:count] for f in rotating_cantilever(gamma)])
    found = [
        [frequency(tip[:, axis], STEP, near) for near in row]
        for axis, row in zip((2, 1), exact, strict=True)
    ]
    return np.array(found), exact


@pytest.fixture(scope="module")
def slender(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slender")
    interfaces = {"root": 0, "tip": 20}
    return beam_superelement(folder, along(1.0, 20), SLENDER, interfaces, rotation=FROM_ROOT)


@pytest.mark.parametrize("gamma", [3.0, 6.0])
def test_rotation_stiffens_flap_and_lag(slender, gamma):
    found, exact = found_and_exact(slender, gamma)
    print(f"gamma = {gamma}: flap {found[0]}, lag {found[1]}, errors {found / exact - 1.0}")
    np.testing.assert_allclose(found, exact, rtol=1e-3)


SIDE, E = 0.04, 1.0
"""of a bar of 1 m and 1 kg/m^3: its first frequencies are 3.516 SIDE / sqrt(12)"""
UNIT = SIDE / np.sqrt(12.0)
BOXES = (8, 1, 1)


def solid(folder, nu, root):
    """A bar of hexahedra on a root of this kind, and the same as a nonlinear mesh."""
    size, material = (1.0, SIDE, SIDE), {"E": E, "nu": nu, "rho": 1.0}
    impulse = {"step": 1e-3, "steps": 1, "method": "modal"}
    element = solid_superelement(
        folder, "hexahedron27", size, BOXES, material, impulse, root, rotation=FROM_ROOT
    )
    return element, SolidBox(size, BOXES, **material)


def found_of_solid(element, gamma, near):
    """Frequencies of flap and of lag (2, 2) in the unit of those of beams."""
    step = STEP / UNIT
    tip = kicked(element, gamma * UNIT, step, T_END / UNIT, UNIT**2 * SIDE**2)
    found = [
        [frequency(tip[:, axis], step, UNIT * omega) / UNIT for omega in row]
        for axis, row in zip((2, 1), near, strict=True)
    ]
    return np.array(found)


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_a_bar_of_solids_stiffens_like_its_nonlinear_mesh(nu, tmp_path):
    """Within a thousandth of that, which is within a hundredth of the theory of slender beams."""
    gamma = 3.0
    element, mesh = solid(tmp_path, nu, "rigid")
    exact = np.array([f[:2] for f in mesh.flap_and_lag(gamma * UNIT)]) / UNIT
    theory = np.array([f[:2] for f in rotating_cantilever(gamma)])
    found = found_of_solid(element, gamma, exact)
    print(f"errors {found / exact - 1.0}, against slender beams {found / theory - 1.0}")
    np.testing.assert_allclose(found, exact, rtol=1e-3)
    np.testing.assert_allclose(found, theory, rtol=1e-2)


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_a_bar_held_by_the_mean_of_its_root_stiffens_like_slender_beams(nu, tmp_path):
    element, _ = solid(tmp_path, nu, "average")
    theory = np.array([f[:2] for f in rotating_cantilever(3.0)])
    found = found_of_solid(element, 3.0, theory)
    print(f"held by its mean, against slender beams {found / theory - 1.0}")
    np.testing.assert_allclose(found, theory, rtol=1e-2)
