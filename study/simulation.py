"""Studies of a model file: a case is a run."""

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import h5py

from ..solver import ConvergenceError, ModelError, Results, ResultsError, read_model, simulate
from ..superelement import SuperelementError
from .case import Case
from .digest import digest
from .keys import matching

NO_TIME = 1e-300
"""a run of this length [s] is its start alone"""


@dataclass(frozen=True)
class Simulation:
    paths: ClassVar[tuple[str, ...]] = ("bodies.*.superelement",)
    columns: ClassVar[tuple[str, ...]] = ("seconds", "steps", "iterations")

    @property
    def failures(self) -> tuple[type[Exception], ...]:
        return ModelError, ConvergenceError, ResultsError, SuperelementError, OSError, MemoryError

    def check(self, base: Path, outputs: Mapping[str, str]) -> None:
        """Start the base model, which compiles the time loop, and look whether the results hold the
        outputs.
        """
        # What draws needs a second to load and is no business of the workers.
        from ..view import read
        from .outputs import check

        with tempfile.TemporaryDirectory() as folder:
            results = Path(folder) / "start.h5"
            simulate(read_model(base).with_settings(t_end=NO_TIME), output=results)
            check(read(results), outputs)

    def make(self, case: Case) -> None:
        simulate(read_model(case.source), output=case.target)

    def is_made(self, case: Case) -> bool:
        try:
            with h5py.File(case.target, "r") as file:
                made_from = file.attrs["model"], dict(file["superelements"].attrs)
                return bool(file["solver"].attrs["finished"]) and made_from == (
                    case.text,
                    _superelements(case),
                )
        except (
            OSError,
            KeyError,
            RuntimeError,
        ):  # what h5py raises on a file that is missing or damaged
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
        if outputs:
            from ..view import read
            from .outputs import values

            numbers |= values(read(case.target), outputs)
        return numbers


def _superelements(case: Case) -> dict[str, str]:
    """The digests of the superelements by body, as results files keep them."""
    named = matching(case.document, Simulation.paths)
    return {key.split(".")[1]: digest(case.folder / path) for key, path in named}
