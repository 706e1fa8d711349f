"""From frozen objects to flat arrays, once per simulation."""

from dataclasses import dataclass

import numpy as np

from ..superelement import GeneralizedAlpha, Superelement
from .compiled import Array, as_index, as_rows
from .errors import ModelError
from .flexibility import lay_out_elastic
from .joint_rows import lay_out_joints
from .joints import Joint
from .model import GROUND, FlexibleBody, Model
from .placement import Pose, frame_pose, place_bodies
from .rotations import quaternion_of
from .signals import Motion, Signal
from .system import Bodies, Frames, Joints, Loads, Scheme, System


@dataclass(frozen=True, eq=False)
class CompiledModel:
    """A system with the names and signals that belong to its arrays, and where it starts."""

    model: Model
    system: System
    scheme: GeneralizedAlpha
    n_steps: int
    poses: list[Pose]
    body_names: list[str]
    frame_names: list[str]
    frame_poses: list[Pose]
    drives: list[Motion]
    load_signals: list[Signal]
    superelements: list[Superelement]

    @property
    def h(self) -> float:
        return float(self.system.scheme.h)

    @property
    def frame_quaternions(self) -> Array:
        """D_0 of every frame (n_f, 4)."""
        return np.array([quaternion_of(D) for D in self.system.frames.D_0]).reshape(-1, 4)


def compile_system(model: Model) -> CompiledModel:
    """Number bodies, frames, rows and dofs, and lay them out for the time loop."""
    h, scheme = _step_and_scheme(model)
    n_steps = int(np.ceil(model.t_end / h - 1e-6))
    poses = place_bodies(model)
    body_names = list(model.bodies)
    frame_names, frame_poses = _frames_of(model, poses)
    frames = _frames(model, body_names, frame_names, frame_poses)
    joints, drives = lay_out_joints(model.joints, [_sides(joint) for joint in model.joints], frame_names, frame_poses)
    _check_moments(model, frames, frame_names, joints)
    system = System(
        scheme=Scheme(
            h=h,
            alpha_m=scheme.alpha_m,
            alpha_f=scheme.alpha_f,
            beta=scheme.beta,
            gamma=scheme.gamma,
            beta_prime=scheme.beta_prime(h),
            gamma_prime=scheme.gamma_prime(h),
            weight=1.0 if model.rule == "consistent" else 0.5,
            tolerance=model.tolerance,
            max_iterations=model.max_iterations,
        ),
        bodies=Bodies(
            mass=np.array([body.mass for body in model.bodies.values()], dtype=float),
            J_rot=np.array([body.inertia for body in model.bodies.values()], dtype=float),
            gravity=model.gravity.copy(),
        ),
        frames=frames,
        joints=joints,
        loads=Loads(
            frame=as_index([frame_names.index(load.on) for load in model.loads]),
            torque=as_index([load.type == "torque" for load in model.loads]),
            follower=as_index([load.follower for load in model.loads]),
            direction=as_rows([load.direction for load in model.loads]),
        ),
        elastic=lay_out_elastic(model, frames, h, scheme, n_steps),
    )
    return CompiledModel(
        model=model,
        system=system,
        scheme=scheme,
        n_steps=n_steps,
        poses=[poses[name] for name in body_names],
        body_names=body_names,
        frame_names=frame_names,
        frame_poses=frame_poses,
        drives=drives,
        load_signals=[load.signal for load in model.loads],
        superelements=[body.superelement for body in model.flexible_bodies.values()],
    )


def _step_and_scheme(model: Model) -> tuple[float, GeneralizedAlpha]:
    kernels = {name: body.superelement.kernel for name, body in model.flexible_bodies.items()}
    steps = {name: kernel.h for name, kernel in kernels.items()}
    radii = {name: kernel.scheme.rho_inf for name, kernel in kernels.items()}
    return (
        _given_or_common("step", model.step, steps),
        GeneralizedAlpha(_given_or_common("rho_inf", model.rho_inf, radii, default=0.9)),
    )


def _given_or_common(key: str, given: float | None, found: dict[str, float], default: float | None = None) -> float:
    if given is not None:
        return given
    values = sorted(set(found.values()))
    if len(values) == 1:
        return values[0]
    if not values and default is not None:
        return default
    if not values:
        raise ModelError(f"simulation: {key}: a model without superelements needs one")
    listed = ", ".join(f"{name}: {value}" for name, value in found.items())
    raise ModelError(f"simulation: {key}: the superelements differ ({listed}), so the model must give one")


def _ground_name(joint: Joint) -> str:
    """The frame fixed in space where the other side of a joint to the bare ground starts."""
    return f"{GROUND}.({joint.name})"


def _sides(joint: Joint) -> tuple[str, str]:
    first, second = (_ground_name(joint) if side == GROUND else side for side in joint.between)
    return first, second


def _frames_of(model: Model, poses: dict[str, Pose]) -> tuple[list[str], list[Pose]]:
    """All frames by name with their starting poses, those with joints and loads first."""
    named: dict[str, Pose] = {}
    for joint in model.joints:
        for name, side, other in zip(_sides(joint), joint.between, reversed(joint.between), strict=True):
            named[name] = frame_pose(model, poses, other if side == GROUND else side)
    for load in model.loads:
        named[load.on] = frame_pose(model, poses, load.on)
    for body in model.bodies:
        for frame in model.frames_of(body):
            named.setdefault(f"{body}.{frame}", frame_pose(model, poses, f"{body}.{frame}"))
    return list(named), list(named.values())


def _frames(model: Model, body_names: list[str], frame_names: list[str], frame_poses: list[Pose]) -> Frames:
    acting = {side for joint in model.joints for side in _sides(joint)} | {load.on for load in model.loads}
    first_dof = _first_dofs(model)
    n = len(frame_names)
    frames = Frames(
        n_acting=len(acting),
        body=np.full(n, -1, dtype=np.int64),
        X=np.zeros((n, 3)),
        D_0=np.tile(np.eye(3), (n, 1, 1)),
        dof=np.full(n, -1, dtype=np.int64),
        active=np.full(n, -1, dtype=np.int64),
        rotations=np.zeros(n, dtype=np.int64),
    )
    n_active = 0
    # Active dofs are numbered body by body, so that the bodies' ranges are contiguous.
    by_dof = sorted(range(n), key=lambda f: first_dof.get(frame_names[f], -1))
    for f in by_dof:
        owner, _, name = frame_names[f].partition(".")
        if owner == GROUND:
            continue
        frames.body[f] = body_names.index(owner)
        body = model.bodies[owner]
        if name:
            frames.X[f] = body.frames[name].position
            frames.D_0[f] = Pose(np.zeros(3), np.eye(3)).carry(body.frames[name]).R
        if isinstance(body, FlexibleBody):
            interface = body.superelement.interface(name)
            frames.dof[f] = first_dof[frame_names[f]]
            frames.rotations[f] = interface.rotations
            if f < frames.n_acting:
                frames.active[f] = n_active
                n_active += interface.n_dofs
    return frames


def _first_dofs(model: Model) -> dict[str, int]:
    first: dict[str, int] = {}
    n = 0
    for name, body in model.flexible_bodies.items():
        for interface in body.superelement.interfaces:
            first[f"{name}.{interface.name}"] = n
            n += interface.n_dofs
    return first


def _check_moments(model: Model, frames: Frames, frame_names: list[str], joints: Joints) -> None:
    """An interface without rotations carries forces alone."""
    rows = np.diff(joints.row)
    turning = np.add.reduceat(joints.rotation, joints.row[:-1]) if len(rows) else rows
    loaded: dict[str, str] = {}
    for joint, moments in zip(model.joints, turning, strict=True):
        if moments:
            loaded |= dict.fromkeys(_sides(joint), f"joint {joint.name!r} ({joint.type})")
    loaded |= {load.on: f"torque on {load.on!r}" for load in model.loads if load.type == "torque"}
    for frame, owner in loaded.items():
        f = frame_names.index(frame)
        if frames.dof[f] >= 0 and not frames.rotations[f]:
            raise ModelError(f"{owner}: interface {frame!r} has no rotations and carries forces alone")
