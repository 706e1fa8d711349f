"""A part known by a hammer test, in an assembly: modes of the test beside its responses.

A simulated test of a steel angle, on which a plate of known mesh is welded. Measured superelements
are joined to the plate in a model; the field's standard way, virtual points of the measured
responses and LM-FBS, couples responses line by line. Both have the same numbers, and the truth is
that of both meshes. The table has the largest errors of nine frequencies and of their damping; rms
errors of the responses of both interfaces and mean differences of those of the assembly, driving
points and transfers of the top of the angle and the tip of the plate, in bands up to 1, 3 and
4.5 kHz; the largest error of ten frequencies of the assembly, and the median. A second table has
motions: after blows of 0.4 ms on the angle alone, and of a ball of steel of 100 g that hits the
assembly at 1 m/s. Run as `python benchmarks/beside_lmfbs.py`.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import warnings
from dataclasses import replace

import numpy as np
from coupling.comparison import OfSuperelement, identified, motions, substructured
from coupling.hammer import ALL, NOISE, SIX_AT_EACH, Errors, HammerTest, hammer_test
from coupling.parts import Array
from duhamel.solver import ValidityWarning
from duhamel.superelement import StepWarning

HEAD = (
    *("errors of the test", "frequencies", "damping", "interfaces", "by VPT [%]"),
    *("A and B", "by LM-FBS [dB]", "frequencies of A and B"),
)
HEAD_OF_MOTIONS = "errors of the test", "displacement", "peak of the force", "speed of the ball"


def tests() -> dict[str, HammerTest]:
    """By what is wrong with them."""
    every = hammer_test(ALL)
    return {
        "none": hammer_test(Errors()),
        "noise of 2 %": hammer_test(NOISE),
        "that, and 2 degrees, 1 mm, 1 %": every,
        "with 6 hits at each interface": every.with_hits(SIX_AT_EACH),
        **{f"other errors of this size, {k}": hammer_test(replace(ALL, seed=k)) for k in (2, 3)},
    }


def row(*cells: str) -> str:
    return "| " + " | ".join(cells) + " |"


def of_bands(values: Array, digits: int) -> str:
    return ", ".join(f"{value:.{digits}f}" for value in values)


def compare(title: str, test: HammerTest) -> OfSuperelement:
    """A row."""
    ours, theirs = identified(test), substructured(test)
    off = 100.0 * np.abs(ours.of_assembly)
    print(
        row(
            title,
            f"{100.0 * ours.frequencies:.3f} %",
            f"{100.0 * ours.damping:.1f} %",
            *(of_bands(100.0 * found.interfaces, 1) for found in (ours, theirs)),
            *(of_bands(found.assembly, 2) for found in (ours, theirs)),
            f"{off.max():.1f}, {np.median(off):.2f} %",
        ),
        flush=True,
    )
    return ours


def main() -> None:
    # Steps of contacts are finer than the band of a test asks for, and runs of a blow are short.
    for category in (ValidityWarning, StepWarning):
        warnings.simplefilter("ignore", category)
    print(row(*HEAD), "|" + "---|" * len(HEAD), sep="\n")
    found = {title: compare(title, test) for title, test in tests().items()}
    print("", row(*HEAD_OF_MOTIONS), "|" + "---|" * len(HEAD_OF_MOTIONS), sep="\n")
    for title, ours in found.items():
        off = motions(ours.element)
        numbers = off.displacement, abs(off.peak), abs(off.speed)
        print(row(title, *(f"{100.0 * x:.2f} %" for x in numbers)), flush=True)


if __name__ == "__main__":
    main()
