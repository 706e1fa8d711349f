"""`duhamel export --to craig-bampton`: the same body in other coordinates, for other codes."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel import superelement
from duhamel.cli import app
from duhamel.preprocess import Body, MatrixError, build
from duhamel.superelement import Modes, SuperelementError
from duhamel.superelement.craig_bampton import in_craig_bampton_form
from scipy.linalg import eigh

STEEL = {"E": 210e9, "nu": 0.3, "rho": 7850.0}
INTERFACES = {
    "root": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}},
    "tip": {"node": [0.4, 0.05, 0.03]},
    "middle": {"node": [0.2, 0.0, 0.0]},
}

BAR = {
    "name": "bar",
    "material": STEEL,
    "interfaces": INTERFACES,
    "impulse": {"step": 1e-5, "steps": 10, "method": "modal"},
    "damping": {"modal": 0.02},
}


@pytest.fixture(scope="module")
def bar(tmp_path_factory):
    """A bar of hexahedra with a frame and two points, with some of its modes."""
    import skfem
    from duhamel.preprocess import mesh_of

    mesh = skfem.MeshHex.init_tensor(
        np.linspace(0, 0.4, 5), np.linspace(0, 0.05, 2), np.linspace(0, 0.03, 2)
    )
    path = tmp_path_factory.mktemp("bar") / "bar.h5"
    superelement.write(build(Body.model_validate(BAR | {"mesh": mesh_of(mesh)})), path)
    return path


def frequencies(K, M):
    return np.sqrt(np.abs(eigh(K, M, eigvals_only=True))) / (2.0 * np.pi)


def test_other_coordinates_have_the_same_frequencies_and_damping(bar):
    e = superelement.read(bar)
    reduced = in_craig_bampton_form(e)
    n_c = e.n_c
    assert frequencies(reduced.K, reduced.M)[6:] == pytest.approx(e.modes.frequencies, rel=1e-9)
    assert frequencies(reduced.K, reduced.M)[5] < 1e-3 * e.modes.frequencies[0]
    values, vectors = eigh(reduced.K, reduced.M)
    zeta = np.diag(vectors.T @ reduced.C @ vectors)[6:] / (2.0 * np.sqrt(values[6:]))
    assert zeta == pytest.approx(e.modes.zeta, rel=1e-6)
    # Under forces in equilibrium the interfaces move as the static compliance says.
    K = reduced.K[:n_c, :n_c]
    balanced = np.linalg.eigh(K)[1][:, 6:]
    assert np.abs(K @ e.compliance @ balanced - balanced).max() <= 1e-7


def at_one_end(e):
    """The same body with its first interface alone."""
    return replace(
        e,
        interfaces=e.interfaces[:1],
        kernel=replace(e.kernel, g=e.kernel.g[:, :6, :6], g_initial=e.kernel.g_initial[:, :6, :6]),
        modes=Modes(e.modes.omega, e.modes.zeta, e.modes.phi[:6]),
        compliance=e.compliance[:6, :6],
        accelerance=e.accelerance[:6, :6],
    )


def test_a_body_with_one_interface(runner, bar, tmp_path):
    """Its interface moves without energy; held to a spring it is refused when read back."""
    e = at_one_end(superelement.read(bar))
    superelement.write(e, tmp_path / "end.h5")
    exported = ["export", str(tmp_path / "end.h5"), str(tmp_path), "--to", "craig-bampton"]
    assert runner.invoke(app, exported).exit_code == 0
    path = tmp_path / "end-reduced.npz"
    body = Body.model_validate(
        {
            "name": "back",
            "matrices": {"stiffness": path, "nodes": path},
            "interfaces": {"root": {"nodes": [1]}},
            "impulse": {"step": 1e-5, "steps": 10, "method": "modal"},
        }
    )
    assert build(body).modes.frequencies == pytest.approx(e.modes.frequencies, rel=1e-9)
    arrays = dict(np.load(path))
    arrays["stiffness"][1, 1] = 10.0
    np.savez(path, **arrays)
    with pytest.raises(MatrixError, match=r"translation along y .* strain energy of 5 J at 1 m"):
        build(body)


def test_files_of_the_name_of_the_superelement_stay(runner, bar, tmp_path):
    """Those of its mesh and its matrices, and itself by another name."""
    (tmp_path / "bar.h5").write_bytes(bar.read_bytes())
    own = [tmp_path / f"bar{suffix}" for suffix in (".npz", ".op4", ".pch", ".bdf")]
    for path in own:
        path.write_text("mine")
    asked = ["export", str(tmp_path / "bar.h5"), str(tmp_path), "--to", "craig-bampton"]
    assert runner.invoke(app, asked).exit_code == 0
    assert [path.read_text() for path in own] == ["mine"] * 4
    (tmp_path / "bar-reduced.pch").unlink()
    (tmp_path / "bar-reduced.pch").hardlink_to(tmp_path / "bar.h5")
    found = runner.invoke(app, asked)
    assert found.exit_code == 1
    assert "bar-reduced.pch is the input" in " ".join(found.stderr.split())
    assert (tmp_path / "bar.h5").read_bytes() == bar.read_bytes()


def test_surfaces_and_fields_that_are_left_out_are_named(runner, tmp_path):
    import skfem
    from duhamel.preprocess import mesh_of

    sides = [np.linspace(0, size, n) for size, n in ((0.4, 6), (0.05, 3), (0.03, 2))]
    mesh = mesh_of(skfem.MeshHex.init_tensor(*sides))
    top = {"plane": {"point": [0, 0, 0.03], "normal": [0, 0, 1]}}
    interfaces = {"root": INTERFACES["root"]}
    parts = {"mesh": mesh, "interfaces": interfaces, "surfaces": {"top": top}, "recovery": {}}
    parts["impulse"] = {"step": 1e-5, "steps": 10, "band": 2e4}
    superelement.write(build(Body.model_validate(BAR | parts)), tmp_path / "bar.h5")
    asked = ["export", str(tmp_path / "bar.h5"), str(tmp_path), "--to", "craig-bampton"]
    found = runner.invoke(app, asked)
    assert "left out: [surfaces], [recovery]" in found.output


def test_interfaces_that_move_together_are_refused(bar):
    """Three modes cannot move twelve dofs independently."""
    e = superelement.read(bar)
    few = Modes(e.modes.omega[:3], e.modes.zeta[:3], e.modes.phi[:, :3])
    with pytest.raises(SuperelementError, match=r"bar: expected modes that move its 12 .* found 9"):
        in_craig_bampton_form(replace(e, modes=few))
    with pytest.raises(SuperelementError, match=r"bar: expected modes, which .* march"):
        in_craig_bampton_form(replace(e, modes=None))


def test_a_body_that_its_interfaces_do_not_hold_is_refused(bar):
    """Two points leave the turn about their line."""
    e = superelement.read(bar)
    rows = np.r_[e.rows("tip"), e.rows("middle")]
    points = replace(
        e,
        interfaces=e.interfaces[1:],
        kernel=replace(e.kernel, g=e.kernel.g[:, 6:, 6:], g_initial=e.kernel.g_initial[:, 6:, 6:]),
        modes=Modes(e.modes.omega, e.modes.zeta, e.modes.phi[rows]),
        compliance=e.compliance[6:, 6:],
        accelerance=e.accelerance[6:, 6:],
    )
    with pytest.raises(SuperelementError, match=r"bar: expected interfaces that hold the body"):
        in_craig_bampton_form(points)


def test_a_file_that_is_no_superelement_is_one_line(runner, tmp_path):
    (tmp_path / "a.h5").write_bytes(b"no")
    found = runner.invoke(
        app, ["export", str(tmp_path / "a.h5"), str(tmp_path / "out"), "--to", "craig-bampton"]
    )
    assert found.exit_code == 1
    assert found.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("stiffness", "nodes", "tolerance"),
    [(".npz", ".npz", 1e-9), (".op4", ".bdf", 1e-8), (".pch", ".bdf", 1e-6)],
)
def test_what_is_exported_reads_back_as_the_same_body(
    runner, bar, tmp_path, stiffness, nodes, tolerance
):
    assert (
        runner.invoke(app, ["export", str(bar), str(tmp_path), "--to", "craig-bampton"]).exit_code
        == 0
    )
    body = Body.model_validate(
        {
            "name": "back",
            "matrices": {
                "stiffness": tmp_path / f"bar-reduced{stiffness}",
                "nodes": tmp_path / f"bar-reduced{nodes}",
            },
            "interfaces": {"root": {"nodes": [1]}, "tip": {"nodes": [2]}, "middle": {"nodes": [3]}},
            "impulse": {"step": 1e-5, "steps": 10, "method": "modal"},
            "damping": {"modal": 0.02},
        }
    )
    e, back = superelement.read(bar), build(body)
    assert back.mass == pytest.approx(e.mass, rel=tolerance)
    np.testing.assert_allclose(back.J_rot, e.J_rot, atol=tolerance * e.J_rot.max())
    assert back.modes.frequencies == pytest.approx(e.modes.frequencies, rel=tolerance)
    for one, other in ((back.compliance, e.compliance), (back.accelerance, e.accelerance)):
        assert np.abs(one - other).max() <= 100 * tolerance * np.abs(other).max()
