"""The commands, an open set: each is a file of this folder, with a function of the file's name.

Its docstring and its arguments are the help; those that several commands have are in arguments.py.
A command that is a word of Python has an underscore after it there: import_. An underscore within a
name is the hyphen of its command: bug_report.
Commands are imported to show the help of all, so they import what they need when they are called.
"""

from collections.abc import Callable
from importlib import import_module
from keyword import iskeyword
from pathlib import Path
from typing import Any

# The help has all others after these.
HELP_ORDER = (
    *("preprocess", "run", "sweep", "peaks", "explain", "info", "check"),
    *(
        "plot",
        "report",
        "animate",
        "export",
        "modes",
        "frf",
        "campbell",
        "unbalance",
        "fmu",
        "init",
        "import",
    ),
    *("tutorial", "demo", "schema", "bug-report"),
)


def command_names() -> list[str]:
    """The names of all commands."""
    names = {
        path.stem.removesuffix("_").replace("_", "-")
        for path in Path(__file__).parent.glob("[!_]*.py")
    }
    return [*HELP_ORDER, *sorted(names.difference(HELP_ORDER))]


def command_of(name: str) -> Callable[..., Any]:
    """The function of a command."""
    function_name = f"{name}_" if iskeyword(name) else name.replace("-", "_")
    module = import_module(f"{__name__}.{function_name}")
    function: Callable[..., Any] = getattr(module, function_name)
    return function
