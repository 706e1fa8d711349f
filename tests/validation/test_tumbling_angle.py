"""A soft angle of hexahedra, thrown: it tumbles and bends by its rotation, as its nonlinear mesh.

Two arms of a meter, of 0.2 m x 0.1 m. The nodes at their ends are followed for 2 s, with steps of
which both make the same use. The error of a body is of third order in its elastic motion: it falls
by eight and more with half the spin, and level 2, with the strain energy to fourth order, takes
most of what is left.
"""

import numpy as np
import pytest
from duhamel.preprocess import Body, build
from duhamel.solver import FlexibleBody, Model, Settings, Start, simulate

from ..preprocess.blocks import named, solid_cells
from .nonlinear_solid import SolidBox

pytestmark = pytest.mark.validation

SIZE, DIVISIONS = np.array([1.0, 0.1, 1.0]), (5, 1, 5)
MATERIAL = {"E": 4e3, "nu": 0.3, "rho": 1.0}
ENDS = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""of the two arms, from the corner of the box"""
SPIN, STEP, STEPS = np.array([1.5, -2.2, 1.8]), 5e-3, 400


def in_angle(centers):
    return (centers[:, 0] < 0.2) | (centers[:, 2] < 0.2)


def superelement(folder, level):
    """Of first order where the level is 0."""
    grid, cells = solid_cells("hexahedron27", DIVISIONS)
    points = grid / (2.0 * np.array(DIVISIONS)) * SIZE
    cells = cells[in_angle(points[cells].mean(axis=1))]
    used, numbers = np.unique(cells, return_inverse=True)
    mesh = named(points[used], [("angle", "hexahedron27", numbers.reshape(cells.shape))])
    path = folder / f"angle{level}.msh"
    mesh.write(path, file_format="gmsh22", binary=False)
    body = {
        "name": "angle",
        "mesh": path,
        "material": MATERIAL,
        "interfaces": {f"end{i}": {"node": x.tolist()} for i, x in enumerate(ENDS)},
        "impulse": {"step": STEP, "steps": 1, "method": "modal"},
        "rotation": {"modes": 8, "soft": 0, "level": level} if level else None,
    }
    return build(Body.model_validate(body))


def thrown(element, spin):
    """The ends from the center of mass (n_t, 2, 3), and the largest displacement [m]."""
    settings = Settings(t_end=STEPS * STEP, step=STEP, rho_inf=0.9)
    body = FlexibleBody(element, Start(angular_velocity=spin))
    results = simulate(Model({"angle": body}, settings=settings))
    frames = [results.frame(f"angle.end{i}") for i in range(len(ENDS))]
    return np.stack([f.position for f in frames], axis=1), max(np.abs(f.u).max() for f in frames)


def test_it_tumbles_as_its_nonlinear_mesh(tmp_path):
    mesh = SolidBox(tuple(SIZE), DIVISIONS, **MATERIAL, keeps=in_angle)
    elements = [superelement(tmp_path, level) for level in (0, 1, 2)]
    errors = np.zeros((3, 2))
    for k, spin in enumerate((SPIN, 0.5 * SPIN)):
        exact = mesh.thrown(spin, STEP, STEPS, ENDS - [0.0, 0.05, 0.5])
        for level, element in enumerate(elements):
            found, u = thrown(element, spin)
            apart = found - exact
            errors[level, k] = np.linalg.norm(apart - apart[0], axis=2).max()
        print(f"spin {np.linalg.norm(spin):.2f} rad/s, largest displacement {u:.4f} m")
    print(f"distances of ends from the mesh by level: {errors.tolist()}")
    assert errors[1, 0] < 0.1 * errors[0, 0]
    assert errors[2, 0] < 0.2 * errors[1, 0]
    assert errors[1, 1] < errors[1, 0] / 8.0
