"""Superelements of a bracket of ten-node tetrahedra, beside Hurty-Craig-Bampton modes of Exudyn on
the same mesh.

Ours: the whole kernel, n_c = 12, h = 1e-5 s, 5000 steps, to the default tolerance in the default
band. Theirs: 16 modes besides the static ones, with the matrices of NGsolve, by both of the
eigensolvers that Exudyn offers. Each measurement has a process of its own; libraries choose their
threads. Needs the extra `validation`. Run as `python benchmarks/preprocess.py [--sizes 20 50 100
160 285] [--patience SECONDS]`; by default the two smallest.
"""

import argparse
import os
import tempfile
import time
from importlib import metadata
from pathlib import Path

from solids.bracket import ENDS, HEIGHT, LENGTH, STEEL, THICKNESS, body_of
from solids.measuring import Measurement, alone, measured, table_of
from solids.solving import counted

SIZES = {
    20: (0.06, 0.008),
    50: (0.062, 0.0065),
    100: (0.06, 0.0048),
    160: (0.062, 0.0038),
    285: (0.056, 0.0035),
}
"""Width of the bracket and length of the elements [m], by thousands of unknowns: Netgen grades
lengths by halves.
"""
MODES = 16
NETGEN_ORDER = [0, 2, 1, 3, 5, 7, 4, 6, 9, 8]
"""Netgen's ten nodes in meshio's order, which sees tetrahedra from the other side."""
NETGEN, GMSH = "bracket.vol", "bracket.msh"


def make_mesh(folder: Path, width: float, length: float) -> Measurement:
    """An angle of plane faces: files of the corners for Netgen, and of all nodes for us."""
    import meshio
    import numpy as np
    from netgen.occ import Box, OCCGeometry

    plate, wall = (
        Box((0, 0, 0), (LENGTH, width, THICKNESS)),
        Box((0, 0, 0), (THICKNESS, width, HEIGHT)),
    )
    mesh = OCCGeometry(plate + wall).GenerateMesh(maxh=length)
    mesh.Save(str(folder / NETGEN))
    mesh.SecondOrder()
    cells = mesh.Elements3D().NumPy()["nodes"][:, :10].astype(np.int64)[:, NETGEN_ORDER] - 1
    bracket = meshio.Mesh(mesh.Coordinates(), [("tetra10", cells)])
    tags = {tag: [np.ones(len(cells), dtype=int)] for tag in ("gmsh:physical", "gmsh:geometrical")}
    bracket.cell_data = tags
    bracket.write(folder / GMSH, file_format="gmsh22")
    return {"unknowns": 3 * len(bracket.points)}


def ours(folder: Path) -> Measurement:
    from duhamel.preprocess import Body, assemble, build

    body = Body.model_validate(body_of(folder / GMSH))
    with counted() as spent, measured() as found:
        bracket = build(body)
    structure = assemble(body)
    return {
        **found,
        **bracket.provenance.timings,
        **spent,
        "modes": len(bracket.modes.omega),
        "error": bracket.kernel.error,
        "traces": (structure.K.trace(), structure.M.trace()),
    }


def exudyn(folder: Path, eigensolver: str) -> Measurement:
    import ngsolve
    from exudyn.FEM import FEMinterface, HCBstaticModeSelection

    mesh, fem = ngsolve.Mesh(str(folder / NETGEN)), FEMinterface()
    with measured() as found:
        start = time.perf_counter()
        mass, stiffness, _ = fem.ImportMeshFromNGsolve(
            mesh,
            density=STEEL["rho"],
            youngsModulus=STEEL["E"],
            poissonsRatio=STEEL["nu"],
            meshOrder=2,
        )
        found["import"] = time.perf_counter() - start
        ends = [fem.GetNodesInPlane(*end) for end in ENDS.values()]
        if eigensolver == "NGsolve":
            fem.ComputeHurtyCraigBamptonModesNGsolve(mass, stiffness, ends, MODES)
        else:
            fem.ComputeHurtyCraigBamptonModes(
                ends, MODES, computationMode=HCBstaticModeSelection.RBE2
            )
    return {**found, "traces": (fem.stiffnessMatrix.trace(), fem.massMatrix.trace())}


def row_of_ours(unknowns: str, m: Measurement) -> str:
    krylov = m["impulse"] - m["set-up"]
    seconds = [
        f"{s:.1f} s" for s in (m["mesh"], m["assembly"], m["set-up"], krylov, m["total"], m["cpu"])
    ]
    rest = [f"{m['peak']:.2f} GB", f"{m['blocks']}", f"{m['modes']}", f"{m['error']:.1e}"]
    return "| " + " | ".join([unknowns, *seconds, *rest]) + " |"


def cells_of_peer(own: Measurement, found: Measurement | None, patience: float | None) -> list[str]:
    if found is None:
        return ["", "died" if patience is None else f"over {patience:.0f} s, or died", "", "", ""]
    for trace, other in zip(found["traces"], own["traces"], strict=True):
        if abs(trace / other - 1.0) > 1e-9:
            raise SystemExit(
                f"the models differ: traces of K and M are {own['traces']} and {found['traces']}"
            )
    hcb = found["total"] - found["import"]
    ratios = f"{found['total'] / own['total']:.1f} ({found['cpu'] / own['cpu']:.1f})"
    return [
        f"{found['import']:.1f} s",
        f"{hcb:.1f} s",
        f"{found['cpu']:.1f} s",
        f"{found['peak']:.2f} GB",
        ratios,
    ]


def main() -> None:
    parser = argparse.ArgumentParser(
        description="Impulse superelements beside Hurty-Craig-Bampton modes."
    )
    parser.add_argument(
        "--sizes",
        type=int,
        nargs="+",
        choices=SIZES,
        default=[20, 50],
        help="thousands of unknowns",
    )
    parser.add_argument("--patience", type=float, help="seconds to wait for each run of the peer")
    chosen = parser.parse_args()

    packages = ("duhamel", "numpy", "scipy", "rslab", "exudyn", "ngsolve")
    print(
        ", ".join(f"{name} {metadata.version(name)}" for name in packages),
        f"{os.cpu_count()} cores",
        sep=", ",
    )
    heading = [
        "unknowns",
        "mesh",
        "assembly",
        "factorization",
        "Krylov",
        "total",
        "CPU",
        "peak",
        "blocks",
        "modes",
    ]
    peers = ["unknowns", "eigensolver", "import", "modes", "CPU", "peak", "ratio (of CPU)"]
    tables = [table_of([*heading, "error"]), table_of(peers)]
    for size in chosen.sizes:
        with tempfile.TemporaryDirectory() as folder:
            mesh, own = alone(make_mesh, Path(folder), *SIZES[size]), alone(ours, Path(folder))
            if mesh is None or own is None:
                raise SystemExit("died; what it said stands above")
            unknowns = f"{mesh['unknowns']:,}".replace(",", " ")
            tables[0].append(row_of_ours(unknowns, own))
            print(tables[0][-1], flush=True)
            for eigensolver in ("NGsolve", "SciPy"):
                found = alone(exudyn, Path(folder), eigensolver, patience=chosen.patience)
                cells = [unknowns, eigensolver, *cells_of_peer(own, found, chosen.patience)]
                tables[1].append("| " + " | ".join(cells) + " |")
                print(tables[1][-1], flush=True)
    print("", *tables[0], "", *tables[1], sep="\n")


if __name__ == "__main__":
    main()
