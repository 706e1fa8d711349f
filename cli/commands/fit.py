"""`duhamel fit`."""

from pathlib import Path
from typing import Annotated

import typer

from ..arguments import ModelStudy, beside, output_option
from ..failures import errors_in_one_line, one_line

FittedModel = Annotated[
    Path | None, output_option("MODEL.toml", "The fitted model: STUDY-fitted.toml unless given.")
]


def fit(study_file: ModelStudy, output: FittedModel = None) -> None:
    """Fit the parameters of a study to the series that its table `fit` names.

    Prints their values, standard deviations and correlations, writes the model with these values,
    and beside it a picture of measured and fitted series and their residuals.
    """
    from rich.console import Console

    from ... import files, results, solver, study, superelement, view
    from ..fits import fit_picture, fit_table

    target = output or beside(study_file, ".toml", "fitted")
    picture = target.with_suffix(".png")
    with errors_in_one_line(files, results, solver, study, superelement, view):
        found = study.fit(study_file, target)
        Console().print(fit_table(study_file.stem, found))
        for one, rms, unit in zip(found.series, found.rms, found.units, strict=True):
            typer.echo(one_line(f"{one.quantity}: rms of the residuals {rms:.4g} {unit}"))
        for note in found.notes:
            typer.echo(one_line(note))
        view.save(fit_picture(study_file.stem, found), picture)
    typer.echo(one_line(f"{target}, {picture}: {found.runs} runs"))
