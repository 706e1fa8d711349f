"""The examples in docstrings run and give what they show."""

import doctest
import importlib
import pkgutil
from types import ModuleType

import duhamel
import pytest

PACKAGES = (
    *("files", "inputs", "superelement", "results", "preprocess", "solver", "view", "study"),
    "robots",
)
OF_MPI = "duhamel.preprocess.parallel."  # whose modules need mpi4py


def modules() -> list[str]:
    """The names of all modules of these packages."""
    return [
        found.name
        for package in PACKAGES
        for found in pkgutil.walk_packages(
            importlib.import_module(f"duhamel.{package}").__path__, f"duhamel.{package}."
        )
        if not found.name.startswith(OF_MPI)
    ]


@pytest.mark.parametrize("name", modules())
def test_examples_in_docstrings_run(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert doctest.testmod(importlib.import_module(name)).failed == 0


def names_of(public: ModuleType) -> list[str]:
    """The names that a package exports, or that a module defines for others."""
    own = [n for n, it in vars(public).items() if getattr(it, "__module__", "") == public.__name__]
    return getattr(
        public, "__all__", [n for n in own if not n.startswith("_") and vars(public)[n].__doc__]
    )


@pytest.mark.parametrize(
    "package",
    [
        *("superelement", "results.series", "results.motion", "results.quantities"),
        *("preprocess", "solver", "view", "study", "robots"),
    ],
)
def test_public_functions_and_classes_have_an_example(package):
    """But for constants, exceptions, and those that name another one for their example."""
    public = importlib.import_module(f"{duhamel.__name__}.{package}")
    for name in names_of(public):
        if name.isupper():
            continue
        words = " ".join(getattr(public, name).__doc__.split())
        is_error = isinstance(getattr(public, name), type) and issubclass(
            getattr(public, name), Exception
        )
        assert is_error or ">>>" in words or "for an example" in words, name
