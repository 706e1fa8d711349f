"""Points and cells that move, as VTKHDF: an unstructured grid whose cells stay.

Source: VTKHDF file format 2.2, docs.vtk.org: UnstructuredGrid, Temporal UnstructuredGrid. Readers
of VTK 9.7 show collections of grids at their first time only, so all cells are in one grid.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import h5py
import numpy as np

from ...files.arrays import Array, IntArray

VTKHDF_VERSION = (2, 2)
# Points that HDF5 compresses together.
CHUNK_POINTS = 1 << 15
GZIP_LEVEL = 4
# Points times steps in memory together, so that long runs of large meshes fit.
BATCH_POINTS = 1 << 20
# By the number of points: vertex, line, triangle, quad, and the quadratic ones.
VTK_CELL_TYPES = {1: 1, 2: 3, 3: 5, 4: 9, 6: 22, 8: 23, 9: 28}


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells by the numbers of their points, one after the other, as VTK has them.

    points: how many there are; connectivity (c,): point numbers; offsets (n + 1,): where each cell
    begins in it; types (n,).
    """

    points: int
    connectivity: IntArray
    offsets: IntArray
    types: IntArray

    @classmethod
    def of_rows(cls, points: int, rows: IntArray) -> "Cells":
        """Of rows of point numbers (n, k), which -1 fills."""
        given = rows >= 0
        sizes = given.sum(axis=1)
        # Types by size: outlines have no two types of cells with as many points.
        types = np.array([VTK_CELL_TYPES[size] for size in sizes.tolist()], dtype=np.int64)
        return cls(points, rows[given].astype(np.int64), np.append(0, np.cumsum(sizes)), types)

    @classmethod
    def of_points(cls, points: int) -> "Cells":
        """A vertex for each point."""
        return cls.of_rows(points, np.arange(points, dtype=np.int64)[:, None])

    @classmethod
    def joined(cls, parts: Sequence["Cells"]) -> "Cells":
        """All cells, the points of one part behind those of the other."""
        points = np.cumsum([0, *(part.points for part in parts)])
        corners = np.cumsum([0, *(len(part.connectivity) for part in parts)])
        before = list(zip(parts, points.tolist(), corners.tolist(), strict=False))
        return cls(
            int(points[-1]),
            np.concatenate([part.connectivity + n for part, n, _ in before]),
            np.concatenate([[0], *(part.offsets[1:] + c for part, _, c in before)]),
            np.concatenate([part.types for part in parts]),
        )

    def __len__(self) -> int:
        return len(self.types)


class Grid:
    """A grid in an HDF5 file at some times (k,) [s], to which positions are added by `put`.

    of_cells: fields of the cells (n,), which do not change.
    """

    def __init__(
        self, file: h5py.File, times: Array, cells: Cells, of_cells: Mapping[str, IntArray]
    ) -> None:
        self._points, self._steps = cells.points, len(times)
        # VTK shows fields in the order in which they were made.
        self._root = file.create_group("VTKHDF", track_order=True)
        self._root.attrs["Version"] = np.array(VTKHDF_VERSION, dtype=np.int64)
        self._root.attrs["Type"] = np.bytes_("UnstructuredGrid")
        self._written: dict[str, int] = {}
        self._offsets = cells.points * np.arange(len(times))
        _put_cells(self._root, cells)
        _put_steps(self._root, times, self._offsets)
        for name, values in of_cells.items():
            self._root[f"CellData/{name}"] = values
            self._root[f"Steps/CellDataOffsets/{name}"] = np.zeros(len(times), dtype=np.int64)

    def put(self, positions: Array, fields: Mapping[str, Array]) -> None:
        """The points (k, p, 3) in space [m] at the next k times, and fields (k, p, ...) there."""
        self._append("Points", positions, np.float64)
        for name, values in fields.items():
            self._append(f"PointData/{name}", values, np.float32)

    def _append(self, path: str, values: Array, kind: type) -> None:
        # VTKHDF has the points of all times in one dataset, one time behind the other.
        rows: Array = np.asarray(values, dtype=kind).reshape(-1, *values.shape[2:])
        if path not in self._root:
            self._create(path, rows)
        first = self._written.get(path, 0)
        self._root[path][first : first + len(rows)] = rows
        self._written[path] = first + len(rows)

    def _create(self, path: str, rows: Array) -> None:
        total = self._points * self._steps
        self._root.create_dataset(
            path,
            shape=(total, *rows.shape[1:]),
            dtype=rows.dtype,
            chunks=(max(1, min(total, CHUNK_POINTS)), *rows.shape[1:]),
            compression="gzip",
            compression_opts=GZIP_LEVEL,
            shuffle=True,
        )
        if path != "Points":
            self._root[f"Steps/PointDataOffsets/{path.partition('/')[2]}"] = self._offsets


def _put_cells(group: h5py.Group, cells: Cells) -> None:
    group["NumberOfPoints"] = np.array([cells.points])
    group["NumberOfCells"] = np.array([len(cells)])
    group["NumberOfConnectivityIds"] = np.array([len(cells.connectivity)])
    group["Connectivity"] = cells.connectivity
    group["Offsets"] = cells.offsets
    group["Types"] = cells.types.astype(np.uint8)
    for data in ("PointData", "CellData"):
        group.create_group(data, track_order=True)


def _put_steps(group: h5py.Group, times: Array, offsets: IntArray) -> None:
    """Where the points of each time begin; the cells are the same at all of them."""
    n = len(times)
    steps = group.create_group("Steps", track_order=True)
    steps.attrs["NSteps"] = n
    steps["Values"] = times
    steps["PartOffsets"] = np.zeros(n, dtype=np.int64)
    steps["NumberOfParts"] = np.ones(n, dtype=np.int64)
    steps["PointOffsets"] = offsets
    # Zero for all times: they share the cells of the first one.
    steps["CellOffsets"] = np.zeros((n, 1), dtype=np.int64)
    steps["ConnectivityIdOffsets"] = np.zeros((n, 1), dtype=np.int64)
    for data in ("PointData", "CellData"):
        steps.create_group(f"{data}Offsets", track_order=True)
