"""Block elimination against dense elimination, and how its cost grows."""

from types import SimpleNamespace

import numpy as np
import pytest
from duhamel.solver.lower.elimination_order import Edge, Node, elimination_order, lay_out_pattern
from duhamel.solver.step.elimination import factorize, substitute

from .matrices import dense

GROUND = -1


def pattern_of(n_bodies, edges, flexible=()):
    """Couplings as (body, body, rows, spring); `flexible`: bodies with six active dofs."""
    rows = np.array([n for _, _, n, _ in edges], dtype=int)
    owner = np.repeat(np.arange(len(edges)), rows)
    body = np.array([b for a, b, _, _ in edges for b in (a, b)], dtype=int)
    return lay_out_pattern(
        n_bodies,
        SimpleNamespace(body=body),
        SimpleNamespace(
            range=np.cumsum([0, *rows]),
            compliant=np.array([int(edges[j][3]) for j in owner], dtype=int),
            rows=SimpleNamespace(frame_a=2 * owner, frame_b=2 * owner + 1),
            terms=SimpleNamespace(row=np.empty(0, dtype=int), own=np.empty(0, dtype=int)),
        ),
        SimpleNamespace(
            body=np.array(flexible, dtype=int), active_range=6 * np.arange(len(flexible) + 1)
        ),
    )


def random_matrix(pattern, n_bodies, edges, rng):
    """Inertia and stiffness of bodies and between them, gradients of joints, springs: what a
    mechanism has.
    """
    n = pattern.first[-1]
    matrix = np.zeros((n, n))

    def unknowns(k):
        return np.arange(pattern.first[k], pattern.first[k + 1])

    for b in range(n_bodies):
        own = unknowns(pattern.body[b])
        half = rng.normal(size=(len(own), len(own)))
        matrix[np.ix_(own, own)] = half @ half.T + np.eye(len(own))
    for j, (a, b, n_rows, spring) in enumerate(edges):
        if not n_rows:
            continue
        rows = unknowns(pattern.coupling[j])
        ends = [unknowns(pattern.body[c]) for c in {a, b} - {GROUND}]
        for own in ends:
            gradient = rng.normal(size=(n_rows, len(own)))
            matrix[np.ix_(own, rows)] -= gradient.T
            matrix[np.ix_(rows, own)] += gradient
        if spring:
            matrix[rows, rows] += 1.0
        if len(ends) == 2:
            matrix[np.ix_(*ends)] += 0.1 * rng.normal(size=(len(ends[0]), len(ends[1])))
            matrix[np.ix_(*ends[::-1])] += 0.1 * rng.normal(size=(len(ends[1]), len(ends[0])))
    return matrix


def blocks_of(pattern, matrix):
    """The blocks of a matrix, in which nothing may stand elsewhere."""
    numbers = dense(pattern, np.arange(1.0, pattern.n_numbers + 1.0)).astype(int)
    S = np.zeros(pattern.n_numbers)
    S[numbers[numbers > 0] - 1] = matrix[numbers > 0]
    np.testing.assert_array_equal(dense(pattern, S), matrix)
    return S


TOPOLOGIES = {
    "one body": (1, []),
    "free chain": (4, [(0, 1, 5, False), (1, 2, 5, False), (2, 3, 3, False)]),
    "chain from the ground": (
        4,
        [(GROUND, 0, 5, False), (0, 1, 5, False), (2, 1, 5, False), (2, 3, 6, False)],
    ),
    "star": (6, [(GROUND, 3, 5, False), *((3, b, 5, False) for b in (0, 1, 2, 4, 5))]),
    "ground at both ends": (
        3,
        [(GROUND, 0, 5, False), (0, 1, 3, False), (1, 2, 3, False), (2, GROUND, 5, False)],
    ),
    "loop off the ground": (
        4,
        [(GROUND, 0, 3, False), *((b, (b + 1) % 4, 4, False) for b in range(4))],
    ),
    "loops in loops": (
        6,
        [
            (GROUND, 0, 5, False),
            *((b, b + 1, 3, False) for b in range(5)),
            (0, 5, 2, False),
            (1, 4, 2, False),
        ],
    ),
    "springs": (
        4,
        [(0, 1, 6, True), (1, 2, 1, True), (2, 2, 1, True), (GROUND, 0, 3, True), (2, 3, 5, False)],
    ),
    "joint and spring side by side": (
        2,
        [(GROUND, 0, 5, False), (0, 1, 5, False), (1, 0, 1, True)],
    ),
    "two joints on the same bodies": (
        2,
        [(GROUND, 0, 5, False), (0, 1, 2, False), (0, 1, 2, False), (0, 1, 0, False)],
    ),
}


@pytest.mark.parametrize("flexible", [(), (0,)], ids=["rigid", "flexible"])
@pytest.mark.parametrize("name", TOPOLOGIES)
def test_elimination_of_blocks_solves_what_dense_elimination_solves(name, flexible):
    n_bodies, edges = TOPOLOGIES[name]
    assert_solved(n_bodies, edges, flexible, np.random.default_rng(3))


@pytest.mark.parametrize("seed", range(20))
def test_random_mechanisms(seed):
    """Trees with joints of three or five rows, springs, and some loops, numbered at random."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 15))
    numbers = rng.permutation(n)
    parents = [GROUND, *(numbers[rng.integers(0, b)] for b in range(1, n))]
    tree = [
        (int(p), int(b), int(rng.choice([3, 5])), False)
        for p, b in zip(parents, numbers, strict=True)
    ]
    pairs = rng.integers(-1, n, size=(4, 2)).tolist()
    more = [(a, b, 1, bool(rng.integers(2))) for a, b in pairs if a != b]
    edges = [tree[i] for i in rng.permutation(n)] + more
    assert_solved(n, edges, tuple(np.flatnonzero(rng.integers(2, size=n)).tolist()), rng)


def assert_solved(n_bodies, edges, flexible, rng):
    pattern = pattern_of(n_bodies, edges, flexible)
    matrix = random_matrix(pattern, n_bodies, edges, rng)
    S, pivots = blocks_of(pattern, matrix), np.zeros(len(matrix), dtype=np.int64)
    assert factorize(pattern, S, pivots)
    right = rng.normal(size=len(matrix))
    x = right.copy()
    substitute(pattern, S, pivots, x)
    expected = np.linalg.solve(matrix, right)
    np.testing.assert_allclose(
        x, expected, rtol=0, atol=1e-11 * np.linalg.cond(matrix) * np.abs(expected).max()
    )


def test_a_joint_without_effect_is_singular():
    pattern = pattern_of(1, [(GROUND, 0, 3, False)])
    matrix = np.eye(9)
    matrix[6:, 6:] = 0.0
    assert not factorize(pattern, blocks_of(pattern, matrix), np.zeros(9, dtype=np.int64))


def ladder(n):
    """Rods on the ground, and rungs from each to the next: n four-bars side by side."""
    edges = [(GROUND, 2 * k, 5, False) for k in range(n + 1)]
    for k in range(n):
        edges += [(2 * k, 2 * k + 1, 5, False), (2 * k + 1, 2 * k + 2, 2, False)]
    return 2 * n + 1, edges


def tower(n):
    """Four-bars one on another: each stands on the rung of the one before."""
    edges, base = [], GROUND
    for b in range(0, 3 * n, 3):
        edges += [(base, b, 5, False), (b, b + 1, 5, False), (b + 1, b + 2, 5, False)]
        edges.append((b + 2, base, 2, False))
        base = b + 1
    return 3 * n, edges


def scissors(n):
    """Crossed bars, each pair on the ends of the one before."""
    edges = [(GROUND, 0, 5, False), (GROUND, 1, 4, False), (0, 1, 2, False)]
    for b in range(2, 2 * n, 2):
        edges += [(b - 1, b, 5, False), (b - 2, b + 1, 5, False), (b, b + 1, 2, False)]
    return 2 * n, edges


def legs(n):
    """A platform on n legs of two bodies."""
    platform = 2 * n
    edges = []
    for b in range(0, platform, 2):
        edges += [(GROUND, b, 4, False), (b, b + 1, 5, False), (b + 1, platform, 3, False)]
    return platform + 1, edges


def suspended(n):
    """A platform on springs, and on it n four-bars."""
    edges = [(GROUND, 0, 6, True)]
    for b in range(1, 3 * n, 3):
        edges += [(0, b, 5, False), (b, b + 1, 5, False), (b + 1, b + 2, 5, False)]
        edges.append((b + 2, 0, 2, False))
    return 3 * n + 1, edges


def chain(n):
    return n, [(GROUND, 0, 5, False), *((b, b + 1, 5, False) for b in range(n - 1))]


def comb(n):
    _, edges = chain(n)
    return n, edges + [(b, b + 2, 1, False) for b in range(0, n - 2, 3)]


def chain_on_springs(n):
    _, edges = chain(n)
    return n, edges + [(GROUND, b, 6, True) for b in range(n)]


@pytest.mark.parametrize("are_flexible", [False, True], ids=["rigid", "flexible"])
@pytest.mark.parametrize("make", [chain, comb, chain_on_springs, ladder, tower, scissors])
def test_the_numbers_of_a_matrix_grow_with_its_bodies_alone(make, are_flexible):
    """Every body or loop more adds as many as the one before."""

    def numbers(n):
        n_bodies, edges = make(n)
        return pattern_of(n_bodies, edges, tuple(range(n_bodies)) if are_flexible else ()).n_numbers

    assert numbers(121) - numbers(61) == numbers(61 + 120) - numbers(121)


def test_loops_on_a_rigid_body_do_not_fill_one_another():
    numbers = [pattern_of(*suspended(n)).n_numbers for n in (20, 40, 60)]
    assert numbers[2] - numbers[1] == numbers[1] - numbers[0]


def rows_between_bodies(edges, n_bodies, flexible, rng):
    """Gradients of rows about one point of space: no row feels a motion of all bodies as one.

    Those of a flexible body go on over its active dofs.
    """
    columns = np.cumsum([0, *(12 if b in flexible else 6 for b in range(n_bodies))])
    rows = []
    for a, b, n_rows, _ in edges:
        gradient = np.zeros((n_rows, columns[-1]))
        relative = rng.normal(size=(n_rows, 6))
        for body, sign in ((a, -1.0), (b, 1.0)):
            if body != GROUND:
                gradient[:, columns[body] : columns[body] + 6] += sign * relative
                bent = columns[body + 1] - columns[body] - 6
                gradient[:, columns[body] + 6 : columns[body + 1]] += rng.normal(
                    size=(n_rows, bent)
                )
        rows.append(gradient)
    return rows


MECHANISMS = {
    "ladder": ladder(8),
    "tower": tower(6),
    "scissors": scissors(8),
    "platform on springs": suspended(5),
    "platform on six legs": legs(6),
    "loops in loops": TOPOLOGIES["loops in loops"],
    "loop off the ground": TOPOLOGIES["loop off the ground"],
    # the last one would be redundant if the platform did not bend
    "joints of a platform that bends": (
        2,
        [(GROUND, 0, 6, True), (0, 1, 5, False), (0, 1, 4, False), (0, 0, 2, False)],
    ),
}


@pytest.mark.parametrize("flexible", [(), (0,), (1, 3)], ids=["rigid", "first", "others"])
@pytest.mark.parametrize("name", MECHANISMS)
def test_joints_are_eliminated_when_their_pivots_are_regular(name, flexible):
    """Rows that are independent of all that are before, of the bodies before, the others held."""
    n_bodies, edges = MECHANISMS[name]
    if "bends" in name:
        flexible = (0,)
    flexible = [b for b in flexible if b < n_bodies]
    gradients = rows_between_bodies(edges, n_bodies, flexible, np.random.default_rng(5))
    size = {Node(True, b): 12 if b in flexible else 6 for b in range(n_bodies)}
    size |= {Node(False, j): edge[2] for j, edge in enumerate(edges)}
    order = elimination_order(size, [Edge(j, a, b, s) for j, (a, b, _, s) in enumerate(edges)])
    assert sorted(order) == sorted(size)
    columns = np.cumsum([0, *(size[Node(True, b)] for b in range(n_bodies))])
    before, rows = [], []
    for node in order:
        if node.is_body:
            before += range(columns[node.number], columns[node.number + 1])
        elif not edges[node.number][3]:
            rows.append(gradients[node.number])
            values = np.linalg.svd(np.vstack(rows)[:, before], compute_uv=False)
            assert len(values) == sum(map(len, rows))
            assert values[-1] > 1e-6 * values[0], node


def test_a_tree_is_eliminated_from_its_leaves():
    """Springs, then bodies, each followed by the joint that it hangs on: nothing fills."""
    edges = [Edge(0, GROUND, 0, False), Edge(1, 0, 1, False), Edge(2, 0, 2, False)]
    size = {Node(True, b): 6 for b in range(3)} | {Node(False, j): 5 for j in range(4)}
    assert elimination_order(size, [*edges, Edge(3, GROUND, 2, True)]) == [
        Node(False, 3),
        Node(True, 2),
        Node(False, 2),
        Node(True, 1),
        Node(False, 1),
        Node(True, 0),
        Node(False, 0),
    ]
