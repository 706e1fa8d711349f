"""`duhamel radiation`."""

from typing import Annotated

import typer

from ..arguments import ResultsFile
from ..failures import errors_in_one_line

RadiatingBody = Annotated[
    str, typer.Argument(metavar="BODY", help="A flexible body with recovered fields.")
]
SurfaceName = Annotated[
    str, typer.Option("--surface", metavar="NAME", help="One of its surfaces; all unless given.")
]
Rigid = Annotated[
    bool, typer.Option("--rigid", help="The motion of the whole body radiates too, as on mounts.")
]
BandFraction = Annotated[
    int, typer.Option("--fraction", metavar="B", help="Bands of 1/B of an octave: 1, 2, 3, 6, ...")
]


def radiation(
    results_file: ResultsFile,
    body: RadiatingBody,
    surface: SurfaceName = "",
    rigid: Rigid = False,
    fraction: BandFraction = 3,
) -> None:
    """Tell the equivalent radiated sound power of a body, as a whole and by octave bands.

    rho c times the integral of the squared normal velocity over the surface, in air: an upper
    estimate of what is radiated. Levels are in dB relative to 1 pW.
    """
    from rich.console import Console

    from ... import results
    from ...results.radiation import decibels, radiated_power
    from ..tables import table

    with errors_in_one_line(results):
        read = results.Results.read(results_file)
        found = radiated_power(read, body, surface, rigid=rigid)
        bands = found.bands(fraction)
    named = f"{body}.{surface}" if surface else body
    rows = [("all", f"{found.mean:.4g}", f"{found.level:.1f}")]
    levels = decibels(bands.values)
    rows += [
        (f"{center:.4g}", f"{power:.4g}", f"{level:.1f}")
        for center, power, level in zip(bands.center, bands.values, levels, strict=True)
    ]
    title = f"{results_file.stem}: {named}, {found.area:.4g} m²"
    Console().print(table(title, ("band [Hz]", "power [W]", "level [dB]"), rows, "nnn"))
