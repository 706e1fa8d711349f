"""Studies of a body file: a case is a superelement."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from ..preprocess import PreprocessError, build, read_body
from ..superelement import SuperelementError, read, write
from .case import Case
from .digest import digest
from .errors import StudyError
from .keys import matching


@dataclass(frozen=True)
class Preprocessing:
    paths: ClassVar[tuple[str, ...]] = (
        "mesh",
        "matrices.stiffness",
        "matrices.mass",
        "matrices.nodes",
        "matrices.dofs",
        "measured.frf",
        "measured.modes",
        "measured.channels",
        "measured.hits",
        "measured.rigid.from",
        "derivatives.*.mesh",
    )
    columns: ClassVar[tuple[str, ...]] = ("seconds", "mass", "first_frequency", "modes", "error")

    @property
    def failures(self) -> tuple[type[Exception], ...]:
        return PreprocessError, SuperelementError, OSError, MemoryError

    def check(self, base: Path, outputs: Mapping[str, str]) -> None:
        read_body(base)
        if outputs:
            raise StudyError(
                "outputs: expected with a model, whose results they are of, found with a body"
            )

    def size(self, base: Path) -> int:
        return 0

    def units(self, case: Case, outputs: Mapping[str, str]) -> dict[str, str]:
        return {}

    def make(self, case: Case) -> None:
        write(case.target, build(read_body(case.source)))

    def is_made(self, case: Case) -> bool:
        try:
            made_from = read(case.target).provenance
            files = [digest(case.folder / path) for _, path in matching(case.document, self.paths)]
            return (made_from.body, made_from.mesh_sha256) == (case.text, ", ".join(files))
        except (SuperelementError, OSError):
            return False

    def numbers(self, case: Case, outputs: Mapping[str, str]) -> dict[str, float]:
        """first_frequency in Hz; nan where there are no modes."""
        element = read(case.target)
        frequencies = [] if element.modes is None else element.modes.frequencies.tolist()
        return {
            "seconds": sum(element.provenance.timings.values()),
            "mass": element.mass,
            "first_frequency": min(frequencies, default=float("nan")),
            "modes": len(frequencies),
            "error": element.kernel.error,
        }
