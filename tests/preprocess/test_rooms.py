"""The order of imports between the rooms of preprocess, and what the three packages may import."""

import ast
import tomllib
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

ROOMS = (
    "errors",
    "threads",
    "memory",
    "progress",
    "mesh",
    "body",
    "elements",
    "given",
    "assembly",
    "sources",
    "responses",
    "estimate",
    "recovery",
    "survey",
    "build",
    "__init__",
)
"""Files and folders of preprocess: each imports from those before it, and from itself."""

MESH = (
    "__init__",
    "cells",
    "mesh",
    "numbering",
    "nodes",
    "facets",
    "connectivity",
    "formats",
    "reading",
)
"""The same within preprocess/mesh."""

PACKAGES = {
    "inputs": set(),
    "superelement": set(),
    "preprocess": {"inputs", "superelement"},
}
"""The other packages that each of these may import."""

Module = tuple[str, ...]


def modules(package: str) -> dict[Module, ast.Module]:
    """Every file of a package, parsed, by its dotted path."""
    return {
        path.relative_to(ROOT).with_suffix("").parts: ast.parse(path.read_text())
        for path in sorted((ROOT / package).rglob("*.py"))
    }


def imported(module: Module, tree: ast.Module) -> Iterator[Module]:
    """The modules of Duhamel that a file imports, also inside functions; a package stands for its
    __init__.
    """
    for node in ast.walk(tree):
        if not isinstance(node, ast.ImportFrom):
            continue
        if node.level:
            base = module[: len(module) - node.level]
        elif (node.module or "").split(".")[0] == "duhamel":
            base = ()
        else:
            continue
        names = (node.module or "").removeprefix("duhamel").strip(".").split(".")
        target = (*base, *filter(None, names))
        if node.module:
            yield file_of(target)
        for alias in node.names:
            # A name may be a module itself: from .formats import gmsh.
            below = (*target, alias.name)
            if ROOT.joinpath(*below).with_suffix(".py").is_file():
                yield below


def file_of(target: Module) -> Module:
    return (*target, "__init__") if ROOT.joinpath(*target).is_dir() else target


def edges(package: str) -> list[tuple[Module, Module]]:
    return [
        (module, target)
        for module, tree in modules(package).items()
        for target in imported(module, tree)
    ]


def upward(edges: list[tuple[Module, Module]], folder: Module, order: tuple[str, ...]) -> list[str]:
    """The imports within a folder that point to a later one of `order`, as text."""
    depth = len(folder)
    found = []
    for module, target in edges:
        if module[:depth] != folder or target[:depth] != folder:
            continue
        here, there = module[depth], target[depth]
        if here != there and order.index(there) > order.index(here):
            found.append(f"{'.'.join(module)} imports {'.'.join(target)}")
    return found


@pytest.mark.parametrize(
    ("folder", "order"),
    [(("preprocess",), ROOMS), (("preprocess", "mesh"), MESH)],
    ids=["preprocess", "preprocess/mesh"],
)
def test_no_import_points_upwards(folder, order):
    depth = len(folder)
    inside = {module[depth] for module in modules("preprocess") if module[:depth] == folder}
    assert inside == set(order), f"the order of {'/'.join(folder)} must name all files and folders"
    assert upward(edges("preprocess"), folder, order) == []


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_import_from_those_below_them_only(package):
    others = [
        f"{'.'.join(module)} imports {'.'.join(target)}"
        for module, target in edges(package)
        if target[0] not in PACKAGES[package] | {package}
    ]
    assert others == []


def test_no_files_import_each_other():
    graph: dict[Module, set[Module]] = {}
    for package in PACKAGES:
        for module, target in edges(package):
            graph.setdefault(module, set()).add(target)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        cycle = " <- ".join(".".join(module) for module in error.args[1])
        pytest.fail(f"files import each other: {cycle}")


@pytest.mark.parametrize("package", PACKAGES)
def test_every_folder_is_in_the_wheel(package):
    """Setuptools takes the packages that are listed, and no others."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    folders = {".".join(("duhamel", *module[:-1])) for module in modules(package)}
    assert folders <= set(settings["tool"]["setuptools"]["packages"])


def test_the_test_finds_what_points_upwards():
    """Else a mistake in reading imports would leave every order kept."""
    wrong = (("preprocess", "mesh", "nodes"), ("preprocess", "body", "body"))
    assert upward([wrong], ("preprocess",), ROOMS) == [
        "preprocess.mesh.nodes imports preprocess.body.body"
    ]
    lazy = "def f():\n    from ..elements.solid import solid_matrices\n"
    assert list(imported(("preprocess", "assembly", "structure"), ast.parse(lazy))) == [
        ("preprocess", "elements", "solid")
    ]
    assert ("preprocess", "mesh", "formats", "gmsh") in dict.fromkeys(
        target for _, target in edges("preprocess")
    )
