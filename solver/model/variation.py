"""Models with other values of their keys, made in memory and with the same superelements."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...inputs import InputError
from ...inputs.table import read_part
from ...superelement import Superelement
from ..errors import ModelError, about
from ..schema.paths import beside
from .bodies import Body, RigidBody
from .file import document_of_model, model_of_tables, table_of_model
from .model import Model


class Variation:
    """The tables of the file of a model, from which models with other values are made.

    tables: as in a model file, with paths relative to that of the model, and by default those that
    `write_model` writes. Superelements are neither read again nor copied. `ModelError` for what a
    file cannot have, as a function of Python.
    """

    def __init__(self, model: Model, tables: Mapping[str, Any] | None = None) -> None:
        self._path = Path(model.path or "model.toml").absolute()
        folder, self._unnamed = self._path.parent, set[str]()
        self._superelements: dict[Path, Superelement] = {}
        bodies: dict[str, Body] = {}
        for name, body in model.bodies.items():
            if not isinstance(body, RigidBody):
                if not body.source:
                    self._unnamed.add(name)
                    body = replace(body, source=str(folder / f"superelement of {name}"))
                self._superelements[folder / body.source] = body.superelement.base
            bodies[name] = body
        if tables is None:
            with about(model.path), beside(folder):
                tables = document_of_model(replace(model, bodies=bodies), folder)
        self.tables = tables

    def model(self, tables: Mapping[str, Any]) -> Model:
        """The model of changed tables; `ModelError` names the key and the value."""
        with about(self._path), beside(self._path.parent):
            try:
                # Frozen copies are made: the tables of one model cannot change those of another.
                file = read_part(tables, table_of_model(tables))
            except InputError as error:
                raise ModelError(str(error)) from error
            found = model_of_tables(file, self._path, dict(self._superelements))
        # Names of superelements in memory are no files.
        kept = {
            name: replace(body, source="")
            for name, body in found.bodies.items()
            if name in self._unnamed and not isinstance(body, RigidBody)
        }
        return replace(found, bodies={**found.bodies, **kept})
