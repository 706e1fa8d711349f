"""MED: families of nodes and cells, and both ways in which programs number the nodes of solids."""

import h5py
import numpy as np
import pytest
from duhamel.preprocess import MeshError
from duhamel.preprocess.mesh.reading import read_mesh

from .geometry import eccentricity, places, volume

CODES = {
    "tetra": "TE4",
    "tetra10": "T10",
    "wedge": "PE6",
    "hexahedron": "HE8",
    "hexahedron20": "H20",
    "triangle": "TR3",
    "triangle6": "TR6",
    "quad": "QU4",
    "quad8": "QU8",
}
STEP = "ENS_MAA/mesh/-0000000000000000001-0000000000000000001"


@pytest.fixture
def written(tmp_path):
    """Writes a box as MED stores it: column by column, with families for its parts and for two
    overlapping groups.
    """

    def write(mesh):
        path = tmp_path / "mesh.med"
        with h5py.File(path, "w") as file:
            step = file.create_group(STEP)
            step["NOE/COO"] = mesh.points.T.ravel()
            step["NOE/COO"].attrs["NBR"] = len(mesh.points)
            ends = np.array(mesh.points[:, 0] == 0.0, dtype=int) + 2 * (mesh.points[:, 1] == 0.0)
            step["NOE/FAM"] = ends
            for number, names in ((1, ["x"]), (2, ["y"]), (3, ["x", "y"])):
                _family(file, f"NOEUD/{number}", number, names)
            for kind in dict.fromkeys(block.type for block in mesh.cells):
                blocks = [(i, block) for i, block in enumerate(mesh.cells, 1) if block.type == kind]
                cells = np.concatenate([block.data for _, block in blocks])
                step[f"MAI/{CODES[kind]}/NOD"] = cells.T.ravel() + 1
                step[f"MAI/{CODES[kind]}/NOD"].attrs["NBR"] = len(cells)
                step[f"MAI/{CODES[kind]}/FAM"] = np.concatenate(
                    [np.full(len(block.data), -i) for i, block in blocks]
                )
            for name, (number, _) in mesh.field_data.items():
                _family(file, f"ELEME/{name}", -number, [name])
        return path

    return write


def _family(file, place, number, names):
    family = file.create_group(f"FAS/mesh/{place}")
    family.attrs["NUM"] = number
    family["GRO/NOM"] = np.array(
        [list(name.ljust(80, "\0").encode()) for name in names], dtype=np.int8
    )


@pytest.mark.parametrize("kind", ["tetra", "tetra10", "wedge", "hexahedron", "hexahedron20"])
def test_nodes_that_are_not_mirrored(box, written, kind):
    """As meshio writes them; those of Gmsh, which are mirrored, are in test_gmsh_files.py."""
    mesh = read_mesh(written(box(kind, divisions=(2, 1, 1))))
    assert eccentricity(mesh) == 0.0
    assert volume(mesh, "box") == pytest.approx(1.0)
    assert np.unique(np.array(places(mesh, "tip"))[:, 0]).tolist() == [1.0]


def test_families_of_nodes(box, written):
    mesh = read_mesh(written(box("hexahedron", divisions=(2, 1, 1))))
    assert set(mesh.groups) == {"root", "tip", "box", "x", "y"}
    assert np.ptp(places(mesh, "x"), axis=0).tolist() == [0, 1, 1]
    assert np.ptp(places(mesh, "y"), axis=0).tolist() == [1, 0, 1]


def test_errors_say_what(box, written):
    path = written(box("hexahedron"))
    with h5py.File(path, "a") as file:
        file[f"{STEP}/MAI/HE8/NOD"][0] = 99
    with pytest.raises(
        MeshError, match=r"mesh\.med: cells of MED's type HE8: expected 8 numbers of nodes, 1 to 27"
    ):
        read_mesh(path)
    with h5py.File(path, "a") as file:
        file.move(f"{STEP}/MAI/HE8", f"{STEP}/MAI/OCT")
    with pytest.raises(MeshError, match=r"mesh\.med: unsupported cells of MED's type OCT"):
        read_mesh(path)
    with h5py.File(path, "a") as file:
        file[f"{STEP}/NOE/COO"].attrs["NBR"] = 26
    with pytest.raises(MeshError, match="NOE/COO: expected values for 26 entries, found 81"):
        read_mesh(path)
    for empty, message in (
        (h5py.Empty("f8"), "NOE/COO: expected values, found an empty dataset"),
        (np.zeros(0), "NOE/COO: expected 1 to 3 coordinates of a node, found 0"),
    ):
        with h5py.File(path, "a") as file:
            del file[f"{STEP}/NOE/COO"]
            file[f"{STEP}/NOE/COO"] = empty
            file[f"{STEP}/NOE/COO"].attrs["NBR"] = 27
        with pytest.raises(MeshError, match=message):
            read_mesh(path)
    with h5py.File(path, "a") as file:
        file.create_group("ENS_MAA/other")
    with pytest.raises(
        MeshError, match=r"mesh\.med: expected one mesh in the file, found mesh, other"
    ):
        read_mesh(path)
