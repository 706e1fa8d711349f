"""The examples in docstrings run and give what they show."""

import doctest
import importlib
import pkgutil

import duhamel
import pytest

PACKAGES = ("files", "inputs", "superelement", "results", "view", "study")


def modules() -> list[str]:
    """The names of all modules of these packages."""
    return [
        found.name
        for package in PACKAGES
        for found in pkgutil.walk_packages(
            importlib.import_module(f"duhamel.{package}").__path__, f"duhamel.{package}."
        )
    ]


@pytest.mark.parametrize("name", modules())
def test_examples_in_docstrings_run(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert doctest.testmod(importlib.import_module(name)).failed == 0


@pytest.mark.parametrize("package", ["superelement", "results.series", "view"])
def test_public_functions_and_classes_have_an_example(package):
    """But for constants, exceptions, and those that name another one for their example."""
    public = importlib.import_module(f"{duhamel.__name__}.{package}")
    for name in public.__all__:
        if name.isupper():
            continue
        words = getattr(public, name).__doc__
        is_error = isinstance(getattr(public, name), type) and issubclass(
            getattr(public, name), Exception
        )
        assert is_error or ">>>" in words or "for an example" in words, name
