"""The validity of a run, from the extremes that its state has counted (results/validity.py)."""

import numpy as np

from ...results.criteria import CRITERIA, MEND_DEFORMATION
from ...results.validity import Check, Validity
from ..arrays import Array
from ..errors import OutOfRangeError
from ..lower.lower import LoweredModel
from ..step.extremes import MAX_ELASTIC_DISPLACEMENT, MAX_ELASTIC_ROTATION
from ..step.system import State
from .measures import MEASURE_OF_CRITERION
from .reading import Reading
from .subjects import Subjects

FAILING_CRITERIA = (
    "elastic_rotation",
    "elastic_displacement",
    "second_order_rotation",
    "second_order_displacement",
    "spin_turn",
    "inertia_taken",
    "joint_turn",
)
"""criteria beyond whose limits Newton's method may fail"""


class ValidityMonitor:
    """The validity checks of a model by name, "CRITERION:OWNER", and their values in a state.

    It needs nothing but the model and a state of it, whatever takes the steps.
    """

    def __init__(self, lowered: LoweredModel) -> None:
        self._subjects, self._steps = (
            Subjects(lowered),
            (lowered.longest_step, lowered.h, finest_step(lowered)),
        )
        owners = {name: MEASURE_OF_CRITERION[name].owners(self._subjects) for name in CRITERIA}
        self._judged = [name for name in CRITERIA if owners[name]]
        self.names = tuple(f"{name}:{owner}" for name in self._judged for owner in owners[name])

    def values(self, state: State, taken: int) -> Array:
        """The values of all checks after so many steps, in their order."""
        reading = Reading(self._subjects, state, taken)
        # nan and inf are verdicts here.
        with np.errstate(over="ignore", invalid="ignore"):  # of a run that grows without bound
            values = [MEASURE_OF_CRITERION[name].values(reading) for name in self._judged]
        return np.concatenate([np.empty(0), *values])

    def validity(self, state: State, taken: int) -> Validity:
        checks = zip(self.names, self.values(state, taken).tolist(), strict=True)
        found = (Check.of(name, value).with_step(*self._steps) for name, value in checks)
        return Validity(tuple(found))

    def cause(self, state: State, taken: int) -> str:
        """Why Newton's method may have failed: the first warning of a body beyond the range."""
        # The first by the order of `CRITERIA`: the most direct cause.
        poor = (check for check in self.validity(state, taken).checks if check.verdict == "poor")
        causes = (check.warning for check in poor if check.criterion.name in FAILING_CRITERIA)
        return next(causes, "")


def finest_step(lowered: LoweredModel) -> float:
    """The step down to which all superelements hold [s]; inf where one has no modes."""
    modes = [element.modes for element in lowered.superelements]
    return max((np.inf if one is None else one.h_min for one in modes), default=0.0)


def check_range(lowered: LoweredModel, state: State, taken: int) -> None:
    """`OutOfRangeError` where an interface has left the range of linear elasticity by far."""
    if not (left := int(state.extremes.left[0])):
        return
    # The loop counts frames from 1 here: 0 says that none has left.
    f, extremes = left - 1, state.extremes
    passed = _beyond(lowered, f, np.sqrt(extremes.rotation[f]), np.sqrt(extremes.displacement[f]))
    raise OutOfRangeError(
        taken, taken * lowered.h, lowered.frame_names[f], passed, lowered.model.path
    )


def interface_out_of_range(lowered: LoweredModel, state: State) -> str:
    """The first interface far beyond linear elasticity, in words; "" if there is none.

    The state need not be that of a step: it may be one in which Newton's method has failed.
    """
    frames, u = lowered.system.frames, state.interfaces.u
    for f in np.flatnonzero(frames.dof >= 0).tolist():
        dof = int(frames.dof[f])
        rotation = np.linalg.norm(u[dof + 3 : dof + 6]) if frames.rotations[f] else 0.0
        if passed := _beyond(lowered, f, float(rotation), float(np.linalg.norm(u[dof : dof + 3]))):
            return passed
    return ""


def _beyond(lowered: LoweredModel, f: int, rotation: float, move: float) -> str:
    """How frame f has left the range at which runs end, in words; "" if it has not."""
    elastic, frames = lowered.system.elastic, lowered.system.frames
    size = float(elastic.size[elastic.of_body[frames.body[f]]])
    if rotation > MAX_ELASTIC_ROTATION:
        limit = f"{MAX_ELASTIC_ROTATION:.3g} rad"
        passed = f"turned by {rotation:.3g} rad by elasticity, more than {limit}"
    elif move > MAX_ELASTIC_DISPLACEMENT * size:
        passed = (
            f"moved by {move:.3g} m by elasticity, more than the size of its body, {size:.3g} m"
        )
    else:
        return ""
    return (
        f"interface {lowered.frame_names[f]!r} has {passed}, where linear elasticity has no "
        f"meaning: {MEND_DEFORMATION}"
    )
