"""One page from results: its parts in order, with all that it needs inside."""

import json
from collections.abc import Callable, Iterator
from itertools import count
from typing import Any, NamedTuple

from ...results import Results
from ...superelement.validation import Array
from . import libraries
from .animation import animation, duration
from .head import head
from .markup import Markup, joined, note, part, read, rendered
from .motion import Motion, motion
from .origin import origin
from .plots import Plot, drawing, plots, remark
from .scene import names, scene
from .sections import SECTIONS

OnPart = Callable[[int, int], object]
"""is told how many parts are made, of how many"""
# Plots, their figures, tables, the scene.
PARTS_BESIDE_BODIES = 4


class Section(NamedTuple):
    """A part of the page."""

    heading: str
    content: Markup

    @property
    def identity(self) -> str:
        """Where links lead."""
        return self.heading.lower().replace(" ", "-")


def page(
    results: Results, title: str = "", field: str = "", on_part: OnPart | None = None
) -> Markup:
    """The page as HTML. field: of the colors of the animation."""
    source = origin(results)
    heading = title or source.name
    made = _counted(len(results.bodies) + PARTS_BESIDE_BODIES, on_part)
    moving = motion(results, field, made)
    drawn = list(plots(results))
    made()
    sections = [*_motion(moving), *_plots(results, drawn)]
    made()
    sections += _sections(results)
    made()
    packed = {"plotly": libraries.plotly()}
    if moving is not None:
        packed |= {"k3d": libraries.k3d(), "scene": libraries.text(scene(moving))}
    made()
    data = _data(results, [plot for _, group in drawn for plot in group], moving)
    packed["data"] = libraries.packed(json.dumps(data, allow_nan=False).encode())
    return rendered(
        "page.html",
        title=heading,
        style=Markup(read("page.css")),
        head=head(results, source),
        sections=sections,
        packed={name: Markup(text) for name, text in packed.items()},
        script=Markup(read("viewer.js") + read("page.js")),
    )


def _counted(total: int, on_part: OnPart | None) -> Callable[[], None]:
    """What is called when one more part is made."""
    numbers = count(1)

    def made() -> None:
        if on_part is not None:
            on_part(next(numbers), total)

    return made


def _data(results: Results, drawn: list[Plot], moving: Motion | None) -> dict[str, Any]:
    """What the script of the page draws."""
    time = results.time
    return {
        "plots": [drawing(plot, time) for plot in drawn],
        "range": [float(time[0]), float(time[-1])] if len(time) else [0.0, 0.0],
        "moves": moving is not None,
        "duration": 0.0 if moving is None else duration(moving),
        "instants": [] if moving is None else moving.time.tolist(),
        "marks": {} if moving is None else names(moving),
    }


def _motion(moving: Motion | None) -> Iterator[Section]:
    if moving is None:
        yield Section("Motion", note("No animation: the run recorded no body."))
    else:
        yield Section("Motion", animation(moving))


def _plots(results: Results, drawn: list[tuple[str, list[Plot]]]) -> Iterator[Section]:
    """A part for each group of plots that has any, and a line for those that have none."""
    numbers = count()
    for heading, group in drawn:
        if group:
            figures = (_figure(plot, next(numbers), results.time) for plot in group)
            yield Section(heading, joined(figures))
    if missing := [heading.lower() for heading, group in drawn if not group]:
        text = f"Nothing was recorded, or nothing happened, of: {', '.join(missing)}."
        yield Section("Not shown", note(text))


def _figure(plot: Plot, number: int, time: Array) -> Markup:
    told = remark(plot, time)
    return part("figure", _capitalized(plot.title), number, told and f"{_capitalized(told)}.")


def _capitalized(text: str) -> str:
    """Unlike `str.capitalize` it leaves the other letters, of which names have some."""
    return text[:1].upper() + text[1:]


def _sections(results: Results) -> Iterator[Section]:
    for each in SECTIONS:
        if (content := each.content(results)) is not None:
            yield Section(each.heading, content)
