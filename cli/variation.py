"""The picture of a study: outputs of its summary over its parameters."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from .. import view
from ..study import StudyError, read_summary
from ..superelement.validation import Array

# Of a summary; they are drawn where they are asked for alone.
RUN_NUMBERS = ("seconds", "steps", "iterations", "modes", "error")


def draw(summary_file: Path, asked: Sequence[str], target: Path, title: str | None) -> None:
    """Draw the outputs that are asked for, or all, over the parameters that vary."""
    summary = read_summary(summary_file)
    outputs = _chosen(summary.numbers, asked)
    heading = summary_file.parent.name if title is None else title
    figure = view.draw_variation(
        summary.parameters, outputs, heading, summary.units, summary.failed
    )
    view.save(figure, target)


def _chosen(numbers: Mapping[str, Array], asked: Sequence[str]) -> dict[str, Array]:
    if not asked:
        return {name: values for name, values in numbers.items() if name not in RUN_NUMBERS}
    for name in asked:
        if name not in numbers:
            raise StudyError(f"no output {name!r}; there are: {', '.join(numbers)}")
    return {name: numbers[name] for name in asked}
