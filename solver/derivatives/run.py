"""A run whose numbers have derivatives by parameters: what it records, beside the values."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...results.batches import STORED_ENERGIES
from ..arrays import Array, Index
from ..compiler.targets import DERIVATIVE_COUNTS
from ..errors import DerivativeError
from ..lower.allocation import make_output
from ..lower.lower import LoweredModel
from ..output.events import EVENT_COLUMNS
from ..step.record import record
from ..step.system import Inputs, Run
from .records import DualRecord, entry_symbol, entry_with_derivatives
from .scope import user_laws
from .seeds import Seeds, Start
from .steps import DualConvolution, DualPhases, live_state

ROWS_AT_ONCE = 256
"""steps between which those rows are kept that are asked for; all of them are recorded before"""
TOUCHING_GAP = 1e-9
"""gap at the start, over the size of what it meets, at which a row of a surface is closed"""
STATES_OF_LAWS = ("contact_state", "friction_state", "motor_state")
"""arrays of `Output` that tell whether something switched"""
EVENT_ARRAYS = ("n_events", "event_contact", "event")
WHILE_CLOSED = {
    "start": "begin",
    "peak": "peak",
    "impulse": "impulse",
    "closing_speed": "closing_speed",
}
"""numbers of an event that a contact has which is still closed, by their arrays in the state"""


@dataclass(frozen=True, eq=False)
class DualRun:
    """Rows and events of a run, each number followed by its derivatives.

    lowered: the model; steps (n,): of the rows; arrays (n, ..., 1 + k): by their names in `Output`;
    owners (m,), events (m, 9, 1 + k): as in `EventRows`; switches: whether a contact, a row of a
    surface, friction or the limit of a motor changed its state in any step.
    """

    lowered: LoweredModel
    steps: Index
    arrays: Mapping[str, Array]
    owners: Index
    events: Array
    switches: bool


def recorded_rows(lowered: LoweredModel) -> Index:
    """The row of each step from the first on, -1: none; row 0 is that of the start."""
    n = lowered.n_steps
    steps = np.arange(1, n + 1)
    recorded = (steps % lowered.model.settings.output.every == 0) | (steps == n)
    return np.where(recorded, np.cumsum(recorded), -1)


def run_with_derivatives(start: Start, seeds: Sequence[Seeds], names: Iterable[str]) -> DualRun:
    """Take all steps of a run, with derivatives by the parameters of some seeds.

    names: the arrays of `Output` that are kept. `DerivativeError` where it fails.
    """
    k, lowered, initial = count_for(len(seeds)), start.lowered, start.initial
    output = make_output(lowered, ROWS_AT_ONCE)
    plain = Run(system=lowered.system, state=initial.state, work=initial.work, output=output)
    run = flight = DualRecord(plain, k, _joined(seeds, k, ("system", "state", "work")))
    if lowered.flight is not None:
        of_flight = _joined(seeds, k, ("flight",), "system/")
        flight = DualRecord(plain.replace(system=lowered.flight), k, of_flight, beside=run)
    _set_functions(lowered, run, k)
    phases = DualPhases(lowered, plain, (run, flight), k, _joined(seeds, k, ("inputs",), ""))
    convolution = DualConvolution(lowered, run.arrays["system/elastic/kernels/g"])
    surfaces = bool(lowered.model.surface_contacts)
    entry_with_derivatives(entry_symbol(record), k, surfaces)(run, 0)
    kept = _Kept(run, tuple(dict.fromkeys((*names, *STORED_ENERGIES))))
    kept.take_rows(np.zeros(1, dtype=np.int64), np.ones(1, dtype=bool))
    done, total, every = 0, lowered.n_steps, lowered.model.settings.output.every
    # The rows of surfaces have their states in scratch alone, which each step makes anew.
    at_once = 1 if surfaces else ROWS_AT_ONCE
    while done < total:
        stride, n = phases.begin(convolution.steps_until_due(done, total - done))
        steps = done + stride * np.arange(1, min(n, at_once) + 1)
        taken, _, failed = phases.advance(_recorded(start.inputs, steps))
        # In long steps `every` counts these.
        steps = steps[:taken]
        kept.take_rows(steps, (steps % (every * stride) == 0) | (steps == total))
        kept.follow_surfaces()
        # It returns early where its list of events is full.
        if not kept.take_events() and failed:
            raise DerivativeError(
                f"with derivatives, Newton's method does not converge in step {done + taken + 1}"
            )
        done += stride * taken
        convolution.update(live_state(run))
    return kept.run(lowered)


def _set_functions(lowered: LoweredModel, run: DualRecord, k: int) -> None:
    """Let laws of users call their functions with derivatives."""
    parameters = run.arrays["system/couplings/laws/parameters"]
    for law in user_laws(lowered):
        parameters[law.places, 0] = law.addresses_with_derivatives(k)


def count_for(n: int) -> int:
    """The derivatives that numbers have for so many parameters."""
    return next(count for count in DERIVATIVE_COUNTS if count >= n)


class _Kept:
    """What is kept of a run: some arrays of its rows, and its events."""

    def __init__(self, run: DualRecord, names: Sequence[str]) -> None:
        self._run = run
        self._steps: list[Index] = []
        self._rows: dict[str, list[Array]] = {name: [] for name in names}
        self._owners: list[Index] = []
        self._events: list[Array] = []
        self._states: dict[str, Array] = {}
        self._switches = False
        contacts, surfaces = "system/surfaces/contacts", "state/surfaces"
        rows = np.diff(run.arrays[f"{contacts}/row"])
        sizes = np.repeat(run.arrays[f"{contacts}/size"][:, 0], rows)
        touches = run.arrays[f"{surfaces}/gap"][: len(sizes), 0] <= TOUCHING_GAP * sizes
        self._closed = run.arrays["work/surfaces/closed"].copy()
        self._any_state = touches & (self._closed == 0)

    def take_rows(self, steps: Index, recorded: NDArray[np.bool_]) -> None:
        """Keep those of the first rows of the output that are recorded; of which steps they are."""
        self._steps.append(steps[recorded])
        output = {
            name: self._run.arrays[f"output/{name}"] for name in (*self._rows, *STATES_OF_LAWS)
        }
        for name, rows in self._rows.items():
            rows.append(output[name][: len(steps)][recorded])
        for name in STATES_OF_LAWS:
            # From the last row of the rows before.
            states = np.concatenate(
                [self._states.get(name, output[name][:1]), output[name][: len(steps)]]
            )
            self._switches |= bool((states[1:] != states[:-1]).any())
            self._states[name] = states[-1:].copy()

    def follow_surfaces(self) -> None:
        """Note whether rows of surfaces open or close, stick or slip in the last step."""
        closed = self._run.arrays["work/surfaces/closed"]
        self._switches |= bool(((closed != self._closed) & ~self._any_state).any())
        self._closed[:], self._any_state[:] = closed, False

    def take_events(self) -> int:
        """Take the events that wait, and forget them there: how many."""
        state = {name: self._run.arrays[f"state/contacts/{name}"] for name in EVENT_ARRAYS}
        n = int(state["n_events"][0])
        self._owners.append(state["event_contact"][:n].copy())
        self._events.append(state["event"][:n].copy())
        state["n_events"][0] = 0
        return n

    def run(self, lowered: LoweredModel) -> "DualRun":
        """All that was kept; contacts that are still closed are the last events."""
        self._take_unfinished(lowered)
        return DualRun(
            lowered,
            np.concatenate(self._steps),
            {name: np.concatenate(rows) for name, rows in self._rows.items()},
            np.concatenate(self._owners),
            np.concatenate(self._events),
            # A contact may open again before the row of its step.
            self._switches or any(map(len, self._owners[:-1])),
        )

    def _take_unfinished(self, lowered: LoweredModel) -> None:
        arrays = self._run.arrays
        closed = np.flatnonzero(arrays["state/contacts/steps"])
        shape = arrays["state/contacts/event"].shape
        events = np.full((len(closed), *shape[1:]), np.nan)
        for name, source in WHILE_CLOSED.items():
            events[:, EVENT_COLUMNS.index(name)] = arrays[f"state/contacts/{source}"][closed]
        for name, number in (
            ("end", lowered.h * arrays["state/step"][0]),
            ("steps", arrays["state/contacts/steps"][closed]),
        ):
            events[:, EVENT_COLUMNS.index(name)] = 0.0
            events[:, EVENT_COLUMNS.index(name), 0] = number
        self._owners.append(closed.astype(np.int64))
        self._events.append(events)


def _joined(
    seeds: Sequence[Seeds], k: int, parts: Sequence[str], prefix: str = "{}/"
) -> dict[str, Array]:
    """The seeds of all parameters (..., k) by the names of arrays; zeros beyond the last."""
    found: dict[str, Array] = {}
    for i, one in enumerate(seeds):
        for part in parts:
            for name, array in one.arrays[part].items():
                key = f"{prefix.format(part)}{name}"
                if key not in found:
                    found[key] = np.zeros((*array.shape, k))
                found[key][..., i] = array
    return found


def _recorded(inputs: Inputs, steps: Index) -> Inputs:
    """The signals of some steps, each of which is recorded in the next row."""
    at = steps - 1
    return inputs.replace(
        load=inputs.load[at],
        drive=inputs.drive[at],
        motor=inputs.motor[at],
        row=np.arange(len(steps)),
    )
