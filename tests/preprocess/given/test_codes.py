"""Bodies from files that other programs wrote: those of `codes`, whose README says which."""

import lzma
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
import scipy.sparse as sp
from duhamel.preprocess import Body, BodyError, MatrixError, MeshWarning, assemble, build
from duhamel.preprocess.given import ansys_full
from duhamel.preprocess.given.ansys_full import read_full
from duhamel.preprocess.given.dmig import read_dmig
from duhamel.preprocess.given.matrix_names import MASS_NAMES, STIFFNESS_NAMES
from duhamel.preprocess.given.op2 import read_op2
from duhamel.preprocess.given.op4 import read_op4
from duhamel.preprocess.given.user_element import read_user_element
from duhamel.preprocess.mesh.nodes import spider
from duhamel.preprocess.mesh.reading import read_mesh
from scipy.linalg import eigh

from ..ansys_files import ansys_examples
from ..conftest import IMPULSE

CODES = Path(__file__).parent / "codes"
STEEL = {"E": 210e9, "nu": 0.3, "rho": 7850.0}


def frequencies(structure: Any) -> Any:
    """Of the free body [Hz], those of rigid motion first."""
    values = eigh(structure.K.toarray(), structure.M.toarray(), eigvals_only=True)
    return np.sqrt(np.abs(values)) / (2.0 * np.pi)


def body(interfaces: dict[str, Any], **source: Any) -> Body:
    return Body.model_validate(
        {"name": "part", "interfaces": interfaces, "impulse": IMPULSE, **source}
    )


@pytest.fixture
def calculix(tmp_path) -> dict[str, Path]:
    folder = CODES / "calculix"
    for name in ("bar.sti", "bar.mas"):
        (tmp_path / name).write_bytes(lzma.decompress((folder / f"{name}.xz").read_bytes()))
    return {
        "stiffness": tmp_path / "bar.sti",
        "mass": tmp_path / "bar.mas",
        "dofs": folder / "bar.dof",
        "nodes": folder / "bar.inp",
    }


ENDS = {"root": {"node": [0, 0, 0]}, "tip": {"node": [0.12, 0.04, 0.03]}}


def test_calculix_has_the_frequencies_of_the_same_elements_here(calculix):
    """Quadratic hexahedra with the same points of integration, 14 digits in the file."""
    found = assemble(body(ENDS, matrices=calculix))
    with pytest.warns(MeshWarning, match="materials STEEL"):
        own = assemble(body(ENDS, mesh=calculix["nodes"], material=STEEL))
    assert frequencies(found)[6:] == pytest.approx(frequencies(own)[6:], rel=1e-10)
    assert found.rigid.mass == pytest.approx(7850.0 * 0.12 * 0.04 * 0.03, rel=1e-12)


def test_groups_of_the_mesh_beside_name_interfaces(calculix):
    tip = build(body({"tip": {"group": "TIP"}}, matrices=calculix)).interfaces[0]
    assert tip.rotations
    np.testing.assert_allclose(tip.X, [0.06, 0.0, 0.0], atol=1e-12)


def test_a_deck_that_turns_the_dofs_of_nodes_is_refused(calculix, tmp_path):
    deck = (
        calculix["nodes"]
        .read_text()
        .replace("*MATERIAL", "*TRANSFORM, NSET=TIP\n0,1,0, 1,0,0\n*MATERIAL")
    )
    (tmp_path / "turned.inp").write_text(deck)
    with pytest.raises(MatrixError, match=r"turned.inp, line \d+: .* found \*TRANSFORM"):
        assemble(body(ENDS, matrices={**calculix, "nodes": tmp_path / "turned.inp"}))


def corners(structure: Any) -> Any:
    """The dofs of the corners of the bar."""
    at_rim = np.isin(structure.nodes.points / [0.12, 0.04, 0.03], [0.0, 1.0])
    return structure.nodes.displacements[at_rim.all(axis=1)].ravel()


def lower(matrix: Any) -> str:
    """Of a symmetric matrix, as *MATRIX has it: some four numbers in a line."""
    values = [f"{value:.16e}" for value in matrix[np.tril_indices(len(matrix))]]
    return "".join(",".join(values[i : i + 4]) + ",\n" for i in range(0, len(values), 4))


@pytest.fixture
def substructure(calculix, tmp_path) -> tuple[dict[str, Path], Any, Any]:
    """Files of the bar condensed to its corners, and the stiffness and mass in them."""
    whole = assemble(body(ENDS, matrices=calculix))
    kept = corners(whole)
    others = np.setdiff1d(np.arange(whole.nodes.n_dofs), kept)
    shapes = np.zeros((whole.nodes.n_dofs, len(kept)))
    shapes[kept] = np.eye(len(kept))
    K = whole.K.toarray()
    shapes[others] = -np.linalg.solve(K[np.ix_(others, others)], K[np.ix_(others, kept)])
    K, M = shapes.T @ K @ shapes, shapes.T @ whole.M.toarray() @ shapes
    head = (CODES / "calculix" / "ends.mtx").read_text().partition("*MATRIX")[0]
    text = f"{head}*MATRIX,TYPE=STIFFNESS\n{lower(K)}*MATRIX,TYPE=MASS\n{lower(M)}"
    (tmp_path / "ends.mtx").write_text(text)
    return {"stiffness": tmp_path / "ends.mtx", "nodes": calculix["nodes"]}, K, M


def test_a_substructure_as_calculix_writes_it(calculix):
    """Its build writes the rows of the corners as they are, without what they are condensed of."""
    whole = assemble(body(ENDS, matrices=calculix))
    kept = corners(whole)
    entries, dofs = read_user_element(CODES / "calculix" / "ends.mtx", "STIFFNESS")
    assert dofs[:4].tolist() == [[990, 1], [990, 2], [990, 3], [960, 1]]
    found = entries.toarray() + np.tril(entries.toarray(), -1).T
    expected = whole.K.toarray()[np.ix_(kept, kept)]
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


def test_a_body_of_a_substructure(substructure):
    """Both matrices in one file, in the documented format of Abaqus."""
    files, K, M = substructure
    found = assemble(body(ENDS, matrices=files))
    assert np.abs(found.K.toarray() - K).max() <= 1e-14 * np.abs(K).max()
    assert np.abs(found.M.toarray() - M).max() <= 1e-14 * np.abs(M).max()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("*MATRIX,TYPE=MASS", "*MATRIX,TYPE=DAMPING", r"TYPE=MASS, found STIFFNESS, DAMPING"),
        ("*MATRIX,TYPE=MASS", "*MASS", r"expected \*USER ELEMENT .* found '\*MASS'"),
        ("\n        24,         3", "\n        24,   4,  3", r"STIFFNESS: expected 325 values for"),
        ("        24,         3\n", "        24,         0\n", r"dofs 1 to 6, found \(760, 0\)"),
        ("        24,         3\n", "        25,         3\n", r"positions among 24 nodes on"),
        ("** ELEMENT NODES", "** NODES", r"expected comments \*\* ELEMENT NODES with nodes"),
        ("e-0", "e-O", r"expected a matrix: could not convert string to float"),
    ],
)
def test_mistakes_in_a_substructure(substructure, old, new, message):
    path = substructure[0]["stiffness"]
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(MatrixError, match=message):
        assemble(body(ENDS, matrices=substructure[0]))


def held(text: str) -> str:
    """Rows without those of one node, as of a model with boundary conditions."""
    return "\n".join(line for line in text.split() if not line.startswith("680."))


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda files: files.pop("dofs"), r"bar.sti: expected the node .* of its rows, found none"),
        (lambda files: files.pop("mass"), r"matrices.mass: expected a file, for bar.sti holds one"),
        (
            lambda files: files.update(dofs=written(files, "680.1\n680.x\n")),
            r"spoiled.dof: expected 'label.dof', found '680.x'",
        ),
        (
            lambda files: files.update(dofs=written(files, held(files["dofs"].read_text()))),
            r"spoiled.dof: expected a row for each of the 96 of bar.sti, found 93",
        ),
    ],
)
def test_mistakes_with_files_of_calculix(calculix, spoil, message):
    spoil(calculix)
    with pytest.raises(MatrixError, match=message):
        assemble(body(ENDS, matrices=calculix))


def written(files: dict[str, Path], text: str) -> Path:
    path = files["stiffness"].with_name("spoiled.dof")
    path.write_text(text)
    return path


@pytest.fixture
def nastran(tmp_path) -> dict[str, Path]:
    """A frame as an external superelement: four points, one with axes of its own, and 22 modes."""
    op4 = tmp_path / "outboard.op4"
    op4.write_bytes(lzma.decompress((CODES / "nastran" / "outboard.op4.xz").read_bytes()))
    return {"stiffness": op4, "nodes": CODES / "nastran" / "outboard.asm"}


def test_rows_of_nastran_are_in_the_order_of_labels(nastran, tmp_path):
    """Whatever the order of the cards."""
    head, *grids = nastran["nodes"].read_text().partition("$ SPOINT DATA")[0].split("GRID*")
    scalars = nastran["nodes"].read_text().partition("$ SPOINT DATA")[2]
    text = head + scalars + "".join(f"GRID*{grid}" for grid in reversed(grids))
    (tmp_path / "mixed.asm").write_text(text)
    given = {**nastran, "nodes": tmp_path / "mixed.asm"}
    found = assemble(body(CORNERS, matrices=given)).rigid
    assert found.center == pytest.approx([184.6398, 150.0, 150.0], rel=1e-6)


CORNERS = {"one": {"nodes": [3]}, "other": {"nodes": [11]}}


def test_nastran_superelement_has_the_mass_that_nastran_prints(nastran):
    """Those of its grid point weight generator, in its units: kg, mm."""
    rigid = assemble(body(CORNERS, matrices=nastran)).rigid
    assert rigid.mass == pytest.approx(1.590384, rel=1e-6)
    assert rigid.center == pytest.approx([184.6398, 150.0, 150.0], rel=1e-6)
    diagonal, product = [3.569328e5, 4.515897e4, 3.763282e5], -1.095583e2
    assert np.diag(rigid.J_rot) == pytest.approx(diagonal, rel=1e-6)
    assert rigid.J_rot[1, 2] == pytest.approx(product, rel=1e-5)


def test_modes_of_a_nastran_superelement_with_its_points_held(nastran):
    """The first and the last eigenvalue that Nastran prints of them."""
    structure = assemble(body(CORNERS, matrices=nastran))
    modal = slice(structure.nodes.n_dofs - structure.nodes.generalized, None)
    K, M = structure.K.toarray()[modal, modal], structure.M.toarray()[modal, modal]
    held = eigh(K, M, eigvals_only=True)
    assert len(held) == 22
    assert held[[0, -1]] == pytest.approx([1.074802e2, 8.818442e6], rel=1e-6)


def test_axes_of_nodes_that_are_ignored_are_refused(nastran, tmp_path):
    """Point 11 has its dofs in system 10: without it the body could not rotate freely."""
    deck = (
        nastran["nodes"].read_text().replace("0.300000000E+03              10", "3.E+2" + 27 * " ")
    )
    (tmp_path / "basic.asm").write_text(deck)
    with pytest.raises(MatrixError, match=r"no resistance to rigid motion.*dofs? "):
        assemble(body(CORNERS, matrices={**nastran, "nodes": tmp_path / "basic.asm"}))


def test_punched_matrices_are_those_of_op4(nastran, tmp_path):
    """DMIG of the same matrices, by labels in another order, of one the lower half alone."""
    whole = assemble(body(CORNERS, matrices=nastran))
    names = {"KAAX": STIFFNESS_NAMES, "MAAX": MASS_NAMES}
    dofs = [(node, i) for node in (3, 11, 19, 27) for i in range(1, 7)]
    dofs += [(1995001 + i, 0) for i in range(22)]
    text = "$ punched\n"
    for name, of_file in names.items():
        text += dmig(name, read_op4(nastran["stiffness"], of_file).toarray(), dofs)
    (tmp_path / "part.pch").write_text(text)
    punched = assemble(body(CORNERS, matrices={**nastran, "stiffness": tmp_path / "part.pch"}))
    for one, other in ((punched.K, whole.K), (punched.M, whole.M)):
        # Ten digits are what fields of 16 letters hold.
        assert (abs(one - other) - 1e-9 * abs(other)).max() <= 1e-16 * abs(other).max()


def dmig(name: str, matrix: Any, dofs: list[tuple[int, int]]) -> str:
    """Cards of a symmetric matrix, the last column first."""
    text = f"DMIG    {name:8}{0:8}{6:8}{2:8}{0:8}\n"
    for j in reversed(range(len(dofs))):
        rows = [i for i in range(j, len(dofs)) if matrix[i, j]]
        if rows:
            text += f"DMIG*   {name:16}{dofs[j][0]:16}{dofs[j][1]:16}\n"
        for i in rows:
            text += f"*       {dofs[i][0]:16}{dofs[i][1]:16}{matrix[i, j]:16.9E}\n"
    return text


def test_matrices_that_nastran_punched(tmp_path):
    """A square one with j in column j, and a symmetric one with ones on its diagonal."""
    packed = CODES / "nastran" / "matrix_factory.pch.xz"
    path = tmp_path / "matrix_factory.pch"
    path.write_bytes(lzma.decompress(packed.read_bytes()))
    pattern, dofs = read_dmig(path, ("PATRN",))
    assert dofs.tolist()[:2] + dofs.tolist()[-2:] == [[1, 1], [1, 2], [11, 0], [12, 0]]
    np.testing.assert_array_equal(pattern.toarray(), np.ones((21, 1)) * np.arange(1, 22))
    np.testing.assert_array_equal(read_dmig(path, ("IDENT",))[0].toarray(), np.eye(21))
    with pytest.raises(MatrixError, match=r"expected a matrix KGG, .* found PATRN, IDENT"):
        read_dmig(path, STIFFNESS_NAMES)


@pytest.fixture(scope="module")
def ansys() -> Path:
    """A cantilever of 40 SOLID186 that comes with the reader, of which 21 nodes are held."""
    return ansys_examples() / "file.full"


def test_rows_of_ansys_belong_to_its_nodes(ansys):
    """Where no neighbor is held, rigid motions of the nodes of the archive make no force.

    With a wrong order of rows or of dofs they would. The archive has the mesh of the same beam.
    """
    theme = pyvista.global_theme
    before = theme.cmap, theme.font.family, theme.title
    full = read_full(ansys)
    assert (theme.cmap, theme.font.family, theme.title) == before
    assert len(full.constrained) == 63
    with pytest.warns(MeshWarning, match="materials"):
        mesh = read_mesh(ansys.with_name("HexBeam.cdb"))
    node = np.searchsorted(mesh.labels, full.dofs[:, 0])
    motion = spider(mesh.points)[node, full.dofs[:, 1] - 1]
    K = (full.K + sp.triu(full.K, 1).T).tocsr()[mesh.points[node, 2] > 0.6]
    assert np.abs(K @ motion).max() <= 1e-12 * np.abs(K.data).max()


def test_a_constrained_model_of_ansys_is_refused(ansys, calculix):
    files = {"stiffness": ansys, "nodes": calculix["nodes"]}
    with pytest.raises(MatrixError, match=r"file.full: .*free body, found 63 constrained dofs"):
        assemble(body(ENDS, matrices=files))


def test_a_free_body_of_ansys(calculix, tmp_path, monkeypatch):
    """What the reader gives: upper halves, and dofs from 0, of nodes in the order of labels."""
    whole = assemble(body(ENDS, matrices=calculix))
    order = np.arange(whole.nodes.n_dofs).reshape(-1, 3)[::-1].ravel()
    K, M = (sp.triu(matrix.tocsr()[order][:, order]) for matrix in (whole.K, whole.M))
    labels = np.array(
        [int(word.partition(".")[0]) for word in calculix["dofs"].read_text().split()]
    )
    nodes = np.unique(labels)

    class Reader:
        const = np.zeros((0, 2))

        def __init__(self, path: str) -> None:
            self._header = {"ptrEND": 1}

        def load_km(self, sort: bool) -> Any:
            return np.column_stack([np.repeat(nodes, 3), np.tile([0, 1, 2], len(nodes))]), K, M

    monkeypatch.setattr(ansys_full, "_reader", lambda: Reader)
    (tmp_path / "file.full").write_bytes(bytes(8))
    files = {"stiffness": tmp_path / "file.full", "nodes": calculix["nodes"]}
    found = assemble(body(ENDS, matrices=files))
    assert frequencies(found)[6:] == pytest.approx(frequencies(whole)[6:], rel=1e-12)


def test_without_the_reader_of_ansys(ansys, calculix, monkeypatch):
    monkeypatch.setitem(sys.modules, "ansys.mapdl.reader.full", None)
    with pytest.raises(MatrixError, match=r"file.full: .* pip install 'duhamel\[ansys\]'"):
        assemble(body(ENDS, matrices={"stiffness": ansys, "nodes": calculix["nodes"]}))


def test_a_file_of_ansys_that_breaks_off(ansys, calculix, tmp_path):
    for size in (700_000, 3000, 100, 0):
        broken = tmp_path / "broken.full"
        broken.write_bytes(ansys.read_bytes()[:size])
        files = {"stiffness": broken, "nodes": calculix["nodes"]}
        with pytest.raises(MatrixError, match=r"broken.full: (expected 801596 bytes|not a .full)"):
            assemble(body(ENDS, matrices=files))


def fields(**source: Any) -> Any:
    """The recovery of the bar of CalculiX, and its modal compliance at points of the surface."""
    made = build(body(ENDS, recovery={"stress": True}, rotation={"modes": 2}, **source))
    assert made.recovery.stress is not None
    flexibility = np.where(made.modes.omega > 0, 1.0 / np.maximum(made.modes.omega, 1.0) ** 2, 0.0)
    response = flexibility * made.modes.phi[0]
    return made, made.recovery.phi @ response, made.recovery.stress @ response


def test_recovery_and_stiffening_by_elements_beside_the_matrices(calculix):
    """Static displacements and stresses under a force are those of the mesh, and second order."""
    given, u, stress = fields(matrices=calculix, material=STEEL)
    with pytest.warns(MeshWarning):
        own, own_u, own_stress = fields(mesh=calculix["nodes"], material=STEEL)
    np.testing.assert_array_equal(given.outline.cells, own.outline.cells)
    np.testing.assert_array_equal(given.recovery.nodes, own.recovery.nodes)
    assert np.abs(u - own_u).max() <= 1e-9 * np.abs(own_u).max()
    assert np.abs(stress - own_stress).max() <= 1e-9 * np.abs(own_stress).max()
    assert np.abs(own.rotation.kappa).max() > 0.0
    np.testing.assert_allclose(given.rotation.kappa, own.rotation.kappa, rtol=1e-9)


def test_elements_that_do_not_fit_leave_the_matrices_without_an_outline(calculix, tmp_path):
    """A linear hexahedron beside a quadratic one, as ties connect them."""
    text = calculix["nodes"].read_text()
    lines = text.splitlines()
    last = next(i for i, line in enumerate(lines) if line.startswith("2, "))
    lines[last] = ", ".join(lines[last].split(", ")[:9])
    lines[last + 1] = "** nodes of edges"
    lines.insert(last, "*ELEMENT, TYPE=C3D8, ELSET=BAR")
    (tmp_path / "tied.inp").write_text("\n".join(lines))
    with pytest.warns(MeshWarning, match=r"tied.inp: no outline: "):
        made = build(body(ENDS, matrices={**calculix, "nodes": tmp_path / "tied.inp"}))
    assert made.outline is None


def test_a_reduced_model_has_an_outline_and_no_fields(substructure):
    files = substructure[0]
    assert len(build(body(ENDS, matrices=files)).outline.points) == 32
    with pytest.raises(BodyError, match=r"\[recovery\]: expected dofs at all nodes .* reduced"):
        build(body(ENDS, matrices=files, recovery={}))


@pytest.mark.parametrize(
    ("material", "message"),
    [
        ({}, r"recovery.stress: expected \[material\], for the matrices bar.sti, bar.mas do not"),
        (
            {"material": {**STEEL, "E": 210e3}},
            r"material: expected that of the matrices .* the elements are 1e-06 times as stiff",
        ),
    ],
)
def test_stresses_take_the_material_of_the_matrices(calculix, material, message):
    with pytest.raises(BodyError, match=message):
        build(body(ENDS, matrices=calculix, recovery={"stress": True}, **material))


@pytest.mark.parametrize(
    ("name", "matrix", "tolerance"), [("double_le", "ZUZR01", 1e-14), ("single_be", "ZUZR04", 1e-7)]
)
def test_a_matrix_that_nastran_wrote_with_output2(tmp_path, name, matrix, tolerance):
    """Nastran read it from the OUTPUT4 file, and wrote it in both orders of bytes."""
    packed = CODES / "nastran"
    for file in (f"{name}.op2", "r_c_rc.op4"):
        (tmp_path / file).write_bytes(lzma.decompress((packed / f"{file}.xz").read_bytes()))
    found = read_op2(tmp_path / f"{name}.op2", (matrix,)).toarray()
    expected = read_op4(tmp_path / "r_c_rc.op4", ("RMAT",)).toarray()
    assert np.abs(found - expected).max() <= tolerance * np.abs(expected).max()


def test_files_of_output2_that_are_refused(tmp_path, calculix):
    whole = lzma.decompress((CODES / "nastran" / "double_le.op2.xz").read_bytes())
    path = tmp_path / "part.op2"
    for data, message in (
        (whole, r"part.op2: expected a matrix KGG, .* found ZUZR01, ZUZR02, ZUZR03"),
        (
            whole.replace(b"ZUZR02", b"KGG   "),
            r"part.op2: matrix KGG: .* real numbers, found type 4",
        ),
        (whole.replace(b"ZUZR01", b"KGG   "), r"part.op2: expected a square matrix, found 25 rows"),
        (whole[:3000], r"part.op2: not an OUTPUT2 file of Nastran, or one that breaks off"),
        (b"", r"part.op2: not an OUTPUT2 file of Nastran"),
        (b"NASTRAN", r"part.op2: not an OUTPUT2 file of Nastran"),
    ):
        path.write_bytes(data)
        with pytest.raises(MatrixError, match=message):
            assemble(body(ENDS, matrices={"stiffness": path, "nodes": calculix["nodes"]}))
