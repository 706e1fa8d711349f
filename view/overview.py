"""The panels of results when none are named: what moved, what pushed, and the energies."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..results import QuantityError, Results
from ..results.quantities import AXES
from ..superelement.validation import Array
from .curve import Curve
from .quantities import curves

# More lines cannot be told apart, and more panels not be seen at once.
MAX_CURVES = 6
MAX_PANELS = 6

# Of the largest curve of a panel: smaller ones would lie on the axis.
LEAST_PEAK_SHARE = 0.01
# Ranges of coordinates below are rounding, in any unit that models of machines have.
LEAST_MOTION = 1e-12

# Of the range of a panel: a position that changes less looks like a level.
LEAST_RANGE_SHARE = 0.1

# Joints have them as coordinates, but they are forces and states.
FRICTION_COORDINATES = ("friction", "friction_state")
# In the order in which they are looked for: gauges are placed for what matters most.
READING_KINDS = ("strain", "stress", "sensor_acceleration", "sensor_displacement")
# The balance has a panel of its own, and the others are parts of those that are shown.
HIDDEN_ENERGIES = ("balance", "modal", "compliance_work", "modal_loss", "modal_damping")


@dataclass(frozen=True, eq=False)
class Candidate:
    """A curve that may be shown, and the quantity that it is of."""

    quantity: str
    curve: Curve


def overview(results: Results) -> list[list[Curve]]:
    """Choose at most six panels of what moved, what pushed, and of energies.

    In this order, as far as it was recorded and is not zero: coordinates of joints, angles and
    distances, or where no joint has a coordinate that moves the positions of bodies, velocities if
    these hardly change; forces of motors; normal forces of contacts and stops; elastic
    displacements of interfaces; what sensors read; angular velocities, or velocities if nothing
    turns; gaps; energies; their balance. Of more than six panels the energies stay, and the first
    ones. Of many curves the largest are shown, of positions those with the largest range.

    Raises
    ------
    QuantityError
        If nothing is left.

    Examples
    --------
    >>> from duhamel import view
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.1).results
    >>> [view.title_and_labels(panel)[0] for panel in view.overview(results)]
    ['ball, position along z', 'ball, velocity along z', 'energy', 'energy balance']
    """
    return [[candidate.curve for candidate in panel] for panel in _panels(results)]


def overview_quantities(results: Results) -> list[list[str]]:
    """Name the quantities of the panels of `overview`, which see for an example.

    Returns
    -------
    list of list of str
        As `duhamel plot` has them.
    """
    return [[candidate.quantity for candidate in panel] for panel in _panels(results)]


def _panels(results: Results) -> list[list[Candidate]]:
    travel = _travel(results)
    motion = [
        *travel,
        _of_one_unit(_scalars(results, "motor_torque", results.motors)),
        _of_one_unit(_scalars(results, "normal_force", _pressed(results))),
        _largest(_vectors(results, "elastic_displacement", results.interfaces), _peak),
        _readings(results),
        _speeds(results, travel),
        _of_one_unit(_gaps(results)),
    ]
    names = [name for name in results.energies if name not in HIDDEN_ENERGIES]
    energies = [
        _largest(_scalars(results, "energy", names), _peak, still=0.0),
        _scalars(results, "energy", ["balance"] if "balance" in results.energies else []),
    ]
    energies = [panel for panel in energies if panel]
    motion = [panel for panel in motion if panel][: MAX_PANELS - len(energies)]
    if not motion and not energies:
        raise QuantityError("there is nothing that is shown unasked: name quantities")
    return [*motion, *energies]


def _pressed(results: Results) -> tuple[str, ...]:
    return *results.contacts, *results.surface_contacts, *results.stops


def _travel(results: Results) -> list[list[Candidate]]:
    """Angles and distances of joints that move, or positions of bodies.

    Positions that change little beside what they are would be levels: velocities then.
    """
    moved = [one for one in _coordinates(results) if _range(one.curve.values) > LEAST_MOTION]
    units = sorted({one.curve.unit for one in moved}, reverse=True)
    if units:
        return [
            _largest([one for one in moved if one.curve.unit == unit], _range) for unit in units
        ]
    positions = _largest(_vectors(results, "position", results.bodies), _range)
    ranges = [_range(one.curve.values) for one in positions]
    span = np.ptp(np.concatenate([one.curve.values for one in positions] or [np.zeros(1)]))
    if max(ranges, default=0.0) > LEAST_RANGE_SHARE * span:
        return [positions]
    return [_largest(_vectors(results, "velocity", results.bodies), _peak)]


def _coordinates(results: Results) -> list[Candidate]:
    """Of all joints, without rates."""
    return [
        candidate
        for joint in results.joints
        for name in results.joint(joint).coordinates
        if not name.endswith("_rate") and name not in FRICTION_COORDINATES
        for candidate in _scalars(results, f"coordinate:{joint}", [name])
    ]


def _speeds(results: Results, travel: Sequence[Sequence[Candidate]]) -> list[Candidate]:
    """Angular velocities, or velocities where nothing turns and they are not shown already."""
    turning = _largest(_vectors(results, "angular_velocity", results.bodies), _peak)
    if turning or any(one.quantity.startswith("velocity:") for panel in travel for one in panel):
        return turning
    return _largest(_vectors(results, "velocity", results.bodies), _peak)


def _gaps(results: Results) -> list[Candidate]:
    """Of those that closed, or of all if none did."""
    owners = (*results.contacts, *results.stops)
    touched = [name for name in owners if results.contact(name).state.any()]
    return _scalars(results, "gap", touched or owners)


def _readings(results: Results) -> list[Candidate]:
    """Of the first kind that the sensors read."""
    for kind in READING_KINDS:
        found: list[Candidate] = []
        for sensor in results.sensors:
            try:
                found += _candidates(results, f"{kind}:{sensor}")
            except QuantityError:
                continue
        if found:
            return _largest(found, _peak)
    return []


def _of_one_unit(candidates: Sequence[Candidate]) -> list[Candidate]:
    """The largest of the unit that most have."""
    units = [candidate.curve.unit for candidate in candidates]
    most = max(units, key=units.count, default="")
    return _largest([one for one in candidates if one.curve.unit == most], _peak)


def _scalars(results: Results, kind: str, names: Iterable[str]) -> list[Candidate]:
    return [one for name in names for one in _candidates(results, f"{kind}:{name}")]


def _vectors(results: Results, kind: str, names: Iterable[str]) -> list[Candidate]:
    return [
        one
        for name in names
        for axis in AXES
        for one in _candidates(results, f"{kind}:{name}:{axis}")
    ]


def _candidates(results: Results, quantity: str) -> list[Candidate]:
    found = curves(results, quantity)
    if len(found) == 1:
        return [Candidate(quantity, found[0])]
    return [Candidate(f"{quantity}:{curve.words[2]}", curve) for curve in found]


def _peak(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))


def _range(values: Array) -> float:
    return float(np.ptp(values)) if len(values) else 0.0


def _largest(
    candidates: Sequence[Candidate], size: Callable[[Array], float], still: float = LEAST_MOTION
) -> list[Candidate]:
    """Those that are seen beside the largest; none where none moves."""
    sizes = np.array([size(candidate.curve.values) for candidate in candidates])
    chosen = [
        i
        for i in np.argsort(-sizes, kind="stable")[:MAX_CURVES]
        if sizes[i] >= max(LEAST_PEAK_SHARE * sizes.max(), still)
    ]
    return [candidates[i] for i in sorted(chosen)]
