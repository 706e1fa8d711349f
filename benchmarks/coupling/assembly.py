"""A welded to B in a model: responses, modes, and a ball that hits it; A alone under a blow."""

from dataclasses import dataclass

import duhamel as du
import numpy as np
from duhamel.superelement import Superelement

from .parts import INTERFACES, STEEL, Array, ComplexArray, plate

PULSE, PULSE_STEP, PULSE_END = 4e-4, 1e-5, 0.04
"""[s] of half sines of 1 N, whose spectrum ends at 3.75 kHz, and of the run after them"""
BALL_MASS, BALL_RADIUS, BALL_SPEED = 0.1, 0.01, 1.0
BALL_STEP, BALL_END = 4e-6, 4e-3
FREE = 6
"""motions of the free assembly, which come first"""


@dataclass(frozen=True)
class Blow:
    """Largest force [N], its time [s]; the speed [m/s] of the ball after it."""

    peak: float
    time: float
    speed: float


def assembly(A: Superelement) -> du.Mechanism:
    """Both parts where their meshes are, the root welded to the foot."""
    B, m = plate().element, du.Mechanism()
    a = m.add(A, name="A", position=A.center)
    b = m.add(B, name="B", place={"root": a["foot"]})
    m.add(du.joints.Fixed(a["foot"], b["root"]), name="weld")
    return m


def responses(A: Superelement, f: Array) -> ComplexArray:
    """Accelerances (k, 6, 6) of top and tip in x, y, z."""
    places = ["A.top", "B.tip"]
    inputs, outputs = (
        [f"{kind}:{place}:{axis}" for place in places for axis in "xyz"]
        for kind in ("force", "acceleration")
    )
    return assembly(A).frf(inputs, outputs, f).values


def frequencies(A: Superelement, n: int) -> Array:
    """The first n of the free assembly [Hz]."""
    return assembly(A).modes(FREE + n).frequencies[FREE:]


def blown(A: Superelement) -> Array:
    """Elastic displacements (2, n, 6) of foot and top of A alone under half sines: along z on the
    foot, and in another run along x on the top.
    """
    motions = []
    for frame, axis in (("foot", "z"), ("top", "x")):
        m = du.Mechanism()
        a = m.add(A, name="A", position=A.center)
        direction = np.eye(3)["xyz".index(axis)]
        m.add(du.loads.Force(a[frame], direction, du.signals.HalfSine(1.0, PULSE)))
        results = m.simulate(PULSE_END, step=PULSE_STEP).results
        motions.append(np.hstack([results.frame(f"A.{name}").u[:, :3] for name in INTERFACES]))
    return np.array(motions)


def struck(A: Superelement) -> Blow:
    """A ball of steel hits the top of the assembly."""
    m = assembly(A)
    start = A.center + A.interface("top").X + [BALL_RADIUS + 1e-6, 0.0, 0.0]
    ball = m.add(
        du.RigidBody(BALL_MASS, [1e-5] * 3), name="ball", position=start,
        velocity=[-BALL_SPEED, 0.0, 0.0],
    )  # fmt: skip
    hertz = du.contacts.Hertz(E=[STEEL.E] * 2, nu=[STEEL.nu] * 2)
    law = du.contacts.plane(m["A"]["top"], ball, "x", ball=BALL_RADIUS, hertz=hertz)
    m.add(law, name="strike")
    results = m.simulate(BALL_END, step=BALL_STEP).results
    force = results.contact("strike").force[:, 0]
    at = force.argmax()
    return Blow(float(force[at]), float(results.time[at]), float(results.body("ball").v[-1, 0]))
