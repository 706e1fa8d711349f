"""Packages that the solver loads."""

import subprocess
import sys


def test_the_solver_leaves_meshes_elements_and_plots_alone():
    code = "import sys, duhamel.solver; print(*{name.partition('.')[0] for name in sys.modules})"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    slow = {"skfem", "meshio", "matplotlib", "rslab", "scipy", "numba", "llvmlite"}
    assert not slow & set(run.stdout.split())
    code = (
        "import sys, duhamel.solver; print(*(n for n in sys.modules if n.startswith('duhamel.')))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    folders = {name.split(".")[1] for name in run.stdout.split()}
    assert folders == {"files", "inputs", "results", "solver", "superelement"}


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
