"""`duhamel demo`."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter
from typing import Annotated, Literal

import typer

from ..failures import errors_in_one_line, one_line
from .schema import schema_of

DEMO_STARTER: Literal["mechanism"] = "mechanism"
DemoFolder = Annotated[Path, typer.Argument(metavar="FOLDER", help="A new or an empty one.")]
# Enough for an eye, and a quarter of what a film has by default.
FILM_FRAMES, FILM_SIZE = 60, (640, 360)


def demo(folder: DemoFolder = Path("duhamel-demo")) -> None:
    """A slider-crank with a flexible rod: from its mesh to a film and a report, in one go.

    The project is that of `duhamel init mechanism`, to be changed and run again.
    """
    from ... import files, preprocess, solver, superelement, view
    from .. import starters

    schemas = {name: schema_of(name) for name in ("body", "model")}
    with errors_in_one_line(files, starters, preprocess, solver, superelement, view):
        starters.make(DEMO_STARTER, folder, schemas)
        rod, results_file = folder / "rod.h5", folder / "model-results.h5"
        report = folder / "model-results.html"
        with _told(rod, "the superelement of the mesh"):
            superelement.write(preprocess.build(preprocess.read_body(folder / "rod.toml")), rod)
        with _told(results_file, "the motion"):
            model = solver.read_model(folder / "model.toml")
            results = solver.simulate(model, output=results_file)
        typer.echo(one_line(results.validity.summary))
        # Films and reports have libraries of their own, which a demonstration is no reason for.
        if find_spec("plotly") and find_spec("jinja2"):
            with _told(report, "a page for any browser"):
                view.write_report(results, report)
        if find_spec("pyvista") and find_spec("imageio"):
            with _told(film := folder / "film.mp4", "the film"):
                view.animate(results, film, frames=FILM_FRAMES, size=FILM_SIZE)
        else:
            typer.echo("for a film and a report: pip install 'duhamel[view,report]'")
    if report.exists():
        typer.echo(one_line(f"next: open {report} in a browser"))
    typer.echo(one_line(f"next: change {folder / 'model.toml'}, and `duhamel run` it"))


@contextmanager
def _told(path: Path, what: str) -> Iterator[None]:
    start = perf_counter()
    yield
    typer.echo(one_line(f"{path}: {what}, {perf_counter() - start:.1f} s"))
