"""Records of Newton's matrix (step/elimination.py, step/newton.py)."""

from ...arrays import Array, Index
from ...compiler.struct import Struct, array


class Pattern(Struct):
    """The iteration matrix as blocks, its nodes in the order of elimination.

    The rows of node k hold its diagonal block and those of `later` nodes to its right, side by
    side. Below the diagonal block stand the blocks of the same nodes in its columns.
    lower/elimination_order.py defines nodes. A place is an index of `MatrixWork.S`; a stride is the
    distance of two rows there.
    """

    size: Index = array("n")
    """unknowns of each node"""
    first: Index = array("n_1")
    """first unknown of each node"""
    width: Index = array("n")
    """width of the rows of each node: its own unknowns and those of its later nodes"""
    row: Index = array("n")
    """place of the rows of each node"""
    lower: Index = array("n")
    """place of the blocks below the diagonal of each node, which are as wide as the node"""
    later_range: Index = array("n_1")
    """first entry of each node in `later`"""
    later: Index = array("n_later")
    """later nodes that are coupled with each node"""
    segment_range: Index = array("n_later_1")
    """first segment of each entry of `later`"""
    segment: Index = array("n_segments", 4)
    """segments of the update of a later node: place, stride, column, width"""
    n_numbers: int
    """numbers in all blocks"""
    body: Index = array("n_b")
    """node of each body"""
    coupling: Index = array("n_j")
    """node of each coupling, -1: it has no rows"""
    body_block: Index = array("n_b", 2)
    """place and stride of the diagonal block of each body"""
    coupling_block: Index = array("n_j", 7, 2)
    """place and stride of the blocks (A, B), (B, A), (A, j), (j, A), (B, j), (j, B), (j, j) of
    coupling j and the bodies of its frames A and B"""
    term_block: Index = array("n_terms", 6, 2)
    """place and stride of the blocks (A, B), (B, A), (A, j), (j, A), (B, j), (j, B) of the coupling
    j that a term belongs to and the bodies of its frames A and B"""
    island_block: Index = array("n_island_blocks", 4)
    """blocks between bodies that surfaces couple, island by island: two bodies, by their places in
    the island, place and stride"""
    force_block: Index = array("n_blocks", 4)
    """blocks in the rows of bodies: body, place, stride, width"""


class MatrixWork(Struct):
    """Newton's matrix, its factors and right-hand side."""

    S: Array = array("n_numbers", real=True)
    """numbers of all blocks, or of their factors"""
    pivots: Index = array("n_unknowns")
    """row of its block that each row was exchanged with"""
    rhs: Array = array("n_unknowns")
    """right-hand side, then corrections, in the order of the nodes"""
    force_rows: Array = array("n_force_rows", real=True)
    """copy of the rows of one block that belong to active dofs"""
    current: Index = array(1)
    """1: S holds factors that may be used again"""
    count: Index = array(1)
    """number of times that S was made"""
    status: Index = array("n_j")
    """status of contacts and friction when S was made"""
