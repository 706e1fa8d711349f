"""CAD files: what their solids have, and meshes of them, by gmsh in a process of its own."""

import json
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ..files import FileError, require_regular
from ..files.cad_suffixes import CAD_SUFFIXES, UNITS_KNOWN
from .errors import CadError
from .feature import Feature
from .picking import Pick
from .quality import Quality
from .solid import Solid

UNIT_READ = 1e-3
"""The unit to which what STEP and IGES say of theirs is turned [m]."""


@dataclass(frozen=True)
class CadGeometry:
    """What a mesh was made of, a solid with its features, by which gmsh, and how well.

    volume [m^3]: of the solid, as the CAD file has it; groups: the feature that each group of
    facets in the mesh is, by the name of the group.
    """

    solid: str
    volume: float
    features: tuple[Feature, ...]
    groups: Mapping[str, Feature]
    quality: Quality
    gmsh: str


def is_cad(path: Path) -> bool:
    """Whether a file is one of CAD, by its suffix."""
    return path.suffix.lower() in CAD_SUFFIXES


def knows_unit(path: Path) -> bool:
    """Whether a CAD file says its unit of length; those of Open CASCADE's own format do not."""
    return path.suffix.lower() in UNITS_KNOWN


def solids_in(path: Path, unit: float | None = None) -> dict[str, Solid]:
    """The solids of a file by their names, in meters.

    unit [m]: of a file that does not say it. `CadError` names the file.
    """
    answer = _asked(path, {"unit": _unit(path, unit), "mesh": None})
    return {
        name: Solid(
            solid["volume"], tuple(solid["center"]), tuple(map(Feature.of, solid["features"]))
        )
        for name, solid in answer["solids"].items()
    }


def mesh_solid(
    path: Path,
    target: Path,
    size: float,
    picks: Sequence[Pick] = (),
    *,
    solid: str | None = None,
    unit: float | None = None,
) -> tuple[CadGeometry, float]:
    """Mesh a solid with tetrahedra of ten nodes into a file of gmsh; what it is, and its unit [m].

    size [m]: of elements; picks: groups of facets, and sizes elsewhere; solid: the name of one of
    several; unit [m]: of a file that does not say it. The same file, sizes and version of gmsh make
    the same mesh. `CadError` names the file, and the pick.
    """
    in_file = _unit(path, unit)
    # The file is in the unit that gmsh works in; what is asked and answered is in meters.
    asked = {"unit": in_file, "mesh": str(target), "size": size, "solid": solid}
    answer = _asked(path, {**asked, "picks": [asdict(pick) for pick in picks]})
    features = tuple(map(Feature.of, answer["features"]))
    groups = {group: features[number - 1] for group, number in answer["groups"].items()}
    quality = Quality(**answer["quality"])
    made = CadGeometry(
        solid=answer["solid"],
        volume=answer["volume"],
        features=features,
        groups=groups,
        quality=quality,
        gmsh=answer["gmsh"],
    )
    return made, in_file


def _unit(path: Path, unit: float | None) -> float:
    if knows_unit(path):
        return UNIT_READ
    if unit is None:
        raise CadError(
            f"{path}: expected scale, its unit of length [m], which {path.suffix} files do not say"
        )
    return unit


def _asked(path: Path, asked: dict[str, Any]) -> dict[str, Any]:
    """The answer of a process with gmsh to what is asked of a file."""
    if find_spec("gmsh") is None:
        raise CadError(f"{path}: CAD files need gmsh: pip install 'duhamel[cad]'")
    try:
        require_regular(path)
    except FileNotFoundError as error:
        raise CadError(f"{path}: no such CAD file") from error
    except FileError as error:
        raise CadError(f"{path}: {error}") from error
    with tempfile.TemporaryDirectory() as folder:
        request, reply = Path(folder, "request.json"), Path(folder, "reply.json")
        request.write_text(json.dumps({**asked, "path": str(path.resolve())}), encoding="utf-8")
        # -P: without it Python imports first what lies in the folder that the user is in.
        command = [sys.executable, "-P", "-m", f"{__package__}.worker", str(request), str(reply)]
        ended = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace"
        )
        if ended.returncode or not reply.is_file():
            raise CadError(f"{path}: {_crash(ended)}")
        answer: dict[str, Any] = json.loads(reply.read_text(encoding="utf-8"))
    if "error" in answer:
        raise CadError(f"{path}: {answer['error']}")
    return answer


def _crash(ended: subprocess.CompletedProcess[str]) -> str:
    """Why the process with gmsh did not answer, from its last line or the signal that ended it."""
    if ended.returncode < 0:
        name = signal.Signals(-ended.returncode).name
        return f"gmsh crashed on it ({name}): damaged, or more than the memory holds"
    last = (ended.stderr.strip().splitlines() or [f"exit code {ended.returncode}"])[-1]
    # The wheel of gmsh wants libraries of the screen, even where there is none.
    lacks = ": on Debian, apt install libglu1-mesa" if ".so" in last else ""
    return f"the process with gmsh failed: {last}{lacks}"
