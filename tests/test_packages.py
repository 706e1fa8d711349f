"""The order of imports between packages, and what the wheel holds of them."""

import ast
import subprocess
import sys
import tomllib
from graphlib import CycleError, TopologicalSorter

import pytest
from import_order import (
    AGAINST_THE_ORDER,
    PACKAGES,
    ROOMS,
    ROOT,
    as_text,
    edges,
    imported,
    modules,
    upward,
)

SETUPTOOLS = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]

DEFINITIONS = ast.FunctionDef | ast.ClassDef


def test_a_package_imports_from_packages_before_it():
    order = list(PACKAGES)
    for i, package in enumerate(order):
        assert PACKAGES[package] <= set(order[:i])


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_import_from_those_below_them_only(package):
    allowed = PACKAGES[package] | {package}
    assert [as_text(*edge) for edge in edges(package) if edge[1][0] not in allowed] == []


def test_no_files_import_each_other():
    graph: dict[tuple[str, ...], set[tuple[str, ...]]] = {}
    for package in PACKAGES:
        for module, target in edges(package):
            graph.setdefault(module, set()).add(target)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        cycle = " <- ".join(".".join(module) for module in error.args[1])
        pytest.fail(f"files import each other: {cycle}")


@pytest.mark.parametrize(("module", "target"), AGAINST_THE_ORDER)
def test_imports_against_the_order_stand_within_functions(module, target):
    """They load nothing when a file is imported; and none is listed that is gone."""
    tree = modules(module[0])[module]
    top = ast.Module([node for node in tree.body if not isinstance(node, DEFINITIONS)], [])
    assert target in set(imported(module, tree)) - set(imported(module, top))


@pytest.mark.parametrize("package", PACKAGES)
def test_every_folder_is_in_the_wheel(package):
    """Setuptools takes the packages that are listed, and no others."""
    folders = {".".join(("duhamel", *module[:-1])) for module in modules(package)}
    assert folders <= set(SETUPTOOLS["packages"])


def test_every_package_has_a_place_in_the_order():
    """But the one that they are all in, the folder `top`."""
    named = {name.split(".")[1] for name in SETUPTOOLS["packages"] if name != "duhamel"}
    assert named == set(PACKAGES)


def test_the_package_that_all_are_in_imports_the_commands_to_run_them_alone():
    packages = {*PACKAGES} - {"study", "robots", "cli"}
    # a part is drawn as the dry run draws it; a mechanism is fitted and optimized as studies are
    commands = {"__main__": {"cli"}, "parts": {*packages, "cli"}}
    commands |= {key: {*packages, "study"} for key in ("mechanism", "varied", "__init__")}
    for module, tree in modules("top").items():
        found = {target[0] for target in imported(module, tree)} & {*PACKAGES}
        assert found <= commands.get(module[-1], packages), module


def test_importing_the_package_that_all_are_in_loads_nothing():
    """Names are loaded when they are first used, so that `import duhamel` takes no time."""
    code = "import sys, duhamel; print([n for n in sys.modules if n.startswith('duhamel.')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("text", "target"),
    [
        ("def f():\n    from ..elements.solid import solid_matrices\n", "elements.solid"),
        ("from .. import build\n", "build"),
        ("from ..mesh import formats\n", "mesh.formats.__init__"),
        ("from duhamel.preprocess.mesh import cells\n", "mesh.cells"),
        ("import duhamel.preprocess.mesh.cells\n", "mesh.cells"),
    ],
)
def test_every_form_of_import_is_seen(text, target):
    """Else a mistake in reading imports would leave every order kept."""
    found = imported(("preprocess", "assembly", "structure"), ast.parse(text))
    assert ("preprocess", *target.split(".")) in found


def test_what_points_upwards_is_found():
    wrong = (("preprocess", "mesh", "nodes"), ("preprocess", "body", "body"))
    assert upward([wrong], ("preprocess",), ROOMS["preprocess"]) == [
        "preprocess.mesh.nodes imports preprocess.body.body"
    ]


def test_every_package_of_the_makefile_is_in_the_wheel():
    lines = (ROOT / "Makefile").read_text().splitlines()
    (listed,) = (line for line in lines if line.startswith("PACKAGES"))
    folders = set(SETUPTOOLS["package-dir"].values())
    assert {"top", *listed.split(":=")[1].split()} == folders
