"""What few modes make of an impact: peak force and rebound over the number of modes.

Rods of steel, 1 m, on a wall, on an equal one and on one of twice the length, beside d'Alembert's
waves; Timoshenko's sphere on a beam beside his integral equation. `free`: the first modes of the
free body alone; Craig and Bampton, Rubin: with what they add for the interfaces; all modes: every
one of the mesh, the impulse superelement. Modes that do not move the point of contact, half those
of the beam, are not counted. The contact of rods is as stiff as the step resolves, K = Z / 3.3 h.
Run as `python benchmarks/why_impulses.py`; it takes a minute.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

from collections.abc import Callable, Iterator
from functools import cache
from itertools import chain

import numpy as np
from duhamel.preprocess import build
from duhamel.preprocess.body.body import Method
from duhamel.superelement import Superelement
from impact.bodies import axial, beam_body, rod_body
from impact.exact import (
    Rod,
    RodImpact,
    contacts,
    rod_on_rod,
    rod_on_wall,
    sphere_on_beam,
    timoshenko,
)
from impact.line import Collision, Side, collide

ELEMENTS = 160
"""of a rod of 1 m"""
BEAM_ELEMENTS = 40
COUNTS = (1, 2, 4, 8, 16, 32, 64)
SPEED = 1.0
RISE = 3.3
"""Time constant of the contact of rods, Z / K, in steps."""
LONGER = 1.3
"""Time that is looked at, over that of the contact of rods."""
X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
ROD = Rod(length=1.0, EA=2.1e11 * 1e-4, mass_per_length=7800.0 * 1e-4)
LONG = Rod(2.0 * ROD.length, ROD.EA, ROD.mass_per_length)
BEAM_TIMES = {1: 3e-4, 2: 3.6e-3}
BEAM_STEP = 1e-6
METHODS: dict[str, Method] = {"free": "modal", "Craig-Bampton": "craig-bampton", "Rubin": "rubin"}


@cache
def rod_element(rod: Rod, method: Method, count: int | None) -> Superelement:
    body = rod_body(rod, round(ELEMENTS * rod.length / ROD.length))
    return build(body) if method == "modal" or count is None else axial(body, method, count)


def rod_side(rod: Rod, method: Method, count: int | None, speed: float = 0.0) -> Side:
    """A rod as a contact feels it; all modes for no count."""
    cached = None if method == "modal" else count
    side = Side.body(rod_element(rod, method, cached), X, "touch", speed=speed)
    return side.first(count) if method == "modal" and count is not None else side


def rods(struck: Rod | None, exact: RodImpact, method: Method, count: int | None) -> Collision:
    """A rod on a wall, for None, or on another one."""
    h = ROD.length / ELEMENTS / ROD.wave_speed
    K = ROD.impedance / (RISE * h)
    other = Side.wall() if struck is None else rod_side(struck, method, count)
    striker = rod_side(ROD, method, count, SPEED)
    return collide(striker, other, K, 1.0, LONGER * exact.duration, h)


def sphere(case: int, method: Method, count: int | None) -> Collision:
    """Timoshenko's sphere on the beam; of its modes half move the middle."""
    impact = timoshenko(case)
    body = beam_body(impact, BEAM_ELEMENTS)
    truncated = count is not None and method != "modal"
    element = build(body.with_modes(method, 2 * count) if truncated and count else body)
    side = Side.body(element, Z, "middle", ("left", "right"))
    if method == "modal" and count is not None:
        side = side.first(count)
    ball = Side.particle(impact.m, impact.speed)
    return collide(ball, side, impact.K, 1.5, BEAM_TIMES[case], BEAM_STEP)


def told(run: Collision, peak: float, speed: float) -> str:
    """Peak over the exact one, velocities over the speed, and the number of contacts."""
    found = contacts(run.time, run.force)
    largest = max(contact.peak for contact in found)
    after = f"{run.velocity[-1] / speed:.2f}, {run.struck[-1] / speed:.2f}"
    return f"{largest / peak:.3f} ({after}; {len(found)})"


def table(
    title: str, one: Callable[[Method, int | None], Collision], peak: float, speed: float
) -> Iterator[str]:
    """A row for each method, a column for each number of modes; all of them in the first line."""
    yield f"\n{title}: {told(one('modal', None), peak, speed)} with all modes\n"
    yield "| modes | " + " | ".join(str(count) for count in COUNTS) + " |"
    yield "|" + "---|" * (len(COUNTS) + 1)
    for name, method in METHODS.items():
        cells = (told(one(method, count), peak, speed) for count in COUNTS)
        yield f"| {name} | " + " | ".join(cells) + " |"


def rod_tables() -> Iterator[str]:
    for title, struck, exact in (
        ("rod on a wall, -1", None, rod_on_wall(ROD, SPEED)),
        ("equal rods, 0 and 1", ROD, rod_on_rod(ROD, ROD, SPEED)),
        ("rods 1:2, 0 and 1/2", LONG, rod_on_rod(ROD, LONG, SPEED)),
    ):

        def one(
            method: Method, count: int | None, struck: Rod | None = struck, exact: RodImpact = exact
        ) -> Collision:
            return rods(struck, exact, method, count)

        yield from table(title, one, exact.force, SPEED)


def beam_tables() -> Iterator[str]:
    for case in (1, 2):
        impact = timoshenko(case)
        exact = sphere_on_beam(impact, BEAM_TIMES[case], 0.5 * BEAM_STEP)
        found = contacts(exact.time, exact.force)

        def one(method: Method, count: int | None, case: int = case) -> Collision:
            return sphere(case, method, count)

        rebound = exact.velocity[-1] / impact.speed
        title = f"sphere on beam, case {case}, {rebound:.4f} after {len(found)}"
        yield from table(title, one, max(contact.peak for contact in found), impact.speed)


def main() -> None:
    print("peak force over the exact one (velocities after it; contacts)")
    for line in chain(rod_tables(), beam_tables()):
        print(line, flush=True)


if __name__ == "__main__":
    main()
