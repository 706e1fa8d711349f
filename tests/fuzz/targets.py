"""The readers of the project, each with files to damage and the exceptions that refuse them."""

import tomllib
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from duhamel.preprocess import PreprocessError, read_body
from duhamel.preprocess.given.matrix_files import read_matrix
from duhamel.preprocess.given.node_table import read_nodes
from duhamel.preprocess.mesh.reading import read_mesh
from duhamel.results import QuantityError, Results, ResultsError
from duhamel.solver import ModelError, read_model, simulate
from duhamel.study import StudyError, read_study
from duhamel.superelement import SuperelementError, read, write
from scipy.io import mmwrite
from scipy.sparse import coo_array, save_npz

from ..bad_inputs.conftest import make_element
from ..bad_inputs.models import MECHANISM, STEADY
from ..superelement.rotations import any_rotation
from . import hdf5

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "tests/preprocess/mesh/formats/data"
STUDY = """
model = "base.toml"
parameters.bodies.hub.mass = [1, 2]
parameters.loads.0.signal = [1, {amplitude = 1, frequency = 2}]
outputs.a = "max |angle:hub:z|"
"""
SAMPLES = """
model = "base.toml"
parameters.m = {log_uniform = [1, 3]}
parameters.c = {normal = [1, 0.1]}
design = {type = "sobol", samples = 3, seed = 1}
derived.bodies.hub.mass = "2 * m ** 0.5 + bodies.hub.mass / sqrt(4)"
derived.loads.0.signal = "c * pi"
"""
TABLE = 'case,bodies.hub.mass,loads.0.signal\na,1,2\nb,"[1, 2]",3\n'
NODES = "1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n"
ABAQUS = "1,1, 1,1, 2.0\n2,1, 1,1, -1.0\n2,1, 2,1, 2.0\n"


@dataclass(frozen=True)
class Target:
    """A reader: seeds by suffix, and the exceptions that are refusals."""

    read: Callable[[Path], object]
    refusals: tuple[type[Exception], ...]
    seeds: dict[str, list[bytes]] = field(default_factory=dict)
    inside: Callable[[int, bytes], bytes] | None = None
    """damage to the contents, besides that to the bytes"""


def targets(folder: Path) -> dict[str, Target]:
    """All readers by name; files that damaged ones name lie in the folder."""
    (folder / "base.toml").write_text(MECHANISM)
    (folder / "study.toml").write_text(STUDY.replace("parameters.", "# ") + 'table = "input.csv"')
    element = make_element()
    write(folder / "beam.h5", element)
    rotation = any_rotation(0, element.modes, element.J_rot, level=2)
    write(folder / "rotating.h5", replace(element, rotation=rotation))
    simulate(read_model(folder / "base.toml"), output=folder / "results.h5")
    meshes = {
        suffix: [path.read_bytes() for path in sorted(DATA.glob(f"*{suffix}"))]
        for suffix in (".msh", ".inp", ".bdf", ".med")
    }
    bodies = [path.read_bytes() for path in sorted(ROOT.glob("meshes/*/*.toml"))]
    refusals = PreprocessError, SuperelementError
    return {
        "model": Target(read_model, (ModelError,), {".toml": _texts(MECHANISM, STEADY)}),
        "study": Target(read_study, (StudyError,), {".toml": _texts(STUDY, SAMPLES)}),
        "study table": Target(_read_table, (StudyError,), {".csv": _texts(TABLE)}),
        "body": Target(read_body, refusals, {".toml": bodies}),
        "superelement": Target(
            read,
            refusals,
            {".h5": [(folder / name).read_bytes() for name in ("beam.h5", "rotating.h5")]},
            hdf5.mutated,
        ),
        "results": Target(
            _read_results,
            (ResultsError, QuantityError),
            {".h5": [(folder / "results.h5").read_bytes()]},
            hdf5.mutated,
        ),
        "mesh": Target(read_mesh, refusals, meshes | _meshes_by_meshio(folder)),
        "matrix": Target(lambda path: read_matrix(path, "KGG"), refusals, _matrices(folder)),
        "nodes": Target(read_nodes, refusals, {".csv": _texts(NODES)} | _npz_of_nodes(folder)),
    }


def attempt(target: Target, path: Path) -> str:
    """ "read", "refused", or what is wrong with the answer."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            target.read(path)
    except target.refusals as error:
        text = str(error)
        if len(text.splitlines()) != 1:
            return f"several lines: {text[:200]!r}"
        return "refused" if path.name in text else f"without the file: {text[:200]}"
    except Exception as error:
        return f"{type(error).__name__}: {str(error)[:200]}"
    return "read"


def _texts(*texts: str) -> list[bytes]:
    for text in texts:
        if text.lstrip().startswith("["):
            tomllib.loads(text)
    return [text.encode() for text in texts]


def _read_table(path: Path) -> object:
    return read_study(path.with_name("study.toml"))


def _read_results(path: Path) -> object:
    results = Results.read(path)
    for body in results.bodies:
        results.body(body)
    for joint in results.joints:
        results.joint(joint)
    return results.time, results.energy, results.solver, results.model


def _meshes_by_meshio(folder: Path) -> dict[str, list[bytes]]:
    """A tetrahedron in formats that meshio writes, numbers within the file."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    mesh = meshio.Mesh(
        points, [("tetra", np.array([[0, 1, 2, 3]]))], cell_data={"part": [np.array([7])]}
    )
    options: dict[str, list[dict[str, Any]]] = {
        ".vtk": [{"binary": False}, {"binary": True}],
        ".vtu": [{"binary": False}, {"binary": True}],
        ".xdmf": [{"data_format": "XML"}],
    }
    found: dict[str, list[bytes]] = {}
    for suffix, several in options.items():
        for options_of_one in several:
            path = folder / f"made{suffix}"
            mesh.write(path, **options_of_one)
            found.setdefault(suffix, []).append(path.read_bytes())
    return found


def _matrices(folder: Path) -> dict[str, list[bytes]]:
    matrix = coo_array(np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]]))
    mmwrite(folder / "made.mtx", matrix)
    save_npz(folder / "made.npz", matrix)
    market = (folder / "made.mtx").read_bytes()
    return {".mtx": [market, ABAQUS.encode()], ".npz": [(folder / "made.npz").read_bytes()]}


def _npz_of_nodes(folder: Path) -> dict[str, list[bytes]]:
    np.savez(folder / "nodes.npz", points=np.eye(3), labels=np.array([1, 2, 3]))
    return {".npz": [(folder / "nodes.npz").read_bytes()]}
