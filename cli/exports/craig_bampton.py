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
FILE_ENDINGS = ("-reduced.npz", "-reduced.op4", "-reduced.pch", "-reduced.bdf")


@superelement_format(
    "craig-bampton",
    FILE_ENDINGS,
    "the matrices of a superelement, as arrays, OUTPUT4 and DMIG for Nastran",
)
def reduced_matrices(
    e: "Superelement", folder: Path, stem: str, modes: int | None
) -> Sequence[Path]:
    import numpy as np

    from ...results.exports.folder import exported
    from ...superelement.craig_bampton import in_craig_bampton_form
    from ...superelement.reduced_files import (
        ReducedModel,
        write_arrays,
        write_deck,
        write_dmig,
        write_op4,
    )

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
    arrays, op4, dmig, deck = (f"{stem}{ending}" for ending in FILE_ENDINGS)
    with exported(folder) as export:
        with export.file(arrays) as path:
            write_arrays(model, path)
        with export.file(op4) as path:
            write_op4(model, OP4_NAMES, path)
        with export.file(dmig) as path:
            write_dmig(model, DMIG_NAMES, path)
        with export.file(deck) as path:
            write_deck(model, path)
    return export.paths
