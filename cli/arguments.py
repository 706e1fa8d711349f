"""Arguments that several commands have: files that they read, completed by their suffixes."""

from math import isfinite
from pathlib import Path
from typing import Annotated, Literal

import typer

from .completion import files

HDF5 = (".h5", ".hdf5")
"""suffixes of superelements and of results"""
TOML = ".toml"
"""suffix of body, model and study files"""

ModelFile = Annotated[
    Path,
    typer.Argument(
        metavar="MODEL.toml",
        help="Bodies, joints, loads, simulation.",
        autocompletion=files(TOML),
    ),
]
ResultsFile = Annotated[
    Path,
    typer.Argument(
        metavar="RESULTS.h5",
        help="The results of `duhamel run`.",
        autocompletion=files(*HDF5, ".nc"),
    ),
]
Gravities = Annotated[bool, typer.Option("--g", help="Accelerations in g = 9.80665 m/s².")]


def results_of(model_file: Path) -> Path:
    """The results file of a model unless another is given."""
    return model_file.parent / f"{model_file.stem}-results.h5"


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
