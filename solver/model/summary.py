"""A model in a few rows, for notebooks."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ...files.html import Row, listed
from .bodies import Body, FlexibleBody
from .settings import Settings

MAX_BODY_ROWS = 10


def rows(
    bodies: Mapping[str, Body], parts: Mapping[str, Sequence[Any]], gravity: Any, settings: Settings
) -> Iterator[Row]:
    """Bodies, what is between them, gravity, and how it is integrated."""
    yield "bodies", str(len(bodies))
    # A table of hundreds of bodies would fill a notebook.
    for name, body in list(bodies.items())[:MAX_BODY_ROWS]:
        yield f"\u2003{name}", _body(body)
    if len(bodies) > MAX_BODY_ROWS:
        yield "", f"and {len(bodies) - MAX_BODY_ROWS} more"
    for kind, entries in parts.items():
        if entries:
            yield kind, listed(_name(entry) for entry in entries)
    yield "gravity", f"{listed(f'{g:.6g}' for g in gravity.tolist())} m/s²"
    yield "t_end", f"{settings.t_end:.6g} s"
    step = "that of the superelements" if settings.step is None else f"{settings.step:.6g} s"
    yield "step", step
    yield "start", settings.start if isinstance(settings.start, str) else settings.start.path


def counted(n: int, kind: str) -> str:
    """A number with its kind, as `1 joint` or `2 joints`."""
    return f"{n} {kind.removesuffix('s') if n == 1 else kind}"


def _body(body: Body) -> str:
    if isinstance(body, FlexibleBody):
        element = body.superelement
        names = listed(interface.name for interface in element.interfaces)
        return f"flexible, {element.mass:.6g} kg, interfaces {names}"
    return f"rigid, {body.mass:.6g} kg" + (f", frames {listed(body.frames)}" if body.frames else "")


def _name(entry: Any) -> str:
    """An entry with its type, as `pivot (revolute)`."""
    name, kind = getattr(entry, "name", ""), getattr(entry, "type", "")
    where = getattr(entry, "on", "") or getattr(entry, "body", "")
    if not name:
        return f"{kind or 'pattern'} on {where}"
    return f"{name} ({kind})" if kind else str(name)
