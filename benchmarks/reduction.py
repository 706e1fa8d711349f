"""Bases for the responses of interfaces, side by side: what each costs, keeps, and errs by.

A free prism of 1 x 1 x 0.6 m of quadratic tetrahedra with two interfaces on half of its ends, with
as many modes in the band as compact bodies have:

- Krylov blocks with the shift of the time step, with a low one (that of the package), and with
  several shifts in the band, each of which takes a factor;
- eigenmodes up to multiples of the band by Lanczos's method, with static and instantaneous
  responses.

python benchmarks/reduction.py [DIVISIONS]    of 1 m; 8 is 7803 unknowns
"""

import sys
import tempfile
import time
from pathlib import Path

import meshio
import numpy as np
from duhamel.preprocess import assemble
from duhamel.preprocess.body.body import Body
from duhamel.preprocess.body.damping import Damping
from duhamel.preprocess.responses.band import Band
from duhamel.preprocess.responses.basis import Basis
from duhamel.preprocess.responses.condensation import condensed
from duhamel.preprocess.responses.lowest import first_square
from duhamel.preprocess.responses.ritz import ritz_modes
from duhamel.preprocess.responses.static import attachment_modes
from duhamel.preprocess.solving.factor import factorize
from duhamel.superelement import GeneralizedAlpha, Modes
from scipy.sparse.linalg import LinearOperator, eigsh
from skfem import Basis as FieldBasis
from skfem import ElementTetP2, MeshTet

BAND, STEP, SCHEME = 6000.0, 2e-5, GeneralizedAlpha(0.9)
TOLERANCE = 1e-6


def prism(divisions: int) -> Body:
    """The body, on a mesh in a temporary file."""
    ticks = np.linspace(0.0, 1.0, divisions + 1)
    tets = MeshTet.init_tensor(ticks, ticks, np.linspace(0.0, 0.6, int(0.6 * divisions) + 1))
    basis = FieldBasis(tets, ElementTetP2(), intorder=1)
    cells, points = basis.element_dofs.T.copy(), basis.doflocs.T
    turned = np.linalg.det(points[cells[:, 1:4]] - points[cells[:, :1]]) < 0
    cells[turned] = cells[turned][:, [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    file = Path(tempfile.mkdtemp()) / "prism.vtu"
    meshio.Mesh(points, [("tetra10", cells)]).write(file, binary=True)
    return Body.model_validate(
        {
            "name": "prism",
            "mesh": file,
            "material": {"E": 2.1e11, "nu": 0.3, "rho": 7850.0},
            "interfaces": {
                "a": {"box": {"corners": [[0, 0, 0], [0, 0.5, 0.6]]}},
                "b": {"box": {"corners": [[1, 0.5, 0], [1, 1, 0.6]]}},
            },
            "impulse": {"step": STEP, "steps": 200},
        }
    )


class Ritz:
    """Modes in a growing space, and the solutions that it took."""

    def __init__(self, structure) -> None:
        self.structure, self.columns = structure, 0
        self.basis = Basis(structure, min(structure.n_u, 2500))
        self.basis.extend(structure.U)

    def add(self, W) -> None:
        self.basis.extend(W)

    def modes(self) -> Modes:
        V = self.basis.V[:, 6:]
        omega, Q = ritz_modes(self.structure, V, V.T @ (self.structure.K @ V))
        return Modes(omega, 0.0 * omega, self.basis.at(self.structure.P_C)[:, 6:] @ Q)


def blocks_of(structure, shifts, band, truth, enough=TOLERANCE, most=120):
    """Blocks of a Krylov space until its modes are right, each with the next of the shifts."""
    space, count = Ritz(structure), 1
    factors = [factorize(structure.K + s * structure.M, "S") for s in shifts]
    start = factorize(structure.K + SCHEME.beta_prime(STEP) * structure.M, "S_h")
    space.add(start(structure.loads))
    first = 6
    while count < most:
        V = space.basis.V[:, first:]
        first = space.basis.columns
        space.add(factors[count % len(factors)](structure.M @ V))
        count += 1
        if truth is None:
            continue
        if count % 2 == 0 and band.error(space.modes(), truth, enough) <= enough:
            break
    return space.modes(), count


def lanczos(structure, limit: float):
    """Eigenmodes up to `limit` [Hz], static and instantaneous responses of the interfaces."""
    s, solved = (2.0 * np.pi * 1000.0) ** 2, 0
    factor = factorize(structure.K + s * structure.M, "S")

    def solve(b):
        nonlocal solved
        solved += 1
        return factor(np.ascontiguousarray(b.ravel()))

    count = 60
    while True:
        solved = 0
        inverse = LinearOperator(structure.K.shape, matvec=solve, dtype=np.float64)
        squares, shapes = eigsh(structure.K, count, structure.M, sigma=-s, OPinv=inverse)
        if np.sqrt(squares.max()) > 2.0 * np.pi * limit:
            break
        count = int(1.5 * count)
    space = Ritz(structure)
    inside = np.sqrt(np.maximum(squares, 0.0)) <= 2.0 * np.pi * limit
    for W in (
        shapes[:, inside],
        attachment_modes(structure),
        factorize(structure.K + SCHEME.beta_prime(STEP) * structure.M, "S_h")(structure.loads),
    ):
        space.add(W)
    return space.modes(), solved


def main(divisions: int = 8) -> None:
    structure, band = assemble(prism(divisions)), Band(STEP, SCHEME, BAND)
    low = 0.1 * first_square(structure)
    of_band = (2.0 * np.pi * BAND) ** 2
    truth, _ = blocks_of(structure, [low], band, None, most=50)
    n_c = structure.P_C.shape[0]
    print(f"{structure.n_u} unknowns, {(truth.frequencies < BAND).sum()} modes in the band\n")
    print("| basis | solutions | vectors | condensed | error | s of CPU |")
    print("|---|---|---|---|---|---|")
    spaces = {
        "shift of the step": [SCHEME.beta_prime(STEP)],
        "low shift": [low],
        "two shifts, low and half the band": [low, 0.25 * of_band],
        "three shifts, low, half, whole band": [low, 0.25 * of_band, of_band],
    }
    for name, shifts in spaces.items():
        began = time.process_time()
        modes, count = blocks_of(structure, shifts, band, truth)
        took = time.process_time() - began
        few = condensed(modes, Damping(), band, 0.1 * TOLERANCE, False, modes.phi)
        error = band.error(few.modes, truth)
        print(
            f"| {name} | {count} blocks of {n_c} | {len(modes.omega)} | {len(few.modes.omega)} "
            f"| {error:.1e} | {took:.1f} |"
        )
    for share in (1.0, 1.5, 2.0):
        began = time.process_time()
        modes, solved = lanczos(structure, share * BAND)
        took = time.process_time() - began
        print(
            f"| Lanczos to {share} times the band | {solved} vectors, 2 blocks of {n_c} "
            f"| {len(modes.omega)} | | {band.error(modes, truth):.1e} | {took:.1f} |"
        )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
