"""The part of a report that shows the motion: stage, controls, and what was reduced for it."""

import json

import numpy as np

from ..field_kinds import scale_of
from .markup import Markup, element, joined, note
from .motion import Motion
from .numbers import counted, seconds, short, vector
from .scene import cameras, color_bar, placed, square
from .still import still

SPEEDS = (("× 1/20", 0.05), ("× 1/5", 0.2), ("× 1/2", 0.5), ("× 1", 1.0), ("× 2", 2.0))
FASTEST_TURN = 0.6
"""between instants, above which the motion between them is not what is seen [rad]"""
MOST_NAMED = 40
"""bodies beside the animation"""


HOW = (
    "Turn with the left button, shift with the right one, zoom with the wheel. The dashed line in "
    "the plots is at the time of the animation, and a click on a curve goes to its time."
)


def animation(motion: Motion) -> Markup:
    """Stage and controls, filled by the script of the page."""
    return joined(
        [
            element(
                "div",
                element("div", id="canvas"),
                element("div", id="names-of-marks"),
                _bar(motion),
                _still(motion),
                id="stage",
            ),
            _controls(motion),
            _legend(motion),
            element("p", HOW, class_="note moving"),
            note(" ".join(remarks(motion))),
        ]
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
    if motion.turn > FASTEST_TURN:
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


def _bar(motion: Motion) -> Markup | str:
    """The scale of colors, with its unit."""
    field, largest = motion.deforming.field, motion.largest
    if not field or largest <= 0.0:
        return ""
    scale = scale_of(field, largest)
    parts = (1.0, 0.75, 0.5, 0.25, 0.0)
    ticks = [element("span", short(largest * part / scale.factor, 3)) for part in parts]
    gradient = f"background:linear-gradient({','.join(color_bar())})"
    return element(
        "div",
        element("div", f"{scale.words} [{scale.unit}]", class_="of"),
        element("div", class_="scale", style=gradient),
        element("div", *ticks, class_="ticks"),
        id="bar",
    )


def _still(motion: Motion) -> Markup:
    middle = seconds(float(motion.time[len(motion.time) // 2]))
    return Markup(f'<img id="still" alt="The bodies at {middle}" src="{still(motion)}">')


def _controls(motion: Motion) -> Markup:
    speeds = [
        Markup(f'<option value="{value}"{" selected" if value == 1.0 else ""}>{text}</option>')
        for text, value in SPEEDS
    ]
    views = [
        element("button", name, type="button", data_camera=json.dumps(placed(camera)))
        for name, camera in cameras(motion).items()
    ]
    return element(
        "div",
        element("button", "▶ Play", type="button", id="play"),
        Markup('<input type="range" id="when" aria-label="time" value="0">'),
        element("output", "", id="clock"),
        element("select", *speeds, id="speed", aria_label="speed"),
        *views,
        element("label", Markup('<input type="checkbox" id="names" checked> '), "names"),
        id="controls",
    )


def _legend(motion: Motion) -> Markup:
    """Colors of bodies that have no field, and of marks."""
    items = [_item(shape.name, shape.color) for shape in motion.shapes if shape.values is None]
    if len(items) > MOST_NAMED:
        more = element("li", f"and {len(items) - MOST_NAMED} more bodies")
        items = [*items[:MOST_NAMED], more]
    items += [_item(kind, color) for kind, color in motion.moving.legend]
    return element("ul", *items, class_="bodies")


def _item(name: str, color: str) -> Markup:
    swatch = element("span", class_="swatch", style=f"background:{color}")
    return element("li", swatch, name)
