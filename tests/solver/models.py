"""Models whose tests vary the mechanism and the settings alike."""

from dataclasses import fields
from typing import Any

from duhamel.solver import Model, Settings

SETTINGS = {field.name for field in fields(Settings)}


def model_of(bodies: Any, joints: Any = (), t_end: float = 1.0, **given: Any) -> Model:
    """A model from fields of `Model` and of `Settings`, told apart by their names."""
    settings = {name: value for name, value in given.items() if name in SETTINGS}
    mechanism = {name: value for name, value in given.items() if name not in SETTINGS}
    return Model(bodies, joints, settings=Settings(t_end=t_end, **settings), **mechanism)
