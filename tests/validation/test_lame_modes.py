"""Lame's modes of a free square prism a x a x b, which bring no traction to any of its faces.

    u = (cos(k x) sin(k y), -sin(k x) cos(k y), 0),    k = n pi / a,    n = 1, 2, ...
    f_n = n c_s / (sqrt(2) a),    c_s = sqrt(G / rho)

The divergence, the shear strain and all strains along z are zero, and sigma_xx = -sigma_yy = -2 G k
sin(k x) sin(k y) is zero where it would be a traction: the modes are exact for every b, every
Poisson's ratio and every n. Source: H. Lamb, Proc. London Math. Soc. 21 (1889) 85-120, who has them
from G. Lame; K. F. Graff, Wave Motion in Elastic Solids (1975), section 8.2.

The interfaces are the mean motions of the faces x = 0 and x = a: by mean displacements they excite
odd n, by mean rotations even ones. With modes of unit mass, in a body of mass m,

    u_x = sqrt(2 / m) 2 / (n pi)    on both, opposite,                        n odd
    theta_z = sqrt(2 / m) 12 / (n pi a)    on both, the same,                 n even

and all their other dofs rest. With nu = 0 bars that stretch have the frequencies of odd n as well,
and modes of one frequency mix: the ratios tried are others. Frequencies converge with the fourth
power of the elements' size; tolerances beside 1e-5 are of these orders. Steel, a = 0.1 m.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from duhamel.superelement import Superelement
from numpy.typing import NDArray

from .solid_bar import solid_superelement

Array = NDArray[np.float64]

E, rho, SIDE = 2.1e11, 7800.0, 0.1
EXACT = 1e-5


def lame_frequency(n: int, nu: float) -> float:
    """f_n [Hz]"""
    return float(n * np.sqrt(0.5 * E / (1.0 + nu) / rho / 2.0) / SIDE)


def prism(
    folder: Path,
    kind: str,
    divisions: tuple[int, int, int],
    nu: float,
    highest: int,
    **impulse: Any,
) -> Superelement:
    """With a band that ends between the modes of n = `highest` and the next, and b / a of the
    divisions, so that elements are cubes.
    """
    band = lame_frequency(1, nu) * (highest + 0.4)
    height = SIDE * divisions[2] / divisions[0]
    return solid_superelement(
        folder,
        kind,
        (SIDE, SIDE, height),
        divisions,
        {"E": E, "nu": nu, "rho": rho},
        {"step": 0.25 / band, "steps": 200, **impulse},
    )


def lame_motion(n: int, mass: float) -> Array:
    """What the interfaces do in mode n (12,): root, then tip, each three displacements and three
    rotations.
    """
    phi = np.zeros(12)
    if n % 2:
        phi[[0, 6]] = 2.0 / (n * np.pi) * np.array([1.0, -1.0])
    else:
        phi[[5, 11]] = 12.0 / (n * np.pi * SIDE)
    return np.sqrt(2.0 / mass) * phi


def errors(found: Superelement, n: int, nu: float) -> tuple[float, float]:
    """Of frequency and motion of the mode that moves the interfaces as Lame's mode n does.

    The frequency relative to f_n, the motion to the largest of its own, rotations times half the
    side.
    """
    phi, scale = found.modes.phi, np.tile([1.0, 1.0, 1.0, *[0.5 * SIDE] * 3], 2)
    exact = (lame_motion(n, found.mass) * scale)[:, None]
    scaled = phi * scale[:, None]
    scaled = scaled * np.sign(exact.T @ scaled)
    apart = np.abs(scaled - exact).max(axis=0) / np.abs(exact).max()
    mode = int(apart.argmin())
    return float(found.modes.frequencies[mode] / lame_frequency(n, nu) - 1.0), float(apart[mode])


@pytest.mark.parametrize(("kind", "coarse"), [("hexahedron27", 4), ("tetra10", 8)])
def test_frequencies_converge_with_the_fourth_power(kind, coarse, tmp_path):
    nu, found = 0.3, []
    for k in (coarse, 2 * coarse):
        frequency, motion = errors(prism(tmp_path, kind, (k, k, k // 4), nu, 1), 1, nu)
        print(f"{kind}, {k} elements: frequency {frequency:.2e}, motion {motion:.2e}")
        found.append(frequency)
    assert 3.5 < np.log2(found[0] / found[1]) < 4.5
    assert abs(16.0 * found[1] - found[0]) / 15.0 < EXACT  # extrapolated
    assert motion < 1e-3


@pytest.mark.validation
@pytest.mark.parametrize("nu", [0.1, 0.45])
@pytest.mark.parametrize(
    ("kind", "divisions", "highest"),
    [("hexahedron27", (28, 28, 2), 2), ("tetra10", (24, 24, 4), 1)],
)
def test_lame_modes_with_a_factor(kind, divisions, highest, nu, tmp_path):
    check(prism(tmp_path, kind, divisions, nu, highest, solver="factor"), nu, highest)


@pytest.mark.parametrize(
    ("kind", "divisions", "highest"),
    [
        pytest.param("hexahedron27", (16, 16, 8), 1, marks=pytest.mark.validation),
        pytest.param("tetra10", (54, 54, 14), 2, marks=pytest.mark.large),
    ],
    ids=["56 thousand unknowns", "a million unknowns"],
)
def test_lame_modes_without_a_factor(kind, divisions, highest, tmp_path):
    nu = 0.3
    check(prism(tmp_path, kind, divisions, nu, highest, solver="iterative"), nu, highest)


def check(found: Superelement, nu: float, highest: int) -> None:
    for n in range(1, highest + 1):
        frequency, motion = errors(found, n, nu)
        print(f"nu = {nu}, n = {n}: frequency {frequency:.2e}, motion {motion:.2e}")
        assert abs(frequency) < EXACT
        assert motion < 1e-3
