"""From frozen objects to flat arrays, once per simulation."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...superelement import GeneralizedAlpha, Superelement
from ..arrays import Array, as_index, as_rows
from ..errors import ModelError
from ..history.layout import lay_out_elastic
from ..model.model import Model
from ..model.signals import Signal, SmoothSignal
from ..step.rows import measures_length
from ..step.system import Bodies, Loads, Newton, Scheme, System
from .elimination_order import lay_out_pattern
from .numbering import Coupling, NumberedFrames, number_frames, side_names
from .placement import Pose, place_bodies
from .rows import (
    Row,
    coupling_rows,
    joint_observers,
    lay_out_couplings,
    lay_out_rows,
)
from .size import model_size

ASSEMBLY_TOLERANCE = 1e-3
"""largest opening of a joint, relative to the size of the model, that is closed without being asked
to
"""
REUSE = 1e-2
"""ratio of successive corrections above which the iteration matrix is made anew: the cheapest in
trials
"""


@dataclass(frozen=True, eq=False)
class LoweredModel:
    """A system with the names and signals that belong to its arrays, and where it starts."""

    model: Model
    system: System
    scheme: GeneralizedAlpha
    n_steps: int
    poses: list[Pose]
    body_names: list[str]
    frame_names: list[str]
    frame_poses: list[Pose]
    coupling_names: list[str]
    observers: list[tuple[str, str]]
    """joint and coordinate of each observer row"""
    observer_starts: Array
    drives: list[SmoothSignal]
    load_signals: list[Signal]
    superelements: list[Superelement]
    compliances: list[Array]
    """static compliance of every flexible body (n_c, n_c)"""
    truncation: float
    """largest error of kernels that are cut off, relative to static displacements"""

    @property
    def all_modal(self) -> bool:
        """Whether there are flexible bodies, and modes carry the history of all of them."""
        modes = np.diff(self.system.elastic.modes.range)
        return len(modes) > 0 and bool(modes.all())

    @property
    def h(self) -> float:
        return float(self.system.scheme.h)

    @property
    def measures_lengths(self) -> NDArray[np.bool_]:
        """Of every row whether its coordinate is a length, not an angle (n_rows,)."""
        return np.array(
            [measures_length(kind) for kind in self.system.couplings.rows.kind.tolist()], dtype=bool
        )

    def coupling_of(self, row: int) -> int:
        """The number of the coupling that a row belongs to."""
        return int(np.searchsorted(self.system.couplings.range, row, side="right")) - 1

    def owner_of(self, row: int) -> str:
        """The same as messages name it: "joint 'hinge'"."""
        return self.model.couplings[self.coupling_of(row)].owner


def lower(model: Model, without: frozenset[int] = frozenset()) -> LoweredModel:
    """Number bodies, frames, rows and dofs, and lay them out for the time loop; rows `without` are
    left out.
    """
    h, scheme = _step_and_scheme(model)
    n_steps = int(np.ceil(model.settings.t_end / h - 1e-6))
    poses = place_bodies(model)
    body_names = list(model.bodies)
    frames = number_frames(model, poses)
    rows = {
        coupling.name: coupling_rows(coupling, frames.sides(coupling))
        for coupling in model.couplings
    }
    numbers = iter(range(sum(map(len, rows.values()))))
    rows = {
        name: [row for row in own if next(numbers) not in without] for name, own in rows.items()
    }
    couplings, drives = lay_out_couplings(list(rows.values()))
    observers = {
        (joint.name, coordinate): row
        for joint in model.joints
        for coordinate, row in joint_observers(joint, frames.sides(joint)).items()
    }
    size = model_size(model, poses, frames)
    if not model.settings.assemble:
        _check_assembled(model, size, frames)
    _check_moments(model, frames, rows)
    weight = 1.0 if model.settings.rule == "consistent" else 0.5
    elastic, compliances, truncation = lay_out_elastic(
        model, frames.arrays, h, scheme, n_steps, weight
    )
    pattern = lay_out_pattern(len(body_names), frames.arrays, couplings, elastic)
    system = System(
        scheme=Scheme(
            h=h,
            alpha_m=scheme.alpha_m,
            alpha_f=scheme.alpha_f,
            beta=scheme.beta,
            gamma=scheme.gamma,
            beta_prime=scheme.beta_prime(h),
            gamma_prime=scheme.gamma_prime(h),
            inertia_ratio=scheme.inertia_ratio,
            weight=weight,
        ),
        newton=Newton(
            tolerance=model.settings.tolerance,
            max_iterations=model.settings.max_iterations,
            fixed_iterations=model.settings.fixed_iterations or 0,
            reuse=np.inf if model.settings.fixed_iterations else REUSE,
        ),
        bodies=Bodies(
            mass=np.array([body.mass for body in model.bodies.values()], dtype=float),
            J_rot=np.array([body.inertia for body in model.bodies.values()], dtype=float),
            gravity=model.gravity.copy(),
            size=size,
        ),
        frames=frames.arrays,
        couplings=couplings,
        observers=lay_out_rows(list(observers.values())),
        loads=Loads(
            frame=as_index([frames.number(load.on) for load in model.loads]),
            kind=as_index([load.kind.number for load in model.loads]),
            moment=as_index([load.kind.moment for load in model.loads]),
            follower=as_index([load.follower for load in model.loads]),
            direction=as_rows([load.direction for load in model.loads]),
        ),
        elastic=elastic,
        pattern=pattern,
    )
    return LoweredModel(
        model=model,
        system=system,
        scheme=scheme,
        n_steps=n_steps,
        poses=[poses[name] for name in body_names],
        body_names=body_names,
        frame_names=list(frames.poses),
        frame_poses=list(frames.poses.values()),
        coupling_names=list(rows),
        observers=list(observers),
        observer_starts=np.array([row.start for row in observers.values()]),
        drives=drives,
        load_signals=[load.signal for load in model.loads],
        superelements=[body.superelement for body in model.flexible_bodies.values()],
        compliances=compliances,
        truncation=truncation,
    )


def _step_and_scheme(model: Model) -> tuple[float, GeneralizedAlpha]:
    kernels = {name: body.superelement.kernel for name, body in model.flexible_bodies.items()}
    steps = {name: kernel.h for name, kernel in kernels.items()}
    radii = {name: kernel.scheme.rho_inf for name, kernel in kernels.items()}
    return (
        _given_or_common("step", model.settings.step, steps),
        GeneralizedAlpha(_given_or_common("rho_inf", model.settings.rho_inf, radii, default=0.9)),
    )


def _given_or_common(
    key: str, given: float | None, found: dict[str, float], default: float | None = None
) -> float:
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
    raise ModelError(
        f"simulation: {key}: the superelements differ ({listed}), so the model must give one"
    )


def _check_assembled(model: Model, size: float, frames: NumberedFrames) -> None:
    """The frames of a joint must meet at the start, but for the directions in which it slides."""
    for joint in model.joints:
        sides = frames.sides(joint)
        gap = sides.gap(joint.basis())
        opening = [gap[k] for k in joint.kind.translations]
        if joint.distance is not None:
            opening.append(gap[2] - joint.distance(0.0))
        A, B = sides.pose_a.x, sides.pose_b.x
        worst = max(map(abs, opening), default=0.0)
        if worst > ASSEMBLY_TOLERANCE * size:
            start = (
                ""
                if joint.distance is None
                else f", the distance starts at {joint.distance(0.0):.6g}"
            )
            raise ModelError(
                f"joint {joint.name!r}: open by {worst:.6g} m at the start: {joint.between[0]} is at {A.tolist()}, "
                f"{joint.between[1]} at {B.tolist()}{start}; assemble = true would close it"
            )


def _check_moments(model: Model, frames: NumberedFrames, rows: dict[str, list[Row]]) -> None:
    """An interface without rotations carries forces alone."""
    loaded: dict[str, str] = {}
    owners: dict[str, Coupling] = {
        **{f"joint {joint.name!r} ({joint.type})": joint for joint in model.joints},
        **{f"motion {motion.name!r}": motion for motion in model.motions},
        **{f"spring {spring.name!r} ({spring.type})": spring for spring in model.springs},
    }
    for owner, coupling in owners.items():
        if not all(measures_length(row.kind) for row in rows[coupling.name]):
            loaded |= dict.fromkeys(side_names(coupling), owner)
    loaded |= {load.on: f"torque on {load.on!r}" for load in model.loads if load.kind.moment}
    for frame, owner in loaded.items():
        f = frames.number(frame)
        if frames.arrays.dof[f] >= 0 and not frames.arrays.rotations[f]:
            raise ModelError(
                f"{owner}: interface {frame!r} has no rotations and carries forces alone"
            )
