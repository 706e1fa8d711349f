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
