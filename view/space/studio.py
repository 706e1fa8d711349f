"""Frames of a stage, painted by VTK without a screen."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...superelement.cells import IntArray
from ...superelement.validation import Array
from ..camera import Camera
from ..errors import PictureError
from ..field_kinds import COLOR_MAP
from ..scene import tint
from .bodies import Body
from .lettering import Frame, Image
from .marks import Mark
from .stage import Batch, Stage
from .surface import mesh_edges, point_normals, pyvista, surface

# Bodies beside those that are colored: gray says that they have no value.
UNCOLORED_BODY = (0.80, 0.82, 0.85)
# Of usual edges [pixels]: shorter ones would blacken a body.
LEAST_EDGE_LENGTH = 7.0
# In units of depth: edges lie before their facets, and marks before all bodies.
EDGE_OFFSET = 400.0
MARK_OFFSET = 66000.0
EDGE_COLOR = (0.25, 0.27, 0.30)
# Pixels drawn for each one shown, across and down: by software that is cheaper than the samples
# of OpenGL, and smoother.
SUPERSAMPLING = 2
# Larger pictures are smoothed by OpenGL, for their memory.
MAX_SUPERSAMPLED_PIXELS = 16_000_000
NO_OPENGL = (
    "OpenGL was not found, not even in software: Debian has it in libgl1, libegl1, libegl-mesa0 "
    "and libgl1-mesa-dri"
)


def _window(size: tuple[int, int]) -> Any:
    """What VTK draws in, without a screen; PictureError where the machine cannot."""
    library = pyvista()
    # It says that there is no screen, which nobody asked for.
    with library.vtk_verbosity("off"):
        plotter = library.Plotter(off_screen=True, window_size=size, lighting="none")
        if not plotter.render_window.SupportsOpenGL():
            raise PictureError(NO_OPENGL)
    return plotter


class Studio:
    """A stage with its camera and light: `frames` paints them one after the other."""

    def __init__(self, stage: Stage, camera: Camera, frame: Frame) -> None:
        self._stage, self._frame = stage, frame
        width, height = frame.size
        self._finer = (
            SUPERSAMPLING if SUPERSAMPLING**2 * width * height <= MAX_SUPERSAMPLED_PIXELS else 1
        )
        self._size = self._finer * width, self._finer * height
        self._plotter = _window(self._size)
        self._plotter.set_background("white")
        # What is seen through is drawn last, in its order: sorting it by depth takes as long again.
        self._plotter.renderer.SetUseOIT(False)
        if self._finer == 1:
            self._plotter.enable_anti_aliasing("msaa", multi_samples=4)
        else:
            self._plotter.disable_anti_aliasing()
        pixel = frame.pixel(camera.height)
        self._figures = [
            _BodyFigure(self._plotter, stage, number, pixel, self._finer)
            for number in range(len(stage.bodies))
        ]
        self._marks = [_MarkFigure(self._plotter, mark, self._finer) for mark in stage.marks]
        self._set_light(camera)
        self._camera = camera

    def __enter__(self) -> "Studio":
        return self

    def __exit__(self, *_: object) -> None:
        self._plotter.close()

    def frames(self, batch: Batch, shifts: Array) -> Iterator[Image]:
        """The frames of a batch, without letters.   shifts (k, 3): of the camera [m]"""
        marks = list(self._stage.mark_positions(batch.rows))
        for k in range(len(batch)):
            for figure, positions, values in zip(
                self._figures, batch.positions, batch.values, strict=True
            ):
                figure.move(positions[k], None if values is None else values[k])
            for mark, places in zip(self._marks, marks, strict=True):
                mark.move(places[k])
            self._aim(replace(self._camera, focus=self._camera.focus + shifts[k]))
            yield self._picture()

    def _picture(self) -> Image:
        """What is drawn, each pixel the mean of those drawn for it."""
        from PIL import Image as Images
        from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

        width, height = self._size
        window = self._plotter.render_window
        window.Render()
        read: Any = vtkUnsignedCharArray()
        # as OpenGL has them, in four bytes and from below to above: three would be made one by one
        window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, read, 0)
        drawn: Any = Images.frombuffer("RGBX", self._size, read, "raw", "RGBX", 0, -1)
        picture: Image = np.asarray(drawn.reduce(self._finer))[..., :3]
        return picture

    def _set_light(self, camera: Camera) -> None:
        library = pyvista()
        right, up, towards = camera.axes
        for direction, strength in (
            (-0.5 * right + 0.8 * up + 0.9 * towards, 0.62),
            (0.8 * right + 0.15 * up + 0.8 * towards, 0.28),
            (towards, 0.22),
        ):
            light = library.Light(light_type="scene light", intensity=strength)
            light.positional = False
            light.position, light.focal_point = tuple(direction), (0.0, 0.0, 0.0)
            self._plotter.add_light(light)

    def _aim(self, camera: Camera) -> None:
        """Put what the camera sees between the margins."""
        height, (left, right, bottom, top) = self._frame.size[1], self._frame.margins
        pixel = self._frame.pixel(camera.height)
        across, up, towards = camera.axes
        focus = camera.focus - 0.5 * pixel * ((left - right) * across + (bottom - top) * up)
        view = self._plotter.camera
        view.parallel_projection = True
        view.focal_point = tuple(focus)
        view.position = tuple(focus + 4.0 * camera.depth * towards)
        view.up = tuple(up)
        view.parallel_scale = 0.5 * pixel * height
        view.clipping_range = (2.0 * camera.depth, 6.0 * camera.depth)


class _BodyFigure:
    """The triangles and lines of a body."""

    def __init__(self, plotter: Any, stage: Stage, number: int, pixel: float, finer: int) -> None:
        body = stage.bodies[number]
        outline = body.outline
        self._colored = body in stage.told
        self._surface = surface(body.X, outline.triangles) if len(outline.triangles) else None
        style: dict[str, Any] = {
            "color": UNCOLORED_BODY if stage.field else tint(number),
            "show_scalar_bar": False,
        }
        if self._colored:
            style |= {"scalars": "value", "cmap": COLOR_MAP, "clim": (0.0, stage.limit or 1.0)}
        self._mesh, self._lines, self._rods = None, None, None
        if self._surface is not None:
            self._mesh = _mesh(body.X[self._surface.copies], triangles=self._surface.triangles)
            self._mesh.point_data["value"] = np.zeros(len(self._surface.copies), np.float32)
            self._mesh.point_data["Normals"] = np.zeros((len(self._surface.copies), 3), np.float32)
            self._mesh.point_data.active_normals_name = "Normals"
            plotter.add_mesh(
                self._mesh,
                smooth_shading=None,
                ambient=0.25,
                diffuse=0.85,
                specular=0.12,
                specular_power=12,
                culling="back" if self._surface.closed else False,
                **style,
            ).prop.interpolation = "Phong"
            edges = _drawn_edges(body, self._surface.edges, pixel)
            if len(edges):
                self._lines = _mesh(body.X, lines=edges)
                drawn = plotter.add_mesh(
                    self._lines,
                    color=EDGE_COLOR,
                    line_width=1.0 * finer,
                    opacity=0.55,
                    lighting=False,
                )
                _bring_forward(drawn, EDGE_OFFSET)
        if len(outline.lines):
            self._rods = _mesh(body.X, lines=outline.lines)
            self._rods.point_data["value"] = np.zeros(len(body.X), np.float32)
            style["render_lines_as_tubes"] = True
            plotter.add_mesh(self._rods, line_width=6.0 * finer, **style)

    def move(self, points: Array, values: Array | None) -> None:
        if self._mesh is not None and self._surface is not None:
            here = points[self._surface.copies]
            self._mesh.points = here
            self._mesh.point_data["Normals"][:] = point_normals(here, self._surface.triangles)
            if values is not None:
                self._mesh.point_data["value"][:] = values[self._surface.copies]
            self._mesh.Modified()
        if self._lines is not None:
            self._lines.points = points
        if self._rods is not None:
            self._rods.points = points
            if values is not None:
                self._rods.point_data["value"][:] = values


def _drawn_edges(body: Body, sharp: IntArray, pixel: float) -> IntArray:
    """The edges of a solid mesh where they are apart on a picture, else the sharp ones, or none."""
    for edges in (mesh_edges(body.outline.cells), sharp):
        a, b = body.X[edges[:, 0]], body.X[edges[:, 1]]
        lengths = np.linalg.norm(b - a, axis=1)
        meshed = edges is not sharp
        if meshed and (not body.flexible or body.outline.node is not None):
            continue
        if (
            len(edges)
            and np.percentile(lengths, 25.0 if meshed else 50.0) >= LEAST_EDGE_LENGTH * pixel
        ):
            return edges
    return (
        sharp
        if body.outline.node is None and _width(body) >= 3.0 * LEAST_EDGE_LENGTH * pixel
        else sharp[:0]
    )


def _width(body: Body) -> float:
    """The second largest length of the box of a body [m]."""
    return float(np.sort(np.ptp(body.X, axis=0))[1])


class _MarkFigure:
    """A mark, which lies before all bodies."""

    def __init__(self, plotter: Any, mark: Mark, finer: int) -> None:
        glyph = mark.glyph
        self._mesh = _mesh(glyph.points, triangles=glyph.triangles, lines=glyph.lines)
        shaded = bool(len(glyph.triangles))
        actor = plotter.add_mesh(
            self._mesh,
            color=mark.color,
            line_width=2.5 * finer,
            ambient=0.45,
            diffuse=0.6,
            lighting=shaded,
            opacity=mark.opacity if shaded else 1.0,
        )
        if mark.before:
            _bring_forward(actor, MARK_OFFSET)

    def move(self, points: Array) -> None:
        self._mesh.points = points.astype(np.float32)


def _bring_forward(actor: Any, units: float) -> None:
    """Draw as if it were nearer to the eye, by units of what depth can tell apart."""
    mapper = actor.mapper
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(0.0, -units)
    mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0.0, -units)


def _mesh(points: Array, triangles: Any = None, lines: Any = None) -> Any:
    parts: dict[str, Any] = {}
    if triangles is not None and len(triangles):
        parts["faces"] = _counted(triangles)
    if lines is not None and len(lines):
        parts["lines"] = _counted(lines)
    return pyvista().PolyData(points.astype(np.float32), **parts)


def _counted(cells: Any) -> Any:
    """Cells (n, k) as VTK reads them, each after the number of its points."""
    return np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel()
