"""Checks of a model that need the poses and the rows of its joints."""

from collections.abc import Mapping, Sequence

from ..couplings.coupling import GROUND
from ..couplings.rows import Row
from ..errors import ModelError
from ..model.model import Model
from .numbering import NumberedFrames

ASSEMBLY_TOLERANCE = 1e-3
"""largest opening of a joint, relative to the size of the model, that is closed unasked"""
LARGEST_MASS_RATIO = 1e15
"""of two bodies on a joint; at 1e16 the forces were still right, at 1e17 equations were singular"""


def check_assembled(model: Model, size: float, frames: NumberedFrames) -> None:
    """`ModelError` for a joint whose frames do not meet at the start. size: of the model [m]."""
    for coupling in model.couplings:
        coupling.check_opening(frames.sides(coupling), ASSEMBLY_TOLERANCE * size)


def check_masses(model: Model) -> None:
    """ModelError for joined bodies so unlike in mass that the force between them has no digits."""
    for joint in model.joints:
        names = [side.partition(".")[0] for side in joint.between]
        if GROUND in names:
            continue
        # Of a pivot m_light + m_heavy, the light mass is what rounding loses.
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
        causes |= coupling.loaded_by_moments(rows[coupling.name])
    # Loads last: where both ask for moments, the torque is named.
    causes |= {load.on: f"torque on {load.on!r}" for load in model.frame_loads if load.kind.moment}
    for frame, cause in causes.items():
        f = frames.number(frame)
        if frames.arrays.dof[f] >= 0 and not frames.arrays.rotations[f]:
            raise ModelError(
                f"{cause}: interface {frame!r} has no rotations and carries forces alone"
            )
