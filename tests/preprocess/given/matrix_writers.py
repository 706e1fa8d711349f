"""Matrices and nodes as other programs write them. Each writer takes a path, a symmetric matrix and
its dofs.
"""

from collections.abc import Callable
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
import scipy.sparse as sp


def npz(path: Path, matrix: Any, dofs: Any) -> Path:
    path = path.with_suffix(".npz")
    sp.save_npz(path, matrix)
    return path


def lower_npz(path: Path, matrix: Any, dofs: Any) -> Path:
    return npz(path, sp.tril(matrix, format="csr"), dofs)


def market_general(path: Path, matrix: Any, dofs: Any) -> Path:
    path = path.with_suffix(".mtx")
    scipy.io.mmwrite(path, matrix, symmetry="general", precision=17)
    return path


def market_symmetric(path: Path, matrix: Any, dofs: Any) -> Path:
    path = path.with_suffix(".mtx")
    scipy.io.mmwrite(path, matrix, symmetry="symmetric", precision=17)
    return path


def abaqus_input(path: Path, matrix: Any, dofs: Any) -> Path:
    """*MATRIX OUTPUT, FORMAT=MATRIX INPUT: the lower triangle, by labels, with commas."""
    lower = sp.tril(matrix).tocoo()
    rows = zip(dofs[lower.row].tolist(), dofs[lower.col].tolist(), lower.data.tolist(), strict=True)
    path = path.with_suffix(".mtx")
    path.write_text(
        "** a job\n" + "".join(f"{i},{a}, {j},{b}, {v:.17e}\n" for (i, a), (j, b), v in rows)
    )
    return path


def abaqus_labels(path: Path, matrix: Any, dofs: Any) -> Path:
    """FORMAT=LABELS: here the whole matrix, by labels, with blanks, in no order."""
    whole = matrix.tocoo()
    shuffled = np.random.default_rng(3).permutation(whole.nnz)
    rows, columns, values = whole.row[shuffled], whole.col[shuffled], whole.data[shuffled]
    path = path.with_suffix(".mtx")
    lines = zip(dofs[rows].tolist(), dofs[columns].tolist(), values.tolist(), strict=True)
    path.write_text("".join(f" {i} {a} {j} {b} {v:.17e}\n" for (i, a), (j, b), v in lines))
    return path


def abaqus_coordinate(path: Path, matrix: Any, dofs: Any) -> Path:
    """FORMAT=COORDINATE: the upper triangle, by rows and columns."""
    upper = sp.triu(matrix).tocoo()
    path = path.with_suffix(".mtx")
    np.savetxt(path, np.column_stack([upper.row + 1, upper.col + 1, upper.data]), fmt="%d %d %.17e")
    return path


def op4_binary(path: Path, matrix: Any, dofs: Any, order: str = "<") -> Path:
    """OUTPUT4 with sparse columns, behind another matrix with dense ones."""
    return _op4(path, matrix, order, long=False)


def op4_long(path: Path, matrix: Any, dofs: Any, order: str = ">") -> Path:
    """OUTPUT4 with BIGMAT, from a machine with the other order of bytes."""
    return _op4(path, matrix, order, long=True)


def _op4(path: Path, matrix: Any, order: str, long: bool) -> Path:
    def words(*numbers: int) -> bytes:
        return np.array(numbers, dtype=f"{order}i4").tobytes()

    def record(body: bytes) -> bytes:
        return words(len(body)) + body + words(len(body))

    name = "KGG" if path.stem.startswith("K") else "MGG"
    n = matrix.shape[0]
    data = record(words(2, 2, 6, 2) + b"OTHER   ")
    data += record(words(2, 1, 4) + np.array([5.0, 6.0], dtype=f"{order}f8").tobytes())
    data += record(words(3, 1, 2) + np.ones(1, dtype=f"{order}f8").tobytes())
    data += record(words(n, -n if long else n, 6, 2) + f"{name:8}".encode())
    for column, first, values in _columns(matrix):
        strings = b""
        for row, part in zip(first, values, strict=True):
            length = 2 * len(part)
            head = words(length + 1, row) if long else words(row + 65536 * (length + 1))
            strings += head + part.astype(f"{order}f8").tobytes()
        data += record(words(column, 0, len(strings) // 4) + strings)
    data += record(words(n + 1, 1, 2) + np.ones(1, dtype=f"{order}f8").tobytes())
    path = path.with_suffix(".op4")
    path.write_bytes(data)
    return path


def op4_text(path: Path, matrix: Any, dofs: Any) -> Path:
    """OUTPUT4 as text, with sparse columns, the lone matrix in its file."""
    n = matrix.shape[0]
    lines = [f"{n:8}{n:8}{6:8}{2:8}{'STIFF':8}1P,3E23.16"]
    for column, first, values in _columns(matrix):
        lines.append(f"{column:8}{0:8}{sum(2 * len(part) + 1 for part in values):8}")
        for row, part in zip(first, values, strict=True):
            lines.append(f"{row + 65536 * (2 * len(part) + 1):8}")
            lines += [
                "".join(f"{v:23.16E}" for v in part[i : i + 3]) for i in range(0, len(part), 3)
            ]
    lines += [f"{n + 1:8}{1:8}{1:8}", f"{1.0:23.16E}"]
    path = path.with_suffix(".op4")
    path.write_text("\n".join(lines) + "\n")
    return path


def _columns(matrix: Any) -> Any:
    """Every column that has entries, from 1: rows where runs of entries below each other begin, and
    their values.
    """
    matrix = matrix.tocsc()
    matrix.sort_indices()
    for j, (start, end) in enumerate(zip(matrix.indptr[:-1], matrix.indptr[1:], strict=True), 1):
        rows = matrix.indices[start:end].tolist()
        runs = [
            [i for _, i in group]
            for _, group in groupby(enumerate(rows), lambda pair: pair[1] - pair[0])
        ]
        if runs:
            ends = np.cumsum([len(run) for run in runs])[:-1]
            yield j, [run[0] + 1 for run in runs], np.split(matrix.data[start:end], ends)


BY_ORDER: list[Callable[..., Path]] = [
    npz,
    lower_npz,
    market_general,
    market_symmetric,
    abaqus_coordinate,
    op4_binary,
    op4_long,
    op4_text,
]
"""Formats whose rows follow the nodes, unless a file of dofs says otherwise."""
BY_LABEL: list[Callable[..., Path]] = [abaqus_input, abaqus_labels]
"""Formats whose entries name nodes and dofs."""


def write_nodes(path: Path, labels: Any, points: Any) -> Path:
    """label, x, y, z"""
    rows = zip(labels.tolist(), points.tolist(), strict=True)
    lines = [f"{label}, {x!r}, {y!r}, {z!r}\n" for label, (x, y, z) in rows]
    path.write_text("label, x, y, z\n" + "".join(lines))
    return path


def write_dofs(path: Path, dofs: Any) -> Path:
    """label, dof"""
    np.savetxt(path, dofs, fmt="%d", delimiter=", ", header="label, dof")
    return path
