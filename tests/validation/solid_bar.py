"""Superelements of straight bars of solid elements."""

from pathlib import Path
from typing import Any

import meshio
import numpy as np
from duhamel.preprocess import Body, build
from duhamel.superelement import Superelement
from numpy.typing import NDArray
from scipy.linalg import block_diag, cholesky, eigvalsh, null_space, solve_triangular

from ..preprocess.blocks import box_mesh

Array = NDArray[np.float64]


def solid_superelement(
    folder: Path,
    kind: str,
    size: tuple[float, float, float],
    divisions: tuple[int, int, int],
    material: dict[str, float],
    impulse: dict[str, Any],
    root: str = "average",
) -> Superelement:
    """A box along x with frames root and tip on its ends, of the kind that `root` says and average."""
    mesh, path = box_mesh(kind, size, divisions), folder / f"{kind}-{divisions[0]}.msh"
    mesh = meshio.Mesh(mesh.points, mesh.cells, cell_data=mesh.cell_data, field_data=mesh.field_data)
    mesh.write(path, file_format="gmsh22", binary=False)
    body = {
        "name": "bar",
        "mesh": path,
        "material": material,
        "interfaces": {"root": {"group": "root", "kind": root}, "tip": {"group": "tip"}},
        "impulse": {"steps": 1000, "method": "krylov", **impulse},
    }
    return build(Body.model_validate(body))


def clamped_frequencies(bar: Superelement) -> Array:
    """Frequencies [Hz] with the root on ground: those of rigid and elastic modes that add up to nothing there.

    min eta^T diag(0, omega^2) eta,   |eta| = 1,   [U L^-T, phi] eta = 0 at the root,   L L^T = diag(m I, J_rot)
    """
    X = next(found.X for found in bar.interfaces if found.name == "root")
    U = np.eye(6)
    U[:3, 3:] = np.cross(np.eye(3), X).T  # columns e_i x X
    L = cholesky(block_diag(bar.mass * np.eye(3), bar.J_rot), lower=True)
    rows = np.hstack([solve_triangular(L, U.T, lower=True).T, bar.modes.phi[bar.rows("root")]])
    free = null_space(rows / np.linalg.norm(rows, axis=1, keepdims=True))
    squares = np.concatenate([np.zeros(6), bar.modes.omega**2])
    return np.sqrt(eigvalsh((free.T * squares) @ free)) / (2.0 * np.pi)
