"""Packages whose public names are loaded when they are first used, so that importing one is cheap.

An `__init__` lists its names for type checkers under `TYPE_CHECKING`, and for Python here.
"""

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from types import ModuleType


class LazyPackage(ModuleType):
    """A package in which a function may have the name of a submodule."""

    def __setattr__(self, name: str, value: object) -> None:
        # Python binds each submodule to its package when it is loaded. The public function of the
        # same name, such as `solver.start`, stays what the package exports.
        lazy_names: Mapping[str, str] = self.__dict__["_lazy_names"]
        if not (name in lazy_names and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


def lazily_loaded(
    package: str, names_of: Mapping[str, str]
) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a package.

    Parameters
    ----------
    package : str
        Its `__name__`.
    names_of : mapping
        The public names of each submodule, separated by blanks; it is written as in an import,
        ".errors".
    """
    module = sys.modules[package]
    lazy_names = {name: where for where, names in names_of.items() for name in names.split()}
    module.__dict__["_lazy_names"] = lazy_names
    module.__class__ = LazyPackage

    def load(name: str) -> object:
        if name not in lazy_names:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        loaded = import_module(lazy_names[name], package)
        # A name that the submodule does not have stands for the submodule itself.
        found = getattr(loaded, name, loaded)
        # From now on Python finds it without a call.
        module.__dict__[name] = found
        return found

    def names() -> list[str]:
        return sorted({*module.__dict__, *lazy_names})

    return load, names
