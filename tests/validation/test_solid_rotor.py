"""Case 1 of the paper with a blade of 10-node tetrahedra, by Krylov, beside that of beams: nothing
else changes.

Both are a square bar of aluminium with the paper's EI and mass per length, of 5.48 mm on 500 mm:
100 x 1 x 1 boxes of six tetrahedra, and 20 of Timoshenko's beams. EA, of which the paper has ten
times as much, plays no part. The torque is that of `examples/case1.toml`.

The two motions may differ by what the meshes explain: the clamped bars' first frequencies differ by
a share s, so that the rotor's drifts apart by a phase of up to 2 pi f s t_end, and static
deflections by 2 s. Measured: s = 2.3e-5, and 2.0e-4 of the peak for the tip where 9.2e-4 are
explained.
"""

import numpy as np
import pytest
from duhamel.solver import (
    Fixed,
    FlexibleBody,
    Frame,
    Model,
    Place,
    Revolute,
    RigidBody,
    Settings,
    Start,
    Steps,
    Torque,
    simulate,
)

from .solid_bar import clamped_modes, solid_superelement
from .straight_beam import along, beam_superelement

pytestmark = pytest.mark.validation

L, a, EI, MASS_PER_LENGTH = 0.5, 0.05, 5.5, 0.0858
rho, nu = 2860.0, 0.33
A = MASS_PER_LENGTH / rho
I_A = A**2 / 12.0
E = EI / I_A
G = 0.5 * E / (1.0 + nu)
HUB = 4.0 * MASS_PER_LENGTH * L * (L**2 / 12.0 + (a + 0.5 * L) ** 2)
ROTOR_FREQUENCY, T_END = 19.8986, 0.3
SECTION = {
    "EA": E * A,
    "GA_y": 5 / 6 * G * A,
    "GA_z": 5 / 6 * G * A,
    "EI_y": EI,
    "EI_z": EI,
    "GJ": 0.1406 * G * A**2,
    "mass_per_length": MASS_PER_LENGTH,
    "rotary_inertia_y": rho * I_A,
    "rotary_inertia_z": rho * I_A,
    "polar_inertia_per_length": 2.0 * rho * I_A,
}


@pytest.fixture(scope="module")
def blades(tmp_path_factory):
    folder, side = tmp_path_factory.mktemp("blades"), np.sqrt(A)
    material, impulse = {"E": E, "nu": nu, "rho": rho}, {"step": 6e-5, "steps": 5000}
    return {
        "beam": beam_superelement(folder, along(L, 20), SECTION, {"root": 0, "tip": 20}),
        "solid": solid_superelement(
            folder, "tetra10", (L, side, side), (100, 1, 1), material, impulse
        ),
    }


def motion(blade):
    """Angle of the hub [rad] and deflection of the tip across its radius [m], (n_t,) each."""
    hub = RigidBody(0.01, HUB * np.array([0.5, 0.5, 1.0]), {"rim": Frame([a, 0, 0])})
    model = Model(
        bodies={"hub": hub, "blade": FlexibleBody(blade, Start(place=Place("root", "hub.rim")))},
        joints=(
            Revolute("ground", "hub", [0, 0, 1], name="pivot"),
            Fixed("hub.rim", "blade.root", name="clamp"),
        ),
        loads=(Torque("hub", [0, 0, 2.0], Steps((0.0, 0.05, 0.15, 0.2), (1.0, 0.0, -1.0, 0.0))),),
        settings=Settings(t_end=T_END, step=6e-5, rho_inf=0.9),
    )
    results = simulate(model)
    angle = results.joint("pivot").coordinates["angle"]
    tip = results.frame("blade.tip").position
    return angle, np.cos(angle) * tip[:, 1] - np.sin(angle) * tip[:, 0]


def test_a_solid_blade_turns_as_one_of_beams(blades):
    frequency, of_solid = (clamped_modes(blade)[0][:2].mean() for blade in blades.values())
    shift = of_solid / frequency - 1.0
    explained = abs(shift) * (2.0 * np.pi * ROTOR_FREQUENCY * T_END + 2.0)
    found = {kind: motion(blade) for kind, blade in blades.items()}
    angle, tip = (
        np.abs(of_solid - of_beam).max() / np.abs(of_beam).max()
        for of_beam, of_solid in zip(found["beam"], found["solid"], strict=True)
    )
    print(
        f"clamped: {frequency:.4f} Hz, solid less beam {shift:+.2e}; largest differences over "
        "the peaks:"
    )
    print(
        f"angle of the hub {angle:.2e}, deflection of the tip {tip:.2e}; explained {explained:.2e}"
    )
    assert tip < explained
    assert angle < explained
