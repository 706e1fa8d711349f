"""Fields on the surfaces of bodies as pictures: stresses of deformed bodies, in colors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from ..superelement.cells import TRIANGLES_OF_FACET, IntArray, triangles
from ..superelement.validation import Array
from .field_kinds import COLOR_MAP
from .picture import add_room, style
from .scene import Marker, Patch, Scene, draw_scene

# Length and height [inch].
COLOR_BAR_SIZE = (3.2, 0.11)
# Height below the bar, and of the bar with its margins, under the views [inch].
COLOR_BAR_ROOM = (0.25, 0.6)


@dataclass(frozen=True, eq=False)
class Field:
    """A surface and a value at each of its points, see `draw_fields` for an example.

    Parameters
    ----------
    points : (p, 3) [m]
    cells : (n, k)
        Facets as rows of points that turn outwards, each of the type of its number of nodes, in
        meshio's order (3, 4, 6, 8 or 9), with -1 filling short rows, as a superelement's recovery
        has them.
    values : (p,)
    """

    points: Array
    cells: IntArray
    values: Array


def draw_fields(
    fields: Sequence[Field], label: str, scale: float = 1.0, scene: Scene | None = None
) -> Figure:
    """Draw surfaces from two sides, colored from zero to the largest value.

    Parameters
    ----------
    fields : sequence of Field
    label : str
        The name of the values, with the unit that they have times `scale`, for the bar of colors.
    scale : float
    scene : Scene, optional
        Drawn with them.

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> triangle = view.Field(np.eye(3), np.array([[0, 1, 2]]), np.array([0.0, 1e6, 2e6]))
    >>> figure = view.draw_fields([triangle], "von Mises stress [MPa]", 1e-6)
    >>> figure.axes[-1].get_title(loc="left")
    'von Mises stress [MPa]'
    """
    largest = scale * max(float(field.values.max()) for field in fields)
    norm = Normalize(0.0, largest or 1.0)
    patches = [*(scene.patches if scene else ())]
    for field in fields:
        facets, values = _triangles(field)
        numbers = _touching(facets, scene.markers if scene else ())
        patches.append(Patch(facets, numbers, COLOR_MAP(norm(scale * values))[:, :3]))
    whole = Scene(patches, scene.lines, scene.markers, scene.masses) if scene else Scene(patches)
    figure = draw_scene(whole)
    (length, height), (bottom, below) = COLOR_BAR_SIZE, COLOR_BAR_ROOM
    add_room(figure, below=below)
    wide, high = figure.get_size_inches()
    with style():
        axes = figure.add_axes(
            (0.5 - 0.5 * length / wide, bottom / high, length / wide, height / high)
        )
        bar = Colorbar(axes, cmap=COLOR_MAP, norm=norm, orientation="horizontal")
        bar.outline.set_visible(False)
        axes.set_title(label, fontsize=8)
        axes.tick_params(labelsize=8, length=2)
    return figure


def _touching(facets: Array, markers: Sequence[Marker]) -> IntArray:
    """The marker (m,) that is a corner of each facet (m, 3, 3): it is named where they are seen."""
    numbers = np.full(len(facets), -1)
    for n, marker in enumerate(markers):
        numbers[(facets == marker.point).all(axis=-1).any(axis=-1)] = n
    return numbers


def _triangles(field: Field) -> tuple[Array, Array]:
    """The triangles of all facets, each cut in four (m, 3, 3), and their mean values (m,)."""
    corners = np.concatenate([field.points, field.values[:, None]], axis=1)
    both = corners[triangles(field.cells)]
    both = np.concatenate([both, 0.5 * (both + np.roll(both, -1, axis=1))], axis=1)
    both = both[:, list(TRIANGLES_OF_FACET[6])].reshape(-1, 3, 4)
    return both[:, :, :3], both[:, :, 3].mean(axis=1)
