"""Files of reduced models that finite element codes read: arrays, OUTPUT4, and bulk data.

All are read back as [matrices]: the arrays alone, the others with the deck of points.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .validation import Array

DOFS_PER_POINT = 6
SMALLEST_ENTRY = 1e-99  # an exponent of two digits is what a field of 16 letters holds
_SYMMETRIC, _DOUBLE = 6, 2  # forms and types of OUTPUT4 and DMIG


@dataclass(frozen=True, eq=False)
class ReducedModel:
    """Symmetric matrices by role, stiffness, mass and damping, on points and modal coordinates.

    names and points (n, 3) [m]: of frames, labelled 1, 2, ...; rotates (n,): which have six dofs,
    else three. matrices (n_u, n_u): the dofs of the points, then the modal coordinates. frequencies
    (m,) [Hz]: with all points held.
    """

    name: str
    names: Sequence[str]
    points: Array
    rotates: Sequence[bool]
    matrices: Mapping[str, Array]
    frequencies: Array

    @property
    def modal_labels(self) -> NDArray[np.int64]:
        """Labels of the modal coordinates, above those of the points."""
        first = 1000 * (1 + len(self.points) // 1000)
        return first + np.arange(1, len(self.frequencies) + 1)

    @property
    def dofs(self) -> NDArray[np.int64]:
        """Label and direction (n_u, 2) of every row, 0 of modal coordinates."""
        of_points = [
            (label, direction)
            for label, six in enumerate(self.rotates, 1)
            for direction in range(1, 7 if six else 4)
        ]
        return np.array([*of_points, *((label, 0) for label in self.modal_labels)], dtype=np.int64)


def write_arrays(model: ReducedModel, path: Path) -> None:
    """NumPy's .npz, of double precision without loss."""
    np.savez_compressed(
        path,
        stiffness=model.matrices["stiffness"],
        mass=model.matrices["mass"],
        damping=model.matrices["damping"],
        dofs=model.dofs,
        points=model.points,
        labels=np.arange(1, len(model.points) + 1),
        interfaces=np.array(list(model.names)),
        frequencies=model.frequencies,
    )


def write_op4(model: ReducedModel, names: Mapping[str, str], path: Path) -> None:
    """Binary OUTPUT4 of the matrices, by names, in the order of Nastran: six rows of each point."""
    places = _places(model)
    n = DOFS_PER_POINT * len(model.points) + len(model.frequencies)
    with path.open("wb") as file:
        for role, matrix in model.matrices.items():
            head = np.array([n, n, _SYMMETRIC, _DOUBLE], dtype="<i4").tobytes()
            file.write(_record(head + f"{names[role]:8}".encode()))
            for column, values in zip(places, matrix.T, strict=True):
                rows = places[values != 0.0]
                if not len(rows):
                    continue
                # One string for each column: readers of all ages know dense columns.
                first, last = int(rows.min()), int(rows.max())
                filled = np.zeros(n)
                filled[places] = values
                run = filled[first : last + 1].astype("<f8").tobytes()
                words = np.array([column + 1, first + 1, len(run) // 4], dtype="<i4").tobytes()
                file.write(_record(words + run))
            # A column behind the last one ends the matrix.
            file.write(_record(np.array([n + 1, 1, 2], dtype="<i4").tobytes() + b"\0" * 8))


def _places(model: ReducedModel) -> NDArray[np.int64]:
    """The row (n_u,) of every dof among six of each point and the modal coordinates."""
    dofs = model.dofs
    of_points = DOFS_PER_POINT * (dofs[:, 0] - 1) + dofs[:, 1] - 1
    n_modes = len(model.frequencies)
    modal = DOFS_PER_POINT * len(model.points) + np.arange(n_modes)
    return np.concatenate([of_points[: len(dofs) - n_modes], modal])


def _record(data: bytes) -> bytes:
    length = np.array([len(data)], dtype="<i4").tobytes()
    return length + data + length


def write_dmig(model: ReducedModel, names: Mapping[str, str], path: Path) -> None:
    """Cards DMIG of the matrices, by names, of which the lower halves, with ten digits."""
    with path.open("w", encoding="utf-8") as file:
        for role, matrix in model.matrices.items():
            file.writelines(_dmig(names[role], matrix, model.dofs))


def _dmig(name: str, matrix: Array, dofs: NDArray[np.int64]) -> Iterator[str]:
    yield f"DMIG    {name:8}{0:8d}{_SYMMETRIC:8d}{_DOUBLE:8d}{0:8d}\n"
    for j, (label, direction) in enumerate(dofs.tolist()):
        # Of a symmetric matrix Nastran must not get an entry twice.
        rows = j + np.flatnonzero(np.abs(matrix[j:, j]) >= SMALLEST_ENTRY)
        if len(rows):
            yield f"DMIG*   {name:16}{label:16d}{direction:16d}\n"
        for i in rows:
            value = f"{matrix[i, j]:16.9E}".replace("E", "D")
            yield f"*       {dofs[i, 0]:16d}{dofs[i, 1]:16d}{value}\n"


def write_deck(model: ReducedModel, path: Path) -> None:
    """The points as GRID and the modal coordinates as SPOINT, in bulk data."""
    lines = [f"$ {model.name}: interfaces and modal coordinates, m, kg, N, s\n"]
    for label, (name, point) in enumerate(zip(model.names, model.points, strict=True), 1):
        x, y, z = (f"{value:16.9E}".replace("E", "D") for value in point)
        lines += [f"$ {name}\n", f"GRID*   {label:16d}{0:16d}{x}{y}\n", f"*       {z}{0:16d}\n"]
    lines += [f"SPOINT  {label:8d}\n" for label in model.modal_labels]
    path.write_text("".join(lines), encoding="utf-8")
