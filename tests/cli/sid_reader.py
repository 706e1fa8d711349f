"""A reader of Standard Input Data, and the motion of a body of such data, from their definition."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

ENTRY = re.compile(r"(m[01])\(([\d\s,]+)\)")


def read_sid(path):
    """mass, coordinates, nodes and matrices by name; each with m0 (rows, columns) and m1 (rows,
    n_q, columns).
    """
    lines = [line.strip() for line in Path(path).read_text(encoding="utf-8").splitlines()[1:]]
    pairs = iter([tuple(part.strip() for part in line.partition("=")[::2]) for line in lines])
    assert next(pairs)[0] == "part"
    assert next(pairs)[0] == "new modal"
    assert next(pairs)[0] == "refmod"
    sid = SimpleNamespace(nodes=[], matrices={}, coordinates=[])
    for key, value in pairs:
        if key == "end refmod":
            break
        if key == "mass":
            sid.mass = number(value)
        elif key == "nelastq":
            sid.n_q = int(value)
        else:
            assert key.startswith("ielastq"), key
            sid.coordinates.append(value)
    assert len(sid.coordinates) == sid.n_q
    assert next(pairs)[0] == "frame"
    for key, _ in pairs:
        if key == "end frame":
            break
        assert key == "new node", key
        assert next(pairs) == ("rframe", "body ref")
        sid.nodes.append(SimpleNamespace(**matrices(pairs, "end node")))
    sid.matrices = matrices(pairs, "end modal")
    assert next(pairs)[0] == "end part"
    return sid


def matrices(pairs, end):
    found = {}
    for name, _ in pairs:
        if name == end:
            return found
        found[name] = taylor(pairs, name)
    raise AssertionError(f"no {end}")


def taylor(pairs, name):
    head, entries = {}, []
    for key, value in pairs:
        if key == f"end {name}":
            break
        if match := ENTRY.match(key):
            index = tuple(int(part) - 1 for part in match[2].split(","))
            entries.append((match[1], index, number(value)))
        else:
            head[key] = int(value)
    rows, columns, n_q = head["nrow"], head["ncol"], head["nq"]
    m0 = np.eye(rows, columns) if head["structure"] == 4 else np.zeros((rows, columns))
    matrix = {"m0": m0, "m1": np.zeros((rows, n_q, columns))}
    for kind, index, value in entries:
        assert kind == "m0" or head["order"] == 1
        matrix[kind][index] = value
    return SimpleNamespace(**matrix, order=head["order"], structure=head["structure"])


def number(text):
    return float(text.replace("D", "E"))


def at(matrix, q):
    """m0 + sum q_k m1[:, k]."""
    return matrix.m0 + np.einsum("ikj,k->ij", matrix.m1, q)


def by_rates(matrix, qd):
    """sum q'_j of the parts (rows, 3) of Gr or Ge, whose columns are of w1, then w2 and w3."""
    rows, n_q = len(matrix.m0), len(qd)
    return matrix.m0.reshape(rows, 3, n_q) @ qd


def skew(v):
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def motion(sid, forces, spin, times):
    """Positions (times, nodes, 3) of the nodes in space, of a body that starts at its place.

    forces: function of time for each node [N] in space; spin (3,) [rad/s]: at the start.
    """
    m, n_q = SimpleNamespace(**sid.matrices), sid.n_q

    def derivative(t, state):
        R = Rotation.from_quat(state[3:7]).as_matrix()
        w, q, qd = state[10:13], state[13 : 13 + n_q], state[13 + n_q :]
        mc, J_six = at(m.mdCM, q)[:, 0], at(m.J, q)[:, 0]
        xx, yy, zz, xy, xz, yz = J_six
        J = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        Ct, Cr, W = at(m.Ct, q), at(m.Cr, q), skew(w)
        M = np.block(
            [[sid.mass * np.eye(3), skew(mc).T, Ct.T], [skew(mc), J, Cr.T], [Ct, Cr, m.Me.m0]]
        )
        x, y, z = w
        products = np.array([x * x, y * y, z * z, x * y, y * z, x * z])
        h_t = -W @ W @ mc - 2.0 * W @ Ct.T @ qd
        h_r = -W @ J @ w - by_rates(m.Gr, qd) @ w
        h_e = -by_rates(m.Ge, qd) @ w - at(m.Oe, q) @ products - m.Ke.m0 @ q - m.De.m0 @ qd
        for node, force in zip(sid.nodes, forces, strict=True):
            f = R.T @ force(t)
            h_t = h_t + f
            h_r = h_r + np.cross(place(node, q), f)
            h_e = h_e + at(node.phi, q).T @ f
        rates = np.linalg.solve(M, np.concatenate([h_t, h_r, h_e]))
        vector, scalar = 0.5 * state[3:6], 0.5 * state[6]
        turning = np.concatenate([scalar * w + np.cross(vector, w), [-vector @ w]])
        return np.concatenate([state[7:10], turning, R @ rates[:3], rates[3:6], qd, rates[6:]])

    mc = m.mdCM.m0[:, 0]
    # The center of mass is at rest.
    v = -np.cross(spin, mc / sid.mass)
    start = np.concatenate([np.zeros(3), [0.0, 0.0, 0.0, 1.0], v, spin, np.zeros(2 * n_q)])
    solved = solve_ivp(derivative, (0.0, times[-1]), start, "DOP853", times, rtol=1e-7, atol=1e-9)
    assert solved.success, solved.message
    return np.array(
        [
            [
                state[:3] + Rotation.from_quat(state[3:7]).apply(place(node, state[13 : 13 + n_q]))
                for node in sid.nodes
            ]
            for state in solved.y.T
        ]
    )


def place(node, q):
    """The position of a node in the frame of the body, of which phi is the derivative by q."""
    return node.origin.m0[:, 0] + node.phi.m0 @ q + 0.5 * np.einsum("ikl,k,l", node.phi.m1, q, q)
