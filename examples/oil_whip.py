"""A rotor on fluid films and pedestals: whirl over the spin, and a run-up into oil whip.

    python examples/oil_whip.py [FOLDER]

Linear analyses of examples/oil_whip.toml give the Campbell diagram, the speed above which the films
drive a whirl, and orbits under unbalance. Then the model runs up through its critical speeds and
beyond that speed: the rotor whirls at its natural frequency while the spin goes on. All is compared
with finite elements of a beam in axes fixed in space. Writes results and pictures to FOLDER, by
default out/.

    python examples/oil_whip.py --table    # write examples/oil_whip.csv anew
"""

import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from matplotlib.figure import Figure
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from rotor_theory import rotor_matrices
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.signal import stft

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/shaft/long.toml"
MODEL = ROOT / "examples/oil_whip.toml"
TABLE = ROOT / "examples/oil_whip.csv"
NAMES = "kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy"
LOAD, CLEARANCE, VISCOSITY, WIDTH, DIAMETER = 525.0, 1e-4, 0.1, 0.03, 0.1
TABLE_SPEEDS = np.arange(30.0, 401.0, 10.0)
L, ELEMENTS, ONE, TWO = 1.5, 24, 8, 16
"""of the reference, and the nodes of its disks"""
MODES = 6
"""of the reference in the run-up, with its bearings held; none of the superelement"""
STEP = 1e-3
SPINS = np.linspace(40.0, 330.0, 30)
"""of the Campbell diagram and the stability map [rad/s]"""
ORBIT_SPINS = np.linspace(40.0, 330.0, 88)
UNBALANCE = 1e-3
"""at the first disk [kg m]"""
LINES = 8


def main(folder: Path) -> "tuple[Linear, RunUp]":
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(MODEL)
    reference = Reference(model)
    linear = linear_analyses(model, reference)
    run = run_up(model, reference, folder / "oil-whip.h5")
    with view.style():
        view.save(draw_linear(linear), folder / "oil-whip-linear.png")
        view.save(draw_run(run, linear), folder / "oil-whip.png")
    assert linear.eigenvalue_error < 1e-4
    assert linear.orbit_error < 1e-3
    assert abs(linear.threshold / linear.expected_threshold - 1.0) < 1e-4
    assert run.error < 0.05
    return linear, run


def ensure_superelement() -> None:
    if not (target := BODY.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)


def short_bearing(e: Array) -> tuple[Array, Array]:
    """Sommerfeld numbers (n,) and NAMES (n, 8) of a short bearing of eccentricities e (n,).

    Times load / clearance; the load is against y, and x is across it. Source: M. I. Friswell et
    al., Dynamics of Rotating Machines (2010), ch. 5.
    """
    square, root, pi2 = e**2, np.sqrt(1.0 - e**2), np.pi**2
    h = (pi2 * (1.0 - square) + 16.0 * square) ** -1.5
    both = pi2 * (1.0 + 2.0 * square) + 32.0 * square * (1.0 + square) / (1.0 - square)
    cross = pi2 * (1.0 + 2.0 * square) - 16.0 * square
    coefficients = np.array([
        4.0 * (pi2 * (2.0 - square) + 16.0 * square),
        np.pi * (pi2 * (1.0 - square) ** 2 - 16.0 * square**2) / (e * root),
        -np.pi * (1.0 - square) * both / (e * root),
        4.0 * both,
        2.0 * np.pi * root * cross / e,
        -8.0 * cross,
        -8.0 * cross,
        2.0 * np.pi * (pi2 * (1.0 - square) ** 2 + 48.0 * square) / (e * root),
    ])  # fmt: skip
    numbers = (
        (DIAMETER / WIDTH) ** 2
        * (1.0 - square) ** 2
        / (np.pi * e * np.sqrt(pi2 * (1.0 - square) + 16.0 * square))
    )
    return numbers, (h * coefficients).T


def eccentricity(spin: float) -> float:
    """The eccentricity at which the film carries the load."""
    per_turn = VISCOSITY * WIDTH * DIAMETER / LOAD * (0.5 * DIAMETER / CLEARANCE) ** 2
    number = per_turn * spin / (2.0 * np.pi)
    return float(brentq(lambda e: short_bearing(np.array([e]))[0][0] - number, 1e-6, 1.0 - 1e-9))


def write_table(path: Path = TABLE) -> None:
    numbers, coefficients = short_bearing(np.array([eccentricity(s) for s in TABLE_SPEEDS]))
    rows = [
        ", ".join(f"{value:.9g}" for value in row)
        for row in np.column_stack([numbers, coefficients])
    ]
    path.write_text("\n".join([", ".join(["sommerfeld", *NAMES]), *rows]) + "\n")


@dataclass(frozen=True)
class Reference:
    """Finite elements of shaft, films and pedestals in axes fixed in space.

    Unknowns: deflections and slopes of the shaft along y, the same along z, then y and z of both
    pedestals.
    """

    model: solver.Model

    @cached_property
    def shaft(self) -> tuple[Array, Array, Array]:
        body = preprocess.read_body(BODY)
        masses = {}
        for node, name in ((ONE, "one"), (TWO, "two")):
            disk = self.model.bodies[name]
            masses[node] = (disk.mass, disk.inertia[0, 0], disk.inertia[1, 1])
        return rotor_matrices(body.section, L, ELEMENTS, masses)

    @cached_property
    def basis(self) -> Array:
        """Shapes of the shaft (n, 2 + MODES): its ends moved, and modes with ends held."""
        M, _, K = self.shaft
        ends = np.array([0, len(K) - 2])
        inner = np.setdiff1d(np.arange(len(K)), ends)
        T = np.zeros((len(K), 2 + MODES))
        T[ends, [0, 1]] = 1.0
        T[inner, :2] = -np.linalg.solve(K[np.ix_(inner, inner)], K[np.ix_(inner, ends)])
        held = (K[np.ix_(inner, inner)], M[np.ix_(inner, inner)])
        T[inner, 2:] = eigh(*held, subset_by_index=[0, MODES - 1])[1]
        return T

    @cached_property
    def pedestals(self) -> tuple[Array, Array, Array]:
        """Masses, stiffnesses and dampings along y and z (4,)."""
        mounts = {spring.name: spring for spring in self.model.springs}
        sides = ("left", "right")
        mass = [self.model.bodies[f"{side}_pedestal"].mass for side in sides for _ in "yz"]
        stiffness = [mounts[f"{side} mount"].stiffness[k, k] for side in sides for k in (0, 1)]
        damping = [mounts[f"{side} mount"].damping[k, k] for side in sides for k in (0, 1)]
        return np.array(mass), np.array(stiffness), np.array(damping)

    def film(self, spin: float) -> tuple[Array, Array]:
        """K and C (2, 2), linear between the speeds of the table."""
        values = np.array([np.interp(spin, TABLE_SPEEDS, column) for column in self._table.T])
        return values[:4].reshape(2, 2), values[4:].reshape(2, 2)

    @cached_property
    def _table(self) -> Array:
        _, table = short_bearing(np.array([eccentricity(s) for s in TABLE_SPEEDS]))
        table = table * LOAD / CLEARANCE
        table[:, 4:] /= TABLE_SPEEDS[:, None]
        return table

    def fixed(self, reduced: bool) -> tuple[Array, Array, Array, Array, Array]:
        """M, C, G and K without films, and the gaps of films by the unknowns (4, n)."""
        T = self.basis if reduced else np.eye(len(self.shaft[0]))
        M, G, K = (T.T @ matrix @ T for matrix in self.shaft)
        mass, stiffness, damping = self.pedestals
        n = len(M)
        whole = [np.zeros((2 * n + 4, 2 * n + 4)) for _ in range(4)]
        for matrix, block, own in ((whole[0], M, mass), (whole[3], K, stiffness)):
            matrix[:n, :n] = matrix[n : 2 * n, n : 2 * n] = block
            matrix[2 * n :, 2 * n :] = np.diag(own)
        whole[1][2 * n :, 2 * n :] = np.diag(damping)
        whole[2][:n, n : 2 * n], whole[2][n : 2 * n, :n] = G, -G
        gaps = np.zeros((4, 2 * n + 4))
        for k, node in enumerate((0, -2)):
            gaps[2 * k, :n] = gaps[2 * k + 1, n : 2 * n] = T[node]
        gaps[:, 2 * n :] = -np.eye(4)
        return whole[0], whole[1], whole[2], whole[3], gaps

    def matrices(self, spin: float) -> tuple[Array, Array, Array]:
        """M, C and K at a spin."""
        M, C, G, K, gaps = self.fixed(reduced=False)
        stiffness, damping = (np.kron(np.eye(2), matrix) for matrix in self.film(spin))
        return M, C + spin * G + gaps.T @ damping @ gaps, K + gaps.T @ stiffness @ gaps

    def eigenvalues(self, spin: float) -> Complex:
        M, C, K = self.matrices(spin)
        inverse = np.linalg.inv(M)
        n = len(M)
        A = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ K, -inverse @ C]])
        return np.linalg.eigvals(A)

    def bending(self, spin: float) -> Complex:
        """Eigenvalues that oscillate below 150 Hz: without those that nothing resists."""
        values = self.eigenvalues(spin)
        return values[(values.imag > 1.0) & (values.imag < 2.0 * np.pi * 150.0)]

    def growth(self, spin: float) -> float:
        return float(self.bending(spin).real.max())

    def disks(self, x: Array | Complex) -> Array | Complex:
        """y and z of both disks (4, ...) of the shaft along y, then z."""
        n = 2 * (ELEMENTS + 1)
        return x[[2 * ONE, n + 2 * ONE, 2 * TWO, n + 2 * TWO]]

    def orbits(self, spin: float) -> Complex:
        """y and z of both disks (4,) under UNBALANCE at the first."""
        M, C, K = self.matrices(spin)
        force = np.zeros(len(M), complex)
        n = 2 * (ELEMENTS + 1)
        force[[2 * ONE, n + 2 * ONE]] = UNBALANCE * spin**2 * np.array([1.0, -1j])
        return self.disks(np.linalg.solve(K + 1j * spin * C - spin**2 * M, force))

    def run_up(self, time: Array, angle: Polynomial) -> Array:
        """y and z of both disks (n, 4) from rest, by Gauss's method of two stages.

        x = a + STEP / 2 (k_1 + k_2), of fourth order, in the shapes of `basis`.
        """
        M, C, G, K, gaps = self.fixed(reduced=True)
        inverse, n, speed = np.linalg.inv(M), len(M), angle.deriv()
        m = 2 + MODES
        at = np.zeros((4, n))
        for row, (node, first) in enumerate(((ONE, 0), (ONE, m), (TWO, 0), (TWO, m))):
            at[row, first : first + m] = self.basis[2 * node]

        def state_matrix(t: float) -> Array:
            spin = float(speed(t))
            stiffness, damping = (np.kron(np.eye(2), matrix) for matrix in self.film(spin))
            D, S = C + spin * G + gaps.T @ damping @ gaps, K + gaps.T @ stiffness @ gaps
            return np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ S, -inverse @ D]])

        def load(t: float) -> Array:
            turn = np.array([np.cos(angle(t)), np.sin(angle(t))])
            push = UNBALANCE * float(speed(t)) ** 2 * at[:2].T @ turn
            return np.concatenate([np.zeros(n), inverse @ push])

        root = np.sqrt(3.0) / 6.0
        weights = np.array([[0.25, 0.25 - root], [0.25 + root, 0.25]])
        x, found = np.zeros(2 * n), [np.zeros(4)]
        times = np.arange(0.0, time[-1] - 0.5 * STEP, STEP)
        for t in times.tolist():
            stages = [t + (0.5 - root) * STEP, t + (0.5 + root) * STEP]
            A = [state_matrix(s) for s in stages]
            left = np.eye(4 * n) - STEP * np.block(
                [[weights[i, k] * A[i] for k in range(2)] for i in range(2)]
            )
            right = np.concatenate([A[i] @ x + load(stages[i]) for i in range(2)])
            x = x + 0.5 * STEP * np.linalg.solve(left, right).reshape(2, -1).sum(axis=0)
            found.append(at @ x[:n])
        return np.array(found)


@dataclass(frozen=True, eq=False)
class Linear:
    """Of the model and of the reference, at SPINS and ORBIT_SPINS.

    eigenvalue_error: the largest difference of an eigenvalue that oscillates, over its size;
    orbits and expected_orbits (n, 2, 2) of both disks along y and z [m].
    """

    diagram: solver.Campbell
    eigenvalue_error: float
    growth: Array
    expected_growth: Array
    threshold: float
    expected_threshold: float
    orbits: Complex
    expected_orbits: Complex
    critical: list[float]

    @property
    def orbit_error(self) -> float:
        """Largest difference over the largest orbit."""
        return float(
            np.abs(self.orbits - self.expected_orbits).max() / np.abs(self.expected_orbits).max()
        )


def linear_analyses(model: solver.Model, reference: Reference) -> Linear:
    spins = SPINS.tolist()
    diagram = solver.campbell(model, spins, LINES)
    stability = solver.stability_map(model, spins)
    response = solver.unbalance_response(model, {"rotor.one": UNBALANCE}, ORBIT_SPINS.tolist())
    expected = [reference.orbits(spin) for spin in ORBIT_SPINS.tolist()]
    (threshold,) = stability.thresholds.tolist()
    names = [response.names.index(f"rotor.{name}") for name in ("one", "two")]
    return Linear(
        diagram,
        max(eigenvalue_error(model, reference, spin) for spin in spins[::6]),
        stability.growth,
        np.array([reference.growth(spin) for spin in spins]),
        threshold,
        float(brentq(reference.growth, spins[0], spins[-1])),
        response.motion[:, names],
        np.array(expected).reshape(-1, 2, 2),
        [spin for spin, _ in response.peaks("rotor.one")],
    )


def eigenvalue_error(model: solver.Model, reference: Reference, spin: float) -> float:
    """Largest difference of the eigenvalues that bend the rotor, below 150 Hz."""
    found = solver.rotor_at(model, spin).modes(24).values
    return max(float(np.abs(found - value).min() / abs(value)) for value in reference.bending(spin))


@dataclass(frozen=True, eq=False)
class RunUp:
    """time (n,) [s]; speed (n,) [rad/s]; y and z of both disks (n, 4) [m], and as expected; y and z
    of the left journal in its pedestal (n, 2) [m].
    """

    time: Array
    speed: Array
    disks: Array
    expected: Array
    journal: Array

    @property
    def error(self) -> float:
        """Largest difference over the peak."""
        return float(np.abs(self.disks - self.expected).max() / np.abs(self.expected).max())


def run_up(model: solver.Model, reference: Reference, target: Path) -> RunUp:
    (drive,) = [joint for joint in model.joints if joint.name == "motor"]
    angle = Polynomial(drive.angle.coefficients)
    results = solver.simulate(model, output=target)
    time = results.time

    def across(name: str) -> Array:
        return np.array(results.frame(f"rotor.{name}").position[:, 1:])

    return RunUp(
        time,
        angle.deriv()(time),
        np.hstack([across("one"), across("two")]),
        reference.run_up(time, angle),
        across("left") - results.body("left_pedestal").x[:, 1:],
    )


def draw_linear(found: Linear) -> Figure:
    figure, (campbell, growth, orbit) = view.panels(3)
    blue, red, *_ = view.COLORS
    for line in found.diagram.lines:
        if line.whirl == "none":  # along the axis and about it
            continue
        color = {"forward": blue, "backward": red}.get(line.whirl, "0.6")
        campbell.plot(SPINS, line.frequencies, color=color, label=line.whirl)
    campbell.plot(SPINS, SPINS / (2.0 * np.pi), color="0.7", linewidth=0.7, label="spin")
    campbell.set(title="whirl", ylabel="[Hz]", ylim=(0.0, 90.0))
    labels = dict(zip(*campbell.get_legend_handles_labels()[::-1], strict=True))
    campbell.legend(labels.values(), labels.keys(), loc="upper left", ncols=len(labels))
    growth.plot(SPINS, found.growth, color=blue, label="superelement")
    growth.plot(SPINS, found.expected_growth, ".", color="0.2", label="finite elements in space")
    growth.axhline(0.0, color="0.8", linewidth=0.8)
    growth.set(title="growth of the least damped mode", ylabel="[1/s]")
    for k, (name, color) in enumerate((("first", blue), ("second", red))):
        size, expected = (
            1e6 * np.linalg.norm(orbits[:, k], axis=1)
            for orbits in (found.orbits, found.expected_orbits)
        )
        orbit.semilogy(ORBIT_SPINS, size, color=color, label=f"{name} disk")
        orbit.semilogy(ORBIT_SPINS[::3], expected[::3], ".", color="0.2")
    orbit.set(title="orbit under unbalance", ylabel="[μm]", xlabel="speed [rad/s]")
    for axes in (growth, orbit):
        axes.legend(loc="upper left")
        axes.axvline(found.threshold, color="0.8", linewidth=0.8)
    view.entitle(figure, "A rotor on fluid films and pedestals")
    return figure


def draw_run(found: RunUp, linear: Linear) -> Figure:
    figure, (spectrum, disk, journal) = view.panels(3)
    blue, *_ = view.COLORS
    rate = 1.0 / (found.time[1] - found.time[0])
    window = int(0.8 * rate)
    frequency, at, amplitude = stft(found.disks[:, 2], rate, "hann", window, int(0.96 * window))
    # Beyond the ends windows are padded, which spreads their spectrum.
    whole = (at >= 0.4) & (at <= found.time[-1] - 0.4)
    at, amplitude = at[whole], amplitude[:, whole]
    speeds = np.interp(at, found.time, found.speed)
    kept = frequency < 70.0
    shown = 20.0 * np.log10(np.abs(amplitude[kept]) + 1e-9)
    spectrum.pcolormesh(speeds, frequency[kept], shown, cmap="magma", rasterized=True,
                        vmin=shown.max() - 60.0)  # fmt: skip
    spectrum.plot(found.speed, found.speed / (2.0 * np.pi), "--", color="w", linewidth=0.6)
    spectrum.set(title="spectrum of the second disk, 60 dB; dashed: the spin", ylabel="[Hz]")
    for axes, moved, expected, title in (
        (disk, found.disks[:, 2], found.expected[:, 2], "second disk along y"),
        (journal, found.journal[:, 0], None, "left journal in its pedestal, along y"),
    ):
        axes.plot(found.speed, 1e6 * moved, color=blue, linewidth=0.5, label="superelement")
        if expected is not None:
            size = np.abs(expected).reshape(-1)
            blocks = np.array_split(np.arange(len(size)), 240)
            crest = np.array([size[block].max() for block in blocks])
            middle = [found.speed[block].mean() for block in blocks]
            axes.plot(middle, 1e6 * crest, color="0.2", label="finite elements in space, crests")
            axes.legend(loc="upper center")
        axes.set(title=title, ylabel="[μm]")
        axes.axvline(linear.threshold, color="0.8", linewidth=0.8)
    journal.set(xlabel="speed [rad/s]")
    view.entitle(figure, "Oil whip: a rotor that runs up beyond its threshold")
    return figure


def report(linear: Linear, run: RunUp) -> None:
    print(f"eigenvalues                 within {linear.eigenvalue_error:.2e}")
    critical = ", ".join(f"{spin:.2f}" for spin in linear.critical)
    print(f"largest orbits              at {critical} rad/s; within {linear.orbit_error:.2e}")
    print(
        f"unstable above              {linear.threshold:.4f} rad/s, finite elements in space "
        f"{linear.expected_threshold:.4f} rad/s"
    )
    late = run.time > run.time[-1] - 1.0
    spectrum = np.abs(np.fft.rfft(run.disks[late, 2] * np.hanning(late.sum())))
    seen = np.fft.rfftfreq(int(late.sum()), run.time[1] - run.time[0])[spectrum.argmax()]
    print(
        f"whirl at the end            {seen:.1f} Hz at a spin of "
        f"{run.speed[-1] / (2.0 * np.pi):.1f} Hz, "
        f"{1e6 * np.abs(run.journal).max():.1f} um in the films"
    )
    print(f"run up                      disks within {run.error:.2e} of their peak")


if __name__ == "__main__":
    if "--table" in sys.argv:
        write_table()
    else:
        target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
        report(*main(target))
        print(f"results and pictures: {target}")
