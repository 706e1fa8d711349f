"""An assembly becomes body files and a model, in which its parts are where they were."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("gmsh")

from duhamel import preprocess, solver, superelement
from duhamel.cad import CadError, session, solids_in
from duhamel.cli import app
from duhamel.cli.assembly import _parts, import_assembly
from typer.testing import CliRunner

from .parts import block, two, write


@pytest.fixture
def assembly(tmp_path: Path) -> Path:
    """Its parts are called base and arm 1, which is no name of a file."""
    path = write(tmp_path / "two.step", two)
    text = path.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if "PRODUCT('" in line]
    for line, name in zip(lines[1:], ("base", "arm 1"), strict=True):
        old = line.partition("'")[2].partition("'")[0]
        text = text.replace(f"'{old}'", f"'{name}'")
    path.write_text(text, encoding="utf-8")
    return path


def test_the_joint_that_holes_propose_is_at_one_point_of_both_bodies(
    assembly: Path, tmp_path: Path
) -> None:
    model = tmp_path / "machine" / "model.toml"
    model.parent.mkdir()
    imported = import_assembly(assembly, model, size=0.02)
    assert {name: path.name for name, path in imported.bodies.items()} == {
        "base": "base.toml",
        "arm_1": "arm_1.toml",
    }
    masses = {}
    for path in imported.bodies.values():
        element = preprocess.build(preprocess.read_body(path))
        superelement.write(element, path.with_suffix(".h5"))
        masses[element.name] = element.mass
        (frame,) = element.interfaces
        np.testing.assert_allclose(element.center + frame.X, [0.03, 0.03, 0.005], atol=1e-12)
    base = 7850.0 * (0.06 * 0.06 * 0.01 - np.pi * 0.006**2 * 0.01)
    arm = 7850.0 * (0.12 * 0.02 * 0.006 + np.pi * 0.0059**2 * 0.012)
    assert masses == pytest.approx({"base": base, "arm_1": arm}, rel=1e-3)
    text = model.read_text(encoding="utf-8")
    head, _, joint = text.partition("# [[joints]]")
    model.write_text(head + "[[joints]]" + joint.replace("\n# ", "\n"), encoding="utf-8")
    read = solver.read_model(model)
    assert [joint.name for joint in read.joints] == ["joint_1"]
    # Where the bodies are in the file, of which coarse meshes miss the centers by some micrometers.
    arm_center = (0.08 * 14.4 + 0.03 * 1.3123) / 15.7123, 0.03
    np.testing.assert_allclose(
        tomllib.loads(text)["bodies"]["arm_1"]["position"][:2], arm_center, atol=1e-5
    )


def test_the_command_writes_files_once_and_keeps_what_is_there(
    assembly: Path, tmp_path: Path
) -> None:
    run = CliRunner().invoke
    done = run(app, ["import", str(assembly)])
    assert done.exit_code == 0, done.output
    assert "2 bodies, 1 joint to uncomment; steel is assumed" in done.output.replace("\n", " ")
    body = tomllib.loads((tmp_path / "arm_1.toml").read_text(encoding="utf-8"))
    assert (body["mesh"], body["solid"]) == ("two.step", "arm 1")
    (tmp_path / "two-model.toml").unlink()
    before = sorted(tmp_path.iterdir())
    again = run(app, ["import", str(assembly)])
    assert again.exit_code == 1
    assert "base.toml: is there already" in again.output.replace("\n", "")
    assert sorted(tmp_path.iterdir()) == before
    refused = run(app, ["import", str(assembly), "--base", "free"])
    assert "--base: is for robots" in refused.output


def test_no_body_has_the_name_of_the_ground() -> None:
    solids: dict[str, Any] = {"Ground": None, "arm": None}
    names = [part.name for part in _parts(solids, "machine", "model")]
    assert names == ["Ground_2", "arm"]


def test_a_single_part_has_the_name_of_its_file(tmp_path: Path) -> None:
    path = write(tmp_path / "part 7.brep", block)
    with pytest.raises(CadError, match=r"part 7\.brep: expected scale"):
        import_assembly(path, tmp_path / "model.toml")
    imported = import_assembly(path, tmp_path / "model.toml", scale=1e-3)
    body = preprocess.read_body(imported.bodies["part_7"])
    assert isinstance(body, preprocess.Body)
    assert (body.solid, body.scale) == (None, 1e-3)
    assert body.interfaces["hole_1"].hole is not None


FREECAD = Path(__file__).with_name("data") / "two_cubes.step"


def test_parts_of_freecad_have_their_names_places_and_masses(tmp_path: Path) -> None:
    imported = import_assembly(FREECAD, tmp_path / "model.toml", size=5e-3)
    assert list(imported.bodies) == ["Box", "Box001"]
    centers = {}
    for name, path in imported.bodies.items():
        text = path.read_text(encoding="utf-8") + "[interfaces.all]\nbox = {corners = "
        path.write_text(text + "[[-1, -1, -1], [1, 1, 1]]}\n", encoding="utf-8")
        rigid = preprocess.assemble(preprocess.read_body(path)).rigid
        assert rigid.mass == pytest.approx(7850.0 * 1e-6, rel=1e-9)
        centers[name] = rigid.center
    apart = np.abs(centers["Box001"] - centers["Box"])
    np.testing.assert_allclose(apart, [0.01, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "X2"])
def test_names_keep_their_letters_in_every_encoding(tmp_path: Path, encoding: str) -> None:
    """The standard's own, and those that programs write all the same."""
    name = b"Tr\\X2\\00E4\\X0\\ger" if encoding == "X2" else "Träger".encode(encoding)
    renamed = tmp_path / "part.step"
    renamed.write_bytes(FREECAD.read_bytes().replace(b"'Box", b"'" + name))
    assert list(solids_in(renamed)) == ["Träger", "Träger001"]


def test_solids_without_a_name_have_that_of_their_part(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As Creo writes them, whose labels end with a reference and SOLID."""
    label = "Shapes/AS1_ASM/NUT_BOLT/BOLT/BOLT/=>[0:1:1:11]/SOLID"
    monkeypatch.setattr("gmsh.model.getEntityName", lambda *_: label)
    assert session._label(1) == "BOLT"
