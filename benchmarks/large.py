"""Superelements of a bracket of 100 thousand to three million unknowns, by factors and by
conjugate gradients.

The angle of `preprocess.py` in a regular mesh of ten-node tetrahedra, written and read as Gmsh's
binary format: the whole kernel, n_c = 12, h = 1e-5 s, 5000 steps, to the default tolerance in the
default band. Each measurement has a process of its own, one after the other; libraries choose their
threads. At COMPARED thousand unknowns transfer functions of both ways are compared as the estimate
of the error does. Rows come as they are found; Ctrl-C keeps them. Run as `python
benchmarks/large.py [--sizes 100 160 285 500 1000 3000] [--solvers factor iterative auto]`; by
default the two smallest, by both.
"""

import argparse
import contextlib
import os
import sys
import tempfile
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "preprocess"))
from blocks import solid_cells
from solids.bracket import HEIGHT, LENGTH, THICKNESS, body_of
from solids.measuring import Measurement, alone, measured, table_of
from solids.solving import counted

SIZES = (100, 160)
"""thousands of unknowns, unless others are asked for"""
SOLVERS = ("factor", "iterative", "auto")
FACTOR_TO = 500
"""thousands of unknowns up to which factors are tried"""
COMPARED = 160
WIDTH = 0.06
"""of the bracket, about [m]"""
MESH, TAGS = "bracket.msh", ("gmsh:physical", "gmsh:geometrical")
COLUMNS = (
    *("unknowns", "solver", "mesh", "assembly", "factor or set-up", "solves", "rest", "total"),
    *("CPU", "peak", "blocks", "iterations", "modes", "error"),
)


def make_mesh(folder: Path, thousands: int) -> Measurement:
    """k cells through the thickness, as nearly cubes as the lengths allow; the width makes up the
    number of unknowns.
    """
    import meshio

    area = THICKNESS * (LENGTH + HEIGHT - THICKNESS)
    k = round(THICKNESS * (1e3 * thousands / (24.0 * area * WIDTH)) ** (1.0 / 3.0))
    along, up = (k + round(k * (length / THICKNESS - 1.0)) for length in (LENGTH, HEIGHT))
    nodes = (2 * k + 1) * (2 * (along + up - k) + 1)  # in a plane across the width
    layers = round((1e3 * thousands / (3 * nodes) - 1.0) / 2.0)
    grid, cells = solid_cells("tetra10", (along, layers, up))
    # What is beyond the thickness both along and up is no part of an angle.
    inside = ~((grid[:, 0] > 2 * k) & (grid[:, 2] > 2 * k))
    cells = cells[inside[cells].all(axis=1)]
    kept, numbers = np.unique(cells, return_inverse=True)
    cells = numbers.reshape(cells.shape)
    places = [
        stretched(k, along, LENGTH),
        np.linspace(0.0, layers * THICKNESS / k, 2 * layers + 1),
        stretched(k, up, HEIGHT),
    ]
    points = np.stack([x[n] for x, n in zip(places, grid[kept].T, strict=True)], axis=1)
    bracket = meshio.Mesh(points, [("tetra10", cells)])
    bracket.cell_data = {tag: [np.ones(len(cells), dtype=int)] for tag in TAGS}
    bracket.write(folder / MESH, file_format="gmsh22", binary=True)
    return {"unknowns": 3 * len(points)}


def stretched(k: int, cells: int, length: float) -> Any:
    """Places of half cells: k cells in the thickness, the others in the rest of the length."""
    through = np.linspace(0.0, THICKNESS, 2 * k + 1)
    return np.concatenate([through, np.linspace(THICKNESS, length, 2 * (cells - k) + 1)[1:]])


def superelement(folder: Path, solver: str) -> Measurement:
    """What a build takes, and its file under the name of the solver."""
    from duhamel.preprocess import Body, PreprocessError, build
    from duhamel.superelement import write

    body = Body.model_validate(body_of(folder / MESH, solver=solver))
    with counted() as spent, measured() as found:
        try:
            bracket = build(body)
        except PreprocessError as error:
            return {"refused": str(error)}
    write(folder / f"{solver}.h5", bracket)
    return {
        **found,
        **bracket.provenance.timings,
        **spent,
        "modes": len(bracket.modes.omega),
        "error": bracket.kernel.error,
    }


def difference(folder: Path, found: str, better: str) -> Measurement:
    """Of their transfer functions, as `Band.error` has it; and the errors that they state."""
    from duhamel.preprocess.responses.band import Band
    from duhamel.superelement import read

    first, second = (read(folder / f"{solver}.h5") for solver in (found, better))
    kernel = second.kernel
    band = Band(kernel.h, kernel.scheme, kernel.band or 0.25 / kernel.h)
    return {
        "difference": band.error(first.modes, second.modes),
        "stated": (first.kernel.error, kernel.error),
    }


def row(unknowns: str, solver: str, m: Measurement) -> str:
    rest = m["total"] - sum(m[part] for part in ("mesh", "assembly", "set-up", "solves"))
    parts = (m["mesh"], m["assembly"], m["set-up"], m["solves"], rest, m["total"], m["cpu"])
    cells = [f"{seconds:.1f} s" for seconds in parts]
    cells += [f"{m['peak']:.2f} GB", *(str(m[key]) for key in ("blocks", "iterations", "modes"))]
    return "| " + " | ".join([unknowns, solver, *cells, f"{m['error']:.1e}"]) + " |"


def measure(size: int, solvers: list[str], factor_to: int, patience: float | None) -> Iterator[str]:
    """The rows of a size, and what its transfer functions differ by."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        mesh = alone(make_mesh, folder, size)
        if mesh is None:
            raise SystemExit("died; what it said stands above")
        unknowns = f"{mesh['unknowns']:,}".replace(",", " ")
        for solver in solvers:
            if solver == "factor" and size > factor_to:
                continue
            found = alone(superelement, folder, solver, patience=patience)
            if found is None:
                yield f"| {unknowns} | {solver} | died, or took longer than {patience} s |"
            elif "refused" in found:
                yield f"| {unknowns} | {solver} | {found['refused']} |"
            else:
                yield row(unknowns, solver, found)
        if size == COMPARED and all((folder / f"{way}.h5").exists() for way in SOLVERS[:2]):
            apart = alone(difference, folder, *reversed(SOLVERS[:2]))
            if apart is not None:
                yield (
                    f"transfer functions with and without a factor, {unknowns} unknowns: "
                    f"{apart['difference']:.1e} apart, in the norm of their errors, which are "
                    "{1:.1e} and {0:.1e}".format(*apart["stated"])
                )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n\n")[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="thousands of unknowns")
    parser.add_argument("--solvers", nargs="+", choices=SOLVERS, default=SOLVERS[:2])
    parser.add_argument("--factor-to", type=int, default=FACTOR_TO, help="thousands of unknowns")
    parser.add_argument("--patience", type=float, help="seconds to wait for each superelement")
    chosen = parser.parse_args()

    packages = ("duhamel", "numpy", "scipy", "numba", "rslab")
    versions = (f"{name} {metadata.version(name)}" for name in packages)
    print(*versions, f"{os.cpu_count()} cores", sep=", ")
    print("", *table_of(list(COLUMNS)), sep="\n", flush=True)
    with contextlib.suppress(KeyboardInterrupt):
        for size in chosen.sizes:
            for line in measure(size, chosen.solvers, chosen.factor_to, chosen.patience):
                print(line, flush=True)


if __name__ == "__main__":
    main()
