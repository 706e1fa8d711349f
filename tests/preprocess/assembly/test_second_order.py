"""Bodies to second order: rigid and averaged interfaces and masses in finite rotation, frame
indifference.
"""

import dataclasses

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess import assemble
from duhamel.preprocess.assembly.rigid import project
from duhamel.preprocess.assembly.second_order import second_order
from duhamel.preprocess.elements.inertia import pairs, scalar_mass
from duhamel.preprocess.sources.reading import read_source
from scipy.spatial.transform import Rotation

from ..differences import matrix_of, refined, six, skew, strain_energy, turning

J = [[3.0, 0.1, 0.2], [0.1, 4.0, -0.1], [0.2, -0.1, 5.0]]
MASSES = {
    "tip": {"interface": "tip", "mass": 20.0, "inertia": J},
    "bolt": {"node": [1, 0, 0], "mass": 40.0},
    "plate": {"group": "root", "mass": 30.0, "inertia": J},
}
AWAY = {"group": "tip", "at": [1.2, 0.1, 0.2]}
SIDE = {"box": {"corners": [[0, 0, 0], [0.8, 0.3, 0]]}}
CHOICES = {
    "average": {"root": {"group": "root"}, "tip": AWAY, "side": SIDE},
    "rigid": {"root": {"group": "root", "kind": "rigid"}, "tip": {**AWAY, "kind": "rigid"}},
    "mixed": {"root": {"group": "root", "kind": "rigid"}, "tip": AWAY, "side": SIDE},
    "node": {"tip": AWAY, "root": {"node": [0, 0, 0]}},
}


def model(body):
    source, structure = read_source(body), assemble(body)
    return source, structure, second_order(structure, source, body)


@pytest.fixture(params=CHOICES)
def solid(request, solid_body, box):
    mesh = box("hexahedron20", size=(1.0, 0.3, 0.2), divisions=(2, 1, 1))
    return model(solid_body(mesh, interfaces=CHOICES[request.param], masses=MASSES))


def elastic(structure, r, size=1.0, seed=0):
    motions = np.random.default_rng(seed).normal(scale=size, size=(structure.n_u, r))
    return project(motions, structure.U, structure.M)


TURN = np.array([0.3, -0.7, 0.5])


def with_rigid(structure, motions):
    """A turn as the first column, and the motions."""
    return np.column_stack([structure.rigid.A[:, 3:] @ TURN, motions])


def test_a_turned_body_has_the_energy_it_had(solid_body, box, kind):
    for choice in ("rigid", "mixed"):
        mesh = box(kind, size=(1.0, 0.3, 0.2), divisions=(3, 2, 2))
        body = solid_body(mesh, interfaces=CHOICES[choice], masses=MASSES)
        _, structure, second = model(body)
        motions = elastic(structure, 3)
        S = turning(structure.nodes, TURN)
        half = motions.T @ (structure.K @ (S @ motions))
        D3 = second.third(with_rigid(structure, motions)[:, :1], motions)[0]
        np.testing.assert_allclose(D3, -half - half.T, rtol=0, atol=1e-12 * np.abs(half).max())


def test_the_third_derivative_is_symmetric(solid):
    _, structure, second = solid
    motions = elastic(structure, 3)
    D3 = second.third(motions, motions)
    for order in ((1, 0, 2), (2, 1, 0), (0, 2, 1)):
        np.testing.assert_allclose(D3.transpose(order), D3, rtol=0, atol=1e-13 * np.abs(D3).max())


def test_turned_frames_turn_as_the_body_does(solid):
    """z'' (U w, c) = S_C P_C c - P_C S c."""
    _, structure, second = solid
    motions = elastic(structure, 3)
    measured = structure.P_C @ motions
    S_C = sp.block_diag(
        [
            sp.block_diag([skew(TURN), 0.5 * skew(TURN)][: 2 if frame.rotations else 1])
            for frame in structure.interfaces
        ]
    )
    expected = S_C @ measured - structure.P_C @ (turning(structure.nodes, TURN) @ motions)
    found = second.measured(with_rigid(structure, motions))[:, 0, 1:]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(measured).max())


def test_the_inertia_of_a_turned_body_turns(solid):
    """F^T U w and Q(U w, c) + F^T S c are those of exp(w~) J exp(-w~)."""
    _, structure, second = solid
    motions = with_rigid(structure, elastic(structure, 3))
    F, W = second.inertia_loads, skew(TURN)

    def turned(d):
        return six(W @ matrix_of(d) - matrix_of(d) @ W)

    first = F.T @ motions
    np.testing.assert_allclose(
        first[:, 0], turned(six(structure.rigid.J_rot)), rtol=0, atol=1e-12 * np.abs(first).max()
    )
    held = dataclasses.replace(second, structure=_immovable(structure))
    Q = held.inertia(motions)[:, 0, 1:] + F.T @ (turning(structure.nodes, TURN) @ motions[:, 1:])
    expected = np.stack([turned(d) for d in first[:, 1:].T], axis=1)
    np.testing.assert_allclose(Q, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def _immovable(structure):
    """A structure so heavy that what is of second order does not move it back."""
    rigid = dataclasses.replace(structure.rigid, mass=1e30, J_rot=1e30 * np.eye(3))
    return dataclasses.replace(structure, rigid=rigid)


class Exact:
    """Finite rotations: nodes on rigid frames, best fits, lumped masses, and mean axes."""

    def __init__(self, source, structure):
        self.source, self.structure = source, structure
        self.center = structure.rigid.center
        self.X = source.nodes.points - self.center
        self.M = scalar_mass(source.matrices()[1])

    def nodes(self, u):
        """Displacements (n, 3) of the nodes of the source."""
        moved = (self.structure.T @ u).reshape(-1, 3)
        for name, frame in self.structure.frames.items():
            if frame.rigid:
                place, w = np.split(self.structure.rows[name] @ u, 2)
                arms = self.source.nodes.points[frame.nodes] - frame.X
                turned = Rotation.from_rotvec(w).apply(arms)
                moved[frame.nodes] = place + turned - arms
        return moved

    def frame(self, attachment, own, u):
        """Displacement and rotation vector (6,) or (3,) of a frame; `own` has the rows of a rigid
        interface.
        """
        if own is not None:
            return own @ u
        moved = self.nodes(u)
        fit = attachment.fit
        if fit is None:
            return attachment.rows @ moved.ravel()
        H = moved[attachment.nodes].T @ fit.y + fit.x.T @ fit.y  # sum (x + u) x^T
        left, _, right = np.linalg.svd(H)
        R = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
        mean = attachment.rows[:3] @ moved.ravel() - np.cross(
            attachment.rows[3:] @ moved.ravel(), attachment.X - fit.middle
        )
        arm = attachment.X - fit.middle
        return np.concatenate([mean + R @ arm - arm, Rotation.from_matrix(R).as_rotvec()])

    def own(self, name):
        frames = self.structure.frames
        return self.structure.rows[name] if name in frames and frames[name].rigid else None

    def masses(self, u):
        """Mass, inertia, place, displacement and rotation vector of lumped masses."""
        for name, values in MASSES.items():
            attachment = self.structure.masses[name]
            motion = self.frame(attachment, self.own(values.get("interface")), u)
            w = motion[3:] if len(motion) == 6 else np.zeros(3)
            j = np.array(values.get("inertia", np.zeros((3, 3))))
            yield values["mass"], j, attachment.X - self.center, motion[:3], w

    def momenta(self, u):
        """What elastic motion has none of: sum m u, and sum m X x u + j w, of the linear mass."""
        moved = self.nodes(u)
        total = np.concatenate(
            [(self.M @ moved).sum(axis=0), np.cross(self.X, self.M @ moved).sum(axis=0)]
        )
        for mass, j, X, v, w in self.masses(u):
            total += np.concatenate([mass * v, mass * np.cross(X, v) + j @ w])
        return total

    def moved_back(self, u):
        """The rigid motion (6,) that takes the momenta away, to second order."""
        rigid = self.structure.rigid
        p, spin = np.split(self.momenta(u), 2)
        return -np.concatenate([p / rigid.mass, np.linalg.solve(rigid.J_rot, spin)])

    def interfaces(self, u):
        parts = [self.frame(f, self.own(name), u) for name, f in self.structure.frames.items()]
        rigid = self.structure.P_C @ (self.structure.rigid.A @ self.moved_back(u))
        return np.concatenate(parts) + rigid

    def pieces(self, u):
        """Mass matrix, inertia, positions and orientation of nodes and masses, moved back."""
        c, theta = np.split(self.moved_back(u), 2)
        R = Rotation.from_rotvec(theta).as_matrix()
        yield self.M, np.zeros((3, 3)), c + (self.X + self.nodes(u)) @ R.T, R
        for mass, j, X, v, w in self.masses(u):
            turned = R @ Rotation.from_rotvec(w).as_matrix()
            yield np.array([[mass]]), j, (c + R @ (X + v))[None], turned

    def inertia(self, u):
        total = np.zeros((3, 3))
        for M, j, x, R in self.pieces(u):
            B = x.T @ (M @ x)
            total += np.trace(B) * np.eye(3) - B + R @ j @ R.T
        return six(total)

    def angular(self, u, rate, step=1e-4):
        """The angular momentum, with rates by central differences."""
        total = np.zeros(3)
        before, after = (self.pieces(u + s * rate) for s in (-step, step))
        for (M, j, x, R), (_, _, y, S) in zip(before, after, strict=True):
            omega = Rotation.from_matrix(S @ R.T).as_rotvec()
            spin = 0.5 * (R @ j @ R.T + S @ j @ S.T) @ omega
            total += np.cross(0.5 * (x + y), M @ (y - x)).sum(axis=0) + spin
        return total / (2 * step)


@pytest.fixture
def exact(solid):
    source, structure, _ = solid
    return Exact(source, structure)


def test_interfaces_are_those_of_finite_rotations(solid, exact):
    _, structure, second = solid
    motions = elastic(structure, 2, size=0.1)
    found = second.interfaces(motions)
    for k, j in ((0, 0), (0, 1)):
        expected = refined(exact.interfaces, [motions[:, k], motions[:, j]], 1e-2)
        np.testing.assert_allclose(
            found[:, k, j], expected, rtol=0, atol=1e-6 * np.abs(found).max()
        )


def test_the_inertia_is_that_of_finite_rotations(solid, exact):
    _, structure, second = solid
    motions = elastic(structure, 2, size=0.1)
    found, first = second.inertia(motions), second.inertia_loads.T @ motions
    expected = refined(exact.inertia, [motions[:, 0]], 1e-2)
    np.testing.assert_allclose(first[:, 0], expected, rtol=0, atol=1e-7 * np.abs(first).max())
    for k, j in ((0, 0), (0, 1)):
        expected = refined(exact.inertia, [motions[:, k], motions[:, j]], 1e-2)
        np.testing.assert_allclose(
            found[:, k, j], expected, rtol=0, atol=1e-6 * np.abs(found).max()
        )


def test_the_angular_momentum_is_that_of_finite_rotations(solid, exact):
    _, structure, second = solid
    motions = elastic(structure, 2, size=0.1)
    h = second.gyroscopic(motions)
    for k, j in ((0, 1), (1, 0), (1, 1)):
        found = refined(lambda u, j=j: exact.angular(u, motions[:, j]), [motions[:, k]], 1e-2)
        np.testing.assert_allclose(h[:, k, j], found, rtol=0, atol=1e-5 * np.abs(h).max())


def test_the_energy_with_rigid_frames_is_that_of_finite_rotations(solid, exact):
    source, structure, second = solid
    motions = elastic(structure, 3, size=0.1)
    owners = source.materials.owners
    energy = strain_energy(source.mesh, source.materials.values, owners)
    D3 = second.third(motions, motions)
    for k, j, m in ((0, 0, 0), (0, 0, 1), (0, 1, 2)):
        columns = [motions[:, i] for i in (k, j, m)]
        expected = refined(lambda u: energy(exact.nodes(u).ravel()), columns, 3e-2)
        assert D3[k, j, m] == pytest.approx(expected, abs=1e-5 * np.abs(D3).max())


def test_no_energy_is_negative(solid):
    """1/2 q K q + D3(q, q, q) / 6 + D4(q, q, q, q) / 8 in modes and what follows at rest."""
    _, structure, second = solid
    K = structure.K.toarray()
    r = 4
    values, vectors = np.linalg.eigh(K)
    motions = vectors[:, 6 : 6 + r]

    others = vectors[:, 6 + r :]

    def solve(loads):
        return others @ ((others.T @ loads) / values[6 + r :, None])

    cubic, quartic = second.cubic(motions), second.quartic(motions, solve)
    for order in ((1, 0, 2, 3), (3, 1, 2, 0), (2, 3, 0, 1)):
        np.testing.assert_array_equal(quartic.transpose(order), quartic)
    directions = np.random.default_rng(2).normal(size=(2000, r))
    a = 0.5 * np.einsum("ik,k,ik->i", directions, values[6 : 6 + r], directions)
    b = np.einsum("klm,ik,il,im->i", cubic, *3 * [directions], optimize=True) / 6
    c = np.einsum("klmn,ik,il,im,in->i", quartic, *4 * [directions], optimize=True) / 8
    assert (c > 0).all()
    # the least of a + b s + c s^2 over all sizes s of the direction
    assert ((a - b**2 / (4 * c)) > -1e-9 * a).all()
    assert (b != 0).any()


def test_loads_of_second_order_strains_are_the_work_of_the_initial_stress(solid):
    """Also where nodes follow rigid frames; and those of quartic energies are the same."""
    _, structure, second = solid
    motions, seen = elastic(structure, 3), []
    second.quartic(motions, lambda loads: seen.append(loads) or 0.0 * loads)
    pair, work = pairs(3), motions.T @ seen[0]
    D3 = second.third(motions, motions)
    for a, b, c in np.ndindex(3, 3, 3):
        found = work[a, pair[b, c]] + work[b, pair[a, c]] + work[c, pair[a, b]]
        assert found == pytest.approx(D3[a, b, c], abs=1e-11 * np.abs(D3).max())


def test_a_mass_of_local_axes_tells_nothing():
    M_s = sp.csr_array(np.array([[2.0, 1.0], [1.0, 2.0]]))
    M = sp.kron(M_s, sp.eye_array(3), format="csc")
    assert abs(scalar_mass(M) - M_s).max() == 0.0
    assert scalar_mass(M + sp.diags_array([1.0, 0, 0, 0, 0, 0])) is None
    coupled = sp.csc_array((np.ones(2), ([0, 1], [1, 0])), shape=(6, 6))
    assert scalar_mass(M + coupled) is None
