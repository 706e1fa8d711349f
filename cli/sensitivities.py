"""Derivatives of a study as tables, JSON and a picture."""

from typing import Any

import numpy as np

from ..study import Sensitivities
from ..superelement.validation import Array
from ..view import draw_elasticities
from .records import SENSITIVITY_COLUMNS, sensitivity_cells
from .tables import table


def sensitivity_table(title: str, found: Sensitivities) -> Any:
    """The derivatives, a row for each output and parameter."""
    rows = list[tuple[str, ...]]()
    for i, (name, unit) in enumerate(found.units.items()):
        value = f"{found.value[i]:.6g} {unit}".rstrip()
        for j, parameter in enumerate(found.parameters):
            slope, error = found.derivative[i, j], found.error[i, j]
            numbers = f"{slope:.6g}", f"{error:.1e}", f"{found.elasticity[i, j]:.4g}"
            # The output once, above the parameters that it follows.
            rows.append((name if not j else "", value if not j else "", parameter, *numbers))
    return table(title, SENSITIVITY_COLUMNS, rows, "tntnnn")


def sensitivity_rows(found: Sensitivities) -> list[list[str]]:
    """The derivatives as rows of a table in a file, all digits kept."""
    return [list(SENSITIVITY_COLUMNS), *(list(map(str, row)) for row in sensitivity_cells(found))]


def sensitivity_picture(title: str, found: Sensitivities) -> Any:
    with np.errstate(divide="ignore", invalid="ignore"):
        errors: Array = np.abs(found.elasticity * found.error / found.derivative)
    return draw_elasticities(
        list(found.parameters), list(found.outputs), found.elasticity, errors, title
    )
