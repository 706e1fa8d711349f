"""Frequencies of the paper's five cases about rest, and the damping that its rule of convolution
(eq. 55) adds.

    python examples/frequencies.py

prints both for the beam as stiff out of the plane of rotation as in it, and for the one that is ten
times softer. The hub of a model turns about, and where its joint is cylindrical slides along, the
axis z; the rest is clamped to it.
"""

from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement
from duhamel.superelement import Superelement
from numpy.typing import NDArray
from scipy.linalg import block_diag, eigh, null_space

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
CASES = ("case1", "case2", "case3", "case4", "case5")


def vibrations(model: solver.Model, beam: Superelement) -> tuple[Array, Array]:
    """Frequencies (m,) [Hz] of small vibrations, rising, and the share (m,) of rigid motion in
    their kinetic energy.

    In the coordinates y of the hub, of the beam as a rigid body, of its modes and of the ball on
    its tip, if there is one, M and K are block diagonal, and B y = 0 joins them: eigenvectors in
    the null space of B.
    """
    hub, ball = model.bodies["hub"], model.bodies.get("ball")
    axis = next(joint for joint in model.joints if joint.between[0] == "ground")
    free = [2, 5] if axis.type == "cylindrical" else [5]
    masses = [inertia(hub)[np.ix_(free, free)], inertia(beam), np.eye(len(beam.modes.omega))]
    root, tip = (
        np.hstack([rigid_motion(X), beam.modes.phi[beam.rows(name)]]) for name, X in places(beam)
    )
    B = np.hstack([rigid_motion(hub.frames["rim"].position)[:, free], -root])
    if ball is not None:
        masses.append(inertia(ball))
        B = np.block([[B, np.zeros((6, 6))], [np.zeros((6, len(free))), tip, -np.eye(6)]])
    M, elastic = block_diag(*masses), slice(len(free) + 6, len(free) + 6 + len(beam.modes.omega))
    K = np.zeros(len(M))
    K[elastic] = beam.modes.omega**2
    N = null_space(B)
    squares, modes = eigh(N.T @ (K[:, None] * N), N.T @ M @ N)
    squares, y = (
        squares[len(free) :],
        (N @ modes)[:, len(free) :],
    )  # without the motions of the whole
    return np.sqrt(squares) / (2.0 * np.pi), 1.0 - (y[elastic] ** 2).sum(axis=0)


def damping_of_the_paper(frequency: Array, rigid_share: Array, h: float) -> Array:
    """Damping ratios (m,) that eq. (55) with the step h [s] gives to vibrations of an undamped
    system, to first order.

    The rule delays elastic displacements by h/2 (docs/theory.md), so that u = (1 - i omega h / 2)
    H_el lambda under the loads lambda of a mode. Perturbing the mode, with mass-normalized modal
    coordinates eta of the beam,

        zeta = h / (4 omega) sum_i (omega_i^2 - omega^2) eta_i^2 = (omega h / 4) (1 - sum_i eta_i^2)

    since sum_i omega_i^2 eta_i^2 = omega^2 where nothing else is elastic: omega h / 4 times the
    rigid share.
    """
    return 0.5 * np.pi * frequency * h * rigid_share


def inertia(body: solver.RigidBody | Superelement) -> Array:
    """(6, 6)"""
    J = body.J_rot if isinstance(body, Superelement) else body.inertia
    return block_diag(body.mass * np.eye(3), J)


def places(beam: Superelement) -> list[tuple[str, Array]]:
    found = {interface.name: interface.X for interface in beam.interfaces}
    return [(name, found[name]) for name in ("root", "tip")]


def rigid_motion(X: Array) -> Array:
    """U = [I, -skew(X); 0, I] (6, 6) of a point."""
    U = np.eye(6)
    U[:3, 3:] = np.cross(np.eye(3), X).T  # columns e_i x X
    return U


def main() -> None:
    for name in ("beam", "flat"):
        body = ROOT / f"meshes/beam/{name}.toml"
        if not (target := body.with_suffix(".h5")).exists():
            superelement.write(preprocess.build(preprocess.read_body(body)), target)
        beam = superelement.read(target)
        print(f"{name}.h5: free from {beam.modes.omega.min() / (2.0 * np.pi):.3f} Hz")
        for case in CASES:
            model = solver.read_model(ROOT / f"examples/{case}.toml")
            h = model.settings.step or beam.kernel.h
            frequency, share = vibrations(model, beam)
            zeta = damping_of_the_paper(frequency, share, h)
            found = zip(frequency[:8], 100.0 * zeta[:8], strict=True)
            print(f"  {case}: " + ", ".join(f"{f:.2f} Hz ({ratio:.2f} %)" for f, ratio in found))
    print("in brackets: damping ratio that rule (55) adds at the step of the case")


if __name__ == "__main__":
    main()
