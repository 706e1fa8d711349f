"""Doubts about units and meshes: told of what is unlike any part, and of nothing else."""

import re

import pytest
from duhamel.preprocess.body.body import Body
from duhamel.preprocess.plausibility import doubts_of_body, doubts_of_mesh
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
        ({"rho": 7.85}, ["material.E = .* 1.64e.05 m/s"]),
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
        ("tetra", (2, 2, 2), "four-node tetrahedra"),
        ("hexahedron", (4, 1, 1), "one through the thickness"),
        ("wedge", (4, 1, 1), "one through the thickness"),
        ("hexahedron", (2, 2, 2), ""),
        ("hexahedron20", (4, 1, 1), ""),
        ("tetra10", (4, 1, 1), ""),
    ],
)
def test_elements_that_are_too_stiff_are_doubted(kind, divisions, doubt, solid_body, box):
    surveyed = survey(solid_body(box(kind, divisions=divisions)))
    found = list(doubts_of_mesh(surveyed.mesh, surveyed.facets))
    assert len(found) == bool(doubt)
    assert all(doubt in text for text in found)
