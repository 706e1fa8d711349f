"""What must hold between steps, and is looked at now and then: by whoever takes them."""

from ..arrays import Array, Index
from ..compiler.marks import entry
from .records.couplings import Couplings, Rows
from .rows import evaluate_row
from .system import Workspace
from .vectors import cross, dot, rotate, row

# of q_3^2: below, both branches are the same to rounding
MIN_BRANCH_MEASURE = 1e-6


@entry
def wrong_branch(couplings: Couplings, rows: Index, work: Workspace) -> int:
    """1 + the first of these rows of constant-velocity joints on the wrong branch; 0: none is.

    The constraint e1(A) e2(B) = e2(A) e1(B) holds where one frame is not twisted about the shaft of
    the other, q_3 = 0, and as well where it is turned by half a turn about any axis, q_0 = 0, with
    the quaternion q of B seen from A, for the difference is -4 q_0 q_3.
    """
    for k in range(len(rows)):
        i = rows[k]
        term = couplings.terms.range[i]
        a, b = couplings.rows.frame_a[i], couplings.rows.frame_b[i]
        # The cosines between the axes of A and those of B, each carried by a frame of the row.
        a_1 = rotate(work.frames.D, a, row(couplings.rows.a, i))
        a_2 = rotate(work.frames.D, a, row(couplings.terms.rows.a, term))
        b_1 = rotate(work.frames.D, b, row(couplings.terms.rows.b, term))
        b_2 = rotate(work.frames.D, b, row(couplings.rows.b, i))
        bend = dot(cross(a_1, a_2), cross(b_1, b_2))
        turn = dot(a_1, b_1) + dot(a_2, b_2)
        # The squares of the quaternion by the rotation matrix. At 180 degrees both vanish.
        q_0, q_3 = 0.25 * (1.0 + turn + bend), 0.25 * (1.0 + bend - turn)
        if q_3 > max(q_0, MIN_BRANCH_MEASURE):
            return int(i + 1)
    return 0


@entry
def open_row(rows: Rows, chosen: Index, limits: Array, gradient: Array, work: Workspace) -> int:
    """1 + the place of the first of the chosen rows open beyond its limit [m, rad]; 0: none is.

    gradient: (12,) scratch.
    """
    for k in range(len(chosen)):
        if abs(evaluate_row(rows, chosen[k], 0.0, 0.0, work, gradient)) > limits[k]:
            return k + 1
    return 0
