"""Fast rotation of bodies from matrices: what they know of it is that of the mesh."""

import numpy as np
import pytest
from duhamel.cli import app
from duhamel.preprocess import BodyError, assemble, build, read_body
from duhamel.preprocess.elements.solid_second import SolidTensors
from duhamel.superelement import check, read, write
from typer.testing import CliRunner

from ..blocks import box_mesh
from ..rotation.steady import Steady, Support
from .matrix_writers import market_symmetric
from .test_matrices import ends, export, given

L, WIDTH, DEPTH = 1.0, 0.1, 0.07
E, DENSITY = 2.1e11, 7800.0
IMPULSE = {"step": 1e-5, "steps": 4}
PINNED = [Support(0, (0, 1, 2, 3)), Support(1, (1, 2))]


@pytest.fixture
def bar(solid_body, tmp_path):
    """A bar along x, from its mesh or from its matrices, with points or frames as interfaces."""

    def make(source, kind=None, width=WIDTH, depth=DEPTH, **changes):
        mesh = box_mesh("hexahedron27", (L, width, depth), (4, 1, 1))
        points = {"root": {"node": [0, 0, 0]}, "tip": {"node": [L, width, depth]}}
        changes = {"impulse": IMPULSE, "rotation": {"modes": 6}, **changes}
        if source == "mesh":
            groups = {name: {"group": name, "kind": kind} for name in points}
            return solid_body(mesh, interfaces=groups if kind else points, **changes)
        model = export(assemble(solid_body(mesh, interfaces=points)))
        x = model.points[:, 0]
        carried = {
            name: {"nodes": model.labels[np.isclose(x, place)].tolist(), "kind": kind}
            for name, place in (("root", 0.0), ("tip", L))
        }
        files = model.write(tmp_path)
        return given(files, interfaces=carried if kind else points, **changes)

    return make


@pytest.mark.parametrize("soft", ["auto", 3])
def test_all_but_stress_is_that_of_the_mesh(bar, monkeypatch, soft):
    """Of which no stress is asked, so that both have the same coordinates, but for signs."""
    rotation = {"modes": 6, "soft": soft}
    found = build(bar("matrices", rotation=rotation))
    monkeypatch.setattr(SolidTensors, "strain_energy", False)
    mesh = build(bar("mesh", rotation=rotation))
    assert found.rotation.n_low == 6
    assert found.rotation.n_soft == (0 if soft == "auto" else soft)
    assert not found.rotation.stiffens
    products = [(e.rotation.T * e.modes.omega**-2) @ e.modes.phi.T for e in (mesh, found)]
    signs = np.sign((products[0] * products[1]).sum(axis=1))
    for name in ("A_inertia", "gyroscopic"):
        one, other = (getattr(e.rotation, name) for e in (found, mesh))
        assert np.abs(other).max() > 0.1
        np.testing.assert_allclose(signs[:, None] * signs * one, other, atol=1e-7, rtol=0)


def test_frames_of_their_own_measure_alone_are_of_second_order(bar):
    """A frame on the mean motion of nodes turns as fits them best; points and rigid ones do not."""
    averaged, rigid, points = (
        build(bar("matrices", kind)).rotation.A_interface for kind in ("average", "rigid", None)
    )
    assert not points.any()
    turns = averaged.reshape(2, 6, *averaged.shape[1:])
    assert np.abs(turns[:, 3:]).max() > 0.0
    assert np.abs(turns[:, :3]).max() < 1e-9 * np.abs(turns).max()
    assert np.abs(rigid).max() < np.abs(turns).max()


def test_a_free_bar_stretches_as_that_of_the_mesh(bar):
    """Each corner, by loads of rotation about any axis; the ends by m w^2 L^2 / (24 EA)."""
    stretches = []
    for source in ("mesh", "matrices"):
        element = build(bar(source))
        modes, load = element.modes, element.rotation.phi_inertia
        stretches.append(modes.phi / modes.omega**2 @ load.T)
    scale = np.abs(stretches[0]).max()
    np.testing.assert_allclose(stretches[1], stretches[0], atol=1e-9 * scale, rtol=0)
    about_z = 0.5 * stretches[1][:, 2]
    assert about_z[3] == pytest.approx(DENSITY * L**3 / (24.0 * E), rel=0.02)


def test_a_shaft_whirls_as_that_of_the_mesh(bar):
    """Forwards faster than backwards, by the inertia of its sections."""
    spin, square = 300.0, {"kind": "rigid", "depth": WIDTH}
    pairs = []
    for source, modes in (("mesh", 4), ("matrices", 16)):
        element = build(bar(source, rotation={"modes": modes}, **square))
        turning = Steady(element, PINNED, [spin, 0, 0]).solve().frequencies()[0][:2]
        pairs.append(turning + np.array([spin, -spin]))
    splitting, means = -np.diff(pairs)[:, 0], np.mean(pairs, axis=1)
    assert splitting[0] > 1e-3 * means[0]
    assert splitting[1] == pytest.approx(splitting[0], rel=0.01)
    # What the stress of rotation adds to the sections' turning: of second order in the spin.
    assert means[1] == pytest.approx(means[0], rel=0.01 * (spin / means[0]) ** 2)


def test_the_file_keeps_it_and_all_checks_hold(bar, tmp_path):
    element = build(bar("matrices"))
    write(tmp_path / "bar.h5", element)
    again = read(tmp_path / "bar.h5")
    for name in ("phi_inertia", "T", "A_interface", "A_inertia", "gyroscopic", "kappa"):
        found, expected = getattr(again.rotation, name), getattr(element.rotation, name)
        np.testing.assert_array_equal(found, expected)
    assert not again.rotation.stiffens
    assert all(fact.holds for fact in check(element))


@pytest.fixture
def body_file(bar, tmp_path):
    """Of a body of the matrices of the mesh of a bar."""

    def make(model):
        model.write(tmp_path, market_symmetric)
        label = ends(model)["tip"]["nodes"][0]
        path = tmp_path / "body.toml"
        path.write_text(
            'name = "given"\n[matrices]\nstiffness = "K.mtx"\nmass = "M.mtx"\n'
            f'nodes = "nodes.csv"\n[interfaces.tip]\nnodes = [{label}]\n'
            "[impulse]\nstep = 1e-5\nsteps = 4\n[rotation]\n"
        )
        return path

    return make


def test_the_commands_say_in_one_line_that_nothing_stiffens(body_file, bar):
    path = body_file(export(assemble(bar("mesh"))))
    assert read_body(path).rotation is not None
    result = CliRunner().invoke(app, ["preprocess", str(path)])
    assert result.exit_code == 0, result.output
    (warning,) = (line for line in result.stderr.splitlines() if line.startswith("warning: "))
    assert f"{path}: rotation: [matrices] know no stiffening" in warning
    shown = CliRunner().invoke(app, ["info", str(path.with_suffix(".h5"))], env={"COLUMNS": "400"})
    assert "r = 4: 4 modes, 0 soft shapes" in shown.output
    assert "none, for [matrices] know none" in shown.output


def test_nodes_with_rotations_are_one_line_that_names_the_file(body_file, beam_body, beam):
    path = body_file(export(assemble(beam_body(beam(4)))))
    result = CliRunner().invoke(app, ["preprocess", str(path)])
    assert result.exit_code == 1
    message = result.stderr.splitlines()[-1]
    assert f"{path}: [rotation]: K.mtx, M.mtx: expected nodes with three dofs" in message
    assert not path.with_suffix(".h5").exists()
    with pytest.raises(BodyError, match=r"\[rotation\]: K.mtx, M.mtx: expected nodes"):
        build(read_body(path))
