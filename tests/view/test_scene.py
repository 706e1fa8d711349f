"""Pictures of bodies: what is seen is in its color, what is behind is not; labels keep apart."""

import matplotlib.image
import numpy as np
import pytest
from duhamel import view
from duhamel.view.scene import apart, color

CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float
)
FACES = [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]]


def pixels(scene, path):
    """Hue (rows, columns, 3) and brightness (rows, columns): the color over its largest part, and
    that part.
    """
    view.save(view.draw_scene(scene), path)
    image = matplotlib.image.imread(path)[:, :, :3]
    assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    largest = image.max(axis=2)
    return image / np.maximum(largest, 1e-6)[:, :, None], largest


def count(hue, number):
    own = np.array(color(number))
    return int((np.abs(hue - own / own.max()).max(axis=2) < 0.02).sum())


def cube(owners, **more):
    names = [
        view.Marker(f"face {n}", CORNERS[FACES[face]].mean(axis=0))
        for n, face in enumerate(np.argsort(owners))
    ]
    markers = names[-(max(owners) + 1) :] if max(owners) >= 0 else []
    return view.Scene([view.Patch(CORNERS[FACES], np.array(owners))], markers=markers, **more)


def test_faces_show_in_the_colors_of_their_markers(tmp_path):
    """The top of a cube and its right side, as wide as their projections: the ratio of their pixels
    is known.
    """
    hue, _ = pixels(cube([-1, 0, -1, -1, -1, 1]), tmp_path / "cube.png")
    eye = np.array([1.0, -1.35, 0.8])
    right, top = count(hue, 0), count(hue, 1)
    assert right > 10_000
    assert top / right == pytest.approx(eye[2] / eye[0], rel=0.05)


def test_what_faces_away_is_hidden_and_seen_from_the_other_side(tmp_path):
    """The bottom of a cube shows in the right half of the picture only."""
    hue, _ = pixels(cube([-1, -1, -1, -1, 0, -1]), tmp_path / "cube.png")
    middle = hue.shape[1] // 2
    assert count(hue[:, middle:], 0) > 10_000
    assert count(hue[:, :middle], 0) == 0


def test_what_is_nearer_covers_what_is_behind(tmp_path):
    """Two cubes in line with the eye, the nearer one larger: only dot and line of the other show
    first.
    """
    eye = np.array([1.0, -1.35, 0.8])
    near, far = 2.0 * (CORNERS - 0.5) + 3.0 * eye, CORNERS - 0.5
    markers = [
        view.Marker("near", 3.0 * eye, has_axes=False),
        view.Marker("far", np.zeros(3), has_axes=False),
    ]
    facets = np.concatenate([near[FACES], far[FACES]])
    scene = view.Scene([view.Patch(facets, np.repeat([0, 1], 6))], markers=markers)
    hue, _ = pixels(scene, tmp_path / "cubes.png")
    halves = [hue[:, : hue.shape[1] // 2], hue[:, hue.shape[1] // 2 :]]
    if hue.shape[0] > hue.shape[1]:
        halves = [hue[: hue.shape[0] // 2], hue[hue.shape[0] // 2 :]]
    assert count(halves[0], 0) > 2_000
    assert count(halves[0], 1) < 100
    assert count(halves[1], 1) > 500


def test_lines_and_dots(tmp_path):
    lines = np.array([[[0, 0, 0], [1, 0, 0]], [[1, 0, 0], [1, 1, 0]]], dtype=float)
    scene = view.Scene(
        lines=lines,
        markers=[view.Marker("root", lines[0, 0], has_axes=False)],
        masses=[view.Marker("lump 1 kg", lines[1, 1], has_axes=False)],
    )
    hue, brightness = pixels(scene, tmp_path / "lines.png")
    assert count(hue, 0) > 20
    assert (brightness < 0.2).sum() > 30


def test_colors_differ():
    colors = np.array([color(number) for number in range(24)])
    distance = np.linalg.norm(colors[:, None] - colors, axis=2) + 9.0 * np.eye(24)
    assert distance.min() > 0.05


def test_labels_keep_their_distance_and_their_order():
    rng = np.random.default_rng(0)
    for n in (1, 2, 7, 24, 40):
        wanted = rng.uniform(-2.0, 2.0, n)
        heights = apart(wanted, 0.2, 2.0)
        gap = min(0.2, 4.0 / max(n - 1, 1))
        assert (np.diff(heights[np.argsort(wanted)]) >= gap - 1e-12).all()
        assert np.abs(heights).max() <= 2.0 + 1e-12


def test_labels_that_are_apart_stay_and_others_move_as_little_as_they_can():
    np.testing.assert_allclose(apart(np.array([1.0, -1.0, 0.0]), 0.2, 2.0), [1.0, -1.0, 0.0])
    np.testing.assert_allclose(apart(np.array([0.0, 0.0, 1.0]), 0.2, 2.0), [-0.1, 0.1, 1.0])
    assert len(apart(np.zeros(0), 0.2, 2.0)) == 0


def test_the_axes_of_sections_are_seen_along_their_directions():
    """A line along x: local y and z start at its middle and are drawn as the axes of the mesh."""
    middle, axes = np.array([0.5, 0.0, 0.0]), np.eye(3)
    sections = [view.Cross(middle, axes[1], axes[2])]
    figure = view.draw_scene(view.Scene(lines=np.array([[[0, 0, 0], [1, 0, 0]]], float)))
    with_axes = view.draw_scene(
        view.Scene(lines=np.array([[[0, 0, 0], [1, 0, 0]]], float), sections=sections)
    )
    drawn = with_axes.axes[0].lines[len(figure.axes[0].lines) :]
    of_mesh = with_axes.axes[0].lines[1:3]
    assert len(drawn) == 2
    for axis, known in zip(drawn, of_mesh, strict=True):
        assert axis.get_color() == known.get_color()
        seen, expected = (np.diff(line.get_xydata(), axis=0)[0] for line in (axis, known))
        cosine = seen @ expected / np.linalg.norm(seen) / np.linalg.norm(expected)
        assert cosine == pytest.approx(1.0, abs=1e-12)
    assert {text.get_text() for text in with_axes.axes[0].texts} >= {"local y", "local z"}


def test_a_fine_surface_is_a_picture_in_a_file_of_lines(tmp_path):
    """One by one, the facets of a part of 51 000 nodes took 27 MB; a coarse one stays sharp."""
    told = {}
    for n in (10, 100):
        corners = np.stack(np.meshgrid(np.arange(n), [0], np.arange(n)), -1).reshape(-1, 1, 3)
        facets = corners + np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 1]])
        patch = view.Patch(facets, np.full(len(facets), -1))
        view.save(view.draw_scene(view.Scene([patch])), tmp_path / f"{n}.svg")
        told[n] = "<image" in (tmp_path / f"{n}.svg").read_text()
    assert told == {10: False, 100: True}
