"""A pendulum that hangs with a ball in a socket, beside the friction of a ring.

    python examples/ball_socket.py [FOLDER]

runs examples/ball_socket.toml. The ball has a neck, so that it rests on a ring around that. Checks
the moment of friction against that of the ring, what each half swing loses by it, and the energy.
Writes results and a picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/ball_stud/ball_stud.toml"
RADIUS, FRICTION, LOAD, LENGTH = 0.01, 0.1, 500.0, 0.1
"""of the ball [m]; coefficient; weight [N] and its distance from the ball [m]"""
NEAR_END = 1e-3
"""time before and after an end of the swing that is not looked at, where friction turns [s]"""


@dataclass(frozen=True, eq=False)
class Swing:
    """time (n,) [s]; sum (n,) of the normal forces and force (n, 3) of the socket [N]; moment (n,)
    of its friction about the center of the socket [N m]; angle (n,) of the pendulum [rad]; instants
    of the ends of its swings [s].
    """

    time: Array
    normal: Array
    force: Array
    friction: Array
    angle: Array
    ends: Array


@dataclass(frozen=True)
class Checks:
    """Angle from the axis at which the ring is, by the forces [deg]; relative errors of the mean
    moment of friction in the second half swing and of the loss of amplitude; error of the energy.
    """

    ring: float
    friction: float
    loss: float
    balance: float


def main(folder: Path) -> tuple[Swing, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/ball_socket.toml")
    results = solver.simulate(model, output=folder / "ball_socket.h5")
    found = swing(results)
    checks = compare(found, results)
    with view.style():
        view.save(curves(found), folder / "ball-socket.png")
    # The neck begins 45 degrees from the axis in the middle of its sides, 55 at its corners.
    assert 45.0 < checks.ring < 55.0
    assert abs(checks.friction) < 0.03
    assert abs(checks.loss) < 0.03
    assert checks.balance < 1e-4
    return found, checks


def ensure_superelement() -> Path:
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    return target


def swing(results: solver.Results) -> Swing:
    contact, bob = results.surface_contact("socket"), results.body("bob").x
    # The moment of the contact is about the center of mass of the stud.
    moment = contact.moment + np.cross(results.body("stud").x, contact.force)
    angle = np.arctan2(-bob[:, 0], -bob[:, 2])
    turns = np.flatnonzero(np.diff(np.sign(np.diff(angle)))) + 1
    return Swing(
        time=results.time,
        normal=contact.normal_force,
        force=contact.force,
        friction=moment[:, 1],
        angle=angle,
        ends=results.time[turns],
    )


def compare(found: Swing, results: solver.Results) -> Checks:
    first, second = found.ends[:2]
    sliding = (found.time > first + NEAR_END) & (found.time < second - NEAR_END)
    normal = float(found.normal[sliding].mean())
    ring = float(np.arccos(found.force[sliding, 2].mean() / normal))
    friction = FRICTION * normal * mean_arm(ring)
    amplitudes = np.abs(np.interp([first, second], found.time, found.angle))
    return Checks(
        ring=float(np.rad2deg(ring)),
        friction=float(np.abs(found.friction[sliding].mean())) / friction - 1.0,
        loss=float(amplitudes[0] - amplitudes[1]) / (2.0 * friction / (LOAD * LENGTH)) - 1.0,
        balance=max(results.validity.values("energy_balance").values()),
    )


def mean_arm(ring: float) -> float:
    """Distance of a ring on the ball from the axis of the swing, which is across it [m]."""
    around = np.linspace(0.0, np.pi, 1001)
    return float(RADIUS * np.sqrt(1.0 - (np.sin(ring) * np.sin(around)) ** 2).mean())


def curves(found: Swing) -> Figure:
    figure, (normal, friction, angle) = view.panels(3)
    time = 1e3 * found.time
    normal.plot(time, found.normal, label="sum of normal forces")
    normal.plot(time, found.force[:, 2], label="upwards")
    friction.plot(time, found.friction)
    angle.plot(time, found.angle)
    normal.set(title="force of the socket", ylabel="[N]")
    friction.set(title="moment of its friction", ylabel="[N m]")
    angle.set(title="angle of the pendulum", ylabel="[rad]", xlabel="time [ms]")
    normal.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=2)
    view.entitle(figure, "A pendulum that hangs with a ball in a socket")
    return figure


def report(found: Swing, checks: Checks) -> None:
    print(f"ring of the contact         {checks.ring:.1f} deg from the axis")
    print(f"moment of friction          {100.0 * checks.friction:+.1f} % of that of the ring")
    print(f"loss of a half swing        {100.0 * checks.loss:+.1f} % of that by this moment")
    print(f"largest normal force        {found.normal.max():.0f} N")
    print(f"error of the energy         {checks.balance:.1e} of the largest")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
