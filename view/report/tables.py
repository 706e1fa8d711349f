"""The tables of a report."""

import platform
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from ...results import Peak, QuantityError, RecoveryError, Results, SeriesError, peaks
from ...results.motion import BALANCED_ENERGIES, Energy, Events
from ...results.validity import Check
from ...superelement import SuperelementError
from ...superelement.validation import Array
from ..prefixes import seconds
from . import libraries
from .markup import Markup, facts, folded, joined, note, part, table
from .numbers import counted, short, vector
from .origin import origin, tables

# A chattering contact has thousands of events, which CSV files are for.
MAX_TABLE_ROWS = 200


def validity_table(results: Results) -> Markup:
    """The worst of each criterion, and folded all."""
    checks = results.validity.checks
    if not checks:
        return note("These results hold no checks of validity.")
    columns = ("", "value", "where", "recommended", "limit", "verdict")
    worst = table(columns, map(_check_row, results.validity.worst), "tntnn")
    every = _limited(columns, [_check_row(check) for check in checks], "tntnn")
    return joined([worst, folded(f"All {len(checks)} checks", every)])


def _check_row(check: Check) -> tuple[object, ...]:
    criterion, verdict = check.criterion, check.verdict
    value = "unknown" if verdict == "unknown" else criterion.measured(check.value)
    owner = check.owner or criterion.owner
    word = part("word", verdict)
    limits = (criterion.bound(criterion.good), criterion.bound(criterion.limit))
    return (criterion.quantity, value, owner, *limits, word)


def _stress_peaks(results: Results) -> tuple[Peak, ...]:
    """The largest stress of each body that knows its stresses, of all steps."""
    found: list[Peak] = []
    for body in results.superelement_files:
        with suppress(RecoveryError, QuantityError, SuperelementError, OSError):
            found += peaks(results, [f"von_mises:{body}"])
    return tuple(found)


def peaks_table(results: Results) -> Markup:
    """The peaks of what is looked at unasked."""
    try:
        found = (*_stress_peaks(results), *peaks(results))
    except (QuantityError, SeriesError) as error:
        return note(f"No table of peaks: {error}")
    rows = [
        (
            peak.quantity if peak.place is None else f"{peak.quantity} at {peak.place}",
            peak.unit,
            short(peak.largest),
            f"{peak.at_largest:.5g} {peak.base}",
            short(peak.smallest),
            f"{peak.at_smallest:.5g} {peak.base}",
        )
        for peak in found
    ]
    return _limited(("quantity", "unit", "largest", "at", "smallest", "at"), rows, "ttnnnn")


def events_table(results: Results) -> Markup:
    """A row for each time that a contact or stop was closed."""
    rows: list[tuple[object, ...]] = []
    for name, events in results.events.items():
        rows += _event_rows(name, events, results.unit("events", name, "peak"))
    if not results.events:
        return note("The model has no contacts and no stops.")
    if not rows:
        return note("No contact and no stop was closed at any time.")
    headings = (
        "contact",
        "closed at [s]",
        "for",
        "steps",
        "peak force",
        "impulse",
        "closing speed",
        "opening speed",
        "restitution",
        "energy taken [J]",
    )
    return _limited(headings, rows, "tnnnnnnnnn")


def _event_rows(name: str, events: Events, unit: str) -> Iterator[tuple[object, ...]]:
    speed = "m/s" if unit == "N" else "rad/s"
    for i, still in enumerate(events.still_closed):
        yield (
            name,
            f"{events.start[i]:.6g}",
            seconds(float(events.end[i] - events.start[i])) + (", to the end" if still else ""),
            f"{events.steps[i]:.0f}",
            f"{short(events.peak[i])} {unit}",
            f"{short(events.impulse[i])} {unit} s",
            f"{short(events.closing_speed[i])} {speed}",
            "–" if still else f"{short(events.opening_speed[i])} {speed}",
            "–" if still else short(events.restitution[i]),
            short(events.dissipated[i]),
        )


def balance_table(results: Results) -> Markup:
    """Energies at the start and at the end, what they were at most, and their balance."""
    if "energy" not in results.recorded:
        return note("No energy balance: the run did not record energies.")
    energy, names = results.energy, [n for n in BALANCED_ENERGIES if n in results.energies]
    rows = [(name, *_extent(getattr(energy, name))) for name in [*names, "balance"]]
    found = table(("energy [J]", "start", "end", "smallest", "largest"), rows, "tnnnn")
    return joined([found, note(_closing(energy))])


def _extent(values: Array) -> tuple[str, ...]:
    return tuple(map(short, (values[0], values[-1], values.min(), values.max())))


def _closing(energy: Energy) -> str:
    """How well energies balance, beside the largest that moved."""
    largest, share = energy.imbalance()
    relative = f", {share:.1g} of the largest energy that moved" if share else ""
    return (
        f"Balance: the sum of all less the work and less its value at the start; it is within "
        f"{largest:.2g} J{relative}."
    )


def momentum_table(results: Results) -> Markup:
    if "momentum" not in results.recorded:
        return note("No momentum: the run did not record it.")
    linear, angular = results.momentum.linear, results.momentum.angular
    rows = [
        ("linear [kg m/s]", vector(linear[0]), vector(linear[-1])),
        ("angular, about the origin [kg m²/s]", vector(angular[0]), vector(angular[-1])),
    ]
    return table(("momentum", "start", "end"), rows, "tnn")


def solver_table(results: Results) -> Markup:
    """Settings and statistics of the run, and what it noted of its start."""
    return joined([facts(_settings(results)), facts(_start(results))])


def _settings(results: Results) -> Iterator[tuple[str, object]]:
    solver, iterations = results.solver, results.iterations
    steps, spent = int(solver.get("steps", 0)), float(solver.get("seconds", 0.0))
    yield "Step h", seconds(float(solver["h"])) if "h" in solver else ""
    yield "Steps", str(steps)
    yield "Recorded", f"{len(results.time)} instants, one of {int(solver.get('every', 1))} steps"
    yield "Time of the loop", seconds(spent) if spent else ""
    yield "Per step", f"{1e6 * spent / steps:.1f} µs" if steps and spent else ""
    if len(iterations):
        most, mean = int(iterations.max()), float(iterations.mean())
        yield "Newton iterations", f"{mean:.3g} on average, {most} at most"
        yield "Relative residual", f"{float(results.residual.max()):.2g} at most"
    for name, key in (
        ("Rule", "rule"),
        ("rho_inf", "rho_inf"),
        ("History", "history"),
        ("Start", "start"),
    ):
        yield name, _plain(solver.get(key, ""))
    yield "Damping", _plain(solver.get("damping", ""))
    yield "Constraints removed as redundant", _plain(solver.get("removed", ""))


def _start(results: Results) -> Iterator[tuple[str, object]]:
    """Notes of the start that are not negligible."""
    solver = results.solver
    for name, key, unit in (
        ("Largest assembly error", "assembly_error", "m"),
        ("Largest velocity error", "velocity_error", "m/s or rad/s"),
        ("Bodies moved at the start by up to", "moved", "m or rad"),
        ("Velocities changed at the start by up to", "velocity_correction", "m/s or rad/s"),
        ("Impulse responses cut off, error", "truncation", "of static displacements"),
    ):
        if float(solver.get(key, 0.0)) > 1e-9:
            at = _plain(solver.get(f"{key}_at", ""))
            yield name, f"{float(solver[key]):.3g} {unit}" + (f" at {at}" if at else "")
    yield "Drift", _plain(solver.get("drift", ""))


def _plain(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def bodies_table(results: Results) -> Markup:
    """Mass and kind of each body, and of superelements their file, method and error."""
    given = tables(results.model).get("bodies", {})
    names = list(dict.fromkeys([*results.bodies, *results.superelement_files, *given]))
    rows = [_body_row(results, name, given.get(name, {})) for name in names]
    headings = ("body", "kind", "mass [kg]", "superelement", "dofs", "method", "error")
    return _limited(headings, rows, "ttntnt")


def _body_row(results: Results, name: str, given: Any) -> tuple[object, ...]:
    file = results.superelement_files.get(name)
    if file is None:
        mass = given.get("mass") if isinstance(given, dict) else None
        return (
            name,
            "rigid",
            short(float(mass)) if isinstance(mass, int | float) else "–",
            "",
            "",
            "",
            "",
        )
    try:
        made = results.superelement(name)
    except (RecoveryError, SuperelementError, OSError) as error:
        return (name, "flexible", "–", file.path, "–", f"not read: {error}", "–")
    kernel = made.kernel
    bound = f"{kernel.error:.2g} up to {kernel.band:.5g} Hz" if kernel.error else "exact"
    return (
        name,
        "flexible",
        short(made.mass),
        file.path,
        made.n_c,
        made.provenance.method,
        bound,
    )


def provenance(results: Results) -> Markup:
    """Files with their digests, and versions."""
    files = {file.path: file.digest for file in results.superelement_files.values()}
    rows = [(path, part("code", digest)) for path, digest in files.items()]
    superelements = [table(("superelement", "sha256"), rows)] if rows else []
    return joined([facts(_machines(results)), *superelements])


def _machines(results: Results) -> Iterator[tuple[str, object]]:
    source = origin(results)
    yield "Results file", f"{source.path}, version {source.version}" if source.path else "in memory"
    yield "Run", _plain(results.solver.get("run", ""))
    yield "Run by", source.created_by
    machine = f"{platform.system()} {platform.release()}, {platform.machine()}"
    yield "Report made on", f"{machine}, Python {platform.python_version()}, numpy {np.__version__}"
    yield "Page drawn by", libraries.versions()


def model_text(results: Results) -> Markup:
    text = results.model
    if not text:
        return note("The model was not read from a file: there is no text of it.")
    lines = counted(text.count("\n") + 1, "line")
    return folded(f"Model file, {lines}", part("listing", text))


def _limited(
    headings: tuple[str, ...], rows: Sequence[tuple[object, ...]], numbers: str = ""
) -> Markup:
    """A table of the first rows, with a line where there are more."""
    shown = table(headings, rows[:MAX_TABLE_ROWS], numbers)
    if len(rows) <= MAX_TABLE_ROWS:
        return shown
    return joined([shown, note(f"The first {MAX_TABLE_ROWS} of {len(rows)} rows.")])
