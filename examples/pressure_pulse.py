"""A clamped plate under a pressure wave.

    python examples/pressure_pulse.py [FOLDER]

runs examples/pressure_pulse.toml: a square plate of solids, whose load is a pattern of its
superelement, and whose strain gauge and accelerometer are sensors of it. Deflection and strain at
rest are compared with thin plates, and those under the wave with one degree of freedom of the first
frequency, as in handbooks. Writes results and a picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/plate/plate.toml"
SIDE, THICKNESS = 0.5, 0.01
"""of the plate [m]"""
DEFLECTION, MOMENT, FREQUENCY = 0.00126532, 0.0229051, 35.9852
"""of a thin clamped square plate: w D / (q a^4) and M / (q a^2) in the middle for nu = 0.3, and
omega a^2 sqrt(rho h / D). Source: R. L. Taylor, S. Govindjee, Communications in Numerical Methods
in Engineering 20 (2004); A. W. Leissa, Vibration of Plates (1969).
"""


@dataclass(frozen=True)
class ThinPlate:
    """Kirchhoff's plate under a uniform pressure, as one degree of freedom."""

    E: float
    nu: float
    rho: float

    @property
    def D(self) -> float:
        """The bending stiffness [N m]."""
        return self.E * THICKNESS**3 / (12.0 * (1.0 - self.nu**2))

    @property
    def omega(self) -> float:
        """The first frequency [rad/s]."""
        return FREQUENCY / SIDE**2 * float(np.sqrt(self.D / (self.rho * THICKNESS)))

    def deflection(self, pressure: float) -> float:
        """At rest, in the middle [m]."""
        return DEFLECTION * pressure * SIDE**4 / self.D

    def strain(self, pressure: float) -> float:
        """At rest, in the middle of the side away from the load: 6 M (1 - nu) / (E h^2)."""
        moment = MOMENT * pressure * SIDE**2
        return 6.0 * moment * (1.0 - self.nu) / (self.E * THICKNESS**2)

    def factor(self, time: Array, rise: float) -> Array:
        """Deflection over that at rest, under a load that rises to 1 and falls as fast.

        (r(t) - 2 r(t - rise) + r(t - 2 rise)) / rise,   r(t) = t - sin(omega t) / omega, t > 0

        Source: J. M. Biggs, Introduction to Structural Dynamics (1964), 2.3.
        """

        def ramp(t: Array) -> Array:
            late = np.maximum(t, 0.0)
            return late - np.sin(self.omega * late) / self.omega

        return (ramp(time) - 2.0 * ramp(time - rise) + ramp(time - 2.0 * rise)) / rise


@dataclass(frozen=True, eq=False)
class Blow:
    """time (n,) [s]; pressure (n,) [Pa]; deflection and strain in the middle (n,), and as one
    degree of freedom has them; static: deflection and strain at rest under 1 bar over those of thin
    plates; frequency: the first over that of thin plates.
    """

    time: Array
    pressure: Array
    deflection: Array
    expected: Array
    strain: Array
    expected_strain: Array
    acceleration: Array
    static: tuple[float, float]
    frequency: float

    @property
    def peak(self) -> float:
        """The largest deflection over that of one degree of freedom."""
        return float(self.deflection.max() / self.expected.max())


def main(folder: Path) -> Blow:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/pressure_pulse.toml")
    found = blow(model, folder / "pressure-pulse.h5")
    with view.style():
        view.save(curves(found), folder / "pressure-pulse.png")
    # elements in one layer are a little too stiff in bending
    assert 0.96 < found.static[0] < 1.0
    assert abs(found.static[1] - 1.0) < 1e-3
    assert 1.0 < found.frequency < 1.02
    assert abs(found.peak - 1.0) < 0.05
    return found


def ensure_superelement() -> None:
    if not (target := BODY.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)


def blow(model: solver.Model, target: Path) -> Blow:
    material = preprocess.read_body(BODY).material
    plate = ThinPlate(material.E, material.nu, material.rho)
    (load,) = model.loads
    peak, rise = load.signal.values[1], load.signal.times[1]
    results = solver.simulate(model, output=target)
    middle, gauge = results.sensor("plate.middle"), results.sensor("plate.gauge")
    time, factor = results.time, plate.factor(results.time, rise)
    held = replace(model, loads=[replace(load, signal=solver.Constant(peak))])
    at_rest = solver.simulate(held.with_settings(start="equilibrium", t_end=model.settings.step))
    deflected = -float(clamped(at_rest)[0]) / plate.deflection(peak)
    stretched = float(at_rest.sensor("plate.gauge").value[0, 0]) / plate.strain(peak)
    first = float(solver.check(model).frequencies[0])
    return Blow(
        time,
        results.pattern("plate.blast").load,
        -clamped(results),
        plate.deflection(peak) * factor,
        gauge.value[:, 0],
        plate.strain(peak) * factor,
        middle.acceleration[:, 2],
        (deflected, stretched),
        2.0 * np.pi * first / plate.omega,
    )


def clamped(results: solver.Results) -> Array:
    """Deflection of the middle from the rim (n,) [m]: sensors are seen from the floating frame."""
    rim = results.frame("plate.rim").u[:, 2]
    return results.sensor("plate.middle").value[:, 2] - rim


def curves(found: Blow) -> Figure:
    figure, (pressure, deflection, strain) = view.panels(3)
    blue, *_ = view.COLORS
    dashed = {"color": "0.2", "linestyle": (0, (4, 3)), "label": "one degree of freedom"}
    ms = 1e3 * found.time
    pressure.plot(ms, 1e-5 * found.pressure, color=blue)
    pressure.set(title="pressure on the plate", ylabel="[bar]")
    deflection.plot(ms, 1e3 * found.deflection, color=blue, label="superelement")
    deflection.plot(ms, 1e3 * found.expected, **dashed)
    deflection.set(title="deflection in the middle", ylabel="[mm]")
    strain.plot(ms, 1e6 * found.strain, color=blue, label="strain gauge")
    strain.plot(ms, 1e6 * found.expected_strain, **dashed)
    strain.set(title="strain on the far side", ylabel="[µm/m]", xlabel="time [ms]")
    for axes in (deflection, strain):
        axes.legend(loc="upper right")
        axes.set_ylim(top=1.7 * axes.get_ylim()[1])
    view.entitle(figure, "A clamped plate under a pressure wave")
    return figure


def report(found: Blow) -> None:
    print(
        f"at rest, over thin plates   deflection {found.static[0]:.4f}, "
        f"strain {found.static[1]:.4f}"
    )
    print(f"first frequency             {found.frequency:.4f} of that of thin plates")
    print(
        f"largest deflection          {1e3 * found.deflection.max():.4f} mm, "
        f"one degree of freedom {1e3 * found.expected.max():.4f} mm"
    )
    print(
        f"largest strain              {1e6 * found.strain.max():.1f}e-6, "
        f"one degree of freedom {1e6 * found.expected_strain.max():.1f}e-6"
    )
    print(f"largest acceleration        {np.abs(found.acceleration).max():.0f} m/s^2")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"results and picture: {target}")
