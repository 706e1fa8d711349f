"""Films: as many frames as asked, one scale, whole files, and what is refused."""

import errno
import os
import sys

import numpy as np
import pytest
from duhamel.view import PictureError, animate
from duhamel.view.space import film as films
from PIL import Image, ImageSequence

from .pendulum import TIME, Pendulum

TINY = (160, 90)


@pytest.mark.parametrize("suffix", [".mp4", ".gif"])
def test_a_film_has_the_frames_that_were_asked_for(tmp_path, suffix):
    from imageio_ffmpeg import count_frames_and_secs

    target = tmp_path / f"film{suffix}"
    film = animate(Pendulum(), target, frames=6, size=TINY)
    assert film.frames == 6
    assert film.field == "displacement"
    if suffix == ".gif":
        with Image.open(target) as shown:
            assert (shown.n_frames, shown.size) == (6, TINY)
    else:
        assert count_frames_and_secs(str(target))[0] == 6
    assert [path.name for path in tmp_path.iterdir()] == [target.name]


def test_bodies_move_from_frame_to_frame_and_letters_stay(tmp_path):
    animate(Pendulum(), tmp_path / "film.gif", frames=4, size=(320, 180), title="pendulum")
    with Image.open(tmp_path / "film.gif") as shown:
        frames = [np.asarray(f.convert("RGB"), int) for f in ImageSequence.Iterator(shown)]
    moved = np.abs(np.diff(frames, axis=0)).sum(axis=-1) > 90
    assert moved[:, 20:160, :270].any(axis=(1, 2)).all()
    assert not moved[:, 20:160, 285:].any()


def test_one_picture_is_of_one_time(tmp_path):
    film = animate(Pendulum(), tmp_path / "one.png", at=0.5, size=TINY)
    assert film.frames == 1
    assert film.largest == pytest.approx(0.5e-3)  # seen from the pin
    assert np.asarray(Image.open(tmp_path / "one.png")).shape == (90, 160, 3)


def test_colors_end_at_a_given_limit(tmp_path):
    """Half the bar is beyond half the largest value, in the last color."""
    film = animate(Pendulum(), tmp_path / "one.png", at=0.5, size=TINY, limit=0.25e-3)
    assert (film.limit, film.scale_end) == (0.25e-3, "250 µm")
    assert film.largest == pytest.approx(0.5e-3)
    with pytest.raises(PictureError, match="--limit: expected a positive number, found -1"):
        animate(Pendulum(), tmp_path / "two.png", at=0.5, size=TINY, limit=-1.0)
    assert not (tmp_path / "two.png").exists()


def test_the_worst_time_is_that_of_the_largest_value():
    assert films.the_time(Pendulum(), "worst", "displacement") == TIME[-1]


def test_the_worst_time_is_within_the_window():
    when = films.the_time(Pendulum(), "worst", "displacement", (TIME[1], TIME[-2]))
    assert when == TIME[-2]


def test_colors_go_from_zero_to_the_largest_value(tmp_path):
    """The bar at rest is blue; the tip, bent most, is red."""
    for at, name in ((0.0, "rest"), (1.0, "bent")):
        run = Pendulum()
        animate(run, tmp_path / f"{name}.png", at=at, size=(320, 180), marks=False)
    rest, bent = (
        np.asarray(Image.open(tmp_path / f"{name}.png"), int)[20:160, :260]
        for name in ("rest", "bent")
    )
    assert not red(rest).any()
    assert red(bent).any()


def red(image):
    return image[..., 0] - image[..., 2] > 100


def test_numbered_pictures(tmp_path):
    animate(Pendulum(), tmp_path / "frame-%03d.png", frames=3, size=TINY)
    assert sorted(p.name for p in tmp_path.iterdir()) == [f"frame-00{n}.png" for n in (1, 2, 3)]


def test_a_full_disk_names_the_picture_of_many(tmp_path, monkeypatch):
    save = Image.Image.save

    def saved(image, path, **keys):
        if len(list(tmp_path.glob("frame-*"))) == 2:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        save(image, path, **keys)

    monkeypatch.setattr(Image.Image, "save", saved)
    message = "frame-003.png: cannot be written: No space left on device; 2 frames before it are"
    with pytest.raises(PictureError, match=message):
        animate(Pendulum(), tmp_path / "frame-%03d.png", frames=4, size=TINY)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["frame-001.png", "frame-002.png"]


@pytest.mark.parametrize(
    ("name", "asked", "message"),
    [
        ("film.avi", {}, "expected a suffix of .mp4, .gif, .png, found '.avi'"),
        ("none/film.mp4", {}, "no folder"),
        ("film.png", {}, "expected --at TIME or --at worst for one picture"),
        ("film.mp4", {"size": (161, 90)}, "expected even numbers as --size"),
        ("film.mp4", {"size": (4, 90)}, "--size: expected 36 to 8192 pixels, found 4x90"),
        ("film.mp4", {"start": -1.0}, "--from: expected a time of the run, 0 to 1 s, found -1 s"),
        ("film.mp4", {"end": 2.0}, "--to: expected a time of the run"),
        ("film.mp4", {"start": 0.5, "end": 0.2}, "--to: expected a time after --from, 0.5 s"),
        ("film.mp4", {"fps": 0.0}, "--fps: expected a number above 0, found 0"),
        ("film.mp4", {"magnify": float("nan")}, "--magnify: expected a number from 0 on"),
        ("one.png", {"at": "best"}, "--at: expected a time or worst, found 'best'"),
        ("one.png", {"at": float("nan")}, "--at: expected a time of the run"),
        ("one.png", {"at": "worst", "field": "none"}, "--at worst: expected a field"),
    ],
)
def test_what_cannot_be_filmed_is_refused_before_anything_is_drawn(tmp_path, name, asked, message):
    with pytest.raises(PictureError, match=message):
        animate(Pendulum(), tmp_path / name, **{"frames": 2, "size": TINY, **asked})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".mp4", ".gif"])
def test_nothing_is_left_of_a_film_that_was_interrupted(tmp_path, suffix):
    target = tmp_path / f"film{suffix}"
    target.write_bytes(b"an earlier film")

    def interrupt(done, total):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        animate(Pendulum(), target, frames=4, size=TINY, on_frame=interrupt)
    assert target.read_bytes() == b"an earlier film"
    assert [path.name for path in tmp_path.iterdir()] == [target.name]


def test_a_full_disk_is_told_and_leaves_nothing(tmp_path, monkeypatch):
    """ffmpeg writes fewer frames than it was given."""
    monkeypatch.setattr("imageio_ffmpeg.count_frames_and_secs", lambda path: (1, 0.1))
    with pytest.raises(PictureError, match="cannot be written: ffmpeg wrote 1 of 3 frames"):
        animate(Pendulum(), tmp_path / "film.mp4", frames=3, size=TINY)
    assert list(tmp_path.iterdir()) == []


def test_without_pyvista_one_line_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(PictureError, match=r"needs pyvista: pip install 'duhamel\[view\]'"):
        animate(Pendulum(), tmp_path / "film.mp4", frames=2, size=TINY)


def test_titles_may_be_anything(tmp_path):
    animate(Pendulum(), tmp_path / "one.png", at=0.0, size=TINY, title="a$b_{<script>}\n" * 50)


@pytest.mark.parametrize(
    ("frames", "fps", "seconds", "expected", "words"),
    [
        (None, 25.0, None, 200, "slowed down 8 ×"),
        (None, 10.0, 2.0, 20, "slowed down 1.9 ×"),
        (26, 25.0, None, 26, "real time"),
        (50, 25.0, 0.1, 50, "sped up 10 ×"),
    ],
)
def test_how_fast_a_film_plays(frames, fps, seconds, expected, words):
    timing = films.timing(TIME, None, None, frames, fps, seconds)
    assert len(timing.times) == expected
    assert timing.words == words
