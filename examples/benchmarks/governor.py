"""A05 of the IFToMM library: a flyball governor with stiff springs instead of coupler rods.

    python examples/benchmarks/governor.py [FOLDER]

A shaft turns freely at 2 pi rad/s. Two rods hang on its top and carry 5 kg each; spring-dampers of
8e5 N/m and 4e4 N s/m join their middles to a slider on the shaft. The library shows the height of
the slider as a figure. Numbers come from Lagrange's equations of the two coordinates that symmetry
and angular momentum leave, integrated to 1e-10. Writes the picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import view
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

G, DENSITY, BALL = 9.81, 3000.0, 5.0
L, SIDE, CUBE = 1.0, 0.01, 0.1
"""shaft and rods are L x SIDE x SIDE, the slider is a cube [m]"""
OFFSET = CUBE / 2
"""of hinges and springs from the axis of the shaft [m]"""
K, C, REST = 8e5, 4e4, 0.5
HEIGHT, ANGLE, SPIN = 0.5, np.pi / 3, 2 * np.pi
"""at the start: slider above the foot of the shaft [m], rods from the vertical [rad], [rad/s]"""
ROD = DENSITY * L * SIDE**2
SLIDER = DENSITY * CUBE**3
ACROSS, ALONG = ROD * (L**2 + SIDE**2) / 12, ROD * SIDE**2 / 6
T_END = 10.0
STEPS = (4e-3, 2e-3, 1e-3)
"""[s]"""


@dataclass(frozen=True, eq=False)
class Found:
    """heights and expected (n,) [m]: of the slider over time with the smallest step; errors [m]:
    largest difference with each step; seconds: of the last run.
    """

    time: Array
    heights: Array
    expected: Array
    errors: Array
    seconds: float


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    found = solve(STEPS)
    draw(found, folder / "governor.png")
    return found


def solve(steps: tuple[float, ...], t_end: float = T_END) -> Found:
    m = mechanism()
    runs = [m.simulate(t_end, step=step) for step in steps]
    heights = [HEIGHT + run["slide"].distance for run in runs]
    last = runs[-1]
    expected = reference(last.time)
    every = [round(step / steps[-1]) for step in steps]
    wrong = [found - expected[::k] for found, k in zip(heights, every, strict=True)]
    errors = np.array([np.abs(one).max() for one in wrong])
    return Found(last.time, heights[-1], expected, errors, last.results.solver["seconds"])


def mechanism() -> du.Mechanism:
    m = du.Mechanism(gravity=[0.0, 0.0, -G])
    ends = {"foot": [0, 0, -L / 2], "left": [-OFFSET, 0, L / 2], "right": [OFFSET, 0, L / 2]}
    spin = [0.0, 0.0, SPIN]
    bar = du.RigidBody(ROD, [ACROSS, ACROSS, ALONG], ends)
    shaft = m.add(bar, "shaft", position=[0, 0, L / 2], angular_velocity=spin)
    sides = {"left": [-OFFSET, 0, 0], "right": [OFFSET, 0, 0]}
    cube = du.RigidBody(SLIDER, [SLIDER * CUBE**2 / 6] * 3, sides)
    slider = m.add(cube, "slider", position=[0, 0, HEIGHT], angular_velocity=spin)
    m.add(du.joints.Revolute(m.ground, shaft["foot"], "z", name="bearing"))
    m.add(du.joints.Prismatic(shaft, slider, "z", name="slide"))
    for side, sign in (("left", -1.0), ("right", 1.0)):
        _add_arm(m, shaft[side], slider[side], sign)
    return m


def _add_arm(m: du.Mechanism, top: object, spring: object, sign: float) -> None:
    """A rod with its ball as one body, whose axes are x in the plane of the arms, z to the top."""
    mass = ROD + BALL
    center = (ROD * L / 2 + BALL * L) / mass
    moment = ACROSS + ROD * (center - L / 2) ** 2 + BALL * (L - center) ** 2
    frames = {"top": [0, 0, center], "middle": [0, 0, center - L / 2]}
    radius = OFFSET + center * np.sin(ANGLE)
    turn = np.array([0.0, -sign * ANGLE, 0.0])
    arm = m.add(
        du.RigidBody(mass, [moment, moment, ALONG], frames),
        "left_arm" if sign < 0 else "right_arm",
        position=[sign * radius, 0, L - center * np.cos(ANGLE)],
        rotation=turn,
        velocity=[0, sign * radius * SPIN, 0],
        angular_velocity=[sign * SPIN * np.sin(ANGLE), 0, SPIN * np.cos(ANGLE)],
    )
    m.add(du.joints.Revolute(top, arm["top"], "y"))
    m.add(du.springs.point(spring, arm["middle"], stiffness=K, damping=C, length=REST))


def moment_of_inertia(angle: float) -> tuple[float, float]:
    """About the shaft, of all bodies, and its derivative by the angle of the rods [kg m^2]."""
    s, c = np.sin(angle), np.cos(angle)
    arm = BALL * (OFFSET + L * s) ** 2 + ROD * (OFFSET + L * s / 2) ** 2
    arm += ACROSS * s**2 + ALONG * c**2
    rate = 2 * BALL * (OFFSET + L * s) * L * c + ROD * (OFFSET + L * s / 2) * L * c
    rate += 2 * (ACROSS - ALONG) * s * c
    return ALONG + SLIDER * CUBE**2 / 6 + 2 * arm, 2 * rate


def reference(time: Array) -> Array:
    """Heights of the slider (n,) [m] by Lagrange's equations in it and the angle of the rods."""
    momentum = moment_of_inertia(ANGLE)[0] * SPIN
    inertia = BALL * L**2 + ROD * L**2 / 4 + ACROSS

    def rate(_: float, state: Array) -> list[float]:
        angle, height, angle_rate, height_rate = state
        across, along = L / 2 * np.sin(angle), L - L / 2 * np.cos(angle) - height
        d = np.hypot(across, along)
        by_angle = (across * L / 2 * np.cos(angle) + along * L / 2 * np.sin(angle)) / d
        by_height = -along / d
        pull = K * (d - REST) + C * (by_angle * angle_rate + by_height * height_rate)
        about_shaft, change = moment_of_inertia(angle)
        weight = -(BALL + ROD / 2) * G * L * np.sin(angle)
        centrifugal = (momentum / about_shaft) ** 2 * change / 4
        return [
            angle_rate,
            height_rate,
            (weight + centrifugal - pull * by_angle) / inertia,
            -G - 2 * pull * by_height / SLIDER,
        ]

    start = [ANGLE, HEIGHT, 0.0, 0.0]
    limits = {"rtol": 1e-10, "atol": 1e-12}
    heights: Array = solve_ivp(rate, (0.0, time[-1]), start, "LSODA", t_eval=time, **limits).y[1]
    return heights


def draw(found: Found, target: Path) -> None:
    figure, (motion, wrong) = view.panels(2)
    with view.style():
        motion.plot(found.time, found.heights)
        motion.set(ylabel="height of the slider [m]")
        wrong.semilogy(found.time[1:], np.abs(found.heights - found.expected)[1:])
        wrong.set(xlabel="time [s]", ylabel="error [m]")
        view.entitle(figure, "A05 of the IFToMM library, a flyball governor")
    view.save(figure, target)


if __name__ == "__main__":
    result = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    for step, error in zip(STEPS, result.errors, strict=True):
        print(f"step {step:g} s: largest error {error:.2g} m")
    print(f"{result.seconds:.2f} s")
