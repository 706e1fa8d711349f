"""Times of a step of the paper's Case 1 when its torque is given step by step, against the
step h of 60 us.

A step lasts from a torque to the outputs, with all that the next can do before its own. It is late
where that takes longer than h. Nothing is tuned: an ordinary process, from Python, its garbage not
collected. CPU time is what the code takes, wall time what other processes let it have. Run as
`python benchmarks/real_time.py [STEPS]`.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import gc
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from duhamel.preprocess import build, read_body
from duhamel.solver import Input, Model, Simulator, read_model
from duhamel.superelement import write

FOLDER = Path(__file__).parents[1]
CASE_1, BEAM = FOLDER / "examples" / "case1.toml", FOLDER / "meshes" / "beam" / "beam.toml"
OUTPUTS = ["joints/pivot/angle", "joints/pivot/angle_rate", "frames/beam.tip/position"]
WARM_UP = 1000
CLOCKS = (time.perf_counter_ns, time.thread_time_ns)


def step_times(model: Model, steps: int) -> tuple[np.ndarray, float]:
    """Wall and CPU nanoseconds of every step (2, steps), and h in nanoseconds; the torque is that
    of the paper.
    """
    torque = model.loads[0].signal
    model = replace(
        model, loads=(replace(model.loads[0], signal=Input("torque", torque(0.0))),)
    ).with_settings(t_end=1e4)
    simulator = Simulator(model, OUTPUTS)
    simulator.step([torque(0.0)])
    h = simulator.time
    times = np.empty((2, steps))
    gc.collect()
    gc.disable()
    for k in range(-WARM_UP, steps):
        value = [torque(simulator.time + h)]
        begun = [clock() for clock in CLOCKS]
        simulator.step(value)
        done = [clock() for clock in CLOCKS]
        if k >= 0:
            times[:, k] = np.subtract(done, begun)
    gc.enable()
    return times, 1e9 * h


def rollback_times(model: Model, repeats: int = 2000) -> tuple[float, float]:
    """Least CPU microseconds in which a state is saved, and gone back to."""
    simulator = Simulator(model, OUTPUTS)
    for _ in range(WARM_UP):
        simulator.step([])
    moment, least = simulator.save(), [np.inf, np.inf]
    for _ in range(repeats):
        for k, act in enumerate((simulator.save, lambda: simulator.restore(moment))):
            begun = time.thread_time_ns()
            act()
            least[k] = min(least[k], 1e-3 * (time.thread_time_ns() - begun))
    return least[0], least[1]


def main() -> None:
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    if not BEAM.with_suffix(".h5").exists():
        write(BEAM.with_suffix(".h5"), build(read_body(BEAM)))
    model = read_model(CASE_1)
    print(f"{steps} steps, us\n")
    print("| corrections | time | median | 99 % | 99.9 % | worst | median of h | late |")
    print("|---|---|---|---|---|---|---|---|")
    for corrections in (None, 2, 1):
        both, h = step_times(model.with_settings(fixed_iterations=corrections), steps)
        for clock, times in zip(("wall", "CPU"), both, strict=True):
            cells = [
                f"{t / 1e3:.1f}" for t in (*np.quantile(times, [0.5, 0.99, 0.999]), times.max())
            ]
            name = corrections or "until converged"
            print(
                f"| {name} | {clock} | {' | '.join(cells)} | {np.median(times) / h:.0%} | "
                f"{np.mean(times > h):.2%} |"
            )
    save, restore = rollback_times(model)
    print(f"\na state is saved in {save:.0f} us and restored in {restore:.0f} us")


if __name__ == "__main__":
    main()
