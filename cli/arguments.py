"""Arguments that several commands take, and the names of the files that they write."""

from math import isfinite
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import typer

from .completion import files

Number = TypeVar("Number", int, float)

# Of superelements and of results.
HDF5_SUFFIXES = (".h5", ".hdf5")
RESULTS_SUFFIXES = (*HDF5_SUFFIXES, ".nc")
# Of body, model and study files.
TOML_SUFFIX = ".toml"


def file_argument(metavar: str, help_text: str, *suffixes: str) -> Any:
    """A file that a command reads, which shells complete by its suffixes."""
    return typer.Argument(metavar=metavar, help=help_text, autocompletion=files(*suffixes))


def output_option(metavar: str, help_text: str | None = None) -> Any:
    """The file or folder that a command writes."""
    return typer.Option("--output", "-o", metavar=metavar, help=help_text)


ModelFile = Annotated[
    Path, file_argument("MODEL.toml", "Bodies, joints, loads, simulation.", TOML_SUFFIX)
]
ModelStudy = Annotated[
    Path, file_argument("STUDY.toml", "A model, its parameters and outputs.", TOML_SUFFIX)
]
ResultsFile = Annotated[
    Path, file_argument("RESULTS.h5", "The results of `duhamel run`.", *RESULTS_SUFFIXES)
]
Gravities = Annotated[bool, typer.Option("--g", help="Accelerations in g = 9.80665 m/s².")]
Title = Annotated[
    str | None, typer.Option(metavar="TEXT", help="The name of the file, unless given.")
]
FromTime = Annotated[
    float | None, typer.Option("--from", metavar="SECONDS", help="From this time.")
]
# `export` has --to for its format, so --until is the name that all commands know.
ToTime = Annotated[
    float | None, typer.Option("--to", "--until", metavar="SECONDS", help="Up to this time.")
]


def beside(file: Path, suffix: str, what: str = "") -> Path:
    """The file that a command writes unless another is named: FILE-WHAT.SUFFIX beside its input.

    what: tells outputs of one kind from one another, so that no command replaces the file of
    another one.
    """
    return file.with_name(f"{file.stem}-{what}{suffix}" if what else f"{file.stem}{suffix}")


def results_of(model_file: Path) -> Path:
    """The results file of a model unless another is given."""
    return beside(model_file, HDF5_SUFFIXES[0], "results")


def time_or_worst(at: str | None) -> "float | Literal['worst']":
    """What --at says: a time [s], or "worst", which it is unless given."""
    if at is None or at == "worst":
        return "worst"
    try:
        time = float(at)
    except ValueError:
        time = float("nan")
    if not isfinite(time):
        raise typer.BadParameter(f"--at: expected a time [s] or worst, found {at!r}")
    return time


def size_of(
    text: str | None, number: type[Number], least: Number, most: Number, as_in: str
) -> tuple[Number, Number] | None:
    """Width and height of "1280x720", as pixels or inches from `least` to `most`."""
    if text is None:
        return None
    try:
        width, height = map(number, text.lower().split("x"))
    except ValueError:
        width = height = number(-1)
    if not (least <= width <= most and least <= height <= most):
        raise typer.BadParameter(
            f"--size: expected WIDTHxHEIGHT from {least:g} to {most:g} {as_in}, found {text!r}"
        )
    return width, height
