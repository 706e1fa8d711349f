"""MATLAB: `duhamel export --to mat`."""

from collections.abc import Sequence
from pathlib import Path

from .export import Asked, export_format


@export_format("mat", ".mat", "all that was recorded, for MATLAB", takes=("window",))
def mat(asked: Asked) -> Sequence[Path]:
    from ...results import write_mat

    return (write_mat(asked.results, asked.folder / f"{asked.stem}.mat", asked.rows),)
