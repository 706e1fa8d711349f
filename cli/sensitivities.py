"""Derivatives of a study as tables, JSON and a picture."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..study import Sensitivities
from ..superelement.validation import Array
from ..view import draw_elasticities
from .tables import table

SENSITIVITY_COLUMNS = ("output", "value", "parameter", "derivative", "error", "elasticity")


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
    return [list(SENSITIVITY_COLUMNS), *(list(map(str, row)) for row in _cells(found))]


def sensitivity_record(found: Sensitivities) -> dict[str, Any]:
    """The derivatives as other programs take them."""
    rows = [dict(zip(SENSITIVITY_COLUMNS, cells, strict=True)) for cells in _cells(found)]
    rows = [{**row, "unit": found.units[str(row["output"])]} for row in rows]
    return {"sensitivities": rows, "notes": list(found.notes)}


def _cells(found: Sensitivities) -> Iterator[tuple[str | float, ...]]:
    for i, name in enumerate(found.outputs):
        for j, parameter in enumerate(found.parameters):
            numbers = found.derivative[i, j], found.error[i, j], found.elasticity[i, j]
            yield name, float(found.value[i]), parameter, *map(float, numbers)


def sensitivity_picture(title: str, found: Sensitivities) -> Any:
    with np.errstate(divide="ignore", invalid="ignore"):
        errors: Array = np.abs(found.elasticity * found.error / found.derivative)
    return draw_elasticities(
        list(found.parameters), list(found.outputs), found.elasticity, errors, title
    )
