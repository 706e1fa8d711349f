"""Bodies made by chance: their mesh and body files, and the same as a `DenseBody`."""

import json
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from .dense_body import DenseBody, arms
from .dense_elements import KINDS, Beam, Solid, line, rule

STEEL = {"E": 2.1e11, "nu": 0.3, "rho": 7800.0}
RUBBER = {"E": 5e6, "nu": 0.4999, "rho": 1100.0}
FOAM = {"E": 2e5, "nu": 0.05, "rho": 60.0}
WOOD = {"E": [12e9, 0.9e9, 0.5e9], "nu": [0.4, 0.5, 0.6], "G": [0.8e9, 0.7e9, 0.05e9], "rho": 500.0}
MATERIALS = {"steel": STEEL, "rubber": RUBBER, "foam": FOAM, "wood": WOOD}
FACETS = {3: 2, 6: 9, 4: 3, 8: 16, 9: 10}
"""Gmsh's number of a facet by its number of nodes."""
_SIDES = {3: [(0, 1), (1, 2), (2, 0)], 4: [(0, 1), (1, 2), (2, 3), (3, 0)]}
_CELL_SPLITS = {
    "tet": [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)],
    "wed": [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)],
    "hex": [tuple(range(8))],
}
_CORNERS = np.array([(i, j, k) for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))])
_FACES = {
    "tet": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
    "wed": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "hex": [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)],
}


@dataclass
class Trial:
    """A body file at `path`, what it should make, and what was chosen for it."""

    path: Path
    dense: DenseBody
    damping: dict
    chosen: dict


def elasticity(material):
    """C (6, 6) [Pa]"""
    E, nu = np.broadcast_to(material["E"], 3), np.broadcast_to(material["nu"], 3)
    G = material.get("G") or [material["E"] / (2.0 * (1.0 + material["nu"]))] * 3
    S = np.diag([*(1.0 / E), 1.0 / G[2], 1.0 / G[1], 1.0 / G[0]])
    for value, i, j in zip(nu, (0, 0, 1), (1, 2, 2), strict=True):
        S[i, j] = S[j, i] = -value / E[i]
    C = np.linalg.inv(S)
    if "axes" not in material:
        return C
    one, two = map(np.array, material["axes"])
    third = np.cross(one, two)
    R = np.array([one, np.cross(third, one), third])
    R /= np.linalg.norm(R, axis=1)[:, None]
    place = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
    tensor = np.einsum("ia,jb,kc,ld,ijkl->abcd", R, R, R, R, C[place[:, :, None, None], place])
    i, j = np.array([(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]).T
    return tensor[i[:, None], j[:, None], i, j]


def damping_of(rng, f, allowed=("none", "modal", "rayleigh", "loss")):
    """[damping] of a body whose first frequency is about f [Hz]."""
    kind = rng.choice(allowed)
    if kind == "modal":
        return {"modal": {"frequencies": [f, 5 * f], "ratios": [0.01, 0.03]}}
    if kind == "rayleigh":
        return {"rayleigh": {"mass": 0.2 * f, "stiffness": 0.001 / f}}
    if kind == "loss":
        return {"loss_factor": float(rng.choice([0.02, 0.1])), "band": [0.1 * f, 50 * f]}
    return {}


# Solids


def random_solid(folder, kind, seed):
    """A box of 2 to 3 elements a side, distorted, sheared, twisted and turned; faces x = 0, x = 1,
    and one element of the face z = 1, are groups.
    """
    rng = np.random.default_rng(seed)
    family = kind[:3]
    n = np.array([rng.integers(2, 4), 2, rng.integers(1, 3)])
    if kind in ("hex20", "hex27"):
        n = np.minimum(n, 2)
    size = np.array([rng.uniform(1.0, 3.0), 1.0, rng.uniform(0.4, 1.0)]) * rng.uniform(0.05, 0.5)
    grid = np.array(list(product(*(range(m + 1) for m in n))))
    moved = grid + rng.uniform(-0.15, 0.15, grid.shape) * ((grid > 0) & (grid < n))
    A = np.eye(3) + 0.15 * rng.standard_normal((3, 3))
    turn, away = Rotation.random(random_state=seed).as_matrix(), rng.uniform(-1.0, 1.0, 3)
    twist = rng.uniform(0.0, 0.5)

    def place(x):
        angle = twist * x[:, 0] / n[0]
        c, s, (_, y, z) = np.cos(angle), np.sin(angle), (x / n - 0.5).T
        x = np.stack([x[:, 0] / n[0], c * y - s * z, s * y + c * z], axis=1) * size
        return x @ A.T @ turn.T + away

    number = {tuple(g): i for i, g in enumerate(grid)}
    corners = []
    for cell in product(*(range(m) for m in n)):
        eight = [number[tuple(np.array(cell) + corner)] for corner in _CORNERS]
        corners += [tuple(eight[i] for i in part) for part in _CELL_SPLITS[family]]
    # nodes by the corners whose mean they are
    nodes, cells = {(i,): i for i in range(len(grid))}, []
    for corner in corners:
        keys = [tuple(sorted(corner[i] for i in group)) for group in KINDS[kind].groups]
        cells.append([nodes.setdefault(key, len(nodes)) for key in keys])
    before = np.array([moved[list(key)].mean(axis=0) for key in nodes])
    points, cells = place(before), np.array(cells)
    if kind == "tet10" and rng.random() < 0.5:  # straight sides
        points = np.array([place(moved)[list(key)].mean(axis=0) for key in nodes])

    def facets(on):
        """Nodes of faces whose corners are all on a part of the boundary."""
        found = []
        for corner in corners:
            for face in _FACES[family]:
                at = [corner[i] for i in face]
                if all(on(grid[i]) for i in at):
                    sides = [(at[a], at[b]) for a, b in _SIDES[len(at)]]
                    keys = [(i,) for i in at] + [tuple(sorted(s)) for s in sides] * KINDS[
                        kind
                    ].quadratic
                    if kind == "hex27":
                        keys.append(tuple(sorted(at)))
                    found.append([nodes[key] for key in keys])
        return found

    groups = {
        "root": facets(lambda g: g[0] == 0),
        "tip": facets(lambda g: g[0] == n[0]),
        "side": facets(lambda g: g[2] == n[2] and g[0] <= 1 and g[1] <= 1),
    }
    halves = before[cells].mean(axis=1)[:, 0] > 0.5 * n[0]
    two = rng.random() < 0.3
    names = [str(name) for name in rng.choice(["steel", "rubber", "foam", "wood"], 2)]
    if two:  # of like stiffness, so that neither is rigid beside the other
        names = ["steel", "wood"]
    materials = [dict(MATERIALS[name]) for name in names]
    for material in materials:
        if "G" in material:
            axes = Rotation.random(random_state=seed + 1).as_matrix()
            material["axes"] = [axes[0].tolist(), (axes[1] + 0.3 * axes[0]).tolist()]
    owner = halves.astype(int) if two else np.zeros(len(cells), dtype=int)

    solids = []
    K = np.zeros((3 * len(points), 3 * len(points)))
    M = np.zeros_like(K)
    for cell, of in zip(cells, owner, strict=True):
        material = materials[of]
        soft = material["nu"] == RUBBER["nu"]
        solids.append(Solid(kind, points[cell], elasticity(material), soft))
        at = (3 * cell[:, None] + np.arange(3)).ravel()
        K[np.ix_(at, at)] += solids[-1].K
        M[np.ix_(at, at)] += solids[-1].mass(material["rho"])
    dense = DenseBody(points, K, M, 3)

    interfaces, tied = {}, []
    kinds = dict(zip(("root", "tip", "side"), rng.choice(["average", "rigid"], 3), strict=True))
    kinds["side"] = "average"
    for name in ("root", "tip", "side")[: rng.integers(1, 4)]:
        table = {"group": name, "kind": str(kinds[name])}
        x, dA, N = surface(points, groups[name])
        X = dA @ x / dA.sum()
        if rng.random() < 0.3:
            X = X + 0.1 * size * rng.standard_normal(3)
            table["at"] = X.tolist()
        a = arms(x - X)
        D = np.linalg.solve(
            np.einsum("q,qic,qid->cd", dA, a, a),
            np.einsum("q,qic,qk->cki", dA, a, N).reshape(6, -1),
        )
        dense.frames[name] = (X, D)
        if kinds[name] == "rigid":
            tied.append((name, X, np.unique(groups[name])))
        interfaces[name] = table
    if rng.random() < 0.4:
        own = int(rng.integers(len(grid)))
        if not any(own in nodes_ for _, _, nodes_ in tied):
            interfaces["point"] = {"node": points[own].tolist()}
            D = np.zeros((3, 3 * len(points)))
            D[:, 3 * own : 3 * own + 3] = np.eye(3)
            dense.frames["point"] = (points[own], D)

    sensors = {}
    low = rule(kind, low=True)[0]
    for i in range(2):
        e = int(rng.integers(len(cells)))
        xi = low[:, rng.integers(low.shape[1])]
        material = materials[owner[e]]
        strain = solids[e].strain(xi)
        sensor = {"point": solids[e].place(xi).tolist()}
        if i:
            d = rng.standard_normal(3)
            sensor["direction"] = d.tolist()
            d /= np.linalg.norm(d)
            v = [d[0] ** 2, d[1] ** 2, d[2] ** 2, d[1] * d[2], d[0] * d[2], d[0] * d[1]]
            value = np.array(v)[None] @ strain
        else:
            sensor["stress"] = True
            value = elasticity(material) @ strain
        S = np.zeros((len(value), 3 * len(points)))
        S[:, (3 * cells[e][:, None] + np.arange(3)).ravel()] = value
        name = f"sensor{i}"
        sensors[name], dense.sensors[name] = sensor, S
    dense.tie(tied)
    dense.frames = {name: dense.frames[name] for name in interfaces}

    masses = {}
    if rng.random() < 0.4:
        name = next(iter(interfaces))
        mass = float(0.3 * dense.inertia()[0])
        J = inertia(rng, mass, 0.3 * size.max())
        masses["piece"] = {"interface": name, "mass": mass, "inertia": J.tolist()}
        dense.add_mass(dense.frames[name][1], mass, J)

    f = np.sqrt(dense.modes()[0][0]) / (2.0 * np.pi)
    damping = damping_of(rng, f, ("none", "modal", "rayleigh"))
    sections = {"body": 0, "one": 0, "two": 1}
    parts = [("one", cells[owner == 0]), ("two", cells[owner == 1])] if two else [("body", cells)]
    write_mesh(
        folder / f"{kind}{seed}.msh",
        points,
        [(name, 2, FACETS[len(rows[0])], rows) for name, rows in groups.items()]
        + [(name, 3, KINDS[kind].gmsh, rows) for name, rows in parts],
    )
    made = {f"materials.{name}": materials[sections[name]] for name, _ in parts}
    return _trial(
        folder / f"{kind}{seed}",
        rng,
        dense,
        f,
        damping,
        {**made, **_named("interfaces", interfaces), **_named("masses", masses)}
        | _named("sensors", sensors),
        {"kind": kind, "materials": names if two else names[:1], "masses": len(masses)},
    )


def surface(points, facets):
    """Points x (q, 3), areas (q,) and shapes (q, p) of facets in space."""
    x, dA, N = [], [], []
    for nodes in facets:
        weight, n, dn = _facet(len(nodes))
        X = points[list(nodes)]
        tangents = np.einsum("kdq,ki->dqi", dn, X)
        x.append(n.T @ X)
        dA.append(weight * np.linalg.norm(np.cross(tangents[0], tangents[1]), axis=1))
        spread = np.zeros((len(weight), len(points)))
        spread[:, list(nodes)] = n.T
        N.append(spread)
    return np.concatenate(x), np.concatenate(dA), np.concatenate(N)


def _facet(k):
    """Weights, N (k, q), dN (k, 2, q) of a facet, by polynomials through its nodes."""
    if k in (3, 6):
        corners = np.array([(0, 0), (1, 0), (0, 1.0)])
        xi, weight = get_quadrature(RefTri, 5)
        powers = [p for p in product(range(3), repeat=2) if sum(p) <= (1 if k == 3 else 2)]
    else:
        corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)])
        x, w = line(3)
        xi, weight = np.array(list(product(x, repeat=2))).T, np.outer(w, w).ravel()
        full = 1 if k == 4 else 2
        powers = [p for p in product(range(full + 1), repeat=2) if k != 8 or sum(p) < 4]
    nodes = [*corners]
    if k > 4:
        nodes += [corners[[a, b]].mean(axis=0) for a, b in _SIDES[len(corners)]]
    if k == 9:
        nodes.append(corners.mean(axis=0))
    e = np.array(powers)

    def terms(x, e):
        return np.prod(x.T[:, None, :] ** e[None], axis=2).T

    C = np.linalg.inv(terms(np.array(nodes).T, e)).copy()
    dN = []
    for axis in range(2):
        lower = e.copy()
        lower[:, axis] = np.maximum(e[:, axis] - 1, 0)
        dN.append(C @ (terms(xi, lower) * e[:, axis][:, None]))
    return weight, C @ terms(xi, e), np.stack(dN, axis=1)


def inertia(rng, mass, radius):
    """Of three points beside a center (3, 3)."""
    x = radius * rng.standard_normal((3, 3))
    return mass * (np.sum(x * x) * np.eye(3) - x.T @ x)


# Beams


def random_frame(folder, seed):
    """A random tree of bars in space with a loop or two, several sections, and pieces of mass."""
    rng = np.random.default_rng(seed)
    joints = [np.zeros(3)]
    bars = []
    for _ in range(rng.integers(1, 5)):
        start = int(rng.integers(len(joints)))
        joints.append(joints[start] + rng.uniform(-0.6, 0.6, 3))
        bars.append((start, len(joints) - 1))
    if len(joints) > 3 and rng.random() < 0.5:
        a, b = sorted(rng.choice(len(joints), 2, replace=False).tolist())
        if (a, b) not in bars and (b, a) not in bars:
            bars.append((a, b))
    turn = Rotation.random(random_state=seed).as_matrix()
    joints = np.array(joints) @ turn.T + rng.uniform(-1.0, 1.0, 3)
    sections, points, lines, owner = {}, [*joints], [], []
    for i, (a, b) in enumerate(bars):
        r, m = rng.uniform(0.003, 0.01), rng.uniform(0.5, 2.0)
        wide = rng.uniform(1.0, 3.0)
        E = 2.1e11
        area = m / 7800.0
        section = {
            "EA": E * area,
            "EI_y": E * area * r**2,
            "EI_z": E * area * (wide * r) ** 2,
            "GJ": 0.3 * E * area * r**2,
            "mass_per_length": m,
            "polar_inertia_per_length": m * (1 + wide**2) * r**2,
        }
        if rng.random() < 0.5:
            section["GA_y"], section["GA_z"] = 0.3 * E * area, 0.25 * E * area
        if rng.random() < 0.3:
            section["rotary_inertia_y"], section["rotary_inertia_z"] = m * r**2, 2 * m * r**2
        if rng.random() < 0.7:
            section["orientation"] = rng.standard_normal(3).tolist()
        sections[f"bar{i}"] = section
        parts = int(rng.integers(3, 9))
        chain = [a, *range(len(points), len(points) + parts - 1), b]
        points += [joints[a] + (joints[b] - joints[a]) * j / parts for j in range(1, parts)]
        lines += [(chain[j], chain[j + 1]) for j in range(parts)]
        owner += [f"bar{i}"] * parts
    points, lines = np.array(points), np.array(lines)
    K = np.zeros((6 * len(points), 6 * len(points)))
    M = np.zeros_like(K)
    beams = []
    for pair, name in zip(lines, owner, strict=True):
        beam = Beam(points[pair], sections[name])
        at = (6 * pair[:, None] + np.arange(6)).ravel()
        K[np.ix_(at, at)] += beam.K
        M[np.ix_(at, at)] += beam.M
        beams.append(beam)
    dense = DenseBody(points, K, M, 6)
    own = rng.choice(len(points), min(len(points), int(rng.integers(1, 5))), replace=False)
    interfaces = {}
    for i, node in enumerate(own):
        D = np.zeros((6, 6 * len(points)))
        D[:, 6 * node : 6 * node + 6] = np.eye(6)
        dense.frames[f"i{i}"] = (points[node], D)
        interfaces[f"i{i}"] = {"node": points[node].tolist()}
    masses = {}
    for i in range(rng.integers(0, 3)):
        node = int(rng.integers(len(points)))
        mass = float(rng.uniform(0.05, 1.0))
        J = inertia(rng, mass, 0.03)
        masses[f"m{i}"] = {"node": points[node].tolist(), "mass": mass, "inertia": J.tolist()}
        D = np.zeros((6, 6 * len(points)))
        D[:, 6 * node : 6 * node + 6] = np.eye(6)
        dense.add_mass(D, mass, J)
    e = int(rng.integers(len(lines)))
    beam, xi = beams[e], float(rng.uniform(0.1, 0.9))
    y, z = rng.uniform(-0.004, 0.004, 2)
    place = points[lines[e, 0]] + np.array([xi * beam.L, y, z]) @ beam.axes
    S = np.zeros((1, 6 * len(points)))
    S[0, (6 * lines[e][:, None] + np.arange(6)).ravel()] = beam.strain(xi, y, z)
    dense.sensors["gauge"] = S
    sensors = {"gauge": {"point": place.tolist(), "direction": beam.axes[0].tolist()}}
    f = np.sqrt(dense.modes()[0][0]) / (2.0 * np.pi)
    damping = damping_of(rng, f)
    by_bar = [(f"bar{i}", 1, 1, lines[np.array(owner) == f"bar{i}"]) for i in range(len(bars))]
    write_mesh(folder / f"beam{seed}.msh", points, by_bar)
    return _trial(
        folder / f"beam{seed}",
        rng,
        dense,
        f,
        damping,
        {**_named("sections", sections), **_named("interfaces", interfaces)}
        | _named("masses", masses)
        | _named("sensors", sensors),
        {"kind": "beam", "bars": len(bars), "masses": len(masses)},
    )


# Files


def _named(table, entries):
    return {f"{table}.{name}": entry for name, entry in entries.items()}


def _trial(stem, rng, dense, f, damping, tables, chosen):
    impulse = {"step": 0.01 / f, "steps": 10, "rho_inf": float(rng.choice([0.5, 0.9, 1.0]))}
    impulse["method"] = str(rng.choice(["auto", "krylov"]))
    if impulse["method"] == "krylov":
        impulse |= {"solver": str(rng.choice(["factor", "iterative"])), "tolerance": 1e-7}
    text = [f'name = "{stem.name}"', f'mesh = "{stem.name}.msh"']
    tables = {**tables, "impulse": impulse, "damping": damping}
    for name, table in tables.items():
        text.append(f"[{name}]")
        for key, value in table.items():
            inline = isinstance(value, dict)
            shown = (
                "{" + ", ".join(f"{k} = {json.dumps(v)}" for k, v in value.items()) + "}"
                if inline
                else json.dumps(value)
            )
            text.append(f"{key} = {shown}")
    stem.with_suffix(".toml").write_text("\n".join(text) + "\n")
    chosen = {**chosen, "frames": len(dense.frames), "damping": next(iter(damping), "none")}
    return Trial(stem.with_suffix(".toml"), dense, damping, {**chosen, **impulse, "f": f})


def write_mesh(path, points, parts):
    """Gmsh 2.2; parts: [(group, dimension, type, nodes (n, k))]."""
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(parts))]
    text += [f'{dim} {i} "{name}"' for i, (name, dim, _, _) in enumerate(parts, start=1)]
    text += ["$EndPhysicalNames", "$Nodes", str(len(points))]
    text += [f"{i} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(points.tolist(), start=1)]
    text += ["$EndNodes", "$Elements", str(sum(len(rows) for *_, rows in parts))]
    number = 0
    for i, (_, _, kind, rows) in enumerate(parts, start=1):
        for row in rows:
            number += 1
            text.append(" ".join(map(str, [number, kind, 2, i, i, *(int(n) + 1 for n in row)])))
    path.write_text("\n".join([*text, "$EndElements"]) + "\n")
