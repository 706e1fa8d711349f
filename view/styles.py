"""The colors and dashes of curves, which tell them apart."""

from collections.abc import Sequence
from typing import Any

from .curve import Curve

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""the palette of Okabe and Ito, which the color-blind can distinguish"""
CURVE_DASHES = ("-", (0, (4, 1.5)), (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5)))


def styles(curves: Sequence[Curve]) -> list[dict[str, Any]]:
    """Of each curve.

    A color each, and dashed ones when the colors are used up. Of several runs a color for each
    quantity, and dashes for each run; of one quantity a color for each run too.
    """
    runs = list(dict.fromkeys(curve.run for curve in curves))
    quantities = list(dict.fromkeys(curve.words for curve in curves))
    if len(runs) < 2:
        return [_style(n, n // len(COLORS)) for n in range(len(curves))]
    dashes = [runs.index(curve.run) for curve in curves]
    own = [quantities.index(curve.words) for curve in curves]
    shades = own if len(quantities) > 1 else dashes
    return [_style(color, dash) for color, dash in zip(shades, dashes, strict=True)]


def _style(color: int, dash: int) -> dict[str, Any]:
    return {
        "color": COLORS[color % len(COLORS)],
        "linestyle": CURVE_DASHES[dash % len(CURVE_DASHES)],
    }
