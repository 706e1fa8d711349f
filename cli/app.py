"""The subcommands, one function each.

Each imports its packages when called, so that `duhamel run` starts fast.
"""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from . import animation, html_report, linear, projects
from . import plot as plotting
from .arguments import HDF5, TOML, ModelFile, ResultsFile
from .completion import files as files_of
from .export import export
from .failures import Commands, errors_in_one_line, one_line, unwritten

if TYPE_CHECKING:
    from ..superelement import Superelement

app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)

BodyFile = Annotated[
    Path,
    typer.Argument(
        metavar="BODY.toml",
        help="Mesh, section or material, interfaces.",
        autocompletion=files_of(TOML),
    ),
]
SuperelementFile = Annotated[
    Path,
    typer.Argument(metavar="FILE.h5", help="A superelement.", autocompletion=files_of(*HDF5)),
]
CheckedFile = Annotated[
    Path,
    typer.Argument(
        metavar="FILE",
        help="A superelement or a model, by its suffix.",
        show_default=False,
        autocompletion=files_of(*HDF5, TOML),
    ),
]
CheckedBody = Annotated[
    Path | None,
    typer.Option(
        "--body",
        metavar="BODY.toml",
        help="The body file of a superelement, whose mesh its static solution is compared with.",
        show_default=False,
        autocompletion=files_of(TOML),
    ),
]
Quantities = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="QUANTITY", help="As acceleration:hub:z, or 'acceleration:*'.", show_default=False
    ),
]
Output = Annotated[
    Path | None, typer.Option("--output", "-o", metavar="FILE.h5", show_default=False)
]
PreprocessOutput = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="FILE",
        help="The superelement, or the picture.",
        show_default=False,
    ),
]
DryRun = Annotated[
    bool,
    typer.Option(
        "--dry-run",
        help="Only report on the mesh and the cost, and draw it: BODY.png beside the body file.",
    ),
]
Processes = Annotated[
    int | None,
    typer.Option(
        "--mpi",
        metavar="N",
        min=1,
        help="Spread the mesh over N processes, by MPI and PETSc: for millions of unknowns.",
        show_default=False,
    ),
]
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
StudyFile = Annotated[
    Path,
    typer.Argument(
        metavar="STUDY.toml",
        help="A model or body, and values of its parameters.",
        autocompletion=files_of(TOML),
    ),
]
StudyFolder = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="FOLDER",
        help="The cases: STUDY beside the study file.",
        show_default=False,
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(
        min=0,
        help="Processes on this machine, as many as cores unless given; 0: none but this one.",
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(metavar="tcp://HOST:PORT", help="Of a Dask cluster that sees the same files."),
]
Plotted = Annotated[
    bool, typer.Option("--plot", help="Also draw the outputs over the parameters: summary.png.")
]
Force = Annotated[bool, typer.Option("--force", help="Also the cases that are up to date.")]
Gravities = Annotated[bool, typer.Option("--g", help="Accelerations in g = 9.80665 m/s².")]


def _tell_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"duhamel {version('duhamel')}")
        raise typer.Exit


Version = Annotated[
    bool,
    typer.Option(
        "--version", callback=_tell_version, is_eager=True, help="Print the version and exit."
    ),
]


@app.callback()
def duhamel(version: Version = False) -> None:
    """Impulse superelements from meshes, and multibody dynamics on them."""


@app.command()
def preprocess(
    body_file: BodyFile,
    output: PreprocessOutput = None,
    dry_run: DryRun = False,
    mpi: Processes = None,
) -> None:
    """Turn a mesh into a superelement: BODY.h5 beside the body file, unless given."""
    if dry_run and mpi is not None:
        raise typer.BadParameter("--mpi goes without --dry-run")
    from .. import preprocess
    from .spread import run_spread, spread_build

    if dry_run:
        _survey(body_file, output)
    elif mpi is not None:
        with errors_in_one_line(preprocess):
            run_spread(mpi, body_file, output)
    else:
        with errors_in_one_line(preprocess, about=body_file):
            build = spread_build()
        if build is not None:
            _preprocess(body_file, output, build)


def _preprocess(body_file: Path, output: Path | None, build: "Callable[..., Superelement]") -> None:
    start = perf_counter()
    from .. import files, preprocess, superelement
    from .description import loss_in_words

    target = output or body_file.with_suffix(".h5")
    with errors_in_one_line(files, preprocess, superelement):
        body = preprocess.read_body(body_file)
        superelement.require_writable(target)
        files.require_no_input(target, [body_file, *preprocess.files_of(body)])
    doubts = list(preprocess.doubts_of_body(body))
    with errors_in_one_line(preprocess, superelement, about=body_file), unwritten(target):
        element = build(body, progress=True, told=doubts.append)
    for doubt in doubts:
        typer.echo(one_line(f"warning: {body_file}: {doubt}"), err=True)
    with errors_in_one_line(superelement):
        superelement.write(element, target)
    if element.modes is not None and element.modes.chain is not None:
        typer.echo(one_line(f"loss factor: {loss_in_words(element.modes, element.modes.chain)}"))
    megabytes = target.stat().st_size / 1e6
    seconds = perf_counter() - start
    if body.impulse.modes is not None:
        kernel, method = element.kernel, element.provenance.method
        typer.echo(f"{method}: error {kernel.error:.2g} up to {kernel.band:.5g} Hz")
    typer.echo(one_line(f"{target}: {element.n_c} dofs, {megabytes:.3g} MB, {seconds:.2f} s"))


def _survey(body_file: Path, output: Path | None) -> None:
    from rich.console import Console

    from .. import files, preprocess, view
    from ..preprocess.survey import survey
    from .survey import report, scene

    target = output or body_file.with_suffix(".png")
    with errors_in_one_line(files, preprocess, view):
        body = preprocess.read_body(body_file)
        files.require_no_input(target, [body_file, *preprocess.files_of(body)])
    with errors_in_one_line(preprocess, about=body_file):
        surveyed = survey(body, progress=True)
    with errors_in_one_line(view):
        view.save(view.draw_scene(scene(surveyed)), target)
    Console().print(report(surveyed))
    typer.echo(one_line(target))


@app.command()
def run(
    model_file: ModelFile, output: Output = None, resume: Resume = False, anyway: Anyway = False
) -> None:
    """Simulate a model: MODEL-results.h5 beside the model file, unless given."""
    if anyway and not resume:
        raise typer.BadParameter("--anyway goes with --continue")
    start = perf_counter()
    from .. import solver, superelement
    from .run_report import report

    target = output or _results_of(model_file)
    unbegun = unwritten(target, "before the first step")
    with errors_in_one_line(solver, superelement), unbegun:
        model = solver.read_model(model_file)
        results = solver.simulate(model, output=target, progress=True, resume=resume, anyway=anyway)
    for line in (*solver.given_moduli(model), *report(results)):
        typer.echo(one_line(line))
    steps, loop = int(results.solver["steps"]), float(results.solver["seconds"])
    speed = f", {1e6 * loop / steps:.1f} us per step" if steps else ""
    seconds = perf_counter() - start
    typer.echo(one_line(f"{target}: {steps} steps, {seconds:.2f} s in all{speed}"))


@app.command()
def sweep(
    study_file: StudyFile,
    output: StudyFolder = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    force: Force = False,
    plot: Plotted = False,
) -> None:
    """Run a model, or preprocess a body, for many values of its parameters.

    Each case is a file of its own, with what was made of it beside it; summary.csv has a row for
    each. A second call makes only what is missing, failed, or was made from other inputs.
    """
    if scheduler is not None and workers is not None:
        raise typer.BadParameter(
            "a scheduler brings its own workers: expected one of --workers and --scheduler"
        )
    start = perf_counter()
    from .. import study
    from .sweep import failures, shown_cases, tell_size, told

    with errors_in_one_line(study):
        plan = study.read_study(study_file, output)
    with errors_in_one_line(study), shown_cases(len(plan.cases)) as finished:
        rows = study.sweep(plan, workers, scheduler, force, finished, tell_size(plan.folder))
    failed = list(failures(rows))
    for line in failed:
        typer.echo(one_line(line), err=True)
    seconds = perf_counter() - start
    typer.echo(one_line(f"{plan.summary}: {len(rows)} cases, {told(rows)}, {seconds:.1f} s"))
    if plot:
        plotting.plot_summary(plan.summary, [], None, None)
    if failed:
        raise typer.Exit(1)


@app.command()
def peaks(
    results_file: ResultsFile, quantities: Quantities = None, gravities: Gravities = False
) -> None:
    """Tell the largest and smallest values of quantities, when they occur, and where.

    Without arguments: of all accelerations, forces and elastic displacements that were recorded. A
    star in a name stands for anything: 'acceleration:bracket.*:z'. The largest one comes first.
    von_mises:BODY is the largest stress on the surface of a body, with its place.
    """
    from rich.console import Console

    from .. import results
    from .peaks import peaks_table, places

    with errors_in_one_line(results):
        read = results.Results.read(results_file)
        found = results.peaks(read, quantities or (), gravities)
    Console().print(peaks_table(results_file.stem, found))
    for place in places(found):
        typer.echo(one_line(place))


@app.command()
def explain(
    criterion: Annotated[
        str | None,
        typer.Argument(help="A name, axial_load, or words of a table's row, 'axial force'."),
    ] = None,
) -> None:
    """Explain a row of the validity table: what it measures, its limits, and what to do.

    Without a name: all criteria, of runs and of linear analyses, in a line each.
    """
    from .explain import criteria_named, criteria_overview, similar_names

    if criterion is None:
        typer.echo("\n".join(criteria_overview()))
        return
    found = criteria_named(criterion)
    if not found:
        like = similar_names(criterion)
        meant = f"did you mean {' or '.join(like)}?" if like else "duhamel explain lists all"
        typer.echo(one_line(f"error: no criterion {criterion!r}: {meant}"), err=True)
        raise typer.Exit(1)
    typer.echo("\n\n".join(one.explanation for one in found))


@app.command()
def info(file: SuperelementFile) -> None:
    """Show what a superelement holds."""
    from rich.console import Console

    from .. import superelement
    from .description import describe

    with errors_in_one_line(superelement):
        element = superelement.read(file)
    Console().print(describe(element))


@app.command()
def check(file: CheckedFile, body: CheckedBody = None) -> None:
    """Recompute what must hold of a file, and say whether it does; exit with 1 if not.

    The suffix says what the file is: FILE.h5 a superelement, FILE.toml a model. The static
    compliance of a superelement is compared with a static solution of its mesh, where that lies
    beside it. A model is not run: what `run` would refuse is refused, and what it would take is
    told.
    """
    if file.suffix.lower() in HDF5:
        _check_superelement(file, body)
    elif file.suffix.lower() == TOML:
        _check_model(file)
    else:
        raise typer.BadParameter(
            f"{file}: expected a superelement, {' or '.join(HDF5)}, or a model, {TOML}"
        )


def _check_model(file: Path) -> None:
    from .. import solver, superelement

    with errors_in_one_line(solver, superelement):
        checked = solver.check(solver.read_model(file), _results_of(file))
    for line in checked.lines():
        typer.echo(one_line(line))
    for warning in checked.warnings:
        typer.echo(one_line(f"warning: {file}: {warning}"), err=True)


def _results_of(model_file: Path) -> Path:
    """The results file of a model unless another is given."""
    return model_file.parent / f"{model_file.stem}-results.h5"


def _check_superelement(file: Path, body_file: Path | None) -> None:
    from rich.console import Console

    from .. import preprocess, superelement
    from .checked import checks_table, failures

    with errors_in_one_line(superelement):
        element = superelement.read(file)
    checks = list(superelement.check(element))
    with errors_in_one_line(preprocess):
        if body_file is None:
            body = preprocess.body_of(element, file.parent)
        else:
            body = preprocess.read_body(body_file)
        if body is not None:
            checks.append(preprocess.static_check(element, body))
    Console().print(checks_table(element.name, checks))
    failed = failures(checks)
    for line in failed:
        typer.echo(one_line(f"error: {file}: {line}"), err=True)
    if failed:
        raise typer.Exit(1)
    if body is None:
        typer.echo(
            one_line(
                f"{file}: not compared with its mesh, which is not beside it as it was: give the "
                "body file with --body"
            )
        )
    typer.echo(one_line(f"{file}: {len(checks)} checks hold"))


for command in (
    plotting.plot,
    html_report.report,
    animation.animate,
    export,
    linear.modes,
    linear.frf,
    linear.campbell,
    projects.init,
    projects.schema,
):
    app.command()(command)
