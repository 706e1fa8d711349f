"""Bodies from matrices of other programs: the same superelement as from the mesh, and an error for
each mistake.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess import (
    Body,
    BodyError,
    InterfaceError,
    MatrixError,
    assemble,
    build,
    read_body,
)
from duhamel.preprocess.assembly.second_order import second_order
from duhamel.preprocess.body.body import Matrices
from duhamel.preprocess.body.damping import Damping
from duhamel.preprocess.given.matrices import read_matrices
from duhamel.preprocess.given.matrix_names import MASS_NAMES, chosen_name
from duhamel.preprocess.sources.reading import read_source
from duhamel.preprocess.survey import survey
from pydantic import ValidationError

from ..blocks import box_mesh
from ..conftest import IMPULSE, straight
from .matrix_writers import (
    BY_LABEL,
    BY_ORDER,
    abaqus_input,
    market_symmetric,
    npz,
    op4_binary,
    op4_text,
    write_dofs,
    write_nodes,
)


@dataclass(frozen=True, eq=False)
class Export:
    """A model as another program has it: labels (n,) with gaps, points (n, 3), and dofs (n_u, 2) of
    K and M.
    """

    labels: Any
    points: Any
    dofs: Any
    K: Any
    M: Any

    def reordered(self, nodes: Any, dofs: Any) -> "Export":
        """The same model with its nodes and its rows in other orders."""
        K, M = (sp.csc_array(matrix[dofs][:, dofs]) for matrix in (self.K, self.M))
        return Export(self.labels[nodes], self.points[nodes], self.dofs[dofs], K, M)

    def write(self, folder: Path, writer: Any = npz, map_dofs: bool = False) -> dict[str, Path]:
        files = {
            "stiffness": writer(folder / "K", self.K, self.dofs),
            "mass": writer(folder / "M", self.M, self.dofs),
            "nodes": write_nodes(folder / "nodes.csv", self.labels, self.points),
        }
        return {**files, "dofs": write_dofs(folder / "dofs.csv", self.dofs)} if map_dofs else files


def export(structure: Any) -> Export:
    nodes = structure.nodes
    labels = 10 + 7 * np.arange(len(nodes.points))
    direction = np.concatenate([np.arange(1, 7 if rotates else 4) for rotates in nodes.rotations])
    dofs = np.stack([labels[nodes.owner], direction], axis=1)
    return Export(labels, nodes.points, dofs, sp.csc_array(structure.K), sp.csc_array(structure.M))


def given(files: Any, **changes: Any) -> Body:
    interfaces = {"root": {"node": [0, 0, 0]}, "tip": {"nodes": [10]}}
    return Body.model_validate(
        {
            "name": "given",
            "matrices": files,
            "interfaces": interfaces,
            "impulse": IMPULSE,
            **changes,
        }
    )


def assert_equal(found: Any, expected: Any) -> None:
    """Two superelements, to rounding: each pair of rows of the kernel on its own scale."""
    assert found.mass == pytest.approx(expected.mass, rel=1e-12)
    np.testing.assert_allclose(found.center, expected.center, rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        found.J_rot, expected.J_rot, rtol=0, atol=1e-12 * np.abs(expected.J_rot).max()
    )
    for one, other in zip(found.interfaces, expected.interfaces, strict=True):
        np.testing.assert_allclose(one.X, other.X, rtol=0, atol=1e-12)
        assert one.rotations == other.rotations
    scale = np.sqrt(np.abs(expected.kernel.g).max(axis=0).diagonal())
    assert (
        np.abs(found.kernel.g - expected.kernel.g).max(axis=0) / np.outer(scale, scale)
    ).max() < 1e-9


@pytest.fixture
def solid(solid_body):
    """A body of a mesh whose interfaces are points."""
    mesh = box_mesh("hexahedron", size=(1.0, 0.2, 0.1), divisions=(3, 2, 1))
    return solid_body(
        mesh, interfaces={"root": {"node": [0, 0, 0]}, "tip": {"node": [1, 0.2, 0.1]}}
    )


@pytest.fixture
def beam(beam_body):
    return beam_body(straight(5, along=(0.6, 0.0, 0.8)), section=askew())


def askew() -> dict[str, float]:
    """Bending of different stiffness about both axes, so that a wrong order shows."""
    return {
        "EA": 2.16e7,
        "EI_y": 5.5,
        "EI_z": 8.0,
        "GJ": 4.0,
        "mass_per_length": 0.0858,
        "polar_inertia_per_length": 4.4e-6,
    }


@pytest.fixture(params=["solid", "beam"])
def original(request):
    """A body of a mesh, with nodes of three and of six dofs."""
    return request.getfixturevalue(request.param)


def last(model: Export) -> int:
    """The label of the node at the far end."""
    return int(model.labels[model.points.sum(axis=1).argmax()])


def ends(model: Export) -> dict[str, Any]:
    return {"root": {"node": [0, 0, 0]}, "tip": {"nodes": [last(model)]}}


@pytest.mark.parametrize("writer", [*BY_ORDER, *BY_LABEL])
def test_the_same_superelement_from_every_format(original, tmp_path, writer):
    model = export(assemble(original))
    assert_equal(
        build(given(model.write(tmp_path, writer), interfaces=ends(model))), build(original)
    )


def test_matrices_of_a_material_that_loses_energy(solid, tmp_path):
    """They are those at the reference frequency."""
    model = export(assemble(solid))
    loss = {"loss_factor": 0.1, "band": (100.0, 4000.0), "reference_frequency": 600.0}
    body = given(model.write(tmp_path), interfaces=ends(model), damping=loss)
    lossy = solid.model_copy(update={"damping": Damping.model_validate(loss)})
    assert_equal(build(body), build(lossy))


@pytest.mark.parametrize("writer", [*BY_ORDER, *BY_LABEL])
def test_nodes_and_rows_in_any_order(original, tmp_path, writer):
    """A file of dofs says which row is which; entries that name nodes and dofs need none."""
    model = export(assemble(original))
    rng = np.random.default_rng(1)
    model = model.reordered(rng.permutation(len(model.labels)), rng.permutation(len(model.dofs)))
    files = model.write(tmp_path, writer, map_dofs=writer in BY_ORDER)
    assert_equal(build(given(files, interfaces=ends(model))), build(original))


def test_rotations_of_solids_and_nodes_without_elements_are_no_unknowns(solid, tmp_path):
    """Nastran has six dofs for every grid point, whatever is there."""
    model = export(assemble(solid))
    n = len(model.labels)
    kept = (6 * np.arange(n)[:, None] + np.arange(3)).ravel()
    blow_up = sp.csc_array((np.ones(3 * n), (kept, np.arange(3 * n))), shape=(6 * n + 6, 3 * n))
    K, M = (blow_up @ matrix @ blow_up.T for matrix in (model.K, model.M))
    wide = Export(
        np.append(model.labels, 9999), np.vstack([model.points, [[5.0, 5.0, 5.0]]]), None, K, M
    )
    body = given(wide.write(tmp_path, op4_binary), interfaces={"tip": {"nodes": [last(model)]}})
    structure = assemble(body)
    assert structure.n_u == 3 * n
    assert abs(structure.K - model.K).max() == 0.0
    with pytest.raises(
        InterfaceError,
        match=r"nodes.csv: interfaces.tip: nodes: no node 9999 with stiffness or mass",
    ):
        assemble(given(body.matrices, interfaces={"tip": {"nodes": [9999]}}))


def test_matrices_of_solids_tell_how_the_inertia_changes(solid, tmp_path):
    """But not how loads stiffen the body."""
    model = export(assemble(solid))
    bodies = solid, given(model.write(tmp_path), interfaces=ends(model))
    structures = [assemble(body) for body in bodies]
    mesh, found = (
        second_order(structure, read_source(body), body)
        for structure, body in zip(structures, bodies, strict=True)
    )
    motions = np.random.default_rng(3).normal(size=(structures[0].n_u, 3))
    pairs = [
        (found.inertia_loads, mesh.inertia_loads),
        (found.inertia(motions), mesh.inertia(motions)),
        (found.gyroscopic(motions), mesh.gyroscopic(motions)),
        (found.interfaces(motions), mesh.interfaces(motions)),
    ]
    for one, other in pairs:
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())
    for energy in (lambda: found.third(motions, motions), lambda: found.quartic(motions, abs)):
        with pytest.raises(BodyError, match=r"nodes.csv: .* do not tell how loads stiffen a body"):
            energy()


def test_matrices_with_rotations_tell_nothing_of_second_order(beam, tmp_path):
    model = export(assemble(beam))
    body = given(model.write(tmp_path), interfaces=ends(model))
    with pytest.raises(BodyError, match="expected nodes with three dofs and a mass"):
        second_order(assemble(body), read_source(body), body)


def test_nodes_of_three_and_of_six_dofs_in_one_model(solid_body, tmp_path):
    """A frame of a solid, which ties make a node with rotations, among nodes that have none."""
    interfaces = {"root": {"group": "root", "kind": "rigid"}, "tip": {"node": [1, 0.2, 0.1]}}
    tied = solid_body(
        box_mesh("hexahedron", size=(1.0, 0.2, 0.1), divisions=(3, 2, 1)), interfaces=interfaces
    )
    model = export(assemble(tied))
    frame = int(model.labels[-1])
    tip = int(model.labels[:-1][model.points[:-1].sum(axis=1).argmax()])
    rng = np.random.default_rng(2)
    model = model.reordered(rng.permutation(len(model.labels)), rng.permutation(len(model.dofs)))
    body = given(
        model.write(tmp_path, abaqus_input),
        interfaces={"root": {"nodes": [frame]}, "tip": {"nodes": [tip]}},
    )
    assert_equal(build(body), build(tied))


@pytest.mark.parametrize("kind", ["average", "rigid"])
def test_several_nodes_carry_a_frame(solid_body, tmp_path, kind):
    """A rigid face is the same from a mesh; the mean motion of nodes is exact for rigid motion."""
    mesh = box_mesh("hexahedron", size=(1.0, 0.2, 0.1), divisions=(3, 2, 1))
    original = solid_body(
        mesh, interfaces={"root": {"group": "root", "kind": kind}, "tip": {"node": [1, 0.2, 0.1]}}
    )
    free = assemble(solid_body(mesh, interfaces={"tip": {"node": [1, 0.2, 0.1]}}))
    model = export(free)
    labels = model.labels[model.points[:, 0] == 0.0].tolist()
    places = ({"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}, {"nodes": labels})
    for place in places:
        interfaces = {"root": {**place, "kind": kind}, "tip": {"nodes": [last(model)]}}
        body = given(model.write(tmp_path), interfaces=interfaces)
        if kind == "rigid":
            assert_equal(build(body), build(original))
        structure = assemble(body)
        X = np.array([structure.interfaces[0].X])
        motion = structure.P_C[:6] @ structure.rigid.A
        np.testing.assert_allclose(X, [[-0.5, 0.0, 0.0]], atol=1e-12)
        np.testing.assert_allclose(motion[:3, :3], np.eye(3), atol=1e-12)
        np.testing.assert_allclose(motion[3:], np.hstack([np.zeros((3, 3)), np.eye(3)]), atol=1e-12)
        np.testing.assert_allclose(
            motion[:3, 3:], [[0, 0, 0], [0, 0, -0.5], [0, 0.5, 0]], atol=1e-12
        )


def test_rotations_of_nodes_follow_a_rigid_frame(beam_body, tmp_path):
    """A frame on three nodes of a bent beam makes a rigid piece of the elements between: it stores
    no energy.
    """
    from ..conftest import line_mesh

    points = [[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0.3, 0.1, 0.1]]
    original = beam_body(line_mesh(points), section=askew())
    model = export(assemble(original))
    knee = {"nodes": model.labels[:3].tolist(), "kind": "rigid"}
    interfaces = {"knee": knee, "tip": {"nodes": [int(model.labels[3])]}}
    structure = assemble(given(model.write(tmp_path), interfaces=interfaces))
    assert structure.n_u == 12
    whole = assemble(original).rigid
    assert structure.rigid.mass == pytest.approx(whole.mass, rel=1e-12)
    np.testing.assert_allclose(structure.rigid.J_rot, whole.J_rot, atol=1e-12 * whole.J_rot.max())
    # The frame moves as a clamp of the last element: its stiffness at the tip is that of the
    # element alone.
    tip = model.K.toarray()[18:, 18:]
    np.testing.assert_allclose(structure.K.toarray()[:6, :6], tip, atol=1e-9 * tip.max())


def test_masses(beam, beam_body, tmp_path):
    model = export(assemble(beam))
    mass = {"mass": 0.3, "inertia": [1e-5, 2e-5, 3e-5]}
    heavy = beam_body(
        straight(5, along=(0.6, 0.0, 0.8)), section=askew(), masses={"a": {**mass, "group": "tip"}}
    )
    for place in ({"interface": "tip"}, {"nodes": [last(model)]}, {"node": [0.3, 0, 0.4]}):
        body = given(model.write(tmp_path), interfaces=ends(model), masses={"a": {**mass, **place}})
        assert_equal(build(body), build(heavy))


def abaqus_nodes(path: Path, model: Export) -> Path:
    rows = zip(model.labels.tolist(), model.points.tolist(), strict=True)
    ends = model.labels[model.points[:, 0] == 0.0]
    lines = ["*NODE", *(f"{label}, {x!r}, {y!r}, {z!r}" for label, (x, y, z) in rows)]
    shell = ", ".join(map(str, ends[:4]))
    lines += ["*ELEMENT, TYPE=S4", f"1, {shell}", "*NSET, NSET=root", *map(str, ends)]
    path = path.with_suffix(".inp")
    path.write_text("\n".join(lines) + "\n")
    return path


def nastran_nodes(path: Path, model: Export) -> Path:
    rows = zip(model.labels.tolist(), model.points.tolist(), strict=True)
    grids = [
        f"GRID*   {label:16}{0:16}{x:16.13f}{y:16.13f}\n*       {z:16.13f}\n"
        for label, (x, y, z) in rows
    ]
    ends = model.labels[model.points[:, 0] == 0.0]
    path = path.with_suffix(".bdf")
    path.write_text("".join(grids) + "".join(f"SET1,1,{label}\n" for label in ends))
    return path


@pytest.mark.parametrize(("writer", "group"), [(abaqus_nodes, "root"), (nastran_nodes, "set 1")])
def test_nodes_labels_and_groups_of_a_mesh_file(solid, tmp_path, writer, group):
    """Nodes that no element has, and elements that make no body here, are no trouble."""
    model = export(assemble(solid))
    files = {**model.write(tmp_path, abaqus_input), "nodes": writer(tmp_path / "mesh", model)}
    assert_equal(build(given(files, interfaces=ends(model))), build(solid))
    frame = assemble(given(files, interfaces={"root": {"group": group}})).interfaces[0]
    np.testing.assert_allclose(frame.X, [-0.5, 0.0, 0.0], atol=1e-12)


def test_lumped_mass(solid, tmp_path):
    """A diagonal matrix of masses is sound: Nastran's default."""
    model = export(assemble(solid))
    lumped = sp.diags_array(model.M.sum(axis=1), format="csc")
    structure = assemble(
        given(Export(model.labels, model.points, model.dofs, model.K, lumped).write(tmp_path))
    )
    assert structure.rigid.mass == pytest.approx(156.0, rel=1e-12)
    np.testing.assert_allclose(structure.rigid.center, [0.5, 0.1, 0.05], atol=1e-12)
    assert abs(structure.M - lumped).max() == 0.0


def test_points_of_an_npz(solid, tmp_path):
    model = export(assemble(solid))
    np.savez(tmp_path / "nodes.npz", points=model.points, labels=model.labels)
    files = {**model.write(tmp_path), "nodes": tmp_path / "nodes.npz"}
    assert assemble(given(files)).rigid.mass == pytest.approx(156.0)
    np.savez(tmp_path / "nodes.npz", points=model.points)
    assert assemble(given(files, interfaces={"tip": {"nodes": [1]}})).rigid.mass == pytest.approx(
        156.0
    )


def test_a_body_file(solid, tmp_path):
    """Paths are relative to it, and the superelement says what it was made of."""
    model = export(assemble(solid))
    model.write(tmp_path, market_symmetric)
    (tmp_path / "body.toml").write_text(
        'name = "given"\n[matrices]\nstiffness = "K.mtx"\nmass = "M.mtx"\nnodes = "nodes.csv"\n'
        "[interfaces.root]\nnode = [0, 0, 0]\n[interfaces.tip]\n"
        f"nodes = [{last(model)}]\n[impulse]\nstep = 1e-4\nsteps = 20\n"
    )
    made = build(read_body(tmp_path / "body.toml"))
    assert_equal(made, build(solid))
    assert made.provenance.mesh == "K.mtx, M.mtx, nodes.csv"
    assert len(made.provenance.mesh_sha256.split(", ")) == 3
    assert made.provenance.body.startswith('name = "given"')


# What is done to K, M and the points of the solid, and what is said of it.
def grounded(model: Export) -> Export:
    spring = sp.csc_array(([5e4], ([4], [4])), shape=model.K.shape)
    return Export(model.labels, model.points, model.dofs, model.K + spring, model.M)


def clamped(model: Export) -> Export:
    free = np.flatnonzero(np.isin(model.dofs[:, 0], model.labels[model.points[:, 0] > 0.0]))
    return model.reordered(np.arange(len(model.labels)), free)


def moved(model: Export) -> Export:
    points = model.points.copy()
    points[5] += [0.0, 0.0, 1e-3]
    return Export(model.labels, points, model.dofs, model.K, model.M)


def lopsided(model: Export) -> Export:
    K = model.K.tolil()
    K[3, 0] *= 1.001
    return Export(model.labels, model.points, model.dofs, sp.csc_array(K), model.M)


def massless(model: Export) -> Export:
    keep = sp.diags_array(np.where(np.arange(model.M.shape[0]) == 7, 0.0, 1.0))
    return Export(
        model.labels, model.points, model.dofs, model.K, sp.csc_array(keep @ model.M @ keep)
    )


def indefinite(model: Export) -> Export:
    """Positive on the diagonal, negative for a motion of two dofs against each other, and with the
    mass as it was.
    """
    i, j, a = 0, 3, model.M[0, 0]
    extra = sp.csc_array(([a, a, -a, -a], ([i, j, i, j], [j, i, i, j])), shape=model.M.shape)
    return Export(
        model.labels, model.points, model.dofs, model.K, sp.csc_array(model.M - 0.99 * -extra)
    )


def uneven(model: Export) -> Export:
    """Mass along x that y and z know nothing of."""
    along_x = sp.diags_array(np.where(model.dofs[:, 1] == 1, 0.01 * model.M.max(), 0.0))
    return Export(model.labels, model.points, model.dofs, model.K, sp.csc_array(model.M + along_x))


def torn(model: Export) -> Export:
    """Without the elements between the first and the last layer of nodes."""
    x = model.points[(model.dofs[:, 0] - 10) // 7, 0]
    near = sp.diags_array((x < 0.5).astype(float))
    far = sp.diags_array((x > 0.5).astype(float))
    K = near @ model.K @ near + far @ model.K @ far
    return Export(model.labels, model.points, model.dofs, sp.csc_array(K), model.M)


def loose(model: Export) -> Export:
    keep = sp.diags_array(np.where(np.arange(model.K.shape[0]) == 7, 0.0, 1.0))
    return Export(
        model.labels, model.points, model.dofs, sp.csc_array(keep @ model.K @ keep), model.M
    )


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (
            grounded,
            r"found under translation along y forces .* dof 2 of node 17: the body is held there.*"
            r"strain energy of 2.5e\+04 J at 1 m",
        ),
        (
            clamped,
            r"under translation along . forces .* on dof \d of node \d+: the body is held there",
        ),
        (
            moved,
            r"found under rotation about . forces .* of node \d+: it may translate but not rotate",
        ),
        (
            lopsided,
            r"K.npz: expected a symmetric matrix, .* "
            r"most between dof 1 of node 1[07] and dof 1 of node 1[07]",
        ),
        (massless, r"expected mass on every dof, found none or less on 1, first dof 2 of node 24"),
        (
            indefinite,
            r"expected a positive definite mass, found one with the eigenvalue -.* of its diagonal",
        ),
        (
            uneven,
            r"expected one mass in all directions, found \d+[.\d]*, 156, 156 kg along x, y, z",
        ),
        (
            torn,
            r"expected one connected body, found 2 pieces of \d+, \d+ nodes; "
            r"node \d+ is in the smallest",
        ),
        (loose, r"expected stiffness on every dof, found none on 1, first dof 2 of node 24"),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_models_that_are_no_free_body(solid, tmp_path, spoil, message):
    model = spoil(export(assemble(solid)))
    with pytest.raises(MatrixError, match=message):
        assemble(given(model.write(tmp_path, abaqus_input if spoil is clamped else npz)))


def test_a_beam_in_another_unit_of_length(beam, tmp_path):
    """Rotations tell: their arms do not fit."""
    model = export(assemble(beam))
    wrong = Export(model.labels, 1000.0 * model.points, model.dofs, model.K, model.M)
    with pytest.raises(
        MatrixError, match=r"under rotation about . forces .*the unit of length is another one"
    ):
        assemble(given(wrong.write(tmp_path)))


def test_nodes_that_do_not_have_all_displacements_or_rotations(beam, tmp_path):
    model = export(assemble(beam))
    part = model.reordered(np.arange(6), np.flatnonzero((model.dofs != [24, 5]).any(axis=1)))
    with pytest.raises(
        MatrixError,
        match=r"K.mtx, M.mtx: .* 1 to 3 of a node, or on 1 to 6, found 1, 2, 3, 4, 6 at node 24",
    ):
        assemble(given(part.write(tmp_path, abaqus_input)))


@pytest.mark.parametrize(
    ("key", "name", "content", "message"),
    [
        (
            "stiffness",
            "K.csv",
            "",
            r"K.csv: expected a file of type .npz, .mtx, .sti, .mas, .op4, .* found .csv",
        ),
        ("stiffness", "none.mtx", None, r"none.mtx: no such file of a matrix"),
        ("stiffness", "K.npz", "text", r"K.npz: expected a sparse matrix of scipy"),
        (
            "stiffness",
            "K.mtx",
            "%%MatrixMarket matrix coordinate real general\n1 1\n",
            r"K.mtx: not a Matrix Market",
        ),
        (
            "stiffness",
            "K.mtx",
            "%%MatrixMarket matrix array real general\n1 2\n1\n2\n",
            r"found 1 rows and 2",
        ),
        (
            "stiffness",
            "K.mtx",
            "%%MatrixMarket matrix array complex general\n1 1\n1 2\n",
            r"found complex ones",
        ),
        (
            "stiffness",
            "K.mtx",
            "%%MatrixMarket matrix array real general\n1 1\nnan\n",
            r"finite numbers, found 1",
        ),
        (
            "stiffness",
            "K.mtx",
            "1,1, 1,1, one\n",
            r"K.mtx: not a matrix of Abaqus: could not convert string ' one'",
        ),
        (
            "stiffness",
            "K.mtx",
            "1,1,1,1\n",
            r"K.mtx: expected rows .* or Matrix Market, found 4 columns",
        ),
        (
            "stiffness",
            "K.mtx",
            "-5,1,1,1,2.0\n",
            r"K.mtx: .*from 1 on, found \[-5.0, .*: internal nodes are not read",
        ),
        ("stiffness", "K.mtx", "5,1,5,1,2.0\n", r"K.mtx: no node 5 in nodes.csv, nor 0 others"),
        (
            "stiffness",
            "K.mtx",
            "10,11,10,11,2.0\n",
            r"K.mtx: expected dofs 1 to 6, .*found dof 11 of node 10",
        ),
        (
            "stiffness",
            "K.mtx",
            "1,1,2.0\n",
            r"K.mtx: expected 72 or 144 rows, three or six for each of the 24 nodes",
        ),
        ("stiffness", "K.op4", "text", r"K.op4: not an OUTPUT4 file of Nastran"),
        ("nodes", "none.csv", None, r"none.csv: no such file of nodes"),
        (
            "nodes",
            "nodes.csv",
            "1, 0, 0\n",
            r"nodes.csv: expected a table of label, x, y, z, found 3 columns, 1 rows",
        ),
        (
            "nodes",
            "nodes.csv",
            "1, 0, 0, 0\n1, 1, 0, 0\n",
            r"every label once, found node 1 2 times",
        ),
        (
            "nodes",
            "nodes.csv",
            "1.5, 0, 0, 0\n",
            r"nodes.csv: expected integers for labels, found 1.5",
        ),
        ("nodes", "nodes.csv", "1, 0, nan, 0\n", r"nodes.csv: expected three finite coordinates"),
        (
            "nodes",
            "nodes.npz",
            "text",
            r"nodes.npz: expected arrays points \(n, 3\) and perhaps labels",
        ),
        (
            "dofs",
            "dofs.csv",
            "10, 1\n",
            r"dofs.csv: expected a row for each of the 72 of K.npz, found 1",
        ),
        (
            "dofs",
            "dofs.csv",
            "10, 1\n" * 72,
            r"dofs.csv: .*found dof 1 of node 10 in several rows",
        ),
    ],
)
def test_files_that_do_not_fit(solid, tmp_path, key, name, content, message):
    files = export(assemble(solid)).write(tmp_path)
    if content is not None:
        (tmp_path / name).write_text(content)
    with pytest.raises(MatrixError, match=message):
        assemble(given({**files, key: tmp_path / name}))


def test_a_triangle_that_is_small_beside_the_diagonal_is_not_halved(tmp_path):
    """Its entries count twice, though the matrix is nearly its mirror image."""
    (tmp_path / "nodes.csv").write_text("1, 0, 0, 0\n")
    half = np.array([[2.0, 0.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 1e11]])
    sp.save_npz(tmp_path / "K.npz", sp.csc_array(half))
    sp.save_npz(tmp_path / "M.npz", sp.csc_array(np.eye(3)))
    files = {"stiffness": "K.npz", "mass": "M.npz", "nodes": "nodes.csv"}
    files = {key: tmp_path / name for key, name in files.items()}
    model = read_matrices(Matrices.model_validate(files))
    np.testing.assert_array_equal(model.K.toarray(), half + np.tril(half, -1).T)
    np.testing.assert_array_equal(model.M.toarray(), np.eye(3))


def test_a_table_of_dofs_that_no_matrix_takes_is_refused(solid, tmp_path):
    files = export(assemble(solid)).write(tmp_path, abaqus_input, map_dofs=True)
    with pytest.raises(MatrixError, match=r"dofs.csv: expected no matrices.dofs, for K.mtx, M.mtx"):
        assemble(given(files))


def test_one_matrix_is_not_both(solid, tmp_path):
    model = export(assemble(solid))
    files = model.write(tmp_path)
    lone = op4_text(tmp_path / "K", model.K, None)
    with pytest.raises(MatrixError, match=r"K.op4: .* found the same matrix for both"):
        assemble(given({"stiffness": lone, "nodes": files["nodes"]}))
    assert chosen_name(["STIFF"], MASS_NAMES) == "STIFF"
    with pytest.raises(MatrixError, match=r"expected a matrix MGG, .* found KGG"):
        chosen_name(["KGG"], MASS_NAMES)


def test_files_of_nastran(solid, tmp_path):
    """Of several matrices the named one; a file that breaks off, or is complex, is refused."""
    model = export(assemble(solid))
    files = model.write(tmp_path, op4_binary)
    swapped = {**files, "stiffness": files["mass"]}
    with pytest.raises(
        MatrixError, match=r"M.op4: expected a matrix KGG, KAA, .* found OTHER, MGG"
    ):
        assemble(given(swapped))
    files["mass"].write_bytes(files["mass"].read_bytes()[:-40])
    with pytest.raises(
        MatrixError,
        match=r"M.op4: not an OUTPUT4 file of Nastran, or one that breaks off: a record of",
    ):
        assemble(given(files))
    text = op4_text(tmp_path / "K", model.K, None)
    whole = text.read_text()
    text.write_text(whole.replace(f"{6:8}{2:8}STIFF", f"{6:8}{4:8}STIFF"))
    with pytest.raises(
        MatrixError, match=r"K.op4: matrix STIFF: expected real numbers, found complex ones"
    ):
        assemble(given({**files, "stiffness": text}))
    text.write_text(whole[:2000])
    with pytest.raises(
        MatrixError, match=r"K.op4: not an OUTPUT4 file of Nastran, or one that breaks off"
    ):
        assemble(given({**files, "stiffness": text}))


@pytest.mark.parametrize(
    ("interface", "message"),
    [
        ({"node": [0.5, 5, 0]}, r"nodes.csv: interfaces.a: no node at \[0.5, 5.0, 0.0\]"),
        (
            {"nodes": [11]},
            r"nodes.csv: interfaces.a: nodes: no node 11 with stiffness or mass in nodes.csv",
        ),
        (
            {"nodes": [10, 17]},
            r"interfaces.a: a frame needs three nodes that are not on a line, found 2 nodes",
        ),
        ({"group": "root"}, r"interfaces.a: no group 'root' in nodes.csv; its groups are: none"),
        ({"sphere": {"center": [9, 9, 9], "radius": 1}}, r"interfaces.a: no node lies in sphere"),
    ],
)
def test_interfaces_that_find_no_nodes(solid, tmp_path, interface, message):
    files = export(assemble(solid)).write(tmp_path)
    with pytest.raises(InterfaceError, match=message):
        assemble(given(files, interfaces={"a": interface}))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mesh": "a.msh"}, "matrices: expected no mesh and nothing made of it, found mesh"),
        ({"scale": 1e-3}, "matrices: expected no mesh and nothing made of it, found scale"),
        ({"order": 2}, "matrices: expected no mesh and nothing made of it, found order"),
        ({"matrices": None}, r"expected mesh or \[matrices\], found neither"),
        (
            {"matrices": None, "mesh": "a.msh", "material": {"E": 1, "nu": 0, "rho": 1}},
            "nodes are labels of",
        ),
        (
            {"interfaces": {"tip": {"nodes": [1], "group": "a"}}},
            "nodes stands alone, found it with group",
        ),
    ],
)
def test_mistakes(changes, message):
    with pytest.raises(ValidationError, match=message):
        given({"stiffness": "K.mtx", "mass": "M.mtx", "nodes": "nodes.csv"}, **changes)


def test_the_text_of_a_body_gives_it_back():
    body = given({"stiffness": "K.mtx", "mass": "M.mtx", "nodes": "nodes.csv", "dofs": "dofs.csv"})
    assert Body.model_validate_json(body.text) == body


def test_recovery_needs_elements(solid, tmp_path):
    files = export(assemble(solid)).write(tmp_path)
    with pytest.raises(BodyError, match=r"\[recovery\]: expected a mesh, found the matrices K.npz"):
        build(given(files, recovery={}))


def test_a_dry_run_needs_a_mesh(solid, tmp_path):
    with pytest.raises(
        BodyError, match=r"a dry run draws what was selected on a mesh, found \[matrices\]"
    ):
        survey(given(export(assemble(solid)).write(tmp_path)))


@pytest.mark.parametrize("method", ["craig-bampton", "rubin"])
def test_the_same_truncated_modes(original, tmp_path, method):
    model = export(assemble(original))
    body = given(model.write(tmp_path, npz), interfaces=ends(model)).with_modes(method, 9)
    found, expected = build(body), build(original.with_modes(method, 9))
    assert_equal(found, expected)
    np.testing.assert_allclose(found.modes.omega, expected.modes.omega, rtol=1e-9)
