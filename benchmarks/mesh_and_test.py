"""A mesh that is a few per cent wrong, before and after its part was tested.

The part is the steel angle of benchmarks/beside_lmfbs.py. Its mesh has legs 4 % too thick, a
modulus 4 % too low and 1 % of damping for all modes. The simulated hammer test, with noise of 2 %,
sensors and hits 2 degrees and 1 mm off and gains 1 % off, gives frequencies and damping of ten
modes, which the mesh takes over (update = "frequencies"); and the mass, in another row. The last
row has no mesh at all. Columns are those of benchmarks/beside_lmfbs.py, and the largest error of
displacements after blows. Run as `python benchmarks/mesh_and_test.py`.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import warnings

import numpy as np
from coupling.comparison import OfSuperelement, identified, motions, of_superelement
from coupling.hammer import ALL, hammer_test
from coupling.hybrid import mesh_alone, mesh_and_test
from coupling.parts import Array
from duhamel.solver import ValidityWarning
from duhamel.superelement import StepWarning

HEAD = (
    *("part by", "frequencies", "damping", "interfaces [%]", "A and B [dB]"),
    *("frequencies of A and B", "displacement"),
)


def row(*cells: str) -> str:
    return "| " + " | ".join(cells) + " |"


def of_bands(values: Array, digits: int) -> str:
    return ", ".join(f"{value:.{digits}f}" for value in values)


def show(title: str, found: OfSuperelement) -> None:
    off = 100.0 * np.abs(found.of_assembly)
    print(
        row(
            title,
            f"{100.0 * found.frequencies:.3f} %",
            f"{100.0 * found.damping:.1f} %",
            of_bands(100.0 * found.interfaces, 1),
            of_bands(found.assembly, 2),
            f"{off.max():.1f}, {np.median(off):.2f} %",
            f"{100.0 * motions(found.element).displacement:.1f} %",
        ),
        flush=True,
    )


def main() -> None:
    # Steps of contacts are finer than the band of a test asks for, and runs of a blow are short.
    for category in (ValidityWarning, StepWarning):
        warnings.simplefilter("ignore", category)
    test = hammer_test(ALL)
    print(row(*HEAD), "|" + "---|" * len(HEAD), sep="\n")
    show("mesh", of_superelement(mesh_alone()))
    show("mesh and test", of_superelement(mesh_and_test(test)))
    show("mesh, test and scale", of_superelement(mesh_and_test(test, weighed=True)))
    show("test", identified(test))


if __name__ == "__main__":
    main()
