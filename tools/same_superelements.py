"""Whether a change of the preprocessor leaves superelements as they were, byte for byte.

    python tools/same_superelements.py make FOLDER      # the superelements that this tree makes
    python tools/same_superelements.py compare ONE TWO  # every dataset and attribute of both

Bodies are those of meshes/, which notebooks and examples use, and of the starters of `duhamel
init`; of some of them every method and solver, and one mesh in every format that is read. Of the
files that the tests of formats read, the digest of the mesh and its warnings are kept. Times of
stages, which no two builds share, are left out.
"""

import argparse
import os
import sys
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import meshio
import numpy as np
from duhamel import preprocess, superelement
from duhamel.preprocess.body.body import Body, Impulse, NonlinearCoordinates, RecoveredFields
from duhamel.preprocess.mesh.mesh import Mesh
from duhamel.preprocess.mesh.reading import read_mesh

ROOT = Path(__file__).resolve().parents[1]
SLOW_BODIES = ("fine",)  # whose mesh an example makes
FIXTURES = ROOT / "tests/preprocess/mesh/formats/data"
FORMATS = {
    ".inp": ("abaqus", {"float_fmt": ".16e"}),
    ".med": ("med", {}),
    ".xdmf": ("xdmf", {"data_format": "XML"}),
    ".vtu": ("vtu", {}),
    ".vtk": ("vtk", {}),
    ".msh": ("gmsh22", {}),
}
METHODS: dict[str, dict[str, Any]] = {
    "modal": {"method": "modal"},
    "factor": {"method": "krylov", "solver": "factor"},
    "iterative": {"method": "krylov", "solver": "iterative"},
    "craig-bampton": {"method": "craig-bampton", "modes": 5},
    "rubin": {"method": "rubin", "modes": 5},
    "march": {"method": "march"},
}


def bodies(folder: Path) -> Iterator[tuple[str, Body]]:
    """The bodies by name; files of other formats are written into the folder."""
    # Files keep the paths of meshes, which are to be the same in all trees and folders.
    os.chdir(ROOT)
    for path in sorted((*Path("meshes").glob("*/*.toml"), *Path("cli").glob("starters/*/*.toml"))):
        if path.stem not in (*SLOW_BODIES, "model"):
            yield f"{path.parent.name}-{path.stem}", preprocess.read_body(path)
    for name in ("beam", "solid"):
        body = preprocess.read_body(f"meshes/beam/{name}.toml")
        for method, changes in METHODS.items():
            impulse = Impulse(step=body.impulse.step, steps=50, **changes)
            yield f"{name}-{method}", body.model_copy(update={"impulse": impulse})
        nonlinear = {"rotation": NonlinearCoordinates(), "recovery": RecoveredFields()}
        yield f"{name}-rotation", body.model_copy(update=nonlinear)
    body = preprocess.read_body("meshes/beam/solid.toml")
    mesh = read_mesh(body.mesh)
    os.chdir(folder)
    yield from in_formats(body, mesh)


def in_formats(body: Body, mesh: Mesh) -> Iterator[tuple[str, Body]]:
    """A body of solids from its mesh in every format, held at the planes of its ends."""
    low, high = (float(end(mesh.points[:, 0])) for end in (np.min, np.max))
    ends = {
        name: {"plane": {"point": (x, 0.0, 0.0), "normal": (1.0, 0.0, 0.0)}}
        for name, x in (("root", low), ("tip", high))
    }
    solids = meshio.Mesh(mesh.points, list(mesh.elements.items()))
    for suffix, (form, more) in FORMATS.items():
        path = Path(f"part{suffix}")
        meshio.write(path, solids, form, **more)
        table = body.model_dump(exclude_unset=True) | {"mesh": path, "interfaces": ends}
        table["impulse"] = {"step": body.impulse.step, "steps": 50}
        yield f"format{suffix.replace('.', '-')}", Body.model_validate(table)


def make(folder: Path) -> None:
    folder = folder.resolve()
    folder.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as meshes, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name, body in bodies(Path(meshes)):
            print(name, flush=True)
            try:
                superelement.write(preprocess.build(body), folder / f"{name}.h5")
            except preprocess.PreprocessError as error:
                text = str(error).replace(meshes, "").replace(str(ROOT), "")
                (folder / f"{name}.txt").write_text(text)
    lines = [fixture(path) for path in sorted(FIXTURES.iterdir()) if path.is_file()]
    (folder / "fixtures.txt").write_text("\n".join(lines))


def fixture(path: Path) -> str:
    """The digest of a mesh and what its reader says of it."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            mesh = read_mesh(path)
            labels = None if mesh.labels is None else mesh.labels.tolist()
            found = f"{mesh.sha256} {labels}"
        except preprocess.MeshError as error:
            found = str(error)
    return " ".join([path.name, found, *(str(warning.message) for warning in told)]).replace(
        str(ROOT), ""
    )


def contents(path: Path) -> dict[str, bytes]:
    """Bytes of every dataset and attribute of a file, or of a text, by name."""
    if path.suffix == ".txt":
        return {"text": path.read_bytes()}
    found: dict[str, bytes] = {}

    def add(name: str, item: h5py.Group | h5py.Dataset) -> None:
        if name == "provenance/timings":
            return
        for key, value in item.attrs.items():
            found[f"{name}@{key}"] = np.asarray(value).dtype.str.encode() + _bytes(value)
        if isinstance(item, h5py.Dataset):
            values = item[()]
            described = f"{item.dtype.str} {item.shape} {item.chunks} {item.compression}"
            found[name] = described.encode() + _bytes(values)

    with h5py.File(path) as file:
        add("", file)
        file.visititems(add)
    return found


def _bytes(value: Any) -> bytes:
    array = np.asarray(value)
    return repr(array.tolist()).encode() if array.dtype.hasobject else array.tobytes()


def compare(one: Path, two: Path) -> int:
    names = sorted({path.name for folder in (one, two) for path in folder.iterdir()})
    different = total = 0
    for name in names:
        if not ((one / name).exists() and (two / name).exists()):
            print(f"{name}: in one folder alone")
            different += 1
            continue
        first, second = contents(one / name), contents(two / name)
        total += len(first)
        for key in sorted(first.keys() | second.keys()):
            if first.get(key) != second.get(key):
                print(f"{name}: {key or 'attributes'} differs")
                different += 1
    print(f"{len(names)} files, {total} datasets and attributes, {different} different")
    return 1 if different else 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("make").add_argument("folder", type=Path)
    comparing = commands.add_parser("compare")
    comparing.add_argument("one", type=Path)
    comparing.add_argument("two", type=Path)
    given = parser.parse_args()
    if given.command == "make":
        make(given.folder)
        return 0
    return compare(given.one, given.two)


if __name__ == "__main__":
    sys.exit(main())
