"""Fields of the bodies of a run as a picture: where and when a stress is largest."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ..results import QuantityError, Results
from ..results.transforms import Window
from ..results.wildcards import WILDCARD_STAR, matching
from .field_kinds import FIELD_WORDS, WORST_TIME, scale_of
from .fields import Field, draw_fields
from .picture import add_room, entitle
from .prefixes import seconds
from .scene import Marker, Scene
from .worst import worst_time

# The outline of a body without recovery deforms by what its interfaces do, which is said.
INTERPOLATED_SOURCE = "interfaces"
HEADER_HEIGHT = 0.5  # [inch]


@dataclass(frozen=True, eq=False)
class Chosen:
    """The field of bodies that a picture shows, and the time [s]."""

    kind: str
    bodies: tuple[str, ...]
    time: float


def draw_body_fields(
    results: Results,
    fields: Sequence[str],
    at: float | str = WORST_TIME,
    window: Window | None = None,
    title: str = "",
) -> Figure:
    """Draw bodies in space at a time, colored by a field on their surfaces.

    Magnitudes on the outlines of bodies, of a displacement the elastic one. The largest value is
    marked; the title says its time and its place in the mesh, and where a deformation is
    interpolated between the interfaces of a body without recovery.

    Parameters
    ----------
    results : Results
    fields : sequence of str
        Of one kind: "von_mises:rod", "displacement:*", "velocity:crank".
    at : float [s] or "worst"
        A time, or when the largest value of the run, or of the window, is.
    window : (float, float) [s], optional
        From and to: where the worst time is looked for.
    title : str

    Raises
    ------
    QuantityError
        For a field or body that there is not; the message lists those there are.
    RecoveryError
        Where the superelement of a body does not know the field.

    Examples
    --------
    >>> from duhamel import view
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.1).results
    >>> figure = view.draw_body_fields(results, ["velocity:ball"], at=0.5)
    >>> figure.texts[-1].get_text().partition(" at (")[0]
    'ball at 0.5 s: 5 m/s'
    """
    chosen = _chosen(results, fields, at, window)
    surfaces = [_surface(results, chosen, body) for body in chosen.bodies]
    peaks = [float(surface.values.max()) for surface in surfaces]
    first = int(np.argmax(peaks))
    body, surface, peak = chosen.bodies[first], surfaces[first], peaks[first]
    k = int(surface.values.argmax())
    scale = scale_of(chosen.kind, peak)
    value = scale.text(4)
    mark = Marker(value, surface.points[k], has_axes=False)
    label = f"{scale.words} [{scale.unit}]"
    figure = draw_fields(surfaces, label, 1.0 / scale.factor, Scene(markers=[mark]))
    line = f"{body} at {seconds(chosen.time)}: {value} at {results.place(body, k)}"
    if blended := [
        name for name in chosen.bodies if results.outline_source(name) == INTERPOLATED_SOURCE
    ]:
        line = f"{line}; interpolated between the interfaces of {', '.join(blended)}"
    _head(figure, title, line)
    return figure


def _chosen(
    results: Results, fields: Sequence[str], at: float | str, window: Window | None
) -> Chosen:
    kinds, bodies = [], []
    for field in fields:
        kind, _, pattern = field.partition(":")
        if kind not in FIELD_WORDS or not pattern:
            forms = ", ".join(f"{known}:BODY" for known in FIELD_WORDS)
            raise QuantityError(f"{field}: expected a field, {forms}")
        kinds.append(kind)
        bodies += _bodies(results, field, kind, pattern)
    if len(set(kinds)) > 1:
        raise QuantityError(f"expected one kind of field in a picture, found {', '.join(kinds)}")
    bodies = list(dict.fromkeys(bodies))
    time = float(at) if at != WORST_TIME else worst_time(results, bodies, kinds[0], window)
    return Chosen(kinds[0], tuple(bodies), time)


def _bodies(results: Results, field: str, kind: str, pattern: str) -> list[str]:
    """Bodies by a name or by stars: rigid ones have a velocity alone."""
    known = [
        body for body in results.bodies if kind == "velocity" or body in results.superelement_files
    ]
    found = [body for body in known if body == pattern]
    if WILDCARD_STAR in pattern:
        found = found or matching(known, pattern)
    if not found:
        what = "body" if kind == "velocity" else "flexible body"
        raise QuantityError(
            f"{field}: no {what} {pattern!r}; there are: {', '.join(known) or 'none'}"
        )
    return found


def _surface(results: Results, chosen: Chosen, body: str) -> Field:
    outline = results.outline(body)
    if not len(outline.triangles):
        raise QuantityError(f"{chosen.kind}:{body}: the body has no surface, lines alone")
    values = results.outline_field(body, chosen.time, chosen.kind)
    return Field(results.outline_position(body, chosen.time), outline.cells, values)


def _head(figure: Figure, title: str, line: str) -> None:
    """Text above the views, for which the figure grows."""
    add_room(figure, above=HEADER_HEIGHT)
    _, high = figure.get_size_inches()
    heading = entitle(figure, title or line)
    heading.set(y=1.0 - 0.1 / high, va="top")
    if title:
        below = 1.0 - 0.32 / high
        figure.text(0.01, below, line, ha="left", va="top", fontsize=9, parse_math=False)
