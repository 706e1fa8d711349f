"""A blade that runs up through a resonance, and its Campbell diagram.

    python examples/run_up.py [FOLDER]

A solid blade of steel turns about its root. Kicked at steady speeds, it vibrates with frequencies
that are compared with those of a rotating beam, out of the plane of rotation and in it; the same
without the terms of second order is drawn beside it. Then examples/run_up.toml drives it from rest
to 60 revolutions a second, under a force at the tip that comes twice a revolution, and the tip is
compared with that of the rotating beam, integrated by scipy. Writes results and pictures to FOLDER,
by default out/.
"""

import sys
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from duhamel.results import quantities
from matplotlib.figure import Figure
from numpy.typing import NDArray
from rotating_theory import RotatingBeam, peak_frequency
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/bar/spun.toml"
L, WIDTH, HEIGHT = 0.5, 0.02, 0.01
Z = np.array([0.0, 0.0, 1.0])
SPINS = np.linspace(0.0, 360.0, 5)
"""of the Campbell diagram [rad/s]"""
RINGING = 0.3
"""how long the blade rings at each [s]"""
ORDER, FORCE = 2, 4.0
"""of the excitation: times a revolution, and its size [N]"""
MODES = 3
"""of the rotating beam under it, up to 600 Hz"""
CURVES = ("flap 1", "lag 1", "flap 2")
"""vibrations out of the plane of rotation and in it"""


@dataclass(frozen=True, eq=False)
class Campbell:
    """Frequencies (n, 3) [rad/s] of CURVES at SPINS, with the terms of second order and without
    them; expected: of the rotating beam.
    """

    found: Array
    without: Array
    expected: Array

    @property
    def error(self) -> float:
        return float(np.abs(self.found / self.expected - 1.0).max())


@dataclass(frozen=True, eq=False)
class RunUp:
    """time (n,) [s]; spin (n,) [rad/s]; deflection of the tip out of the plane of rotation (n,)
    [m], without the terms of second order, and as expected.
    """

    time: Array
    spin: Array
    deflection: Array
    without: Array
    expected: Array

    @property
    def error(self) -> float:
        """Largest difference over the peak."""
        return float(np.abs(self.deflection - self.expected).max() / np.abs(self.expected).max())


def main(folder: Path) -> tuple[Campbell, RunUp]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/run_up.toml")
    diagram, found = campbell(model), run_up(model, folder / "run-up.h5")
    with view.style():
        view.save(campbell_diagram(diagram), folder / "campbell.png")
        view.save(curves(found), folder / "run-up.png")
    assert diagram.error < 4e-3
    assert found.error < 0.03
    return diagram, found


def ensure_superelement() -> None:
    if not (target := BODY.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)


def beams() -> tuple[RotatingBeam, RotatingBeam]:
    """The blade as it bends out of the plane of rotation, and in it."""
    material = preprocess.read_body(BODY).material
    A = WIDTH * HEIGHT
    flap, lag = (material.E * A * side**2 / 12.0 for side in (HEIGHT, WIDTH))
    return RotatingBeam(L, flap, material.rho * A), RotatingBeam(L, lag, material.rho * A)


def first_order(model: solver.Model) -> solver.Model:
    """The same without the terms of second order; what warns of that is not wanted here."""
    warnings.simplefilter("ignore", solver.ValidityWarning)
    return replace(model, bodies={"blade": replace(model.bodies["blade"], second_order="off")})


def campbell(model: solver.Model) -> Campbell:
    expected = expected_at(SPINS)
    found, without = (
        np.array([frequencies(kind, *at) for at in zip(SPINS, expected, strict=True)])
        for kind in (model, first_order(model))
    )
    return Campbell(found, without, expected)


def expected_at(spins: Array) -> Array:
    """CURVES of the rotating beam (n, 3) [rad/s]."""
    flap, lag = beams()
    return np.array([[flap.flap(s)[0], lag.lag(s)[0], flap.flap(s)[1]] for s in spins])


def frequencies(model: solver.Model, spin: float, near: Array) -> list[float]:
    """Of CURVES [rad/s], after a kick at the tip while the blade turns steadily."""
    (shaft,) = model.joints
    kick = solver.Force("blade.tip", [0, 1, 1], solver.Pulse(50.0, 1e-3, 2e-3), follower=True)
    steady = replace(
        model,
        joints=(replace(shaft, angle=solver.Polynomial((0.0, spin))),),
        loads=(kick,),
    ).with_settings(
        t_end=RINGING, start="equilibrium", steady_rotation=solver.SteadyRotation(spin * Z)
    )
    tip = in_turning_axes(solver.simulate(steady))
    step = model.settings.step
    return [
        peak_frequency(tip[:, 1 if "lag" in name else 2], step, f)
        for name, f in zip(CURVES, near, strict=True)
    ]


def in_turning_axes(results: solver.Results) -> Array:
    """The tip (n, 3) in axes that turn with the shaft [m]."""
    angle = results.joint("shaft").coordinates["angle"]
    x, y, z = results.frame("blade.tip").position.T
    cos, sin = np.cos(angle), np.sin(angle)
    return np.column_stack([cos * x + sin * y, cos * y - sin * x, z])


def run_up(model: solver.Model, target: Path) -> RunUp:
    (shaft,) = model.joints
    excited = replace(model, loads=(excitation(shaft),))
    results = solver.simulate(excited, output=target)
    without = solver.simulate(first_order(excited))
    time = results.time
    return RunUp(
        time,
        angle_of(shaft).deriv()(time),
        quantities.position(results, "blade.tip")[:, 2],
        quantities.position(without, "blade.tip")[:, 2],
        forced_beam(time, shaft),
    )


def angle_of(shaft: solver.Joint) -> np.polynomial.Polynomial:
    return np.polynomial.Polynomial(shaft.angle.coefficients)


def excitation(shaft: solver.Joint) -> solver.Load:
    """F cos(k psi) at the tip, across the plane of rotation."""
    angle = angle_of(shaft)

    def force(t: float) -> float:
        return FORCE * float(np.cos(ORDER * angle(t)))

    return solver.Force("blade.tip", Z, solver.Function(force))


def forced_beam(time: Array, shaft: solver.Joint) -> Array:
    """The tip (n,) [m] of the rotating beam, in its modes at rest:

    q'' + b diag(omega^2) q' + (diag(omega^2) + psi'^2 S) q = f F cos(k psi)
    """
    beam, damping = beams()[0], preprocess.read_body(BODY).damping.rayleigh.stiffness
    squares, shapes = eigh(beam.K, beam.M, subset_by_index=[0, MODES - 1])
    S, f = shapes.T @ beam.S @ shapes, beam.tip @ shapes
    angle = angle_of(shaft)
    spin = angle.deriv()

    def rates(t: float, state: Array) -> Array:
        q, rate = state[:MODES], state[MODES:]
        load = f * FORCE * np.cos(ORDER * angle(t))
        stiffening = spin(t) ** 2 * (S @ q)
        return np.concatenate([rate, load - squares * (q + damping * rate) - stiffening])

    start = np.concatenate([f * FORCE / squares, np.zeros(MODES)])
    states = solve_ivp(rates, (0.0, time[-1]), start, "DOP853", t_eval=time, rtol=1e-6, atol=1e-9).y
    return f @ states[:MODES]


def campbell_diagram(found: Campbell) -> Figure:
    """The second flap above, lag and first flap below, all over revolutions a second."""
    figure, (second, first) = view.panels(2)
    turns, fine = SPINS / (2.0 * np.pi), np.linspace(0.0, SPINS[-1], 101)
    theory = expected_at(fine)
    for i, (name, color) in enumerate(zip(CURVES, view.COLORS, strict=False)):
        axes = second if name == "flap 2" else first
        look = {"color": color, "linestyle": ""}
        axes.plot(fine / (2 * np.pi), theory[:, i] / (2 * np.pi), color=color, linewidth=0.9)
        axes.plot(turns, found.found[:, i] / (2 * np.pi), marker="o", label=name, **look)
        axes.plot(turns, found.without[:, i] / (2 * np.pi), marker="x", **look)
    for order in (1, 2, 3, 4, 5):
        for axes in (first, second):
            axes.plot(turns, order * turns, color="0.7", linewidth=0.6)
    second.set(
        title="lines: rotating beam; dots: solid; crosses: without second order",
        ylabel="[Hz]",
        ylim=(190, 270),
    )
    first.set(title="grey: 1 to 5 times a revolution", ylabel="[Hz]", ylim=(0, 80))
    first.set(xlabel="revolutions a second")
    for axes in (first, second):
        axes.legend(loc="upper left")
    view.entitle(figure, "Campbell diagram of a blade")
    return figure


def curves(found: RunUp) -> Figure:
    figure, (spin, tip, without) = view.panels(3)
    blue, red, *_ = view.COLORS
    spin.plot(found.time, found.spin / (2.0 * np.pi), color=blue)
    for axes, deflection, color, label in (
        (tip, found.deflection, blue, "solid"),
        (without, found.without, red, "without second order"),
    ):
        axes.plot(found.time, 1e3 * deflection, color=color, linewidth=0.8, label=label)
        axes.plot(
            found.time, 1e3 * found.expected, color="0.2", linewidth=0.5, label="rotating beam"
        )
        axes.set(title="tip across the plane of rotation", ylabel="[mm]")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=2)
    spin.set(title="revolutions a second")
    without.set(xlabel="time [s]")
    view.entitle(figure, "A blade that runs up through a resonance")
    return figure


def report(diagram: Campbell, found: RunUp) -> None:
    print("frequencies over spin       [rad/s]: " + ", ".join(CURVES) + "; without second order")
    for spin, row, without in zip(SPINS, diagram.found, diagram.without, strict=True):
        print(
            f"  {spin:6.1f}        " + "".join(f"{f:9.2f}" for f in row) + "   "
            "" + "".join(f"{f:9.2f}" for f in without)
        )
    print(f"rotating beam               frequencies within {diagram.error:.2e}")
    peak, expected = np.abs(found.deflection).argmax(), np.abs(found.expected).argmax()
    print(
        f"largest deflection          {1e3 * np.abs(found.deflection[peak]):.3f} mm at "
        f"{found.spin[peak]:.1f} rad/s, rotating beam {1e3 * abs(found.expected[expected]):.3f} mm "
        f"at {found.spin[expected]:.1f} rad/s"
    )
    print(f"run up                      tip within {found.error:.2e} of its peak")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
