"""Blocks of points and cells that move, as VTKHDF: unstructured grids in a collection.

The cells stay, the points and what is known at them change from step to step. Source: VTKHDF file
format 2.2, docs.vtk.org: UnstructuredGrid, PartitionedDataSetCollection, Temporal Data.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import NDArray

from ...superelement.validation import Array
from .folder import distinct

IntArray = NDArray[np.int64]

VERSION = (2, 2)
CHUNK = 1 << 15
"""points that HDF5 compresses together"""
COMPRESSION = 4
VERTEX = 1
SHAPES = {1: VERTEX, 2: 3, 3: 5, 4: 9, 6: 22, 8: 23, 9: 28}
"""types of cells in VTK by their number of points: vertex, line, triangle, quad, quadratic ones"""


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells by the numbers of their points, one after the other, as VTK has them.

    connectivity (c,): point numbers; offsets (n + 1,): where each cell begins in it; types (n,).
    """

    connectivity: IntArray
    offsets: IntArray
    types: IntArray

    @classmethod
    def of_rows(cls, rows: IntArray) -> "Cells":
        """Of rows of point numbers (n, k), which -1 fills."""
        given = rows >= 0
        sizes = given.sum(axis=1)
        types = np.array([SHAPES[size] for size in sizes.tolist()], dtype=np.int64)
        return cls(rows[given].astype(np.int64), np.append(0, np.cumsum(sizes)), types)

    @classmethod
    def of_points(cls, n: int) -> "Cells":
        """A vertex for each point."""
        return cls.of_rows(np.arange(n, dtype=np.int64)[:, None])

    def __len__(self) -> int:
        return len(self.types)


class Collection:
    """A collection of blocks in an HDF5 file, at some times (k,) [s]."""

    def __init__(self, file: h5py.File, times: Array) -> None:
        self._times = times
        self._root = file.create_group("VTKHDF", track_order=True)
        self._assembly = self._root.create_group("Assembly", track_order=True)
        _describe(self._root, "PartitionedDataSetCollection")
        self._blocks = 0

    def block(self, cells: Cells, points: int, name: str) -> "Block":
        """A new block with so many points at each time."""
        group = self._root.create_group(f"block{self._blocks}", track_order=True)
        group.attrs["Index"] = self._blocks
        self._blocks += 1
        return Block(group, self._times, cells, points, name)

    def arrange(self, branch: str, blocks: Sequence["Block"]) -> None:
        """Show blocks under their names in a branch of the tree, or at its root for ""."""
        parent = self._assembly
        if branch:
            parent = self._assembly.create_group(branch, track_order=True)
        names = distinct([block.name.replace("/", "_").replace(".", "_") for block in blocks])
        for name, block in zip(names, blocks, strict=True):
            parent[name] = h5py.SoftLink(block.path)


class Block:
    """An unstructured grid whose points move; `put` has its positions and fields, batch by batch."""

    def __init__(
        self, group: h5py.Group, times: Array, cells: Cells, points: int, name: str
    ) -> None:
        self.name, self.path = name, group.name
        self._group, self._points, self._steps = group, points, len(times)
        self._written: dict[str, int] = {}
        _describe(group, "UnstructuredGrid")
        _put_cells(group, cells, points)
        for data in ("PointData", "CellData", "FieldData"):
            group.create_group(data, track_order=True)
        self._offsets = points * np.arange(len(times))
        _put_steps(group, times, self._offsets)

    def put_of_cells(self, name: str, values: Array | IntArray) -> None:
        """A field of the cells (n,) that does not change."""
        self._put_constant("CellData", name, values)

    def put(self, positions: Array, fields: dict[str, Array]) -> None:
        """The points (k, p, 3) in space [m] at the next k times, and fields (k, p, ...) there."""
        self._append("Points", positions, np.float64)
        for name, values in fields.items():
            self._append(f"PointData/{name}", values, np.float32)

    def _append(self, path: str, values: Array, kind: type) -> None:
        rows = np.asarray(values, dtype=kind).reshape(-1, *values.shape[2:])
        if path not in self._group:
            self._create(path, rows)
        first = self._written.get(path, 0)
        self._group[path][first : first + len(rows)] = rows
        self._written[path] = first + len(rows)

    def _create(self, path: str, rows: Array) -> None:
        total = self._points * self._steps
        self._group.create_dataset(
            path,
            shape=(total, *rows.shape[1:]),
            dtype=rows.dtype,
            chunks=(max(1, min(total, CHUNK)), *rows.shape[1:]),
            compression="gzip",
            compression_opts=COMPRESSION,
            shuffle=True,
        )
        if path != "Points":
            name = path.partition("/")[2]
            self._group[f"Steps/PointDataOffsets/{name}"] = self._offsets

    def _put_constant(self, data: str, name: str, values: Array | IntArray) -> None:
        self._group[f"{data}/{name}"] = values
        self._group[f"Steps/{data}Offsets/{name}"] = np.zeros(self._steps, dtype=np.int64)


def _describe(group: h5py.Group, kind: str) -> None:
    group.attrs["Version"] = np.array(VERSION, dtype=np.int64)
    group.attrs["Type"] = np.bytes_(kind)


def _put_cells(group: h5py.Group, cells: Cells, points: int) -> None:
    group["NumberOfPoints"] = np.array([points])
    group["NumberOfCells"] = np.array([len(cells)])
    group["NumberOfConnectivityIds"] = np.array([len(cells.connectivity)])
    group["Connectivity"] = cells.connectivity
    group["Offsets"] = cells.offsets
    group["Types"] = cells.types.astype(np.uint8)


def _put_steps(group: h5py.Group, times: Array, offsets: IntArray) -> None:
    """Where the points of each time begin; the cells are the same at all of them."""
    n = len(times)
    steps = group.create_group("Steps", track_order=True)
    steps.attrs["NSteps"] = n
    steps["Values"] = times
    steps["PartOffsets"] = np.zeros(n, dtype=np.int64)
    steps["NumberOfParts"] = np.ones(n, dtype=np.int64)
    steps["PointOffsets"] = offsets
    steps["CellOffsets"] = np.zeros((n, 1), dtype=np.int64)
    steps["ConnectivityIdOffsets"] = np.zeros((n, 1), dtype=np.int64)
    for data in ("PointData", "CellData", "FieldData"):
        steps.create_group(f"{data}Offsets", track_order=True)
