"""An unbalanced rotor that runs through its first critical speed.

    python examples/unbalance.py [FOLDER]

runs examples/unbalance.toml: a shaft with a disk on two bearings, one superelement with the terms
of fast rotation. The whirl of the disk is compared with that of finite elements of a beam in axes
fixed in space, with gyroscopic matrix, integrated by scipy, and drawn over the speed beside what
would stay at each speed; the same without the terms of second order is drawn too. Writes results
and a picture to FOLDER, by default out/.
"""

import sys
import warnings
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from matplotlib.figure import Figure
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from rotor_theory import rotor_matrices
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, eigvals

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/shaft/rotor.toml"
L, AT = 1.0, 1.0 / 3.0
"""of the shaft [m], and where its disk is, over that"""
ELEMENTS = 30
"""of the reference: none of the superelement"""
MODES = 6
"""of the reference under the unbalance, at rest"""


@dataclass(frozen=True)
class Shaft:
    """Finite elements of the rotor in axes fixed in space, see rotor_theory.py:

    M w'' + (C - i spin G) w' + K w = force
    """

    model: solver.Model

    @property
    def disk(self) -> int:
        """The row of its deflection."""
        return 2 * round(AT * ELEMENTS)

    @cached_property
    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """M, C, G, K (n, n)"""
        body = preprocess.read_body(BODY)
        section, disk = body.section, body.masses["disk"]
        polar, diametral, _ = np.diag(disk.inertia)
        mass = disk.mass + self.model.bodies["unbalance"].mass
        M, G, K = rotor_matrices(
            section, L, ELEMENTS, {round(AT * ELEMENTS): (mass, polar, diametral)}
        )
        C = np.zeros_like(M)
        for spring in self.model.springs:
            if spring.name in ("left", "right"):
                row = 0 if spring.name == "left" else len(K) - 2
                K[row, row] += spring.stiffness[1, 1]
                C[row, row] += spring.damping[1, 1]
        return M, C, G, K

    @property
    def unbalance(self) -> float:
        """Mass times its distance from the axis [kg m]."""
        part = self.model.bodies["unbalance"]
        return float(part.mass * np.linalg.norm(part.frames["seat"].position))

    def critical_speeds(self) -> Array:
        """Forward (n,) [rad/s], lowest first: det(K + s^2 (G - M)) = 0."""
        M, _, G, K = self.matrices
        squares = eigvals(K, M - G)
        real = squares[np.isfinite(squares) & (np.abs(squares.imag) < 1e-6 * np.abs(squares))].real
        return np.sqrt(np.sort(real[real > 0.0]))

    def steady(self, speeds: Array) -> Array:
        """The radius (n,) [m] on which the disk whirls at each speed for ever."""
        M, C, G, K = self.matrices
        force = np.zeros(len(K))
        force[self.disk] = self.unbalance
        return np.array(
            [
                np.abs(np.linalg.solve(K + 1j * s * C + s**2 * (G - M), s**2 * force)[self.disk])
                for s in speeds
            ]
        )

    def run_up(self, time: Array, angle: Polynomial) -> Complex:
        """y + i z (n,) [m] of the disk that is turned by `angle`, in the lowest modes at rest."""
        M, C, G, K = self.matrices
        squares, V = eigh(K, M, subset_by_index=[0, MODES - 1])
        C, G, f = V.T @ C @ V, V.T @ G @ V, self.unbalance * V[self.disk]
        spin, acceleration = angle.deriv(1), angle.deriv(2)

        def rates(t: float, state: Complex) -> Complex:
            q, rate, s = state[:MODES], state[MODES:], spin(t)
            load = f * (s**2 - 1j * acceleration(t)) * np.exp(1j * angle(t))
            return np.concatenate([rate, load - squares * q - C @ rate + 1j * s * (G @ rate)])

        states = solve_ivp(
            rates,
            (0.0, time[-1]),
            np.zeros(2 * MODES, complex),
            "DOP853",
            t_eval=time,
            rtol=1e-6,
            atol=1e-10,
        ).y
        return V[self.disk] @ states[:MODES]


@dataclass(frozen=True, eq=False)
class Whirl:
    """time (n,) [s]; speed (n,) [rad/s]; y + i z of the disk (n,) [m], without the terms of second
    order, and as expected; critical: the forward critical speed [rad/s].
    """

    time: Array
    speed: Array
    disk: Complex
    without: Complex
    expected: Complex
    critical: float

    @property
    def error(self) -> float:
        """Largest difference over the peak."""
        return float(np.abs(self.disk - self.expected).max() / np.abs(self.expected).max())


def main(folder: Path) -> Whirl:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/unbalance.toml")
    found = run_up(model, folder / "unbalance.h5")
    with view.style():
        view.save(curves(found, Shaft(model)), folder / "unbalance.png")
    assert found.error < 5e-3
    return found


def ensure_superelement() -> None:
    if not (target := BODY.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)


def run_up(model: solver.Model, target: Path) -> Whirl:
    (drive,) = [joint for joint in model.joints if joint.name == "motor"]
    angle, shaft = Polynomial(drive.angle.coefficients), Shaft(model)
    results = solver.simulate(model, output=target)
    warnings.simplefilter("ignore", solver.ValidityWarning)
    rotor = replace(model.bodies["rotor"], second_order="off")
    without = solver.simulate(replace(model, bodies={**model.bodies, "rotor": rotor}))
    time = results.time
    return Whirl(
        time,
        angle.deriv()(time),
        disk(results),
        disk(without),
        shaft.run_up(time, angle),
        shaft.critical_speeds()[0],
    )


def disk(results: solver.Results) -> Complex:
    y, z = results.frame("rotor.disk").position[:, 1:].T
    return y + 1j * z


def curves(found: Whirl, shaft: Shaft) -> Figure:
    figure, (radius, apart) = view.panels(2)
    blue, red, *_ = view.COLORS
    speeds = np.linspace(0.0, found.speed[-1], 801)
    turning = found.speed
    radius.plot(speeds, 1e3 * shaft.steady(speeds), color="0.7", label="at each speed for ever")
    radius.plot(turning, 1e3 * np.abs(found.disk), color=blue, label="superelement")
    radius.plot(
        turning,
        1e3 * np.abs(found.expected),
        color="0.2",
        linestyle=(0, (4, 3)),
        label="finite elements in space",
    )
    radius.plot(turning, 1e3 * np.abs(found.without), color=red, label="without second order")
    highest = 1.3e3 * np.abs(found.disk).max()
    radius.set(title="radius of the whirl", ylabel="[mm]", ylim=(0.0, highest))
    for whirl, color, label in (
        (found.disk, blue, "superelement"),
        (found.without, red, "without second order"),
    ):
        apart.plot(turning, 1e3 * np.abs(whirl - found.expected), color=color, label=label)
    apart.set(title="distance from finite elements in space", ylabel="[mm]", xlabel="speed [rad/s]")
    for axes in (radius, apart):
        axes.axvline(found.critical, color="0.8", linewidth=0.8)
        axes.legend(loc="upper left")
    view.entitle(figure, "An unbalanced rotor runs through its critical speed")
    return figure


def report(found: Whirl) -> None:
    peak, expected = np.abs(found.disk).argmax(), np.abs(found.expected).argmax()
    print(f"forward critical speed      {found.critical:.3f} rad/s")
    print(
        f"largest whirl               {1e3 * abs(found.disk[peak]):.4f} mm at "
        f"{found.speed[peak]:.1f} rad/s, finite elements in space "
        f"{1e3 * abs(found.expected[expected]):.4f} mm at {found.speed[expected]:.1f} rad/s"
    )
    print(f"whirl                       within {found.error:.2e} of its peak")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"results and picture: {target}")
