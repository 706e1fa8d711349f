"""Loads for static analyses: `duhamel export --to abaqus` and `--to nastran`."""

from collections.abc import Sequence
from pathlib import Path

from .export import Asked, export_format

_DECKS = (
    "forces and moments on flexible bodies at an instant with the inertia that balances them, as "
    "decks for static analyses"
)


@export_format("abaqus", ".inp", _DECKS, takes=("instant",))
def abaqus(asked: Asked) -> Sequence[Path]:
    from ...results import write_loads

    at = asked.at
    return write_loads(asked.results, asked.folder, asked.stem, "abaqus", asked.bodies, at)


@export_format("nastran", ".bdf", _DECKS, takes=("instant",))
def nastran(asked: Asked) -> Sequence[Path]:
    from ...results import write_loads

    at = asked.at
    return write_loads(asked.results, asked.folder, asked.stem, "nastran", asked.bodies, at)
