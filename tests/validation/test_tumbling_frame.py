"""A frame of beams with a disk, free in space: it tumbles, shakes, and keeps energy and angular
momentum to the second order of the step.

Three beams in three directions, the disk on the second corner. The frame bends by its own rotation:
the terms of second order exchange energy between the rotation and the vibrations at every instant.
"""

from itertools import pairwise

import meshio
import numpy as np
import pytest
from duhamel.preprocess import Body, build
from duhamel.solver import FlexibleBody, Model, Settings, Start, simulate
from scipy.spatial.transform import Rotation

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1.3, 0.6, 0], [1.2, 1.0, 0.7]])
PER_LEG = 4
SECTION = {
    "EA": 2e3,
    "EI_y": 14.0,
    "EI_z": 9.0,
    "GJ": 10.0,
    "mass_per_length": 1.2,
    "rotary_inertia_y": 5e-3,
    "rotary_inertia_z": 7e-3,
    "polar_inertia_per_length": 1.2e-2,
}
SPIN, T_END = np.array([1.0, -1.5, 1.2]), 4.0


@pytest.fixture(scope="module")
def frame(tmp_path_factory):
    legs = pairwise(CORNERS)
    shares = np.arange(PER_LEG)[:, None] / PER_LEG
    points = np.vstack([*(a + shares * (b - a) for a, b in legs), CORNERS[-1:]])
    lines = np.column_stack([np.arange(len(points) - 1), np.arange(1, len(points))])
    tags = {tag: [np.ones(len(lines), dtype=int)] for tag in ("gmsh:physical", "gmsh:geometrical")}
    path = tmp_path_factory.mktemp("frame") / "frame.msh"
    meshio.Mesh(points, [("line", lines)], cell_data=tags).write(
        path, file_format="gmsh22", binary=False
    )
    ends = {"near": CORNERS[0], "far": CORNERS[-1]}
    return build(
        Body.model_validate(
            {
                "name": "frame",
                "mesh": str(path),
                "section": SECTION,
                "interfaces": {name: {"node": x.tolist()} for name, x in ends.items()},
                "masses": {
                    "disk": {
                        "node": CORNERS[1].tolist(),
                        "mass": 0.5,
                        "inertia": [0.03, 0.02, 0.01],
                    }
                },
                "impulse": {"step": 1e-2, "steps": 1, "method": "modal"},
                "rotation": {"modes": 8, "soft": 0},
            }
        )
    )


def tumbling(frame, step, position=(0, 0, 0), turn=(0, 0, 0), t_end=T_END, rho_inf=0.9):
    """It starts undeformed, in full rotation: so it is thrown into vibration at once."""
    start = Start(position, turn, angular_velocity=SPIN)
    settings = Settings(t_end=t_end, step=step, rho_inf=rho_inf)
    return simulate(Model({"frame": FlexibleBody(frame, start)}, settings=settings))


def drifts(results):
    """Of energy and of angular momentum, over their sizes."""
    energy = results.energy.kinetic + results.energy.elastic
    momentum = results.momentum.angular
    change = np.linalg.norm(momentum - momentum[0], axis=1).max()
    return np.ptp(energy) / energy[0], change / np.linalg.norm(momentum[0])


def test_it_is_thrown_into_vibration(frame):
    """By a twentieth of its size; and the ends of bodies of first order stay where they are."""
    u = tumbling(frame, 0.01).frame("frame.far").u
    print(f"largest displacement {np.linalg.norm(u[:, :3], axis=1).max():.3f}")
    assert 0.03 < np.linalg.norm(u[:, :3], axis=1).max() < 0.3


@pytest.mark.parametrize("rho_inf", [0.9, 1.0])
def test_energy_and_angular_momentum_are_kept_to_second_order(frame, rho_inf):
    steps = 0.02 / 2.0 ** np.arange(5)
    found = np.array([drifts(tumbling(frame, step, rho_inf=rho_inf)) for step in steps])
    orders = np.log2(found[:-1] / found[1:])
    print(f"energy {found[:, 0]}, angular momentum {found[:, 1]}, orders {orders}")
    assert found[2, 0] < 5e-4
    assert found[2, 1] < 1e-4
    np.testing.assert_allclose(orders[1:], 2.0, atol=0.25)


def test_the_motion_converges_with_the_square_of_the_step(frame):
    ends = [tumbling(frame, 0.0025 / 2**k).frame("frame.far").position[-1] for k in range(4)]
    changes = np.linalg.norm(np.diff(ends, axis=0), axis=1)
    print(f"changes of the far end {changes}")
    np.testing.assert_allclose(np.log2(changes[:-1] / changes[1:]), 2.0, atol=0.3)


@pytest.mark.parametrize("turn", [[0.0, 0.0, 3.0], [1.1, -2.0, 0.7], [-2.2, 0.4, 1.9]])
def test_elsewhere_and_turned_it_moves_alike(frame, turn):
    """A kilometer away: what is left is the rounding of positions, 1e-13 m a step."""
    there = np.array([600.0, -800.0, 100.0])
    here, moved = tumbling(frame, 0.01), tumbling(frame, 0.01, there, turn)
    for name in ("frame.near", "frame.far"):
        a, b = (results.frame(name) for results in (here, moved))
        np.testing.assert_allclose(b.u, a.u, rtol=0, atol=1e-8 * np.abs(a.u).max())
        expected = Rotation.from_rotvec(turn).apply(a.position) + there
        np.testing.assert_allclose(b.position, expected, rtol=0, atol=1e-8)
    a, b = (results.energy for results in (here, moved))
    np.testing.assert_allclose(b.kinetic, a.kinetic, rtol=1e-8)
