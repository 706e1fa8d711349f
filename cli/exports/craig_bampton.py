"""Reduced matrices of a superelement: `duhamel export SUPERELEMENT --to craig-bampton`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .export import superelement_format

if TYPE_CHECKING:
    from ...superelement import Superelement

OP4_NAMES = {"stiffness": "KXX", "mass": "MXX", "damping": "BXX"}
DMIG_NAMES = {"stiffness": "KAAX", "mass": "MAAX", "damping": "BAAX"}
"""as Nastran names those of an external superelement"""
# Beside a superelement there often are the files of its mesh, of its plain name.
ARRAYS, OP4, DMIG, DECK = ENDINGS = tuple(f"-reduced{s}" for s in (".npz", ".op4", ".pch", ".bdf"))


@superelement_format(
    "craig-bampton",
    ENDINGS,
    "the matrices of a superelement, as arrays, OUTPUT4 and DMIG for Nastran",
)
def reduced_matrices(e: "Superelement", folder: Path, stem: str) -> Sequence[Path]:
    import numpy as np

    from ...preprocess.given.reduced_files import (
        ReducedModel,
        write_arrays,
        write_deck,
        write_dmig,
        write_op4,
    )
    from ...results.exports.folder import exported
    from ...superelement.craig_bampton import in_craig_bampton_form

    # Other codes have the points where the mesh has them.
    reduced = in_craig_bampton_form(e)
    model = ReducedModel(
        e.name,
        [interface.name for interface in e.interfaces],
        np.array([interface.X for interface in e.interfaces]).reshape(-1, 3) + e.center,
        [interface.rotations for interface in e.interfaces],
        {"stiffness": reduced.K, "mass": reduced.M, "damping": reduced.C},
        reduced.omega / (2.0 * np.pi),
    )
    with exported(folder) as export:
        with export.file(f"{stem}{ARRAYS}") as path:
            write_arrays(model, path)
        with export.file(f"{stem}{OP4}") as path:
            write_op4(model, OP4_NAMES, path)
        with export.file(f"{stem}{DMIG}") as path:
            write_dmig(model, DMIG_NAMES, path)
        with export.file(f"{stem}{DECK}") as path:
            write_deck(model, path)
    return export.paths
