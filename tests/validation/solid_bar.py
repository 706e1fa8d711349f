"""Superelements of straight bars of solid elements."""

from pathlib import Path
from typing import Any

import meshio
import numpy as np
from duhamel.preprocess import Body, build
from duhamel.superelement import Superelement
from numpy.typing import NDArray
from scipy.linalg import block_diag, cholesky, eigh, null_space, solve_triangular

from ..preprocess.blocks import box_mesh

Array = NDArray[np.float64]


def solid_superelement(*box: Any, **settings: Any) -> Superelement:
    """That of a `solid_body`."""
    return build(solid_body(*box, **settings))


def solid_body(
    folder: Path,
    kind: str,
    size: tuple[float, float, float],
    divisions: tuple[int, int, int],
    material: dict[str, float],
    impulse: dict[str, Any],
    root: str = "average",
    **settings: Any,
) -> Body:
    """A box along x with frames root and tip on its ends, of the kind that `root` says and
    average; settings: of the body file.
    """
    mesh, path = box_mesh(kind, size, divisions), folder / f"{kind}-{divisions[0]}.msh"
    mesh = meshio.Mesh(
        mesh.points, mesh.cells, cell_data=mesh.cell_data, field_data=mesh.field_data
    )
    mesh.write(path, file_format="gmsh22")
    body = {
        "name": "bar",
        "mesh": path,
        "material": material,
        "interfaces": {"root": {"group": "root", "kind": root}, "tip": {"group": "tip"}},
        "impulse": {"steps": 1000, "method": "krylov", **impulse},
        **settings,
    }
    return Body.model_validate(body)


def clamped_modes(bar: Superelement) -> tuple[Array, Array]:
    """With the root on ground: frequencies (m,) [Hz], and what the tip does in modes of unit mass
    (6, m).

    The rigid and the elastic modes that add up to nothing at the root:

        K eta = omega^2 eta,   K = diag(0, omega^2),   [U L^-T, phi] eta = 0 at the root,
        L L^T = diag(m I, J_rot)
    """
    L = cholesky(block_diag(bar.mass * np.eye(3), bar.J_rot), lower=True)
    motion = []
    for interface in bar.interfaces:
        U = np.eye(6)
        U[:3, 3:] = np.cross(np.eye(3), interface.X).T  # columns e_i x X
        rigid = solve_triangular(L, U.T, lower=True).T
        motion.append(np.hstack([rigid, bar.modes.phi[bar.rows(interface.name)]]))
    root, tip = motion
    free = null_space(root / np.linalg.norm(root, axis=1, keepdims=True))
    squares = np.concatenate([np.zeros(6), bar.modes.omega**2])
    squares, Q = eigh((free.T * squares) @ free)
    return np.sqrt(squares) / (2.0 * np.pi), tip @ free @ Q
