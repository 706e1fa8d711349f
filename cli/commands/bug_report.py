"""`duhamel bug-report`: what a report of a defect needs to be understood."""

from pathlib import Path
from typing import Annotated

import typer

from ..arguments import TOML_SUFFIX, file_argument, output_option
from ..failures import errors_in_one_line, one_line

ReportedModel = Annotated[
    Path | None,
    file_argument("MODEL.toml", "The model that fails: its digest is told.", TOML_SUFFIX),
]
ReportFile = Annotated[Path, output_option("FILE.txt")]


def bug_report(
    model_file: ReportedModel = None, output: ReportFile = Path("duhamel-bug-report.txt")
) -> None:
    """Write a text file about this installation and its last failure, to attach to a report.

    It has versions, the machine, the compiled code, digests of the model and its superelements, and
    the last error of a command. Folders and names of users and machines are taken out of it. Names
    in your files and values that a message quotes stay: read it before you send it. Nothing is sent
    by Duhamel.
    """
    from ... import files
    from ..installation import report

    with errors_in_one_line(files):
        if model_file is not None:
            files.require_no_input(output, [model_file], "the model file")
            files.require_regular(model_file)
        text = report(model_file)
        with files.renamed_when_whole(output, failure=files.FileError) as whole:
            whole.write_text(text, encoding="utf-8")
    typer.echo(one_line(f"{output}: read it, then attach it to your report"))
