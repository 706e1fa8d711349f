"""A case of a study: a file that runs by itself, and the file that is made from it."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Protocol

import tomli_w


@dataclass(frozen=True)
class Case:
    """One case of a study.

    Parameters
    ----------
    name : str
    parameters : mapping
        By dotted key.
    document : mapping
        The base file with these parameters.
    folder : Path
        Of its files.

    Examples
    --------
    >>> document = {"bodies": {"ball": {"mass": 2.0}}}
    >>> case = Case("1", {"bodies.ball.mass": 2.0}, document, Path("masses"))
    >>> case.source.name, case.target.name
    ('1.toml', '1.h5')
    """

    name: str
    parameters: Mapping[str, Any]
    document: Mapping[str, Any]
    folder: Path

    @property
    def source(self) -> Path:
        """The model or body file of this case."""
        return self.folder / f"{self.name}.toml"

    @property
    def target(self) -> Path:
        """The results or the superelement."""
        return self.folder / f"{self.name}.h5"

    @cached_property
    def text(self) -> str:
        return tomli_w.dumps(self.document)


class Kind(Protocol):
    """The work of a study on the files of its cases, in this process and in workers."""

    paths: ClassVar[tuple[str, ...]]
    """patterns of the dotted keys that hold paths"""
    columns: ClassVar[tuple[str, ...]]
    """the numbers that every case has in the summary"""

    @property
    def failures(self) -> tuple[type[Exception], ...]:
        """The exceptions of a case that are not defects of the program."""

    def check(self, base: Path, outputs: Mapping[str, str]) -> None:
        """Raise one of `failures`, or `StudyError`, for what can be found before any case runs."""

    def size(self, base: Path) -> int:
        """Bytes of the target of a case that is as large as that of the base; 0 if not known."""

    def units(self, case: Case, outputs: Mapping[str, str]) -> dict[str, str]:
        """The units of the outputs, from the target; "" of numbers."""

    def make(self, case: Case) -> None:
        """Make the target from the source."""

    def is_made(self, case: Case) -> bool:
        """True if the target is whole and up to date with the source and all files it names."""

    def numbers(self, case: Case, outputs: Mapping[str, str]) -> dict[str, float]:
        """The values of `columns` and of the outputs, from the target."""
