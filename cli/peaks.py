"""A table of peaks."""

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from ..results import Peak

BEYOND = "*"
"""behind frequencies at which a spectrum is not to be trusted"""


def peaks_table(name: str, peaks: Sequence[Peak]) -> Table:
    """A row for each number; times in seconds, frequencies in hertz."""
    table = Table(title=Text(name), title_justify="left", box=None, pad_edge=False)
    for heading in ("quantity", "unit"):
        table.add_column(heading, overflow="fold")
    for heading in ("largest", "at", "smallest", "at"):
        table.add_column(heading, justify="right", no_wrap=True)
    for peak in peaks:
        table.add_row(
            Text(peak.quantity),
            Text(peak.unit),
            f"{peak.largest:.4g}",
            f"{peak.at_largest:.5g} {peak.base}{BEYOND if peak.is_beyond else ''}",
            f"{peak.smallest:.4g}",
            f"{peak.at_smallest:.5g} {peak.base}",
        )
    if beyond := [peak for peak in peaks if peak.is_beyond]:
        bands = ", ".join(f"{band:.4g} Hz" for band in sorted({peak.band for peak in beyond}))
        table.caption = f"{BEYOND} beyond the band of the superelement, {bands}"
        table.caption_justify = "left"
    return table


def places(peaks: Sequence[Peak]) -> list[str]:
    """A line for each peak whose place on a body is known."""
    return [f"{peak.quantity}: largest at {peak.place}" for peak in peaks if peak.place]
