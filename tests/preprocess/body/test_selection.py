"""Shapes in space: areas and centroids of what they select against closed forms, on meshes that
follow a half tube.
"""

import numpy as np
import pytest
from duhamel.preprocess import BodyError, InterfaceError, assemble
from duhamel.preprocess.assembly.interfaces import attachments
from duhamel.preprocess.body.body import Body
from duhamel.preprocess.body.reading import read_body
from duhamel.preprocess.body.selection import Box, Cylinder, Plane, Sphere
from duhamel.preprocess.sources.reading import read_source

INNER, OUTER, LENGTH = 0.02, 0.03, 0.05
AXIS = [[0, 0, 0], [0, 0, LENGTH]]
BORE = {"cylinder": {"axis": AXIS, "radius": INNER, "inner": INNER}}
MANTLE = {"cylinder": {"axis": AXIS, "radius": OUTER, "inner": OUTER}}


def half_tube(box, kind, divisions=(8, 1, 2)):
    """A box bent around z: the first axis is the angle, from pi to 0, the second the radius."""
    mesh = box(kind, divisions=divisions)
    angle, radius, z = (
        np.pi * (1.0 - mesh.points[:, 0]),
        INNER + (OUTER - INNER) * mesh.points[:, 1],
        mesh.points[:, 2],
    )
    mesh.points = np.stack([radius * np.cos(angle), radius * np.sin(angle), LENGTH * z], axis=1)
    return mesh


def attached(body: Body):
    return attachments("interfaces", body.interfaces, read_source(body))


@pytest.mark.parametrize(
    ("kind", "order"), [("hexahedron", 2), ("hexahedron20", 4), ("tetra10", 4)]
)
@pytest.mark.parametrize(("shape", "radius"), [(BORE, INNER), (MANTLE, OUTER)])
def test_cylinders_converge_to_their_area_and_centroid(solid_body, box, kind, order, shape, radius):
    """pi r L, and 2 r / pi from the axis: chords err with the square of the angle, parabolas with
    its fourth power.
    """
    errors = []
    for n in (8, 16):
        place = attached(solid_body(half_tube(box, kind, (n, 1, 2)), interfaces={"face": shape}))[
            "face"
        ]
        assert len(place.facets) == (2 * n if kind.startswith("hexahedron") else 4 * n)
        errors.append(
            [
                place.area / (np.pi * radius * LENGTH) - 1.0,
                place.X[1] / (2.0 * radius / np.pi) - 1.0,
            ]
        )
        np.testing.assert_allclose(place.X[[0, 2]], [0.0, LENGTH / 2], rtol=0, atol=1e-8)
    errors = np.abs(errors)
    assert errors[0].max() < {2: 2e-2, 4: 2e-4}[order]
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), order, atol=0.1)


SHAPES = {
    "half of the bore": (
        {"cylinder": {"axis": [[0, 0, 0], [0, 0, LENGTH / 2]], "radius": INNER}},
        INNER * LENGTH / 2,
    ),
    "bore in a box": (
        {**BORE, "box": {"corners": [[1, 1, 0], [-1, 0, LENGTH / 2]]}},
        INNER * LENGTH / 2,
    ),
    "quarter in a box": (
        {**MANTLE, "box": {"corners": [[0, 0, 0], [1, 1, 1]]}},
        OUTER * LENGTH / 2,
    ),
    "end": ({"plane": {"point": [1, 1, LENGTH], "normal": [0, 0, -2]}}, (OUTER**2 - INNER**2) / 2),
    "end as a flat box": (
        {"box": {"corners": [[-1, -1, 0], [1, 1, 0]]}},
        (OUTER**2 - INNER**2) / 2,
    ),
    "all": (
        {"sphere": {"center": [0, 0, 0], "radius": 1}},
        (OUTER + INNER) * (LENGTH + OUTER - INNER),
    ),
}


@pytest.mark.parametrize("name", SHAPES)
def test_areas_over_pi(solid_body, box, name):
    """Of all that is selected; `all` has two cuts besides, 2 (OUTER - INNER) LENGTH."""
    selection, expected = SHAPES[name]
    area = attached(
        solid_body(half_tube(box, "hexahedron27", (16, 1, 2)), interfaces={"face": selection})
    )["face"].area
    cuts = 2 * (OUTER - INNER) * LENGTH if name == "all" else 0.0
    assert area - cuts == pytest.approx(np.pi * expected, rel=1e-5)


def test_a_shape_restricts_a_group(solid_body, box):
    """A quarter of the end face of a box, and the middle of its facets."""
    quarter = {"group": "tip", "box": {"corners": [[0, 0, 0], [1, 0.5, 0.5]]}}
    place = attached(solid_body(box("hexahedron20"), interfaces={"tip": quarter}))["tip"]
    assert place.area == pytest.approx(0.25, rel=1e-12)
    np.testing.assert_allclose(place.X, [1.0, 0.25, 0.25], atol=1e-14)


def test_shapes_hold_what_lies_in_them():
    """Against the definitions, on points at random."""
    points = np.random.default_rng(1).uniform(-1, 1, (2000, 3))
    x, y, z = points.T
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    across = np.linalg.norm(np.cross(points, axis), axis=1)
    for shape, expected in (
        (Plane(point=(0, 0, 0.1), normal=(0, 0, 5), tolerance=0.05), np.abs(z - 0.1) <= 0.1),
        (Box(corners=((0.5, -1, 1), (-0.5, 0, 0))), (np.abs(x) <= 0.5) & (y <= 0) & (z >= 0)),
        (Sphere(center=(0.1, 0, 0), radius=0.7), (x - 0.1) ** 2 + y**2 + z**2 <= 0.49),
        (
            Cylinder(axis=((0, 0, 0), tuple(0.5 * axis)), radius=0.6, inner=0.2),
            (points @ axis >= 0) & (points @ axis <= 0.5) & (across <= 0.6) & (across >= 0.2),
        ),
    ):
        assert 0 < expected.sum() < len(points)
        np.testing.assert_array_equal(shape.holds(points, 2.0), expected)


def test_a_box_on_a_beam_selects_the_node_in_it(beam_body, beam):
    middle = {"middle": {"box": {"corners": [[0.2, -1, -1], [0.3, 1, 1]]}}}
    structure = assemble(beam_body(beam(4), interfaces=middle))
    np.testing.assert_allclose(structure.interfaces[0].X, 0.0, atol=1e-14)


@pytest.mark.parametrize(
    ("selection", "message"),
    [
        (
            {"box": {"corners": [[0, 0, 0], [1, 0.4, 0.4]]}},
            r"interfaces.part: no facet of the boundary lies as a whole in box "
            r"\(corners=.*, only nodes do: 3",
        ),
        (
            {"sphere": {"center": [2, 2, 2], "radius": 0.1}},
            r"no facet .* in sphere \(center=.*, nor does a node",
        ),
        (
            {"group": "tip", "box": {"corners": [[1, 0, 0], [1, 0.4, 0.4]]}},
            r"no facet lies as a whole in group 'tip' and box \(corners=.*, only nodes do: 1",
        ),
    ],
)
def test_shapes_without_a_whole_facet(solid_body, box, selection, message):
    with pytest.raises(InterfaceError, match=message):
        assemble(solid_body(box("hexahedron"), interfaces={"part": selection}))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "cylinder = {axis = [[0, 0, 0], [0, 0, 0]], radius = 1}",
            "cylinder: axis: expected two points, found",
        ),
        (
            "cylinder = {axis = [[0, 0, 0], [0, 0, 1]], radius = 1, inner = 2}",
            "cylinder: inner: expected at most the rad",
        ),
        (
            "sphere = {centre = [0, 0, 0], radius = 1}",
            r"sphere: unknown key 'centre'; did you mean 'center'\?",
        ),
        ("box = {corners = [[0, 0, 0]]}", r"box.corners.1: missing"),
        (
            "node = [0, 0, 0]\nbox = {corners = [[0, 0, 0], [1, 1, 1]]}",
            "node stands alone, found it with box",
        ),
        (
            'at = [0, 0, 0]\nkind = "rigid"',
            "expected node, or one or more of group, hole, face, plane, box, sphere and cylinder",
        ),
    ],
)
def test_mistakes_in_a_file(tmp_path, line, message):
    text = (
        'name = "b"\nmesh = "m.msh"\n[material]\nE = 1\nnu = 0\nrho = 1\n'
        "[impulse]\nstep = 1\nsteps = 1\n"
    )
    (tmp_path / "body.toml").write_text(f"{text}[interfaces.face]\n{line}\n")
    with pytest.raises(BodyError, match=rf"body.toml: interfaces.face[.:] ?{message}"):
        read_body(tmp_path / "body.toml")
