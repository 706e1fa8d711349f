"""Whirl of a shaft with a disk off its middle, on two bearings, one body: forwards and backwards.

Seen in space, y + i z of the disk turns at +omega or -omega; both are read off one complex signal
after a kick. Reference: finite elements in axes fixed in space, with the gyroscopic matrix of shaft
and disk, in `beam_theory.py`. At 300 rad/s the shaft turns 2.4 times as fast as its first critical
speed.
"""

import numpy as np
import pytest
from duhamel.solver import (
    FlexibleBody,
    Force,
    Frame,
    Model,
    Pulse,
    Settings,
    Spherical,
    Start,
    SteadyRotation,
    Torque,
    linearize,
    simulate,
)

from .beam_theory import whirl
from .spectrum import frequency
from .straight_beam import along, beam_superelement

X = np.array([1.0, 0.0, 0.0])
L, DIAMETER, RHO, E = 1.0, 0.02, 7850.0, 2.1e11
A, I_A = np.pi * DIAMETER**2 / 4.0, np.pi * DIAMETER**4 / 64.0
DISK = (5.0, 0.05, 0.025)
"""mass, inertia about the shaft, about a diameter"""
STEP, T_END = 1e-5, 0.5
N = 24


@pytest.fixture(scope="module")
def shaft(tmp_path_factory):
    section = {
        "EA": E * A,
        "EI_y": E * I_A,
        "EI_z": E * I_A,
        "GJ": E / 2.6 * 2.0 * I_A,
        "mass_per_length": RHO * A,
        "rotary_inertia_y": RHO * I_A,
        "rotary_inertia_z": RHO * I_A,
        "polar_inertia_per_length": 2.0 * RHO * I_A,
    }
    m, polar, diametral = DISK
    disk = {"interface": "disk", "mass": m, "inertia": [polar, diametral, diametral]}
    return beam_superelement(
        tmp_path_factory.mktemp("shaft"),
        along(L, N),
        section,
        {"left": 0, "right": N, "disk": N // 3},
        masses={"disk": disk},
        rotation={"modes": 8, "soft": 8, "loaded": ["left", "right"]},
    )


def kicked(shaft, spin, t_end=T_END):
    """y + i z of the disk (n_t,)."""
    start = -shaft.interface("left").X
    model = Model(
        bodies={"shaft": FlexibleBody(shaft, Start(start))},
        joints=(
            Spherical("ground", "shaft.left", name="left"),
            Spherical("ground.right", "shaft.right", name="right"),
        ),
        loads=(
            Force("shaft.disk", [0, 0.3, 0], Pulse(1.0, 0.0, 1e-3)),
            Torque("shaft.disk", [0, 0, 0.1], Pulse(1.0, 0.0, 1e-3)),
        ),
        ground_frames={"right": Frame([L, 0, 0])},
        settings=Settings(
            t_end=t_end,
            step=STEP,
            rho_inf=0.9,
            start="equilibrium",
            steady_rotation=SteadyRotation(spin * X),
        ),
    )
    y, z = simulate(model).frame("shaft.disk").position[:, 1:].T
    return y + 1j * z


@pytest.mark.parametrize(
    "spin", [300.0, *(pytest.param(s, marks=pytest.mark.validation) for s in (100.0, 600.0))]
)
def test_a_shaft_whirls_forwards_and_backwards(shaft, spin):
    exact = whirl(spin, L, E * I_A, RHO * A, RHO * I_A, DISK, 1.0 / 3.0)[:4]
    signal = kicked(shaft, spin)
    found = np.array([frequency(signal, STEP, omega) for omega in exact])
    print(f"{spin} rad/s: {found}, exact {exact}, errors {found / exact - 1.0}")
    np.testing.assert_allclose(found, exact, rtol=1e-3)


@pytest.mark.parametrize("spin", [0.0, 100.0, 600.0])
def test_linear_analysis_has_the_whirl(shaft, spin):
    exact = whirl(spin, L, E * I_A, RHO * A, RHO * I_A, DISK, 1.0 / 3.0)[:4]
    model = Model(
        bodies={"shaft": FlexibleBody(shaft, Start(-shaft.interface("left").X))},
        joints=(
            Spherical("ground", "shaft.left", name="left"),
            Spherical("ground.right", "shaft.right", name="right"),
        ),
        ground_frames={"right": Frame([L, 0, 0])},
        settings=Settings(t_end=T_END, step=STEP, rho_inf=0.9),
    )
    found = linearize(model, SteadyRotation(spin * X)).modes().values.imag
    for omega in np.abs(exact - spin):
        assert np.abs(found - omega).min() < 1e-5 * max(omega, spin)
