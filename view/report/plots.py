"""The plots of a report: their curves, thinned, and what stands beside them."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np

from ...results import QuantityError, Results
from ...results.quantities import KINDS_BY_NAME, evaluate, names_in_role
from ...superelement.validation import Array
from ..curve import Curve
from ..naming import in_full, title_and_labels
from ..overview import overview
from ..quantities import curves
from .thinning import kept

# As many as there are colors: the largest ones.
MAX_PLOT_CURVES = 6
# Of numbers on the page: what single precision has, and all that a plot can show.
NUMBER_DIGITS = 7


@dataclass(frozen=True, eq=False)
class Plot:
    """Curves of one unit over time, or marks where `marks`.

    title: what all curves have in common; logarithmic: the ordinate; left_out: how many smaller
    curves are not shown.
    """

    title: str
    unit: str
    curves: Sequence[Curve]
    logarithmic: bool = False
    marks: bool = False
    left_out: int = 0


def plots(results: Results) -> Iterator[tuple[str, list[Plot]]]:
    """The plots by the heading above them; none where nothing was recorded."""
    yield "Overview", overview_plots(results)
    for section in dict.fromkeys(kind.section for kind in KINDS_BY_NAME.values() if kind.section):
        found = [name for name, kind in KINDS_BY_NAME.items() if kind.section == section]
        drawn = [plot for name in found for plot in _of_kind(results, name)]
        yield section, [*drawn, *(_peaks_of_contacts(results) if section == "Contacts" else ())]
    yield "Solver", [*_solver(results)]


def drawing(plot: Plot, time: Array) -> dict[str, Any]:
    """A plot as the script of the page takes it, with its points thinned."""
    words = _labels(plot.curves)
    drawn = [_trace(curve, time, name) for curve, name in zip(plot.curves, words, strict=True)]
    return {
        # Of these the page sets the title as plain text; Plotly reads markup in the others.
        "title": plot.title,
        "unit": escape(plot.unit, quote=False),
        "log": plot.logarithmic,
        "marks": plot.marks,
        "curves": drawn,
    }


def remark(plot: Plot, time: Array) -> str:
    """What a reader must know of a plot that does not show everything."""
    parts = []
    shown = max((len(kept(curve.values)) for curve in plot.curves), default=0)
    if shown < len(time) and not plot.marks:
        parts.append(
            f"up to {shown} of {len(time)} points: the smallest and the largest of each column, "
            f"so every peak is there"
        )
    if plot.left_out:
        parts.append(f"the {len(plot.curves)} largest; {plot.left_out} smaller ones are left out")
    return "; ".join(parts)


def overview_plots(results: Results) -> list[Plot]:
    """The plots that are shown unasked."""
    try:
        return [_panel(shown) for shown in overview(results)]
    except QuantityError:
        return []


def plot_of(results: Results, quantity: str) -> Plot:
    """The plot of a quantity as `duhamel plot` has them; `QuantityError` where there is none."""
    return _panel(curves(results, quantity))


def _panel(shown: Sequence[Curve]) -> Plot:
    return Plot(title_and_labels(shown)[0], shown[0].unit, shown)


def _peaks_of_contacts(results: Results) -> Iterator[Plot]:
    """The peak of each time that a contact or stop was closed."""
    for unit, names in _by_unit(results).items():
        events = [
            Curve(("", name, ""), unit, results.events[name].peak, results.events[name].start)
            for name in names
            if len(results.events[name])
        ]
        if events:
            shown = events[:MAX_PLOT_CURVES]
            left_out = len(events) - len(shown)
            yield Plot("peak force of each contact", unit, shown, marks=True, left_out=left_out)


def _by_unit(results: Results) -> dict[str, list[str]]:
    """Contacts and stops by the unit of their force."""
    units: dict[str, list[str]] = {}
    for name in results.events:
        units.setdefault(results.unit("events", name, "peak"), []).append(name)
    return units


def _solver(results: Results) -> Iterator[Plot]:
    iterations = Curve(("iterations", "", ""), "", results.iterations.astype(float))
    yield Plot("Newton iterations of a step", "", [iterations])
    residual = results.residual.astype(float)
    if (residual > 0.0).any():
        shown = np.where(residual > 0.0, residual, np.nan)
        curve = Curve(("residual", "", ""), "", shown)
        yield Plot("relative residual of a step", "", [curve], logarithmic=True)


def _of_kind(results: Results, name: str) -> Iterator[Plot]:
    """A plot of all that a kind is of, for each unit that it has."""
    roles = [role for each in KINDS_BY_NAME[name].names for role in each.split("|")]
    owners = [owner for role in roles for owner in names_in_role(results, role)]
    found: list[Curve] = []
    for owner in owners if roles else [""]:
        with suppress(QuantityError):
            found.append(_length(results, name, owner))
    title = name.replace("_", " ")
    if len(roles) > 1:
        there = [role.lower().replace("_", " ") for role in roles if names_in_role(results, role)]
        title += f" of {' and '.join(f'{role}s' for role in there)}"
    for unit in dict.fromkeys(curve.unit for curve in found):
        yield from _largest(title, [curve for curve in found if curve.unit == unit])


def _length(results: Results, kind: str, name: str) -> Curve:
    """A number over time, or the length of a vector; of stresses the equivalent one."""
    found = evaluate(results, f"{kind}:{name}" if name else kind)
    values = found.values
    if values.ndim == 2:
        values = _equivalent(values) if len(KINDS_BY_NAME[kind].axes) == 6 else _norm(values)
    return Curve(("", name, ""), found.unit, values)


def _norm(vectors: Array) -> Array:
    lengths: Array = np.linalg.norm(vectors, axis=1)
    return lengths


def _equivalent(stress: Array) -> Array:
    from ...superelement import von_mises

    return von_mises(stress)


def _largest(title: str, curves: list[Curve]) -> Iterator[Plot]:
    """A plot of the largest curves, of which those that are zero throughout are none."""
    size: Callable[[Curve], float] = lambda curve: float(np.nanmax(np.abs(curve.values)))  # noqa: E731
    moving = [curve for curve in curves if len(curve.values) and size(curve) > 0.0]
    chosen = sorted(moving, key=size, reverse=True)[:MAX_PLOT_CURVES]
    if chosen:
        in_order = [curve for curve in moving if curve in chosen]
        yield Plot(title, chosen[0].unit, in_order, left_out=len(moving) - len(chosen))


def _labels(curves: Sequence[Curve]) -> list[str]:
    """What tells the curves apart; of a single one its name."""
    return [in_full(curves[0])] if len(curves) == 1 else title_and_labels(curves)[1]


def _trace(curve: Curve, time: Array, name: str) -> dict[str, Any]:
    x = time if curve.abscissa is None else curve.abscissa
    points = kept(curve.values)
    return {
        "name": escape(name, quote=False),
        "x": _numbers(x[points]),
        "y": _numbers(curve.values[points]),
    }


def _numbers(values: Array) -> list[float | None]:
    """Numbers of a few digits, null for what is none."""
    return [float(f"{x:.{NUMBER_DIGITS}g}") if np.isfinite(x) else None for x in values.tolist()]
