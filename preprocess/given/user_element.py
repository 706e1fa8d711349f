"""Matrices of a substructure that Abaqus and CalculiX write as a user element (.mtx).

*USER ELEMENT, NODES=n, LINEAR; comments with the nodes below ** ELEMENT NODES; lists of dofs, the
first of the first node and others headed by the position from which on they hold; *MATRIX,
TYPE=STIFFNESS or MASS with the lower triangle row by row, or with UNSYMM the whole matrix column by
column. Source: Abaqus Keywords Guide, *SUBSTRUCTURE MATRIX OUTPUT, *USER ELEMENT and *MATRIX.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..errors import MatrixError
from ..mesh.mesh import IntArray

_ELEMENT = re.compile(r"\*USER\s*ELEMENT\b", re.IGNORECASE)
_MATRIX = re.compile(r"\*MATRIX\b.*\bTYPE\s*=\s*(\w+)", re.IGNORECASE)
_NODES = re.compile(r"\*\*\s*ELEMENT NODES", re.IGNORECASE)
_NUMBERS = re.compile(r"\*\*[\s\d,]*\d[\s\d,]*")


@dataclass
class _Parts:
    """Items of the lines of a file by what they say: nodes, lists of dofs, values by matrix."""

    elements: int = 0
    nodes: list[str] = field(default_factory=list)
    dofs: list[list[str]] = field(default_factory=list)
    values: dict[str, list[str]] = field(default_factory=dict)
    unsymmetric: set[str] = field(default_factory=set)


def is_user_element(path: Path) -> bool:
    """Whether the first keyword is *USER ELEMENT, in a file of text."""
    with path.open(encoding="utf-8") as file:
        for line in file:
            if line.strip() and not line.startswith("**"):
                return _ELEMENT.match(line) is not None
    return False


def read_user_element(path: Path, kind: str) -> tuple[Any, IntArray]:
    """The matrix (n, n) of a kind, STIFFNESS or MASS, sparse, and label and dof (n, 2) of rows.

    `MatrixError` if it is not there, or does not fit the nodes and dofs.
    """
    parts = _parts(path)
    if parts.elements != 1:
        raise MatrixError(f"expected one *USER ELEMENT, found {parts.elements}")
    if kind not in parts.values:
        raise MatrixError(
            f"expected *MATRIX, TYPE={kind}, found {', '.join(parts.values) or 'none'}"
        )
    dofs = _dofs(parts)
    return sp.coo_array(_matrix(parts, kind, len(dofs))), dofs


def _parts(path: Path) -> _Parts:
    parts, listed, values = _Parts(), False, None
    for line in path.read_text(encoding="utf-8").splitlines():
        # Only comments tell the nodes: *USER ELEMENT itself gives their number alone.
        if line.startswith("**"):
            listed = bool(_NODES.match(line)) or (listed and bool(_NUMBERS.fullmatch(line)))
            if listed and not _NODES.match(line):
                parts.nodes += _items(line[2:])
        elif _ELEMENT.match(line):
            parts.elements, values = parts.elements + 1, None
        elif match := _MATRIX.match(line):
            values = parts.values.setdefault(match[1].upper(), [])
            if re.search(r"\bUNSYMM\b", line, re.IGNORECASE):
                parts.unsymmetric.add(match[1].upper())
        elif line.startswith("*"):
            raise MatrixError(f"expected *USER ELEMENT and *MATRIX, TYPE=..., found {line[:40]!r}")
        elif values is not None:
            values += _items(line)
        elif line.strip():
            parts.dofs.append(_items(line))
    return parts


def _items(line: str) -> list[str]:
    return line.replace(",", " ").split()


def _dofs(parts: _Parts) -> IntArray:
    """The label and dof (n, 2) of every row: the nodes in their order, each with its dofs."""
    nodes = _integers(parts.nodes, "nodes")
    lists = [_integers(items, "dofs") for items in parts.dofs]
    if not (nodes and lists and lists[0]):
        raise MatrixError("expected comments ** ELEMENT NODES with nodes, and dofs, found none")
    # All lists but the first begin with the position from which on they hold.
    starts = [1, *(items[0] for items in lists[1:])]
    if starts != sorted(set(starts)) or starts[-1] > len(nodes):
        raise MatrixError(
            f"expected lists of dofs from ascending positions among {len(nodes)} nodes on, "
            f"found {starts}"
        )
    directions = [lists[0], *(items[1:] for items in lists[1:])]
    counts = [last - first for first, last in pairwise([*starts, len(nodes) + 1])]
    of_each = [dofs for dofs, count in zip(directions, counts, strict=True) for _ in range(count)]
    rows = [(node, i) for node, dofs in zip(nodes, of_each, strict=True) for i in dofs]
    if (wrong := [row for row in rows if row[1] == 0]) or not rows:
        raise MatrixError(f"expected dofs 1 to 6, found {wrong[0] if wrong else 'none'}")
    return np.array(rows, dtype=np.int64)


def _integers(items: Sequence[str], what: str) -> list[int]:
    wrong = [item for item in items if not (item.isascii() and item.isdigit() and len(item) < 18)]
    if wrong:
        raise MatrixError(f"expected integers for {what}, found {wrong[0]!r}")
    return [int(item) for item in items]


def _matrix(parts: _Parts, kind: str, n: int) -> Array:
    """The lower triangle (n, n), or the whole of a matrix that need not be symmetric."""
    values = np.array([float(item.upper().replace("D", "E")) for item in parts.values[kind]])
    whole = kind in parts.unsymmetric
    count = n * n if whole else n * (n + 1) // 2
    if len(values) != count:
        raise MatrixError(
            f"*MATRIX, TYPE={kind}: expected {count} values for the {n} dofs of the nodes, found "
            f"{len(values)}"
        )
    matrix = np.zeros((n, n))
    if whole:
        return np.asarray(values.reshape(n, n).T)
    matrix[np.tril_indices(n)] = values
    return matrix
