"""Bad meshes, matrices and body files: `duhamel preprocess` says one line, and leaves nothing."""

import importlib
import os
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp
from duhamel.cli import app
from typer.testing import CliRunner

SECTION = """
[section]
EA = 2e7
EI_y = 5.5
EI_z = 5.5
GJ = 4.0
mass_per_length = 0.08
polar_inertia_per_length = 4.4e-8
"""
BODY = """
name = "rod"
{source}
{make}
[interfaces.root]
node = [0, 0, 0]
[impulse]
step = 1e-4
steps = 20
"""
MATRICES = '[matrices]\nstiffness = "K.{kind}"\nmass = "M.npz"\nnodes = "nodes.csv"\n'
ON_MESH = BODY.format(source='mesh = "mesh.vtk"', make=SECTION)
K = sp.csr_array(np.eye(12) * 1e6)


def rod() -> meshio.Mesh:
    points = np.column_stack([np.linspace(0, 0.5, 5), np.zeros(5), np.zeros(5)])
    return meshio.Mesh(points, [("line", np.column_stack([np.arange(4), np.arange(1, 5)]))])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    meshio.write(tmp_path / "mesh.vtk", rod())
    sp.save_npz(tmp_path / "M.npz", K)
    (tmp_path / "nodes.csv").write_text("1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n")
    return tmp_path


def refused(folder: Path, body: str, *names: str) -> None:
    """One line that names the body file or the file at fault, and one of some keys; no output."""
    path = folder / "body.toml"
    path.write_text(body)
    before = sorted(os.listdir(folder))
    result = CliRunner().invoke(app, ["preprocess", str(path)])
    assert result.exit_code == 1, (result.output, result.exception)
    lines = [line for line in result.stderr.splitlines() if line.strip()]
    (message,) = (line for line in lines if not line.startswith("warning: "))
    assert message.startswith(f"error: {folder}")
    assert len(message) < 2000
    for name in names:
        assert name in message, message
    assert sorted(os.listdir(folder)) == before


# Body files


@pytest.mark.parametrize(
    ("old", "new", "names"),
    [
        ('"rod"', '"a\\u0000b"', ("body.toml: name: expected 1 to 100 characters",)),
        ('"rod"', f'"{"n" * 300}"', ("body.toml: name: expected 1 to 100 characters",)),
        ('"rod"', '"a\\nb"', ("body.toml: name: expected",)),
        ("interfaces.root", 'interfaces."a/b"', ("body.toml: interfaces: expected a name",)),
        ("interfaces.root", 'interfaces.".."', ("body.toml: interfaces: expected a name",)),
        ("interfaces.root", 'interfaces."a\\u0000"', ("body.toml: interfaces: expected a name",)),
        ("interfaces.root", f"interfaces.{'i' * 300}", ("body.toml: interfaces: expected a name",)),
        ("steps = 20", "steps = 1_000_000_000", ("body.toml: impulse.steps = 1000000000",)),
        ("steps = 20", "steps = 1e12", ("body.toml: impulse.steps", "found 1000000000000")),
        ("steps = 20", "steps = 1_000_000_000_000", ("impulse.steps = 1000000000000", "GB")),
        ("steps = 20", f"steps = {'9' * 5000}", ("body.toml", "integer")),
        ("steps = 20", f"steps = {'[' * 5000}{']' * 5000}", ("body.toml", "one another")),
        ("EA = 2e7", "EA = 1e308", ("body.toml", "mesh.vtk: expected a stiffness up to 1e+100")),
        ("EA = 2e7", "EA = inf", ("body.toml: section.EA",)),
        ("mass_per_length = 0.08", "mass_per_length = 1e308", ("mesh.vtk: expected a mass up",)),
        (
            "polar_inertia_per_length = 4.4e-8",
            "polar_inertia_per_length = 1.0",
            ("body.toml", "expected principal inertias of which two are no less than the third"),
        ),
        ("EI_y = 5.5", "EI_y = 1e-99", ("body.toml",)),
        ('"mesh.vtk"', '"a\\u0000.vtk"', ("",)),
        ('"mesh.vtk"', f'"{"m" * 300}.vtk"', ("",)),
        ('"mesh.vtk"', '"."', ("expected a regular file, found a folder",)),
        ("step = 1e-4", "step = 1e-300", ("body.toml: impulse: step: expected 1e-30 to 1e+06 s",)),
        ("step = 1e-4", "step = 1e-4\nband = 1e-300", ("body.toml: impulse: band: expected at",)),
    ],
)
def test_a_bad_body_file_is_one_line_that_names_the_key(
    old: str, new: str, names: tuple[str, ...], folder: Path
) -> None:
    assert old in ON_MESH
    refused(folder, ON_MESH.replace(old, new), *names)


@pytest.mark.parametrize(
    ("entries", "names"),
    [
        ("modes = 0", ("rotation.modes: ", "found 0")),
        ("modes = 33", ("rotation.modes: ", "found 33")),
        ("modes = 2.5", ("rotation.modes: ", "found 2.5")),
        ('soft = "most"', ('rotation.soft: expected "auto" or a number from 0 to 32, found',)),
        ("soft = -1", ("rotation.soft: expected", "found -1")),
        ("level = 3", ("rotation.level: expected 1 or 2, found 3",)),
        ("level = 2", ("rotation.level: expected 1 of lines, found 2, which is for solids",)),
        ('loaded = ["rot"]', ("rotation.loaded: no interface 'rot'; there are: root",)),
        ('loaded = "root"', ("rotation.loaded: expected a list of interfaces, found 'root'",)),
        ("loaded = [1]", ("rotation.loaded: expected a list of interfaces, found [1]",)),
        ("mode = 4", ("rotation: unknown key 'mode'; did you mean 'modes'?",)),
        ('[impulse]\nmethod = "march"', ("rotation: needs modes, which impulse.method march",)),
    ],
)
def test_a_bad_rotation_is_one_line_that_names_the_key(
    entries: str, names: tuple[str, ...], folder: Path
) -> None:
    head, _, impulse = entries.partition("[impulse]")
    body = ON_MESH.replace("[impulse]", f"[impulse]{impulse}")
    refused(folder, f"{body}\n[rotation]\n{head}\n", "body.toml: ", *names)


def test_matrices_have_no_energy_of_the_fourth_order(folder: Path) -> None:
    body = BODY.format(source=MATRICES.format(kind="npz"), make="") + "[rotation]\nlevel = 2\n"
    refused(folder, body, "body.toml: rotation.level: expected 1 of [matrices], found 2")


def test_memory_that_runs_out_on_the_way_is_one_line(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def exhausted(*_: object) -> None:
        raise MemoryError("Unable to allocate 9. GiB")

    build = importlib.import_module("duhamel.preprocess.build")
    monkeypatch.setattr(build, "impulse_responses", exhausted)
    refused(folder, ON_MESH, "body.toml: out of memory: Unable to allocate 9. GiB; fewer")


def test_a_build_that_a_limit_of_memory_ends_is_one_line(folder: Path) -> None:
    """`ulimit -v`, of a process of its own."""
    path = folder / "body.toml"
    path.write_text(ON_MESH.replace("steps = 20", "steps = 2_000_000"))
    program = (
        "import resource, sys\n"
        "from duhamel.cli import app\n"
        "resource.setrlimit(resource.RLIMIT_AS, (1_500_000 << 10, 1_500_000 << 10))\n"
        "app()\n"
    )
    words = [sys.executable, "-c", program, "preprocess", str(path)]
    result = subprocess.run(words, capture_output=True, text=True, check=False)
    assert result.returncode == 1
    (message,) = (line for line in result.stderr.splitlines() if line.strip())
    assert message.startswith(f"error: {path}: ")
    assert "memory" in message
    assert sorted(folder.glob("*.h5")) == []


# Meshes


def pipe(path: Path) -> None:
    os.mkfifo(path)


def nested_grids(path: Path) -> None:
    deep = 20_000
    inner = '<Grid GridType="Collection">' * deep + "</Grid>" * deep
    path.write_text(f"<Xdmf><Domain>{inner}</Domain></Xdmf>")


def xdmf_of_a_device(path: Path) -> None:
    item = '<DataItem Format="Binary" Dimensions="4 3">/dev/zero</DataItem>'
    grid = f'<Grid><Geometry GeometryType="XYZ">{item}</Geometry></Grid>'
    path.write_text(f"<Xdmf><Domain>{grid}</Domain></Xdmf>")


def xdmf_of_a_link(path: Path) -> None:
    with h5py.File(path.with_name("numbers.h5"), "w") as file:
        file["x"] = h5py.ExternalLink("elsewhere.h5", "/x")
    item = '<DataItem Format="HDF" Dimensions="4 3">numbers.h5:/x</DataItem>'
    grid = f'<Grid><Geometry GeometryType="XYZ">{item}</Geometry></Grid>'
    path.write_text(f"<Xdmf><Domain>{grid}</Domain></Xdmf>")


def include_bomb(path: Path) -> None:
    """2^30 times the last file."""
    path.write_text("*INCLUDE, INPUT=0.inc\n")
    for level in range(30):
        path.with_name(f"{level}.inc").write_text(f"*INCLUDE, INPUT={level + 1}.inc\n" * 2)
    path.with_name("30.inc").write_text("*NODE\n1, 0, 0, 0\n")


def wide_includes(path: Path) -> None:
    path.write_text("INCLUDE 'other.bdf'\n" * 2000)
    path.with_name("other.bdf").write_text("GRID,1,,0.,0.,0.\n")


def damaged_med(change: Callable[[h5py.File], None]) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        meshio.write(path, rod())
        with h5py.File(path, "r+") as file:
            change(file["ENS_MAA/mesh/-0000000000000000001-0000000000000000001"])

    return make


def many_zeros(step: h5py.Group) -> None:
    del step["NOE/COO"]
    coordinates = step["NOE"].create_dataset("COO", (300_000_000,), "f8", chunks=(1000,))
    coordinates.attrs["NBR"] = 100_000_000


def no_numbers(step: h5py.Group) -> None:
    attributes = dict(step["NOE/COO"].attrs)
    del step["NOE/COO"]
    step["NOE/COO"] = np.array([b"x"] * 15)
    step["NOE/COO"].attrs.update(attributes)


def huge_count(step: h5py.Group) -> None:
    step["NOE/COO"].attrs["NBR"] = 1e300


def nodes_that_are_no_numbers(step: h5py.Group) -> None:
    attributes = dict(step["MAI/SE2/NOD"].attrs)
    del step["MAI/SE2/NOD"]
    step["MAI/SE2/NOD"] = np.full(8, np.nan)
    step["MAI/SE2/NOD"].attrs.update(attributes)


def too_large_nodes(step: h5py.Group) -> None:
    step["MAI/SE2/NOD"][0] = 2**62


MESHES = {
    "pipe": ("mesh.msh", pipe),
    "nested grids": ("mesh.xdmf", nested_grids),
    "xdmf of a device": ("mesh.xdmf", xdmf_of_a_device),
    "xdmf of a link": ("mesh.xdmf", xdmf_of_a_link),
    "include bomb": ("mesh.inp", include_bomb),
    "wide includes": ("mesh.bdf", wide_includes),
    "med zeros": ("mesh.med", damaged_med(many_zeros)),
    "med text": ("mesh.med", damaged_med(no_numbers)),
    "med count": ("mesh.med", damaged_med(huge_count)),
    "med nodes": ("mesh.med", damaged_med(nodes_that_are_no_numbers)),
    "med large nodes": ("mesh.med", damaged_med(too_large_nodes)),
}


@pytest.mark.parametrize(("name", "make"), MESHES.values(), ids=MESHES)
def test_a_bad_mesh_is_one_line_that_names_it(
    name: str, make: Callable[[Path], None], folder: Path
) -> None:
    make(folder / name)
    refused(folder, BODY.format(source=f'mesh = "{name}"', make=SECTION), name)


# Matrices


def flipped(place: int) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        sp.save_npz(path, K)
        data = bytearray(path.read_bytes())
        data[place % len(data)] ^= 0x55
        path.write_bytes(data)

    return make


def text(content: bytes) -> Callable[[Path], None]:
    return lambda path: path.write_bytes(content)


def nul_in_market(path: Path) -> None:
    scipy.io.mmwrite(path, K)
    data = path.read_bytes()
    path.write_bytes(data[:120] + b"\0" + data[121:])


def huge_arrays(path: Path) -> None:
    """Declared alone: the archive has a header for 8 TB."""
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }"
    header = header.ljust(117) + b"\n"
    with zipfile.ZipFile(path, "w") as file:
        for name in ("data", "indices", "indptr", "shape", "format"):
            file.writestr(f"{name}.npy", b"\x93NUMPY\x01\x00\x76\x00" + header)


MARKET = b"%%MatrixMarket matrix coordinate real general\n"
MATRIX_FILES = {
    **{f"flipped {place}": ("npz", flipped(place)) for place in (0, 8, 30, 60, 200, -20, -3)},
    "huge arrays": ("npz", huge_arrays),
    "no archive": ("npz", text(b"text")),
    "pipe": ("npz", pipe),
    "NUL": ("mtx", nul_in_market),
    "NUL of Abaqus": ("mtx", text(b"1,1,1,1,2.0\n\0")),
    "not UTF-8": ("mtx", text(b"1,1,1,1,2.0\n\xff\xfe\n")),
    "huge market": ("mtx", text(MARKET + b"1000000000000 1000000000000 1\n1 1 1.0\n")),
    "promised entries": ("mtx", text(MARKET + b"12 12 1000000000000\n1 1 1.0\n")),
    "empty": ("mtx", text(b"")),
    "large labels": ("mtx", text(b"1e18,1,1,1,2.0\n")),
    "no labels": ("mtx", text(b"nan,1,1,1,2.0\n")),
    "op4": ("op4", text(bytes(range(256)))),
    "op4 negative record": ("op4", text(b"\xf8\xff\xff\xff" * 40)),
}


@pytest.mark.parametrize(("kind", "make"), MATRIX_FILES.values(), ids=MATRIX_FILES)
def test_a_bad_matrix_is_one_line_that_names_it(
    kind: str, make: Callable[[Path], None], folder: Path
) -> None:
    make(folder / f"K.{kind}")
    refused(folder, BODY.format(source=MATRICES.format(kind=kind), make=""), str(folder))


@pytest.mark.parametrize(
    "content",
    [b"1, 0, 0\n", b"\xff\xfe", b"1, 0, 0, 0\n\0", b"1e300, 0, 0, 0\n", b"nan, 0, 0, 0\n", b""],
)
def test_a_bad_table_of_nodes_is_one_line_that_names_it(content: bytes, folder: Path) -> None:
    sp.save_npz(folder / "K.npz", K)
    (folder / "nodes.csv").write_bytes(content)
    refused(folder, BODY.format(source=MATRICES.format(kind="npz"), make=""), "nodes.csv")


def test_a_body_that_is_rigid_as_a_whole_is_refused(folder: Path) -> None:
    points = np.array([[x, y, z] for z in (0, 1.0) for y in (0, 1.0) for x in (0, 1.0)])
    cube = meshio.Mesh(points, [("hexahedron", np.array([[0, 1, 3, 2, 4, 5, 7, 6]]))])
    cube.write(folder / "cube.vtk")
    make = "[material]\nE = 2e11\nnu = 0.3\nrho = 7800.0\n"
    body = BODY.format(source='mesh = "cube.vtk"', make=make).replace(
        "node = [0, 0, 0]", 'kind = "rigid"\nbox = {corners = [[0, 0, 0], [1, 1, 1]]}'
    )
    refused(folder, body, "body.toml: cube.vtk: expected nodes that can move against each other")
