"""Cost of a step of the history in each of its forms, over interface dofs, modes and steps; and
what `auto` takes.

The history alone, without Newton and the rest of a step: loads are given. CPU time, one thread,
less that of the same calls from Python for a rigid body, which has no history.

    python benchmarks/history.py [--steps 1000 10000 100000]
"""

import argparse
import time

import numpy as np
from duhamel.solver import (
    LOADS,
    Constant,
    FlexibleBody,
    Model,
    RigidBody,
    Settings,
)
from duhamel.solver.arrays import Array
from duhamel.solver.history.cost import cheapest_history, history_costs
from duhamel.solver.history.dyadic import DyadicConvolution
from duhamel.solver.start.initial import initialize
from duhamel.solver.step.history import finish_history, start_history
from duhamel.solver.step.system import State, System, Workspace
from duhamel.superelement import GeneralizedAlpha, Interface, Modes, Superelement, sample_kernel

H = 1e-4
SCHEME = GeneralizedAlpha(0.9)
LONGEST_KERNEL = 3e8
"""numbers: what memory there is on a small machine"""


def advance(system: System, state: State, work: Workspace, loads: Array) -> None:
    """One step of the history for every row of loads."""
    for p in loads:
        start_history(system.elastic, system.scheme, state, work)
        work.interfaces.p_n[:] = state.interfaces.p
        state.interfaces.p[:] = p
        finish_history(system, state, work)
        state.step[0] += 1


def element(n_c: int, m: int) -> Superelement:
    """Random modes up to the Nyquist frequency, seen at n_c / 6 interfaces."""
    rng = np.random.default_rng(n_c + m)
    modes = Modes(np.sort(rng.uniform(100.0, 3e4, m)), np.full(m, 0.01), rng.normal(size=(n_c, m)))
    return Superelement(
        name=f"{n_c} dofs, {m} modes",
        mass=1.0,
        J_rot=np.eye(3),
        center=np.zeros(3),
        interfaces=tuple(Interface(f"i{k}", rng.normal(size=3), True) for k in range(n_c // 6)),
        kernel=sample_kernel(modes, H, SCHEME, 8),
        modes=modes,
        compliance=modes.compliance,
        accelerance=modes.accelerance,
    )


def measure(body: Superelement, history: str, n_steps: int) -> float:
    """Microseconds a step."""
    loads = tuple(
        LOADS[kind](f"body.{interface.name}", [0.0, 0.0, 1.0], Constant(1.0))
        for interface in body.interfaces
        for kind in ("force", "torque")
    )
    model = Model(
        {"body": FlexibleBody(body)},
        loads=loads,
        settings=Settings(t_end=n_steps * H, step=H, rho_inf=0.9, history=history),
    )
    return microseconds(model, n_steps) - microseconds(rigid(), min(n_steps, 100_000))


def rigid() -> Model:
    return Model({"body": RigidBody(1.0, [1.0, 1.0, 1.0])}, settings=Settings(t_end=H, step=H))


def microseconds(model: Model, n_steps: int) -> float:
    """Of the history of a step, and of calls."""
    initial = initialize(model)
    system, state, work = initial.lowered.system, initial.state, initial.work
    convolution = DyadicConvolution(system.elastic)
    p = np.random.default_rng(0).normal(size=(1024, len(state.interfaces.p)))
    advance(system, state, work, p[:0])
    started, done = time.process_time(), 0
    while done < n_steps:
        n = convolution.steps_until_due(done, min(1024, n_steps - done))
        advance(system, state, work, p[:n])
        convolution.update(state)
        done += n
    return 1e6 * (time.process_time() - started) / n_steps


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--steps", type=int, nargs="+", default=[1000, 10_000, 100_000])
    parser.add_argument("--dofs", type=int, nargs="+", default=[6, 12, 24])
    parser.add_argument("--modes", type=int, nargs="+", default=[60, 400])
    arguments = parser.parse_args()
    print("microseconds a step, measured (modelled)")
    print(
        f"{'dofs':>5} {'modes':>6} {'steps':>8}  {'recursive':>15} {'direct':>17} {'fft':>15}   "
        "auto; without modes"
    )
    for n_c in arguments.dofs:
        for m in arguments.modes:
            body = element(n_c, m)
            for n_steps in arguments.steps:
                cells = []
                modelled = history_costs(n_c, n_c, m, n_steps, n_steps + 1)
                for history in ("recursive", "direct", "fft"):
                    long = history == "direct" and n_steps > 10_000
                    if history != "recursive" and (
                        long or m != arguments.modes[0] or n_c**2 * n_steps > LONGEST_KERNEL
                    ):
                        cells.append("-")
                        continue
                    cells.append(
                        f"{measure(body, history, n_steps):.2f} ({1e-3 * modelled[history]:.2f})"
                    )
                choice = cheapest_history(n_c, n_c, m, n_steps, n_steps + 1)
                fallback = cheapest_history(n_c, n_c, None, n_steps, n_steps + 1)
                print(
                    f"{n_c:5} {m:6} {n_steps:8}  {cells[0]:>15} {cells[1]:>17} {cells[2]:>15}   "
                    f"{choice}; {fallback}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
