"""Packages that are loaded where they are needed, and not before."""

import ast
import subprocess
import sys
from importlib import import_module

import pytest
from import_order import ROOT

LAZY_PACKAGES = "results", "solver", "superelement"

HEAVY_PACKAGES = {
    *("skfem", "meshio", "matplotlib", "rslab", "scipy", "numba", "llvmlite", "pyvista"),
    *("rich.progress", "jinja2", "PIL", "numpy.ma", "numpy.random"),
}
"""those that neither the solver nor a start of the command line needs"""
ALL_PACKAGES = HEAVY_PACKAGES | {"numpy", "h5py", "pydantic", "threadpoolctl"}


def loaded_by(code: str) -> set[str]:
    """The modules that a new process has loaded after some code."""
    program = f"import sys\n{code}\nprint(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return set(run.stdout.splitlines()[-1].split())


def test_the_solver_itself_loads_what_lists_its_names_alone():
    found = loaded_by("from duhamel import solver")
    assert not ALL_PACKAGES & found
    assert {name for name in found if name.startswith("duhamel.solver.")} == set()


def test_a_simulation_leaves_meshes_elements_and_plots_alone():
    found = loaded_by("from duhamel.solver import Model, read_model, simulate")
    assert not HEAVY_PACKAGES & found
    assert {name.split(".")[1] for name in found if name.startswith("duhamel.")} == {
        *("files", "inputs", "results", "solver", "superelement")
    }
    others = "linear", "simulator", "inspection"
    assert not {f"duhamel.solver.{name}" for name in others} & found
    assert (
        not {"duhamel.results.exports", "duhamel.results.series", "duhamel.results.peaks"} & found
    )


def test_help_loads_no_numbers():
    code = "from duhamel.cli import app\napp(['--help'], standalone_mode=False)"
    found = loaded_by(code)
    assert not ALL_PACKAGES & found
    packages = {name.split(".")[1] for name in found if name.startswith("duhamel.")}
    assert packages == {"cli", "files"}


@pytest.mark.parametrize("package", LAZY_PACKAGES)
def test_lists_of_names_agree(package):
    """What type checkers read, what `import *` takes, and what Python finds."""
    tree = ast.parse((ROOT / package / "__init__.py").read_text())
    block = next(node for node in tree.body if isinstance(node, ast.If))
    listed = {
        alias.asname or alias.name: f"{'.' * node.level}{node.module or alias.name}"
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    module = import_module(f"duhamel.{package}")
    assert module._lazy_names == listed
    assert set(module.__all__) <= listed.keys()
    assert listed.keys() <= set(dir(module))


@pytest.mark.parametrize("package", LAZY_PACKAGES)
def test_all_names_are_found(package):
    module = import_module(f"duhamel.{package}")
    for name in module.__all__:
        assert getattr(module, name) is not None


def test_a_name_that_there_is_not_is_an_attribute_error():
    with pytest.raises(AttributeError, match=r"module .duhamel.solver. has no attribute 'smulate'"):
        _ = import_module("duhamel.solver").smulate
    with pytest.raises(ImportError, match="cannot import name 'smulate'"):
        exec("from duhamel.solver import smulate")


def test_functions_that_have_the_name_of_a_room_stay_functions():
    """Python binds a room to its package whenever it is loaded."""
    code = (
        "import duhamel.solver.start.initial, duhamel.results.peaks, duhamel.solver\n"
        "assert callable(duhamel.solver.start) and callable(duhamel.results.peaks)\n"
        "from duhamel.solver import simulate, start\n"
        "import duhamel.solver.start\n"
        "assert callable(start) and callable(duhamel.solver.start)"
    )
    assert "duhamel.solver.start.initial" in loaded_by(code)


def test_models_know_all_forms_whatever_was_loaded_first():
    """A signal or a law is known by the file that defines it."""
    code = (
        "from duhamel.solver.model.file import ENTRY_FAMILIES, TABLES_OF_ARRAYS\n"
        "from duhamel.solver.couplings.joints import JOINTS\n"
        "forms = lambda: [*map(sorted, [f.forms for f in ENTRY_FAMILIES]), sorted(JOINTS)]\n"
        "before = forms()\n"
        "import duhamel.solver\n"
        "for name in duhamel.solver.__all__: getattr(duhamel.solver, name)\n"
        "assert forms() == before"
    )
    loaded_by(code)


def test_the_step_registers_all_compiled_functions():
    """Else the name of the machine code would depend on what a program has imported."""
    code = (
        "from duhamel.solver.compiler import digests, marks\n"
        "import duhamel.solver.step\n"
        "before, key = {*marks.COMPILED_FUNCTIONS}, digests.key()\n"
        "import duhamel.solver\n"
        "for name in duhamel.solver.__all__: getattr(duhamel.solver, name)\n"
        "digests.key.cache_clear()\n"
        "assert {*marks.COMPILED_FUNCTIONS} == before and digests.key() == key"
    )
    loaded_by(code)


def test_a_first_run_of_a_small_model_loads_no_masked_arrays():
    """Nor scipy: either takes as long as a third of the start."""
    code = """
import sys
from duhamel.solver import Frame, Model, Revolute, RigidBody, Settings, Start, simulate
arm = RigidBody(1.0, [0.01] * 3, {"end": Frame([-0.5, 0, 0])}, Start([0.5, 0, 0]))
hinge = Revolute("ground", "arm.end", [0, 0, 1], name="hinge")
simulate(Model({"arm": arm}, [hinge], settings=Settings(t_end=0.01, step=1e-3)))
print(*sys.modules)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy.ma", "scipy"} & set(run.stdout.split())
