"""Holes, shafts and faces are those that the part was made with, in meters, whatever its file."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("gmsh")

from duhamel.cad import CadError, Feature, mesh_solid, solids_in
from duhamel.cad.picking import Pick, picked

from .parts import block, fork, in_unit, plate, two, write


def features(path: Path, unit: float | None = None) -> tuple[Feature, ...]:
    (found,) = solids_in(path, unit).values()
    return found.features


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cad")


@pytest.fixture(scope="module")
def plate_file(folder: Path) -> Path:
    return write(folder / "plate.step", plate)


@pytest.fixture(scope="module")
def plate_features(plate_file: Path) -> tuple[Feature, ...]:
    return features(plate_file)


def test_holes_are_whole_and_neither_slots_nor_fillets(
    plate_features: tuple[Feature, ...],
) -> None:
    holes = sorted((f.radius, f.length, f.center) for f in plate_features if f.kind == "hole")
    expected = [
        (0.004, 0.005, (0.02, 0.03, 0.0025)),
        (0.006, 0.008, (0.05, 0.015, 0.004)),  # whose halves are two faces of the file
        (0.007, 0.003, (0.02, 0.03, 0.0065)),
    ]
    for hole, (radius, length, center) in zip(holes, expected, strict=True):
        assert hole[:2] == pytest.approx((radius, length), rel=1e-9)
        np.testing.assert_allclose(hole[2], center, atol=1e-9)
    assert len([f for f in plate_features if f.kind == "curved"]) == 3  # slot ends and fillet


def test_a_boss_is_a_shaft_and_planes_point_outwards(plate_features: tuple[Feature, ...]) -> None:
    (boss,) = (f for f in plate_features if f.kind == "shaft")
    assert (boss.radius, boss.length, boss.center) == (0.005, 0.012, (0.05, 0.042, 0.014))
    by_normal = {
        f.axis for f in plate_features if f.kind == "plane" and min(f.center[0], f.center[1]) < 1e-9
    }
    assert by_normal == {(-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)}
    # The floor of the counterbore looks up, as the top does; the underside looks down.
    heights = {f.center[2]: f.axis[2] for f in plate_features if abs(f.axis[2]) == 1.0}
    assert heights[0.005] == heights[0.008] == 1.0
    assert heights[0.0] == -1.0


def test_holes_in_one_line_are_two_where_a_gap_is_between(folder: Path) -> None:
    holes = [f for f in features(write(folder / "fork.step", fork)) if f.kind == "hole"]
    assert sorted(hole.center[0] for hole in holes) == [0.004, 0.036]
    assert {hole.axis for hole in holes} == {(1.0, 0.0, 0.0)}


@pytest.mark.parametrize(("unit", "meters"), [("M", 1.0), ("INCH", 0.0254)])
def test_step_says_its_unit(folder: Path, unit: str, meters: float) -> None:
    path = in_unit(write(folder / "block.step", block), unit)
    hole = features(path)[0]
    assert hole.kind == "hole"
    assert hole.radius == pytest.approx(8.0 * meters, rel=1e-9)
    np.testing.assert_allclose(hole.center, np.array([30, 20, 10]) * meters, rtol=1e-9)


def test_iges_has_loose_faces_that_close_a_solid_and_brep_no_unit(folder: Path) -> None:
    of_step = features(write(folder / "block.step", block))
    of_iges = features(write(folder / "block.igs", block))
    of_brep = features(write(folder / "block.brep", block), 0.01)
    for iges, brep, step in zip(of_iges, of_brep, of_step, strict=True):
        assert iges.kind == brep.kind == step.kind
        np.testing.assert_allclose(iges.center, step.center, atol=1e-8)
        np.testing.assert_allclose(brep.center, 10.0 * np.array(step.center), atol=1e-8)


def pick(near: tuple[float, float, float], radius: float | None = None, kind: str = "hole") -> Pick:
    return Pick(f"interfaces.a.{kind}", kind, near, radius, 1e-3, "a")  # type: ignore[arg-type]


def found(chosen: Pick, among: tuple[Feature, ...]) -> Feature:
    """By the planes and cylinders themselves, without the edges of faces."""

    def distance(face: int, point: np.ndarray) -> float:
        feature = next(f for f in among if face in f.faces)
        return abs(float((point - np.array(feature.near)) @ feature.axis))

    return picked(chosen, among, distance, 0.117)


def test_where_holes_meet_the_radius_picks_one(plate_features: tuple[Feature, ...]) -> None:
    between = (0.02, 0.03, 0.005)
    with pytest.raises(CadError, match=r"interfaces\.a\.hole: expected one hole .*, found 2: "):
        found(pick(between), plate_features)
    assert found(pick(between, 0.004), plate_features).radius == pytest.approx(0.004)
    assert found(pick(between, 0.00702), plate_features).radius == pytest.approx(0.007)


def test_a_hole_that_is_not_there_lists_those_that_are(plate_features: tuple[Feature, ...]) -> None:
    with pytest.raises(CadError, match="no hole") as raised:
        found(pick((0.05, 0.015, 0.004), 0.0065), plate_features)
    nearest, *others = str(raised.value).partition("[m]: ")[2].split("; ")
    assert nearest.startswith("hole of radius 0.006 at [0.05, 0.015, 0.004] along [0.0, 0.0, 1.0]")
    assert len(others) == 2
    with pytest.raises(CadError, match="1 m away"):
        found(pick((0.05, 0.015, 1.008)), plate_features)


def test_a_point_of_an_edge_is_on_two_faces(plate_file: Path, tmp_path: Path) -> None:
    with pytest.raises(CadError, match=r"expected one face at .*, found 2: plane .*; plane "):
        mesh_solid(plate_file, tmp_path / "a.msh", 0.01, [pick((0.05, 0.06, 0.0), kind="face")])


def test_one_of_several_solids_is_named(folder: Path, tmp_path: Path) -> None:
    path = write(folder / "two.step", two)
    names = list(solids_in(path))
    assert len(set(names)) == 2
    with pytest.raises(CadError, match="expected one solid, found 2: name one by `solid`"):
        mesh_solid(path, tmp_path / "a.msh", 0.01)
    with pytest.raises(CadError, match="solid: no 'leg', the file has: "):
        mesh_solid(path, tmp_path / "a.msh", 0.01, solid="leg")
    geometry, _ = mesh_solid(path, tmp_path / "a.msh", 0.01, solid=names[1])
    assert [f.kind for f in geometry.features].count("shaft") == 1


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "gmsh cannot use it: Could not read file"),
        ("ISO-10303-21;\nHEADER;\n", "gmsh cannot use it: Could not read file"),
    ],
)
def test_damaged_files_are_named(tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "part.step"
    path.write_text(text)
    with pytest.raises(CadError, match=f"part.step: {expected}"):
        solids_in(path)


def test_without_gmsh_the_extra_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("duhamel.cad.reading.find_spec", lambda name: None)
    with pytest.raises(CadError, match=r"pip install 'duhamel\[cad\]'"):
        solids_in(tmp_path / "part.step")


def test_a_crash_of_gmsh_is_an_error(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    crashing = tmp_path / "python"
    crashing.write_text("#!/bin/sh\nkill -SEGV $$\n")
    crashing.chmod(0o755)
    (tmp_path / "part.step").write_text("")
    monkeypatch.setattr("duhamel.cad.reading.sys.executable", str(crashing))
    with pytest.raises(CadError, match=r"part\.step: gmsh crashed on it \(SIGSEGV\)"):
        solids_in(tmp_path / "part.step")
