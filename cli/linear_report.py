"""Tables and pictures of `duhamel modes`, `duhamel frf` and `duhamel campbell`."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from rich.table import Table

from ..solver import (
    Campbell,
    FrequencyResponse,
    LinearModel,
    LinearModes,
    Model,
    UnbalanceResponse,
    stability_map,
)
from ..superelement.validation import Array
from ..view import CampbellLine, ModeShape, ResponseCurve, draw_campbell, draw_response, draw_shapes
from .tables import table

# Within its width, or a sharp peak falls between two points.
FREQUENCIES_PER_RESONANCE = 41
# Of damping: a sharper resonance counts as so wide, for its peak has no end.
LEAST_RESONANCE_RATIO = 1e-4
# Damping ratios, and frequencies over the largest, that count as none.
ROUNDING_SHARE = 1e-9
# Six rows of two fill a page.
MAX_DRAWN_MODES = 12
# Of a Campbell diagram, in 80 columns.
LINES_ABREAST = 6
# Whole ones would leave four lines abreast.
NARROW_WHIRL_NAMES = {"forward": "forw.", "backward": "backw.", "none": "none", "mixed": "mixed"}


def modes_table(title: str, modes: LinearModes) -> Table:
    """Number, frequency, damping and what is special of every mode."""
    rows = (
        (k + 1, f"{modes.frequencies[k]:.6g}", _percent(float(modes.ratios[k])), kind(modes, k))
        for k in range(len(modes))
    )
    return table(title, ("mode", "frequency [Hz]", "damping [%]", ""), rows, "nnnt")


def per(unit: str, given: str) -> str:
    """A unit per unit of what is given: "m / N", "rad / (N m)"."""
    return f"{unit} / {f'({given})' if ' ' in given else given or '1'}"


def _percent(ratio: float) -> str:
    return "0" if abs(ratio) < ROUNDING_SHARE else f"{100.0 * ratio:.4g}"


def kind(modes: LinearModes, k: int) -> str:
    """What a mode is beside an oscillation that decays."""
    value = complex(modes.values[k])
    if value == 0.0:
        return "free: nothing resists"
    if modes.unstable[k]:
        return f"UNSTABLE: grows by exp({value.real:.4g} t)"
    return f"decays by exp({value.real:.4g} t)" if value.imag == 0.0 else ""


def modes_csv(modes: LinearModes) -> list[list[str]]:
    rows = [["mode", "frequency_Hz", "damping_ratio", "real_rad_per_s", "imaginary_rad_per_s"]]
    for k, value in enumerate(modes.values.tolist()):
        numbers = (modes.frequencies[k], modes.ratios[k], value.real, value.imag)
        rows.append([str(k + 1), *(repr(float(number)) for number in numbers)])
    return rows


def modes_picture(title: str, linear: LinearModel, modes: LinearModes) -> Any:
    """The first modes, two a row."""
    shapes = []
    for k in range(min(len(modes), MAX_DRAWN_MODES)):
        bodies = [(s.points, s.motion, s.edges) for s in linear.shapes(modes.y[:, k])]
        what = kind(modes, k) or f"{modes.frequencies[k]:.5g} Hz"
        shapes.append(ModeShape(f"{k + 1}: {what}", bodies))
    return draw_shapes(shapes, title)


def grid(band: tuple[float, float], n: int, modes: LinearModes | None) -> Array:
    """n frequencies of a band [Hz], evenly in their logarithm, and more about resonances."""
    frequencies = np.geomspace(*band, n)
    if modes is None:
        return frequencies
    parts = [frequencies]
    for f, ratio in zip(modes.frequencies.tolist(), modes.ratios.tolist(), strict=True):
        if band[0] <= f <= band[1]:
            # an even number beside the peak, which is infinite without damping
            spread = np.linspace(-8.0, 8.0, FREQUENCIES_PER_RESONANCE + 1) * max(
                ratio, LEAST_RESONANCE_RATIO
            )
            parts.append(f * (1.0 + spread))
    joined: Array = np.unique(np.concatenate(parts))
    inside = (joined >= band[0]) & (joined <= band[1])
    return joined[inside]


def band_of(modes: LinearModes, limit: float = np.inf) -> tuple[float, float]:
    """From a fifth of the first frequency to twice the tenth, but not beyond a limit [Hz].

    limit: where the superelements end; a first frequency beyond it is shown all the same.
    """
    moving = np.sort(modes.frequencies[modes.frequencies > 0.0])
    if not len(moving):
        # Rigid bodies that nothing holds: any band shows their masses.
        return 1.0, 1000.0
    first = float(moving[0])
    return first / 5.0, max(min(2.0 * float(moving[:10][-1]), limit), 2.0 * first)


def response_csv(responses: Mapping[str, FrequencyResponse]) -> list[list[str]]:
    """A row for each frequency: magnitude and phase [rad] of every output by every input.

    responses: at the same frequencies, by what is said behind their names.
    """
    first = next(iter(responses.values()))
    columns = [["frequency_Hz", *map(repr, first.frequencies.tolist())]]
    for curve in _curves(responses):
        columns.append([f"{curve.name} [{curve.unit}]", *_numbers(np.abs(curve.values))])
        columns.append([f"{curve.name} phase [rad]", *_numbers(np.angle(curve.values))])
    return [list(row) for row in zip(*columns, strict=True)]


def _curves(responses: Mapping[str, FrequencyResponse]) -> Iterator[ResponseCurve]:
    """Every output by every input."""
    for remark, response in responses.items():
        for i, output in enumerate(response.outputs):
            for j, given in enumerate(response.inputs):
                unit = per(response.units[i], response.input_units[j])
                yield ResponseCurve(f"{output} by {given}{remark}", unit, response.values[:, i, j])


def _numbers(values: Array) -> list[str]:
    # As many digits as read back to the same number.
    return list(map(repr, values.tolist()))


def response_picture(title: str, responses: Mapping[str, FrequencyResponse]) -> Any:
    """All outputs by all inputs; responses: by what is said behind their names."""
    frequencies = next(iter(responses.values())).frequencies
    return draw_response(frequencies, list(_curves(responses)), title)


def static_table(response: FrequencyResponse) -> Table:
    """Static influence coefficients: a row for each output, a column for each input."""
    inputs = zip(response.inputs, response.input_units, strict=True)
    headings = ["output", *(f"per {unit or 'unit'} of {name}" for name, unit in inputs)]
    outputs = enumerate(zip(response.outputs, response.units, strict=True))
    rows = (
        (f"{name} [{unit}]", *(f"{value:.9g}" for value in response.values[0, i].real.tolist()))
        for i, (name, unit) in outputs
    )
    return table("static influence coefficients", headings, rows, "t".ljust(len(headings), "n"))


def campbell_rows(diagram: Campbell) -> list[list[str]]:
    """A row for each spin: frequencies and damping ratios of all lines."""
    names = [f"{k + 1} {line.whirl}" for k, line in enumerate(diagram.lines)]
    header = ["spin_rad_per_s"]
    for name in names:
        header += [f"{name} [Hz]", f"{name} damping"]
    rows = [header]
    for n, spin in enumerate(diagram.spins.tolist()):
        row = [repr(spin)]
        for line in diagram.lines:
            row += [repr(float(line.frequencies[n])), repr(float(line.ratios[n]))]
        rows.append(row)
    return rows


def campbell_tables(title: str, diagram: Campbell) -> Iterator[Table]:
    """Frequencies over the spin, as many lines side by side as fit into 80 columns."""
    largest = max(float(np.nanmax(line.frequencies)) for line in diagram.lines)
    heads = [f"{k + 1} {NARROW_WHIRL_NAMES[line.whirl]}" for k, line in enumerate(diagram.lines)]
    for first in range(0, len(heads), LINES_ABREAST):
        what = f"{title}: frequencies in space [Hz] over the spin [rad/s]" if not first else ""
        lines = diagram.lines[first : first + LINES_ABREAST]
        rows = [
            (f"{spin:.5g}", *(_rounded(line.frequencies[n], largest) for line in lines))
            for n, spin in enumerate(diagram.spins.tolist())
        ]
        headings = ("spin", *heads[first : first + LINES_ABREAST])
        yield table(what, headings, rows, "n" * len(headings))


def _rounded(frequency: float, largest: float) -> str:
    """A frequency with five digits, 0 where it is the rounding of the largest."""
    if np.isnan(frequency):
        return ""
    return f"{frequency:.5g}" if frequency > ROUNDING_SHARE * largest else "0"


def crossing_lines(diagram: Campbell, orders: Sequence[float]) -> Iterator[str]:
    """A line of text for each speed at which an engine order meets a mode, or a mode grows."""
    for order in orders:
        for crossing in diagram.crossings(order):
            turns = 60.0 * crossing.spin / (2.0 * np.pi)
            whirl = diagram.lines[crossing.line].whirl
            yield (
                f"{order:g}x meets line {crossing.line + 1} ({whirl}) at {crossing.spin:.6g} "
                f"rad/s, {turns:.6g} turns per minute: {crossing.frequency:.6g} Hz"
            )
    # A mode that grows is told even where no engine order meets it.
    for spin in diagram.spins[diagram.unstable].tolist():
        yield f"UNSTABLE at {spin:.6g} rad/s: a mode grows, see `duhamel modes` at that spin"


def threshold_lines(model: Model, diagram: Campbell, modes: int) -> Iterator[str]:
    """A line for each speed at which a rotor on bearings becomes unstable, or stable again."""
    spins, unstable = diagram.spins.tolist(), diagram.unstable.tolist()
    for k in range(len(spins) - 1):
        if unstable[k] == unstable[k + 1] or spins[k] == 0.0:
            continue
        for spin in stability_map(model, spins[k : k + 2], 2 * modes).thresholds.tolist():
            what = "unstable above" if unstable[k + 1] else "stable above"
            turns = 60.0 * spin / (2.0 * np.pi)
            yield f"{what} {spin:.6g} rad/s, {turns:.6g} turns per minute"


def unbalance_rows(response: UnbalanceResponse, points: Sequence[str]) -> list[list[str]]:
    """A row for each spin: amplitude and phase along e_1 and e_2, and the long semiaxis."""
    header, columns = ["spin_rad_per_s"], [response.spins]
    for name in points:
        motion = response.motion[:, response.names.index(name)]
        for k, axis in enumerate(("e1", "e2")):
            header += [f"{name}.{axis} [m]", f"{name}.{axis} phase [rad]"]
            columns += [np.abs(motion[:, k]), np.angle(motion[:, k])]
        header.append(f"{name} long semiaxis [m]")
        columns.append(response.amplitude(name))
    return [header, *([repr(float(x)) for x in row] for row in zip(*columns, strict=True))]


def peak_lines(response: UnbalanceResponse, points: Sequence[str]) -> Iterator[str]:
    """A line of text for each critical speed of a point."""
    for name in points:
        for spin, size in response.peaks(name):
            turns = 60.0 * spin / (2.0 * np.pi)
            yield (
                f"{name}: largest at {spin:.6g} rad/s, {turns:.6g} turns per minute: {size:.4g} m"
            )


def unbalance_picture(title: str, response: UnbalanceResponse, points: Sequence[str]) -> Any:
    """Amplitudes and phases of points along e_1 and e_2 over turns per second."""
    curves = [
        ResponseCurve(f"{name}.{axis}", "m", response.motion[:, response.names.index(name), k])
        for name in points
        for k, axis in enumerate(("e1", "e2"))
    ]
    return draw_response(response.spins / (2.0 * np.pi), curves, title)


def campbell_picture(title: str, diagram: Campbell, orders: Sequence[float]) -> Any:
    lines = [CampbellLine(line.whirl, line.frequencies) for line in diagram.lines]
    crossings = [(c.spin, c.frequency) for order in orders for c in diagram.crossings(order)]
    return draw_campbell(diagram.spins, lines, orders, crossings, title)
