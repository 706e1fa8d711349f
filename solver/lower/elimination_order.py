"""The pattern of the iteration matrix: the order of elimination, and the location of each block.

Nodes are bodies (six rigid coordinates, then their active interface dofs) and couplings (their
rows). Bodies may be eliminated in any order. A forest, grown from the ground along the joints, says
when the pivot -B M^-1 B^T of the rows of a joint is regular, whatever is eliminated before:

- a joint of the forest, after the body that hangs on it;
- a joint that closes a loop, after the bodies of the loop below the one in which its branches meet,
  and after that one too where it is flexible;
- a coupler, after those of all its pairs of bodies; a spring at once, its pivot is 1.

For let multipliers of the rows before leave no force on the bodies before, the others held. Loops
before connect only branches that hang on the same rigid held body. With their bodies free of
forces, that one is too, since no row does work in a motion of all as one: so the rows would be
redundant.

Among the nodes that may be next, one that fills nothing is taken, or else the one that costs least
(minimum degree). Without loops that is from the leaves to the roots, and nothing fills. Chains of
loops cost in proportion to their number, also those along the ground. Source: P. R. Amestoy, T. A.
Davis, I. S. Duff: An approximate minimum degree ordering algorithm (1996), here with exact degrees.
"""

import heapq
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from itertools import accumulate
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Index, as_index, starts
from ..step.records.couplings import Couplings
from ..step.records.elastic import Elastic
from ..step.records.frames import Frames
from ..step.records.matrix import Pattern

GROUND_NODE = -1
Pairs = Set[tuple[int, int]]
"""of bodies, between which the terms of a coupler are"""
MOST_IN_CLIQUE = 64
"""nodes beside one, of which it is seen whether all are connected"""
NO_COUPLERS: Mapping[int, Pairs] = MappingProxyType({})


class Edge(NamedTuple):
    """A coupling between two bodies; `GROUND_NODE` for what is fixed in space."""

    coupling: int
    a: int
    b: int
    spring: bool


class Node(NamedTuple):
    """A body or a coupling, by its number among its kind."""

    is_body: bool
    number: int


def lay_out_pattern(
    n_bodies: int,
    frames: Frames,
    couplings: Couplings,
    elastic: Elastic,
    islands: Sequence[Sequence[int]] = (),
) -> Pattern:
    """Order the nodes, find the blocks that fill, and lay all of them out in one array.

    islands: groups of bodies whose forces depend on the motion of all in the group.
    """
    edges = _edges(frames, couplings)
    couplers = _couplers(frames, couplings)
    body_size = np.full(n_bodies, 6)
    body_size[elastic.body] += np.diff(elastic.active_range)
    row_count = np.diff(couplings.range)
    size_of = {Node(True, b): n for b, n in enumerate(body_size.tolist())}
    # Couplings whose rows are all redundant have no node.
    size_of |= {Node(False, j): n for j, n in enumerate(row_count.tolist()) if n}
    groups = [[Node(True, b) for b in island] for island in islands]
    order = elimination_order(size_of, edges, couplers, groups)
    position = {node: k for k, node in enumerate(order)}
    size = [size_of[node] for node in order]
    body = [position[Node(True, b)] for b in range(n_bodies)]
    cliques = [
        [position[node] for node in clique] for clique in (*_cliques(edges, couplers), *groups)
    ]
    layout = _Layout(size, _fill(len(order), cliques))

    coupling = np.full(len(row_count), -1)
    coupling_block = np.full((len(row_count), 7, 2), -1)
    force_blocks = {(k, k) for k in body}

    def blocks_of(j: int, numbers: tuple[int, int]) -> Iterator[tuple[int, tuple[int, int]]]:
        """The blocks of node j and two bodies, by their places in `coupling_block`."""
        a, b = (None if n == GROUND_NODE else body[n] for n in numbers)
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
    island_block = []
    for island in islands:
        for i, first in enumerate(island):
            for k, second in enumerate(island):
                pair = body[first], body[second]
                island_block.append((i, k, *layout.block(*pair)))
                force_blocks.add(pair)
    owner = {k: b for b, k in enumerate(body)}
    updates = [layout.update(k, i) for k in range(len(order)) for i in layout.later[k]]
    return Pattern(
        size=as_index(size),
        first=starts(size),
        width=as_index(layout.width),
        row=as_index(layout.row),
        lower=as_index(layout.lower),
        later_range=starts([len(nodes) for nodes in layout.later]),
        later=as_index([i for nodes in layout.later for i in nodes]),
        segment_range=starts([len(segments) for segments in updates]),
        segment=_table([segment for segments in updates for segment in segments], 4),
        n_numbers=layout.n_numbers,
        body=as_index(body),
        coupling=as_index(coupling),
        body_block=_table([layout.block(k, k) for k in body], 2),
        coupling_block=coupling_block,
        term_block=term_block,
        island_block=_table(island_block, 4),
        force_block=_table(
            [(owner[i], *layout.block(i, k), size[k]) for i, k in sorted(force_blocks)], 4
        ),
    )


def elimination_order(
    size: Mapping[Node, int],
    edges: Sequence[Edge],
    couplers: Mapping[int, Pairs] = NO_COUPLERS,
    groups: Sequence[Sequence[Node]] = (),
) -> list[Node]:
    """All nodes, each when its pivot is regular, in an order that costs little.

    size: unknowns of each node. couplers: pairs of bodies of the couplings that are between several
    pairs. groups: of bodies that have blocks with each other in any case.
    """
    n_bodies = sum(node.is_body for node in size)
    forest = _grow(n_bodies, [edge for edge in edges if edge.coupling not in couplers])
    # A body with active dofs can take forces of several rows at once without being held.
    flexible = {node.number for node, n in size.items() if node.is_body and n > 6}
    awaited = _awaited_bodies(edges, couplers, forest, flexible)
    graph = _Graph(size, (*_cliques(edges, couplers), *groups))
    return _cheapest_first(graph, awaited, _from_the_leaves(awaited, forest))


def _cliques(edges: Sequence[Edge], couplers: Mapping[int, Pairs]) -> Iterator[list[Node]]:
    """Nodes between all of which there are blocks: each coupling with its bodies."""
    for edge in edges:
        bodies = {edge.a, edge.b} - {GROUND_NODE}
        yield [Node(False, edge.coupling), *(Node(True, b) for b in sorted(bodies))]
    for j, pairs in couplers.items():
        bodies = {b for pair in pairs for b in pair} - {GROUND_NODE}
        yield [Node(False, j), *(Node(True, b) for b in sorted(bodies))]


def _awaited_bodies(
    edges: Sequence[Edge],
    couplers: Mapping[int, Pairs],
    forest: Mapping[int, tuple[int, int | None]],
    flexible: Set[int],
) -> dict[int, Set[int]]:
    """The bodies after which the pivot of each coupling is regular."""
    hanging = {joint: b for b, (_, joint) in forest.items() if joint is not None}
    awaited: dict[int, Set[int]] = {}
    for edge in edges:
        j = edge.coupling
        if edge.spring:
            awaited[j] = set()
        elif j in hanging:
            awaited[j] = {hanging[j]}
        else:
            pairs = couplers.get(j, {(edge.a, edge.b)})
            awaited[j] = set().union(*(_loop(a, b, forest, flexible) for a, b in pairs))
    return awaited


def _from_the_leaves(
    awaited: Mapping[int, Set[int]], forest: Mapping[int, tuple[int, int | None]]
) -> list[Node]:
    """Bodies from the leaves to the roots, each followed by the couplings whose last one it is.

    Of equal costs the first in this order is taken.
    """
    # The forest is in the order of breadth, roots first: reversed, leaves come first.
    place = {b: k for k, b in enumerate(reversed(list(forest)))}
    after: list[list[int]] = [[] for _ in range(len(forest) + 1)]
    for j, bodies in awaited.items():
        after[max((place[b] + 1 for b in bodies), default=0)].append(j)
    order = [Node(False, j) for j in after[0]]
    for b, k in place.items():
        order.append(Node(True, b))
        order += [Node(False, j) for j in after[k + 1]]
    return order


def _cheapest_first(
    graph: "_Graph", awaited: Mapping[int, Set[int]], by_default: Sequence[Node]
) -> list[Node]:
    """Eliminate node after node: one that may be next, of the least cost, the first of equals."""
    rank = {node: k for k, node in enumerate(by_default)}
    missing = {Node(False, j): len(bodies) for j, bodies in awaited.items()}
    waiting: dict[Node, list[Node]] = {}
    for j, bodies in awaited.items():
        for b in bodies:
            waiting.setdefault(Node(True, b), []).append(Node(False, j))
    cost: dict[Node, int] = {}
    queue: list[tuple[int, int, Node]] = []

    def reckon(nodes: Iterable[Node]) -> None:
        for node in nodes:
            if not missing.get(node):
                cost[node] = graph.cost(node)
                heapq.heappush(queue, (cost[node], rank[node], node))

    reckon(by_default)
    order: list[Node] = []
    while queue:
        expected, _, node = heapq.heappop(queue)
        # heapq cannot change a priority: each change pushes a new entry, and old ones are passed
        # over.
        if cost.get(node) != expected:
            continue  # eliminated, or of another cost since
        del cost[node]
        order.append(node)
        changed = graph.eliminate(node)
        # The rest is a dense matrix: further search would cost time and save nothing.
        if len(changed) == len(graph):  # all are connected: no order costs less
            return order + sorted(changed, key=rank.__getitem__)
        for coupling in waiting.get(node, ()):
            missing[coupling] -= 1
        reckon(changed)
    return order


class _Graph:
    """The nodes that are left, and which of them blocks connect."""

    def __init__(self, size: Mapping[Node, int], cliques: Iterable[Sequence[Node]]) -> None:
        self._size = size
        self._beside: dict[Node, set[Node]] = {node: set() for node in size}
        for clique in cliques:
            for node in clique:
                self._beside[node].update(clique)
        for node, others in self._beside.items():
            others.discard(node)
        self._width = {
            node: size[node] + sum(map(size.__getitem__, others))
            for node, others in self._beside.items()
        }

    def __len__(self) -> int:
        return len(self._beside)

    def cost(self, node: Node) -> int:
        """Products of numbers by which the node is eliminated; 0 if that fills nothing."""
        # All its neighbors are connected already: elimination adds no block.
        if self._is_clique(self._beside[node]):
            return 0
        # Multiplications of an update of rank `size` on a square of `width`.
        return self._size[node] * self._width[node] ** 2

    def eliminate(self, node: Node) -> set[Node]:
        """Connect all nodes beside the node, which goes; they are returned."""
        others = self._beside.pop(node)
        for other in others:
            beside = self._beside[other]
            beside.discard(node)
            new = others - beside
            new.discard(other)
            beside |= new
            self._width[other] += sum(map(self._size.__getitem__, new)) - self._size[node]
        return others

    def _is_clique(self, nodes: Set[Node]) -> bool:
        """Whether all nodes are connected; no, unseen, of more than `MOST_IN_CLIQUE`."""
        return len(nodes) <= MOST_IN_CLIQUE and all(
            len(self._beside[node] & nodes) == len(nodes) - 1 for node in nodes
        )


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


def _couplers(frames: Frames, couplings: Couplings) -> dict[int, set[tuple[int, int]]]:
    """The couplings with terms between other frames than their own, and the pairs of bodies."""
    rows, terms, body = couplings.rows, couplings.terms, frames.body
    pairs: dict[int, set[tuple[int, int]]] = {}
    for t in np.flatnonzero(terms.own < 0).tolist():
        i = int(terms.row[t])
        j = int(np.searchsorted(couplings.range, i, side="right")) - 1
        of_row = int(body[rows.frame_a[i]]), int(body[rows.frame_b[i]])
        of_term = int(body[terms.rows.frame_a[t]]), int(body[terms.rows.frame_b[t]])
        pairs.setdefault(j, set()).update((of_row, of_term))
    return pairs


def _grow(n_bodies: int, edges: Sequence[Edge]) -> dict[int, tuple[int, int | None]]:
    """Parent of every body and the joint that it hangs on, in the order in which they are reached.

    Joints lead first, springs where there are none; a body that nothing reaches is a root.
    """
    neighbors: dict[int, list[tuple[int, Edge]]] = {b: [] for b in range(GROUND_NODE, n_bodies)}
    for edge in edges:
        neighbors[edge.a].append((edge.b, edge))
        neighbors[edge.b].append((edge.a, edge))
    forest: dict[int, tuple[int, int | None]] = {}
    # Breadth first: short branches make loops that wait for few bodies.
    reached = deque([GROUND_NODE])
    sprung: deque[tuple[int, int]] = deque()
    unreached = iter(range(n_bodies))
    while len(forest) < n_bodies or reached:
        if not reached:
            # Only where joints lead no farther: a spring says nothing about pivots.
            b, parent = sprung.popleft() if sprung else (next(unreached), GROUND_NODE)
            if b in forest:
                continue
            forest[b] = (parent, None)
            reached.append(b)
        b = reached.popleft()
        for other, edge in neighbors[b]:
            if other == GROUND_NODE or other in forest:
                continue
            if edge.spring:
                sprung.append((other, b))
            else:
                forest[other] = (b, edge.coupling)
                reached.append(other)
    return forest


def _loop(
    a: int, b: int, forest: Mapping[int, tuple[int, int | None]], flexible: Set[int]
) -> Set[int]:
    """The bodies on the ways from a and b to the one in which they meet, and that if it bends."""
    from_a, from_b = _path(a, forest), set(_path(b, forest))
    meeting = next(body for body in from_a if body in from_b)
    # The symmetric difference: bodies of one way alone, without what both share above the meeting.
    return (set(from_a) ^ from_b) | ({meeting} & flexible)


def _path(b: int, forest: Mapping[int, tuple[int, int | None]]) -> list[int]:
    """A body and its ancestors, the ground last."""
    path = [b]
    while path[-1] != GROUND_NODE:
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
            # Fill goes on to the next node that is eliminated: the elimination tree passes it down.
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
            first = [0, *accumulate(size[node] for node in (k, *nodes))]
            self.column.append(dict(zip((k, *nodes), first, strict=False)))
            self.width.append(first[-1])
            self.row.append(self.n_numbers)
            # Blocks below the diagonal follow the rows of a node, stored by columns of it.
            self.lower.append(self.n_numbers + size[k] * first[-1])
            self.n_numbers = self.lower[k] + size[k] * (first[-1] - size[k])

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


def _table(rows: Sequence[Any], columns: int) -> Index:
    return as_index(rows).reshape(-1, columns)
