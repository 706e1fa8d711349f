"""The inspection of a model before it runs: `check`."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from os import PathLike
from pathlib import Path

import numpy as np

from ..files.blas import one_blas_thread
from ..files.memory import peak
from ..results.contents import Contents
from ..results.validity import Validity
from .arrays import Array
from .cosimulation.start import start_beside
from .errors import about
from .model.bodies import FlexibleBody
from .model.model import Model
from .output.columns import check_request
from .output.inputs import drifts, signal_warnings
from .output.size import check_memory, file_bytes, lack_of_disk
from .output.validity import ValidityMonitor
from .output.writer import check_output, contents_of, rows_of
from .plausibility import plausibility_warnings
from .start.damping import DampedMotion, damped_motions, damping_in_words
from .start.frequencies import vibrations, without_surfaces
from .start.initial import InitialState, initialize, lower_to_start
from .step.contacts import penetration_of
from .trial import take_trial, with_cause

MAX_FREQUENCIES = 6
NOTHING_JUDGED = Validity(())
# below, the error of a vibration is some per cent
MIN_STEPS_IN_PERIOD = 20


@dataclass(frozen=True, eq=False)
class ModelCheck:
    """What a run of a model will be, from `check`. `print` shows it as text.

    Parameters
    ----------
    bodies, flexible, constraints, degrees_of_freedom : int
        Degrees of freedom are those with all bodies rigid.
    removed : str
        Redundant constraints, in words.
    assembly_error : float [m]
        The largest gap of a joint as given.
    step : float [s]
    steps : int
    frequencies : (n,) or None [Hz]
        Of the assembled model about its start, None where they are not known.
    free_frequencies : dict of float [Hz]
        The first of each superelement alone, by body.
    second_order : dict of str
        Of each flexible body the number of its coordinates, "off" or "none".
    seconds : float [s]
        Estimate for the time loop.
    memory : int [bytes]
        Of the whole process at most, with libraries and compiled code.
    rows : int
    results_size : int [bytes]
    contacts, drifts, motors, moduli : tuple of str
        A line for each contact and stop with its gap at the start; for each coordinate that is
        driven by its velocity or acceleration, where it ends; for each motor; for each body whose
        moduli are given at a frequency.
    damping : tuple
        Frequencies and damping ratios of the first modes; empty where nothing damps them.
    validity : Validity
        Of the first steps, which are taken to measure the time.
    warnings : tuple of str

    Examples
    --------
    >>> from duhamel.solver import Model, RigidBody, Settings
    >>> ball, settings = RigidBody(1.0, [0.1, 0.1, 0.1]), Settings(t_end=1.0, step=0.1)
    >>> found = check(Model({"ball": ball}, settings=settings))
    >>> found.degrees_of_freedom, found.steps
    (6, 10)
    """

    bodies: int
    flexible: int
    constraints: int
    degrees_of_freedom: int
    removed: str
    assembly_error: float
    step: float
    steps: int
    frequencies: Array | None
    free_frequencies: dict[str, float]
    second_order: dict[str, str]
    seconds: float
    memory: int
    rows: int
    results_size: int
    contacts: tuple[str, ...] = ()
    drifts: tuple[str, ...] = ()
    damping: tuple[DampedMotion, ...] = ()
    motors: tuple[str, ...] = ()
    moduli: tuple[str, ...] = ()
    validity: Validity = NOTHING_JUDGED
    warnings: tuple[str, ...] = field(default=())

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self) -> Iterator[str]:
        """Lines of text, warnings excluded."""
        yield f"bodies: {self.bodies}, of which {self.flexible} flexible"
        if self.second_order:
            listed = ", ".join(f"{name} {terms}" for name, terms in self.second_order.items())
            yield f"terms of second order, coordinates: {listed}"
        yield f"constraints: {self.constraints}; redundant: {self.removed or 'none'}"
        yield f"degrees of freedom (bodies as rigid): {self.degrees_of_freedom}"
        yield f"largest assembly error: {self.assembly_error:.3g} m"
        yield f"steps: {self.steps} of {self.step:g} s"
        yield self._line_of_frequencies()
        if self.damping:
            yield f"damping ratios about the initial state: {damping_in_words(self.damping)}"
        yield from self.moduli
        yield from self.contacts
        yield from self.drifts
        yield from self.motors
        yield f"expected: about {self.seconds:.2g} s, {_megabytes(self.memory)} of memory in all"
        yield f"results: {self.rows} rows, {_megabytes(self.results_size)}"

    def _line_of_frequencies(self) -> str:
        if self.frequencies is None:
            listed = ", ".join(f"{name} {f:.5g}" for name, f in self.free_frequencies.items())
            return f"natural frequencies of the bodies, free [Hz]: {listed or 'not known'}"
        if not len(self.frequencies):
            return "natural frequencies [Hz]: none, nothing is elastic"
        first = ", ".join(f"{f:.5g}" for f in self.frequencies[:MAX_FREQUENCIES])
        about = "linearized about the initial state, without damping, preload and spin"
        return f"natural frequencies, {about} [Hz]: {first}"


def check(model: Model, output: str | PathLike[str] | None = None) -> ModelCheck:
    """Check a model without running it.

    Parameters
    ----------
    model : Model
    output : path, optional
        Where results would be written. Nothing is written.

    Returns
    -------
    ModelCheck
        Its time is measured on some steps from the start, taken in memory. See there for an
        example.

    Raises
    ------
    ModelError
        For all that `simulate` refuses before its first step.
    ConvergenceError
        Where the first steps fail.
    """
    path = None if output is None else Path(output)
    if path is not None:
        check_output(path, model)
    with about(model.path), one_blas_thread():
        lowered, source = lower_to_start(model)
        check_request(lowered)  # as `simulate`: before anything is compiled
        initial = initialize(model, lowered, source)
        lowered = initial.lowered
        contents, rows = contents_of(lowered, ValidityMonitor(lowered)), rows_of(lowered) - 1
        if path is None:
            check_memory(contents, rows)
        vibrating = without_surfaces(initial)
        found, free = vibrations(vibrating), _free_frequencies(model)
        frequencies = None if found is None else found.frequencies
        damped = () if found is None else tuple(damped_motions(vibrating, found))
        contacts = *_contacts(initial), *_surface_contacts(initial)
        motors = tuple(_motors(initial))
        fast = tuple(_fast_servos(initial))
        initial, exchange = start_beside(initial, lowered, source)
        with exchange:
            trial = take_trial(initial, exchange)  # from here on the state is that after some steps
        trial = trial._replace(validity=with_cause(model, initial, trial.validity))
    return ModelCheck(
        bodies=len(model.bodies),
        flexible=len(model.flexible_bodies),
        constraints=int((lowered.system.couplings.compliant == 0).sum()),
        degrees_of_freedom=initial.degrees_of_freedom,
        removed=initial.removed.names,
        assembly_error=initial.assembly_error.opening,
        step=lowered.longest_step,
        steps=lowered.n_steps // lowered.ratio,
        frequencies=frequencies,
        damping=damped,
        free_frequencies=free,
        second_order={name: _second_order(b) for name, b in model.flexible_bodies.items()},
        memory=peak(),
        rows=rows,
        results_size=file_bytes(contents, rows),
        contacts=contacts,
        drifts=tuple(map(str, drifts(lowered, lowered.h * lowered.n_steps))),
        motors=motors,
        moduli=tuple(given_moduli(model)),
        warnings=(
            *initial.warnings,
            *signal_warnings(lowered),
            *_warnings(frequencies, free, lowered.longest_step),
            *fast,
            *_lacks(path, contents, rows),
            *(found.text for found in plausibility_warnings(model)),
            *(f"in the first {trial.steps} steps: {line}" for line in trial.validity.brief()),
        ),
        validity=trial.validity,
        seconds=trial.seconds,
    )


def given_moduli(model: Model) -> Iterator[str]:
    """A line for each flexible body whose moduli are given at a frequency, not at rest.

    Parameters
    ----------
    model : Model

    Yields
    ------
    str

    Examples
    --------
    >>> from duhamel.solver import Model, RigidBody
    >>> list(given_moduli(Model({"ball": RigidBody(1.0, [0.1] * 3)})))
    []
    """
    for name, body in model.flexible_bodies.items():
        modes = body.superelement.modes
        if modes is not None and modes.chain is not None and (words := modes.chain.given_moduli):
            yield f"body {name!r}: {words}"


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.3g} MB"


def _second_order(body: FlexibleBody) -> str:
    if body.rotation is not None:
        return str(body.rotation.r)
    return "none" if body.superelement.rotation is None else "off"


def _free_frequencies(model: Model) -> dict[str, float]:
    """The first frequency of each flexible body alone [Hz], where it has modes."""
    elements = {name: body.superelement for name, body in model.flexible_bodies.items()}
    return {
        name: float(element.modes.frequencies.min())
        for name, element in elements.items()
        if element.modes is not None and len(element.modes.omega)
    }


def _warnings(frequencies: Array | None, free: dict[str, float], h: float) -> Iterator[str]:
    known = list(free.values()) if frequencies is None else frequencies.tolist()
    if known and (steps := 1.0 / (min(known) * h)) < MIN_STEPS_IN_PERIOD:
        yield (
            f"the first frequency, {min(known):.5g} Hz, has {steps:.2g} steps in a period: "
            f"expected {MIN_STEPS_IN_PERIOD} or more, "
            f"simulation.step = {1.0 / (MIN_STEPS_IN_PERIOD * min(known)):.2g}"
        )


def _lacks(path: Path | None, contents: Contents, rows: int) -> Iterator[str]:
    if path is not None and (lack := lack_of_disk(path, contents, rows)):
        yield lack


def _contacts(initial: InitialState) -> Iterator[str]:
    lowered = initial.lowered
    couplings, coordinate = lowered.system.couplings, initial.work.couplings.coordinate
    for j in couplings.contact.tolist():
        row, coupling = couplings.range[j], lowered.model.couplings[j]
        beyond, _ = penetration_of(couplings, row, float(coordinate[row]))
        gap = f"{0.0 - beyond:.4g} {'m' if lowered.measures_lengths[row] else 'rad'}"
        yield f"{coupling.owner}: {coupling.in_words}; gap at the start {gap}"


def _surface_contacts(initial: InitialState) -> Iterator[str]:
    """A line for each contact of surfaces, and one for each island that they are solved in."""
    model, contacts = initial.lowered.model, initial.lowered.system.surfaces.contacts
    rows = np.diff(contacts.row)
    for contact, first, n in zip(model.surface_contacts, contacts.row, rows, strict=False):
        gaps = initial.state.surfaces.gap[first : first + n]
        gap = float(np.min(gaps, initial=np.inf, where=~np.isnan(gaps)))
        start = f"gap at the start {gap:.4g} m" if gap < np.inf else "far from it at the start"
        yield f"{contact.owner}: {contact.in_words}; {n} nodes may close; {start}"
    for first, last in pairwise(contacts.island_range.tolist()):
        own = contacts.island[first:last]
        n = int(rows[own].sum())
        names = ", ".join(model.surface_contacts[c].name for c in own.tolist())
        # W and the factor of its closed part, as they would be with every node closed
        size = initial.work.surfaces.W[0].nbytes + initial.work.surfaces.factor[0].nbytes
        yield (
            f"contacts solved together: {names}; up to {n} unknown forces, "
            f"{_megabytes(size)} for their compliance"
        )


def _motors(initial: InitialState) -> Iterator[str]:
    lowered, motors = initial.lowered, initial.lowered.system.couplings.laws.motors
    for m, motor in enumerate(lowered.model.motors):
        length = bool(lowered.measures_lengths[motors.row[m]])
        torque = float(initial.state.couplings.lam[motors.row[m]])
        line = f"{motor.owner}: {motor.coordinate} of joint {motor.joint!r}; "
        line += f"{torque:.4g} {'N' if length else 'N m'} at the start"
        if pole := float(initial.state.motors.pole[m]):
            line += f"; servo of {pole / (2.0 * np.pi):.4g} Hz"
        yield line


def _fast_servos(initial: InitialState) -> Iterator[str]:
    """A line for each servo whose step is too large, by its fastest pole."""
    lowered = initial.lowered
    for motor, pole in zip(lowered.model.motors, initial.state.motors.pole.tolist(), strict=True):
        turn = pole * lowered.longest_step
        if turn > 2.0 * np.pi / MIN_STEPS_IN_PERIOD:
            yield (
                f"{motor.owner}: its servo has {2.0 * np.pi / turn:.2g} steps in a period: "
                f"expected {MIN_STEPS_IN_PERIOD} or more, "
                f"simulation.step = {2.0 * np.pi / (MIN_STEPS_IN_PERIOD * pole):.2g}"
            )
