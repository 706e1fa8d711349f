"""Checks of a model that need the poses and the rows of its joints."""

from collections.abc import Mapping, Sequence

import numpy as np

from ..couplings.contacts import Contact
from ..couplings.joints import Joint
from ..couplings.motions import PrescribedMotion
from ..errors import ModelError
from ..model.model import GROUND, Coupling, Model
from ..step.rows import measures_length
from .numbering import NumberedFrames, side_names
from .rows import Row, joint_drives

ASSEMBLY_TOLERANCE = 1e-3
"""largest opening of a joint, relative to the size of the model, that is closed unasked"""
LARGEST_MASS_RATIO = 1e15
"""of two bodies on a joint; at 1e16 the forces were still right, at 1e17 equations were singular"""


def check_assembled(model: Model, size: float, frames: NumberedFrames) -> None:
    """`ModelError` for a joint whose frames do not meet at the start.

    Directions in which the joint slides do not count. size: of the model [m].
    """
    for joint in model.joints:
        sides = frames.sides(joint)
        gap = sides.gap(joint.basis(sides.pose_a.R))
        opening = [gap[k] for k in joint.kind.translations]
        start = ""
        drive = joint_drives(joint, sides).get("distance")
        if drive is not None and "distance" not in joint.drawn:
            distance = drive(0.0)
            drawn = np.linalg.norm(gap) if joint.kind.own == "rod" else gap[2]
            opening.append(float(drawn) - distance)
            start = f", the distance starts at {distance:.6g}"
        worst = max(map(abs, opening), default=0.0)
        if worst > ASSEMBLY_TOLERANCE * size:
            first, second = joint.between
            r_a, r_b = sides.pose_a.x.tolist(), sides.pose_b.x.tolist()
            raise joint.error(
                f"open by {worst:.6g} m at the start: {first} is at {r_a}, "
                f"{second} at {r_b}{start}; assemble = true would close it"
            )


def check_masses(model: Model) -> None:
    """ModelError for joined bodies so unlike in mass that the force between them has no digits."""
    for joint in model.joints:
        names = [side.partition(".")[0] for side in joint.between]
        if GROUND in names:
            continue
        light, heavy = sorted(names, key=lambda name: model.bodies[name].mass)
        least, most = model.bodies[light].mass, model.bodies[heavy].mass
        if most > LARGEST_MASS_RATIO * least:
            raise joint.error(
                f"expected masses in a ratio of at most {LARGEST_MASS_RATIO:g}, beyond which the "
                f"lighter one is lost in rounding, got {least:g} kg ({light}) and {most:g} kg "
                f"({heavy})"
            )


def check_moments(model: Model, frames: NumberedFrames, rows: Mapping[str, Sequence[Row]]) -> None:
    """`ModelError` for a moment on an interface without rotations, which carries forces alone.

    rows: of each coupling, by name.
    """
    causes: dict[str, str] = {}
    for coupling in model.couplings:
        if isinstance(coupling, Contact):
            first, second = side_names(coupling)
            causes[first] = f"{coupling.owner}, whose shape it carries"
            if coupling.friction is not None and coupling.ball > 0.0:
                causes[second] = f"{coupling.owner}, with friction on a ball"
        elif not all(measures_length(row.kind) for row in rows[coupling.name]):
            causes |= dict.fromkeys(side_names(coupling), _described(coupling))
        elif isinstance(coupling, Joint) and coupling.kind.sided:
            causes[side_names(coupling)[0]] = f"{_described(coupling)}, whose axis it carries"
    causes |= {load.on: f"torque on {load.on!r}" for load in model.frame_loads if load.kind.moment}
    for frame, cause in causes.items():
        f = frames.number(frame)
        if frames.arrays.dof[f] >= 0 and not frames.arrays.rotations[f]:
            raise ModelError(
                f"{cause}: interface {frame!r} has no rotations and carries forces alone"
            )


def _described(coupling: Coupling) -> str:
    """A coupling as messages name it, with its type if it has one."""
    if isinstance(coupling, PrescribedMotion | Contact):
        return coupling.owner
    return f"{coupling.owner} ({coupling.type})"
