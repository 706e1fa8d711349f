"""The lines of `duhamel run` besides its speed: start, energy balance and momentum of the run."""

from collections.abc import Iterator

import numpy as np

from ..results import Results
from ..results.motion import BALANCED_ENERGIES, Energy, Events
from ..superelement.validation import Array

# Of positions [m, rad] and velocities [m/s, rad/s]: less is the rounding of the assembly.
NOTICEABLE_CHANGE = 1e-9


def report(results: Results) -> Iterator[str]:
    """Lines of text: degrees of freedom, changes at the start, energies and momenta at the end."""
    solver = results.solver
    yield f"degrees of freedom (bodies as rigid): {solver['degrees_of_freedom']}"
    if solver["removed"]:
        yield f"redundant constraints removed: {solver['removed']}"
    if damping := solver.get("damping"):
        yield f"damping ratios about the initial state: {damping}"
    if solver["assembly_error"] > NOTICEABLE_CHANGE:
        opening, joint = solver["assembly_error"], solver["assembly_error_at"]
        yield f"largest assembly error: {opening:.3g} m at {joint}"
    if solver["velocity_error"] > NOTICEABLE_CHANGE:
        error, joint = solver["velocity_error"], solver["velocity_error_at"]
        yield f"largest velocity error: {error:.3g} m/s or rad/s at {joint}"
    if solver["moved"] > NOTICEABLE_CHANGE:
        yield f"bodies start up to {solver['moved']:.3g} m or rad from their given places"
    if solver["velocity_correction"] > NOTICEABLE_CHANGE:
        change = solver["velocity_correction"]
        yield f"bodies start up to {change:.3g} m/s or rad/s from their given velocities"
    if solver["truncation"] > 0.0:
        error = solver["truncation"]
        yield f"impulse responses are cut off: error of displacements {error:.1g} of static ones"
    yield from str(solver.get("drift", "")).splitlines()
    recorded = results.recorded
    if "energy" in recorded:
        yield _energy_balance(results.energy)
    if "momentum" in recorded:
        linear, angular = results.momentum.linear[-1], results.momentum.angular[-1]
        yield (
            f"momentum at the end [kg m/s]: {_vector(linear)}; "
            f"angular, about the origin [kg m^2/s]: {_vector(angular)}"
        )
    # Surfaces that open give energy back that closing took: it has a criterion of its own.
    if "energy" in recorded and not results.surface_contacts:
        yield from _created(results.energy, solver["rule"])
    for name, events in results.events.items():
        yield f"contacts: {name}: {_contact(events, results.unit('events', name, 'peak'))}"
    for name in results.surface_contacts:
        yield f"contacts: {name}: {_surfaces(results, name)}"
    for name in results.motors:
        yield f"motor {name}: {_motor(results, name)}"
    yield from str(results.validity).splitlines()
    if names := results.never_closed:
        yield (
            f"note: never closed in this run: {', '.join(names)}; if that is not meant, look at "
            "their gaps (duhamel check), shapes and t_end"
        )


def _contact(events: Events, unit: str) -> str:
    """How often a contact or stop closed, how hard, and how many steps of the run it took."""
    if not len(events):
        return "never closed"
    n, shortest = events.impacts, events.shortest
    parts = [f"{n} impact{'' if n == 1 else 's'}", f"peak {events.peak.max():.4g} {unit}"]
    parts.append(f"impulse {events.impulse.sum():.4g} {unit} s")
    if shortest is not None:
        parts.append(f"shortest {shortest} steps")
    if n < len(events):
        parts.append("closed at the start")
    if events.still_closed.any():
        parts.append("closed at the end")
    return ", ".join(parts)


def _surfaces(results: Results, name: str) -> str:
    """How much of a surface was in contact at most, and how hard it was pressed."""
    motion = results.surface_contact(name)
    return (
        f"up to {motion.closed_rows.max()} nodes closed, {motion.area.max():.4g} m^2, "
        f"largest pressure {motion.largest_pressure.max():.4g} Pa"
    )


def _motor(results: Results, name: str) -> str:
    """What a motor gave at most, its work, how far it was from its reference, and its limits."""
    motion = results.motor(name)
    torque, length = (results.unit("motors", name, key) for key in ("torque", "error"))
    parts = [
        f"peak {np.abs(motion.torque).max():.4g} {torque}, {np.abs(motion.power).max():.4g} W",
        f"work {motion.work[-1]:.4g} J",
    ]
    if motion.error.any():
        largest, last = np.abs(motion.error).max(), motion.error[-1]
        parts.append(f"error up to {largest:.3g} {length}, at the end {last:.3g} {length}")
    if limited := float(np.mean(motion.state != 0)):
        parts.append(f"at its limit {100.0 * limited:.3g} % of the time")
    return "; ".join(parts)


def _created(energy: Energy, rule: str) -> Iterator[str]:
    """A line where the convolution has created energy."""
    put_in = energy.elastic + energy.numerical
    lowest, scale = float(put_in.min()), float(np.abs(put_in).max())
    # Two bounds: rounding of large energies, and that of a run in which nothing vibrates.
    if lowest < -1e-9 * scale and lowest < -10.0 * np.finfo(float).eps:
        yield (
            f"elastic energy fell to {lowest:.3g} J: the convolution has created energy "
            f"(rule {rule!r})"
        )


def _energy_balance(energy: Energy) -> str:
    last = ", ".join(
        f"{name} {getattr(energy, name)[-1]:.4g}"
        for name in BALANCED_ENERGIES
        if getattr(energy, name).any()
    )
    largest, share = energy.imbalance()
    relative = f", {share:.1g} of the largest" if share else ""
    return f"energy at the end [J]: {last or 'none'}; balance within {largest:.2g}{relative}"


def _vector(values: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")"
