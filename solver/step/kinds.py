"""The open set of kinds of rows; rows.py and gaps.py have them."""

from collections.abc import Callable
from typing import Any, TypeVar

from ..compiler.marks import compiled
from .records.couplings import Rows
from .system import Workspace
from .vectors import Vector, row, subtract

ROW_KINDS: list[Any] = []
"""kinds of rows, in the order of their numbers"""
AnyKind = TypeVar("AnyKind", bound=type)


def row_kind(*, length: bool, slips: bool = False) -> Callable[[AnyKind], AnyKind]:
    """Register a kind of row, whose coordinate is a length or else an angle or its sine.

    The class has two compiled functions: `evaluate` returns the coordinate and sets its gradient
    (12,) by (r, theta) of A and B, in space, which is zero before; `add_tangent` adds a factor
    times H. slips: there is no coordinate, but the integral of gradient . V.
    """

    def register(kind: Any) -> Any:
        kind.number, kind.length, kind.slips = len(ROW_KINDS), length, slips
        compiled(kind.evaluate)
        compiled(kind.add_tangent)
        ROW_KINDS.append(kind)
        return kind

    return register


@compiled
def delta_of(rows: Rows, i: int, work: Workspace) -> Vector:
    """r_B - r_A"""
    return subtract(row(work.frames.r, rows.frame_b[i]), row(work.frames.r, rows.frame_a[i]))
