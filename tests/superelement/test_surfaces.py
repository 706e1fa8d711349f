"""Surfaces of superelements: what they must be, and that their file gives them back."""

from dataclasses import replace

import h5py
import numpy as np
import pytest
from duhamel.superelement import (
    SuperelementError,
    Surface,
    Surfaces,
    check,
    read,
    write,
)

GRID = np.array([[x, y, 0.0] for y in (0.0, 1.0, 2.0) for x in (0.0, 1.0, 2.0)])
QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]])


def grid(name="face", first=0, **changes):
    values = {
        "nodes": first + np.arange(9),
        "X": GRID + first,
        "facets": QUADS,
        "facet_type": "quad",
        "normals": np.tile([0.0, 0.0, 1.0], (9, 1)),
        "area": 4.0,
    }
    return Surface(name, **{**values, **changes})


@pytest.fixture
def touched(make_element):
    """A body whose surfaces have a rest of random definite matrices beside the modes."""
    element = make_element()
    rng = np.random.default_rng(3)
    phi, root = rng.normal(size=(54, 4)), rng.normal(size=(54, 54))
    omega = element.modes.omega
    H = (phi / omega**2) @ phi.T + 1e-6 * (root @ root.T + np.eye(54))
    return replace(element, surfaces=Surfaces((grid("z"), grid("a", 20)), phi, 0.5 * (H + H.T)))


def test_files_give_back_every_bit(touched, tmp_path):
    write(touched, tmp_path / "body.h5")
    again = read(tmp_path / "body.h5")
    assert [patch.name for patch in again.surfaces.patches] == ["z", "a"]
    for ours, theirs in zip(touched.surfaces.patches, again.surfaces.patches, strict=True):
        for key in ("nodes", "X", "facets", "normals"):
            np.testing.assert_array_equal(getattr(theirs, key), getattr(ours, key))
        assert (theirs.facet_type, theirs.area) == (ours.facet_type, ours.area)
    np.testing.assert_array_equal(again.surfaces.phi, touched.surfaces.phi)
    np.testing.assert_array_equal(again.surfaces.H, touched.surfaces.H)


def test_groups_of_surfaces_in_older_files_are_passed_over(touched, tmp_path):
    """Version 5 knows none, as any unknown group; the digest is that of the rest."""
    plain = replace(touched, surfaces=None)
    write(plain, tmp_path / "body.h5")
    with h5py.File(tmp_path / "body.h5", "a") as file:
        file.attrs["version"] = 5
        file.create_group("surfaces/face")
    assert read(tmp_path / "body.h5").surfaces is None


def test_rows_and_nodes(touched):
    surfaces = touched.surfaces
    assert surfaces.n == 18
    assert surfaces.rows("a") == slice(27, 54)
    assert touched.surface("z") is surfaces.patches[0]
    np.testing.assert_array_equal(surfaces.patches[0].corner_nodes, np.arange(9))
    for ask in (touched.surface, surfaces.rows):
        with pytest.raises(SuperelementError, match="no surface 'b'; there are: z, a"):
            ask("b")
    with pytest.raises(SuperelementError, match="no surface 'b'; it has none"):
        replace(touched, surfaces=None).surface("b")


def test_the_rest_is_what_modes_leave(touched):
    surfaces, omega = touched.surfaces, touched.modes.omega
    np.testing.assert_array_equal(surfaces.F(omega, 0.0), surfaces.H)
    rest = surfaces.F(omega)
    for i in range(4):
        rest = rest + np.outer(surfaces.phi[:, i], surfaces.phi[:, i]) / omega[i] ** 2
    np.testing.assert_allclose(rest, surfaces.H, atol=1e-15)


def test_facets_with_middle_nodes_have_corners():
    around = np.array([[0, 2, 8, 6, 1, 5, 7, 3, 4]])
    face = grid(facets=around, facet_type="quad9")
    np.testing.assert_array_equal(face.corners, [[0, 2, 8, 6]])
    np.testing.assert_array_equal(face.corner_nodes, [0, 2, 6, 8])
    assert repr(face) == "<Surface 'face': 9 nodes, 1 quad9, 4 m^2>"


WRONG = {
    "type": ({"facet_type": "quad7"}, "facet_type: expected one of triangle, quad, .* 'quad7'"),
    "X": ({"X": np.zeros((9, 2))}, r"X: expected shape \(n, 3\), found \(9, 2\)"),
    "nodes": ({"nodes": np.arange(8)}, r"nodes: expected integers of shape \(9\)"),
    "twice": ({"nodes": np.zeros(9, dtype=int)}, "nodes: expected each node once"),
    "floats": ({"nodes": np.arange(9.0)}, "nodes: expected integers .* found float64"),
    "facets": ({"facets": QUADS[:, :3]}, r"facets: expected integers of shape \(n, 4\)"),
    "unused": ({"facets": QUADS[:3]}, "facets: expected all of the numbers 0 to 8 .* found 8 from"),
    "outside": ({"facets": QUADS + 1}, "facets: expected all of the numbers 0 to 8"),
    "normals": ({"normals": np.ones((9, 3))}, "normals: expected unit vectors, .* by 0.732"),
    "area": ({"area": 0.0}, "area: expected a positive number, found 0"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_surfaces_are_refused(name):
    changes, message = WRONG[name]
    with pytest.raises(SuperelementError, match=f"surface 'face': {message}"):
        grid(**changes)


def test_names_of_surfaces_are_refused():
    with pytest.raises(SuperelementError, match="surface name: expected one line"):
        grid("a.b")


def test_surfaces_that_do_not_fit_are_refused(touched):
    good = touched.surfaces
    with pytest.raises(SuperelementError, match="surfaces: H: expected a symmetric matrix"):
        replace(good, H=good.H + np.triu(np.ones((54, 54)), 1))
    with pytest.raises(SuperelementError, match=r"surfaces: H: expected shape \(54, 54\)"):
        replace(good, H=np.eye(27))
    with pytest.raises(SuperelementError, match="surfaces: expected different names"):
        replace(good, patches=(grid(), grid(first=20)))
    with pytest.raises(SuperelementError, match="phi: expected 4 columns, one per mode, found 3"):
        replace(touched, surfaces=replace(good, phi=good.phi[:, :3]))
    with pytest.raises(SuperelementError, match="surfaces: expected a body with modes"):
        replace(touched, modes=None, recovery=None)
    renamed = replace(good, patches=(grid("face 0"), grid("a", 20)))
    with pytest.raises(SuperelementError, match=r"other names than .* found face 0"):
        replace(touched, surfaces=renamed)


def damaged(path, name, change):
    with h5py.File(path, "a") as file:
        file[name][...] = change(file[name][()])


DAMAGE = {
    "modes": ("modes/phi_surface", lambda A: 1e3 * A, "static/surface: expected no more complia"),
    "stiffer": ("static/surface", lambda A: 1e-3 * A, "static/surface: expected no more complia"),
    "points": ("surfaces/a/points", lambda A: A + 1e-3, "rigid, interfaces: expected the numbers"),
    "normals": ("surfaces/a/normals", lambda A: -A, "rigid, interfaces: expected the numbers"),
    "facets": ("surfaces/a/facets", lambda A: A[::-1], "rigid, interfaces: expected the numbers"),
    "area": ("surfaces/z/area", lambda A: 2.0 * A, "rigid, interfaces: expected the numbers"),
    "asymmetric": ("static/surface", np.tril, "surfaces: H: expected a symmetric matrix"),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_damaged_files_are_refused(touched, tmp_path, name):
    write(touched, tmp_path / "body.h5")
    dataset, change, message = DAMAGE[name]
    damaged(tmp_path / "body.h5", dataset, change)
    with pytest.raises(SuperelementError, match=message):
        read(tmp_path / "body.h5")


def test_a_rest_that_vanishes_somewhere_is_refused(touched, tmp_path):
    """Modes that take all of one load leave no flexibility to close a contact with."""
    values, vectors = np.linalg.eigh(touched.surfaces.F(touched.modes.omega))
    taken = touched.surfaces.H - (1.0 - 1e-6) * values[0] * np.outer(vectors[:, 0], vectors[:, 0])
    element = replace(touched, surfaces=replace(touched.surfaces, H=0.5 * (taken + taken.T)))
    assert not all(found.holds for found in check(element))
    write(element, tmp_path / "body.h5")
    with pytest.raises(SuperelementError, match=r"a static rest of every load .* smal"):
        read(tmp_path / "body.h5")


def test_rows_in_another_order_are_refused(touched, tmp_path):
    write(touched, tmp_path / "body.h5")
    with h5py.File(tmp_path / "body.h5", "a") as file:
        file["surfaces/z"].attrs["row"] = 3
    with pytest.raises(SuperelementError, match="surfaces/z: row: expected 0, found 3"):
        read(tmp_path / "body.h5")


def test_audits_find_all_that_surfaces_must_satisfy(touched):
    of_surfaces = [found for found in check(touched) if found.where == "static/surface"]
    assert len(of_surfaces) == 4
    assert all(found.holds for found in of_surfaces)
    assert of_surfaces[-1].found > 1.0
