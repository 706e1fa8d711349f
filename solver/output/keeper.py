"""The state of a run, kept beside its results from time to time and at its end."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from ...files.outputs import in_words, remove_orphans, replace_durably, resolved
from ...results.batches import Energies
from ...results.file import FileWriter, unfinished
from ...results.source import Writer
from ..checkpoint.carried import Arrays, Snapshot
from ..checkpoint.file import STATE_SUFFIX, StateFile, read_state
from ..checkpoint.identity import Identity, identity_of
from ..errors import ResultsError, StateError
from ..lower.lower import LoweredModel
from ..model.settings import EverySteps, Seconds
from .recorder import Recorder
from .writer import extent_at


class Keeper(Protocol):
    """Keeps the state of a run, or does not."""

    def steps_until_due(self, step: int, n: int) -> int:
        """The number of steps, up to n, that may follow `step` before `step_taken` is due."""

    def step_taken(self, step: int, recorder: Recorder) -> None:
        """Keep the state after this step, if it is time to."""


class NoKeeper:
    def steps_until_due(self, step: int, n: int) -> int:
        return n

    def step_taken(self, step: int, recorder: Recorder) -> None:
        pass


class FileKeeper:
    """Keeps the state in a file, with the rows that belong to it on the disk before.

    A copy in memory is always that of the last step after which the loop returned: it is what is
    kept when the run ends, well or not. Where it cannot be, the file stays as it was. beside: gives
    copies of what else the run carries on.
    """

    def __init__(
        self,
        writer: FileWriter,
        lowered: LoweredModel,
        live: Arrays,
        first: int,
        beside: Callable[[], Arrays],
    ) -> None:
        interval = lowered.model.settings.checkpoint
        self._every = lowered.ratio * interval.every if isinstance(interval, EverySteps) else None
        self._pause = interval.seconds if isinstance(interval, Seconds) else float("inf")
        self._writer, self._lowered, self._live = writer, lowered, live
        self._beside = beside
        self._path = checkpoint_of(writer.place)
        self._identity: Identity | None = None
        self._newest = self._kept = Snapshot(-1, {})
        self._first = first
        self._notes: dict[str, float] = {}
        self._last = time.monotonic()

    def steps_until_due(self, step: int, n: int) -> int:
        return n if self._every is None else min(n, self._every - step % self._every)

    def step_taken(self, step: int, recorder: Recorder) -> None:
        # Copied after every return of the loop: after an interrupt arrays may be those of half a
        # step.
        own = Snapshot.of(step, self._live)
        self._newest = own._replace(arrays={**own.arrays, **self._beside()})
        self._notes = recorder.start._asdict() | {"first": float(self._first)}
        # The first state is kept at once, or a run killed early could not go on.
        none = self._kept.step < 0
        by_time = time.monotonic() - self._last > self._pause
        if none or by_time or (self._every is not None and step % self._every == 0):
            # Rows before the state: a state whose rows are lost could not be continued.
            recorder.flush()
            self._keep()

    def _keep(self) -> None:
        """Write the newest state, if all rows up to it are on the disk."""
        # Nothing is new, or the disk does not have what belongs to it.
        if self._newest.step in (-1, self._kept.step) or not self._are_on_disk(self._newest):
            return
        # Digests of superelements take a while, and stay the same.
        self._identity = self._identity or identity_of(self._lowered)
        without = tuple(sorted(self._lowered.without))
        state = StateFile(self._newest, self._identity, self._writer.run, without, self._notes)
        try:
            state.write(self._path)
        except OSError as error:
            raise ResultsError(
                f"{self._path}: cannot be written: {in_words(error)}; "
                f"the state of step {max(self._kept.step, 0)} stays"
            ) from error
        self._kept, self._last = self._newest, time.monotonic()

    def _are_on_disk(self, state: Snapshot) -> bool:
        """Whether the rows and events up to a state are."""
        extent = extent_at(state, self._first, self._lowered)
        return all(n >= m for n, m in zip(self._writer.committed, extent, strict=True))

    def __enter__(self) -> "FileKeeper":
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if not self._writer.place.exists():
            forget_checkpoint(self._writer)  # of a run that was abandoned
        elif not isinstance(error, ResultsError):  # the disk is full
            self._keep()


def checkpoint_of(file: Path) -> Path:
    """The file of the state that belongs to results."""
    return file.with_name(file.name + STATE_SUFFIX)


def read_checkpoint(path: Path) -> StateFile:
    """The state of the last run to a path; `StateError` if there is none."""
    file = unfinished(resolved(path))
    state = checkpoint_of(file)
    if not file.exists():
        raise StateError(f"{file}: no such file: there is no run to continue")
    if not state.exists():
        raise StateError(
            f"{state}: no such file: the run saved no state: set [simulation] checkpoint"
        )
    return read_state(state)


def forget_checkpoint(writer: Writer) -> None:
    """Remove the state of an earlier run that had the file of this one."""
    if isinstance(writer, FileWriter):
        checkpoint_of(writer.place).unlink(missing_ok=True)


def settle_checkpoint(writer: Writer) -> None:
    """Let the state of a run that ends well follow its results; that of an earlier run goes."""
    if not isinstance(writer, FileWriter):
        return
    own, later = checkpoint_of(writer.place), checkpoint_of(writer.target)
    # Before the early return: orphans lie there in either case.
    remove_orphans(later)  # of a run that was killed while it wrote its state
    if own == later:
        return
    try:
        if own.exists():
            replace_durably(own, later)
        else:
            later.unlink(missing_ok=True)
    except OSError as error:
        raise ResultsError(f"{later}: cannot be written: {in_words(error)}") from error


def start_of(state: StateFile) -> tuple[int, Energies]:
    """The step and the energies at the start of the run."""
    energies = Energies(*(state.notes[name] for name in Energies._fields))
    return int(state.notes["first"]), energies
