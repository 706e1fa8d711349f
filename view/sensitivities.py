"""The picture of sensitivities: how much each output follows each parameter."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from ..superelement.validation import Array
from .picture import PICTURE_WIDTH, entitle, panels, style
from .styles import COLORS

BAR_HEIGHT, MARGIN_HEIGHT = 0.22, 1.1
"""[inch]"""
SHARE_OF_BARS = 0.8
"""of the distance from one output to the next"""


def draw_elasticities(
    parameters: Sequence[str],
    outputs: Sequence[str],
    elasticity: Array,
    error: Array,
    title: str = "",
) -> Figure:
    """Draw elasticities as bars with their errors: an output a group, a parameter a color.

    Parameters
    ----------
    parameters, outputs : sequence of str
    elasticity, error : (outputs, parameters)
        Per cent of an output for one per cent of a parameter.
    title : str

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> figure = view.draw_elasticities(["k"], ["peak"], np.array([[0.5]]), np.array([[0.01]]))
    >>> figure.axes[0].get_xlabel()
    '% of the output for 1 % of the parameter'
    """
    figure, (axes,) = panels(1)
    figure.set_size_inches(
        PICTURE_WIDTH, MARGIN_HEIGHT + BAR_HEIGHT * max(len(outputs) * len(parameters), 4)
    )
    height = SHARE_OF_BARS / len(parameters)
    places = np.arange(len(outputs), dtype=float)
    with style():
        for k, parameter in enumerate(parameters):
            axes.barh(
                places + (k - 0.5 * (len(parameters) - 1)) * height,
                elasticity[:, k],
                height,
                xerr=np.where(np.isfinite(error[:, k]), error[:, k], 0.0),
                color=COLORS[k % len(COLORS)],
                error_kw={"elinewidth": 0.8, "capsize": 2.0},
                label=parameter,
            )
        axes.axvline(0.0, color="0.3", linewidth=0.8)
        axes.set_yticks(places, outputs)
        # The first output of the table is on top.
        axes.invert_yaxis()
        axes.set_xlabel("% of the output for 1 % of the parameter")
        axes.legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, fontsize="small", frameon=False
        )
    entitle(figure, title)
    return figure
