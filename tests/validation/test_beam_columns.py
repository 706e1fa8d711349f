"""Beams under axial loads, one body each: what buckles them, how they vibrate before, and how
clamps that do not move stiffen them.

The end that slides is held by a slider of no weight to speak of. The axial load is there from the
start, in equilibrium; then a moment kicks the beam, and the square of its first frequency, which
falls almost linearly with the load, is extrapolated to zero.
"""

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Model,
    Place,
    Prismatic,
    Pulse,
    RigidBody,
    Settings,
    Start,
    simulate,
)

from .beam_theory import buckling_loads, loaded_between_clamps
from .spectrum import frequency
from .straight_beam import along, beam_superelement

X, Z = np.eye(3)[[0, 2]]
STEP = 2e-3
SECTION = {
    "EI_y": 1.0,
    "EI_z": 1.0,
    "GJ": 1.0,
    "mass_per_length": 1.0,
    "rotary_inertia_y": 1e-6,
    "rotary_inertia_z": 1e-6,
    "polar_inertia_per_length": 2e-6,
}
SUPPORTS = {
    "pinned-pinned": ("revolute", "revolute"),
    "clamped-free": ("fixed", None),
    "clamped-pinned": ("fixed", "revolute"),
    "clamped-guided": ("fixed", "fixed"),
}
AT_REST = {
    "pinned-pinned": np.pi**2,
    "clamped-free": 1.8751**2,
    "clamped-pinned": 3.9266**2,
    "clamped-guided": 4.7300**2,
}
"""first frequencies without load, sqrt(EI / (m L^4))"""


def column(folder, EA=1e5, points=None, **rotation):
    interfaces = points or {"root": 0, "tip": 20}
    section = SECTION | {"EA": EA}
    return beam_superelement(folder, along(1.0, 20), section, interfaces, rotation=rotation)


def held(beam, ends, P, kick=1e-4):
    """A column from the origin along x, and its tip under a dead load -P; moments kick its ends."""
    root, tip = ends
    axes = {"revolute": (Z,), "fixed": ()}
    clamp = JOINTS[root]("ground", "beam.root", *axes[root], name="root")
    bodies, joints = {"beam": FlexibleBody(beam, Start(-beam.interface("root").X))}, [clamp]
    if tip:
        on = Start(place=Place("center", "beam.tip"))
        bodies["slider"] = RigidBody(1e-6, 1e-9 * np.ones(3), {"center": Frame()}, on)
        joints += [
            Prismatic("ground", "slider.center", X, name="guide"),
            JOINTS[tip]("slider.center", "beam.tip", *axes[tip], name="tip"),
        ]
    signal, on = Pulse(kick, 0.0, 0.1), "middle" if tip else "tip"
    return Model(
        bodies=bodies,
        joints=joints,
        loads=(
            Force("beam.tip", -P * X, Constant(1.0)),
            Force(f"beam.{on}", [0, 1, 0], signal),
        ),
        settings=Settings(t_end=20.0, step=STEP, rho_inf=0.9, start="equilibrium"),
    )


MIDDLE = {"root": 0, "middle": 10, "tip": 20}


def first_frequency(beam, name, P, Pcr):
    results = simulate(held(beam, SUPPORTS[name], P))
    near = AT_REST[name] * np.sqrt(1.0 - P / Pcr)
    on = "tip" if name == "clamped-free" else "middle"
    return frequency(results.frame(f"beam.{on}").position[:, 1], STEP, near)


@pytest.fixture(scope="module")
def beam(tmp_path_factory):
    return column(tmp_path_factory.mktemp("column"), points=MIDDLE, modes=2, loaded=["root", "tip"])


@pytest.mark.parametrize("name", SUPPORTS)
def test_the_load_that_buckles_a_column(beam, name):
    exact = buckling_loads()[name]
    loads = np.array([0.6, 0.75, 0.9]) * exact
    squares = [first_frequency(beam, name, P, exact) ** 2 for P in loads]
    parabola = np.polynomial.Polynomial.fit(squares, loads, 2)
    found = parabola(0.0)
    print(f"{name}: {found:.5f}, exact {exact:.5f}, error {found / exact - 1.0:.1e}")
    assert found == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("P", [-20.0, -5.0, 3.0, 6.0, 9.0])
def test_the_frequency_of_a_loaded_column(beam, P):
    """Pinned at both ends: pi^2 sqrt(1 - P / pi^2)."""
    exact = np.pi**2 * np.sqrt(1.0 - P / np.pi**2)
    found = first_frequency(beam, "pinned-pinned", P, np.pi**2)
    print(f"P = {P}: {found:.4f}, exact {exact:.4f}")
    assert found == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("P", [1.0, 5.0, 10.0, 20.0])
def test_clamps_that_do_not_move_stiffen_a_beam(P, tmp_path_factory):
    """Up to deflections of 4.6 radii of gyration."""
    EA = 1e4
    beam = column(tmp_path_factory.mktemp("held"), EA, MIDDLE, modes=4)
    model = Model(
        bodies={"beam": FlexibleBody(beam, Start(-beam.interface("root").X))},
        joints=(
            Fixed("ground", "beam.root", name="left"),
            Fixed("ground.right", "beam.tip", name="right"),
        ),
        loads=(Force("beam.middle", [0, P, 0], Constant(1.0)),),
        ground_frames={"right": Frame([1, 0, 0])},
        settings=Settings(t_end=0.01, step=1e-3, start="equilibrium"),
    )
    results = simulate(model)
    found = results.frame("beam.middle").position[0, 1], results.joint("right").force[0, 0]
    exact = loaded_between_clamps(P, EA)
    print(f"P = {P}: deflection and tension over von Karman's: {np.divide(found, exact)}")
    assert found[0] == pytest.approx(exact[0], rel=5e-3)
    assert abs(found[1]) == pytest.approx(exact[1], rel=1e-2)
