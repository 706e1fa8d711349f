"""The commands, an open set: each is a file of this folder, with a function of the file's name.

Its docstring and its arguments are the help; those that several commands have are in arguments.py.
Commands are imported to show the help of all, so they import what they need when they are called.
"""

from collections.abc import Callable, Iterator
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

HELP_ORDER = (
    "preprocess",
    "run",
    "sweep",
    "peaks",
    "explain",
    "info",
    "check",
    "plot",
    "report",
    "animate",
    "export",
    "modes",
    "frf",
    "campbell",
    "init",
    "schema",
)
"""which has all others after these"""


def all_commands() -> Iterator[Callable[..., Any]]:
    """The functions of all commands."""
    names = sorted(module.name for module in iter_modules(__path__))
    for name in (*HELP_ORDER, *(name for name in names if name not in HELP_ORDER)):
        yield getattr(import_module(f"{__name__}.{name}"), name)
