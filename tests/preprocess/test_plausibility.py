"""Doubts about units and meshes: told of what is unlike any part, and of nothing else."""

import re
from pathlib import Path

import numpy as np
import pytest
from duhamel.preprocess import build, read_body
from duhamel.preprocess.body.body import Body
from duhamel.preprocess.plausibility import (
    doubts_of_body,
    doubts_of_frequencies,
    doubts_of_mesh,
    doubts_of_source,
)
from duhamel.preprocess.sources.reading import read_source
from duhamel.preprocess.survey import survey

STEEL = {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}


def of_body(body: Body) -> list[str]:
    return list(doubts_of_body(body))


@pytest.mark.parametrize(
    "material",
    [
        STEEL,
        {"E": 7e10, "nu": 0.3, "rho": 2700.0},
        {"E": 3e9, "nu": 0.4, "rho": 1200.0},
        {"E": 1e6, "nu": 0.49, "rho": 1000.0},
        {"E": [12e9, 0.9e9, 0.5e9], "nu": [0.4, 0.5, 0.7], "G": [8e8, 7e8, 5e7], "rho": 450.0},
    ],
    ids=["steel", "aluminium", "plastic", "rubber", "spruce"],
)
def test_real_materials_raise_no_doubts(material, solid_body, box):
    body = solid_body(box("hexahedron20"), material=material)
    assert of_body(body) == []
    assert survey(body).doubts == ()


@pytest.mark.parametrize(
    ("change", "doubts"),
    [
        ({"E": 2.1e5}, ["material.E = 210000 Pa makes a speed of sound of 5.17 m/s"]),
        ({"rho": 7.85}, ["material.rho = 7.85", "material.E = .* 1.64e.05 m/s"]),
        (
            {"rho": 7.85e-9},
            ["material.rho = 7.85e-09 kg/m.3 is not that of a solid", "material.E = "],
        ),
        ({"rho": 78500.0}, ["material.rho = 78500"]),
    ],
)
def test_wrong_units_are_told_by_key(change, doubts, solid_body, box):
    found = of_body(solid_body(box("hexahedron20"), material={**STEEL, **change}))
    assert len(found) == len(doubts)
    for doubt, start in zip(found, doubts, strict=True):
        assert re.match(start, doubt), doubt


def test_sections_that_differ_without_orientation_are_doubted(beam_body, beam, section):
    flat = {**section, "EI_y": 0.5}
    (doubt,) = of_body(beam_body(beam(4), section=flat))
    assert doubt.startswith("section: EI_y and EI_z differ, and without section.orientation")
    assert of_body(beam_body(beam(4), section={**flat, "orientation": [0, 1, 0]})) == []
    assert of_body(beam_body(beam(4))) == []


def test_a_mesh_in_millimeters_is_doubted(solid_body, box):
    large = survey(solid_body(box("hexahedron20"), scale=1000.0))
    assert any("in millimeters (scale = 1e-3)?" in doubt for doubt in large.doubts)


@pytest.mark.parametrize(
    ("kind", "divisions", "doubt"),
    [
        ("tetra", (2, 2, 2), "too stiff in bending: deflections are about "),
        ("wedge", (4, 1, 1), "too stiff in bending: deflections are about "),
        ("hexahedron", (4, 1, 1), ""),
        ("hexahedron", (2, 2, 2), ""),
        ("hexahedron20", (4, 1, 1), ""),
        ("tetra10", (4, 1, 1), ""),
    ],
)
def test_elements_that_are_too_stiff_are_doubted(kind, divisions, doubt, solid_body, box):
    surveyed = survey(solid_body(box(kind, divisions=divisions)))
    found = [text for text in surveyed.doubts if "stiff" in text]
    assert len(found) == bool(doubt)
    assert all(doubt in text for text in found)


def on_mesh(body: Body) -> list[str]:
    return list(doubts_of_source(body, read_source(body)))


ROOT = Path(__file__).parents[2] / "meshes"
MASSLESS = ROOT / "shaft/light.toml"
MESHES = sorted(set(ROOT.glob("*/*.toml")) - {ROOT / "connecting_rod/fine.toml", MASSLESS})
"""but for the one whose mesh an example makes, and a shaft without mass"""


@pytest.mark.parametrize("path", MESHES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_no_body_of_the_repository_is_doubted(path):
    body = read_body(path)
    assert [*of_body(body), *on_mesh(body)] == []


def test_the_only_one_with_good_reason_is_a_shaft_without_mass():
    only_doubt = "section.EA = 6.59734e+07 N makes a speed of sound of 1.64e+05 m/s"
    body = read_body(MASSLESS)
    assert [doubt[: len(only_doubt)] for doubt in [*of_body(body), *on_mesh(body)]] == [only_doubt]


@pytest.mark.parametrize(
    ("change", "doubted"),
    [
        ({"polar_inertia_per_length": 4.4e-8 * 90}, ""),
        ({"polar_inertia_per_length": 4.4e-8 * 110}, "section.polar_inertia_per_length = "),
        ({"polar_inertia_per_length": 4.4e-8 / 90}, ""),
        ({"polar_inertia_per_length": 4.4e-8 / 110}, "section.polar_inertia_per_length = "),
        ({"GJ": 109.0}, ""),
        ({"GJ": 111.0}, "section.GJ = 111 N m^2 is 10 times EI_y + EI_z"),
        ({"GA_y": 2.1e7}, ""),
        ({"GA_y": 2.2e7}, "section.GA_y = 2.2e+07 N is more than EA"),
    ],
)
def test_numbers_of_a_section_that_do_not_fit_each_other_are_doubted(
    change, doubted, beam_body, beam, section
):
    found = of_body(beam_body(beam(4), section={**section, **change}))
    assert len(found) == bool(doubted)
    assert all(doubt.startswith(doubted) for doubt in found)


@pytest.mark.parametrize(("radius", "doubted"), [(0.24, False), (0.26, True)])
def test_a_section_as_deep_as_its_beam_is_long_is_doubted(
    radius, doubted, beam_body, beam, section
):
    """sqrt(EI / EA) = radius [m] in a beam of 0.5 m."""
    EI = section["EA"] * radius**2
    polar = 2.0 * section["mass_per_length"] * radius**2
    deep = {**section, "EI_y": EI, "EI_z": EI, "polar_inertia_per_length": polar}
    found = on_mesh(beam_body(beam(4), section=deep, impulse={"step": 1e-5, "steps": 2}))
    assert len(found) == 2 * doubted
    assert all("the radius of gyration, is 0.26 m in a mesh of 0.5 m" in text for text in found)


@pytest.mark.parametrize(("ratio", "doubted"), [(0.5, False), (2.0, True)])
def test_damping_in_per_cent_is_doubted(ratio, doubted, beam_body, beam):
    found = of_body(beam_body(beam(4), damping={"modal": ratio}))
    assert len(found) == doubted
    assert all(text.startswith("damping.modal = 2 is a ratio") for text in found)


@pytest.mark.parametrize(("E", "doubted"), [(1.2e12, False), (1.4e12, True)])
def test_a_modulus_above_that_of_diamond_is_doubted(E, doubted, solid_body, box):
    found = of_body(solid_body(box("hexahedron20"), material={**STEEL, "E": E}))
    assert len(found) == doubted
    assert all(
        text.startswith("material.E = 1.4e+12 Pa is above that of diamond") for text in found
    )


@pytest.mark.parametrize(("rho", "doubted"), [(9.1, False), (8.9, True), (24e3, False), (26e3, 1)])
def test_densities_from_foams_to_osmium_are_taken(rho, doubted, solid_body, box):
    soft = {"E": 1e3 * rho**2, "nu": 0.3, "rho": rho}  # no other doubts
    found = of_body(solid_body(box("hexahedron20"), material=soft))
    assert len(found) == doubted


@pytest.mark.parametrize(("speed", "doubted"), [(19, 1), (21, 0), (29e3, 0), (31e3, 1)])
def test_speeds_of_sound_from_rubber_to_beryllium_are_taken(speed, doubted, solid_body, box):
    material = {"E": 1000.0 * speed**2, "nu": 0.3, "rho": 1000.0}
    assert len(of_body(solid_body(box("hexahedron20"), material=material))) == doubted


@pytest.mark.parametrize(("radius", "doubted"), [(14.0, False), (16.0, True)])
def test_the_inertia_of_a_piece_in_square_millimeters_is_doubted(radius, doubted, beam_body, beam):
    """J about an axis of 2 m r^2 / 3 each: tr J = 2 m r^2, on a mesh of 0.5 m."""
    inertia = [2.0 / 3.0 * 0.1 * radius**2] * 3
    piece = {"sensor": {"mass": 0.1, "inertia": inertia, "interface": "tip"}}
    found = on_mesh(beam_body(beam(4), masses=piece))
    assert len(found) == doubted
    assert all(text.startswith("masses.sensor.inertia: its radius of") for text in found)


@pytest.mark.parametrize(("scale", "doubted"), [(199.0, 0), (201.0, 1), (2.1e-5, 0), (1.9e-5, 1)])
def test_beams_of_ten_micrometers_to_a_hundred_meters_are_taken(scale, doubted, beam_body, beam):
    """0.5 m times the scale, without the doubts of a step that is far too small or large."""
    mesh = read_source(beam_body(beam(4), scale=scale)).mesh
    assert len(list(doubts_of_mesh(mesh))) == doubted


@pytest.mark.parametrize(("nodes", "doubted"), [(0.011, False), (0.009, True)])
def test_a_step_that_nothing_on_the_mesh_is_fast_enough_for_is_doubted(
    nodes, doubted, solid_body, box
):
    """The shear wave of the Nyquist frequency is 2 h c long; elements are 1/4 m."""
    mesh = box("hexahedron20", divisions=(4, 4, 4))
    speed = float(np.sqrt(STEEL["E"] / 2.6 / STEEL["rho"]))
    source = read_source(solid_body(mesh))
    spacing = source.resolution(1.0).spacing
    body = solid_body(mesh, impulse={"step": 0.5 * nodes * spacing / speed, "steps": 2})
    found = on_mesh(body)
    assert len(found) == doubted
    assert all(text.startswith("impulse.step = ") for text in found)


@pytest.mark.parametrize(("factor", "doubted"), [(0.99, False), (1.01, True)])
def test_a_band_that_the_mesh_does_not_carry_is_doubted(factor, doubted, solid_body, box):
    wave = read_source(solid_body(box("hexahedron20"))).resolution(1.0)
    band = factor * wave.nodes / wave.needed
    impulse = {"step": 0.1 / band, "steps": 2, "band": band}
    found = on_mesh(solid_body(box("hexahedron20"), impulse=impulse))
    assert len(found) == doubted
    assert all(text.startswith("impulse.band = ") for text in found)


@pytest.mark.parametrize(
    ("impulse", "doubt"),
    [
        ({"step": 1.1e-3}, "impulse.step = 0.0011 s: its Nyquist frequency, 454.5 Hz, is below"),
        ({"step": 0.9e-3}, ""),
        ({"step": 1e-4, "band": 499.0}, "impulse.band = 499 Hz is below the first elastic"),
        ({"step": 1e-4, "band": 501.0}, ""),
    ],
)
def test_a_step_or_band_without_an_elastic_mode_is_doubted(impulse, doubt, beam_body, beam):
    body = beam_body(beam(4), impulse={**impulse, "steps": 20})
    found = list(doubts_of_frequencies(body, 500.0))
    assert len(found) == bool(doubt)
    assert all(text.startswith(doubt) for text in found)


def test_build_tells_what_the_dry_run_does(beam_body, beam):
    body = beam_body(beam(4), impulse={"step": 1e-2, "steps": 20})
    told = []
    build(body, told=told.append)
    assert tuple(told) == survey(body).doubts
    assert told[0].startswith("impulse.step = 0.01 s: its Nyquist frequency, 50 Hz, is below")


def test_the_axes_of_sections_are_drawn_where_they_are(beam_body, beam, section):
    """Along x: local y is horizontal, e_z cross x; with an orientation it is there."""
    points, axes = survey(beam_body(beam(4))).section_axes()
    assert points.tolist() == pytest.approx(np.array([[x, 0, 0] for x in (1, 3, 5, 7)]) / 16)
    assert axes[0].tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    turned = {**section, "orientation": [0, 0, 1]}
    _, axes = survey(beam_body(beam(4), section=turned)).section_axes()
    assert axes[0].tolist() == [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
