"""Stiffness and mass of blocks of ten-node tetrahedra, beside scikit-fem's own forms in the same
run.

Each measurement has a process of its own: CPU time on one thread, and peak memory with mesh and
imports. Run as `python benchmarks/assembly.py [--large | --small]`.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import argparse
import multiprocessing
import resource
import statistics
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import skfem
from duhamel.preprocess.body.material import Material
from duhamel.preprocess.elements.solid import solid_matrices
from duhamel.preprocess.mesh.mesh import Mesh
from skfem.helpers import dot
from skfem.models.elasticity import lame_parameters, linear_elasticity

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "preprocess"))
from blocks import solid_cells

SIZES = [(41, 4, 4), (49, 6, 6), (61, 8, 8)]
LARGE = (76, 12, 12)
STEEL = Material(E=2.1e11, nu=0.3, rho=7800.0)
Matrices = tuple[Any, Any]


def block(divisions: tuple[int, int, int]) -> Mesh:
    grid, cells = solid_cells("tetra10", divisions)
    return Mesh("block", grid / (2.0 * divisions[1]), {"tetra10": cells}, {}, ("tetra10",))


def ours(mesh: Mesh) -> Matrices:
    return solid_matrices(mesh, [STEEL], np.zeros(mesh.n_elements, dtype=np.int64))


def scikit_fem(mesh: Mesh) -> Matrices:
    corners, cells = np.unique(mesh.cells["tetra10"][:, :4], return_inverse=True)
    grid = skfem.MeshTet1(
        *map(np.ascontiguousarray, (mesh.points[corners].T, cells.reshape(-1, 4).T))
    )
    basis = skfem.Basis(grid, skfem.ElementVector(skfem.ElementTetP2()))
    stiffness = linear_elasticity(*lame_parameters(STEEL.E, STEEL.nu)).assemble(basis)
    return stiffness, skfem.BilinearForm(lambda u, v, _: STEEL.rho * dot(u, v)).assemble(basis)


def measure(
    assemble: Callable[[Mesh], Matrices], divisions: tuple[int, int, int], repeats: int
) -> list[float]:
    """Unknowns, median CPU seconds, peak memory [GB], and the traces of K and M."""
    mesh = block(divisions)
    seconds = []
    for _ in range(repeats):
        start = time.process_time()
        K, M = assemble(mesh)
        seconds.append(time.process_time() - start)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return [3 * len(mesh.points), statistics.median(seconds), peak, K.trace(), M.trace()]


def alone(*work: Any) -> list[float]:
    """A measurement in a fresh process."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        return pool.submit(measure, *work).result()


def main() -> None:
    parser = argparse.ArgumentParser()
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--large", action="store_true", help="287 000 unknowns too")
    size.add_argument("--small", action="store_true", help="20 000 unknowns alone")
    chosen = parser.parse_args()
    sizes = SIZES[:1] if chosen.small else [*SIZES, LARGE][: len(SIZES) + chosen.large]
    print(
        f"{'unknowns':>10}{'ours':>10}{'scikit-fem':>12}{'ratio':>8}{'peak':>10}{'scikit-fem':>12}"
    )
    for divisions in sizes:
        unknowns, seconds, peak, *traces = alone(ours, divisions, 5)
        _, theirs, their_peak, *others = alone(scikit_fem, divisions, 1)
        np.testing.assert_allclose(traces, others, rtol=1e-10)
        print(
            f"{unknowns:10.0f}{seconds:8.2f} s{theirs:10.2f} s{theirs / seconds:8.1f}{peak:7.2f} "
            f"GB{their_peak:9.2f} GB"
        )


if __name__ == "__main__":
    main()
