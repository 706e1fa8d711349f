"""`duhamel peaks`."""

from typing import Annotated

import typer

from ..arguments import Gravities, ResultsFile
from ..call import AsJson, give_record
from ..failures import errors_in_one_line, one_line

Quantities = Annotated[
    list[str] | None,
    typer.Argument(metavar="QUANTITY", help="As acceleration:hub:z, or 'acceleration:*'."),
]


def peaks(
    results_file: ResultsFile,
    quantities: Quantities = None,
    gravities: Gravities = False,
    as_json: AsJson = False,
) -> None:
    """Tell the largest and smallest values of quantities, when they occur, and where.

    Without arguments: of all accelerations, forces and elastic displacements that were recorded. A
    star in a name stands for anything: 'acceleration:bracket.*:z'. The largest one comes first.
    von_mises:BODY is the largest stress on the surface of a body, with its place.
    """
    from rich.console import Console

    from ... import results
    from ..peaks import peaks_table, places
    from ..records import peaks_record

    with errors_in_one_line(results):
        read = results.Results.read(results_file)
        found = results.peaks(read, quantities or (), gravities)
    give_record(peaks_record(results_file, found))
    Console().print(peaks_table(results_file.stem, found))
    for place in places(found):
        typer.echo(one_line(place))
