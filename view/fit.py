"""A test of a part as a picture: measured and fitted responses, misfits, shapes, and where."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..files.arrays import Array
from .camera import ISOMETRIC_EYE, UPWARD, axes_towards
from .picture import panels
from .styles import COLORS

HEIGHTS_OF_FIT = (1.5, 1.0, 1.6, 1.6)
HIT_LENGTH = 0.08
"""of arrows of hits, over the extent of the part"""
LETTERS_OF_FIT = 7.0


@dataclass(frozen=True, eq=False)
class FitOfTest:
    """What `draw_fit` draws; see there for an example.

    Parameters
    ----------
    frequencies : (k,) [Hz]
    measured, fitted : (k,) [1/kg]
        Root mean squares of all accelerances.
    modes : (m,) [Hz]
    mac : (m, m)
        Modal assurance criterion of the modes with one another, at the sensors.
    misfits : mapping of str to float
        Of each channel and of each hit.
    sensors, hits, interfaces : mapping of str to (3,) [m]
    directions : mapping of str to (3,)
        Of the hits.
    """

    frequencies: Array
    measured: Array
    fitted: Array
    modes: Array
    mac: Array
    misfits: Mapping[str, float]
    sensors: Mapping[str, Array]
    hits: Mapping[str, Array]
    interfaces: Mapping[str, Array]
    directions: Mapping[str, Array]


def draw_fit(fit: FitOfTest) -> Figure:
    """Draw responses with their modes, misfits by channel and hit, how alike modes are, and places.

    Examples
    --------
    >>> import numpy as np
    >>> place = {"1": np.zeros(3)}
    >>> f = np.linspace(10.0, 100.0, 5)
    >>> one = np.array([50.0]), np.array([[1.0]])
    >>> fit = FitOfTest(f, f, f, *one, {"1:x": 0.1}, place, {}, place, {})
    >>> len(draw_fit(fit).axes)
    5
    """
    figure, (responses, bars, alike, places) = panels(4, share_time=False, heights=HEIGHTS_OF_FIT)
    responses.semilogy(fit.frequencies, fit.measured, color=COLORS[0], label="measured")
    responses.semilogy(fit.frequencies, fit.fitted, "--", color=COLORS[1], label="fitted")
    for frequency in fit.modes:
        responses.axvline(frequency, color="0.8", linewidth=0.8, zorder=0)
    responses.set_xlabel("frequency [Hz]")
    responses.set_ylabel("accelerance [1/kg], rms")
    responses.legend(loc="best")
    bars.bar(range(len(fit.misfits)), list(fit.misfits.values()), color=COLORS[0])
    bars.set_xticks(range(len(fit.misfits)), list(fit.misfits), rotation=90, fontsize=6.0)
    bars.set_ylabel("misfit")
    _draw_mac(alike, fit)
    _draw_places(places, fit)
    return figure


def _draw_mac(axes: Axes, fit: FitOfTest) -> None:
    """Of modes that the sensors tell apart only the diagonal is dark."""
    # One scale for all tests, so that pictures can be compared.
    image = axes.imshow(fit.mac, cmap="Blues", vmin=0.0, vmax=1.0)
    names = [f"{frequency:.4g}" for frequency in fit.modes]
    for ticks, turn in ((axes.set_xticks, 90.0), (axes.set_yticks, 0.0)):
        ticks(range(len(names)), names, rotation=turn, fontsize=LETTERS_OF_FIT)
    axes.set_ylabel("mode [Hz]")
    axes.grid(visible=False)
    axes.figure.colorbar(image, ax=axes, label="MAC")


def _draw_places(axes: Axes, fit: FitOfTest) -> None:
    camera = axes_towards(ISOMETRIC_EYE, UPWARD)
    every = np.array([*fit.sensors.values(), *fit.hits.values(), *fit.interfaces.values()])
    length = HIT_LENGTH * float(np.linalg.norm(np.ptp(every, axis=0)))
    kinds = (
        ("sensors", fit.sensors, "s", COLORS[0]),
        ("interfaces", fit.interfaces, "o", COLORS[2]),
    )
    for label, points, marker, color in kinds:
        seen = [_seen(camera, X) for X in points.values()]
        axes.plot(*zip(*seen, strict=True), marker, color=color, label=label, markersize=5.0)
        for name, at in zip(points, seen, strict=True):
            axes.annotate(name, at, (4, 4), textcoords="offset points", fontsize=LETTERS_OF_FIT)
    for name, X in fit.hits.items():
        tip, tail = _seen(camera, X), _seen(camera, X - length * fit.directions[name])
        arrow = {"arrowstyle": "->", "color": COLORS[1], "linewidth": 0.9}
        axes.annotate("", tip, tail, arrowprops=arrow)
        axes.annotate(name, tail, fontsize=LETTERS_OF_FIT, color=COLORS[1], ha="center")
        axes.plot(*tail, alpha=0.0)  # so that the panel holds the arrow
    axes.plot([], [], color=COLORS[1], label="hits")
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.legend(loc="best")


def _seen(camera: Array, X: Array) -> tuple[float, float]:
    across, up = camera[:2] @ X
    return float(across), float(up)
