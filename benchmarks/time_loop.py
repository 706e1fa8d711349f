"""Cost of a step of the time loop: the paper's Case 1 by part, bodies of many modes, and chains
of flexible bodies.

CPU time on one thread, without set-up and results files, medians of repeats in one process. Parts
are differences: between runs with and without record, and with one correction more and a matrix in
every step.

    python benchmarks/time_loop.py [--bodies 1 2 4 8 16 64 256 1000]
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import argparse
import statistics
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from duhamel.preprocess import build, read_body
from duhamel.solver import (
    FlexibleBody,
    Model,
    Revolute,
    Settings,
    Start,
    read_model,
)
from duhamel.solver.lower.allocation import make_output
from duhamel.solver.simulation import signals
from duhamel.solver.start.initial import initialize
from duhamel.solver.step.loop import advance
from duhamel.solver.step.record import record
from duhamel.solver.step.system import Run
from duhamel.superelement import (
    GeneralizedAlpha,
    Interface,
    Modes,
    Superelement,
    read,
    sample_kernel,
    write,
)

FOLDER = Path(__file__).parents[1]
CASE_1, BEAM = FOLDER / "examples" / "case1.toml", FOLDER / "meshes" / "beam" / "beam.toml"
LENGTH = 0.5
"""[m] of the beam"""
H = 6e-5
REPEATS = 7


class Cost(NamedTuple):
    """Per step: microseconds, corrections and iteration matrices; and the seconds of the start."""

    step: float
    corrections: float
    matrices: float
    start: float


def measure(model: Model, recorded: bool = True, repeats: int = REPEATS) -> Cost:
    seconds, starts = [], []
    for _ in range(repeats):
        started = time.process_time()
        initial = initialize(model)
        starts.append(time.process_time() - started)
        lowered, work = initial.lowered, initial.work
        n = lowered.n_steps
        output = make_output(lowered, n if recorded else 1)
        inputs = signals(lowered, 1, np.arange(n) if recorded else np.full(n, -1))
        run = Run(system=lowered.system, state=initial.state, work=work, output=output)
        record(run, 0)
        work.matrix.count[0] = 0
        started = time.process_time()
        taken, _ = advance(run, inputs)
        seconds.append(time.process_time() - started)
        if taken < n:
            raise RuntimeError(f"no convergence in step {taken + 1}")
    corrections = float(output.newton_iterations.mean()) if recorded else np.nan
    return Cost(
        1e6 * statistics.median(seconds) / n,
        corrections,
        int(work.matrix.count[0]) / n,
        statistics.median(starts),
    )


def beam() -> Superelement:
    file = BEAM.with_suffix(".h5")
    if not file.exists():
        write(file, build(read_body(BEAM)))
    return read(file)


def case_1() -> None:
    beam()
    model = read_model(CASE_1)
    whole, bare = measure(model), measure(model, recorded=False)
    fixed = [measure(model.with_settings(fixed_iterations=n), recorded=False).step for n in (1, 2)]
    correction = fixed[1] - fixed[0]
    others = bare.step - whole.corrections * correction
    matrix = fixed[0] - correction - others
    print(
        f"Case 1: {whole.step:.1f} us a step, {whole.corrections:.2f} corrections, "
        f"{whole.matrices:.3f} matrices\n"
    )
    print("| part | us | times a step |\n|---|---|---|")
    print(
        f"| correction: evaluate, substitute, move | {correction:.2f} | {whole.corrections:.2f} |"
    )
    print(f"| matrix: derivatives, blocks, factors | {matrix:.1f} | {whole.matrices:.3f} |")
    print(f"| record | {whole.step - bare.step:.2f} | 1 |")
    print(
        f"| history, prediction, works, validity | {others - matrix * whole.matrices:.2f} | 1 |\n"
    )


def many_modes() -> None:
    """One body on a revolute joint, under gravity, that remembers by more and more modes."""
    print("| modes at 12 interface dofs | us a step |\n|---|---|")
    for m in (60, 200, 400, 800):
        model = Model(
            {"body": FlexibleBody(element(m))},
            [Revolute("ground", "body.i0", [0, 0, 1], name="pivot")],
            gravity=[0, -9.81, 0],
            settings=Settings(t_end=2000 * H),
        )
        print(f"| {m} | {measure(model).step:.1f} |")
    print()


def element(m: int) -> Superelement:
    """Two interfaces, and random modes up to 30 kHz."""
    rng = np.random.default_rng(m)
    modes = Modes(np.sort(rng.uniform(2e3, 2e5, m)), np.zeros(m), rng.normal(size=(12, m)))
    return Superelement(
        name=f"{m} modes",
        mass=1.0,
        J_rot=0.01 * np.eye(3),
        center=np.zeros(3),
        interfaces=tuple(
            Interface(f"i{k}", np.array([0.2 * k - 0.1, 0.0, 0.0]), True) for k in range(2)
        ),
        kernel=sample_kernel(modes, H, GeneralizedAlpha(0.9), 8),
        modes=modes,
        compliance=modes.compliance,
        accelerance=modes.accelerance,
    )


def chains(numbers: Sequence[int]) -> None:
    """Beams on revolute joints that fall from the horizontal."""
    print(
        "| bodies | us a step | a body | corrections | matrices a step | start "
        "|\n|---|---|---|---|---|---|"
    )
    for n in numbers:
        cost = measure(chain(beam(), n, steps=40 if n > 100 else 400), repeats=3)
        cells = (
            f"{cost.step:.1f} | {cost.step / n:.1f} | {cost.corrections:.2f} | {cost.matrices:.3f}"
        )
        print(f"| {n} | {cells} | {cost.start:.2f} s |", flush=True)


def chain(element: Superelement, n: int, steps: int) -> Model:
    ends = ["ground", *(f"body{k}.tip" for k in range(n))]
    return Model(
        bodies={
            f"body{k}": FlexibleBody(element, Start(position=[LENGTH * (k + 0.5), 0, 0]))
            for k in range(n)
        },
        joints=[Revolute(ends[k], f"body{k}.root", [0, 0, 1], name=f"joint{k}") for k in range(n)],
        gravity=[0, -9.81, 0],
        settings=Settings(t_end=steps * H, step=H),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--bodies", type=int, nargs="+", default=[1, 2, 4, 8, 16, 64, 256, 1000])
    numbers = parser.parse_args().bodies
    case_1()
    many_modes()
    chains(numbers)


if __name__ == "__main__":
    main()
