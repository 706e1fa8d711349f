"""What the rows of validity tables mean."""

from collections.abc import Mapping
from difflib import get_close_matches

from ..results.criteria import CRITERIA, Criterion
from ..solver.linear.validity import LINEAR_CRITERIA

ALL_CRITERIA: Mapping[str, Criterion] = {**CRITERIA, **LINEAR_CRITERIA}
"""the criteria of runs and of linear analyses, by name"""


def criteria_named(words: str) -> list[Criterion]:
    """The criterion of a name, or those whose row of a table has some words; none if none has."""
    if words in ALL_CRITERIA:
        return [ALL_CRITERIA[words]]
    return [
        criterion
        for criterion in ALL_CRITERIA.values()
        if words.lower() in criterion.quantity.lower()
    ]


def similar_names(words: str) -> list[str]:
    """Names like some words."""
    # Names of criteria have underscores, which nobody types who reads them in a table.
    return get_close_matches(words.replace(" ", "_"), ALL_CRITERIA, n=3, cutoff=0.5)


def criteria_overview() -> list[str]:
    """A line for each criterion."""
    width = max(map(len, ALL_CRITERIA))
    return [f"{name:{width}}  {criterion.quantity}" for name, criterion in ALL_CRITERIA.items()]
