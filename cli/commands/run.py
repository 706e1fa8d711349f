"""`duhamel run`."""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from time import perf_counter
from types import ModuleType
from typing import TYPE_CHECKING, Annotated

import typer

from ..arguments import ModelFile, output_option, results_of
from ..call import AsJson, give_record
from ..failures import errors_in_one_line, one_line, unwritten

if TYPE_CHECKING:
    from ...solver import Model

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


# Once steps are made, `simulate` says itself what an interrupt leaves.
BEFORE_STEPS = "before the first step"
LookOn = Annotated[
    bool,
    typer.Option(
        "--watch",
        help="Serve a page on this machine that shows the run while it goes on, and pauses or "
        "stops it.",
    ),
]


def run(
    model_file: ModelFile,
    output: Output = None,
    resume: Resume = False,
    anyway: Anyway = False,
    watch: LookOn = False,
    as_json: AsJson = False,
) -> None:
    """Simulate a model: MODEL-results.h5 beside the model file, unless given."""
    if anyway and not resume:
        raise typer.BadParameter("--anyway goes with --continue")
    start = perf_counter()
    from ... import solver, superelement
    from ..records import run_record
    from ..run_report import report

    target = output or results_of(model_file)
    with errors_in_one_line(solver, superelement, *_pages(watch)), unwritten(target, BEFORE_STEPS):
        model = solver.read_model(model_file)
        with _watched(model, target) if watch else nullcontext():
            results = solver.simulate(
                model, output=target, progress=True, resume=resume, force=anyway
            )
            for line in (*solver.given_moduli(model), *report(results)):
                typer.echo(one_line(line))
            steps, loop = int(results.solver["steps"]), float(results.solver["seconds"])
            speed = f", {1e6 * loop / steps:.1f} us per step" if steps else ""
            seconds = perf_counter() - start
            give_record(run_record(model_file, target, results, seconds))
            typer.echo(one_line(f"{target}: {steps} steps, {seconds:.2f} s in all{speed}"))


def _pages(watch: bool) -> list[ModuleType]:
    """The package of pages, if there is one to be made."""
    if not watch:
        return []
    from ... import view

    return [view]


@contextmanager
def _watched(model: "Model", target: Path) -> Iterator[None]:
    """Serve the page of the run of the block."""
    from ...solver.control import RUN_CONTROL, RunControl
    from ...view.live.server import watched

    def tell(address: str) -> None:
        typer.echo(f"watch the run: {address}", err=True)

    control = RunControl()
    title = Path(model.path).stem if model.path else target.stem
    token = RUN_CONTROL.set(control)
    try:
        with watched(control, target, title, model.settings.t_end, tell):
            yield
    finally:
        RUN_CONTROL.reset(token)
