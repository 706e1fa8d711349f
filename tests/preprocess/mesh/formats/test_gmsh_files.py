"""Files that Gmsh wrote: two unit cubes along x of every element, with groups of all dimensions
(data/make_data.py).
"""

from pathlib import Path

import numpy as np
import pytest
from duhamel.preprocess.mesh.reading import read_mesh

from .geometry import eccentricity, places, volume

DATA = Path(__file__).parent / "data"
FACETS = {
    "tetra": 2,
    "tetra10": 2,
    "wedge": 2,
    "hexahedron": 1,
    "hexahedron20": 1,
    "hexahedron27": 1,
}
# Gmsh writes its coordinates with 16 digits, or the 7 that fit into a short field of Nastran.
PRECISE = 1e-11


@pytest.mark.parametrize("version", ["2.2-text", "2.2-binary", "4.1-text", "4.1-binary"])
def test_msh(kind, version):
    """A group without a name, elements in two groups, one name in two dimensions: all of it is
    kept.
    """
    mesh = read_mesh(DATA / f"{kind}-{version}.msh")
    assert set(mesh.groups) == {
        "left",
        "right",
        "all of it",
        "root",
        "tip",
        "physical surface 7",
        "corner",
    }
    assert mesh.body_types == (kind,)
    assert eccentricity(mesh) < PRECISE
    assert volume(mesh) == pytest.approx(2.0, rel=1e-10)
    for group, expected in (("left", 1.0), ("right", 1.0), ("all of it", 2.0)):
        assert volume(mesh, group) == pytest.approx(expected, rel=1e-10)
    np.testing.assert_allclose(places(mesh, "corner"), [[0, 0, 0]])
    _check_ends(mesh, kind, "root", "tip", "physical surface 7")
    assert len(mesh.group("root").cells["vertex"]) == 1


def test_abaqus(kind):
    mesh = read_mesh(DATA / f"{kind}.inp")
    own = {"Surface1", "Surface48", "Volume1", "Volume2"}  # Gmsh's entities
    assert set(mesh.groups) == own | {
        "left",
        "right",
        "all_of_it",
        "root",
        "tip",
        "PhysicalSurface7",
        "corner",
    }
    assert mesh.body_types == (kind,)
    assert eccentricity(mesh) < PRECISE
    for group, expected in (("left", 1.0), ("right", 1.0), ("all_of_it", 2.0)):
        assert volume(mesh, group) == pytest.approx(expected, rel=1e-10)
    assert mesh.points[mesh.group("corner").points].tolist() == [[0, 0, 0]]
    _check_ends(mesh, kind, "root", "tip", "PhysicalSurface7")


@pytest.mark.parametrize("kind", [kind for kind in FACETS if kind != "hexahedron27"])
def test_nastran(kind):
    """Gmsh makes its entities properties; those of volume and surface 1 are one."""
    mesh = read_mesh(DATA / f"{kind}.bdf")
    assert mesh.body_types == (kind,)
    assert eccentricity(mesh) < 1e-6
    assert volume(mesh, "property 1") == pytest.approx(1.0, rel=1e-6)
    assert volume(mesh, "property 2") == pytest.approx(1.0, rel=1e-6)
    assert sum(map(len, mesh.group("property 48").cells.values())) == FACETS[kind]
    assert np.ptp(places(mesh, "property 48"), axis=0).tolist() == [0, 1, 1]


@pytest.mark.parametrize("kind", ["tetra10", "wedge", "hexahedron27"])
def test_med(kind):
    mesh = read_mesh(DATA / f"{kind}.med")
    assert set(mesh.groups) == {"left", "right", "all of it", "root", "tip", "G_2D_7", "corner"}
    assert mesh.body_types == (kind,)
    assert eccentricity(mesh) < PRECISE
    for group, expected in (("left", 1.0), ("right", 1.0), ("all of it", 2.0)):
        assert volume(mesh, group) == pytest.approx(expected, rel=1e-10)
    np.testing.assert_allclose(places(mesh, "corner"), [[0, 0, 0]])
    _check_ends(mesh, kind, "root", "tip", "G_2D_7")


def _check_ends(mesh, kind, root, tip, both):
    """Facets at x = 0, x = 2 and both."""
    for group, expected in ((root, [0.0]), (tip, [2.0]), (both, [0.0, 2.0])):
        cells = {name: rows for name, rows in mesh.group(group).cells.items() if name != "vertex"}
        assert sum(map(len, cells.values())) == FACETS[kind] * len(expected)
        x = [mesh.points[mesh.cells[name][rows]][..., 0] for name, rows in cells.items()]
        np.testing.assert_allclose(np.unique(np.concatenate(x).round(9)), expected)
