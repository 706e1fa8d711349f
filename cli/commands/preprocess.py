"""`duhamel preprocess`."""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from ..arguments import TOML_SUFFIX, beside, file_argument, output_option
from ..failures import errors_in_one_line, one_line, unwritten

if TYPE_CHECKING:
    from ...preprocess import MeasuredBody
    from ...superelement import Superelement

BodyFile = Annotated[
    Path, file_argument("BODY.toml", "Mesh, section or material, interfaces.", TOML_SUFFIX)
]
SuperelementOrPicture = Annotated[
    Path | None, output_option("FILE", "The superelement, or the picture.")
]
DryRun = Annotated[
    bool,
    typer.Option(
        "--dry-run",
        help="Only report on the mesh and the cost, or on a test, and draw it: BODY.png beside the "
        "body file; of a test also a page, by -o FILE.html.",
    ),
]
Processes = Annotated[
    int | None,
    typer.Option(
        "--mpi",
        metavar="N",
        min=1,
        help="Spread the mesh over N processes, by MPI and PETSc: for millions of unknowns.",
    ),
]


def preprocess(
    body_file: BodyFile,
    output: SuperelementOrPicture = None,
    dry_run: DryRun = False,
    mpi: Processes = None,
) -> None:
    """Turn a mesh into a superelement: BODY.h5 beside the body file, unless given."""
    if dry_run and mpi is not None:
        raise typer.BadParameter("--mpi goes without --dry-run")
    from ... import preprocess
    from ..spread import run_spread, spread_build

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
    from ... import files, preprocess, superelement
    from ...cad import is_cad
    from ..description import loss_in_words, measured_pairs

    target = output or beside(body_file, ".h5")
    with errors_in_one_line(files, preprocess, superelement):
        body = preprocess.read_body(body_file)
        # Before hours of work, not after them.
        superelement.require_writable(target)
        files.require_no_input(target, [body_file, *preprocess.files_of(body)])

    def tell(doubt: str) -> None:
        """At once: a wrong unit makes the build long, and its error another one."""
        typer.echo(one_line(f"warning: {body_file}: {doubt}"), err=True)

    for doubt in preprocess.doubts_of_body(body):
        tell(doubt)
    with errors_in_one_line(preprocess, superelement, about=body_file), unwritten(target):
        element = build(body, progress=True, on_warning=tell)
    with errors_in_one_line(superelement):
        superelement.write(element, target)
    if element.modes is not None and element.modes.chain is not None:
        typer.echo(one_line(f"loss factor: {loss_in_words(element.modes, element.modes.chain)}"))
    # Pair by pair: an assignment that is wrong is seen here, or in measurements of the machine.
    if element.measured is not None:
        for frequency, pair in measured_pairs(element.measured):
            typer.echo(one_line(f"measured: {frequency.strip()}, {pair}"))
    if isinstance(body, preprocess.MeasuredBody):
        typer.echo(one_line(element.provenance.method))
        undamped = False
    else:
        undamped = not (body.damping.model_fields_set or any(body.loss_factors.values()))
        if any(map(is_cad, body.files)):
            typer.echo(one_line(f"mesh: {element.provenance.mesh}"))
    if undamped and element.measured is None:
        typer.echo(
            "note: the body file has no [damping], so what vibrates rings on for ever: give a "
            "loss_factor, as 0.02, and its band"
        )
    megabytes = target.stat().st_size / 1e6
    seconds = perf_counter() - start
    if body.impulse.modes is not None:
        kernel, method = element.kernel, element.provenance.method
        typer.echo(f"{method}: error {kernel.error:.2g} up to {kernel.band:.5g} Hz")
    typer.echo(one_line(f"{target}: {element.n_c} dofs, {megabytes:.3g} MB, {seconds:.2f} s"))


def _survey(body_file: Path, output: Path | None) -> None:
    from rich.console import Console

    from ... import files, preprocess, view
    from ...preprocess.survey import survey
    from ..survey import features_to_copy, report, scene

    target = output or beside(body_file, ".png")
    with errors_in_one_line(files, preprocess, view):
        body = preprocess.read_body(body_file)
        files.require_no_input(target, [body_file, *preprocess.files_of(body)])
    if isinstance(body, preprocess.MeasuredBody):
        _survey_test(body, body_file, target)
        return
    with errors_in_one_line(preprocess, about=body_file):
        surveyed = survey(body, progress=True)
    with errors_in_one_line(view):
        view.save(view.draw_scene(scene(surveyed)), target)
    Console().print(report(surveyed))
    for line in features_to_copy(surveyed):
        typer.echo(one_line(line))
    typer.echo(one_line(target))


def _survey_test(body: "MeasuredBody", body_file: Path, target: Path) -> None:
    from rich.console import Console

    from ... import preprocess, view
    from ...files import renamed_when_whole
    from ...preprocess.measured.part import identified
    from ...preprocess.progress import shown_stages
    from ..part_test import page_of_test, picture, report

    with errors_in_one_line(preprocess, about=body_file), shown_stages(True) as stages:
        part = identified(body, stages)
    told = report(part)
    with errors_in_one_line(view):
        # The suffix says what is made of a test, as of results.
        if target.suffix.lower() == ".html":
            with renamed_when_whole(target, failure=view.PictureError) as temporary:
                temporary.write_text(page_of_test(part, told), encoding="utf-8")
        else:
            view.save(view.draw_fit(picture(part)), target)
    Console().print(told)
    typer.echo(one_line(target))
