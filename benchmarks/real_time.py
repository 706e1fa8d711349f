"""How long a step of the paper's Case 1 takes when its torque is given step by step, against the step h of 60 us.

`step` is the time from a torque to the outputs, `prepare` what is done before the next torque is known. A step is late
where both together take longer than h. Nothing is tuned: an ordinary process, from Python, its garbage not collected.
Run as `python benchmarks/real_time.py [STEPS]`.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import gc
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from duhamel.solver import Input, Model, Simulator, read_model

CASE_1 = Path(__file__).parents[1] / "examples" / "case1.toml"
OUTPUTS = ["joints/pivot/angle", "joints/pivot/angle_rate", "frames/beam.tip/position"]
WARM_UP = 1000


def step_times(model: Model, steps: int) -> tuple[np.ndarray, float]:
    """Nanoseconds of step and of prepare (steps, 2), and h in nanoseconds; the torque is that of the paper."""
    torque = model.loads[0].signal
    model = replace(model, loads=(replace(model.loads[0], signal=Input("torque", torque(0.0))),), t_end=1e4)
    simulator = Simulator(model, OUTPUTS)
    simulator.step([torque(0.0)])
    h = simulator.time
    times = np.empty((steps, 2))
    gc.collect()
    gc.disable()
    for k in range(-WARM_UP, steps):
        value = [torque(simulator.time + h)]
        begun = time.perf_counter_ns()
        simulator.step(value)
        done = time.perf_counter_ns()
        simulator.prepare()
        if k >= 0:
            times[k] = done - begun, time.perf_counter_ns() - done
    gc.enable()
    return times, 1e9 * h


def main() -> None:
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    model = read_model(CASE_1)
    print(f"{steps} steps; us: median, 99.9 %, worst")
    print("| corrections | step | prepare | both | of h | late |\n|---|---|---|---|---|---|")
    for corrections in (None, 2, 1):
        times, h = step_times(replace(model, corrections=corrections), steps)
        both = times.sum(axis=1)
        cells = [", ".join(f"{t / 1e3:.1f}" for t in spread(part)) for part in (*times.T, both)]
        name = corrections or "until converged"
        print(f"| {name} | {' | '.join(cells)} | {np.median(both) / h:.0%} | {np.mean(both > h):.2%} |")


def spread(times: np.ndarray) -> tuple[float, float, float]:
    return float(np.median(times)), float(np.quantile(times, 0.999)), float(times.max())


if __name__ == "__main__":
    main()
