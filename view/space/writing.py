"""Films and pictures as files, which appear whole or not at all."""

import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from ...files.outputs import in_words, renamed_when_whole
from ..errors import PictureError, require_target
from .lettering import Image

FILM_SUFFIX = ".mp4"
GIF_SUFFIX = ".gif"
PICTURE_SUFFIX = ".png"
FILM_SUFFIXES = (FILM_SUFFIX, GIF_SUFFIX, PICTURE_SUFFIX)
FRAME_NUMBER = re.compile(r"%0?\d*d")
# A crf of 18 can hardly be told from the original, 23 is usual.
H264_QUALITY = ("-crf", "20", "-preset", "veryfast")
# Of the 256 that a GIF can have; letters and light bodies need the grays.
GIF_COLORS = 220
GIF_GRAYS = 35
# Levels between the channels of what counts as gray.
MAX_GRAY_SPREAD = 14
# Levels of a channel that count as one color: so a large plain face does not take all colors.
LEVELS_OF_A_COLOR = 6
# From which the colors of a GIF are taken: one palette for all, or it would flicker.
PALETTE_FRAMES = 8


class Sink(Protocol):
    """What takes the frames of a film in their order."""

    def put(self, image: Image) -> None: ...


def require_format(path: Path, size: tuple[int, int], several: bool) -> None:
    """PictureError if no such file can be made.   several: it is more than a single frame"""
    suffix = require_target(path, FILM_SUFFIXES)
    if suffix == PICTURE_SUFFIX and several and not FRAME_NUMBER.search(path.name):
        raise PictureError(
            f"{path}: expected --at TIME or --at worst for one picture, "
            "or a name with a number for many, as frame-%04d.png"
        )
    if suffix == FILM_SUFFIX and (size[0] % 2 or size[1] % 2):
        raise PictureError(f"{path}: expected even numbers as --size of a film, found {size}")


@contextmanager
def written(path: Path, size: tuple[int, int], fps: float, frames: int) -> Iterator[Sink]:
    """What takes the frames of a film and makes a file of them at the end of the block."""
    suffix = path.suffix.lower()
    try:
        if suffix == PICTURE_SUFFIX and frames > 1:
            yield _Stills(path)
            return
        with renamed_when_whole(path) as temporary:
            if suffix == FILM_SUFFIX:
                with _h264(temporary, size, fps, frames) as film:
                    yield film
            else:
                sink = _Moving(fps) if suffix == GIF_SUFFIX else _Still()
                yield sink
                sink.save(temporary)
    except OSError as error:
        raise PictureError(f"{path}: cannot be written: {in_words(error)}") from error


class _Still:
    def put(self, image: Image) -> None:
        self._image = image

    def save(self, path: Path) -> None:
        _picture(self._image).save(path, format="PNG", optimize=True)


class _Stills:
    """A file for each frame, by its number from 1 on."""

    def __init__(self, path: Path) -> None:
        self._path, self._number = path, 0

    def put(self, image: Image) -> None:
        self._number += 1
        name = FRAME_NUMBER.sub(lambda found: found[0] % self._number, self._path.name, count=1)
        path = self._path.with_name(name)
        try:
            with renamed_when_whole(path) as temporary:
                _picture(image).save(temporary, format="PNG")
        except OSError as error:
            raise PictureError(
                f"{path}: cannot be written: {in_words(error)}; {self._number - 1} frames before "
                "it are written"
            ) from error


class _Moving:
    """A GIF: frames in the colors that some of them share. Until then they are kept packed."""

    def __init__(self, fps: float) -> None:
        self._duration = max(round(100.0 / fps), 2) * 10
        self._packed: list[bytes] = []
        self._shape: tuple[int, ...] = ()

    def put(self, image: Image) -> None:
        self._shape = image.shape
        self._packed.append(zlib.compress(image.tobytes(), 1))

    def save(self, path: Path) -> None:
        palette = self._palette()
        frames = (
            self._frame(n).quantize(palette=palette, dither=0) for n in range(len(self._packed))
        )
        next(frames).save(
            path,
            format="GIF",
            save_all=True,
            append_images=frames,
            duration=self._duration,
            loop=0,
            disposal=1,
        )

    def _palette(self) -> Any:
        chosen = np.linspace(0, len(self._packed) - 1, PALETTE_FRAMES).round().astype(int)
        together = np.concatenate([np.asarray(self._frame(n)) for n in np.unique(chosen)])
        return _palette_of(together.reshape(-1, 3))

    def _frame(self, number: int) -> Any:
        raw = np.frombuffer(zlib.decompress(self._packed[number]), dtype=np.uint8)
        return _picture(raw.reshape(self._shape))


def _palette_of(colors: Image) -> Any:
    """Grays, white among them, and what serves the other colors (n, 3), each of which counts once.

    However much of a picture each covers.
    """
    from PIL import Image as Images

    bright = colors[np.ptp(colors.astype(int), axis=1) > MAX_GRAY_SPREAD]
    _, first = np.unique(bright // LEVELS_OF_A_COLOR @ [1 << 12, 1 << 6, 1], return_index=True)
    grays = np.repeat(np.linspace(0, 255, GIF_GRAYS).astype(int), 3).tolist()
    found: list[int] = []
    if len(first):
        found = list(_picture(bright[first][None]).quantize(GIF_COLORS, dither=0).getpalette())
    palette = Images.new("P", (1, 1))
    palette.putpalette([*grays, *found[: 3 * GIF_COLORS]])
    return palette


@contextmanager
def _h264(path: Path, size: tuple[int, int], fps: float, frames: int) -> Iterator[Sink]:
    try:
        from imageio_ffmpeg import count_frames_and_secs, write_frames
    except ImportError as error:
        raise PictureError(
            "a film needs imageio with ffmpeg: pip install 'duhamel[view]'"
        ) from error
    writer = write_frames(
        str(path),
        size,
        fps=fps,
        codec="libx264",
        pix_fmt_out="yuv420p",
        macro_block_size=2,
        quality=None,
        ffmpeg_log_level="fatal",
        output_params=[*H264_QUALITY, "-f", "mp4", "-movflags", "+faststart"],
    )
    writer.send(None)
    try:
        yield _Pipe(writer)
    finally:
        writer.close()
    try:
        found, _ = count_frames_and_secs(str(path))
    except RuntimeError as error:
        raise OSError("ffmpeg left no whole film: is the disk full?") from error
    if found != frames:
        raise OSError(f"ffmpeg wrote {found} of {frames} frames")


class _Pipe:
    def __init__(self, writer: Any) -> None:
        self._writer = writer

    def put(self, image: Image) -> None:
        try:
            self._writer.send(image.tobytes())
        except OSError as error:  # the pipe breaks: ffmpeg has ended
            raise OSError("ffmpeg stopped: is the disk full?") from error


def _picture(image: Image) -> Any:
    from PIL import Image as Images

    return Images.fromarray(image)
