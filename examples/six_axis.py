"""A beam on a shaker of six axes that follows a recorded acceleration.

    python examples/six_axis.py [FOLDER]

The record, examples/six_axis.csv, has the accelerations of the place where the beam is clamped, in
g and rad/s^2 over milliseconds. The motion of the table is compared with the record integrated by
scipy, and the tip of the beam with five modes of a cantilever on that base, by scipy too. Writes
results and a picture to FOLDER, by default out/.

The record itself was made by `write_record`: noise of 8 to 60 Hz that sets in and ends smoothly.
"""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from duhamel import solver, view
from matplotlib.figure import Figure
from numpy.typing import NDArray
from rotating_beam import ensure_superelement
from scipy.interpolate import make_interp_spline
from scipy.optimize import brentq
from scipy.signal import lsim
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
RECORD = ROOT / "examples/six_axis.csv"
EI, MASS_PER_LENGTH, L, G = 5.5, 0.0858, 0.5, 9.81
MODES = 5
REFERENCE: dict[str, Any] = {"color": "0.15", "marker": "o", "linestyle": "", "markersize": 2.0}
SPARSE = 60
"""steps between the points of the reference"""
COLUMNS = ("ax [g]", "ay [g]", "az [g]", "roll [rad/s2]", "pitch [rad/s2]", "yaw [rad/s2]")
BAND, LINEAR, ANGULAR = (8.0, 60.0), 0.1, 3.0
"""of the noise [Hz], and its root mean square along [g] and about an axis [rad/s^2]"""


@dataclass(frozen=True, eq=False)
class Found:
    """time (n,) [s]; position (n, 3) [m] and angles (n, 3) [rad] of the place of the clamp, and
    those expected; tip (n, 2) [m]: the deflection along y and z of the table, and that expected.
    """

    time: Array
    position: Array
    angles: Array
    tip: Array
    expected_position: Array
    expected_angles: Array
    expected_tip: Array

    @property
    def errors(self) -> tuple[float, float, float]:
        """Largest differences of positions [m], of angles [rad], and of the tip over its peak."""
        pairs = (
            (self.position, self.expected_position),
            (self.angles, self.expected_angles),
            (self.tip, self.expected_tip),
        )
        position, angle, tip = (float(np.abs(a - b).max()) for a, b in pairs)
        return position, angle, tip / float(np.abs(self.expected_tip).max())


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/six_axis.toml")
    results = solver.simulate(model, output=folder / "six-axis.h5")
    print(results.solver["drift"])
    found = compared(results)
    with view.style():
        view.save(curves(found), folder / "six-axis.png")
    position, angle, tip = found.errors
    assert position < 1e-14
    assert angle < 1e-14
    assert tip < 2e-3
    return found


def write_record(path: Path) -> None:
    """500 samples a second, of four digits behind the point."""
    time = np.arange(501) / 500.0
    window = solver.Window((0.0, 1.0), 0.1, 0.1)
    columns = [1e3 * time]
    for seed in range(6):
        density = (LINEAR if seed < 3 else ANGULAR) ** 2 / (BAND[1] - BAND[0])
        noise = solver.Noise(density, BAND, period=1.0, seed=seed)
        columns.append(solver.Product((noise, window)).values_at(time))
    rows = np.column_stack(columns)
    header = ",".join(["t [ms]", *COLUMNS])
    np.savetxt(path, rows, "%.4f", ",", header=header, comments="")


def recorded() -> tuple[Array, Array]:
    """Times (n,) [s] and accelerations (n, 6) [m/s^2, rad/s^2] of the record."""
    rows = np.loadtxt(RECORD, delimiter=",", skiprows=1)
    return 1e-3 * rows[:, 0], rows[:, 1:] * np.array([G, G, G, 1.0, 1.0, 1.0])


def compared(results: solver.Results) -> Found:
    top, tip = results.frame("table.top"), results.frame("beam.tip")
    turns = Rotation.from_quat(top.rotation, scalar_first=True)
    bent = turns.inv().apply(tip.position - top.position)
    position, angles, expected_tip = integrated(results.time)
    return Found(
        results.time,
        top.position - top.position[0],
        turns.as_euler("ZYX")[:, ::-1],
        bent[:, 1:],
        position,
        angles,
        expected_tip,
    )


def integrated(time: Array) -> tuple[Array, Array, Array]:
    """Position and angles of the base (n, 3), and deflection of the tip along y and z (n, 2).

    The record, linear between its rows, is integrated twice as a spline of first order; the beam by
    its modes in the axes of the base, q'' + omega^2 q = -(acceleration of the base, of each place
    of the beam), to first order in the angles.
    """
    record = make_interp_spline(*recorded(), k=1)
    motion, given = record.antiderivative(2)(time), record(time)
    position, angles = motion[:, :3], motion[:, 3:]
    axes = Rotation.from_euler("ZYX", angles[:, ::-1])
    _, a_y, a_z = axes.inv().apply(given[:, :3]).T
    _, pitch, yaw = given[:, 3:].T
    tip = np.zeros((len(time), 2))
    for omega, shift, turn, end in zip(*cantilever(), strict=True):
        oscillator = ([-1.0], [1.0, 0.0, omega**2])
        for axis, load in enumerate((shift * a_y + turn * yaw, shift * a_z - turn * pitch)):
            _, q, _ = lsim(oscillator, load, time)
            tip[:, axis] += end * q
    return position, angles, tip


def cantilever() -> tuple[Array, Array, Array, Array]:
    """Of each mode: frequency [rad/s], participation in a shift of its base and in a turn about it,
    and tip value.

    phi = cosh - cos - sigma (sinh - sin) has the mean square 1, int phi = 2 sigma L / k and int x
    phi = 2 L^2 / k^2.
    """
    roots = [
        brentq(lambda k: np.cos(k) + 1.0 / np.cosh(k), np.pi * i, np.pi * (i + 1))
        for i in range(MODES)
    ]
    k = np.array(roots)
    sigma = (np.cosh(k) + np.cos(k)) / (np.sinh(k) + np.sin(k))
    omega = k**2 * np.sqrt(EI / (MASS_PER_LENGTH * L**4))
    return omega, 2.0 * sigma / k, 2.0 * L / k**2, 2.0 * (-1.0) ** np.arange(MODES)


def curves(found: Found) -> Figure:
    figure, (given, moved, turned, tip) = view.panels(4)
    at, record = recorded()
    for i, (axis, color) in enumerate(zip("xyz", view.COLORS, strict=False)):
        given.plot(at, record[:, i] / G, color=color, linewidth=0.8, label=axis)
        moved.plot(found.time, 1e3 * found.position[:, i], color=color, label=axis)
        turned.plot(found.time, 1e3 * found.angles[:, i], color=color, label=axis)
    for i, (axis, color) in enumerate(zip("yz", view.COLORS[1:], strict=False)):
        tip.plot(found.time, 1e3 * found.tip[:, i], color=color, label=axis)
        tip.plot(found.time[::SPARSE], 1e3 * found.expected_tip[::SPARSE, i], **REFERENCE)
    tip.lines[-1].set_label("modes by scipy")
    given.set(title="recorded accelerations", ylabel="[g]")
    moved.set(title="displacement of the table", ylabel="[mm]")
    turned.set(title="rotation of the table", ylabel="[mrad]")
    tip.set(title="tip in the axes of the table", ylabel="[mm]")
    tip.set(xlabel="time [s]")
    for axes in (given, moved, turned, tip):
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    view.entitle(figure, "A beam on a shaker of six axes")
    return figure


def report(found: Found) -> None:
    position, angle, tip = found.errors
    peak = float(np.abs(found.tip).max())
    print(f"table                       position within {position:.1e} m, angles {angle:.1e} rad")
    print(f"tip of the beam             peak {1e3 * peak:.3f} mm, within {tip:.1e} of it")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"results and pictures: {target}")
