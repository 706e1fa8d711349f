"""Bodies of CAD files have the mass, inertia and frequencies of the part, and say what is wrong."""

from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("gmsh")

import duhamel as du
from duhamel import preprocess
from duhamel.inputs import InputError
from duhamel.preprocess.plausibility import _of_volume
from duhamel.preprocess.sources.cad import mesh_of_cad
from duhamel.preprocess.sources.reading import read_mesh_source
from duhamel.preprocess.survey import survey
from duhamel.superelement import sha256
from duhamel.view import draw_scene

from .parts import bar, block, hub, write

STEEL = du.Material(E=210e9, nu=0.3, rho=7850.0)
BORE = du.hole([0.03, 0.02, 0.01], radius=0.008)


@pytest.fixture(scope="module")
def block_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("cad") / "block.step", block)


def part(path: Path, size: float = 6e-3, **more: Any) -> du.Part:
    made = du.Part.from_step(path, STEEL, size, **more)
    made.interface("bore", BORE)
    made.interface("side", du.face([0.0, 0.02, 0.01]))
    return made


def test_mass_and_inertia_are_those_of_a_block_with_a_hole(block_file: Path) -> None:
    """Curved edges leave the fourth order of the angle of an element, 5e-5 of the hole."""
    a, b, c, r = 0.06, 0.04, 0.02, 0.008
    box, bore = 7850.0 * a * b * c, 7850.0 * pi * r**2 * c
    rigid = preprocess.assemble(part(block_file).body(step=1e-5)).rigid
    assert rigid.mass == pytest.approx(box - bore, rel=2e-5)
    np.testing.assert_allclose(rigid.center, [0.03, 0.02, 0.01], atol=1e-7)
    J = np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2]) / 12.0 * box
    J -= bore * np.array([3 * r**2 + c**2, 3 * r**2 + c**2, 6 * r**2]) / 12.0
    np.testing.assert_allclose(np.diag(rigid.J_rot), J, rtol=2e-5)


def test_interfaces_are_on_the_axis_of_the_hole_and_on_the_face(block_file: Path) -> None:
    body = part(block_file, 1e-2).body(step=1e-5)
    structure, mesh = preprocess.assemble(body), read_mesh_source(body).mesh
    bore, side = structure.frames["bore"], structure.frames["side"]
    np.testing.assert_allclose(bore.X, [0.03, 0.02, 0.01], atol=1e-6)
    assert bore.area == pytest.approx(2.0 * pi * 0.008 * 0.02, rel=1e-3)
    np.testing.assert_allclose(side.X, [0.0, 0.02, 0.01], atol=1e-12)
    assert side.area == pytest.approx(0.04 * 0.02, rel=1e-12)
    across = np.linalg.norm(mesh.points[bore.nodes, :2] - [0.03, 0.02], axis=1)
    np.testing.assert_allclose(across, 0.008, rtol=1e-9)  # middle nodes too


def test_a_mesh_of_another_volume_than_its_solid_is_told(block_file: Path) -> None:
    source = read_mesh_source(part(block_file, 1e-2).body(step=1e-5))
    assert not list(_of_volume(source))
    smaller = replace(source.geometry, volume=0.99 * source.geometry.volume)
    other = replace(source, mesh=replace(source.mesh, geometry=smaller))
    (doubt,) = _of_volume(other)
    assert "+1 % beside the 4.354e-05 m^3" in doubt


def test_a_measured_part_is_meshed_once(
    block_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the mass that was weighed makes another body of it; by both commands."""
    corners = [[0.0, 0.0, 0.0], [0.06, 0.0, 0.0], [0.0, 0.04, 0.0], [0.06, 0.04, 0.02]]
    rows = [f"p{k}, {x}, {y}, {z}, {a}" for k, (x, y, z) in enumerate(corners) for a in "xyz"]
    (tmp_path / "channels.csv").write_text("\n".join(["label, x, y, z, axis", *rows]))
    tested = part(block_file, 1e-2)
    for k, corner in enumerate(corners):
        tested.sensor(f"p{k}", corner)
    element = tested.superelement(step=2e-6)
    lowest = np.argsort(element.modes.omega)[:3]
    np.savez(
        tmp_path / "modes.npz",
        frequency=0.97 * element.modes.omega[lowest] / (2.0 * pi),
        damping=np.full(3, 0.01),
        shapes=element.channels.phi[:, lowest].T,
    )
    made = part(block_file, 1e-2)
    made.measured(tmp_path / "modes.npz", tmp_path / "channels.csv", mass=1.1 * element.mass)
    body, meshed = made.body(step=2e-6), []

    def counted(*given: Any) -> Any:
        meshed.append(given)
        return mesh_of_cad(*given)

    monkeypatch.setattr("duhamel.preprocess.sources.reading.mesh_of_cad", counted)
    assert preprocess.build(body).mass == pytest.approx(1.1 * element.mass, rel=1e-9)
    assert survey(body).structure.rigid.mass == pytest.approx(1.1 * element.mass, rel=1e-9)
    assert len(meshed) == 2  # one for each


def test_frames_stand_on_the_axis_of_holes_with_keyways_and_of_half_shells(tmp_path: Path) -> None:
    """Where the centroid of their facets is not; and on the axis of what a box leaves of them."""
    made = du.Part.from_step(write(tmp_path / "hub.step", hub), STEEL, 6e-3)
    bore, half = du.hole([0.02, 0.018, 0.01]), du.face([0.02, 0.035, 0.01])
    made.interface("bore", bore)
    made.interface("seat", half)
    lower = du.box([0.0, 0.0, -0.001], [0.04, 0.04, 0.0125])
    made.interface("lower", bore & lower)
    frames = preprocess.assemble(made.body(step=1e-5)).frames
    np.testing.assert_allclose(frames["bore"].X, [0.02, 0.018, 0.01], atol=1e-9)
    np.testing.assert_allclose(frames["seat"].X, [0.02, 0.04, 0.01], atol=1e-9)
    assert frames["bore"].fit.middle[0] < 0.0195
    assert frames["seat"].fit.middle[1] < 0.037
    X = frames["lower"].X
    np.testing.assert_allclose(X[:2], [0.02, 0.018], atol=1e-9)
    assert 0.002 < X[2] < 0.0063


def test_a_bar_of_steel_rings_as_the_standard_for_youngs_modulus_says(tmp_path: Path) -> None:
    """ASTM E1876, equations 1 and 2: E = 0.9465 (m f^2 / b) (L / t)^3 T, free at both ends."""
    made = du.Part.from_step(write(tmp_path / "bar.step", bar), STEEL, 8e-3)
    made.interface("end", du.face([0.0, 0.0, 0.0]))
    found = made.superelement(step=2e-5, band=2000.0).modes
    assert found is not None
    ratio, nu = 0.01 / 0.4, 0.3
    T = 1.0 + 6.585 * (1.0 + 0.0752 * nu + 0.8109 * nu**2) * ratio**2
    expected = ratio / 0.4 * np.sqrt(210e9 / (0.9465 * 7850.0 * T))
    np.testing.assert_allclose(found.frequencies[:2], expected, rtol=3e-4)


def test_the_same_file_gives_the_same_superelement_which_names_it(block_file: Path) -> None:
    one, two = (part(block_file, 1.5e-2).superelement(step=2e-5) for _ in range(2))
    assert one.modes is not None
    assert two.modes is not None
    np.testing.assert_array_equal(one.modes.phi, two.modes.phi)
    np.testing.assert_array_equal(one.outline.points, two.outline.points)
    assert one.provenance.mesh_sha256 == sha256(block_file)
    assert one.provenance.versions["gmsh"].startswith("4.")
    assert one.provenance.mesh.startswith("block.step: ")
    assert " tetrahedra, shape " in one.provenance.mesh


def test_a_smaller_size_on_a_hole_refines_there_alone(block_file: Path) -> None:
    def meshed(fine: float | None) -> tuple[int, int]:
        made = part(block_file, 1e-2)
        if fine is not None:
            made.refine("bore", BORE, fine)
        groups = read_mesh_source(made.body(step=1e-5)).mesh.groups
        bore, side = groups[str(BORE)], groups["face near [0.0, 0.02, 0.01]"]
        return len(bore.cells["triangle6"]), len(side.cells["triangle6"])

    (bore, side), (fine_bore, fine_side) = meshed(None), meshed(2e-3)
    assert fine_bore >= 2.0 * 2.0 * pi * 8.0 * 20.0 / 2.0**2  # two triangles a square, near enough
    assert fine_bore > 4 * bore
    assert fine_side <= 2 * side


def test_the_dry_run_lists_what_picks_each_hole_and_face(block_file: Path, tmp_path: Path) -> None:
    from duhamel.cli.survey import features_to_copy, scene

    surveyed = survey(part(block_file, 1.5e-2).body(step=1e-5))
    _, *lines = features_to_copy(surveyed)
    assert len(lines) == 7
    assert lines[0] == (
        "hole = {near = [0.03, 0.02, 0.01], radius = 0.008}  # 1: hole of radius 0.008 m, length "
        "0.02 m, center [0.03, 0.02, 0.01], axis [0.0, 0.0, 1.0]"
    )
    copied = [f"[interfaces.copy_{i}]\n{line}" for i, line in enumerate(lines)]
    head = (
        f'name = "block"\nmesh = "{block_file}"\nsize = 0.015\n[impulse]\nstep = 1e-5\nsteps = 9\n'
    )
    material = "[material]\nE = 210e9\nnu = 0.3\nrho = 7850\n"
    path = tmp_path / "body.toml"
    path.write_text(head + material + "\n".join(copied), encoding="utf-8")
    body = preprocess.read_body(path)
    assert isinstance(body, preprocess.Body)
    again = preprocess.assemble(body).frames
    assert len({attachment.X.tobytes() for attachment in again.values()}) == 7
    names = {mark.name for mark in scene(surveyed).masses}
    assert names == {str(number) for number in range(1, 8)}
    assert "1" in {
        text.get_text() for axes in draw_scene(scene(surveyed)).axes for text in axes.texts
    }


def body(mesh: str, **more: Any) -> preprocess.Body:
    table = {
        "name": "part",
        "mesh": mesh,
        "material": STEEL,
        "interfaces": {"bore": {"hole": {"near": [0.0, 0.0, 0.0]}}},
        "impulse": {"step": 1e-5, "steps": 10},
        **more,
    }
    return preprocess.Body.model_validate(table)


@pytest.mark.parametrize(
    ("mesh", "more", "expected"),
    [
        ("a.step", {}, r"size: expected that of the elements of a\.step \[m\], found none"),
        ("a.step", {"size": 0.0}, "size\n.*greater than 0"),
        ("a.stp", {"size": 1e-3, "scale": 1e-3}, r"scale: a\.stp says its unit of length itself"),
        ("a.brep", {"size": 1e-3}, r"scale: \.brep files do not say their unit of length"),
        ("a.IGES", {"size": 1e-3, "order": 2}, "order: CAD files are meshed by tetrahedra of ten"),
        ("a.msh", {}, r"interfaces\.bore\.hole: is for CAD files .*, found a\.msh"),
        (
            "a.msh",
            {"size": 1e-3, "interfaces": {"a": {"group": "a"}}},
            r"size: is for CAD files \(\.step, \.iges, \.brep\), found a\.msh",
        ),
        (
            "a.step",
            {"size": 1e-3, "sizes": {"b": {"size": 2e-3, "face": {"near": [0.0, 0.0, 0.0]}}}},
            r"sizes\.b\.size: expected at most size = 0\.001, found 0\.002",
        ),
        (
            "a.step",
            {"size": 1e-3, "sizes": {"b": {"size": 1e-4}}},
            "expected hole or face, found neither",
        ),
        (
            "a.step",
            {"size": 1e-3, "interfaces": {"a": {"group": "a", "face": {"near": [0.0, 0.0, 0.0]}}}},
            "expected one of group, hole and face, found group and face",
        ),
        (
            "a.step",
            {"size": 1e-3, "loads": {"a": {"force_per_volume": [0, 0, 1.0]}}},
            None,
        ),
    ],
)
def test_keys_of_cad_files_are_checked(
    mesh: str, more: dict[str, Any], expected: str | None
) -> None:
    if expected is None:
        assert body(mesh, **more).size == 1e-3
        return
    with pytest.raises((ValueError, InputError), match=expected):
        body(mesh, **more)


@pytest.mark.parametrize(
    ("size", "expected"),
    [
        (1e-6, r"size: 1e-06 m would make about .* elements, expected at most"),
        (1.0, r"size: expected that of elements, less than the 0\.0748 m of the part, found 1 m"),
    ],
)
def test_absurd_sizes_are_refused(block_file: Path, size: float, expected: str) -> None:
    with pytest.raises(preprocess.MeshError, match=rf"block\.step: {expected}"):
        preprocess.assemble(part(block_file, size).body(step=1e-5))


def test_a_hole_that_is_not_there_names_the_interface(block_file: Path) -> None:
    made = part(block_file)
    made.interface("bolt", du.hole([0.01, 0.02, 0.01]))
    with pytest.raises(
        preprocess.MeshError,
        match=r"block\.step: interfaces\.bolt\.hole: no hole at \[0\.01, 0\.02, 0\.01\].*; nearest "
        r"of 1 are \[m\]: hole of radius 0\.008 at \[0\.03, 0\.02, 0\.01\] .*, 0\.012 m away",
    ):
        preprocess.assemble(made.body(step=1e-5))


def test_a_part_of_cad_is_written_and_read_again(block_file: Path, tmp_path: Path) -> None:
    made = part(block_file, 1e-2)
    made.refine("bore", BORE, 4e-3)
    made.write(tmp_path / "block.toml", step=1e-5)
    read = preprocess.read_body(tmp_path / "block.toml")
    assert isinstance(read, preprocess.Body)
    assert read.sizes["bore"].hole == BORE.hole
    np.testing.assert_array_equal(
        preprocess.assemble(read).rigid.J_rot, preprocess.assemble(made.body(step=1e-5)).rigid.J_rot
    )


def test_the_path_of_a_cad_file_is_no_mesh(block_file: Path) -> None:
    with pytest.raises(preprocess.BodyError, match=r"use du\.Part\.from_step"):
        du.Part(block_file, STEEL)
    with pytest.raises(preprocess.MeshError, match="is geometry, no mesh"):
        preprocess.mesh_of(block_file)
