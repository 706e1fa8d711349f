"""A03 of the IFToMM library: Andrews' squeezing mechanism, seven bars with three loops.

    python examples/benchmarks/squeezer.py [FOLDER]

A torque of 0.033 N m drives the mechanism up to 1100 rad/s within 0.03 s. Names, data and the
solution at the end are those of the test set for initial value problems (Hairer and Wanner, Solving
ordinary differential equations II; PSIDE with a tolerance of 1e-14). Writes the picture to FOLDER,
by default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import view
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

MASSES = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
INERTIAS = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
"""of K1 to K7 about their centers of mass [kg m^2]"""
A, B, C = (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
"""pivots and the fixed end of the spring [m]"""
RR, RA, D, DA, E, EA = 7e-3, 0.92e-3, 28e-3, 11.5e-3, 20e-3, 14.21e-3
SS, SA, SB, SC, SD = 35e-3, 18.74e-3, 10.43e-3, 18e-3, 20e-3
ZT, TA, TB, U, UA, UB, ZF, FA = 40e-3, 23.08e-3, 9.16e-3, 40e-3, 12.28e-3, 4.49e-3, 20e-3, 14.21e-3
STIFFNESS, LENGTH, TORQUE = 4530.0, 0.07785, 0.033

ANGLES = ("beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon")
START = (
    -0.0617138900142764496,
    0.0,
    0.455279819163070380,
    0.222668390165885885,
    0.487364979543842550,
    -0.222668390165885885,
    1.23054744454982120,
)
"""angles [rad]; the mechanism starts at rest"""
END = (
    15.81077119629904,
    -15.75637105984298,
    0.04082224013073101,
    -0.5347301163226948,
    0.5244099658805304,
    0.5347301163226948,
    1.048080741042263,
)
"""angles at 0.03 s [rad]"""
RATES = (
    1139.920302151208,
    -1424.379294994111,
    11.03291221937134,
    19.29337464421385,
    0.5735699284790808,
    -19.29337464421385,
    0.3231791658026955,
)
"""at 0.03 s [rad/s]"""
MULTIPLIERS = (
    199.1753333731910,
    -29.75531228015052,
    23.06654119098399,
    31.45271365475927,
    22.64249232082739,
    11.61740700019673,
)
"""forces at 0.03 s on K3, K4, K6, along x and y each [N]"""
T_END = 0.03
STEPS = (4e-5, 2e-5, 1e-5)
"""[s]"""


@dataclass(frozen=True, eq=False)
class Found:
    """angles (n, 7) [rad] over time with the smallest step; largest differences at the end with
    each step: angle_errors [rad], rate_errors [rad/s], force_errors [N]; seconds: of the last run.
    """

    time: Array
    angles: Array
    angle_errors: Array
    rate_errors: Array
    force_errors: Array
    seconds: float


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    found = solve(STEPS)
    draw(found, folder / "squeezer.png")
    return found


def solve(steps: tuple[float, ...]) -> Found:
    m = mechanism()
    runs = [m.simulate(T_END, step=step) for step in steps]
    last = runs[-1]
    return Found(
        last.time,
        np.array(START) + angles(last),
        np.array([np.abs(START + angles(run)[-1] - END).max() for run in runs]),
        np.array([np.abs(rates(run)[-1] - RATES).max() for run in runs]),
        np.array([np.abs(forces(run) - MULTIPLIERS).max() for run in runs]),
        last.results.solver["seconds"],
    )


def mechanism() -> du.Mechanism:
    """Each body of the test set with axes along which its points have the coordinates given."""
    beta, theta, gamma, phi, delta, omega, epsilon = START
    m = du.Mechanism()
    origin, F = np.zeros(2), RR * along(beta)
    G, H = A + ZT * along(delta), A + U * along(epsilon - np.pi / 2)
    K1 = add(m, 1, origin, beta, (RA, 0), {"O": (0, 0), "F": (RR, 0)})
    K2 = add(m, 2, F, beta + theta, (-DA, 0), {"F": (0, 0), "E": (-D, 0)})
    K3 = add(m, 3, B, gamma, (SB, -SA), {"B": (0, 0), "E": (0, -SS), "D": (SD, -SC)})
    K4 = add(m, 4, G, phi + delta - np.pi / 2, (E - EA, 0), {"G": (0, 0), "E": (E, 0)})
    K5 = add(m, 5, A, delta, (TA, TB), {"A": (0, 0), "G": (ZT, 0)})
    K6 = add(m, 6, H, omega + epsilon, (ZF - FA, 0), {"H": (0, 0), "E": (ZF, 0)})
    K7 = add(m, 7, A, epsilon, (UB, -UA), {"A": (0, 0), "H": (0, -U)})
    hinges = (
        (m.ground, K1["O"]),
        (K1["F"], K2["F"]),
        (m.ground, K3["B"]),
        (K5["G"], K4["G"]),
        (m.ground, K5["A"]),
        (K7["H"], K6["H"]),
        (m.ground, K7["A"]),
    )
    for name, (one, other) in zip(ANGLES, hinges, strict=True):
        m.add(du.joints.Revolute(one, other, "z", name=name))
    # The loops meet at E. Further hinges there would constrain the plane again.
    for body in (K3, K4, K6):
        m.add(du.joints.PointOnLine(K2["E"], body["E"], "z", name=f"E of {body.name}"))
    end = m.ground.frame("C", [*C, 0.0])
    m.add(du.springs.point(end, K3["D"], stiffness=STIFFNESS, length=LENGTH))
    m.add(du.loads.Torque(K1, "z", du.signals.Constant(TORQUE)))
    return m


def along(angle: float) -> Array:
    return np.array([np.cos(angle), np.sin(angle)])


def add(
    m: du.Mechanism,
    number: int,
    origin: ArrayLike,
    angle: float,
    center: tuple[float, float],
    points: dict[str, tuple[float, float]],
) -> du.mechanism.BodyHandle:
    """Body K1 to K7; origin in the plane, center of mass and points in its axes [m]."""
    frames = {name: [x - center[0], y - center[1], 0.0] for name, (x, y) in points.items()}
    at = np.asarray(origin) + center[0] * along(angle) + center[1] * along(angle + np.pi / 2)
    body = du.RigidBody(MASSES[number - 1], [INERTIAS[number - 1]] * 3, frames)
    return m.add(body, f"K{number}", position=[*at, 0.0], rotation=[0.0, 0.0, angle])


def angles(run: du.Run) -> Array:
    """Changes of ANGLES (n, 7) [rad]."""
    return np.stack([run[name].angle for name in ANGLES], axis=1)


def rates(run: du.Run) -> Array:
    return np.stack([run[name].angle_rate for name in ANGLES], axis=1)


def forces(run: du.Run) -> Array:
    """MULTIPLIERS: forces at the end on K3, K4 and K6."""
    return np.concatenate([run[f"E of K{k}"].force[-1, :2] for k in (3, 4, 6)])


def draw(found: Found, target: Path) -> None:
    figure, (motion, fast, errors) = view.panels(3, share_time=False)
    with view.style():
        for k, name in enumerate(ANGLES):
            axes = fast if k < 2 else motion
            axes.plot(1e3 * found.time, found.angles[:, k], label=name)
        motion.set(ylabel="angle [rad]")
        fast.set(xlabel="time [ms]", ylabel="angle [rad]")
        errors.loglog(STEPS, found.angle_errors, "o-", label="angles [rad]")
        errors.loglog(STEPS, found.rate_errors, "s-", label="rates [rad/s]")
        errors.loglog(STEPS, found.force_errors, "^-", label="forces [N]")
        errors.set(xlabel="step [s]", ylabel="error at 0.03 s")
        for axes in (motion, fast, errors):
            axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        view.entitle(figure, "A03 of the IFToMM library, Andrews' squeezing mechanism")
    view.save(figure, target)


if __name__ == "__main__":
    result = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    errors = (result.angle_errors, result.rate_errors, result.force_errors)
    for step, angle, rate, force in zip(STEPS, *errors, strict=True):
        print(f"step {step:g} s: angles {angle:.2g} rad, rates {rate:.2g} rad/s, {force:.2g} N")
    print(f"{result.seconds:.2f} s")
