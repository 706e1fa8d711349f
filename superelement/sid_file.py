"""Files of Standard Input Data (.SID_FEM): one line for each number that is not zero.

As other programs write them: entries m0(row, column) and m1(row, coordinate, column) of each
matrix, with exponents of D. Source: as in sid.py.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ..files.arrays import Array
from .sid import NodeFrame, StandardInputData, Taylor

_MATRICES = ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "ksigma", "Ke", "De")
_OF_FRAMES = ("origin", "phi", "psi", "AP")
_ZERO, _DIAGONAL, _FULL = 0, 1, 3
"""What `structure` says of m0."""
_STEP = 5  # letters of indentation
_VALUE_COLUMN = 48


def write_sid(sid: StandardInputData, remark: str, path: Path) -> None:
    """Write the data into one file; the first line has the remark.

    Frames have numbers, 1, 2, ..., and their names in the remark.
    """
    names = ", ".join(f"{i} {frame.name}" for i, frame in enumerate(sid.frames, 1))
    with path.open("w", encoding="utf-8", newline="\n") as file:
        counts = f"{len(sid.frames):5d}{sid.n_q:5d}    :No. nodes, No. modes"
        file.write(f"{counts}: {sid.name}: {names}; {remark}\n")
        file.writelines(line.rstrip() + "\n" for line in _part(sid))


def _part(sid: StandardInputData) -> Iterator[str]:
    yield " part"
    yield _keyed(1, "new modal", "")
    yield _line(2, "refmod")
    yield _keyed(3, "mass", _number(sid.mass))
    yield _keyed(3, "nelastq", f"{sid.n_q:5d}")
    for k, words in enumerate(sid.coordinates, 1):
        yield _keyed(3, f"ielastq ({k:4d})", f" {words}")
    yield _line(2, "end refmod")
    yield _line(2, "frame")
    for number, frame in enumerate(sid.frames, 1):
        yield from _node(number, frame, sid.n_q)
    yield _line(2, "end frame")
    for name in _MATRICES:
        yield from _matrix(2, name, getattr(sid, name), sid.n_q)
    yield _line(1, "end modal")
    yield " end part"


def _node(number: int, frame: NodeFrame, n_q: int) -> Iterator[str]:
    yield _keyed(3, "new node", f"{number:5d}")
    yield _keyed(4, "rframe", " body ref")
    for name in _OF_FRAMES:
        yield from _matrix(4, name, getattr(frame, name), n_q)
    yield _line(3, "end node")


def _matrix(depth: int, name: str, matrix: Taylor, n_q: int) -> Iterator[str]:
    m0, m1 = matrix.m0, matrix.m1
    rows, columns = m0.shape
    yield _line(depth, name)
    for key, value in {
        "order": 0 if m1 is None else 1,
        "nrow": rows,
        "ncol": columns,
        "nq": n_q,
        "nqn": 0,
        "structure": _structure(m0, m1),
    }.items():
        yield _keyed(depth + 1, key, f"{value:5d}")
    for i, j in np.argwhere(m0):
        yield _keyed(depth + 1, f"m0({i + 1:4d},{j + 1:4d})", _number(m0[i, j]))
    if m1 is not None:
        for j, i, k in np.argwhere(m1.transpose(2, 0, 1)):
            index = f"m1({i + 1:4d},{k + 1:4d},{j + 1:4d})"
            yield _keyed(depth + 1, index, _number(m1[i, k, j]))
    yield _line(depth, f"end {name}")


def _structure(m0: Array, m1: Array | None) -> int:
    if m1 is None and not m0.any():
        return _ZERO
    square = m0.shape[0] == m0.shape[1]
    diagonal = m1 is None and square and not (m0 - np.diag(np.diag(m0))).any()
    return _DIAGONAL if diagonal else _FULL


def _number(value: float) -> str:
    return f"{value:18.11E}".replace("E", "D")


def _line(depth: int, text: str) -> str:
    return f" {' ' * (_STEP * depth)}{text}"


def _keyed(depth: int, key: str, value: str) -> str:
    return f"{_line(depth, key):{_VALUE_COLUMN}}={value}"
