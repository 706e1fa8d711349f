"""A table of peaks."""

from collections.abc import Sequence

from rich.table import Table

from ..results import Peak
from .tables import table

# Behind frequencies at which a spectrum is not to be trusted.
BEYOND_BAND_SIGN = "*"


def peaks_table(name: str, peaks: Sequence[Peak]) -> Table:
    """A row for each number; times in seconds, frequencies in hertz."""
    rows = (
        (
            peak.quantity,
            peak.unit,
            f"{peak.largest:.4g}",
            f"{peak.at_largest:.5g} {peak.base}{BEYOND_BAND_SIGN if peak.is_beyond else ''}",
            f"{peak.smallest:.4g}",
            f"{peak.at_smallest:.5g} {peak.base}",
        )
        for peak in peaks
    )
    headings = ("quantity", "unit", "largest", "at", "smallest", "at")
    made = table(name, headings, rows, "ttnnnn")
    made.title_justify, made.box, made.pad_edge = "left", None, False
    if beyond := [peak for peak in peaks if peak.is_beyond]:
        bands = ", ".join(f"{band:.4g} Hz" for band in sorted({peak.band for peak in beyond}))
        made.caption = f"{BEYOND_BAND_SIGN} beyond the band of the superelement, {bands}"
        made.caption_justify = "left"
    return made


def places(peaks: Sequence[Peak]) -> list[str]:
    """A line for each peak whose place on a body is known."""
    return [f"{peak.quantity}: largest at {peak.place}" for peak in peaks if peak.place]
