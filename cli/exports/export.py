"""What an export format is: a function that writes files, and what the command says of it.

Formats are an open set: every file of this folder may hold some.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from ...results import Results
    from ...superelement import Superelement

EXPORT_OPTIONS = {
    "quantities": "quantities",
    "window": "--from and --until",
    "film": "--frames, --all and --magnify",
    "instant": "--at and --body",
    "modes": "--modes",
}
"""what a format may take, and its options as messages name them"""


@dataclass(frozen=True)
class Asked:
    """What a format is asked to write, with the options that it takes."""

    results: "Results"
    folder: Path
    stem: str
    """the name of the results file, without its suffix"""
    rows: slice
    """the recorded steps from --from until --until"""
    quantities: Sequence[str]
    frames: int | None
    every: bool
    magnify: float | None
    at: "float | Literal['worst']"
    bodies: Sequence[str]


Write = Callable[[Asked], Sequence[Path]]


@dataclass(frozen=True)
class ExportFormat:
    """A format of `duhamel export --to NAME`.

    suffix: of its files; what: they are, for the help; takes: keys of `EXPORT_OPTIONS`; write:
    writes the files and gives their paths.
    """

    name: str
    suffix: str
    what: str
    takes: tuple[str, ...]
    write: Write


EXPORTS: dict[str, ExportFormat] = {}
"""all formats by name"""


def export_format(
    name: str, suffix: str, what: str, takes: tuple[str, ...] = ()
) -> Callable[[Write], Write]:
    """Make a function that writes files known to `duhamel export`, see `ExportFormat`."""

    def register(write: Write) -> Write:
        EXPORTS[name] = ExportFormat(name, suffix, what, takes, write)
        return write

    return register


WriteSuperelement = Callable[["Superelement", Path, str, int | None], Sequence[Path]]


@dataclass(frozen=True)
class SuperelementFormat:
    """A format of superelements, not of results.

    endings: of the names of its files, behind the stem; keeps: what it has of the parts that
    others leave out, as the command names them; write:
    takes a superelement, a folder, a stem of names, and the number of --modes; the others are those
    of `ExportFormat`.
    """

    name: str
    endings: tuple[str, ...]
    what: str
    takes: tuple[str, ...]
    keeps: tuple[str, ...]
    write: WriteSuperelement


SUPERELEMENT_EXPORTS: dict[str, SuperelementFormat] = {}
"""all formats of superelements by name"""


def superelement_format(
    name: str,
    endings: tuple[str, ...],
    what: str,
    takes: tuple[str, ...] = (),
    keeps: tuple[str, ...] = (),
) -> Callable[[WriteSuperelement], WriteSuperelement]:
    """Make a function that writes files of a superelement known to `duhamel export`."""

    def register(write: WriteSuperelement) -> WriteSuperelement:
        SUPERELEMENT_EXPORTS[name] = SuperelementFormat(name, endings, what, takes, keeps, write)
        return write

    return register
