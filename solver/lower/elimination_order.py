"""The pattern of the iteration matrix: the order of elimination, and the location of each block.

Nodes are bodies (six rigid coordinates, then their active interface dofs) and couplings (their
rows). Bodies are eliminated from the leaves of a forest, grown from the ground along the joints, to
its roots; a joint goes after the body that hangs on it, when its pivot -B M^-1 B^T, M the
articulated inertia, is regular whatever else moves; a joint that closes a loop, after the body in
which the branches of the loop meet, and so does a coupler of several joints. Springs, whose pivot
is 1, go first and fill nothing. So the cost is linear in the number of bodies, and cubic in the
loops that lie in one another alone.
"""

from collections import deque
from collections.abc import Iterator, Mapping, Sequence, Set
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Index, as_index
from ..step.system import Couplings, Elastic, Frames, Pattern

GROUND = -1
EMPTY: Mapping[int, Set[int]] = MappingProxyType({})
"""no couplers"""


class Edge(NamedTuple):
    """A coupling between two bodies; `GROUND` for what is fixed in space."""

    coupling: int
    a: int
    b: int
    spring: bool


class Node(NamedTuple):
    """A body or a coupling, by its number among its kind."""

    is_body: bool
    number: int


def lay_out_pattern(
    n_bodies: int, frames: Frames, couplings: Couplings, elastic: Elastic
) -> Pattern:
    """Order the nodes, find the blocks that fill, and lay all of them out in one array."""
    edges = _edges(frames, couplings)
    couplers = _couplers(frames, couplings)
    order = elimination_order(n_bodies, edges, couplers)
    position = {node: k for k, node in enumerate(order)}
    body_size = np.full(n_bodies, 6)
    body_size[elastic.body] += np.diff(elastic.active_range)
    row_count = np.diff(couplings.range)
    size = [int((body_size if node.is_body else row_count)[node.number]) for node in order]
    body = [position[Node(True, b)] for b in range(n_bodies)]
    cliques = [
        [position[Node(False, e.coupling)], *(body[b] for b in {e.a, e.b} - {GROUND})]
        for e in edges
    ]
    cliques += [
        [position[Node(False, j)], *(body[b] for b in bodies - {GROUND})]
        for j, bodies in couplers.items()
    ]
    layout = _Layout(size, _fill(len(order), cliques))

    coupling = np.full(len(row_count), -1)
    coupling_block = np.full((len(row_count), 7, 2), -1)
    force_blocks = {(k, k) for k in body}

    def blocks_of(j: int, numbers: tuple[int, int]) -> Iterator[tuple[int, tuple[int, int]]]:
        """The blocks of node j and two bodies, by their places in `coupling_block`."""
        a, b = (None if n == GROUND else body[n] for n in numbers)
        for n, (i, k) in enumerate([(a, b), (b, a), (a, j), (j, a), (b, j), (j, b), (j, j)]):
            if i is not None and k is not None:
                yield n, layout.block(i, k)
                if i != j:
                    force_blocks.add((i, k))

    for edge in edges:
        j = coupling[edge.coupling] = position[Node(False, edge.coupling)]
        for n, block in blocks_of(j, (edge.a, edge.b)):
            coupling_block[edge.coupling, n] = block
    terms = couplings.terms
    term_block = np.full((len(terms.row), 6, 2), -1)
    for t, row in enumerate(terms.row.tolist()):
        j = int(coupling[np.searchsorted(couplings.range, row, side="right") - 1])
        pair = frames.body[terms.rows.frame_a[t]], frames.body[terms.rows.frame_b[t]]
        for n, block in blocks_of(j, (int(pair[0]), int(pair[1]))):
            if n < 6:
                term_block[t, n] = block
    owner = {k: b for b, k in enumerate(body)}
    updates = [layout.update(k, i) for k in range(len(order)) for i in layout.later[k]]
    return Pattern(
        size=as_index(size),
        first=_ranges(size),
        width=as_index(layout.width),
        row=as_index(layout.row),
        lower=as_index(layout.lower),
        later_range=_ranges([len(nodes) for nodes in layout.later]),
        later=as_index([i for nodes in layout.later for i in nodes]),
        segment_range=_ranges([len(segments) for segments in updates]),
        segment=_table([segment for segments in updates for segment in segments], 4),
        n_numbers=layout.n_numbers,
        body=as_index(body),
        coupling=as_index(coupling),
        body_block=_table([layout.block(k, k) for k in body], 2),
        coupling_block=coupling_block,
        term_block=term_block,
        force_block=_table(
            [(owner[i], *layout.block(i, k), size[k]) for i, k in sorted(force_blocks)], 4
        ),
    )


def elimination_order(
    n_bodies: int, edges: Sequence[Edge], couplers: Mapping[int, Set[int]] = EMPTY
) -> list[Node]:
    """Springs, then bodies from the leaves to the roots, each before its joints.

    Those are the joints that its elimination leaves regular. couplers: bodies of the couplings that
    are between several pairs; they follow the body in which the branches of all of them meet.
    """
    forest = _grow(n_bodies, [edge for edge in edges if edge.coupling not in couplers])
    joints_after: dict[int, list[int]] = {b: [] for b in (*forest, GROUND)}
    hanging = {joint: b for b, (_, joint) in forest.items() if joint is not None}
    for edge in edges:
        if not edge.spring and edge.coupling not in hanging:
            bodies = couplers.get(edge.coupling, {edge.a, edge.b})
            joints_after[_meeting(bodies, forest)].append(edge.coupling)
    for joint, b in hanging.items():
        joints_after[b].append(joint)
    order = [Node(False, edge.coupling) for edge in edges if edge.spring]
    for b in (*reversed(forest), GROUND):
        if b != GROUND:
            order.append(Node(True, b))
        order += [Node(False, joint) for joint in joints_after[b]]
    return order


def _edges(frames: Frames, couplings: Couplings) -> list[Edge]:
    """The couplings that have rows left."""
    rows = couplings.rows
    return [
        Edge(
            j,
            int(frames.body[rows.frame_a[i]]),
            int(frames.body[rows.frame_b[i]]),
            bool(couplings.compliant[i]),
        )
        for j, (i, end) in enumerate(
            zip(couplings.range[:-1].tolist(), couplings.range[1:].tolist(), strict=True)
        )
        if i < end
    ]


def _couplers(frames: Frames, couplings: Couplings) -> dict[int, set[int]]:
    """The couplings with terms between other frames than their own, and the bodies of each."""
    rows, terms, body = couplings.rows, couplings.terms, frames.body
    bodies: dict[int, set[int]] = {}
    for t in np.flatnonzero(terms.own < 0).tolist():
        i = int(terms.row[t])
        j = int(np.searchsorted(couplings.range, i, side="right")) - 1
        of_row = body[rows.frame_a[i]], body[rows.frame_b[i]]
        of_term = body[terms.rows.frame_a[t]], body[terms.rows.frame_b[t]]
        bodies.setdefault(j, set()).update(map(int, (*of_row, *of_term)))
    return bodies


def _grow(n_bodies: int, edges: Sequence[Edge]) -> dict[int, tuple[int, int | None]]:
    """Parent of every body and the joint that it hangs on, in the order in which they are reached.

    Joints lead first, springs where there are none; a body that nothing reaches is a root.
    """
    neighbors: dict[int, list[tuple[int, Edge]]] = {b: [] for b in range(GROUND, n_bodies)}
    for edge in edges:
        neighbors[edge.a].append((edge.b, edge))
        neighbors[edge.b].append((edge.a, edge))
    forest: dict[int, tuple[int, int | None]] = {}
    reached = deque([GROUND])
    sprung: deque[tuple[int, int]] = deque()
    unreached = iter(range(n_bodies))
    while len(forest) < n_bodies or reached:
        if not reached:
            b, parent = sprung.popleft() if sprung else (next(unreached), GROUND)
            if b in forest:
                continue
            forest[b] = (parent, None)
            reached.append(b)
        b = reached.popleft()
        for other, edge in neighbors[b]:
            if other == GROUND or other in forest:
                continue
            if edge.spring:
                sprung.append((other, b))
            else:
                forest[other] = (b, edge.coupling)
                reached.append(other)
    return forest


def _meeting(bodies: Set[int], forest: dict[int, tuple[int, int | None]]) -> int:
    """The last common ancestor of bodies."""
    first, *others = bodies
    path = _path(first, forest)
    for b in others:
        ancestors = set(_path(b, forest))
        path = [a for a in path if a in ancestors]
    return path[0]


def _path(b: int, forest: dict[int, tuple[int, int | None]]) -> list[int]:
    """A body and its ancestors, the ground last."""
    path = [b]
    while path[-1] != GROUND:
        path.append(forest[path[-1]][0])
    return path


def _fill(n: int, cliques: Sequence[Sequence[int]]) -> list[list[int]]:
    """The later nodes whose blocks beside each node are not zero when it is eliminated."""
    later: list[set[int]] = [set() for _ in range(n)]
    for clique in cliques:
        for k in clique:
            later[k].update(i for i in clique if i > k)
    for nodes in later:
        if nodes:
            nearest = min(nodes)
            later[nearest] |= nodes - {nearest}
    return [sorted(nodes) for nodes in later]


class _Layout:
    """Locations of blocks: of each node its rows, diagonal block first, then those below."""

    def __init__(self, size: Sequence[int], later: list[list[int]]) -> None:
        self.size, self.later = size, later
        self.column: list[dict[int, int]] = []
        self.width: list[int] = []
        self.row: list[int] = []
        self.lower: list[int] = []
        self.n_numbers = 0
        for k, nodes in enumerate(later):
            starts = np.cumsum([0, size[k], *(size[i] for i in nodes)]).tolist()
            self.column.append(dict(zip((k, *nodes), starts, strict=False)))
            self.width.append(starts[-1])
            self.row.append(self.n_numbers)
            self.lower.append(self.n_numbers + size[k] * starts[-1])
            self.n_numbers = self.lower[k] + size[k] * (starts[-1] - size[k])

    def block(self, i: int, k: int) -> tuple[int, int]:
        """The first number of block (i, k) and the distance of its rows."""
        if k >= i:
            return self.row[i] + self.column[i][k], self.width[i]
        return self.lower[k] + (self.column[k][i] - self.size[k]) * self.size[k], self.size[k]

    def update(self, k: int, i: int) -> list[tuple[int, int, int, int]]:
        """Segments of row i that the elimination of node k changes; adjacent blocks are joined.

        Of each: first number, row distance, source column beside node k, and width.
        """
        segments: list[tuple[int, int, int, int]] = []
        for j in self.later[k]:
            start, stride = self.block(i, j)
            column, width = self.column[k][j], self.size[j]
            if (
                segments
                and segments[-1][0] + segments[-1][3] == start
                and segments[-1][1] == stride
            ):
                start, stride, column, joined = segments.pop()
                width += joined
            segments.append((start, stride, column, width))
        return segments


def _ranges(lengths: Sequence[int]) -> Index:
    return as_index(np.cumsum([0, *lengths]))


def _table(rows: Sequence[Any], columns: int) -> Index:
    return as_index(rows).reshape(-1, columns)
