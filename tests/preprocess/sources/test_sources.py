"""Sources of bodies: one protocol for lines, solids and matrices; solids from one record each."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess import Body, BodyError, assemble
from duhamel.preprocess.assembly.structure import assemble_on
from duhamel.preprocess.mesh.cells import SOLID_TYPES
from duhamel.preprocess.mesh.mesh import Mesh
from duhamel.preprocess.recovery import recover
from duhamel.preprocess.sources import solids
from duhamel.preprocess.sources.reading import read_mesh_source, read_source
from duhamel.preprocess.sources.solids import SolidSource
from duhamel.preprocess.survey import survey


@pytest.fixture
def given(solid_body, box, tmp_path):
    """The matrices of a block, as another program would give them."""
    block = assemble(solid_body(box("hexahedron")))
    sp.save_npz(tmp_path / "K.npz", block.K)
    sp.save_npz(tmp_path / "M.npz", block.M)
    np.savez(tmp_path / "nodes.npz", points=block.nodes.points)
    return Body.model_validate(
        {
            "name": "block",
            "matrices": {
                "stiffness": tmp_path / "K.npz",
                "mass": tmp_path / "M.npz",
                "nodes": tmp_path / "nodes.npz",
            },
            "interfaces": {"corner": {"node": block.nodes.points[0].tolist()}},
            "impulse": {"step": 1e-4, "steps": 20},
        }
    )


@pytest.fixture(params=["lines", "solids", "matrices"])
def body(request, beam_body, beam, solid_body, box):
    match request.param:
        case "lines":
            return beam_body(beam(4))
        case "solids":
            return solid_body(box("tetra10"))
        case _:
            return request.getfixturevalue("given")


def test_every_source_is_a_free_body_on_its_dofs(body):
    source = read_source(body)
    K, M = source.matrices()
    assert K.shape == M.shape == (source.nodes.n_dofs, source.nodes.n_dofs)
    assert abs(K - K.T).max() == abs(M - M.T).max() == 0.0
    A = source.nodes.rigid_motion(np.zeros(3))
    np.testing.assert_allclose(K @ A, 0.0, atol=1e-9 * abs(K).max() * np.abs(A).max())
    structure = assemble(body)
    assert list(structure.frames) == list(body.interfaces)
    assert structure.T.shape == (3 * len(source.nodes.points), structure.n_u)


def test_matrices_have_neither_fields_nor_a_picture(given):
    with pytest.raises(
        BodyError, match=r"\[recovery\]: expected a mesh, found the matrices K.npz, M"
    ):
        read_source(given).check_fields(stress=False)
    with pytest.raises(BodyError, match=r"dry run .* found \[matrices\]"):
        read_mesh_source(given)


def test_a_survey_finds_facets_and_frames_once(solid_body, box, monkeypatch):
    counted = []
    facets_of, attachment = solids.facets_of, SolidSource.attachment
    monkeypatch.setattr(solids, "facets_of", lambda mesh: counted.append("f") or facets_of(mesh))
    monkeypatch.setattr(
        SolidSource, "attachment", lambda *args: counted.append("a") or attachment(*args)
    )
    masses = {"tip": {"mass": 1.0, "interface": "tip"}}
    found = survey(solid_body(box("hexahedron"), masses=masses))
    list(found.boundary())
    assert sorted(counted) == ["a", "a", "f"]
    assert found.masses["tip"] is found.interfaces["tip"]


@pytest.mark.parametrize("solid", SOLID_TYPES)
def test_a_solid_is_one_record(solid, solid_body, box, monkeypatch):
    """Under another name, which stands in one table alone, it gives the same to the last bit."""
    body = solid_body(box(solid), recovery={"stress": True})
    source = read_mesh_source(body)
    monkeypatch.setitem(SOLID_TYPES, "another", replace(SOLID_TYPES[solid]))
    mesh = source.mesh
    cells = {"another" if kind == solid else kind: rows for kind, rows in mesh.cells.items()}
    groups = {}
    for name, group in mesh.groups.items():
        members = {"another" if k == solid else k: rows for k, rows in group.cells.items()}
        groups[name] = replace(group, cells=members)
    renamed = SolidSource(Mesh(mesh.name, mesh.points, cells, groups, ("another",)), body)

    one, other = assemble_on(body, source), assemble_on(body, renamed)
    for name in ("K", "M", "P_C"):
        assert abs(getattr(one, name) - getattr(other, name)).max() == 0.0
    u = np.random.default_rng(0).normal(size=(one.n_u, 2))
    fields = [
        recover(body, s, t, lambda rows: rows @ u) for s, t in ((source, one), (renamed, other))
    ]
    np.testing.assert_array_equal(fields[0].stress, fields[1].stress)
    assert source.shares() == renamed.shares()
    assert source.resolution(1e3) == renamed.resolution(1e3)
