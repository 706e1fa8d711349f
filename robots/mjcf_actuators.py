"""Actuators of MJCF as motors: a force by a control u, of which few kinds are those of a motor.

force = gain u + b_0 + b_1 l + b_2 l',     l = gear q,   torque = gear force
"""

from typing import Any

import numpy as np

from .compiled_model import CompiledModel
from .description import Actuator

# Relative difference of two gains that count as one.
SAME_GAIN = 1e-9


def actuators_of(mjcf: CompiledModel) -> tuple[Actuator, ...]:
    """The actuators that are motors; the others are left out by name."""
    found = (_actuator(mjcf, a) for a in range(mjcf.model.nu))
    return tuple(actuator for actuator in found if actuator is not None)


def _actuator(mjcf: CompiledModel, a: int) -> Actuator | None:
    m = mjcf.model
    name = str(m.actuator(a).name) or f"actuator {a + 1}"
    kind, gains = _kind(mjcf, a)
    if kind is None:
        mjcf.leave_out(f"actuator {name!r}: neither motor, position nor velocity of a joint")
        return None
    joint = int(m.actuator_trnid[a][0])
    for key in ("actuator_armature", "actuator_damping", "actuator_dampingpoly"):
        # New in MuJoCo 4.
        if np.any(getattr(m, key, np.zeros(a + 1))[a]):
            mjcf.leave_out(f"actuator {name!r}: {key.partition('_')[2]}")
    gear = float(m.actuator_gear[a][0])
    _tell_controls(mjcf, a, name, kind, gear)
    # A gear acts twice: on the length that is measured, and on the force.
    stiffness, damping = (gain * gear**2 for gain in gains)
    return Actuator(
        name,
        mjcf.joint(joint),
        kind,
        stiffness=stiffness,
        damping=damping,
        limit=_limit(m, a, joint, kind),
    )


def _kind(mjcf: CompiledModel, a: int) -> tuple[Any, tuple[float, float]]:
    """What the control is of a motor, with its stiffness and damping; None of another kind."""
    m, mujoco = mjcf.model, mjcf.mujoco
    joint = int(m.actuator_trnid[a][0])
    plain = (
        int(m.actuator_trntype[a]) == int(mujoco.mjtTrn.mjTRN_JOINT)
        and int(m.actuator_dyntype[a]) == int(mujoco.mjtDyn.mjDYN_NONE)
        and int(m.actuator_gaintype[a]) == int(mujoco.mjtGain.mjGAIN_FIXED)
        and float(m.actuator_gear[a][0]) != 0.0
        and int(m.jnt_type[joint])
        in (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    )
    gain = float(m.actuator_gainprm[a][0])
    affine = int(m.actuator_biastype[a]) == int(mujoco.mjtBias.mjBIAS_AFFINE)
    constant, by_length, by_rate = m.actuator_biasprm[a][:3].tolist() if affine else (0.0,) * 3
    if not plain or constant or by_length > 0.0 or by_rate > 0.0 or gain <= 0.0:
        return None, (0.0, 0.0)
    if by_length == 0.0 and by_rate == 0.0:
        return "torque", (0.0, 0.0)
    if np.isclose(gain, -by_length, rtol=SAME_GAIN):
        return "reference", (gain, -by_rate)
    if by_length == 0.0 and np.isclose(gain, -by_rate, rtol=SAME_GAIN):
        return "rate", (0.0, gain)
    return None, (0.0, 0.0)


def _tell_controls(mjcf: CompiledModel, a: int, name: str, kind: str, gear: float) -> None:
    """What the input of the motor is, where it is not the control, and limits of the control."""
    m = mjcf.model
    factor = gear * float(m.actuator_gainprm[a][0]) if kind == "torque" else 1.0 / gear
    what = {"torque": "force on the joint", "reference": "reference", "rate": "reference rate"}[
        kind
    ]
    if factor != 1.0:
        mjcf.leave_out(f"actuator {name!r}: its input is the {what}, {factor:g} times the control")
    if m.actuator_ctrllimited[a] and kind != "torque":
        lower, upper = (factor * m.actuator_ctrlrange[a]).tolist()
        mjcf.leave_out(f"actuator {name!r}: limits of the {what}, {lower:g} to {upper:g}")


def _limit(m: Any, a: int, joint: int, kind: str) -> tuple[float, float] | None:
    """The narrowest limits of the force on the joint, None where there are none."""
    gear, gain = float(m.actuator_gear[a][0]), float(m.actuator_gainprm[a][0])
    limits = []
    if m.actuator_forcelimited[a]:
        limits.append(gear * m.actuator_forcerange[a])
    if kind == "torque" and m.actuator_ctrllimited[a]:
        limits.append(gear * gain * m.actuator_ctrlrange[a])
    if m.jnt_actfrclimited[joint]:
        limits.append(m.jnt_actfrcrange[joint])
    if not limits:
        return None
    # A negative gear exchanges the two ends.
    lower = max(float(min(each)) for each in limits)
    upper = min(float(max(each)) for each in limits)
    return lower, upper
