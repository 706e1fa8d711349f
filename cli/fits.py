"""Fits of a study as a table and a picture."""

from typing import Any

from ..study import ModelFit
from ..view import SeriesFit, draw_series_fit
from .tables import table


def fit_table(title: str, found: ModelFit) -> Any:
    """The parameters by number, their standard deviations, and the correlations between them."""
    n = len(found.parameters) - 1
    rows = [
        (
            *(f"{i + 1}", one.name, f"{one.start:.6g}", f"{one.value:.8g}"),
            f"{one.deviation:.2g}",
            *(f"{found.correlation[i, j]:.2f}" if j < i else "" for j in range(n)),
        )
        for i, one in enumerate(found.parameters)
    ]
    headings = ("", "parameter", "start", "fitted", "deviation")
    correlations = (f"with {j + 1}" for j in range(n))
    return table(title, (*headings, *correlations), rows, "ntnnn" + n * "n")


def fit_picture(title: str, found: ModelFit) -> Any:
    return draw_series_fit(
        [
            SeriesFit(one.quantity, one.time, one.values, fitted, unit, one.sigma)
            for one, fitted, unit in zip(found.series, found.fitted, found.units, strict=True)
        ],
        title,
    )
