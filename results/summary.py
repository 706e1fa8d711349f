"""Results in a few rows, for notebooks."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..files.arrays import Array
from ..files.html import Row, listed
from .validity import Validity


def rows(
    time: Array,
    notes: Mapping[str, Any],
    recorded: tuple[str, ...],
    validity: Validity,
    never_closed: Sequence[str],
) -> Iterator[Row]:
    """Duration, steps, how far it is to be trusted, and what was recorded."""
    yield "time", spanned(time)
    steps = notes.get("steps")
    yield "steps", ("" if steps is None else f"{steps}, ") + f"{len(time)} rows recorded"
    if not notes.get("finished", True):
        yield "end", "not reached: the run was interrupted, failed, or is still going on"
    if "seconds" in notes:
        yield "computed in", f"{float(notes['seconds']):.3g} s"
    yield "validity", "\n".join(_validity(validity))
    if never_closed:
        yield "never closed", listed(never_closed)
    for kind, names in _groups(recorded).items():
        yield kind, listed(names)


def spanned(time: Array) -> str:
    return f"{time[0]:.6g} to {time[-1]:.6g} s" if len(time) else "nothing recorded"


def _validity(validity: Validity) -> Iterator[str]:
    """A summary, and the worst of each criterion beyond its limit."""
    yield validity.summary
    for check in validity.worst:
        if check.verdict == "poor":
            yield f"{check.sentence}, limit {check.criterion.bound(check.criterion.limit)}"


def _groups(recorded: tuple[str, ...]) -> dict[str, list[str]]:
    """What was recorded, by its kind."""
    groups: dict[str, list[str]] = {}
    for group in recorded:
        kind, _, name = group.partition("/")
        groups.setdefault(kind, []).extend([name] if name else ["yes"])
    return groups
