"""The panels of results when none are named."""

from collections.abc import Callable

import numpy as np

from ..results import QuantityError, Results
from ..results.quantities import AXES
from ..superelement.validation import Array
from .quantities import Curve, curves

MOST_CURVES = 6

VISIBLE = 0.01
"""the least peak of a curve beside the largest one in its panel"""


def overview(results: Results) -> list[list[Curve]]:
    """Four panels: speeds, displacements, energies, and their balance.

    Speeds are the angular velocities of the bodies, or their velocities if nothing rotates;
    displacements are elastic ones of the interfaces, or the positions of the bodies if none is
    flexible. Of many curves the largest are shown, of positions those with the largest range. A
    panel of which nothing was recorded is left out; QuantityError if all are.
    """
    speed = _all(results, "angular_velocity", results.bodies)
    if not any(curve.values.any() for curve in speed):
        speed = _all(results, "velocity", results.bodies)
    if results.interfaces:
        travel = _largest(_all(results, "elastic_displacement", results.interfaces), _peak)
    else:
        travel = _largest(_all(results, "position", results.bodies), _range)
    energies = [f"energy:{name}" for name in results.energies if name not in ("balance", "modal")]
    panels = [
        _largest(speed, _peak),
        travel,
        _largest([curve for energy in energies for curve in curves(results, energy)], _peak),
        curves(results, "energy:balance") if "balance" in results.energies else [],
    ]
    if not any(panels):
        raise QuantityError("there is nothing that is shown unasked: name quantities")
    return [panel for panel in panels if panel]


def _all(results: Results, kind: str, names: tuple[str, ...]) -> list[Curve]:
    return [
        curve
        for name in names
        for axis in AXES
        for curve in curves(results, f"{kind}:{name}:{axis}")
    ]


def _peak(values: Array) -> float:
    return float(np.abs(values).max())


def _range(values: Array) -> float:
    return float(np.ptp(values))


def _largest(candidates: list[Curve], size: Callable[[Array], float]) -> list[Curve]:
    sizes = np.array([size(curve.values) for curve in candidates])
    chosen = [
        i
        for i in np.argsort(-sizes, kind="stable")[:MOST_CURVES]
        if sizes[i] >= VISIBLE * sizes.max()
    ]
    return [candidates[i] for i in sorted(chosen)]
