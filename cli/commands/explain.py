"""`duhamel explain`."""

from typing import Annotated

import typer

from ..failures import one_line


def explain(
    criterion: Annotated[
        str | None,
        typer.Argument(help="A name, axial_load, or words of a table's row, 'axial force'."),
    ] = None,
) -> None:
    """Explain a row of the validity table: what it measures, its limits, and what to do.

    Without a name: all criteria, of runs and of linear analyses, in a line each.
    """
    from ..explain import criteria_named, criteria_overview, similar_names

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
