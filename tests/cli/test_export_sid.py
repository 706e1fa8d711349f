"""`duhamel export --to sid`: body integrals, their order in the file, and the motion they make."""

from dataclasses import replace
from pathlib import Path

import duhamel as du
import numpy as np
import pytest
import skfem
from duhamel import superelement
from duhamel.cli import app
from duhamel.preprocess import Body, assemble, build, mesh_of
from duhamel.superelement.sid import standard_input_data
from duhamel.superelement.sid_file import write_sid

from .sid_reader import motion, read_sid

STEEL = {"E": 210e9, "nu": 0.3, "rho": 7850.0}
INERTIA = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))  # of the rows of J
SPINS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # of the columns of Oe


def symmetric(six):
    J = np.zeros((3, 3))
    for (i, j), value in zip(INERTIA, six, strict=True):
        J[i, j] = J[j, i] = value
    return J


def by_coordinate(matrix, n_q):
    """The parts (n_q, rows, 3) of Gr or Ge, whose columns are of w1, then w2 and w3."""
    return matrix.m0.reshape(len(matrix.m0), 3, n_q).transpose(2, 0, 1)


def check_orders(m, n_q, rel):
    """What J, Gr and Oe have in common, whatever the shapes, where modes move in one direction.

    J = -int r~r~ dm, Gr_j = -2 int r~ phi_j~ dm: its symmetric part is the change of J, as is Oe.
    """
    Gr = by_coordinate(m["Gr"], n_q)
    scale = np.abs(m["J"].m1).max()
    for j in range(n_q):
        change = symmetric(m["J"].m1[:, j, 0])
        np.testing.assert_allclose(0.5 * (Gr[j] + Gr[j].T), change, atol=rel * scale)
        of_spin = [-change[pair] * (0.5 if pair[0] == pair[1] else 1.0) for pair in SPINS]
        np.testing.assert_allclose(m["Oe"].m0[j], of_spin, atol=1e-9 * scale)


def test_a_file_of_another_program_has_this_order():
    """Its shapes are across the plate, and its masses lumped: moments differ by a per cent."""
    sid = read_sid(Path(__file__).with_name("data") / "cartop.SID_FEM")
    check_orders(sid.matrices, sid.n_q, rel=1e-2)
    # Ct is the integral of phi, and so the change of the first moment.
    np.testing.assert_array_equal(sid.matrices["Ct"].m0.T, sid.matrices["mdCM"].m1[:, :, 0])


@pytest.fixture(scope="module")
def corner():
    """Hexahedra around a corner, all nodes of which are on the surface, with all modes."""
    mesh = skfem.MeshHex.init_tensor([0.0, 0.1, 0.2, 0.25], [0.0, 0.05, 0.15, 0.3], [0.0, 0.04])
    middles = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.restrict(np.flatnonzero((middles[0] > 0.2) | (middles[1] < 0.05)))
    body = Body.model_validate(
        {
            "name": "corner",
            "mesh": mesh_of(mesh),
            "material": STEEL,
            "interfaces": {
                "root": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}},
                "tip": {"node": [0.25, 0.3, 0.04]},
            },
            "impulse": {"step": 1e-6, "steps": 2, "method": "modal"},
            "damping": {"modal": 0.02},
            "rotation": {},
            "recovery": {},
        }
    )
    return body, build(body)


def test_integrals_are_those_over_the_mesh(corner, tmp_path):
    """By the mass M_s of the nodes, which integrates positions and displacements exactly."""
    body, e = corner
    n = len(e.modes.omega)
    write_sid(standard_input_data(e, n), "", tmp_path / "corner.SID_FEM")
    sid = read_sid(tmp_path / "corner.SID_FEM")
    m, structure = sid.matrices, assemble(body)
    M_s = structure.M[::3, ::3].toarray()
    points = structure.nodes.points
    X = e.recovery.points + e.center
    order = [int(np.linalg.norm(X - point, axis=1).argmin()) for point in points]
    np.testing.assert_allclose(X[order], points, atol=1e-12)
    phi = e.recovery.phi[order][:, :, np.argsort(e.modes.omega, kind="stable")]
    assert sid.n_q == n == 3 * len(points) - 6

    def integral(a, b):
        """int a~ b~ dm (3, 3) of fields of the nodes (n, 3)."""
        products = a.T @ M_s @ b
        return products.T - np.trace(products) * np.eye(3)

    r, shapes = points, [phi[:, :, j] for j in range(n)]
    scale = np.sqrt(np.trace(-integral(r, r)))
    np.testing.assert_allclose(symmetric(m["J"].m0[:, 0]), -integral(r, r), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(m["mdCM"].m0[:, 0], M_s.sum(axis=0) @ r, rtol=1e-9)
    Gr, Ge = by_coordinate(m["Gr"], n), by_coordinate(m["Ge"], n)
    # The shapes of [rotation] are the lowest modes and soft shapes: these alone have second order.
    q = e.rotation.T[: e.rotation.n_low].argmax(axis=1)
    q = np.argsort(np.argsort(e.modes.omega, kind="stable"))[q]
    for j in range(n):
        C4 = integral(r, shapes[j])
        np.testing.assert_allclose(Gr[j], -2.0 * C4, atol=1e-7 * scale)
        np.testing.assert_allclose(symmetric(m["J"].m1[:, j, 0]), -C4 - C4.T, atol=1e-7 * scale)
    for j in q:
        for k in q:
            P = shapes[k].T @ M_s @ shapes[j]
            path = np.array([P[1, 2] - P[2, 1], P[2, 0] - P[0, 2], P[0, 1] - P[1, 0]])
            np.testing.assert_allclose(m["Cr"].m1[j, k], path, atol=1e-7)
            np.testing.assert_allclose(Ge[k, j], 2.0 * path, atol=1e-7)
    check_orders(m, n, rel=1e-7)


def test_a_bar_that_stretches_has_the_moments_of_closed_forms(tmp_path):
    """phi = sqrt(2 / m) cos(pi x / L) along x: int x phi dm = -2 sqrt(2 m) L / pi^2."""
    steel = du.Material(**STEEL)
    section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    bar = du.Beam([(x, 0.0, 0.0) for x in np.linspace(0.0, 1.0, 33)], section=section)
    for name, x in (("root", 0.0), ("tip", 1.0)):
        bar.interface(name, (x, 0.0, 0.0))
    bar.rotation(modes=2)
    e = bar.superelement(step=1e-4)
    data = standard_input_data(e, len(e.modes.omega))
    root, tip = (frame.phi.m0 for frame in data.frames)
    along = int(np.flatnonzero(np.abs(tip[0]) > 1e-3)[0])
    frequency = np.sqrt(data.Ke.m0[along, along])
    assert frequency == pytest.approx(np.pi * np.sqrt(210e9 / 7850), rel=1e-3)
    moment = -2.0 * np.sign(root[0, along]) * np.sqrt(2.0 * e.mass) / np.pi**2
    assert data.J.m1[1, along, 0] == pytest.approx(2.0 * moment, rel=1e-3)
    assert data.Oe.m0[along, 2] == pytest.approx(-moment, rel=1e-3)
    # Bending is of unit mass, so that Oe softens it by w^2, beside what stress stiffens.
    bending = int(np.flatnonzero(np.abs(root[1]) > 1e-3)[0])
    # All but the rotary inertia of its sections.
    assert data.Oe.m1[bending, bending, 0] == pytest.approx(-1.0, abs=5e-3)
    assert data.Oe.m1[bending, bending, 1] > 1.0


def half_sine(duration, force):
    return lambda t: np.array(force) * (np.sin(np.pi * t / duration) if t < duration else 0.0)


def test_the_body_moves_as_in_our_own_run(tmp_path):
    """It spins, is pressed and bends: both differ by the third order of the deflection."""
    steel = du.Material(**STEEL)
    section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    beam = du.Beam([(x, 0.0, 0.0) for x in np.linspace(0.0, 1.0, 5)], section=section)
    for name, x in (("root", 0.0), ("tip", 1.0)):
        beam.interface(name, (x, 0.0, 0.0))
    beam.rotation()
    beam.damping(modal=0.05)
    spin = [2.0, 3.0, 80.0]
    loads = {"root": (0.012, [250.0, 30.0, 15.0]), "tip": (0.006, [-250.0, 10.0, -5.0])}
    e = beam.superelement(step=2.5e-5)
    m = du.Mechanism()
    body = m.add(e, name="beam", angular_velocity=spin)
    for name, (duration, force) in loads.items():
        m.add(du.loads.Force(body[name], force, du.signals.HalfSine(1.0, duration)))
    run = m.simulate(0.012)
    rows = slice(0, None, 60)
    ours = np.stack([run[f"beam.{name}"].position[rows] for name in loads], axis=1)
    write_sid(standard_input_data(e, 6), "", tmp_path / "beam.SID_FEM")
    sid = read_sid(tmp_path / "beam.SID_FEM")
    forces = [half_sine(*load) for load in loads.values()]

    def difference():
        found = motion(sid, forces, spin, run.time[rows])
        # Our bodies start with their center of mass at the origin.
        return np.abs(found - e.center - ours).max()

    least = difference()
    for node in sid.nodes:
        node.phi.m1[:] = 0.0
    without_stiffening_by_loads = difference()
    sid.matrices["Oe"].m1[:] = 0.0
    assert least < 5e-6
    assert without_stiffening_by_loads > 4.0 * least
    assert difference() > 20.0 * least


def test_what_a_body_does_not_know_is_said(runner, element, tmp_path):
    """Made by hand: without [rotation], and then without modes."""
    superelement.write(element, tmp_path / "beam.h5")
    asked = ["export", str(tmp_path / "beam.h5"), str(tmp_path), "--to"]
    result = runner.invoke(app, [*asked, "sid", "--modes", "2"])
    assert result.exit_code == 0, result.output
    assert "no [rotation] in the superelement: constant J, no Oe, Gr, Ge" in result.output
    sid = read_sid(tmp_path / "beam.SID_FEM")
    assert "no [rotation]" in (tmp_path / "beam.SID_FEM").read_text().splitlines()[0]
    assert all(matrix.order == 0 for matrix in sid.matrices.values())
    # Two modes and nine static shapes, of which the static compliance is that of all modes.
    shapes = np.vstack([getattr(node, key).m0 for node in sid.nodes for key in ("phi", "psi")])
    K = sid.matrices["Ke"].m0
    assert sid.n_q == 11
    np.testing.assert_allclose(
        shapes[:9] @ np.linalg.solve(K, shapes[:9].T), element.modes.compliance, rtol=1e-8
    )
    assert not shapes[9:].any()  # a point without rotations
    result = runner.invoke(app, [*asked, "craig-bampton", "--modes", "2"])
    assert "--modes go with --to sid, found --to craig-bampton" in clean(result.stderr)
    superelement.write(replace(element, modes=None, recovery=None), tmp_path / "march.h5")
    result = runner.invoke(
        app, ["export", str(tmp_path / "march.h5"), str(tmp_path), "--to", "sid"]
    )
    assert result.exit_code == 1
    assert "expected modes, which impulse.method march does not find" in result.stderr
    assert not (tmp_path / "march.SID_FEM").exists()


def clean(text):
    return " ".join(text.replace("│", "").split())
