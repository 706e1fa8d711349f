"""`duhamel run`."""

from pathlib import Path
from time import perf_counter
from typing import Annotated

import typer

from ..arguments import ModelFile, output_option, results_of
from ..failures import errors_in_one_line, one_line, unwritten

Output = Annotated[Path | None, output_option("FILE.h5")]
Resume = Annotated[
    bool,
    typer.Option(
        "--continue",
        help="Go on with the last run to this file, from the state that it kept (checkpoint).",
    ),
]
Anyway = Annotated[
    bool,
    typer.Option(
        "--anyway", help="Also where the model, versions or the machine are not those of that run."
    ),
]


def run(
    model_file: ModelFile, output: Output = None, resume: Resume = False, anyway: Anyway = False
) -> None:
    """Simulate a model: MODEL-results.h5 beside the model file, unless given."""
    if anyway and not resume:
        raise typer.BadParameter("--anyway goes with --continue")
    start = perf_counter()
    from ... import solver, superelement
    from ..run_report import report

    target = output or results_of(model_file)
    # Once steps are made, `simulate` says itself what an interrupt leaves.
    unbegun = unwritten(target, "before the first step")
    with errors_in_one_line(solver, superelement), unbegun:
        model = solver.read_model(model_file)
        results = solver.simulate(model, output=target, progress=True, resume=resume, force=anyway)
    for line in (*solver.given_moduli(model), *report(results)):
        typer.echo(one_line(line))
    steps, loop = int(results.solver["steps"]), float(results.solver["seconds"])
    speed = f", {1e6 * loop / steps:.1f} us per step" if steps else ""
    seconds = perf_counter() - start
    typer.echo(one_line(f"{target}: {steps} steps, {seconds:.2f} s in all{speed}"))
