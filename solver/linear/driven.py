"""Drives that turn a mechanism, at the speed of a steady rotation that is asked for.

A shaft whose angle, or the reference of whose motor, moves with time in the model turns at the
speed of the analysis instead: Campbell diagrams need no model for each speed. A drive that stands
still keeps its angle, and its joint refuses the rotation.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..couplings.joint import Joint
from ..couplings.motors import Motor
from ..model.model import Model
from ..model.settings import SteadyRotation
from ..model.speed_ratios import speed_ratios
from ..signals.curves import Constant, Polynomial
from ..signals.drives import angle_at_rate

START_SAMPLES = 65


def driven_at(model: Model, rotation: SteadyRotation) -> dict[str, Any]:
    """Joints, motions and motors of a model whose drives turn at the speed of a rotation."""
    times = np.linspace(0.0, model.settings.t_end, START_SAMPLES).tolist()[1:]
    velocity = np.asarray(rotation.angular_velocity)

    def moves(signal: Callable[[float], float]) -> bool:
        start = signal(0.0)
        # Exactly: a constant that is computed is the same at all times.
        return any(signal(t) != start for t in times)

    ratios = speed_ratios(model, rotation)
    rates = {joint.name: joint.angular_rate(velocity, ratios) for joint in model.joints}
    return {
        "joints": tuple(_driven(joint, rates[joint.name], moves) for joint in model.joints),
        "motions": tuple(
            motion.turned_at(ratios[motion.on.partition(".")[0]] * velocity, moves)
            for motion in model.motions
        ),
        "motors": tuple(_followed(motor, rates, moves) for motor in model.motors),
    }


Moves = Callable[[Callable[[float], float]], bool]


def _driven(joint: Joint, rate: float | None, moves: Moves) -> Joint:
    drive = joint.drives.get("angle")
    if rate is None or drive is None or not moves(drive):
        return joint
    drives_angle: Any = joint
    return replace(joint, **angle_at_rate(drives_angle.angle, rate))


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
