"""Files of sparse matrices: Matrix Market, scipy's .npz, ANSYS, Abaqus, CalculiX and
Nastran.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...files import in_one_line
from ..errors import MatrixError
from ..mesh.mesh import IntArray
from .damage import MATRIX_DAMAGE, about_matrices, arrays, load_rows, require_text, whole_numbers
from .labels import MAX_LABEL, numbered
from .market import MARKET_HEAD, read_market
from .matrix_names import STIFFNESS_NAMES
from .user_element import is_user_element, read_user_element

MARKET_HEAD_BYTES = MARKET_HEAD.encode()


@dataclass(frozen=True, eq=False)
class MatrixFile:
    """A square matrix as its file has it, entries (n, n) sparse; perhaps half of a symmetric one.

    dofs (n, 2): label of the node and direction, 1 to 6, of every row where the file says them,
    else None; direction 0 of a generalized coordinate, which belongs to no node. dofs_file: the
    suffix of the file beside it that must say them, else empty. named: whether the file tells by a
    name which of several matrices this is. by_label: whether Nastran wrote it, in the order of the
    labels of its deck.
    """

    name: str
    entries: Any
    dofs: IntArray | None = None
    dofs_file: str = ""
    named: bool = False
    by_label: bool = False


def read_matrix(path: Path, names: tuple[str, ...]) -> MatrixFile:
    """Read a matrix; of a file with several the first of these names that is there. `MatrixError`
    says why it cannot be read.
    """
    read = _READERS.get(path.suffix.lower())
    if read is None:
        raise MatrixError(
            f"{path}: expected a file of type {', '.join(_READERS)}, "
            f"found {path.suffix or 'no suffix'}"
        )
    with about_matrices(path, "a matrix"):
        matrix = read(path, names)
    rows, columns = matrix.entries.shape
    if rows != columns:
        raise MatrixError(
            f"{path}: expected a square matrix, found {rows} rows and {columns} columns"
        )
    if matrix.dofs is not None and matrix.dofs.shape != (rows, 2):
        raise MatrixError(
            f"{path}: expected a label and a dof for each of {rows} rows, found an array "
            f"{matrix.dofs.shape}"
        )
    if matrix.entries.dtype.kind == "c":
        raise MatrixError(f"{path}: expected real numbers, found complex ones")
    if not np.isfinite(matrix.entries.data).all():
        raise MatrixError(
            f"{path}: expected finite numbers, "
            f"found {(~np.isfinite(matrix.entries.data)).sum()} others"
        )
    return matrix


def _npz(path: Path, names: tuple[str, ...]) -> MatrixFile:
    """A file of scipy.sparse.save_npz, or of arrays stiffness, mass and dofs."""
    with arrays(path, "a sparse matrix of scipy, or arrays stiffness, mass and dofs"):
        with np.load(path) as file:
            if "dofs" in file:
                key = "stiffness" if names is STIFFNESS_NAMES else "mass"
                dofs = whole_numbers(np.asarray(file["dofs"], dtype=float), "labels and dofs")
                return MatrixFile(path.name, sp.coo_array(file[key]), dofs, named=True)
        return MatrixFile(path.name, sp.coo_array(sp.load_npz(path)))


def _mtx(path: Path, names: tuple[str, ...]) -> MatrixFile:
    """Matrix Market if the first line says so, else Abaqus."""
    require_text(path)
    with path.open("rb") as file:
        market = file.read(len(MARKET_HEAD_BYTES)) == MARKET_HEAD_BYTES
    if market:
        return _market(path)
    if is_user_element(path):
        kind = "STIFFNESS" if names is STIFFNESS_NAMES else "MASS"
        entries, dofs = read_user_element(path, kind)
        return MatrixFile(path.name, entries, dofs, named=True)
    return _abaqus(path)


def _market(path: Path) -> MatrixFile:
    try:
        return MatrixFile(path.name, read_market(path))
    except MatrixError:
        raise
    except MATRIX_DAMAGE as error:
        raise MatrixError(f"not a Matrix Market file: {in_one_line(error)}") from error


def _abaqus(path: Path) -> MatrixFile:
    """A matrix of Abaqus with labels or with numbers of rows.

    Rows "node, dof, node, dof, value" (MATRIX INPUT, LABELS), or "row, column, value" from 1 on
    (COORDINATE).

    Source: Abaqus Analysis Guide, "Generating structural matrices".
    """
    with path.open(encoding="utf-8") as file:
        first = next((line for line in file if line.strip() and not line.startswith("*")), "")
    try:
        table = load_rows(path, delimiter="," if "," in first else None, comments="*")
    except ValueError as error:
        raise MatrixError(f"not a matrix of Abaqus: {in_one_line(error)}") from error
    if table.shape[1] not in (3, 5):
        raise MatrixError(
            "expected rows 'node, dof, node, dof, value' or 'row, column, value' of Abaqus, or "
            f"Matrix Market, found {table.shape[1]} columns"
        )
    given = table[:, :-1]
    wrong = ~((given >= 1.0) & (given <= MAX_LABEL) & (given % 1.0 == 0.0)).all(axis=1)
    if wrong.any():
        raise MatrixError(
            f"expected labels, dofs and rows from 1 on, found {table[wrong][0].tolist()}: "
            "internal nodes are not read"
        )
    labels = given.astype(np.int64)
    if table.shape[1] == 3:
        rows, columns = labels.T - 1
        return MatrixFile(path.name, _coo(table[:, -1], rows, columns, int(labels.max())))
    pairs = np.concatenate([labels[:, :2], labels[:, 2:]])
    dofs, number = numbered(pairs)
    rows, columns = np.split(number, 2)
    return MatrixFile(path.name, _coo(table[:, -1], rows, columns, len(dofs)), dofs)


def _calculix(path: Path, _: tuple[str, ...]) -> MatrixFile:
    """A triangle of CalculiX, "row column value" from 1 on, of which a .dof file tells the dofs.

    Source: CalculiX CrunchiX User's Manual, *FREQUENCY, SOLVER=MATRIXSTORAGE.
    """
    require_text(path)
    try:
        table = load_rows(path)
    except ValueError as error:
        raise MatrixError(f"not a matrix of CalculiX: {in_one_line(error)}") from error
    if table.shape[1] != 3 or not len(table):
        raise MatrixError(
            f"expected rows 'row column value' of CalculiX, found {table.shape[1]} columns"
        )
    rows, columns = (whole_numbers(table[:, i], "rows and columns") - 1 for i in (0, 1))
    if min(rows.min(), columns.min()) < 0 or max(rows.max(), columns.max()) >= MAX_LABEL:
        raise MatrixError("expected rows and columns from 1 on, found others")
    n = int(max(rows.max(), columns.max())) + 1
    return MatrixFile(path.name, _coo(table[:, 2], rows, columns, n), dofs_file=".dof")


def _coo(values: Any, rows: IntArray, columns: IntArray, n: int) -> Any:
    return sp.coo_array((values, (rows, columns)), shape=(n, n))


def _op4(path: Path, names: tuple[str, ...]) -> MatrixFile:
    from .op4 import read_op4

    return MatrixFile(path.name, read_op4(path, names), named=True, by_label=True)


def _op2(path: Path, names: tuple[str, ...]) -> MatrixFile:
    from .op2 import read_op2

    return MatrixFile(path.name, read_op2(path, names), named=True, by_label=True)


def _full(path: Path, names: tuple[str, ...]) -> MatrixFile:
    from .ansys_full import read_full

    full = read_full(path)
    full.require_free()
    entries = full.K if names is STIFFNESS_NAMES else full.M
    return MatrixFile(path.name, entries, full.dofs, named=True)


def _dmig(path: Path, names: tuple[str, ...]) -> MatrixFile:
    from .dmig import read_dmig

    entries, dofs = read_dmig(path, names)
    return MatrixFile(path.name, entries, dofs, named=True)


_READERS: dict[str, Callable[[Path, tuple[str, ...]], MatrixFile]] = {
    ".npz": _npz,
    ".mtx": _mtx,
    ".sti": _calculix,
    ".mas": _calculix,
    ".op4": _op4,
    ".op2": _op2,
    ".pch": _dmig,
    ".dmig": _dmig,
    ".full": _full,
}
"""By suffix."""
