"""Bars of solids against Timoshenko's beam: frequencies, clamped and free, and the response to a
force on the tip.

Steel-like bars of 27-node hexahedra and of 10-node tetrahedra with nu = 0, section 80 x 100 mm: a
section that does not contract makes no singularity at the clamp, so that the elements show their
full order. The closed form is that of

    w' = psi + Q / (kappa G A),  psi' = M / (E I),  M' = -Q - rho I omega^2 psi,  Q' = -rho A
    omega^2 w

with kappa = 5/6, which is Cowper's value for nu = 0 (Journal of Applied Mechanics 33 (1966)
335-340): a free bar agrees with it to the fourth order of depth over length. A clamp keeps the end
section plane, which shear would warp: that stiffens a piece of about the depth, in a part of the
compliance that goes with the square, so the third order.

Tolerances. Quadratic elements bring order 4 in frequencies; measured 3.86 to 3.94 for hexahedra,
3.2 to 3.4 for tetrahedra, whose coarsest mesh is not yet there. Orders in depth over length, of
extrapolated meshes: 2.8 and 2.9. The tip is compared with that of 40 beam elements over five
periods. Modes of static share s_j whose frequencies differ drift apart, and the responses with
them, by no more than sum s_j 2 pi |f_j - f_j'| t_end and the static difference.
"""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Model,
    Settings,
    Start,
    simulate,
)
from scipy.linalg import expm
from scipy.optimize import brentq

from .solid_bar import clamped_modes, solid_superelement
from .straight_beam import along, beam_superelement

pytestmark = pytest.mark.validation

E, rho, WIDTH, DEPTH = 2e11, 8000.0, 0.08, 0.1
G, A, kappa = E / 2, WIDTH * DEPTH, 5 / 6
I_Y, I_Z = WIDTH * DEPTH**3 / 12, DEPTH * WIDTH**3 / 12
KINDS = ("hexahedron27", "tetra10")
REFINEMENTS = (1, 2, 4)
ORDER = {"hexahedron27": 3.8, "tetra10": 3.1}
STEP = 2.5e-5


@pytest.fixture(scope="module")
def bar(tmp_path_factory):
    """A bar of a length and a kind of elements with n of them across each side, clamped by a rigid
    root; made once.
    """
    made = {}

    def make(kind, length, n):
        if (kind, length, n) not in made:
            made[kind, length, n] = solid_superelement(
                tmp_path_factory.mktemp("bar"),
                kind,
                (length, WIDTH, DEPTH),
                (round(10 * length * n), n, n),
                {"E": E, "nu": 0.0, "rho": rho},
                {"step": STEP * length, "tolerance": 1e-8},
                root="rigid",
            )
        return made[kind, length, n]

    return make


def first_two(bar, support):
    """The first frequency [Hz] of bending in each plane, the softer one first."""
    return bar.modes.omega[:2] / (2.0 * np.pi) if support == "free" else clamped_modes(bar)[0][:2]


def closed_form(length, I_A, support, near):
    """The frequency [Hz] of Timoshenko's beam, within 5 % of `near`."""

    def determinant(f):
        omega = 2.0 * np.pi * f
        scale = np.array([1.0, 1.0 / length, E * I_A / length**2, E * I_A / length**3])
        system = np.zeros((4, 4))  # of w, psi, M, Q
        system[0, 1], system[0, 3], system[1, 2] = 1.0, 1.0 / (kappa * G * A), 1.0 / (E * I_A)
        system[2, 1], system[2, 3], system[3, 0] = -rho * I_A * omega**2, -1.0, -rho * A * omega**2
        across = expm(length * system * scale / scale[:, None])
        return np.linalg.det(across[2:, :2] if support == "free" else across[2:, 2:])

    return brentq(determinant, 0.95 * near, 1.05 * near, xtol=1e-10)


@pytest.mark.parametrize("support", ["free", "clamped"])
def test_frequencies_converge_with_the_mesh_and_to_each_other(bar, support):
    found = {
        kind: np.array([first_two(bar(kind, 1.0, n), support) for n in REFINEMENTS])
        for kind in KINDS
    }
    limit = np.array(
        [
            closed_form(1.0, I_A, support, f)
            for I_A, f in zip((I_Z, I_Y), found[KINDS[0]][-1], strict=True)
        ]
    )
    apart = np.abs(found["tetra10"] / found["hexahedron27"] - 1.0).max(axis=1)
    for kind, frequencies in found.items():
        coarse, fine = -np.diff(frequencies, axis=0)
        order = np.log2(coarse / fine)
        print(
            f"{support}, {kind}: {frequencies.tolist()} Hz, order {order}; off Timoshenko "
            f"{frequencies / limit - 1}"
        )
        assert (order > ORDER[kind]).all()
    print(f"{support}: apart from each other {apart}")
    assert (np.log2(apart[:-1] / apart[1:]) > 2.0).all()
    assert apart[-1] < 2e-5


def test_slender_bars_tend_to_the_beam(bar):
    lengths = np.array([0.25, 0.5, 1.0])
    off = {"free": [], "clamped": []}
    for length in lengths:
        for support, differences in off.items():
            coarse, fine = (first_two(bar("hexahedron27", length, n), support) for n in (2, 4))
            frequencies = fine - (coarse - fine) / 15.0
            theory = [
                closed_form(length, I_A, support, f)
                for I_A, f in zip((I_Z, I_Y), frequencies, strict=True)
            ]
            differences.append(frequencies / theory - 1.0)
    free, clamped = np.array(off["free"]), np.array(off["clamped"])
    order = np.log2(clamped[:-1] / clamped[1:])
    print(
        f"depth over length {DEPTH / lengths}: free {free.tolist()}, clamped "
        f"{clamped.tolist()}, order {order.tolist()}"
    )
    assert (np.abs(free) < 0.02 * (DEPTH / lengths[:, None]) ** 4).all()
    assert (order > 2.7).all()
    assert (order < 3.1).all()


def bending(part):
    """The first four clamped modes that a force along z on the tip excites: frequencies [Hz], and
    compliances [m/N].
    """
    frequency, tip = clamped_modes(part)
    compliance = (tip[2] / (2.0 * np.pi * frequency)) ** 2
    largest = np.sort(np.argsort(compliance)[-4:])
    return frequency[largest], compliance[largest]


def tip_response(part, length, t_end):
    """Deflection of the tip (n_t,) under a force along z from t = 0 on, with the root on ground."""
    model = Model(
        bodies={"bar": FlexibleBody(part, Start(position=[0.5 * length, 0, 0]))},
        joints=(Fixed("ground", "bar.root", name="clamp"),),
        loads=(Force("bar.tip", [0, 0, 1.0], Constant(1.0)),),
        settings=Settings(t_end=t_end, step=STEP * length, rho_inf=0.9),
    )
    results = simulate(model)
    return results.frame("bar.tip").position[:, 2]


def test_the_tip_follows_that_of_the_beam(bar, tmp_path):
    length, elements = 1.0, 40
    section = {
        "EA": E * A,
        "GA_y": kappa * G * A,
        "GA_z": kappa * G * A,
        "EI_y": E * I_Y,
        "EI_z": E * I_Z,
        "GJ": G * (I_Y + I_Z),
        "mass_per_length": rho * A,
        "rotary_inertia_y": rho * I_Y,
        "rotary_inertia_z": rho * I_Z,
        "polar_inertia_per_length": rho * (I_Y + I_Z),
    }
    beam = beam_superelement(
        tmp_path, along(length, elements), section, {"root": 0, "tip": elements}
    )
    frequency, compliance = bending(beam)
    t_end = 5.0 / frequency[0]
    reference = tip_response(beam, length, t_end)
    static = length**3 / (3.0 * E * I_Y) + length / (kappa * G * A)
    print(f"beam: {frequency} Hz, shares of the static deflection {compliance / static}")
    np.testing.assert_allclose(compliance.sum(), static, rtol=1e-3)
    for kind in KINDS:
        off = []
        for n in REFINEMENTS:
            part = bar(kind, length, n)
            of_solid, solid_compliance = bending(part)
            drift = compliance @ np.abs(of_solid - frequency) * 2.0 * np.pi * t_end
            explained = drift + 2.0 * np.abs(solid_compliance - compliance).sum()
            off.append(np.abs(tip_response(part, length, t_end) - reference).max())
            print(
                f"{kind}, {n} across: off by {off[-1] / static:.2e}, explained "
                f"{explained / static:.2e} of the static"
            )
            assert off[-1] < explained
        assert off[0] > 4.0 * off[1] > 16.0 * off[2]
