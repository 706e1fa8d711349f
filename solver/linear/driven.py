"""Drives that turn a mechanism, at the speed of a steady rotation that is asked for.

A shaft whose angle, or the reference of whose motor, moves with time in the model turns at the
speed of the analysis instead: Campbell diagrams need no model for each speed. A drive that stands
still keeps its angle, and its joint refuses the rotation.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..couplings.joints import Joint
from ..couplings.motions import PrescribedMotion, PrescribedRotation
from ..couplings.motors import Motor
from ..model.model import Model
from ..model.settings import SteadyRotation
from ..signals.curves import Constant, Polynomial
from ..signals.signal import SmoothSignal

SAMPLES = 65
"""times at which a drive is compared with its start"""


def driven_at(model: Model, rotation: SteadyRotation) -> dict[str, Any]:
    """Joints, motions and motors of a model whose drives turn at the speed of a rotation."""
    times = np.linspace(0.0, model.settings.t_end, SAMPLES).tolist()[1:]
    velocity = np.asarray(rotation.angular_velocity)

    def moves(signal: Callable[[float], float]) -> bool:
        start = signal(0.0)
        return any(signal(t) != start for t in times)

    rates = {joint.name: _rate(joint, velocity) for joint in model.joints}
    return {
        "joints": tuple(_driven(joint, rates[joint.name], moves) for joint in model.joints),
        "motions": tuple(_turned(motion, velocity, moves) for motion in model.motions),
        "motors": tuple(_followed(motor, rates, moves) for motor in model.motors),
    }


Moves = Callable[[Callable[[float], float]], bool]


def _rate(joint: Joint, velocity: Array) -> float | None:
    """The rate of the angle of a joint between the ground and a body that turns about its axis."""
    grounded = [frame.partition(".")[0] == "ground" for frame in joint.between]
    axis = joint.axis
    if axis is None or joint.kind.axes != 1 or sum(grounded) != 1:
        return None
    along = float(axis @ velocity) / float(np.linalg.norm(axis))
    return along if grounded[0] else -along


def _driven(joint: Joint, rate: float | None, moves: Moves) -> Joint:
    drive = joint.drives.get("angle")
    if rate is None or drive is None or not moves(drive):
        return joint
    return replace(joint, **_keys(joint.angle, rate))


def _turned(motion: PrescribedMotion, velocity: Array, moves: Moves) -> PrescribedMotion:
    if not isinstance(motion, PrescribedRotation) or not moves(motion.drive):
        return motion
    along = float(np.asarray(motion.axis) @ velocity) / float(np.linalg.norm(motion.axis))
    return replace(motion, start={}, **_keys(motion.angle, along))


def _keys(angle: SmoothSignal | None, rate: float) -> Mapping[str, Any]:
    """The drive at a rate, from where it starts."""
    steady = {"angle": None, "angular_velocity": None, "angular_acceleration": None}
    if angle is None:
        return {**steady, "angular_velocity": Constant(rate)}
    return {**steady, "angle": Polynomial((angle(0.0), rate))}


def _followed(motor: Motor, rates: Mapping[str, float | None], moves: Moves) -> Motor:
    """A servo whose reference turns, at a rate."""
    rate = rates.get(motor.joint) if motor.coordinate == "angle" else None
    reference, given = motor.reference, motor.reference_rate
    if rate is None:
        return motor
    changes: dict[str, Any] = {}
    if reference is not None and moves(reference):
        changes["reference"] = Polynomial((reference(0.0), rate))
    if given is not None and (changes or reference is None):
        changes["reference_rate"] = Constant(rate)
    return replace(motor, **changes) if changes else motor
