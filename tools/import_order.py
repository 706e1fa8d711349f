"""The order of imports between packages and between their rooms, and what the sources import.

A room is a folder of a package, or a file beside the folders. The tests keep the order, and
draw_architecture.py draws it. Sources are parsed, not imported.
"""

import ast
import gc
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

PACKAGES: dict[str, set[str]] = {
    "files": set(),
    "inputs": {"files"},
    "superelement": {"files"},
    "cad": {"files", "superelement"},
    "results": {"files", "superelement"},
    "preprocess": {"files", "inputs", "superelement", "cad"},
    "solver": {"files", "inputs", "superelement", "results"},
    "view": {"files", "superelement", "results"},
    "study": {"files", "inputs", "superelement", "results", "preprocess", "solver"},
    "robots": {"files", "inputs", "superelement", "solver"},
    "fmu": {"files", "inputs", "results", "solver"},
    "cli": {
        *("files", "inputs", "superelement", "results", "preprocess", "solver", "view", "study"),
        *("robots", "fmu", "cad"),
    },
}
"""All packages, and the others that each of them may import, which stand before it."""

ROOMS: dict[str, tuple[str, ...]] = {
    "preprocess": (
        "errors",
        "threads",
        "memory",
        "sparse",
        "progress",
        "processes",
        "mesh",
        "body",
        "elements",
        "given",
        "assembly",
        "sources",
        "solving",
        "responses",
        "rotation",
        "identification",
        "measured",
        "estimate",
        "recovery",
        "derivatives",
        "outline",
        "plausibility",
        "hammer",
        "survey",
        "build",
        "verification",
        "parallel",
        "__init__",
        "__main__",
    ),
    "preprocess/mesh": (
        "__init__",
        "cells",
        "mesh",
        "numbering",
        "nodes",
        "facets",
        "divided",
        "mixed",
        "connectivity",
        "formats",
        "reading",
        "quadratic",
        "writing",
        "in_memory",
    ),
    "fmu": (
        "errors",
        "naming",
        "parameters",
        "variables",
        "segments",
        "image",
        "description",
        "library",
        "archive",
        "export",
        "__init__",
    ),
    "solver": (
        "arrays",
        "errors",
        "compiler",
        "schema",
        "laws",
        "step",
        "signals",
        "couplings",
        "model",
        "history",
        "lower",
        "checkpoint",
        "start",
        "output",
        "diagnosis",
        "phases",
        "cosimulation",
        "plausibility",
        "control",
        "simulation",
        "derivatives",
        "many",
        "trial",
        "inspection",
        "stepper",
        "simulator",
        "linear",
        "__init__",
    ),
}
"""Files and folders of a folder: each imports from those before it, and from itself."""

Module = tuple[str, ...]
"""A file by its path without the suffix: ("solver", "step", "loop")"""
Edge = tuple[Module, Module]
"""a file, and one that it imports"""

AGAINST_THE_ORDER: dict[Edge, str] = {
    (
        ("preprocess", "__main__"),
        ("cli", "__init__"),
    ): "python -m duhamel.preprocess is a command of the command line",
    (
        ("solver", "compiler", "build"),
        ("solver", "step", "__init__"),
    ): "the process that compiles loads all that is to be compiled",
    (
        ("solver", "compiler", "marks"),
        ("solver", "compiler", "object_file"),
    ): "the first call of an entry loads the machine code of all",
}
"""Imports that may point upwards, each within a function, with the reason."""


def modules(package: str, root: Path = ROOT) -> dict[Module, ast.Module]:
    """Every file of a package, parsed."""
    # Trees have no cycles: looking for some takes as long as parsing.
    gc.disable()
    try:
        return {
            path.relative_to(root).with_suffix("").parts: ast.parse(path.read_text("utf-8"))
            for path in sorted((root / package).rglob("*.py"))
        }
    finally:
        gc.enable()


def imported(module: Module, tree: ast.Module) -> Iterator[Module]:
    """The files of Duhamel that a file imports, also inside functions.

    A package stands for its `__init__`.
    """
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                first, *names = alias.name.split(".")
                if first == "duhamel" and names:
                    yield _file(tuple(names))
        elif isinstance(node, ast.ImportFrom):
            yield from _imported_from(module, node)


def _imported_from(module: Module, node: ast.ImportFrom) -> Iterator[Module]:
    names = node.module.split(".") if node.module else []
    if node.level:
        target = (*module[: len(module) - node.level], *names)
    elif names and names[0] == "duhamel":
        target = tuple(names[1:])
    else:
        return
    if node.module and target:
        yield _file(target)
    for alias in node.names:
        # A name may be a module itself: from .formats import gmsh.
        below = (*target, alias.name)
        if _is_folder(below) or ROOT.joinpath(*below).with_suffix(".py").is_file():
            yield _file(below)


def _file(target: Module) -> Module:
    return (*target, "__init__") if _is_folder(target) else target


def _is_folder(target: Module) -> bool:
    return ROOT.joinpath(*target, "__init__.py").is_file()


@cache
def edges(package: str) -> tuple[Edge, ...]:
    """What the files of a package import of Duhamel, once each, but for `AGAINST_THE_ORDER`."""
    found = (
        (module, target)
        for module, tree in modules(package).items()
        for target in imported(module, tree)
    )
    return tuple(edge for edge in dict.fromkeys(found) if edge not in AGAINST_THE_ORDER)


def upward(edges: Iterable[Edge], folder: Module, order: tuple[str, ...]) -> list[str]:
    """The imports within a folder that point to a later room of `order`, as text."""
    depth, found = len(folder), []
    for module, target in edges:
        if module[:depth] != folder or target[:depth] != folder:
            continue
        here, there = module[depth], target[depth]
        if here != there and order.index(there) > order.index(here):
            found.append(as_text(module, target))
    return found


def as_text(module: Module, target: Module) -> str:
    return f"{'.'.join(module)} imports {'.'.join(target).removesuffix('.__init__')}"
