"""The group `space` of a results file: outlines one after the other, connections, ground frames."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise, repeat
from typing import Any

import h5py
import numpy as np

from ..files.arrays import Array
from ..files.hdf5 import texts, whole
from ..superelement import Outline, SuperelementError
from ..superelement.cells import padded
from .errors import ResultsError
from .space import Connection, ContactShape, Space

SPACE_GROUP = "space"
TEXT_OF_SPACE = h5py.string_dtype()
# The name that the netCDF library gives to a dimension without a variable; others look for it.
WITHOUT_VALUES = "This is a netCDF dimension but not a netCDF variable.%10d"


def put_space(file: h5py.File, space: Space) -> None:
    """Write the group of a new file."""
    group = file.create_group(SPACE_GROUP, track_order=True)
    _Writer(group).put(space)


def read_space(file: h5py.File) -> Space | None:
    """What the group holds; None where there is none, as in files before version 7."""
    if not isinstance(group := file.get(SPACE_GROUP), h5py.Group):
        return None
    try:
        return Space(
            dict(_outlines(group)),
            tuple(_connections(group)),
            dict(_ground_frames(group)),
            dict(_interfaces(group)),
        )
    except (SuperelementError, KeyError, IndexError, ValueError) as error:
        raise ResultsError(f"group {SPACE_GROUP!r}: {error}") from error


class _Writer:
    """Variables of a group with their dimensions."""

    def __init__(self, group: h5py.Group) -> None:
        self._group = group
        self._scales: dict[str, h5py.Dataset] = {}
        self._dimension("axis", 3)

    def put(self, space: Space) -> None:
        different = list({id(outline): outline for outline in space.outlines.values()}.values())
        if different:
            self._put_outlines(different)
            self._put_texts("body", "body", "body", list(space.outlines))
            number = {id(outline): n for n, outline in enumerate(different)}
            of_body = [number[id(outline)] for outline in space.outlines.values()]
            self._put("outline_of_body", ("body",), np.array(of_body), "number of its outline")
            counts = np.array([space.interfaces.get(name, 0) for name in space.outlines])
            self._put("interfaces_of_body", ("body",), counts, "number of its interfaces")
        if space.connections:
            self._put_connections(space.connections)
        if space.ground_frames:
            self._put_ground_frames(space.ground_frames)

    def _put_outlines(self, outlines: Sequence[Outline]) -> None:
        points = np.concatenate([outline.points for outline in outlines])
        cells = padded([outline.cells for outline in outlines]).astype(np.int32)
        node = np.concatenate([_nodes(outline) for outline in outlines])
        firsts = {
            "first_point": np.cumsum([0, *(len(outline.points) for outline in outlines)]),
            "first_cell": np.cumsum([0, *(len(outline.cells) for outline in outlines)]),
        }
        for name, n in (
            ("outline_bound", len(outlines) + 1),
            ("point", len(points)),
            ("cell", len(cells)),
            ("corner", cells.shape[1]),
        ):
            self._dimension(name, n)
        for name, first in firsts.items():
            what = f"{name.replace('_', ' ')} of each outline, then the number of all"
            self._put(name, ("outline_bound",), first, what)
        self._put("points", ("point", "axis"), points, "points at rest, in body axes", "m")
        self._put("cells", ("cell", "corner"), cells, "points of each facet in its outline, or -1")
        self._put("node", ("point",), node, "node of the beam that carries the point, or -1")

    def _put_connections(self, connections: Sequence[Connection]) -> None:
        columns = {
            "connection": [connection.name for connection in connections],
            "connection_group": [connection.group for connection in connections],
            "connection_type": [connection.type for connection in connections],
            "connection_first": [connection.between[0] for connection in connections],
            "connection_second": [connection.between[1] for connection in connections],
        }
        for name, values in columns.items():
            self._put_texts(name, "connection", name.replace("_", ": "), values)
        nothing = np.full(3, np.nan)
        axes = [nothing if one.axis is None else one.axis for one in connections]
        what = "axis, in the axes of the first frame"
        self._put("connection_axis", ("connection", "axis"), np.array(axes), what, "1")
        if any(one.shape is not None for one in connections):
            self._put_shapes([one.shape for one in connections])

    def _put_shapes(self, shapes: Sequence[ContactShape | None]) -> None:
        """Of all connections; nan where one has no shape, which only contacts have."""
        none = ContactShape(np.nan, np.nan, np.full(3, np.nan), np.zeros((0, 2)))
        every = [shape or none for shape in shapes]
        radii, lengths = (np.array([getattr(s, n) for s in every]) for n in ("radius", "length"))
        first = np.cumsum([0, *(len(shape.curve) for shape in every)])
        self._dimension("curve_bound", len(first))
        self._dimension("plane_axis", 2)
        self._dimension("curve_point", int(first[-1]))
        self._put("contact_radius", ("connection",), radii, "of a sphere or cylinder, or 0", "m")
        self._put("contact_length", ("connection",), lengths, "of a cylinder, or inf", "m")
        across = np.array([shape.across for shape in every])
        what = "across the axis, in the axes of the first frame"
        self._put("contact_across", ("connection", "axis"), across, what, "1")
        what = "first point of the curve of each profile, then the number of all"
        self._put("first_curve_point", ("curve_bound",), first, what)
        curves = np.concatenate([shape.curve for shape in every])
        what = "points of profiles, along contact_across and axis x contact_across"
        self._put("curve_points", ("curve_point", "plane_axis"), curves, what, "m")

    def _put_ground_frames(self, frames: Mapping[str, Array]) -> None:
        self._put_texts("ground_frame", "ground_frame", "frames fixed in space", list(frames))
        positions = np.array(list(frames.values()))
        self._put("ground_frame_position", ("ground_frame", "axis"), positions, "position", "m")

    def _dimension(self, name: str, n: int) -> None:
        scale = self._group.create_dataset(name, shape=(n,), dtype=">f4")
        scale.make_scale(WITHOUT_VALUES % n)
        self._scales[name] = scale

    def _put_texts(self, name: str, dimension: str, what: str, values: Sequence[str]) -> None:
        data = np.array(values, dtype=object)
        dataset = self._group.create_dataset(name, data=data, dtype=TEXT_OF_SPACE)
        dataset.attrs["long_name"] = what
        if name == dimension:
            dataset.make_scale(name)
            self._scales[name] = dataset
        else:
            self._attach(dataset, (dimension,))

    def _put(
        self, name: str, dimensions: Sequence[str], data: Any, what: str, unit: str = ""
    ) -> None:
        dataset = self._group.create_dataset(name, data=data)
        dataset.attrs["long_name"] = what
        if unit:
            dataset.attrs["units"] = unit
        self._attach(dataset, dimensions)

    def _attach(self, dataset: h5py.Dataset, dimensions: Sequence[str]) -> None:
        for axis, name in enumerate(dimensions):
            h5py.h5ds.attach_scale(dataset.id, self._scales[name].id, axis)


def _nodes(outline: Outline) -> Any:
    """The node of each point, -1 of solids."""
    n = len(outline.points)
    return np.full(n, -1, np.int32) if outline.node is None else outline.node.astype(np.int32)


def _outlines(group: h5py.Group) -> Iterator[tuple[str, Outline]]:
    if "body" not in group:
        return
    points, cells, node, first_point, first_cell, of_body = (
        whole(group[name])
        for name in ("points", "cells", "node", "first_point", "first_cell", "outline_of_body")
    )
    made: dict[int, Outline] = {}
    for body, n in zip(texts(group["body"]), of_body.tolist(), strict=True):
        if n not in made:
            here = slice(first_point[n], first_point[n + 1])
            nodes = node[here]
            rows = cells[first_cell[n] : first_cell[n + 1]]
            carried = len(nodes) and nodes.min() >= 0
            made[n] = Outline(points[here], rows, nodes if carried else None)
        yield body, made[n]


def _interfaces(group: h5py.Group) -> Iterator[tuple[str, int]]:
    if "interfaces_of_body" in group:
        counts = whole(group["interfaces_of_body"]).tolist()
        yield from zip(texts(group["body"]), counts, strict=True)


def _connections(group: h5py.Group) -> Iterator[Connection]:
    if "connection" not in group:
        return
    names = ("", "_group", "_type", "_first", "_second")
    columns = [texts(group[f"connection{name}"]) for name in names]
    axes = whole(group["connection_axis"])
    shapes = _shapes(group, len(axes))
    for name, of, kind, first, second, axis, shape in zip(*columns, axes, shapes, strict=True):
        known = None if np.isnan(axis[0]) else axis
        yield Connection(name, of, kind, (first, second), known, shape)


def _shapes(group: h5py.Group, n: int) -> Iterator[ContactShape | None]:
    """The shape of each of n connections; None of all where the file has none."""
    if "contact_radius" not in group:
        yield from repeat(None, n)
        return
    radii, lengths, across, first, curves = (
        whole(group[name])
        for name in (
            "contact_radius",
            "contact_length",
            "contact_across",
            "first_curve_point",
            "curve_points",
        )
    )
    columns = zip(radii, lengths, across, pairwise(first), strict=True)
    for radius, length, e1, (a, b) in columns:
        known = not np.isnan(radius)
        yield ContactShape(float(radius), float(length), e1, curves[a:b]) if known else None


def _ground_frames(group: h5py.Group) -> Iterator[tuple[str, Array]]:
    if "ground_frame" in group:
        positions = whole(group["ground_frame_position"])
        yield from zip(texts(group["ground_frame"]), positions, strict=True)
