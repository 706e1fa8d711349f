"""The error that a superelement states, whatever its steps, band and solver, against all modes of
its mesh: at rest, in its frequencies, and in frequency responses.
"""

from itertools import pairwise, product

import numpy as np
import pytest
from duhamel.preprocess import assemble, build
from duhamel.preprocess.responses.modal import elastic_shapes
from duhamel.superelement.transfer import laplace_stiffness, receptance

ROUNDING = 1e-7
"""Of squared frequencies and compliances of the slender bodies, relative."""
STEEL = {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}
DAMPING = {"modal": 0.005}
SECOND = {
    "steel": STEEL,
    "rubber": {"E": 5e6, "nu": 0.45, "rho": 1100.0},
    "foam": {"E": 1e5, "nu": 0.3, "rho": 50.0},
}
BODIES = {
    "slender bar": ("hexahedron20", (4.0, 0.1, 0.1), (10, 1, 1)),
    "block": ("tetra10", (0.4, 0.2, 0.15), (4, 2, 2)),
    "plate": ("hexahedron20", (0.3, 0.2, 0.01), (5, 4, 1)),
    "column": ("hexahedron", (1.0, 0.1, 0.1), (24, 2, 2)),
}
IMPULSES = [
    {"step": 1e-5, "steps": 1},
    {"step": 1e-5, "steps": 1000},
    {"step": 1e-4, "steps": 5},
    {"step": 1e-6, "steps": 20, "band": 3e3},
]
CASES = (
    [
        (body, second, impulse, "factor")
        for body, second, impulse in product(BODIES, ("steel", "rubber"), IMPULSES)
    ]
    + [
        (body, second, IMPULSES[0], "iterative")
        for body, second in product(("block", "column"), ("steel", "rubber"))
    ]
    + [
        (body, "foam", impulse, "factor")
        for body, impulse in product(("block", "column"), IMPULSES[::2])
    ]
)


@pytest.mark.parametrize(("body", "second", "impulse", "solver"), CASES)
def test_no_use_errs_by_more_than_twice_what_is_stated(halves, body, second, impulse, solver):
    impulse = {"method": "krylov", "solver": solver, **impulse}
    made = halves(*BODIES[body], SECOND[second], impulse)
    element, truth = build(made), elastic_shapes(assemble(made), made.damping)[0]
    stated, modes = element.kernel.error, element.modes
    assert stated <= 1e-4

    H = truth.compliance
    at_rest = deviation(element.compliance, H, np.sqrt(np.diag(H)))
    assert at_rest <= 2.0 * stated + ROUNDING

    # The nearest frequency of the mesh to each of the superelement, in the band and beyond it.
    inside = modes.omega[modes.frequencies < element.kernel.band]
    nearest = truth.omega[np.abs(truth.omega - inside[:, None]).argmin(axis=1)]
    assert np.abs(inside / nearest - 1.0).max(initial=0.0) <= 2.0 * stated + ROUNDING

    edges = np.linspace(0.0, 2.0 * np.pi * element.kernel.band, 9)
    for low, high in pairwise(edges):
        resonant = truth.omega[(low < truth.omega) & (truth.omega < high)]
        s = 1j * np.concatenate([np.linspace(low, high, 40), resonant])
        found, expected = (receptance(m, laplace_stiffness(m, s)) for m in (modes, truth))
        scale = np.sqrt(np.abs(np.einsum("fii->fi", expected)).max(axis=0))
        assert deviation(found, expected, scale) <= 2.0 * stated + ROUNDING / DAMPING["modal"]


def deviation(found, expected, scale):
    return (np.abs(found - expected) / np.outer(scale, scale)).max()


@pytest.fixture
def halves(solid_body, box):
    """Bodies whose half at the tip is of another material."""

    def make(kind, size, divisions, second, impulse):
        mesh = box(kind, size, divisions)
        *_, (block, tags, _) = zip(
            mesh.cells,
            mesh.cell_data["gmsh:physical"],
            mesh.cell_data["gmsh:geometrical"],
            strict=True,
        )
        middle = mesh.points[block.data].mean(axis=1)[:, 0] > 0.5 * size[0]
        new = tags.max() + 1
        tags[middle] = new
        mesh.field_data["half"] = np.array([new, 3])
        materials = {"box": STEEL, "half": second}
        return solid_body(
            mesh, material=None, materials=materials, impulse=impulse, damping=DAMPING
        )

    return make
