"""The summary of a study: a row a case."""

import csv
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..files import renamed_when_whole
from .case import Case
from .study_file import Study


@dataclass(frozen=True)
class Row:
    """A case in the summary.

    status: "done", "failed", or "open" where the study was stopped before it.
    """

    case: Case
    status: str = "open"
    numbers: dict[str, float] = field(default_factory=dict)
    message: str = ""
    warnings: tuple[str, ...] = ()


def write_summary(path: Path, study: Study, rows: Sequence[Row]) -> None:
    """Write the summary, a table of comma-separated values.

    Columns: case, parameters, status, numbers and outputs in SI units, message.
    """
    parameters = list(study.cases[0].parameters)
    numbers = [*study.kind.columns, *study.outputs]
    with (
        renamed_when_whole(path) as temporary,
        temporary.open("w", encoding="utf-8", newline="") as file,
    ):
        table = csv.writer(file)
        table.writerow(["case", *parameters, "status", *numbers, "message"])
        for row in rows:
            cells = [_cell(row.case.parameters[key]) for key in parameters]
            table.writerow(
                [
                    row.case.name,
                    *cells,
                    row.status,
                    *[row.numbers.get(n, "") for n in numbers],
                    row.message,
                ]
            )


def _cell(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, list | dict | bool) else value
