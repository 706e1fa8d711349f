"""Loads on frames, an open set of kinds: forces and torques, drag.

A kind is a class with `@load_kind`. It gives the force or torque from the signal, parameters of its
own and the motion of the frame, and its derivatives; work, wrench and Newton's matrix follow. The
classes by which users give loads are those of solver/model/loads.py.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

from ..arrays import Array
from ..compiler.dispatch import dispatcher
from ..compiler.marks import compiled
from ..compiler.memory import copy
from .frames import add_pair_tangent, add_wrench_scale, pull_back
from .records.loads import Loads
from .rotations import relative_rotation
from .system import State, System, Workspace
from .vectors import UNIT_AXES, ZERO_VECTOR, Vector, add_to_row, cross, dot, rotate, scale, triple

LOAD_KINDS: list[Any] = []
"""kinds of loads, in the order of their numbers"""
AnyKind = TypeVar("AnyKind", bound=type)


def load_kind(*, moment: bool, by_velocity: bool = False) -> Callable[[AnyKind], AnyKind]:
    """Register a kind of load, which acts as a moment or as a force.

    The class has two compiled functions. `evaluate` returns the force or moment of load m, in
    space. `add_tangent` adds its derivative by (delta r, delta theta) of the frame, and where it
    depends on them by its velocity and angular velocity, all in space, to H (3, 12), which is zero
    before; it returns False where there is none. Parameter k of load m is
    loads.parameters[loads.first[m] + k].
    """

    def register(kind: Any) -> Any:
        kind.number, kind.moment, kind.by_velocity = len(LOAD_KINDS), moment, by_velocity
        compiled(kind.evaluate)
        compiled(kind.add_tangent)
        LOAD_KINDS.append(kind)
        return kind

    return register


@compiled
def _directed(loads: Loads, m: int, work: Workspace) -> Vector:
    """s direction, or s D direction of a follower; parameters: direction, follower."""
    direction = scale(work.loads.value[m], triple(loads.parameters, loads.first[m]))
    return rotate(work.frames.D, loads.frame[m], direction) if _follows(loads, m) else direction


@compiled
def _follows(loads: Loads, m: int) -> bool:
    return loads.parameters[loads.first[m] + 3] != 0.0  # type: ignore[no-any-return]


@compiled
def _add_directed_tangent(loads: Loads, m: int, work: Workspace, H: Array) -> bool:
    """df = dtheta x f of a follower."""
    if not _follows(loads, m):
        return False
    vector = _directed(loads, m, work)
    for j in range(3):
        turned = cross(UNIT_AXES[j], vector)
        for i in range(3):
            H[i, 3 + j] += turned[i]
    return True


@load_kind(moment=False)
class Force:
    """A force at the origin of the frame."""

    evaluate = staticmethod(_directed)
    add_tangent = staticmethod(_add_directed_tangent)


@load_kind(moment=True)
class Torque:
    """A torque on the frame."""

    evaluate = staticmethod(_directed)
    add_tangent = staticmethod(_add_directed_tangent)


@load_kind(moment=False, by_velocity=True)
class Drag:
    """f = -s (linear + quadratic |v|) v; parameters: quadratic, linear."""

    @staticmethod
    def evaluate(loads: Loads, m: int, work: Workspace) -> Vector:
        v, first = triple(work.frames.V[loads.frame[m]], 0), loads.first[m]
        speed = math.sqrt(dot(v, v))
        factor = loads.parameters[first + 1] + loads.parameters[first] * speed
        return scale(-work.loads.value[m] * factor, v)

    @staticmethod
    def add_tangent(loads: Loads, m: int, work: Workspace, H: Array) -> bool:
        """df/dv = -s ((linear + quadratic |v|) I + quadratic v v^T / |v|)"""
        v, first = triple(work.frames.V[loads.frame[m]], 0), loads.first[m]
        s, quadratic = work.loads.value[m], loads.parameters[first]
        speed = math.sqrt(dot(v, v))
        for i in range(3):
            H[i, 6 + i] -= s * (loads.parameters[first + 1] + quadratic * speed)
            # At rest the direction of v is unknown, and its part of the derivative vanishes.
            if speed > 0.0:
                for j in range(3):
                    H[i, 6 + j] -= s * quadratic * v[i] * v[j] / speed
        return True


_evaluate = dispatcher(
    "evaluate_load",
    "loads, m, work",
    [kind.evaluate for kind in LOAD_KINDS],
    otherwise="0.0, 0.0, 0.0",
)
_add_tangent = dispatcher(
    "add_load_tangent",
    "loads, m, work, H",
    [kind.add_tangent for kind in LOAD_KINDS],
    otherwise="False",
)


@compiled
def load_vector(loads: Loads, m: int, work: Workspace) -> Vector:
    """The force or torque of load m, in space."""
    return _evaluate(loads.kind[m], loads, m, work)  # type: ignore[no-any-return]


@compiled
def add_load_wrenches(loads: Loads, work: Workspace) -> None:
    """The loads act on their frames."""
    for m in range(len(loads.frame)):
        vector = load_vector(loads, m, work)
        add_to_row(work.frames.wrench, loads.frame[m], 3 * loads.moment[m], vector)


@compiled
def add_load_scales(system: System, state: State, work: Workspace) -> None:
    """The loads, each by itself, join the force scales of the bodies."""
    loads = system.loads
    for m in range(len(loads.frame)):
        vector = load_vector(loads, m, work)
        wrench = (ZERO_VECTOR, vector) if loads.moment[m] else (vector, ZERO_VECTOR)
        add_wrench_scale(system.frames, loads.frame[m], wrench, state, work)


@compiled
def linearize_loads(system: System, state: State, work: Workspace) -> None:
    """K += the tangents of loads that depend on the motion of their frame."""
    loads, frames, pattern = system.loads, system.frames, system.pattern
    H, forces, tangent = work.loads.tangent, work.loads.forces_by_motion, work.loads.frame_tangent
    for m in range(len(loads.frame)):
        f = loads.frame[m]
        # The ground does not move: its loads have no tangent.
        if frames.body[f] < 0:
            continue
        H[:] = 0.0
        if not _add_tangent(loads.kind[m], loads, m, work, H):
            continue
        # The map of velocities is computed for loads that need it only.
        n = 12 if loads.by_velocity[m] else 6
        for j in range(n):
            vector = (H[0, j], H[1, j], H[2, j])
            wrench = (ZERO_VECTOR, vector) if loads.moment[m] else (vector, ZERO_VECTOR)
            pull_back(frames, f, wrench, state, work, forces[j])
        for z in range(12):
            by_r = (forces[0, z], forces[1, z], forces[2, z])
            by_theta = (forces[3, z], forces[4, z], forces[5, z])
            pull_back(frames, f, (by_r, by_theta), state, work, tangent[z])
            for j in range(6, n):
                for k in range(12):
                    tangent[z, k] += forces[j, z] * work.frames.rate_map[f, j - 6, k]
        block = pattern.body_block[frames.body[f]]
        add_pair_tangent(frames, (f, f), tangent, (0, 0), block, work)


@compiled
def add_load_work(loads: Loads, state: State, work: Workspace) -> None:
    """Trapezoidal means of loads times displacements or rotations of their frames in the step."""
    old, motion = state.loads, work.loads.motion
    for m in range(len(loads.frame)):
        f = loads.frame[m]
        vector = load_vector(loads, m, work)
        if loads.moment[m]:
            relative_rotation(old.axes[m], work.frames.D[f], motion)
        else:
            for i in range(3):
                motion[i] = work.frames.r[f, i] - old.position[m, i]
        copy(work.frames.r[f], old.position[m])
        copy(work.frames.D[f], old.axes[m])
        old.value[m] = work.loads.value[m]
        for i in range(3):
            state.energies.work[0] += 0.5 * (vector[i] + old.vector[m, i]) * motion[i]
            old.vector[m, i] = vector[i]
