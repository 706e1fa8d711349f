"""Seven cases of the validation manual of code_aster, with shocks and friction, by their names.

    python examples/benchmarks/code_aster.py [FOLDER]

    SDND101 (V5.01.101)  a mass on a spring that is thrown against an elastic stop
    SDND105 (V5.01.105)  a mass that strikes a stop, which buckles
    SDND106 (V5.01.106)  two masses and a spring, of which one sticks, slips and sticks again
    SDND122 (V5.01.122)  a mass on a spring with a soft wall: periods by amplitude
    SDNL32  (V5.02.032)  a hinged beam that swings against an elastic support
    SDNL104 (V5.02.104)  a cantilever that is pressed on an elastic support
    SDNV100 (V5.03.100)  a bar that strikes a rigid wall at 100 m/s

Writes the picture to FOLDER, by default out/.
"""

import sys
import warnings
from dataclasses import dataclass
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import solver, view
from numpy.typing import NDArray

Array = NDArray[np.float64]


SDNL32 = {
    "soft": (-2.66, -4.33, -4.92, -4.78, -3.82, -2.87, -2.71, -3.09, -3.41, -3.36, -2.64, -0.742),
    "stiff": (-2.25, -2.66, -1.96, -1.15, -0.124, -0.364, -2.01, -2.74, -1.89, -0.352, 1.70, 4.99),
}
"""displacements of the tip at 1 to 12 ms [mm]"""


@dataclass(frozen=True, eq=False)
class Found:
    """Curves over time (n,); values and expected by the words of the manual; seconds; scale: what
    errors are measured by, else each by what is expected.
    """

    time: Array
    curves: dict[str, Array]
    values: dict[str, float]
    expected: dict[str, float]
    seconds: float
    scale: float | None = None

    @property
    def errors(self) -> dict[str, float]:
        """Relative."""
        return {
            name: abs(self.values[name] - right) / (self.scale or abs(right))
            for name, right in self.expected.items()
        }


def main(folder: Path) -> dict[str, Found]:
    folder.mkdir(parents=True, exist_ok=True)
    found = {
        "SDND101": sdnd101(),
        "SDND105": sdnd105(),
        "SDND106": sdnd106(),
        "SDND122": sdnd122(),
        "SDNL32": sdnl32(),
        "SDNL104": sdnl104(),
        "SDNV100": sdnv100(),
    }
    draw(found, folder / "code-aster.png")
    return found


def sdnd101(step: float = 1e-4) -> Found:
    """The contact lasts pi / omega and the mass returns at its speed, omega^2 = (k + K) / m."""
    mass, k, K, speed = 100.0, 1e4, 1e6, 1.0
    m = du.Mechanism()
    block = m.add(du.RigidBody(mass, [1.0] * 3), "mass", velocity=[speed, 0.0, 0.0])
    m.add(du.joints.Prismatic(m.ground, block, "x"))
    m.add(du.springs.point(m.ground.frame("anchor", [-1.0, 0.0, 0.0]), block, stiffness=k))
    wall = m.ground.frame("wall")
    m.add(du.contacts.plane(wall, block, [-1.0, 0.0, 0.0], stiffness=K, name="stop"))
    run = m.simulate(0.45, step=step)
    omega = np.sqrt((k + K) / mass)
    stop = run["stop"]
    first = stop.events
    return Found(
        run.time,
        {"displacement [m]": run["mass"].x[:, 0]},
        {
            "largest force": float(stop.force[:, 0].max()),
            "impulse": float(first.impulse[0]),
            "duration": float(first.end[0] - first.start[0]),
            "speed after": float(-run["mass"].v[first_after(run.time, first.end[0]), 0]),
        },
        {
            "largest force": K * speed / omega,
            "impulse": 2.0 * K * speed / omega**2,
            "duration": np.pi / omega,
            "speed after": speed,
        },
        run.results.solver["seconds"],
    )


def sdnd105(step: float = 2e-4) -> Found:
    """The stop gives way at the force F to the force P, and springs back by k P / F.

    The mass meets it at 2 m/s. Everything is in closed form.
    """
    mass, k, F, P, speed = 1.0, 1.0, 1.0, 0.5, 2.0
    m = du.Mechanism()
    block = m.add(du.RigidBody(mass, [1.0] * 3), "mass", velocity=[speed, 0.0, 0.0])
    m.add(du.joints.Prismatic(m.ground, block, "x"))
    anchor = m.ground.frame("anchor", [-10.0, 0.0, 0.0])
    law = du.laws.UserLaw(stop_that_buckles, [k, F, P], memory=[0.0, 0.0], update=crush)
    m.add(du.springs.point(anchor, block, length=10.0, law=law, name="stop"))
    run = m.simulate(12.0, step=step)
    x, force = run["mass"].x[:, 0], np.linalg.norm(run["stop"].force, axis=1)
    last = int(np.flatnonzero(force > 0.0)[-1])
    buckles = int(np.argmax(np.diff(force) < -0.25))
    back = last + int(np.argmax(x[last:] < 0.0))
    return Found(
        run.time,
        {"displacement [m]": x},
        {
            "buckles at": float(run.time[buckles]),
            "crushed by": float(x[last]),
            "back at": float(run.time[back] + x[back] * step / (x[back - 1] - x[back])),
        },
        {
            "buckles at": np.pi / 6,
            "crushed by": 3.0,
            "back at": np.pi / 6 + 2.0 * np.sqrt(3.0) + (np.pi + 6.0) / np.sqrt(2.0),
        },
        run.results.solver["seconds"],
    )


def stop_that_buckles(
    parameters: Array, memory: Array, h: float, c: float, rate: float
) -> tuple[float, float, float, float]:
    """Force, its derivatives, energy; memory: whether it has buckled, its crush [m]."""
    k, F, P = parameters[0], parameters[1], parameters[2]
    elastic = c - memory[1]
    if elastic <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    if memory[0] == 0.0 and k * elastic < F:
        return k * elastic, k, 0.0, 0.5 * k * elastic**2
    if k * elastic < F:
        return k * P / F * elastic, k * P / F, 0.0, 0.5 * k * P / F * elastic**2
    return P, 0.0, 0.0, 0.5 * P * F / k


def crush(parameters: Array, memory: Array, h: float, c: float, rate: float) -> None:
    k, F = parameters[0], parameters[1]
    if k * (c - memory[1]) >= F:
        memory[0] = 1.0
        memory[1] = c - F / k


def first_after(time: Array, at: float) -> int:
    return int(np.searchsorted(time, at))


def sdnd106(step: float = 1e-5) -> Found:
    """A force on the second mass until 0.2 s; friction on the first, 0.3 at rest and 0.2 sliding.

    The references of the manual are analytical, with a coefficient that jumps. Here it falls over
    1 mm/s, which delays the slip by 0.1 ms; the delay falls with the root of this speed.
    """
    mass, k, normal = 5.0, 1e4, 1e4
    m = du.Mechanism()
    one = m.add(du.RigidBody(mass, [1.0] * 3), "one")
    other = m.add(du.RigidBody(mass, [1.0] * 3), "other", position=[10.0, 0.0, 0.0])
    law = du.joints.Stribeck(static=0.3, sliding=0.2, speed=1e-3)
    friction = du.joints.JointFriction(law, preload=normal)
    m.add(du.joints.Prismatic(m.ground, one, "x", friction=friction, name="slide"))
    m.add(du.joints.Prismatic(m.ground, other, "x"))
    m.add(du.springs.point(one, other, stiffness=k))
    pull = du.signals.Pulse(3e3, 0.0, 0.2)
    m.add(du.loads.Force(other, "x", pull))
    run = m.simulate(0.34, step=step)
    x, y = run["one"].x[:, 0], run["other"].x[:, 0] - 10.0
    speed = run["one"].v[:, 0]
    slow = 1e-3
    released = int(np.argmax(speed > slow))
    stuck = first_after(run.time, 0.2)
    stuck += int(np.argmax(speed[stuck:] < slow))
    at = [first_after(run.time, t - step / 2) for t in (0.02, 0.15, 0.34)]
    return Found(
        run.time,
        {"first mass [m]": x, "second mass [m]": y},
        {
            "x2 at 0.02 s": float(y[at[0]]),
            "x1 at 0.15 s": float(x[at[1]]),
            "x2 at 0.15 s": float(y[at[1]]),
            "x2 at 0.34 s": float(y[at[2]]),
            "slips from": float(run.time[released]),
            "sticks from": float(run.time[stuck]),
        },
        {
            "x2 at 0.02 s": 0.11221,
            "x1 at 0.15 s": 1.35332,
            "x2 at 0.15 s": 1.80751,
            "x2 at 0.34 s": 3.96813,
            "slips from": 0.03512,
            "sticks from": 0.31492,
        },
        run.results.solver["seconds"],
    )


def sdnd122(step: float = 1e-3, amplitudes: tuple[float, ...] = (0.011, 0.02, 0.1)) -> Found:
    """Periods of the nonlinear mode: it is free for u < e, and has the stiffness k + K beyond."""
    mass, k, K, e = 1.0, 10.0, 50.0, 0.01
    runs = []
    for amplitude in amplitudes:
        m = du.Mechanism()
        block = m.add(du.RigidBody(mass, [1.0] * 3), "mass", position=[-amplitude, 0.0, 0.0])
        m.add(du.joints.Prismatic(m.ground, block, "x"))
        anchor = m.ground.frame("anchor", [-1.0, 0.0, 0.0])
        m.add(du.springs.point(anchor, block, stiffness=k, length=1.0))
        wall = m.ground.frame("wall", [e, 0.0, 0.0])
        m.add(du.contacts.plane(wall, block, [-1.0, 0.0, 0.0], stiffness=K, name="wall"))
        runs.append(m.simulate(10.0, step=step))
    starts = [run["wall"].events.start for run in runs]
    names = [f"period at {amplitude:g} m" for amplitude in amplitudes]
    found = [float(at[-1] - at[0]) / (len(at) - 1) for at in starts]
    expected = [period_of_sdnd122(amplitude, mass, k, K, e) for amplitude in amplitudes]
    return Found(
        runs[-1].time,
        {"displacement [m]": runs[-1]["mass"].x[:, 0]},
        dict(zip(names, found, strict=True)),
        dict(zip(names, expected, strict=True)),
        sum(run.results.solver["seconds"] for run in runs),
    )


def period_of_sdnd122(amplitude: float, mass: float, k: float, K: float, e: float) -> float:
    free, closed = np.sqrt(k / mass), np.sqrt((k + K) / mass)
    speed = free * np.sqrt(amplitude**2 - e**2)
    # The contact starts this far beyond the place where both springs balance.
    beyond = e * k / (k + K)
    flight = (np.pi / 2 + np.arcsin(e / amplitude)) / free
    contact = (np.pi / 2 - np.arctan(closed * beyond / speed)) / closed
    return float(2.0 * (flight + contact))


def sdnl32(step: float = 1e-5, elements: int = 10) -> Found:
    """Displacements of the tip at each ms on a soft and on a stiff support, in mm, and forces."""
    length, side, E, density, spin = 0.783, 0.014, 6.7e10, 2400.0, -3.8
    points = np.linspace([0.0, 0.0, 0.0], [length, 0.0, 0.0], elements + 1)
    section = du.Section.rectangle(du.Material(E=E, nu=0.0, rho=density), width=side, height=side)
    part = du.Beam(points, section=section)
    part.interface("root", points[0])
    part.interface("tip", points[-1])
    # Ratios are those of the free beam; its first mode becomes that of the hinged one, with 1 %.
    part.damping(modal=0.01 * (4.73004 / 3.92660) ** 2)
    element = part.superelement(step=step)
    curves, values, expected, seconds = {}, {}, {}, 0.0
    for name, stiffness in (("soft", 18e3), ("stiff", 45e3)):
        m = du.Mechanism()
        beam = m.add(
            element,
            "beam",
            position=[length / 2, 0.0, 0.0],
            velocity=[0.0, spin * length / 2, 0.0],
            angular_velocity=[0.0, 0.0, spin],
        )
        m.add(du.joints.Revolute(m.ground, beam["root"], "z"))
        support = m.ground.frame("support", [length, 0.0, 0.0])
        m.add(du.contacts.plane(support, beam["tip"], "y", stiffness=stiffness, name="support"))
        run = m.simulate(0.013, step=step)
        tip = 1e3 * run["beam.tip"].position[:, 1]
        curves[f"{name} [mm]"] = tip
        for at, right in enumerate(SDNL32[name], 1):
            values[f"{name}, {at} ms"] = float(tip[first_after(run.time, 1e-3 * at - step / 2)])
            expected[f"{name}, {at} ms"] = right
        seconds += run.results.solver["seconds"]
    return Found(run.time, curves, values, expected, seconds, scale=5.0)


def sdnl104(step: float = 1e-4, elements: int = 10) -> Found:
    """A constant force on the tip; the manual has the rebound, of a computation by Newmark's rule.

    Its number of elements is not given. Ten come nearest; the rebound, a hundredth of the gap,
    changes by 4 % with twenty.
    """
    radius, E, density, gap, stiffness, force = 0.1, 1e10, 1e6, 1e-4, 1e8, -1000.0
    points = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], elements + 1)
    area, second = np.pi * radius**2, np.pi * radius**4 / 4
    section = du.Section(
        EA=E * area,
        EI_y=E * second,
        EI_z=E * second,
        GJ=E / 2.6 * 2 * second,
        mass_per_length=density * area,
        polar_inertia_per_length=density * 2 * second,
    )
    part = du.Beam(points, section=section)
    part.interface("root", points[0])
    part.interface("tip", points[-1])
    m = du.Mechanism()
    beam = m.add(part.superelement(step=step), "beam", position=[0.5, 0.0, 0.0])
    m.add(du.joints.Fixed(m.ground, beam["root"]))
    m.add(du.loads.Force(beam["tip"], "y", du.signals.Constant(force)))
    support = m.ground.frame("support", [1.0, -gap, 0.0])
    m.add(du.contacts.plane(support, beam["tip"], "y", stiffness=stiffness, name="support"))
    run = m.simulate(0.2, step=step)
    tip = run["beam.tip"]
    u, v = tip.position[:, 1], tip.velocity[:, 1]
    rebound = (run.time > 0.1) & (run.time < 0.15)
    return Found(
        run.time,
        {"displacement [m]": u},
        {
            "rebound": float(u[rebound].max()),
            "time of the rebound": float(run.time[rebound][u[rebound].argmax()]),
            "largest speed": float(v.min()),
            "time of the largest speed": float(run.time[v.argmin()]),
        },
        {
            "rebound": -1.85334e-6,
            "time of the rebound": 0.1315,
            "largest speed": -4.63284e-3,
            "time of the largest speed": 0.1566,
        },
        run.results.solver["seconds"],
    )


def sdnv100(step: float = 1e-7, elements: int = 100) -> Found:
    """The bar leaves the wall after 2 L / c at its own speed; the force is EA v / c until then."""
    length, side, E, density, speed, gap = 0.2, 0.02, 2e11, 8000.0, 100.0, 2e-3
    area, wave = side**2, np.sqrt(E / density)
    impedance = density * area * wave
    points = np.linspace([0.0, 0.0, 0.0], [length, 0.0, 0.0], elements + 1)
    section = du.Section.rectangle(du.Material(E=E, nu=0.3, rho=density), width=side, height=side)
    part = du.Beam(points, section=section)
    part.interface("front", points[0])
    part.interface("back", points[-1])
    m = du.Mechanism()
    bar = part.superelement(step=step)
    at = [length / 2 + gap, 0.0, 0.0]
    body = m.add(bar, "bar", position=at, velocity=[-speed, 0.0, 0.0])
    # Stiff beside the bar: the force rises within four steps, in which a wave passes a fifth of
    # an element.
    stiffness = impedance / (4 * step)
    m.add(
        du.contacts.plane(
            m.ground.frame("wall"), body["front"], "x", stiffness=stiffness, name="wall"
        )
    )
    with warnings.catch_warnings():
        # At 100 m/s the strain is 2 %; the manual's elasticity is linear too.
        warnings.simplefilter("ignore", solver.ValidityWarning)
        run = m.simulate(1.4e-4, step=step)
    wall = run["wall"]
    first = wall.events
    middle = (run.time > 4e-5) & (run.time < 8e-5)
    return Found(
        run.time,
        {"force on the wall [N]": wall.force[:, 0]},
        {
            "force": float(wall.force[middle, 0].mean()),
            "duration": float(first.end[-1] - first.start[0]),
            "impulse": float(wall.impulse[-1]),
            "speed after": float(run["bar"].v[-1, 0]),
        },
        {
            "force": impedance * speed,
            "duration": 2 * length / wave,
            "impulse": 2 * impedance * speed * length / wave,
            "speed after": speed,
        },
        run.results.solver["seconds"],
    )


def draw(found: dict[str, Found], target: Path) -> None:
    figure, panels = view.panels(len(found), share_time=False)
    with view.style():
        for (name, one), axes in zip(found.items(), panels, strict=True):
            for label, curve in one.curves.items():
                axes.plot(one.time, curve, label=label.partition(" [")[0])
            unit = next(iter(one.curves)).partition("[")[2]
            words = (
                next(iter(one.curves)).partition(" [")[0] if len(one.curves) == 1 else "position"
            )
            axes.set(ylabel=f"{words} [{unit}", title=name)
            if len(one.curves) > 1:
                axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        panels[-1].set(xlabel="time [s]")
    view.save(figure, target)


if __name__ == "__main__":
    for case, result in main(Path(sys.argv[1] if len(sys.argv) > 1 else "out")).items():
        print(f"{case}, {result.seconds:.2f} s")
        for name, right in result.expected.items():
            value, error = result.values[name], result.errors[name]
            print(f"  {name}: {value:.6g} of {right:.6g}, {100 * error:.2g} %")
