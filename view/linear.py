"""Pictures of linear analyses: frequency responses, Campbell diagrams, shapes of modes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..superelement.validation import Array
from .camera import ISOMETRIC_EYE, UPWARD, axes_towards
from .picture import PANEL_HEIGHT, PICTURE_WIDTH, entitle, panels, style
from .styles import COLORS

# Of the size of the mechanism: a shape is to be seen, and the mechanism to be known again.
LARGEST_SHAPE_SHARE = 0.15
# Relative to the largest response: what is below is rounding, and would stretch the axis.
RESPONSE_ROUNDING = 1e-12
LEGEND_LINE_HEIGHT = 0.17  # [inch]
# Lines just above the reach of engine orders are those that a designer asks about next.
DRAWN_BEYOND_ORDERS = 1.25
# Over the highest frequency, or its line would lie on the frame.
DIAGRAM_TOP_MARGIN = 1.08
# Dashes beside colors, so that the kinds are told apart in print too.
WHIRL_LINES = {"forward": "-", "backward": "--", "none": ":", "mixed": "-."}


@dataclass(frozen=True, eq=False)
class ResponseCurve:
    """A frequency response with its name and unit, see `draw_response` for an example.

    Parameters
    ----------
    name, unit : str
    values : (n,) complex
    """

    name: str
    unit: str
    values: NDArray[np.complex128]


def draw_response(frequencies: Array, curves: Sequence[ResponseCurve], title: str = "") -> Figure:
    """Draw magnitudes and phases of frequency responses.

    Parameters
    ----------
    frequencies : (n,) [Hz]
    curves : sequence of ResponseCurve
    title : str

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> f = np.geomspace(1.0, 100.0, 200)
    >>> oscillator = view.ResponseCurve("tip by load", "m / N", 1.0 / (100.0 - f**2 + 0.5j * f))
    >>> magnitude, phase = view.draw_response(f, [oscillator]).axes
    >>> phase.get_ylabel()
    'phase [°]'
    """
    figure, (size, phase) = panels(2)
    seen = [curve for curve in curves if np.abs(curve.values).max(initial=0.0) > 0.0]
    largest = max((float(np.abs(curve.values).max()) for curve in seen), default=1.0)
    seen = [curve for curve in seen if np.abs(curve.values).max() > RESPONSE_ROUNDING * largest]
    figure.set_figheight(2.0 * PANEL_HEIGHT + LEGEND_LINE_HEIGHT * len(seen))
    with style():
        for curve in seen:
            name = f"{curve.name} [{curve.unit}]"
            size.loglog(frequencies, np.abs(curve.values), label=name)
            degrees = np.degrees(np.angle(curve.values))
            # both are one phase, and rounding would go from one to the other
            phase.semilogx(frequencies, np.where(degrees < -179.9, 180.0, degrees))
        size.set_ylabel("magnitude")
        phase.set_ylabel("phase [°]")
        phase.set_ylim(-190.0, 190.0)
        phase.set_yticks([-180.0, -90.0, 0.0, 90.0, 180.0])
        phase.set_xlabel("frequency [Hz]")
        if seen:
            legend = figure.legend(loc="outside lower left", ncols=1)
            for text in legend.get_texts():
                text.set_parse_math(False)
        entitle(figure, title)
    return figure


@dataclass(frozen=True, eq=False)
class CampbellLine:
    """A mode over the spins, see `draw_campbell` for an example.

    Parameters
    ----------
    whirl : {"forward", "backward", "none", "mixed"}
    frequencies : (n,) [Hz]
    """

    whirl: str
    frequencies: Array


def draw_campbell(
    spins: Array,
    lines: Sequence[CampbellLine],
    orders: Sequence[float] = (1.0,),
    crossings: Sequence[tuple[float, float]] = (),
    title: str = "",
) -> Figure:
    """Draw frequencies over the spin, with engine orders.

    Parameters
    ----------
    spins : (n,) [rad/s]
    lines : sequence of CampbellLine
    orders : sequence of float
        Times a revolution.
    crossings : sequence of (float, float) [rad/s, Hz]
        Spins and frequencies that are marked.
    title : str

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> spins = np.linspace(0.0, 300.0, 4)
    >>> lines = [view.CampbellLine("forward", 40.0 + 0.05 * spins)]
    >>> figure = view.draw_campbell(spins, lines, crossings=[(257.0, 40.9)])
    >>> figure.axes[0].get_xlabel()
    'spin [turns per second]'
    """
    figure, (axes,) = panels(1)
    figure.set_size_inches(PICTURE_WIDTH, 2.0 * PANEL_HEIGHT)
    turns = spins / (2.0 * np.pi)
    with style():
        highest = _band_of_interest(spins, lines, orders)
        top = DIAGRAM_TOP_MARGIN * highest
        named: set[str] = set()
        for line in lines:
            if np.nanmin(line.frequencies) > top:
                continue
            label = line.whirl if line.whirl not in named else None
            label = {"none": "no whirl"}.get(line.whirl, line.whirl) if label else None
            named.add(line.whirl)
            color = COLORS[list(WHIRL_LINES).index(line.whirl)]
            axes.plot(turns, line.frequencies, WHIRL_LINES[line.whirl], color=color, label=label)
        for order in orders:
            axes.plot(turns, order * turns, color="0.6", linewidth=0.8)
            end = min(turns[-1], 1.05 * highest / order)
            axes.annotate(
                f"{order:g}x",
                (end, order * end),
                xytext=(3.0, 0.0),
                textcoords="offset points",
                va="center",
                color="0.4",
                fontsize=8,
            )
        for spin, frequency in crossings:
            axes.plot(spin / (2.0 * np.pi), frequency, "o", color="0.2", markersize=4)
        axes.set_ylim(0.0, top)
        axes.set_xlabel("spin [turns per second]")
        axes.set_ylabel("frequency [Hz]")
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        entitle(figure, title)
    return figure


def _band_of_interest(
    spins: Array, lines: Sequence[CampbellLine], orders: Sequence[float]
) -> float:
    """The highest frequency [Hz] that is drawn.

    A little beyond what the orders reach, but at least the lowest line that they do not reach.
    """
    reached = DRAWN_BEYOND_ORDERS * max(orders, default=1.0) * float(spins[-1]) / (2.0 * np.pi)
    lowest = sorted(float(np.nanmin(line.frequencies)) for line in lines)
    tops = sorted(float(np.nanmax(line.frequencies)) for line in lines)
    above = next((frequency for frequency in lowest if frequency > reached), 0.0)
    return min(max(reached, above), tops[-1])


@dataclass(frozen=True, eq=False)
class ModeShape:
    """A mode of a mechanism, see `draw_shapes` for an example.

    Parameters
    ----------
    title : str
    bodies : sequence of (points, motion, edges)
        Of each body: points (p, 3) [m], their complex motion (p, 3), and edges (e, 2) of points.
    """

    title: str
    bodies: Sequence[tuple[Array, Any, NDArray[np.int64]]]


def draw_shapes(shapes: Sequence[ModeShape], title: str = "") -> Figure:
    """Draw two modes a row: the mechanism as it is in gray, and moved by each mode.

    Parameters
    ----------
    shapes : sequence of ModeShape
    title : str

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    >>> motion = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    >>> mode = view.ModeShape("1: 50 Hz", [(points, motion, np.array([[0, 1]]))])
    >>> view.draw_shapes([mode]).axes[0].get_title(loc="left")
    '1: 50 Hz'
    """
    figure, axes = panels(-(-len(shapes) // 2), 2, share_time=False)
    camera = axes_towards(ISOMETRIC_EYE, UPWARD)[:2]
    with style():
        for axis, shape in zip(axes, shapes, strict=False):
            _draw_shape(axis, shape, camera)
        for axis in axes[len(shapes) :]:
            axis.set_axis_off()
        entitle(figure, title)
    return figure


def _draw_shape(axes: Axes, shape: ModeShape, camera: Array) -> None:
    points = np.vstack([body[0] for body in shape.bodies])
    motion = np.vstack([body[1] for body in shape.bodies])
    size = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    largest = motion.ravel()[np.argmax(np.abs(motion))]
    factor = LARGEST_SHAPE_SHARE * size / largest if abs(largest) > 0.0 else 0.0
    for still, moved, edges in shape.bodies:
        for where, color, width in (
            (still, "0.75", 0.8),
            (still + (factor * moved).real, COLORS[0], 1.3),
        ):
            flat = where @ camera.T
            axes.add_collection(LineCollection(list(flat[edges]), colors=color, linewidths=width))
            if not len(edges):
                axes.plot(*flat.T, "o", color=color, markersize=3)
    whole = np.vstack([points, points + (factor * motion).real, points - (factor * motion).real])
    flat = whole @ camera.T
    axes.update_datalim(flat)
    axes.autoscale_view()
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_axis_off()
    axes.set_title(shape.title, parse_math=False)
