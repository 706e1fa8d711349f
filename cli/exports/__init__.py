"""The formats of `duhamel export`, an open set: every file of this folder may hold some.

export.py says what a format is. Help, completion and what is refused follow from `EXPORTS`.
"""

from importlib import import_module
from itertools import groupby
from pkgutil import iter_modules

from .export import (
    EXPORT_OPTIONS,
    EXPORTS,
    SUPERELEMENT_EXPORTS,
    Asked,
    ExportFormat,
    SuperelementFormat,
)

__all__ = [
    "EXPORTS",
    "EXPORT_OPTIONS",
    "SUPERELEMENT_EXPORTS",
    "Asked",
    "described",
    "takers",
]

# Files in the order of the help, which has all others after these.
FORMAT_ORDER = ("vtk", "csv", "mat", "loads")

_names = sorted(module.name for module in iter_modules(__path__))
for _module in (*FORMAT_ORDER, *(name for name in _names if name not in FORMAT_ORDER)):
    import_module(f"{__name__}.{_module}")


def described() -> str:
    """What each format writes, in one paragraph."""
    formats = [(each.name, each.what) for each in EXPORTS.values()]
    formats += [(each.name, each.what) for each in SUPERELEMENT_EXPORTS.values()]
    alike = groupby(formats, key=lambda each: each[1])
    return " ".join(f"{', '.join(name for name, _ in some)}: {what}." for what, some in alike)


def takers(option: str) -> str:
    """The formats that take an option of `EXPORT_OPTIONS`, as text."""
    formats: list[ExportFormat | SuperelementFormat] = [
        *EXPORTS.values(),
        *SUPERELEMENT_EXPORTS.values(),
    ]
    *others, last = [each.name for each in formats if option in each.takes]
    return f"{', '.join(others)} or {last}" if others else last
