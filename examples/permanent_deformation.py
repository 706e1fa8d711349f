"""What stays after a blow: a dented plane, a bent hinge, and the losses of a bolted joint.

    python examples/permanent_deformation.py [FOLDER]

throws a steel ball on a steel plane at speeds over three decades, and compares its restitution with
the closed form of Thornton (1997); bends a plastic hinge by a blow, and compares the angle that
stays with the balance of energy; shakes a bolted joint, and compares what a cycle loses with
Segalman's power law (2005). Writes a picture to FOLDER, by default out/.
"""

import math
import sys
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import view
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

RADIUS, MASS, YIELD_PRESSURE = 0.01, 0.0327, 1.5e9
"""of the ball [m], [kg], and of both steels [Pa]"""
STEEL = du.contacts.Hertz([210e9, 210e9], [0.3, 0.3], yield_pressure=YIELD_PRESSURE)
STEPS_PER_CONTACT = 200
HINGE = du.laws.ElastoplasticLaw(40.0, stiffness=8e3)
INERTIA, ANGULAR_VELOCITY = 2.0, 5.0
"""of the bent body [kg m^2], [rad/s]"""
BOLT = du.laws.IwanLaw(slip_force=4e3, stiffness=1.5e7, chi=-0.4, beta=0.6)
CYCLES, STEPS_PER_CYCLE = 3, 2000


def main(folder: Path) -> dict[str, tuple[Array, Array, Array]]:
    """Found and exact by abscissa: restitution by speed, angle by time, loss by amplitude."""
    folder.mkdir(parents=True, exist_ok=True)
    speeds = np.geomspace(0.5, 300.0, 13) * yield_speed()
    amplitudes = np.geomspace(0.01, 0.95, 9) * BOLT.macro_slip
    time, angle = bend()
    found = {
        "restitution": (
            speeds,
            np.array([restitution(v) for v in speeds]),
            np.array([thornton(v) for v in speeds]),
        ),
        "hinge": (time, angle, np.full_like(time, bent())),
        "bolt": (
            amplitudes,
            np.array([loss(u) for u in amplitudes]),
            np.array([segalman(u) for u in amplitudes]),
        ),
    }
    with view.style():
        view.save(picture(found), folder / "permanent-deformation.png")
    return found


def restitution(speed: float) -> float:
    """Of a ball that meets a plane."""
    stiffness = 4.0 / 3.0 * STEEL.modulus * math.sqrt(RADIUS)
    contact_time = 2.94 * (MASS / stiffness) ** 0.4 * speed**-0.2
    m = du.Mechanism()
    solid = du.RigidBody(MASS, [0.4 * MASS * RADIUS**2] * 3)
    touching = [0.0, 0.0, RADIUS * (1.0 + 1e-9)]
    ball = m.add(solid, name="ball", position=touching, velocity=[0.0, 0.0, -speed])
    floor = m.ground.frame("floor")
    m.add(du.contacts.plane(floor, ball, "z", ball=RADIUS, hertz=STEEL), name="plane")
    run = m.simulate(3.0 * contact_time, step=contact_time / STEPS_PER_CONTACT)
    return float(run.results.contact("plane").events.restitution[0])


def yield_speed() -> float:
    """The speed [m/s] at which a dent begins (Thornton 1997, eq. 30)."""
    shape = math.sqrt(8.0 * math.pi * RADIUS**3 / (15.0 * MASS))
    return (0.5 * math.pi / STEEL.modulus) ** 2 * shape * YIELD_PRESSURE**2.5


def thornton(speed: float) -> float:
    """The restitution in closed form (Thornton 1997, eq. 40)."""
    r = min(yield_speed() / speed, 1.0)
    share = r / (r + 2.0 * math.sqrt(1.2 - 0.2 * r * r))
    return math.sqrt(1.2 * math.sqrt(3.0) * (1.0 - r * r / 6.0)) * share**0.25


def bend() -> tuple[Array, Array]:
    """Time [s] and angle [rad] of a body on a plastic hinge after a blow."""
    m = du.Mechanism()
    wheel = m.add(
        du.RigidBody(1.0, [INERTIA] * 3), name="wheel", angular_velocity=[0, 0, ANGULAR_VELOCITY]
    )
    m.add(du.joints.Revolute(m.ground, wheel, "z", name="axle"))
    m.add(du.springs.torsion(m.ground, wheel, "z", law=HINGE), name="hinge")
    results = m.simulate(1.0, step=5e-4).results
    return results.time, results.joint("axle").angle


def bent() -> float:
    """The angle [rad] that stays: what the hinge does not store at its largest angle bends it."""
    moment, stiffness = HINGE.yield_force, HINGE.stiffness
    return (0.5 * INERTIA * ANGULAR_VELOCITY**2 - 0.5 * moment**2 / stiffness) / moment


def loss(amplitude: float) -> float:
    """The energy [J] that the bolted joint loses in a cycle."""
    m = du.Mechanism()
    plate = m.add(du.RigidBody(1.0, [1.0] * 3), name="plate", position=[1.0, 0.0, 0.0])
    rail = du.joints.Prismatic(
        m.ground, plate, "x", name="rail", distance=du.signals.Harmonic(amplitude, 1.0)
    )
    m.add(rail)
    base = m.ground.frame("base", [1.0, 0.0, 0.0])
    m.add(du.springs.bushing(base, plate, law={"x": BOLT}), name="bolt")
    results = m.simulate(float(CYCLES), step=1.0 / STEPS_PER_CYCLE).results
    bolt = results.spring("bolt")
    force, length = bolt.multipliers[:, 0], bolt.coordinates["coordinates"][:, 0]
    last = slice(-STEPS_PER_CYCLE - 1, None)
    return float(abs(np.trapezoid(force[last], length[last])))


def segalman(amplitude: float) -> float:
    """The same in closed form (Segalman 2005, eq. 22)."""
    chi = BOLT.chi
    R = BOLT.stiffness * (chi + 1.0) / (1.0 + BOLT.beta) / BOLT.macro_slip ** (chi + 1.0)
    return float(4.0 * R * amplitude ** (chi + 3.0) / ((chi + 2.0) * (chi + 3.0)))


def picture(found: dict[str, tuple[Array, Array, Array]]) -> Figure:
    figure = Figure(figsize=(9.6, 3.2), layout="constrained")
    ball, hinge, bolt = figure.subplots(1, 3)
    speed, e, exact = found["restitution"]
    ball.loglog(speed, exact, label="Thornton")
    ball.loglog(speed, e, "o", label="computed")
    ball.set(xlabel="speed [m/s]", ylabel="restitution", title="ball on a plane")
    time, angle, stays = found["hinge"]
    hinge.plot(time, np.degrees(angle), label="angle")
    hinge.plot(time, np.degrees(stays), "--", label="plastic rotation")
    hinge.set(xlabel="time [s]", ylabel="angle [deg]", title="plastic hinge")
    amplitude, lost, exact = found["bolt"]
    bolt.loglog(amplitude, exact, label="Segalman")
    bolt.loglog(amplitude, lost, "o", label="computed")
    bolt.set(xlabel="amplitude [m]", ylabel="loss per cycle [J]", title="bolted joint")
    for axes in (ball, hinge, bolt):
        axes.legend()
    return figure


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
