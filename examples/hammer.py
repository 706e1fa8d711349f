"""A hammer on a bracket: the force of the blow, and the stresses at its worst.

    python examples/hammer.py [FOLDER]

runs examples/hammer.toml. The force is compared with that of the same hammer on modes of the finite
element mesh with its bolts held, found without the superelement and integrated in time by scipy;
the impulse with the momentum that the hammer loses. Writes results and pictures to FOLDER, by
default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from duhamel import preprocess, solver, superelement, view
from duhamel.preprocess import assemble
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.sparse.linalg import eigsh, splu

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/bracket/struck.toml"
MODES = 40
"""of the bracket with its bolts held, up to 30 kHz; the rest is compliance"""
HELD = 24
"""rows of the four bolts in those of the interfaces"""
TOLERANCE = 1e-9
ENLARGED = 40.0
"""displacements in the picture of the bracket"""


@dataclass(frozen=True, eq=False)
class Blow:
    """time (n,) [s]; force on the hammer (n,), expected (n,): with the modes of the held mesh [N];
    largest (n,): von Mises stress anywhere [Pa].
    """

    time: Array
    force: Array
    expected: Array
    largest: Array

    @property
    def worst(self) -> float:
        """The time of the largest stress [s]."""
        return float(self.time[self.largest.argmax()])


@dataclass(frozen=True)
class Checks:
    """Largest difference of the force over its peak; of the impulse from the change of momentum,
    relative; the peak on a rigid body by the formula of Hertz [N].
    """

    force: float
    impulse: float
    on_rigid: float


def main(folder: Path) -> tuple[Blow, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/hammer.toml")
    results = solver.simulate(model, output=folder / "hammer.h5")
    found = blow(model, results)
    checks = compare(model, results, found)
    with view.style():
        view.save(curves(found, results), folder / "hammer.png")
        view.save(stressed_bracket(results, found.worst), folder / "hammer-stress.png")
    assert checks.force < 0.025
    assert checks.impulse < 1e-3
    return found, checks


def ensure_superelement() -> Path:
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    return target


def blow(model: solver.Model, results: solver.Results) -> Blow:
    return Blow(
        time=results.time,
        force=results.contact("blow").force[:, 0],
        expected=held_bracket(model, results),
        largest=results.von_mises("bracket", results.time).max(axis=1),
    )


def held_bracket(model: solver.Model, results: solver.Results) -> Array:
    """The force (n,) [N] of the hammer on the bracket with its bolts held, u the face that is hit:

        q_i'' + omega_i^2 q_i = phi_i F,   m x'' = -F,
        u = sum_i phi_i q_i + (c - sum_i phi_i^2 / omega_i^2) F,   F = K (x - u + C_p F)^(3/2)

    c is the static compliance of the face, C_p that of the patch on a half space.
    """
    time, face = results.time, results.frame("bracket.struck").position[0, 0]
    omega, phi, compliance = held_modes()
    (contact,) = model.contacts
    law, hammer = contact.law(), model.bodies["hammer"]
    K = law.stiffness
    rest = compliance - np.sum((phi / omega) ** 2) - law.patch
    speed = -hammer.start.velocity[0]
    gap = hammer.start.position[0] - contact.ball - face

    def force(approach: float) -> float:
        if approach <= 0.0:
            return 0.0
        most = 2.0 * K * approach**1.5
        return float(brentq(lambda F: (F / K) ** (2.0 / 3.0) + rest * F - approach, 0.0, most))

    def rates(_: float, state: Array) -> Array:
        x, v, q, rate = state[0], state[1], state[2 : 2 + MODES], state[2 + MODES :]
        F = force(x - gap - phi @ q)
        return np.concatenate([[v, -F / hammer.mass], rate, phi * F - omega**2 * q])

    start = np.zeros(2 + 2 * MODES)
    start[1] = speed
    states = solve_ivp(
        rates, (0.0, time[-1]), start, t_eval=time, rtol=1e-6, atol=TOLERANCE, max_step=time[1]
    ).y
    return np.array([force(x) for x in states[0] - gap - phi @ states[2 : 2 + MODES]])


def held_modes() -> tuple[Array, Array, float]:
    """omega (m,) [rad/s], the motion (m,) of the face across it, and its compliance [m/N], from

    K u + P^T lambda = omega^2 M u,  P u = 0 at the bolts.
    """
    structure = assemble(preprocess.read_body(BODY))
    bolts, face = structure.P_C[:HELD], structure.P_C[HELD]
    K = sp.block_array([[structure.K, bolts.T], [bolts, None]], format="csc")
    M = sp.block_diag([structure.M, sp.csc_array((HELD, HELD))], format="csc")
    squares, shapes = eigsh(K, MODES, M, sigma=0.0)
    load = np.concatenate([face.toarray().ravel(), np.zeros(HELD)])
    return np.sqrt(squares), load @ shapes, float(load @ splu(K).solve(load))


def compare(model: solver.Model, results: solver.Results, found: Blow) -> Checks:
    hammer, (contact,) = model.bodies["hammer"], model.contacts
    lost = hammer.mass * np.ptp(results.body("hammer").v[:, 0])
    impulse = np.trapezoid(found.force, found.time)
    energy = 1.25 * hammer.mass * hammer.start.velocity[0] ** 2
    return Checks(
        force=float(np.abs(found.force - found.expected).max() / found.expected.max()),
        impulse=abs(float(impulse / lost) - 1.0),
        on_rigid=float(contact.law().stiffness ** 0.4 * energy**0.6),
    )


def curves(found: Blow, results: solver.Results) -> Figure:
    figure, (force, motion, stress) = view.panels(3)
    blue, red, *_ = view.COLORS
    time = 1e3 * found.time
    force.plot(time, 1e-3 * found.force, color=blue, label="superelement")
    force.plot(
        time,
        1e-3 * found.expected,
        color=red,
        linestyle=(0, (4, 3)),
        label="modes of the held mesh",
    )
    face = results.frame("bracket.struck").position[:, 0]
    head = results.body("hammer").x[:, 0]
    motion.plot(time, 1e3 * (face - face[0]), color=blue, label="face of the lug")
    motion.plot(time, 1e3 * (head - head[0]), color="0.6", label="hammer")
    stress.plot(time, 1e-6 * found.largest, color=red)
    force.set(title="force of the blow", ylabel="[kN]")
    motion.set(title="motion along x", ylabel="[mm]")
    stress.set(title="largest von Mises stress", ylabel="[MPa]", xlabel="time [ms]")
    for axes in (force, motion):
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=2)
    view.entitle(figure, "A hammer on a bracket")
    return figure


def stressed_bracket(results: solver.Results, time: float) -> Figure:
    recovery = results.superelement("bracket").recovery
    points = recovery.points + ENLARGED * results.displacement("bracket", time)
    field = view.Field(points, recovery.cells, results.von_mises("bracket", time))
    return view.draw_fields([field], "von Mises stress [MPa]", 1e-6)


def report(found: Blow, checks: Checks) -> None:
    print(
        f"force of the blow           {found.force.max():.1f} N, on a rigid body "
        f"{checks.on_rigid:.1f} N"
    )
    print(f"modes of the held mesh      force within {checks.force:.2e} of its peak")
    print(f"impulse                     momentum of the hammer within {checks.impulse:.2e}")
    print(
        f"largest stress              {1e-6 * found.largest.max():.1f} MPa at "
        f"{1e3 * found.worst:.3f} ms"
    )


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
