"""A case of a study: a file like any other, which runs by itself, and the file that is made from
it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Protocol

import tomli_w


@dataclass(frozen=True)
class Case:
    """Parameters by dotted key, and the document, which is the base file with these in place; both
    files by name.
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
    """What a study does with the files of its cases. The same class does it in this process and in
    workers.
    """

    paths: ClassVar[tuple[str, ...]]
    """patterns of the dotted keys that hold paths"""
    columns: ClassVar[tuple[str, ...]]
    """the numbers that every case has in the summary"""

    @property
    def failures(self) -> tuple[type[Exception], ...]:
        """What a case may raise that is no defect of the program."""

    def check(self, base: Path, outputs: Mapping[str, str]) -> None:
        """Raise one of `failures`, or `StudyError`, for what can be found before any case runs."""

    def make(self, case: Case) -> None:
        """From source to target."""

    def is_made(self, case: Case) -> bool:
        """Whether the target is whole, and made from the present contents of the source and of all
        files it names.
        """

    def numbers(self, case: Case, outputs: Mapping[str, str]) -> dict[str, float]:
        """The values of `columns` and of the outputs, from the target."""
