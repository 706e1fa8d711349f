"""Damaged files: wherever bytes end or change, it is one error that names the file, or a mesh."""

from pathlib import Path

import numpy as np
import pytest
from duhamel.preprocess import MeshError
from duhamel.preprocess.mesh.reading import read_mesh

from .test_vtk import FORMATS
from .test_xdmf import tagged

DATA = Path(__file__).parent / "data"
PLACES = 60
BY_GMSH = (
    *(
        f"hexahedron20-{version}.msh"
        for version in ("2.2-text", "2.2-binary", "4.1-text", "4.1-binary")
    ),
    "wedge.inp",
    "wedge.bdf",
    "wedge.med",
)


@pytest.fixture(params=[*BY_GMSH, *FORMATS, "XDMF"])
def sample(request, tmp_path, box, save):
    """A whole file of every format."""
    if request.param in BY_GMSH:
        path = tmp_path / f"mesh{Path(request.param).suffix}"
        path.write_bytes((DATA / request.param).read_bytes())
        return path
    name, file_format, options = FORMATS.get(
        request.param, ("mesh.xdmf", "xdmf", {"data_format": "XML"})
    )
    return save(tagged(box("hexahedron20", divisions=(2, 1, 1))), name, file_format, **options)


@pytest.mark.filterwarnings("ignore::duhamel.preprocess.MeshWarning")
def test_files_that_break_off(sample):
    whole = sample.read_bytes()
    read_mesh(sample)
    for kept in np.linspace(0, len(whole) - 1, PLACES, dtype=int):
        _read_damaged(sample, whole[:kept])


@pytest.mark.filterwarnings("ignore::duhamel.preprocess.MeshWarning")
def test_bytes_that_changed_or_are_missing(sample):
    whole = sample.read_bytes()
    rng = np.random.default_rng(4)
    for _ in range(PLACES):
        place, byte = rng.integers(len(whole)), rng.integers(256, dtype=np.uint8)
        _read_damaged(sample, whole[:place] + byte.tobytes() + whole[place + 1 :])
        _read_damaged(sample, whole[:place] + whole[place + rng.integers(1, 50) :])


def test_empty_files(sample):
    sample.write_bytes(b"")
    with pytest.raises(MeshError, match=rf"{sample.name}: "):
        read_mesh(sample)


def _read_damaged(path, data):
    path.write_bytes(data)
    try:
        told = read_mesh(path).name
    except MeshError as error:
        told = str(error)
    assert path.name in told
