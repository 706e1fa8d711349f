"""A shelf on a drop table: half a sine of 50 g in 6 ms, and what shock engineers read of it.

    python examples/base_shock.py [FOLDER]

runs examples/base_shock.toml. The shock response spectrum of the wall is compared with the closed
form of half a sine, the tip with modes of the finite element mesh with its wall held, found without
the superelement and moved by Fourier transforms. Writes results and pictures to FOLDER, by default
out/.
"""

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from duhamel import preprocess, solver, superelement, view
from duhamel.preprocess import assemble
from duhamel.results import series
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/shelf/shelf.toml"
G = 9.80665
PEAK, DURATION, START = 50 * G, 6e-3, 1e-3
"""of the pulse [m/s^2], [s], [s]"""
Q = 10.0
"""of the oscillators of the spectra, and of all modes of the shelf: 1 / its loss factor"""
MODES, HELD = 20, 6
"""of the shelf with its wall held, up to 17 kHz; rows of the wall in those of the interfaces"""
PADDED = 4
"""length of Fourier transforms over that of the run, until all has died away"""
CORNER = 3000.0
"""up to which the tip is compared [Hz]: corners of the pulse make the time stepping ripple"""


@dataclass(frozen=True, eq=False)
class Shock:
    """time (n,) [s]; accelerations along z of wall and tip (n,), expected (n,): of the tip, by the
    modes of the held mesh [m/s^2]; frequencies [Hz] and participations of these modes (m,).
    """

    time: Array
    wall: Array
    tip: Array
    expected: Array
    frequencies: Array
    participations: Array


@dataclass(frozen=True)
class Checks:
    """The largest of the wall's spectrum over the peak of the pulse, and its frequency times the
    duration; pseudo-velocity at 5 Hz over the change of velocity, undamped; difference of the tip
    from the held mesh over its peak; its peak over that by the wall's spectrum.
    """

    amplification: float
    cycles: float
    velocity: float
    tip: float
    by_spectrum: float


def main(folder: Path) -> tuple[Shock, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/base_shock.toml")
    results = solver.simulate(model, output=folder / "base-shock.h5")
    found = shock(results)
    checks = compare(found)
    view.save(picture(results, found), folder / "base-shock.png")
    assert abs(checks.amplification - 1.65) < 0.01
    assert abs(checks.velocity - 1.0) < 2e-3
    assert checks.tip < 0.01
    return found, checks


def ensure_superelement() -> Path:
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    return target


def shock(results: solver.Results) -> Shock:
    time = results.time
    expected, frequencies, participations = held_shelf(time, results.superelement("shelf"))
    return Shock(
        time=time,
        wall=results.frame("shelf.wall").acceleration[:, 2],
        tip=results.frame("shelf.tip").acceleration[:, 2],
        expected=expected,
        frequencies=frequencies,
        participations=participations,
    )


def pulse(time: Array) -> Array:
    inside = (time >= START) & (time <= START + DURATION)
    return np.where(inside, PEAK * np.sin(np.pi * (time - START) / DURATION), 0.0)


def held_shelf(time: Array, shelf: superelement.Superelement) -> tuple[Array, Array, Array]:
    """The acceleration of the tip (n,) over the acceleration a of the wall, by Fourier transforms:

        a_tip = a + sum_i p_i (A_i - a),    A_i = omega_i^2 c / (omega_i^2 c - w^2) a

    with c(i w) of the material, that lets it stiffen and lose energy. Also the frequencies [Hz] of
    the modes with c at 163 Hz, and their participations p_i.
    """
    omega, participations = held_modes()
    chain, n = shelf.modes.chain, PADDED * len(time)
    a = np.fft.rfft(pulse(time), n)
    w = 2 * np.pi * np.fft.rfftfreq(n, time[1])
    c = chain.factor(w, 1)[:, 0]
    a_tip = a.copy()
    for square, p in zip(omega**2, participations, strict=True):
        a_tip += p * w**2 / (square * c - w**2) * a
    usual = np.sqrt(chain.factor(np.array([2 * np.pi * chain.reference]), 1).real[0, 0])
    return np.fft.irfft(a_tip, n)[: len(time)], usual * omega / (2 * np.pi), participations


def held_modes() -> tuple[Array, Array]:
    """The mesh with its wall held, [rad/s], and the participations of its modes in the tip along z:

    K u + P^T lambda = omega^2 M u,  P u = 0 at the wall;    p_i = phi_i(tip) phi_i^T M e_z
    """
    structure = assemble(preprocess.read_body(BODY))
    wall, tip = structure.rows["wall"], structure.rows["tip"]
    K = sp.block_array([[structure.K, wall.T], [wall, None]], format="csc")
    M = sp.block_diag([structure.M, sp.csc_array((HELD, HELD))], format="csc")
    squares, shapes = eigsh(K, MODES, M, sigma=0.0)
    shapes = shapes[: structure.n_u]
    along = structure.U @ np.linalg.solve(wall @ structure.U, np.eye(HELD)[2])
    return np.sqrt(squares), (tip @ shapes)[2] * (shapes.T @ (structure.M @ along))


def compare(found: Shock) -> Checks:
    time = found.time
    spectrum = series.shock_spectrum(time, found.wall, q=Q)
    slow = series.shock_spectrum(time, found.wall, [5.0], q=np.inf, response="pseudo-velocity")
    most = int(spectrum.values.argmax())
    tip, expected = (
        series.butterworth(time, values, "lowpass", (CORNER,)).values
        for values in (found.tip, found.expected)
    )
    at_modes = series.shock_spectrum(time, found.wall, found.frequencies[:4], q=Q).values
    by_spectrum = math.hypot(*(found.participations[:4] * at_modes))
    return Checks(
        amplification=float(spectrum.values[most] / PEAK),
        cycles=float(spectrum.frequency[most] * DURATION),
        velocity=float(slow.values[0] / (2 / np.pi * PEAK * DURATION)),
        tip=float(np.abs(tip - expected).max() / np.abs(expected).max()),
        by_spectrum=float(np.abs(found.tip).max() / by_spectrum),
    )


def picture(results: solver.Results, found: Shock) -> Figure:
    """By the words that `duhamel plot` takes."""
    ends = ("acceleration:shelf.wall:z", "acceleration:shelf.tip:z")
    panels = [
        [curve for end in ends for curve in view.curves(results, text.format(end), gravities=True)]
        for text in ("{}", "srs({}, q=10)", "srs({}, q=10, pseudo-velocity)")
    ]
    figure = view.draw(results.time, panels, "A shelf on a drop table, half a sine of 50 g in 6 ms")
    with view.style():
        motion, spectrum, _ = figure.axes
        scale = 1e3 if "ms" in motion.get_xlabel() else 1.0
        dashed = {"color": "0.2", "linewidth": 0.8, "linestyle": (0, (4, 3))}
        motion.plot(scale * found.time, found.expected / G, **dashed)
        spectrum.axhline(1.65 * PEAK / G, **dashed)
    return figure


def report(found: Shock, checks: Checks) -> None:
    print(
        f"spectrum of the wall   {checks.amplification:.3f} x 50 g at f T = {checks.cycles:.2f}, "
        f"Q = 10"
    )
    print(f"change of velocity     pseudo-velocity at 5 Hz is {checks.velocity:.4f} of it")
    print(f"first frequency held   {found.frequencies[0]:.1f} Hz")
    print(
        f"peak of the tip        {np.abs(found.tip).max() / G:.1f} g, held mesh within "
        f"{checks.tip:.1e}; {checks.by_spectrum:.3f} of that by the spectrum and four modes"
    )


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
