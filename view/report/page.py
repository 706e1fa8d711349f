"""One page from results: its parts in order, with all that it needs inside."""

import json
from collections.abc import Callable, Iterator, Mapping
from importlib.resources import files
from itertools import count
from typing import Any

import numpy as np

from ...results import Results
from . import libraries
from .animation import animation, duration
from .head import contents, head
from .markup import Markup, element, joined, note, section
from .motion import Motion, motion
from .origin import origin
from .plots import Plot, drawing, plots, remark
from .scene import names, scene
from .sections import SECTIONS

ROOM = files(__package__)
OnPart = Callable[[int, int], object]
"""is told how many parts are made, of how many"""
LATER = 4
"""parts beside the bodies: plots, their pages, tables, the scene"""


def page(
    results: Results, title: str = "", field: str = "", on_part: OnPart | None = None
) -> Markup:
    """The page as HTML. field: of the colors of the animation."""
    source = origin(results)
    heading = title or source.name
    made = _counted(len(results.bodies) + LATER, on_part)
    moving = motion(results, field, made)
    drawn = list(plots(results))
    made()
    parts = [*_motion(moving), *_plots(results, drawn)]
    made()
    parts += _sections(results)
    made()
    links = contents([(identity, text) for identity, text, _ in parts])
    sections = (section(identity, text, body) for identity, text, body in parts)
    packed = {"plotly": libraries.plotly()}
    if moving is not None:
        packed |= {"k3d": libraries.k3d(), "scene": libraries.text(scene(moving))}
    made()
    data = _data(results, [plot for _, group in drawn for plot in group], moving)
    packed["data"] = libraries.packed(json.dumps(data, allow_nan=False).encode())
    main = element("main", head(results, source, heading), links, _without_scripts(), *sections)
    return Markup(f"<!doctype html>\n{_document(heading, main, packed)}\n")


def _counted(total: int, on_part: OnPart | None) -> Callable[[], None]:
    """What is called when one more part is made."""
    numbers = count(1)

    def made() -> None:
        if on_part is not None:
            on_part(next(numbers), total)

    return made


def _document(title: str, main: Markup, packed: Mapping[str, str]) -> Markup:
    head = element(
        "head",
        Markup('<meta charset="utf-8">'),
        Markup('<meta name="viewport" content="width=device-width, initial-scale=1">'),
        Markup('<link rel="icon" href="data:,">'),
        element("title", title),
        element("style", Markup(_file("page.css"))),
    )
    blocks = (_block(name, text) for name, text in packed.items())
    script = element("script", Markup(_file("page.js")))
    return element("html", head, element("body", main, *blocks, script), lang="en")


def _block(name: str, packed: str) -> Markup:
    """Compressed data, which the script of the page unpacks."""
    return element("script", Markup(packed), id=name, type="text/plain")


def _file(name: str) -> str:
    return ROOM.joinpath(name).read_text(encoding="utf-8")


def _without_scripts() -> Markup:
    text = "Plots and the animation need JavaScript, which is switched off here; tables do not."
    return element("noscript", element("p", text, class_="failed"))


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


def _motion(moving: Motion | None) -> Iterator[tuple[str, str, Markup]]:
    if moving is None:
        text = "No animation: the run recorded no body."
        yield "motion", "Motion", note(text)
    else:
        yield "motion", "Motion", animation(moving)


def _plots(
    results: Results, drawn: list[tuple[str, list[Plot]]]
) -> Iterator[tuple[str, str, Markup]]:
    """A part for each group of plots that has any, and a line for those that have none."""
    n = 0
    missing = [heading.lower() for heading, group in drawn if not group]
    for heading, group in drawn:
        if group:
            figures = [_figure(plot, n + i, results.time) for i, plot in enumerate(group)]
            yield heading.lower(), heading, joined(figures)
            n += len(group)
    if missing:
        text = f"Nothing was recorded, or nothing happened, of: {', '.join(missing)}."
        yield "missing", "Not shown", note(text)


def _figure(plot: Plot, number: int, time: Any) -> Markup:
    title = plot.title[:1].upper() + plot.title[1:]
    told = remark(plot, np.asarray(time))
    drawn = element("div", class_="drawn")
    return element(
        "figure",
        element("h3", title),
        element("div", drawn, class_="plot", data_plot=number),
        note(told[:1].upper() + told[1:] + ".") if told else "",
    )


def _sections(results: Results) -> Iterator[tuple[str, str, Markup]]:
    for part in SECTIONS:
        if (content := part.content(results)) is not None:
            yield part.identity, part.heading, content
