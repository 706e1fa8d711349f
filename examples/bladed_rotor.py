"""A rotor with three solid blades, one of which is struck.

    python examples/bladed_rotor.py [FOLDER]

runs examples/bladed_rotor.toml, whose blades are one superelement used three times. It checks that
the blades move alike until one is struck, the angular momentum, and what the blow adds to that
blade against Duhamel's integral over modes of the finite element mesh with its root held, found
without the superelement. Writes results and pictures to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from duhamel import preprocess, solver, superelement, view
from duhamel.preprocess import assemble
from duhamel.results import quantities
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/blade/blade.toml"
BLADES = ("1", "2", "3")
SPUN, BLOW = 0.051, 0.1
"""after the torque, and when the blow begins [s]"""
AFTER = 0.03
"""how long the struck blade is compared, a first period [s]"""
MOMENTUM = 2.0
"""what the torque leaves, 40 N m for 0.05 s [N m s]"""
MODES = 30
"""of the blade with its root held, up to 9 kHz"""
HUB = (0.06, 0.03)
"""radius and height in the picture [m]"""


@dataclass(frozen=True, eq=False)
class Motion:
    """time (n,) [s]; deflections (3, n) of the tips along the axis of the rotor, seen from their
    seats, and what the blow adds to the first by Duhamel's integral, expected (n,) [m].
    """

    time: Array
    deflections: Array
    expected: Array


@dataclass(frozen=True)
class Checks:
    """Largest differences, relative.

    alike: of the tips from one another before the blow; momentum: of the angular momentum from what
    the torque leaves; struck: of what the blow adds to the first blade from Duhamel's integral.
    """

    alike: float
    momentum: float
    struck: float


def main(folder: Path) -> tuple[Motion, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/bladed_rotor.toml")
    target = folder / "bladed-rotor.h5"
    results = solver.simulate(model, output=target)
    found = motion(model, solver.Results.read(target))
    checks = compare(results, found)
    with view.style():
        view.save(curves(found, results), folder / "bladed-rotor.png")
        view.save(stressed_rotor(results), folder / "bladed-rotor-stress.png")
    assert checks.alike < 1e-9
    assert checks.momentum < 1e-5
    assert checks.struck < 0.1
    return found, checks


def ensure_superelement() -> Path:
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    return target


def motion(model: solver.Model, results: solver.Results) -> Motion:
    tips = [
        quantities.displacement(results, f"blade_{n}.tip", seen_from=f"hub.seat_{n}")[:, 2]
        for n in BLADES
    ]
    time = results.time
    (blow,) = [load for load in model.loads if load.on == "blade_1.tip"]
    force = blow.direction[2] * blow.signal.samples(time, time[1])
    return Motion(time, np.array(tips), held_blade(time, force))


def held_blade(time: Array, force: Array) -> Array:
    """The deflection (n,) [m] along z of the tip of a blade whose root is held, under a force (n,)
    there along z [N].

        u(t) = sum_i phi_i^2 / omega_i int_0^t sin(omega_i (t - s)) f(s) ds

    from the modes of K u + P^T lambda = omega^2 M u, P u = 0 at the root, with the trapezoidal rule
    over the steps.
    """
    body = preprocess.read_body(BODY)
    structure = assemble(body)
    root, tip = structure.P_C[:6], structure.P_C[6:]
    K = sp.block_array([[structure.K, root.T], [root, None]], format="csc")
    M = sp.block_diag([structure.M, sp.csc_array((6, 6))], format="csc")
    squares, shapes = eigsh(K, MODES, M, sigma=0.0)
    phi, omega = (tip @ shapes[:-6])[2], np.sqrt(squares)
    h = time[1]
    response = (phi**2 / omega) @ np.sin(omega[:, None] * time)
    return h * np.convolve(force, response)[: len(time)]


def compare(results: solver.Results, found: Motion) -> Checks:
    before = found.time <= BLOW
    first = (found.time > BLOW) & (found.time <= BLOW + AFTER)
    tips = found.deflections
    added = tips[0] - tips[1]
    spin = results.momentum.angular[found.time > SPUN, 2]
    return Checks(
        alike=largest(tips[:, before] - tips[0, before]) / largest(tips[:, before]),
        momentum=largest(spin / MOMENTUM - 1.0),
        struck=largest((added - found.expected)[first]) / largest(found.expected[first]),
    )


def largest(values: Array) -> float:
    return float(np.abs(values).max())


def curves(found: Motion, results: solver.Results) -> Figure:
    figure, (speed, tips, added) = view.panels(3)
    blue, red, green, *_ = view.COLORS
    speed.plot(found.time, results.body("hub").v[:, 5], color=blue)
    for n, color, line in zip((0, 1, 2), (red, blue, green), ("-", "-", (0, (4, 3))), strict=True):
        tips.plot(
            found.time,
            1e3 * found.deflections[n],
            color=color,
            linestyle=line,
            label=f"blade {n + 1}",
        )
    added.plot(
        found.time,
        1e3 * (found.deflections[0] - found.deflections[1]),
        color=red,
        label="blade 1 less blade 2",
    )
    added.plot(
        found.time,
        1e3 * found.expected,
        color="0.2",
        linestyle=(0, (4, 3)),
        label="Duhamel's integral",
    )
    speed.set(title="speed of the hub", ylabel="[rad/s]")
    tips.set(title="tips seen from their seats, along the axis of the rotor", ylabel="[mm]")
    added.set(title="what the blow adds", ylabel="[mm]", xlabel="time [s]")
    for axes in (tips, added):
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=3)
    view.entitle(figure, "A rotor with three blades, one of which is struck")
    return figure


def stressed_rotor(results: solver.Results) -> Figure:
    """The rotor when the stress in the struck blade is largest."""
    time = results.time[results.time >= BLOW]
    worst = float(time[results.von_mises("blade_1", time).max(axis=1).argmax()])
    cells = results.superelement("blade_1").recovery.cells
    bodies = [f"blade_{n}" for n in BLADES]
    fields = [
        view.Field(results.position(body, worst), cells, results.von_mises(body, worst))
        for body in bodies
    ]
    return view.draw_fields(fields, "von Mises stress [MPa]", 1e-6, view.Scene(hub()))


def hub() -> list[view.Patch]:
    """A disk with a rim of flat sides."""
    radius, height = HUB
    angles = np.linspace(0.0, 2.0 * np.pi, 73)
    circle = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    lower, upper = (
        np.column_stack([circle, np.full(len(circle), side * 0.5 * height)]) for side in (-1.0, 1.0)
    )
    rim = np.stack([lower[:-1], lower[1:], upper[1:], upper[:-1]], axis=1)
    ends = np.stack([upper[:-1], lower[-2::-1]])
    return [view.Patch(facets, np.full(len(facets), -1)) for facets in (rim, ends)]


def report(checks: Checks) -> None:
    print(f"blades before the blow      alike within {checks.alike:.2e} of their deflection")
    print(f"angular momentum            as the torque left it within {checks.momentum:.2e}")
    print(
        "what the blow adds          Duhamel's integral over the held blade within "
        f"{checks.struck:.2e} of its peak"
    )


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target)[1])
    print(f"results and pictures: {target}")
