"""What to show of a results file when nobody says."""

from collections.abc import Callable

import numpy as np

from .errors import QuantityError
from .quantities import AXES, Curve, curves
from .recording import Recording
from .rotations import Array

MOST_CURVES = 6

VISIBLE = 0.01
"""the least peak of a curve beside the largest one in its panel"""


def overview(recording: Recording) -> list[list[Curve]]:
    """Four panels: how fast, how far, the energies, and how well they balance.

    How fast are the angular velocities of the bodies, or their velocities if nothing turns; how far
    are the elastic displacements of the interfaces, or the positions of the bodies if none is
    flexible. Where there are many, those that are largest are shown: positions by how far they go.
    A panel of which nothing was recorded is left out; QuantityError if all are.
    """
    speed = _all(recording, "angular_velocity", recording.bodies)
    if not any(curve.values.any() for curve in speed):
        speed = _all(recording, "velocity", recording.bodies)
    if recording.interfaces:
        travel = _largest(_all(recording, "elastic_displacement", recording.interfaces), _peak)
    else:
        travel = _largest(_all(recording, "position", recording.bodies), _range)
    energies = [f"energy:{name}" for name in recording.energies if name not in ("balance", "modal")]
    panels = [
        _largest(speed, _peak),
        travel,
        _largest([curve for energy in energies for curve in curves(recording, energy)], _peak),
        curves(recording, "energy:balance") if "balance" in recording.energies else [],
    ]
    if not any(panels):
        raise QuantityError("there is nothing that is shown unasked: name quantities")
    return [panel for panel in panels if panel]


def _all(recording: Recording, kind: str, names: tuple[str, ...]) -> list[Curve]:
    return [
        curve
        for name in names
        for axis in AXES
        for curve in curves(recording, f"{kind}:{name}:{axis}")
    ]


def _peak(values: Array) -> float:
    return float(np.abs(values).max())


def _range(values: Array) -> float:
    return float(np.ptp(values))


def _largest(found: list[Curve], size: Callable[[Array], float]) -> list[Curve]:
    sizes = np.array([size(curve.values) for curve in found])
    chosen = [
        i
        for i in np.argsort(-sizes, kind="stable")[:MOST_CURVES]
        if sizes[i] >= VISIBLE * sizes.max()
    ]
    return [found[i] for i in sorted(chosen)]
