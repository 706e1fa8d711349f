"""Arguments that several commands have: files that they read, completed by their suffixes."""

from pathlib import Path
from typing import Annotated

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
