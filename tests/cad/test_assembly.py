"""An assembly becomes body files and a model, in which its parts are where they were."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("gmsh")

from duhamel import preprocess, solver, superelement
from duhamel.cad import CadError
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
