"""The cost of derivatives by dual numbers and by differences, over that of a run.

python benchmarks/derivatives.py

Seconds of the processor, the least of some rounds: a machine with other work on it gives the same
ratios. Case 1 has nothing that switches; the ball bounces, and is differentiated at six values.
"""

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from duhamel import preprocess, superelement
from duhamel.solver import (
    Contact,
    Frame,
    Impact,
    Model,
    RigidBody,
    Settings,
    Start,
    read_model,
    simulate,
)
from duhamel.solver.derivatives.run import recorded_rows, run_with_derivatives
from duhamel.solver.derivatives.seeds import Seeds, start_of
from duhamel.solver.lower.allocation import make_output
from duhamel.solver.step.loop import advance
from duhamel.solver.step.record import record
from duhamel.solver.step.system import Run
from duhamel.study import sensitivities

ROOT = Path(__file__).parents[1]
ROUNDS = 3
COUNTS = (1, 4)
NO_SEEDS = Seeds({part: {} for part in ("system", "state", "work", "inputs")}, 0)
CASE_1 = (
    *("loads.0.signal.values.0", "loads.0.signal.values.2", "bodies.hub.frames.rim.position.0"),
    "loads.0.signal.times.1",
)
BALL = (
    *("contacts.floor.stiffness", "bodies.ball.mass", "bodies.ball.position.2"),
    "simulation.gravity.2",
)


def seconds(function: Callable[[], object]) -> float:
    """The least time of some calls, after one that compiles what is needed."""
    function()
    taken = []
    for _ in range(ROUNDS):
        begin = time.process_time()
        function()
        taken.append(time.process_time() - begin)
    return min(taken)


def case_1(folder: Path) -> Model:
    element = preprocess.build(preprocess.read_body(ROOT / "meshes/beam/beam.toml"))
    superelement.write(folder / "beam.h5", element)
    text = (ROOT / "examples/case1.toml").read_text()
    (folder / "case1.toml").write_text(text.replace("../meshes/beam/beam.h5", "beam.h5"))
    return read_model(folder / "case1.toml")


def bouncing() -> Model:
    floor = Contact(
        "floor",
        ["ground.floor", "ball"],
        "plane",
        ball=0.0,
        axis=[0, 0, 1],
        impact=Impact(stiffness=1e5, restitution=1.0),
    )
    ball = RigidBody(1.0, [0.1] * 3, start=Start(position=[0.0, 0.0, 0.01]))
    return Model(
        {"ball": ball},
        contacts=[floor],
        ground_frames={"floor": Frame([0, 0, 0])},
        gravity=(0, 0, -9.81),
        settings=Settings(t_end=0.2, step=4e-5),
    )


def loop_ratio(model: Model, k: int) -> float:
    """The time loop with k derivatives, its rows recorded, over that without."""

    def taken(derivatives: int) -> float:
        start = start_of(model, recorded_rows)
        initial = start.initial
        output = make_output(start.lowered, start.lowered.n_steps + 2)
        system = start.lowered.system
        run = Run(system=system, state=initial.state, work=initial.work, output=output)
        begin = time.process_time()
        if derivatives:
            run_with_derivatives(start, [NO_SEEDS] * derivatives, ())
        else:
            record(run, 0)
            advance(run, start.inputs)
        return time.process_time() - begin

    least = [min(taken(n) for _ in range(1 + ROUNDS)) for n in (k, 0)]
    return least[0] / least[1]


def report(name: str, model: Model, parameters: Sequence[str], outputs: Sequence[str]) -> None:
    run = seconds(lambda: simulate(model))
    print(f"{name}: a run takes {run:.3f} s")
    loops = ", ".join(f"{k}: {loop_ratio(model, k):.1f}" for k in (1, 4, 8))
    print(f"    the loop with derivatives, over that without: {loops}")
    for method in ("dual", "differences"):
        ratios = [
            seconds(lambda: sensitivities(model, parameters[:n], outputs, method=method)) / run  # noqa: B023
            for n in COUNTS
        ]
        shown = ", ".join(f"{n}: {ratio:.1f}" for n, ratio in zip(COUNTS, ratios, strict=True))
        print(f"    {method}, runs for parameters {shown}")


def main() -> None:
    with TemporaryDirectory() as folder:
        outputs = ["final angle:hub:z", "max |displacement:beam.tip:hub.rim:y|"]
        report("Case 1", case_1(Path(folder)), CASE_1, outputs)
    report("ball", bouncing(), BALL, ["final position:ball:z", "max event:floor:peak"])


if __name__ == "__main__":
    main()
