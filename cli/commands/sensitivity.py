"""`duhamel sensitivity`."""

import typer

from ..arguments import ModelStudy, beside
from ..call import AsJson, give_record
from ..failures import errors_in_one_line, one_line
from ..linear import LinearOutput


def sensitivity(
    study_file: ModelStudy, output: LinearOutput = None, as_json: AsJson = False
) -> None:
    """Derivatives of the outputs of a study by its parameters, with their errors.

    Also the elasticity, the per cent of an output for one per cent of a parameter. Without -o the
    picture is STUDY-sensitivity.png beside the study file.
    """
    from rich.console import Console

    from ... import files, results, solver, study, superelement, view
    from ..records import sensitivity_record
    from ..sensitivities import sensitivity_picture, sensitivity_rows, sensitivity_table

    target = output or beside(study_file, ".png", "sensitivity")
    with errors_in_one_line(files, results, solver, study, superelement, view):
        files.require_no_input(target, [study_file], "the study file")
        found = study.sensitivities_of(study_file)
        give_record(sensitivity_record(found))
        Console().print(sensitivity_table(study_file.stem, found))
        for note in found.notes:
            typer.echo(one_line(note))
        if as_json and output is None:
            return
        if target.suffix.lower() == ".csv":
            files.write_rows(target, sensitivity_rows(found), view.PictureError)
        else:
            view.save(sensitivity_picture(study_file.stem, found), target)
        typer.echo(one_line(target))
