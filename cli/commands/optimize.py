"""`duhamel optimize`."""

from pathlib import Path
from typing import Annotated

import typer

from ..arguments import ModelStudy, beside, output_option
from ..call import AsJson, give_record
from ..failures import errors_in_one_line, one_line

OptimizedModel = Annotated[
    Path | None,
    output_option("MODEL.toml", "The optimized model: STUDY-optimized.toml unless given."),
]


def optimize(
    study_file: ModelStudy, output: OptimizedModel = None, as_json: AsJson = False
) -> None:
    """Optimize the parameters of a study, as its table `optimize` asks for.

    Prints what changed, limits with their multipliers, and why the search ended. Writes the model
    with the best values, and beside it a picture of the search. Exits with 1 where no optimum was
    found.
    """
    from rich.console import Console

    from ... import files, results, solver, study, superelement, view
    from ..optimizations import goal_table, optimum_picture, parameter_table
    from ..records import optimum_record

    target = output or beside(study_file, ".toml", "optimized")
    picture = target.with_suffix(".png")
    with errors_in_one_line(files, results, solver, study, superelement, view):
        found = study.optimize(study_file, target)
        give_record(optimum_record(found))
        Console().print(parameter_table(study_file.stem, found))
        Console().print(goal_table(found))
        for note in found.notes:
            typer.echo(one_line(note))
        view.save(optimum_picture(study_file.stem, found), picture)
    typer.echo(one_line(f"{target}, {picture}: {found.runs} runs"))
    # The best point is written all the same.
    if not found.converged:
        raise typer.Exit(1)
