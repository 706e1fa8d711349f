"""Studies of a model file: a case is a run."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from ..results import Results, ResultsError
from ..solver import (
    ConvergenceError,
    MissedContactError,
    ModelError,
    OutOfRangeError,
    StateError,
    read_model,
    simulate,
    start,
)
from ..solver import check as solver_check
from ..superelement import SuperelementError
from .case import Case
from .digest import digest
from .keys import matching
from .outputs import check, units, values

SUPERELEMENT_KEYS = "bodies.*.superelement"
# Signals that are columns of files.
SIGNAL_FILE_KEYS = "*.file"


@dataclass(frozen=True)
class Simulation:
    paths: ClassVar[tuple[str, ...]] = (
        SUPERELEMENT_KEYS,
        "simulation.start.from",
        SIGNAL_FILE_KEYS,
    )
    columns: ClassVar[tuple[str, ...]] = ("seconds", "steps", "iterations")

    @property
    def failures(self) -> tuple[type[Exception], ...]:
        return (
            ModelError,
            StateError,
            ConvergenceError,
            MissedContactError,
            OutOfRangeError,
            ResultsError,
            SuperelementError,
            OSError,
            MemoryError,
        )

    def check(self, base: Path, outputs: Mapping[str, str]) -> None:
        """Start the base model, and check that its results have the outputs.

        This compiles the time loop before any case runs.
        """
        check(start(read_model(base)), outputs)

    def size(self, base: Path) -> int:
        try:
            return solver_check(read_model(base)).results_size
        except self.failures:  # of its first steps, which cases need not share
            return 0

    def units(self, case: Case, outputs: Mapping[str, str]) -> dict[str, str]:
        return units(Results.read(case.target), outputs)

    def make(self, case: Case) -> None:
        simulate(read_model(case.source), output=case.target)

    def is_made(self, case: Case) -> bool:
        try:
            results = Results.read(case.target)
            files = results.superelement_files
            made_from = {body: file.digest for body, file in files.items()}
            finished = bool(results.solver["finished"])
            if not finished or results.solver.get("records", "") != _records(case):
                return False
            return (results.model, made_from) == (case.text, _superelements(case))
        except (ResultsError, OSError, KeyError):  # missing, damaged, or of another version
            return False

    def numbers(self, case: Case, outputs: Mapping[str, str]) -> dict[str, float]:
        results = Results.read(case.target)
        steps = int(results.solver["steps"])
        iterations = float(results.iterations[1:].mean()) if steps else 0.0
        numbers = {
            "seconds": float(results.solver["seconds"]),
            "steps": steps,
            "iterations": iterations,
        }
        return numbers | values(results, outputs)


def _superelements(case: Case) -> dict[str, str]:
    """The digests of the superelements of flexible bodies, as results files keep them."""
    return {name: digest(path) for name, path in _bodies(case, rigid=False)}


def _bodies(case: Case, rigid: bool) -> Iterator[tuple[str, Path]]:
    """The bodies with a superelement that are rigid, or those that are flexible, and its file."""
    for key, path in matching(case.document, [SUPERELEMENT_KEYS]):
        name = key.split(".")[1]
        if bool(case.document["bodies"][name].get("rigid", False)) == rigid:
            yield name, case.folder / path


def _records(case: Case) -> str:
    """The digests of the other files that it is made from, as the notes of a run keep them.

    Those of recorded signals, and the superelements of rigid bodies.
    """
    named = {digest(case.folder / path) for _, path in matching(case.document, [SIGNAL_FILE_KEYS])}
    named |= {digest(path) for _, path in _bodies(case, rigid=True)}
    return " ".join(sorted(named))
