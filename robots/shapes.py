"""What pictures show of the bodies of a robot: figures of its links, or facets of its meshes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..files import require_no_input
from ..files.arrays import Array
from ..solver.schema.paths import relative
from ..superelement import Outline, figures
from .bodies import ModelBody
from .description import Geometry, Robot, Visual
from .document import tidy
from .meshes import Facets, MeshError, found_mesh, read_facets, write_stl
from .names import Names
from .poses import Pose
from .tree import Tree

# Of axes that count as along those of the body: what products of rotations leave.
AXES_TOLERANCE = 1e-9


@dataclass
class Shaper:
    """Gives the bodies of a robot their shapes.

    A figure along the axes of the body, and an STL file in its axes, stand in the model as they
    are. All others are written as one STL file for each body, into a folder beside the model.
    """

    robot: Robot
    target: Path
    packages: Sequence[Path]
    facets: dict[Path, Facets] = field(default_factory=dict)
    """what is to be written, by its path"""
    names: Names = field(default_factory=Names)
    meshes: list[Path] = field(default_factory=list)
    """the files that were found, of which none is to be replaced"""

    @property
    def folder(self) -> Path:
        """Where facets are written: robot-shapes beside robot.toml."""
        return self.target.with_name(f"{self.target.stem}-shapes")

    def give_shape(self, body: ModelBody, tree: Tree) -> list[str]:
        """Give a body its shape; what cannot be shown is said."""
        visuals = [
            Visual(body.pose.relative(tree.pose[link] @ visual.pose), visual.geometry)
            for link in body.links
            for visual in self.robot.links[link].visuals
        ]
        told: list[str] = []
        parts: list[Facets] = []
        for visual in visuals:
            try:
                if len(visuals) == 1 and (shape := self._as_it_is(visual, body.size)):
                    body.shape = shape
                    return told
                parts.append(self._facets(visual))
            except MeshError as error:
                told.append(str(error))
        # One file for all: a body of a model has one shape.
        if parts:
            path = self.folder / f"{self.names.new(body.name)}.stl"
            self.facets[path] = _joined(parts)
            body.shape = {"stl": relative(str(path), self.target.parent)}
        return told

    def write(self) -> list[Path]:
        """Write the files of all shapes; their paths. `OverwriteError` for a mesh of the robot."""
        for path in self.facets:
            require_no_input(path, self.meshes, "a mesh of the robot", "shape")
        if self.facets:
            self.folder.mkdir(exist_ok=True)
        for path, facets in self.facets.items():
            write_stl(path, facets)
        return list(self.facets)

    def _as_it_is(self, visual: Visual, body_size: float) -> Mapping[str, Any] | None:
        """A figure as model files have it, None where they do not."""
        pose, geometry = visual.pose, visual.geometry
        size = geometry.size
        p = tidy(pose.p, body_size)
        center: dict[str, Any] = {"center": p} if p.any() else {}
        if geometry.kind == "sphere":
            return {"sphere": float(size[0])} | center
        if geometry.kind == "cylinder":
            axis = tidy(pose.R[:, 2], 1.0)
            cylinder = {"radius": float(size[0]), "length": float(size[1]), "axis": axis}
            return {"cylinder": cylinder} | center
        if geometry.kind == "box":
            along = np.abs(pose.R).round()
            if np.abs(np.abs(pose.R) - along).max() > AXES_TOLERANCE:
                return None
            return {"box": along @ size} | center
        return self._file_as_it_is(geometry, pose, center)

    def _file_as_it_is(
        self, geometry: Geometry, pose: Pose, center: dict[str, Any]
    ) -> Mapping[str, Any] | None:
        scale = float(geometry.size[0])
        turned = np.abs(pose.R - np.eye(3)).max() > AXES_TOLERANCE
        if turned or not (geometry.size == scale).all() or scale <= 0.0 or not geometry.file:
            return None
        path = self._found(geometry.file)
        if path.suffix.lower() != ".stl":
            return None
        # An unreadable one is told now; in the model it would be an error.
        read_facets(path, geometry.file)
        scaled = {"scale": scale} if scale != 1.0 else {}
        return {"stl": relative(str(path), self.target.parent)} | scaled | center

    def _found(self, name: str) -> Path:
        path = found_mesh(name, self.robot.path, self.packages)
        self.meshes.append(path)
        return path

    def _facets(self, visual: Visual) -> Facets:
        """The triangles of a figure in the axes of the body."""
        geometry = visual.geometry
        if geometry.kind != "mesh":
            outline = _outline(geometry)
            points, triangles = outline.points, outline.triangles
        elif geometry.facets is not None:
            points, triangles = geometry.facets
        else:
            points, triangles = read_facets(self._found(geometry.file), geometry.file)
        if geometry.kind == "mesh":
            points = points * geometry.size
            # A mirror turns facets inside out: the other order of corners turns them back.
            triangles = triangles[:, ::-1] if np.prod(geometry.size) < 0.0 else triangles
        return visual.pose.of(points), triangles


def _outline(geometry: Geometry) -> Outline:
    if geometry.kind == "box":
        return figures.box(geometry.size)
    if geometry.kind == "sphere":
        return figures.sphere(float(geometry.size[0]))
    radius, length = geometry.size.tolist()
    return figures.cylinder(radius, length, np.array([0.0, 0.0, 1.0]))


def _joined(parts: Sequence[Facets]) -> Facets:
    starts = np.cumsum([0, *(len(points) for points, _ in parts)])
    points: Array = np.concatenate([points for points, _ in parts])
    triangles = [tri + start for (_, tri), start in zip(parts, starts, strict=False)]
    return points, np.concatenate(triangles)
