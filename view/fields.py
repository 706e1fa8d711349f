"""Fields on the surfaces of bodies as pictures: stresses of deformed bodies, in colors."""

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from ..superelement.validation import Array
from .picture import style
from .scene import IntArray, Patch, Scene, draw_scene

COLOURS = "turbo"
BAR = (3.2, 0.11)
"""length and height of the bar of colors [inch]"""
ROOM = (0.25, 0.6)
"""below and in all for the bar, under the views [inch]"""

TRIANGLES = {
    3: [[0, 1, 2]],
    4: [[0, 1, 2], [0, 2, 3]],
    6: [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
    8: [[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 6], [4, 6, 7]],
    9: [[0, 4, 8], [0, 8, 7], [4, 1, 5], [4, 5, 8], [8, 5, 2], [8, 2, 6], [7, 8, 6], [7, 6, 3]],
}
"""What facets are cut into, by their number of nodes in meshio's order, so that curved ones stay
curved.
"""


@dataclass(frozen=True, eq=False)
class Field:
    """A surface and a value at each of its points.

    points (p, 3) [m]; values (p,); cells (n, k): facets as rows of points that turn outwards, each
    of the type that its number of nodes tells, in meshio's order (3, 4, 6, 8 or 9), with -1 filling
    short rows, as a superelement's recovery has them.
    """

    points: Array
    cells: IntArray
    values: Array


def draw_fields(
    fields: Sequence[Field], label: str, scale: float = 1.0, scene: Scene | None = None
) -> Figure:
    """Bodies from two sides, colored by values times `scale` from zero to the largest; what else
    the scene holds too.

    label: what the values are, with the unit that `scale` leaves, for the bar of colors.
    """
    largest = scale * max(float(field.values.max()) for field in fields)
    norm, colours = Normalize(0.0, largest), matplotlib.colormaps[COLOURS]
    patches = [*(scene.patches if scene else ())]
    for field in fields:
        facets, values = _triangles(field)
        patches.append(
            Patch(facets, np.full(len(facets), -1), colours(norm(scale * values))[:, :3])
        )
    whole = Scene(patches, scene.lines, scene.places, scene.masses) if scene else Scene(patches)
    figure = draw_scene(whole)
    (length, height), (below, room) = BAR, ROOM
    wide, high = figure.get_size_inches()
    for axes in figure.axes:
        x, y, width, part = axes.get_position().bounds
        axes.set_position(
            (x, (y * high + room) / (high + room), width, part * high / (high + room))
        )
    figure.set_size_inches(wide, high + room)
    high += room
    with style():
        axes = figure.add_axes(
            (0.5 - 0.5 * length / wide, below / high, length / wide, height / high)
        )
        bar = Colorbar(axes, cmap=colours, norm=norm, orientation="horizontal")
        bar.outline.set_visible(False)
        axes.set_title(label, fontsize=8)
        axes.tick_params(labelsize=8, length=2)
    return figure


def _triangles(field: Field) -> tuple[Array, Array]:
    """Triangles (m, 3, 3) and their mean values (m,): what facets are cut into, each cut in four
    again, for colors.
    """
    lengths = (field.cells >= 0).sum(axis=1)
    rows = [
        field.cells[lengths == length][:, parts].reshape(-1, 3)
        for length, parts in TRIANGLES.items()
        if (lengths == length).any()
    ]
    corners = np.concatenate(rows)
    both = np.concatenate([field.points, field.values[:, None]], axis=1)[corners]
    both = np.concatenate([both, 0.5 * (both + np.roll(both, -1, axis=1))], axis=1)
    both = both[:, TRIANGLES[6]].reshape(-1, 3, 4)
    return both[:, :, :3], both[:, :, 3].mean(axis=1)
