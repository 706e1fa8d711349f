"""Draw the pictures of docs/concepts.md: `python tools/draw_concepts.py`."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Polygon

IMAGES = Path(__file__).parents[1] / "docs" / "images"
BLUE, ORANGE, GREEN, GRAY = "#0072b2", "#d55e00", "#009e73", "#888888"
LENGTH, HEIGHT = 6.0, 1.0
"""of the bar that is drawn"""


def bar(ax: Axes, bend: float = 0.0, place: tuple[float, float, float] = (0, 0, 0)) -> None:
    """A bar of quadrilaterals, bent by a parabola without mean and moment, and turned."""
    x, y = np.meshgrid(np.linspace(0, LENGTH, 13), np.linspace(-HEIGHT / 2, HEIGHT / 2, 3))
    points = placed(x, y, bend, place)
    for row in range(2):
        for column in range(12):
            corners = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)]
            ax.add_patch(
                Polygon([points[c] for c in corners], facecolor="#e8ecef", edgecolor=GRAY, lw=0.6)
            )


def placed(
    x: np.ndarray, y: np.ndarray, bend: float, place: tuple[float, float, float]
) -> np.ndarray:
    """Points of the bar in space."""
    s = x / LENGTH
    slope = bend * (2.0 * s - 1.0) / LENGTH
    u, v = x - y * slope, y + bend * (s**2 - s + 1.0 / 6.0)
    cos, sin = np.cos(place[2]), np.sin(place[2])
    return np.stack([place[0] + cos * u - sin * v, place[1] + sin * u + cos * v], axis=-1)


def axes_at(ax: Axes, at: tuple[float, float], angle: float, color: str, size: float = 0.9) -> None:
    """Two arrows for a frame."""
    for turn in (angle, angle + np.pi / 2):
        arrow(ax, at, (at[0] + size * np.cos(turn), at[1] + size * np.sin(turn)), color)


def arrow(ax: Axes, start: tuple[float, float], end: tuple[float, float], color: str) -> None:
    ax.add_patch(
        FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=10, color=color, lw=1.6)
    )


def blank(width: float, height: float) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(width, height))
    ax = figure.add_axes((0, 0, 1, 1))
    ax.set_aspect("equal")
    ax.axis("off")
    return figure, ax


def superelement() -> Figure:
    figure, ax = blank(7.5, 2.6)
    bar(ax)
    for x, name in ((0.0, "root"), (LENGTH, "tip")):
        ax.add_patch(Circle((x, 0), 0.12, color=ORANGE, zorder=3))
        ax.text(x, -1.0, name, color=ORANGE, ha="center")
    ax.text(LENGTH / 2, 1.0, "mesh: 48 165 unknowns", ha="center")
    arrow(ax, (6.8, 0), (8.4, 0), "black")
    ax.text(7.6, 0.25, "preprocess", ha="center", fontsize=9)
    t = np.linspace(0, 3.2, 300)
    for row in range(2):
        for column in range(2):
            decay = np.exp(-0.6 * t) * np.sin((5 + 4 * (row == column)) * t) * 0.45
            x0, y0 = 9.0 + 3.6 * column, 0.75 - 1.5 * row
            ax.plot([x0, x0 + 3.2], [y0, y0], color=GRAY, lw=0.6)
            ax.plot(x0 + t, y0 + decay, color=BLUE, lw=1.2)
    ax.text(12.6, 1.55, "impulse responses: 12 x 12", ha="center", color=BLUE)
    ax.text(12.6, -1.75, "superelement", ha="center")
    ax.set_xlim(-0.6, 16.2)
    ax.set_ylim(-2.1, 2.1)
    return figure


def interface() -> Figure:
    figure, ax = blank(6.5, 2.6)
    for x0, name, squeeze in ((0.0, "average", 0.25), (7.0, "rigid", 0.0)):
        angles = np.linspace(0, 2 * np.pi, 200)
        radius = 1.0 + squeeze * np.cos(2 * angles)
        ring = np.stack([x0 + 1.9 * np.cos(angles), 1.9 * np.sin(angles)], axis=1)
        hole = np.stack([x0 + radius * np.cos(angles), radius * np.sin(angles)], axis=1)
        ax.add_patch(Polygon(ring, facecolor="#e8ecef", edgecolor=GRAY))
        ax.add_patch(Polygon(hole, facecolor="white", edgecolor=ORANGE, lw=2))
        for angle in angles[:-1:17]:
            r = 1.0 + squeeze * np.cos(2 * angle)
            end = (x0 + r * np.cos(angle), r * np.sin(angle))
            style = "-" if name == "rigid" else ":"
            ax.plot([x0, end[0]], [0, end[1]], style, color=GRAY, lw=1.0)
        axes_at(ax, (x0, 0), 0.0, BLUE, 0.75)
        ax.text(x0, -2.4, name, ha="center")
    ax.text(
        2.1, 1.55, "facets stay elastic;\nthe frame has their\nmean motion", fontsize=9, va="top"
    )
    ax.text(9.1, 1.55, "facets follow\nthe frame", fontsize=9, va="top")
    ax.set_xlim(-2.3, 12.2)
    ax.set_ylim(-2.8, 2.2)
    return figure


def floating_frame() -> Figure:
    figure, ax = blank(7.0, 3.2)
    place = (3.0, 0.6, np.radians(20))
    bar(ax, 4.0, place)
    straight = placed(np.array([0, LENGTH]), np.zeros(2), 0.0, place)
    ax.plot(*straight.T, "--", color=GRAY, lw=1.2)
    middle = tuple(straight.mean(axis=0))
    axes_at(ax, (0, 0), 0.0, "black")
    ax.text(-0.2, -0.45, "space")
    arrow(ax, (0, 0), middle, GREEN)
    ax.text(2.3, 0.15, "x", color=GREEN, fontsize=12)
    axes_at(ax, middle, place[2], BLUE, 1.2)
    ax.text(middle[0] + 0.5, middle[1] - 0.45, "floating frame, R", color=BLUE)
    tip = placed(np.array([LENGTH]), np.zeros(1), 4.0, place)[0]
    arrow(ax, tuple(straight[1]), tuple(tip), ORANGE)
    ax.text(straight[1, 0] + 0.15, straight[1, 1] + 0.3, "elastic\ndisplacement u", color=ORANGE)
    ax.set_xlim(-0.7, 12.0)
    ax.set_ylim(-0.8, 4.9)
    return figure


def convolution() -> Figure:
    figure = Figure(figsize=(7.0, 3.2), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    steps = np.arange(13)
    loads = np.array([0, 0.6, 1.0, 0.7, 0.2, 0, 0, 0.4, 0.5, 0.1, 0, 0, 0])
    fine = np.linspace(0, 12, 193)
    total = np.zeros_like(fine)
    for step, load in zip(steps, loads, strict=True):
        if load:
            hat = load * np.clip(1 - np.abs(fine - step), 0, None)
            upper.fill_between(fine, hat, color=BLUE, alpha=0.2, lw=0)
            after = np.clip(fine - step, 0, None)
            response = load * np.sin(2.0 * after) * np.exp(-0.25 * after)
            lower.plot(fine, response, color=BLUE, alpha=0.35, lw=0.9)
            total += response
    upper.plot(steps, loads, "o-", color=BLUE, ms=4)
    lower.plot(fine, total, color=ORANGE, lw=1.8)
    upper.set_ylabel("load p")
    lower.set_ylabel("displacement u")
    lower.set_xlabel("time, in steps")
    for ax in (upper, lower):
        ax.set_yticks([])
        ax.spines[["top", "right"]].set_visible(False)
    return figure


def main() -> None:
    mpl.rcParams.update({"svg.hashsalt": "duhamel", "font.size": 10, "svg.fonttype": "none"})
    for draw in (superelement, interface, floating_frame, convolution):
        path = IMAGES / f"concept-{draw.__name__.replace('_', '-')}.svg"
        draw().savefig(path, metadata={"Date": None}, facecolor="white")


if __name__ == "__main__":
    main()
