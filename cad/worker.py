"""The process that loads gmsh: it reads a CAD file and writes a mesh and what it found.

gmsh is one session for a whole process, prints as it likes, and may crash on a damaged file. Here
it does so to itself alone, and leaves the sessions of users alone.
"""

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import gmsh
import numpy as np

from ..superelement.validation import Array
from .errors import CadError
from .feature import Feature
from .meshing import mesh
from .picking import Pick, picked
from .quality import Quality
from .recognition import features_of
from .session import keep_alone, open_solids, solid_size


def main(request: Path, reply: Path) -> None:
    """Answer a request, in JSON, by a reply; failures are part of it."""
    try:
        answer = _answer(json.loads(request.read_text(encoding="utf-8")))
    except CadError as error:
        answer = {"error": str(error)}
    except Exception as error:  # gmsh has no other type
        answer = {"error": f"gmsh cannot use it: {error}"}
    reply.write_text(json.dumps(answer), encoding="utf-8")


def _answer(asked: dict[str, Any]) -> dict[str, Any]:
    unit = asked["unit"]
    with open_solids(Path(asked["path"])) as solids:
        found: dict[str, Any] = {"gmsh": gmsh.__version__}
        if asked["mesh"] is None:
            found["solids"] = {name: _listed(tag, unit) for name, tag in solids.items()}
            return found
        found["solid"], solid = keep_alone(solids, asked["solid"])
        found["volume"] = unit**3 * gmsh.model.occ.getMass(3, solid)
        features = features_of(solid)
        found["features"] = _tables(features, unit)
        picks = [Pick.of(table) for table in asked["picks"]]
        quality, groups = _mesh(solid, features, picks, asked, found["solid"])
        return found | {"quality": asdict(quality), "groups": groups}


def _listed(solid: int, unit: float) -> dict[str, Any]:
    center = unit * np.array(gmsh.model.occ.getCenterOfMass(3, solid))
    volume = unit**3 * gmsh.model.occ.getMass(3, solid)
    features = _tables(features_of(solid), unit)
    return {"volume": volume, "center": center.tolist(), "features": features}


def _tables(features: list[Feature], unit: float) -> list[dict[str, Any]]:
    return [asdict(feature.scaled(unit)) for feature in features]


def _mesh(
    solid: int, features: list[Feature], picks: list[Pick], asked: dict[str, Any], name: str
) -> tuple[Quality, dict[str, int]]:
    """Mesh the solid into the file that is asked for, with a group for each pick of no size.

    How good it is, and the numbers of the features that the groups are.
    """
    unit = asked["unit"]
    in_meters = [feature.scaled(unit) for feature in features]

    def distance(face: int, point: Array) -> float:
        return float(unit * _distance(face, point / unit))

    size = unit * solid_size(solid)
    chosen = [picked(pick, in_meters, distance, size) for pick in picks]
    sizes: dict[int, float] = {}
    groups: dict[str, Feature] = {}
    for pick, feature in zip(picks, chosen, strict=True):
        if pick.size is None:
            groups[pick.group] = feature
            continue
        # Of several sizes for a face the smallest counts: the other is kept by it too.
        for face in feature.faces:
            sizes[face] = min(pick.size / unit, sizes.get(face, np.inf))
    # Groups come after the mesh: it is the same whatever is selected on it.
    quality = mesh(solid, asked["size"] / unit, sizes, unit)
    gmsh.model.addPhysicalGroup(3, [solid], name=name)
    for group, feature in groups.items():
        gmsh.model.addPhysicalGroup(2, list(feature.faces), name=group)
    gmsh.write(asked["mesh"])
    return quality, {group: feature.number for group, feature in groups.items()}


def _distance(face: int, point: Array) -> float:
    """Exact distance of a point from a face with its edges."""
    # By Open CASCADE, not by facets: a point of a body file lies on the face, not on its chords.
    probe = gmsh.model.occ.addPoint(*point.tolist())
    try:
        return float(gmsh.model.occ.getDistance(0, probe, 2, face)[0])
    finally:
        gmsh.model.occ.remove([(0, probe)])


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
