"""The 45 degree bend of Bathe and Bolourchi: a cantilever along an arc, loaded out of its plane, at
rest.

R = 100 in, section 1 x 1 in, E = 1e7 psi, nu = 0 (so G = E/2), force 600 lb along z at the tip. The
arc starts at the origin along x and bends towards -y, so that the tip is at (70.71, -29.29, 0)
without the force.

Reference: displacement of the tip (-23.821, 13.732, 53.610) in; published values differ by about
one per cent. Source of the problem: K. J. Bathe and S. Bolourchi, Large displacement analysis of
three-dimensional beam structures, International Journal for Numerical Methods in Engineering 14
(1979) 961-986.

Five superelements of 8 straight elements each; each turns by about ten degrees within itself, where
it is linear. Tolerance 5 %; ten superelements are nearer to the reference.
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

from .straight_beam import beam_superelement

pytestmark = pytest.mark.validation

R, E, FORCE = 100.0, 1e7, 600.0
REFERENCE = np.array([-23.821, 13.732, 53.610])
ANGLE, ELEMENTS = np.pi / 4, 8
SECTION = {
    "EA": E,
    "GA_y": 5 / 6 * 0.5 * E,
    "GA_z": 5 / 6 * 0.5 * E,
    "EI_y": E / 12,
    "EI_z": E / 12,
    "GJ": 0.1406 * 0.5 * E,
    "mass_per_length": 2.5e-4,
    "polar_inertia_per_length": 2.5e-4 / 6,
}


def arc(angle, elements):
    """Nodes on an arc of radius R about (0, -R, 0) that starts at the origin along x (elements + 1,
    3).
    """
    phi = np.linspace(0.0, angle, elements + 1)
    return R * np.column_stack([np.sin(phi), np.cos(phi) - 1.0, np.zeros_like(phi)])


def turned(points, angle):
    """Along the arc by an angle (3,)."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = points - np.array([0.0, -R, 0.0])
    return np.array([cos * x + sin * y, cos * y - sin * x - R, z])


def bend(folder, n):
    """n superelements along the arc, in equilibrium at t = 0."""
    part = beam_superelement(
        folder, arc(ANGLE / n, ELEMENTS), SECTION, {"root": 0, "tip": ELEMENTS}
    )
    bodies = {
        f"b{i}": FlexibleBody(
            part, Start(turned(part.center, i * ANGLE / n), [0.0, 0.0, -i * ANGLE / n])
        )
        for i in range(n)
    }
    return Model(
        bodies=bodies,
        joints=(
            Fixed("ground", "b0.root", name="clamp"),
            *(Fixed(f"b{i}.tip", f"b{i + 1}.root", name=f"j{i}") for i in range(n - 1)),
        ),
        loads=(Force(f"b{n - 1}.tip", [0, 0, FORCE], Constant(1.0)),),
        settings=Settings(start="equilibrium", t_end=0.05, step=1e-3),
    )


def displacement(folder, n):
    """Of the tip in equilibrium (3,), and how far it moves in the steps that follow."""
    results = simulate(bend(folder, n))
    tip = results.frame(f"b{n - 1}.tip").position
    moved = tip[0] - arc(ANGLE, 1)[-1]
    print(
        f"{n} superelements: tip moved by {moved} in, reference {REFERENCE}, "
        f"{results.solver['seconds']:.2f} s"
    )
    return moved, np.abs(tip - tip[0]).max()


@pytest.mark.parametrize("n", [5, 10])
def test_the_tip_is_where_bathe_and_bolourchi_find_it(n, tmp_path):
    moved, drift = displacement(tmp_path, n)
    print(f"relative difference {moved / REFERENCE - 1.0}, drift {drift:.1e} in")
    np.testing.assert_allclose(moved, REFERENCE, rtol=0.05)
    assert drift < 1e-6
