"""The Campbell diagram of a disk on a light shaft, by linear analysis, against the formula.

    python examples/campbell.py [FOLDER]

Four lines, two with the spin and two against it: the disk moves across, and tilts with its
gyroscopic moment. The forward tilt never meets the spin, for the disk is thin: its inertia about
the shaft is twice that about a diameter. Writes the picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/shaft/light.toml"
L, EI = 1.0, 1649.3361431346415
AT = L / 3.0
MASS, POLAR, DIAMETRAL = 5.0, 0.05, 0.025
SPINS = np.linspace(0.0, 800.0, 17)
"""[rad/s]"""
LINES = 4


@dataclass(frozen=True, eq=False)
class Found:
    """diagram; expected (n, 4) [Hz], ascending; error: largest relative difference of a line."""

    diagram: solver.Campbell
    expected: Array
    error: float
    critical: Array
    """speeds at which the spin meets a line [rad/s]"""


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    model = solver.read_model(ROOT / "examples/campbell.toml")
    diagram = solver.campbell(model, SPINS.tolist(), LINES)
    expected = np.array([formula(spin) for spin in SPINS])
    lines = np.sort(np.array([line.frequencies for line in diagram.lines]).T, axis=1)
    crossings = diagram.crossings(1.0)
    found = Found(
        diagram,
        expected,
        float(np.abs(lines / expected - 1.0).max()),
        np.array([crossing.spin for crossing in crossings]),
    )
    draw(found, folder / "campbell-diagram.png")
    assert found.error < 2e-3
    return found


def formula(spin: float) -> Array:
    """Frequencies [Hz] of a disk on a massless shaft in short bearings, ascending.

        m w'' + K_11 w + K_12 v = 0,    J_d v'' - i J_p spin v' + K_21 w + K_22 v = 0

    for w = y + i z and the slope v of the shaft at the disk; K is the inverse of the flexibility of
    a beam on two supports.
    """
    a, b = AT, L - AT
    F = np.array([[a * a * b * b, a * b * (b - a)], [a * b * (b - a), a * a - a * b + b * b]])
    K = np.linalg.inv(F / (3.0 * EI * L))
    M, G = np.diag([MASS, DIAMETRAL]), np.diag([0.0, POLAR * spin])
    inverse = np.linalg.inv(M)
    first_order = np.block([[np.zeros((2, 2)), np.eye(2)], [inverse @ K, inverse @ G]])
    frequencies: Array = np.sort(np.abs(np.linalg.eigvals(first_order).real)) / (2.0 * np.pi)
    return frequencies


def draw(found: Found, target: Path) -> None:
    lines = [view.CampbellLine(line.whirl, line.frequencies) for line in found.diagram.lines]
    crossings = [(spin, spin / (2.0 * np.pi)) for spin in found.critical.tolist()]
    title = "A disk on a light shaft: whirl over the spin"
    figure = view.draw_campbell(SPINS, lines, (1.0, 2.0), crossings, title)
    with view.style():
        (axes,) = figure.axes
        turns = np.repeat(SPINS / (2.0 * np.pi), LINES)
        axes.plot(turns, found.expected.ravel(), ".", color="0.3", markersize=3, label="formula")
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    view.save(figure, target)


if __name__ == "__main__":
    result = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    print(f"largest difference from the formula: {result.error:.2g}")
    print(f"critical speeds [rad/s]: {', '.join(f'{spin:.6g}' for spin in result.critical)}")
