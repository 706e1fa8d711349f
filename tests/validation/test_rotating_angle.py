"""An angle of two beams in steady rotation, as one body of second order and as straight pieces.

0.3 m along x and 0.2 m along y, the end of the first clamped to a hub that turns about z; a small
force on the tip along the axis shows how stiff it is across the plane. The reference is a chain of
twelve bodies, one for each element, with [rotation] each: straight, so that all stress is that of
loads, and so short that none of them bends.

Tolerances: a body that is bent has strain energies of third order in its coordinates, which level 1
leaves out, so that its error grows with its deflection: 0.03, 0.14, 0.57 % in the plane and below
0.02 % across it at 10, 20, 40 rad/s, where the tip moves by 0.1, 0.3, 1.3 % of the length. Without
terms of second order it is 20 %, and 11 % where soft shapes carry the stress that stiffens.
"""

from pathlib import Path

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Model,
    Revolute,
    RigidBody,
    Settings,
    Start,
    SteadyRotation,
    simulate,
)

from .straight_beam import beam_superelement

SECTION = {
    "EA": 2.16e7,
    "EI_y": 5.5,
    "EI_z": 5.5,
    "GJ": 4.0,
    "mass_per_length": 0.0858,
    "polar_inertia_per_length": 4.4e-8,
}
POINTS = np.array(
    [[x, 0.0, 0.0] for x in np.linspace(0.0, 0.3, 7)]
    + [[0.3, y, 0.0] for y in np.linspace(0.0, 0.2, 7)[1:]]
)
Z = np.array([0.0, 0.0, 1.0])


def tip_moves(folder: Path, pieces: int, spin: float) -> np.ndarray:
    """Of the angle as so many bodies in a row, in steady rotation (3,)."""
    bodies = {"hub": RigidBody(1.0, [1.0, 1.0, 1.0])}
    joints = [Revolute("ground", "hub", Z, name="pivot")]
    carrier = "hub"
    for i, nodes in enumerate(np.array_split(np.arange(12), pieces)):
        points = POINTS[nodes[0] : nodes[-1] + 2]
        ends = {"root": 0, "tip": len(points) - 1}
        element = beam_superelement(folder, points, SECTION, ends, rotation={})
        bodies[f"b{i}"] = FlexibleBody(element, Start(position=element.center))
        joints.append(Fixed(carrier, f"b{i}.root", name=f"j{i}"))
        carrier = f"b{i}.tip"
    start = {"start": "equilibrium", "steady_rotation": SteadyRotation(spin * Z)}
    settings = Settings(t_end=1e-4, step=1e-4, rho_inf=0.9, **start)
    load = Force(carrier, 0.02 * Z, Constant(1.0))
    results = simulate(Model(bodies, tuple(joints), loads=(load,), settings=settings))
    return results.frame(carrier).position[0] - POINTS[-1]


@pytest.mark.parametrize(("spin", "in_plane"), [(10.0, 5e-4), (20.0, 2e-3), (40.0, 8e-3)])
def test_an_angle_is_right_as_one_body(tmp_path, spin, in_plane):
    found, expected = (tip_moves(tmp_path, pieces, spin) for pieces in (1, 12))
    error = np.linalg.norm((found - expected)[:2]) / np.linalg.norm(expected[:2])
    print(f"{spin} rad/s: error in the plane {error}, across it {found[2] / expected[2] - 1.0}")
    assert error < in_plane
    assert found[2] == pytest.approx(expected[2], rel=5e-4)
