"""The part of a report that shows the motion: stage, controls, and what was reduced for it."""

import json

import numpy as np

from ..field_kinds import scale_of
from ..prefixes import seconds
from .markup import Markup, rendered
from .motion import Motion
from .numbers import counted, short, vector
from .scene import cameras, color_bar, placed, square
from .still import still

# Of a body between instants [rad]: above it, the eye takes what is drawn for another motion.
MAX_SEEN_TURN = 0.6
# Below the animation: more would push the plots off the screen.
MAX_NAMED_BODIES = 40


def animation(motion: Motion) -> Markup:
    """Stage and controls, filled by the script of the page."""
    bodies = [(shape.name, shape.color) for shape in motion.shapes if shape.values is None]
    return rendered(
        "animation.html",
        bar=_bar(motion),
        middle=seconds(float(motion.time[len(motion.time) // 2])),
        still=still(motion),
        cameras={name: json.dumps(placed(camera)) for name, camera in cameras(motion).items()},
        legend=[*bodies[:MAX_NAMED_BODIES], *motion.moving.legend],
        not_named=max(len(bodies) - MAX_NAMED_BODIES, 0),
        remarks=remarks(motion),
    )


def duration(motion: Motion) -> float:
    """How long the animation takes as it is played [s]."""
    return float(np.clip(len(motion.time) / 25.0, 6.0, 20.0))


def remarks(motion: Motion) -> list[str]:
    """What was reduced, and what a reader must know of the picture."""
    drawn, whole = motion.points
    length = seconds(float(motion.time[-1] - motion.time[0]))
    lines = [
        f"At × 1 the {length} of motion take {duration(motion):.3g} s. "
        f"The squares of the grid, in the plane of x and y, are {square(motion):g} m wide."
    ]
    stage = motion.deforming
    if stage.magnification != 1.0:
        lines.append(
            f"Elastic deformations are drawn {stage.magnification:g} times as large as they are; "
            f"so bodies may seem to leave their joints."
        )
    lines.append(
        f"Shown: {counted(len(motion.time), 'instant')} of {motion.recorded} recorded"
        + (f", deformations at {len(stage.times)} of them" if _deforms(motion) else "")
        + f", straight between them; {drawn} of {whole} points of the bodies, rounded to 1/16000 "
        f"of their size."
    )
    if motion.turn > MAX_SEEN_TURN:
        lines.append(
            f"Between two instants a body turns by up to {motion.turn / (2 * np.pi):.2g} "
            f"revolutions: what is seen between them is not the motion, and wheels may seem to "
            f"turn backwards."
        )
    if motion.origin.any():
        lines.append(f"Coordinates are from {vector(motion.origin)} m.")
    lines += [f"No colors: {reason}" for reason in [*stage.untold.values()][:5]]
    lines += [f"Elastic motion: {remark}." for remark in stage.remarks[:5]]
    if stage.field:
        lines.append("Colors end at the largest value of what is shown; peaks of all steps: below.")
    return lines


def _deforms(motion: Motion) -> bool:
    return any(shape.u is not None for shape in motion.shapes)


def _bar(motion: Motion) -> dict[str, object] | None:
    """The scale of colors, with its unit."""
    field, largest = motion.deforming.field, motion.largest
    if not field or largest <= 0.0:
        return None
    scale = scale_of(field, largest)
    return {
        "label": f"{scale.words} [{scale.unit}]",
        "colors": color_bar(),
        "ticks": [short(largest * part / scale.factor, 3) for part in (1.0, 0.75, 0.5, 0.25, 0.0)],
    }
