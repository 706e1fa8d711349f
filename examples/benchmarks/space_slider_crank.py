"""The spatial slider-crank of the IFToMM library, after Haug: a loop in space without friction.

    python examples/benchmarks/space_slider_crank.py [FOLDER]

A crank of 0.08 m turns about x at 6 rad/s, 0.1 m beside and 0.12 m above the path of a slider. A
ball joint and a universal joint hold the rod between them. The reference uses no multibody solver:
kinetic and potential energy follow from the angle of the crank alone, and its speed from their sum,
which does not change. Writes the picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import view
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

G = 9.81
CRANK, ROD = 0.08, 0.3
CENTER = np.array([0.0, 0.1, 0.12])
"""of the crank; the slider moves along x [m]"""
CRANK_MASS, ROD_MASS, SLIDER_MASS = 0.12, 0.5, 2.0
CRANK_INERTIA = (1e-4, 1e-4, 1e-5)
ROD_INERTIA = (4e-4, 4e-3, 4e-3)
"""along the rod and across [kg m^2]"""
SPEED = 6.0
"""of the crank at the start [rad/s]"""
T_END = 5.0
STEPS = (2e-3, 1e-3, 5e-4)
"""[s]"""


@dataclass(frozen=True, eq=False)
class Found:
    """slider and expected (n,) [m] over time with the smallest step; slider_errors [m] and
    angle_errors [rad], of the crank: largest difference with each step; seconds: of the last run.
    """

    time: Array
    slider: Array
    expected: Array
    slider_errors: Array
    angle_errors: Array
    seconds: float


@dataclass(frozen=True, eq=False)
class Motion:
    """Of a run or the reference: angle (n,) [rad] of the crank, slider (n,) [m]."""

    angle: Array
    slider: Array


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    found = solve(STEPS)
    draw(found, folder / "space-slider-crank.png")
    return found


def solve(steps: tuple[float, ...], t_end: float = T_END) -> Found:
    m = mechanism()
    runs = [m.simulate(t_end, step=step) for step in steps]
    found = [Motion(run["crank_hinge"].angle, run["slider"].x[:, 0]) for run in runs]
    expected = reference(runs[-1].time)
    every = [round(step / steps[-1]) for step in steps]
    slider = [one.slider - expected.slider[::k] for one, k in zip(found, every, strict=True)]
    angle = [one.angle - expected.angle[::k] for one, k in zip(found, every, strict=True)]
    return Found(
        runs[-1].time,
        found[-1].slider,
        expected.slider,
        np.array([np.abs(wrong).max() for wrong in slider]),
        np.array([np.abs(wrong).max() for wrong in angle]),
        runs[-1].results.solver["seconds"],
    )


def mechanism() -> du.Mechanism:
    m = du.Mechanism(gravity=[0.0, 0.0, -G])
    at = place(0.0)
    rates = rates_at(0.0) * SPEED
    half = CRANK / 2
    crank = m.add(
        du.RigidBody(CRANK_MASS, CRANK_INERTIA, {"hub": [0, 0, -half], "pin": [0, 0, half]}),
        "crank",
        position=place(0.0).pin - [0, 0, half],
        velocity=[0, -half * SPEED, 0],
        angular_velocity=[SPEED, 0, 0],
    )
    rod = m.add(
        du.RigidBody(ROD_MASS, ROD_INERTIA, {"pin": [-ROD / 2, 0, 0], "cross": [ROD / 2, 0, 0]}),
        "rod",
        position=(at.pin + at.cross) / 2,
        rotation=Rotation.from_matrix(at.axes).as_rotvec(),
        velocity=rates[3:6],
        angular_velocity=at.axes.T @ rates[:3],
    )
    slider = m.add(
        du.RigidBody(SLIDER_MASS, [1e-4] * 3),
        "slider",
        position=at.cross,
        velocity=[rates[6], 0, 0],
    )
    m.add(du.joints.Revolute(m.ground, crank["hub"], "x", name="crank_hinge"))
    m.add(du.joints.Spherical(crank["pin"], rod["pin"]))
    m.add(du.joints.Universal(slider, rod["cross"], "x", at.axes[:, 1]))
    m.add(du.joints.Prismatic(m.ground, slider, "x"))
    return m


@dataclass(frozen=True, eq=False)
class Place:
    """pin, cross (3,) [m]: ends of the rod; axes (3, 3): along it, that of the cross on it, across
    both.
    """

    pin: Array
    cross: Array
    axes: Array


def place(angle: float) -> Place:
    """Of the rod for an angle of the crank [rad]; the cross keeps it perpendicular to x."""
    pin = CENTER + CRANK * np.array([0.0, -np.sin(angle), np.cos(angle)])
    cross = np.array([np.sqrt(ROD**2 - pin[1] ** 2 - pin[2] ** 2), 0.0, 0.0])
    along = (cross - pin) / ROD
    on_rod = np.cross([1.0, 0.0, 0.0], along)
    on_rod /= np.linalg.norm(on_rod)
    return Place(pin, cross, np.stack([along, on_rod, np.cross(along, on_rod)], axis=1))


def rates_at(angle: float) -> Array:
    """By the angle of the crank (7,): rotation of the rod, its center, the slider; differences."""
    h = 1e-4
    before, at, after = (place(angle + step) for step in (-h, 0.0, h))
    turn = (after.axes - before.axes) / (2 * h) @ at.axes.T
    rotation = [turn[2, 1], turn[0, 2], turn[1, 0]]
    centers = [(one.pin + one.cross) / 2 for one in (before, after)]
    center = (centers[1] - centers[0]) / (2 * h)
    return np.array([*rotation, *center, (after.cross - before.cross)[0] / (2 * h)])


def generalized_mass(angle: float) -> float:
    """T = generalized_mass angle'^2 / 2 [kg m^2]."""
    rates = rates_at(angle)
    rotation = place(angle).axes.T @ rates[:3]
    rod = rotation**2 @ ROD_INERTIA + ROD_MASS * rates[3:6] @ rates[3:6]
    crank = CRANK_INERTIA[0] + CRANK_MASS * CRANK**2 / 4
    return float(crank + rod + SLIDER_MASS * rates[6] ** 2)


def height_energy(angle: float) -> float:
    """[J]"""
    at = place(angle)
    crank = CRANK_MASS * (CENTER[2] + CRANK / 2 * np.cos(angle))
    return float(G * (crank + ROD_MASS * (at.pin[2] + at.cross[2]) / 2))


def reference(time: Array) -> Motion:
    """angle' = sqrt(2 (E - V) / generalized mass); the crank never turns back."""
    energy = generalized_mass(0.0) * SPEED**2 / 2 + height_energy(0.0)

    def rate(_: float, angle: Array) -> list[float]:
        kinetic = energy - height_energy(angle[0])
        return [np.sqrt(2 * kinetic / generalized_mass(angle[0]))]

    limits = {"rtol": 1e-9, "atol": 1e-10}
    angles = solve_ivp(rate, (0.0, time[-1]), [0.0], "DOP853", t_eval=time, **limits).y[0]
    return Motion(angles, np.array([place(angle).cross[0] for angle in angles]))


def draw(found: Found, target: Path) -> None:
    figure, (motion, wrong) = view.panels(2, share_time=False)
    with view.style():
        motion.plot(found.time, found.slider)
        motion.set(xlabel="time [s]", ylabel="slider [m]")
        wrong.loglog(STEPS, found.slider_errors, "o-", label="slider [m]")
        wrong.loglog(STEPS, found.angle_errors, "s-", label="crank [rad]")
        wrong.set(xlabel="step [s]", ylabel="largest error")
        wrong.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        view.entitle(figure, "A slider-crank in space, IFToMM library")
    view.save(figure, target)


if __name__ == "__main__":
    result = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    for step, slider, angle in zip(STEPS, result.slider_errors, result.angle_errors, strict=True):
        print(f"step {step:g} s: slider {slider:.2g} m, crank {angle:.2g} rad")
    print(f"{result.seconds:.2f} s")
