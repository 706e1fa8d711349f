"""What few modes make of an impact: peak force, blows and rebound over the number of modes.

Rods of steel, 1 m, on a wall, on an equal one and on one of twice the length, beside d'Alembert's
waves; Timoshenko's sphere on a beam, and an arm on its stop, beside an integral equation; a hammer
on the bracket of the gallery, with a soft and with a hard tip, beside all modes that its steps
resolve. `free`: the first modes of the free body alone; Craig and Bampton, Rubin: with what they
add for the interfaces; all: the impulse superelement. Modes that do not move the point of contact
are not counted. Run as `python benchmarks/why_impulses.py [--picture FILE.png]`; it takes about a
minute.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import argparse
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from duhamel.solver import Impact
from duhamel.superelement import Superelement
from impact import exact, models
from impact.bodies import (
    Reducible,
    reducible_arm,
    reducible_beam,
    reducible_bracket,
    reducible_rod,
)
from impact.exact import History, Rod, steel_arm, timoshenko
from matplotlib.axes import Axes

ELEMENTS = 160
"""of a rod of 1 m"""
BEAM_ELEMENTS, ARM_ELEMENTS = 40, 80
COUNTS = (1, 2, 4, 8, 16, 32, 64)
SPEED = 1.0
METHODS = {"free": "free", "Craig-Bampton": "craig-bampton", "Rubin": "rubin"}
HELD = {name: METHODS[name] for name in ("Craig-Bampton", "Rubin")}
ROD = Rod(length=1.0, EA=2.1e11 * 1e-4, mass_per_length=7800.0 * 1e-4)
LONG = Rod(2.0 * ROD.length, ROD.EA, ROD.mass_per_length)
ROD_STEP = models.rod_step(ROD, ELEMENTS)
ROD_RHO_INF = 0.5
"""With more, ends that go on side by side without a force touch again."""
STEP, EXACT_STEP = 1e-6, 2e-7
"""of beams [s]"""
BEAM_TIMES = {1: 3e-4, 2: 3.6e-3}
ARM_TIME = 6e-3
HAMMER_STEP, HAMMER_TIME = 4e-6, {"soft": 2e-3, "hard": 1e-3}
TIP_RADIUS = 0.01
"""of the hard tip of the hammer [m]"""
TIPS = {
    "soft": Impact(stiffness=1e6),
    "hard": Impact(
        stiffness=4.0 / 3.0 * np.sqrt(TIP_RADIUS) / ((1 - 0.3**2) / 2.1e11 + (1 - 0.33**2) / 7e10),
        exponent=1.5,
    ),
}
HAMMER_MASS = 0.16
LEAST_DRAWN = 1e-4


@dataclass(frozen=True)
class Outcome:
    """The largest force [N], the impulse of the first blow [N s], the number of blows, and the
    speed after them over that before.
    """

    peak: float
    first_impulse: float
    blows: int
    rebound: float

    @classmethod
    def of(cls, history: History) -> "Outcome":
        found = history.blows
        return cls(
            max(contact.peak for contact in found),
            found[0].impulse,
            len(found),
            float(history.velocity[-1] / history.velocity[0]),
        )


@dataclass(frozen=True, eq=False)
class Problem:
    """An impact by method and number of modes, None for all, and its exact outcome if there is."""

    name: str
    strike: Callable[[str, int | None], History]
    exact: Outcome | None
    methods: Mapping[str, str] = field(default_factory=lambda: METHODS)
    found: dict[tuple[str, int | None], Outcome] = field(default_factory=dict)

    def outcome(self, method: str, count: int | None) -> Outcome:
        key = (method if count else "all", count)
        if key not in self.found:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # that the modes are few is known
                self.found[key] = Outcome.of(self.strike(method, count))
        return self.found[key]

    @property
    def right(self) -> Outcome:
        return self.exact or self.outcome("all", None)


@cache
def reducible(rod: Rod) -> Reducible:
    return reducible_rod(rod, round(ELEMENTS * rod.length / ROD.length))


@cache
def rod_element(rod: Rod, method: str, count: int | None) -> Superelement:
    return reducible(rod).with_modes(method, count)


def wall(method: str, count: int | None) -> History:
    answer = exact.rod_on_wall(ROD, SPEED)
    element = rod_element(ROD, method, count)
    return models.rod_on_wall(ROD, element, answer, SPEED, ROD_STEP, ROD_RHO_INF).strike()


def rods(other: Rod) -> Callable[[str, int | None], History]:
    answer = exact.rod_on_rod(ROD, other, SPEED)

    def strike(method: str, count: int | None) -> History:
        pair = (rod_element(ROD, method, count), rod_element(other, method, count))
        return models.rod_on_rod(ROD, pair, answer, SPEED, ROD_STEP, ROD_RHO_INF).strike()

    return strike


def of_rods(answer: exact.RodImpact) -> Outcome:
    return Outcome(answer.force, answer.impulse, 1, answer.velocities[0] / SPEED)


def sphere(case: int) -> Problem:
    impact, t_end = timoshenko(case), BEAM_TIMES[case]
    beam = reducible_beam(impact, BEAM_ELEMENTS)

    def strike(method: str, count: int | None) -> History:
        element = beam.with_modes(method, count)
        return models.sphere_on_beam(impact, element, t_end, STEP).strike()

    answer = Outcome.of(exact.point_impact(impact, t_end, EXACT_STEP))
    return Problem(f"sphere on beam, case {case}", strike, answer)


def arm() -> Problem:
    impact = steel_arm()
    body = reducible_arm(impact, ARM_ELEMENTS)

    def strike(method: str, count: int | None) -> History:
        element = body.with_modes(method, count)
        return models.arm_on_stop(impact, element, ARM_TIME, STEP).strike()

    return Problem(
        "arm on a stop", strike, Outcome.of(exact.point_impact(impact, ARM_TIME, EXACT_STEP))
    )


def hammers() -> Iterator[Problem]:
    bracket = reducible_bracket(HAMMER_STEP)
    for name, tip in TIPS.items():
        hammer, t_end = models.Hammer(HAMMER_MASS, tip, SPEED), HAMMER_TIME[name]

        def strike(
            method: str, count: int | None, hammer: models.Hammer = hammer, t_end: float = t_end
        ) -> History:
            element = bracket.with_modes(method, count)
            return models.hammer_on_lug(hammer, element, t_end, HAMMER_STEP).strike()

        # Few free modes cannot be bolted: they have less motions than bolts would hold.
        yield Problem(f"hammer on the bracket, {name} tip", strike, None, HELD)


def problems() -> list[Problem]:
    return [
        Problem("rod on a wall", wall, of_rods(exact.rod_on_wall(ROD, SPEED))),
        Problem("equal rods", rods(ROD), of_rods(exact.rod_on_rod(ROD, ROD, SPEED))),
        Problem("rods of 1 m and 2 m", rods(LONG), of_rods(exact.rod_on_rod(ROD, LONG, SPEED))),
        arm(),
        *hammers(),
        sphere(1),
        sphere(2),
    ]


def table(
    title: str,
    asked: Sequence[Problem],
    methods: Collection[str],
    told: Callable[[Outcome, Outcome], str],
    right: Callable[[Outcome], str],
) -> None:
    """A row for each problem and method, a column for each number of modes, all, and the answer."""
    head = [title, "", *map(str, COUNTS), "all", "exact"]
    print("", "| " + " | ".join(head) + " |", "|" + "---|" * len(head), sep="\n")
    for problem in asked:
        for name in (name for name in methods if name in problem.methods):
            outcomes = [problem.outcome(METHODS[name], count) for count in (*COUNTS, None)]
            cells = [told(outcome, problem.right) for outcome in outcomes]
            known = right(problem.exact) if problem.exact else ""
            print("| " + " | ".join([problem.name, name, *cells, known]) + " |", flush=True)


def tables(asked: Sequence[Problem]) -> None:
    one = ("Craig-Bampton",)
    table(
        "peak force over the exact one",
        asked,
        METHODS,
        lambda found, right: f"{found.peak / right.peak:.3f}",
        lambda right: f"{right.peak:.5g} N",
    )
    table(
        "blows", asked, one, lambda found, right: str(found.blows), lambda right: str(right.blows)
    )
    table(
        "impulse of the first blow over the exact one",
        asked,
        one,
        lambda found, right: f"{found.first_impulse / right.first_impulse:.3f}",
        lambda right: f"{right.first_impulse:.5g} N s",
    )
    table(
        "speed after them over that before",
        asked,
        one,
        lambda found, right: f"{found.rebound:.3f}",
        lambda right: f"{right.rebound:.3f}",
    )


PICTURED = {4: "4 modes", 16: "16", None: "all, impulses"}
"""numbers of Craig and Bampton's modes whose forces are drawn"""


def picture(asked: Sequence[Problem], path: str) -> None:
    """Forces on equal rods over time, and errors of the peak over the number of modes."""
    figure, (forces, errors) = plt.subplots(1, 2, figsize=(13.0, 4.2), layout="constrained")
    draw_forces(forces)
    draw_errors(errors, asked)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_forces(axes: Axes) -> None:
    answer, strike = exact.rod_on_rod(ROD, ROD, SPEED), rods(ROD)
    for count, label in PICTURED.items():
        history = strike("craig-bampton", count)
        axes.plot(1e6 * history.time, 1e-3 * history.force, label=label, linewidth=1.2)
    edges = 1e6 * np.array([0.0, 0.0, answer.duration, answer.duration])
    exact_force = 1e-3 * np.array([0.0, answer.force, answer.force, 0.0])
    axes.plot(edges, exact_force, "k--", label="exact", linewidth=1.2)
    axes.set(xlabel="time [us]", ylabel="force [kN]", title="equal rods, Craig-Bampton")
    axes.legend()


def draw_errors(axes: Axes, asked: Sequence[Problem]) -> None:
    for problem in asked:
        peaks = [problem.outcome("craig-bampton", count).peak for count in COUNTS]
        error = np.abs(np.array(peaks) / problem.right.peak - 1.0)
        axes.loglog(COUNTS, np.maximum(error, LEAST_DRAWN), "o-", label=problem.name, markersize=4)
    axes.set_xticks(COUNTS, [str(count) for count in COUNTS])
    axes.set(xlabel="modes", ylabel="error of the peak force", title="Craig-Bampton")
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))


def main() -> None:
    parser = argparse.ArgumentParser(description="What few modes make of an impact.")
    parser.add_argument("--picture", help="a file for it")
    chosen = parser.parse_args()
    asked = problems()
    tables(asked)
    if chosen.picture:
        picture(asked, chosen.picture)


if __name__ == "__main__":
    main()
