"""What is written around a picture: title, time, the scale of colors, what is magnified."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.font_manager import findfont
from numpy.typing import NDArray

from ...superelement.validation import Array
from ..field_kinds import COLOR_MAP, Scale
from ..picture import style
from ..prefixes import UNIT_PREFIXES, exponent_of
from ..scene import draw_triad

Image = NDArray[np.uint8]
"""(height, width, 3)"""
# Of pictures whose letters have the sizes below; in others they grow with the picture [pixels].
USUAL_HEIGHT = 720.0
TITLE_LETTER = 17.0  # [pixels]
NOTE_LETTER = 14.0  # [pixels]
LETTER_SHRINKING = 0.6
# Kept for letters, where no body is drawn [pixels].
TOP_ROOM = 52.0
BOTTOM_ROOM = 44.0
SCALE_ROOM = 142.0
# Of the width: the time stands to its right.
TITLE_SHARE = 0.66
# Any number does, for sizes are in pixels.
FIGURE_DPI = 100.0


@dataclass(frozen=True)
class Lettering:
    """title: above; notes: below; legend: words with their colors, below on the right.

    scale: of colors, if there is one; ends: what is written below it; axes (3, 3): of the
    camera.
    """

    title: str = ""
    notes: tuple[str, ...] = ()
    legend: tuple[tuple[str, str], ...] = ()
    scale: Scale | None = None
    ends: str = ""
    axes: Array = field(default_factory=lambda: np.eye(3))


@dataclass(frozen=True)
class Frame:
    """The size of a picture (width, height) and the margins around the model [pixels]."""

    size: tuple[int, int]
    scale: bool

    @property
    def enlarged(self) -> float:
        """Of letters, which shrink less than small pictures, so that they are read."""
        width, height = self.size
        share = min(height, width * 9.0 / 16.0) / USUAL_HEIGHT
        return share if share > 1.0 else share**LETTER_SHRINKING

    def pixel(self, seen: float) -> float:
        """The length of a pixel where a height `seen` lies between the margins [m]."""
        _, _, bottom, top = self.margins
        return seen / (self.size[1] - bottom - top)

    @property
    def aspect(self) -> float:
        """Width over height of what lies between the margins."""
        (width, height), (left, right, bottom, top) = self.size, self.margins
        return (width - left - right) / (height - bottom - top)

    @property
    def margins(self) -> tuple[float, float, float, float]:
        """left, right, bottom, top"""
        e = self.enlarged
        return 10.0 * e, (SCALE_ROOM if self.scale else 10.0) * e, BOTTOM_ROOM * e, TOP_ROOM * e


def lettered(frame: Frame, words: Lettering) -> Image:
    """The picture of all that stays the same, dark on white."""
    (width, height), e = frame.size, frame.enlarged
    points = 72.0 / FIGURE_DPI * e
    with style():
        figure = Figure(
            figsize=(width / FIGURE_DPI, height / FIGURE_DPI), dpi=FIGURE_DPI, facecolor="white"
        )
        canvas: Any = FigureCanvasAgg(figure)
        figure.text(
            12.0 * e / width,
            1.0 - 0.5 * TOP_ROOM * e / height,
            fitting(words.title, TITLE_SHARE * width, TITLE_LETTER * e),
            fontsize=TITLE_LETTER * points,
            fontweight="bold",
            va="center",
            parse_math=False,
        )
        _write_notes(figure, frame, words, points)
        _draw_axes(figure, frame, words.axes, points)
        if words.scale is not None:
            _draw_scale(figure, frame, words.scale, words.ends, points)
        canvas.draw()
    picture: Image = np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
    return picture


def fitting(text: str, width: float, letter: float) -> str:
    """A line of printable characters that is not wider than `width`."""
    line = "".join(c if c.isprintable() else " " for c in text)
    most = max(int(width / (0.62 * letter)), 4)
    return line if len(line) <= most else f"{line[: most - 1]}…"


def _write_notes(figure: Figure, frame: Frame, words: Lettering, points: float) -> None:
    (width, height), e = frame.size, frame.enlarged
    y, x = 0.45 * BOTTOM_ROOM * e / height, 1.0 - 12.0 * e / width
    for name, color in reversed(words.legend):
        figure.text(x, y, name, color=color, fontsize=NOTE_LETTER * points, ha="right", va="center")
        x -= (0.62 * NOTE_LETTER * len(name) + 12.0) * e / width
    room = x * width - 90.0 * e
    note = fitting("   ".join(words.notes), room, 0.9 * NOTE_LETTER * e)
    figure.text(
        90.0 * e / width,
        y,
        note,
        color="0.25",
        fontsize=NOTE_LETTER * points,
        va="center",
        parse_math=False,
    )


def _draw_axes(figure: Figure, frame: Frame, axes: Array, points: float) -> None:
    """The directions x, y, z in the lower left corner."""
    (width, height), e = frame.size, frame.enlarged
    pane = figure.add_axes((0.0, 0.0, 84.0 * e / width, 84.0 * e / height))
    pane.set_axis_off()
    pane.set_xlim(-1.5, 1.5)
    pane.set_ylim(-1.5, 1.5)
    draw_triad(pane, axes, np.zeros(2), 1.0, 2.2 * points, 0.9 * NOTE_LETTER * points)


def _draw_scale(figure: Figure, frame: Frame, scale: Scale, ends: str, points: float) -> None:
    width, e = frame.size[0], frame.enlarged
    largest = scale.largest / scale.factor or 1.0
    pane = figure.add_axes((1.0 - (SCALE_ROOM - 34.0) * e / width, 0.16, 20.0 * e / width, 0.62))
    norm = Normalize(0.0, largest)
    bar = Colorbar(pane, cmap=COLOR_MAP, norm=norm)
    bar.outline.set_visible(False)
    step = [tick for tick in pane.get_yticks() if 0.0 <= tick < 0.93 * largest]
    bar.set_ticks([*step, largest], labels=[f"{t:.3g}" for t in (*step, largest)])
    pane.tick_params(labelsize=NOTE_LETTER * points, length=3 * points, width=0.7 * points)
    name = "\n".join(scale.words.rsplit(" ", 1))
    figure.text(
        1.0 - (SCALE_ROOM - 34.0) * e / width,
        0.795,
        f"{name}\n[{scale.unit}]",
        fontsize=NOTE_LETTER * points,
        va="bottom",
        linespacing=1.15,
    )
    figure.text(
        1.0 - (SCALE_ROOM - 34.0) * e / width,
        0.14,
        ends,
        color="0.35",
        fontsize=0.8 * NOTE_LETTER * points,
        va="top",
        linespacing=1.15,
    )


class Clock:
    """Writes the time at the upper right, always with as many digits.

    last: the largest time; step: between frames [s].
    """

    def __init__(self, frame: Frame, last: float, step: float) -> None:
        from PIL import ImageFont

        self._frame = frame
        self._exponent = exponent_of(abs(last))
        step = step / 10.0**self._exponent
        self._digits = int(np.clip(np.ceil(-np.log10(step)), 0, 6)) if step > 0.0 else 3
        self._font = ImageFont.truetype(
            findfont("DejaVu Sans"), max(round(TITLE_LETTER * frame.enlarged), 1)
        )

    def text(self, time: float) -> str:
        return (
            f"t = {time / 10.0**self._exponent:.{self._digits}f} {UNIT_PREFIXES[self._exponent]}s"
        )

    def write(self, image: Image, time: float) -> Image:
        from PIL import Image as Images
        from PIL import ImageDraw

        picture = Images.fromarray(image)
        e, width = self._frame.enlarged, self._frame.size[0]
        ImageDraw.Draw(picture).text(
            (width - 14.0 * e, 0.5 * TOP_ROOM * e),
            self.text(time),
            fill=(30, 30, 30),
            font=self._font,
            anchor="rm",
        )
        return np.asarray(picture)
