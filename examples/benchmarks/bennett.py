"""Bennett's linkage: four bars and four hinges in space, which turn though three are too many.

    python examples/benchmarks/bennett.py [FOLDER]

Opposite bars have the same length and twist, and lengths are as the sines of the twists: a / sin
alpha = b / sin beta (G. T. Bennett, Engineering 76 (1903) 777-778). Then the angles at the ends of
a bar keep tan(first / 2) tan(second / 2) constant, and the first turns in full circles. The
reference uses no multibody solver: kinetic and potential energy follow from this angle, and its
speed from their sum. Writes the picture to FOLDER, by default out/.
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
A, B = 0.3, 0.5
"""lengths of the bars [m]"""
ALPHA = np.pi / 6
BETA = np.arcsin(B / A * np.sin(ALPHA))
"""twists: angles between the hinges at both ends of a bar [rad]"""
RATIO = np.sin((ALPHA + BETA) / 2) / np.sin((BETA - ALPHA) / 2)
MASS_PER_LENGTH, SIDE = 3.0, 0.02
"""[kg/m], [m]"""
START, SPEED = 1.0, 9.0
"""of the first angle [rad, rad/s]"""
T_END = 5.0
STEPS = (2e-3, 1e-3, 5e-4)
"""[s]"""
LINKS = ((A, ALPHA), (B, BETA), (A, ALPHA))
"""length and twist of the three that move; the fourth is the ground"""


@dataclass(frozen=True, eq=False)
class Found:
    """angle, expected (n,) [rad]: of the first hinge with the smallest step; errors [rad], energies
    [J]: largest with each step; removed: the constraints left out; seconds: of the last run.
    """

    time: Array
    angle: Array
    expected: Array
    errors: Array
    energies: Array
    removed: str
    seconds: float


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    found = solve(STEPS)
    draw(found, folder / "bennett.png")
    return found


def solve(steps: tuple[float, ...], t_end: float = T_END) -> Found:
    m = linkage()
    runs = [m.simulate(t_end, step=step, redundant="remove") for step in steps]
    last = runs[-1]
    angles = [START + run["first"].angle for run in runs]
    expected = reference(last.time)
    every = [round(step / steps[-1]) for step in steps]
    errors = [np.abs(one - expected[::k]).max() for one, k in zip(angles, every, strict=True)]
    return Found(
        last.time,
        angles[-1],
        expected,
        np.array(errors),
        np.array([np.ptp(run.energy.kinetic + run.energy.potential) for run in runs]),
        last.results.solver["removed"],
        last.results.solver["seconds"],
    )


def linkage() -> du.Mechanism:
    m = du.Mechanism(gravity=[0.0, 0.0, -G])
    places, rates = place(START), rates_at(START) * SPEED
    bars = []
    for k, ((length, _), (origin, axes)) in enumerate(zip(LINKS, places, strict=True)):
        ends = {"start": [-length / 2, 0, 0], "end": [length / 2, 0, 0]}
        bars.append(
            m.add(
                du.RigidBody(MASS_PER_LENGTH * length, inertia(length), ends),
                f"bar{k + 1}",
                position=origin + axes @ [length / 2, 0, 0],
                rotation=Rotation.from_matrix(axes).as_rotvec(),
                velocity=rates[k, 3:],
                angular_velocity=axes.T @ rates[k, :3],
            )
        )
    hinges = [axes[:, 2] for _, axes in places]
    m.add(du.joints.Revolute(m.ground, bars[0]["start"], hinges[0], name="first"))
    m.add(du.joints.Revolute(bars[0]["end"], bars[1]["start"], hinges[1]))
    m.add(du.joints.Revolute(bars[1]["end"], bars[2]["start"], hinges[2]))
    m.add(du.joints.Revolute(m.ground, bars[2]["end"], [0.0, np.sin(BETA), np.cos(BETA)]))
    return m


def inertia(length: float) -> list[float]:
    """Along the bar and across [kg m^2]."""
    mass = MASS_PER_LENGTH * length
    across = mass * (length**2 + SIDE**2) / 12
    return [mass * SIDE**2 / 6, across, across]


def place(angle: float) -> list[tuple[Array, Array]]:
    """First end (3,) [m] and axes (3, 3) of the bars: along it, and z about the hinge there."""
    second = 2 * np.arctan2(RATIO * np.cos(angle / 2), np.sin(angle / 2))
    origin, axes = np.zeros(3), np.eye(3)
    places = []
    for (length, twist), turn in zip(LINKS, (angle, second, -angle), strict=True):
        axes = axes @ Rotation.from_rotvec([0.0, 0.0, turn]).as_matrix()
        places.append((origin, axes))
        origin = origin + axes @ [length, 0.0, 0.0]
        axes = axes @ Rotation.from_rotvec([twist, 0.0, 0.0]).as_matrix()
    return places


def rates_at(angle: float) -> Array:
    """Rotation and center of each bar by the first angle (3, 6); differences."""
    h, rates = 1e-4, []
    near = zip(place(angle - h), place(angle), place(angle + h), LINKS, strict=True)
    for (r_0, D_0), (_, D), (r_1, D_1), (length, _) in near:
        turn = (D_1 - D_0) / (2 * h) @ D.T
        center = (r_1 - r_0 + (D_1 - D_0) @ [length / 2, 0.0, 0.0]) / (2 * h)
        rates.append([turn[2, 1], turn[0, 2], turn[1, 0], *center])
    return np.array(rates)


def generalized_mass(angle: float) -> float:
    """T = generalized_mass angle'^2 / 2 [kg m^2]."""
    total = 0.0
    for (length, _), (_, axes), rate in zip(LINKS, place(angle), rates_at(angle), strict=True):
        spin = axes.T @ rate[:3]
        total += spin**2 @ inertia(length) + MASS_PER_LENGTH * length * rate[3:] @ rate[3:]
    return float(total)


def height_energy(angle: float) -> float:
    """[J]"""
    pairs = zip(LINKS, place(angle), strict=True)
    return sum(
        float(MASS_PER_LENGTH * length * G * (origin[2] + axes[2, 0] * length / 2))
        for (length, _), (origin, axes) in pairs
    )


def reference(time: Array) -> Array:
    """angle' = sqrt(2 (E - V) / generalized mass); the first bar never turns back."""
    energy = generalized_mass(START) * SPEED**2 / 2 + height_energy(START)

    def rate(_: float, angle: Array) -> list[float]:
        return [np.sqrt(2 * (energy - height_energy(angle[0])) / generalized_mass(angle[0]))]

    limits = {"rtol": 1e-9, "atol": 1e-9}
    angles: Array = solve_ivp(rate, (0.0, time[-1]), [START], "DOP853", t_eval=time, **limits).y[0]
    return angles


def draw(found: Found, target: Path) -> None:
    figure, (motion, wrong) = view.panels(2, share_time=False)
    with view.style():
        motion.plot(found.time, np.gradient(found.angle, found.time), label="Duhamel")
        rate = np.gradient(found.expected, found.time)
        motion.plot(found.time[::50], rate[::50], ".", color="0.3", label="from energy")
        motion.set(xlabel="time [s]", ylabel="first bar [rad/s]")
        wrong.loglog(STEPS, found.errors, "o-", label="first angle [rad]")
        wrong.loglog(STEPS, found.energies, "s-", label="energy [J]")
        wrong.set(xlabel="step [s]", ylabel="largest error")
        for axes in (motion, wrong):
            axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        view.entitle(figure, "Bennett's linkage")
    view.save(figure, target)


if __name__ == "__main__":
    result = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    print(f"left out: {result.removed}")
    for step, wrong, energy in zip(STEPS, result.errors, result.energies, strict=True):
        print(f"step {step:g} s: angle {wrong:.2g} rad, change of energy {energy:.2g} J")
    print(f"{result.seconds:.2f} s, {(result.angle[-1] - START) / (2 * np.pi):.1f} turns")
