"""The steps and quantities that a run records."""

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

from ..errors import ModelError

ALWAYS = "solver"


@dataclass(frozen=True)
class OutputRequest:
    """The steps and quantities that a run records.

    every: one step in so many, besides the first and the last; quantities: by default all. They
    are groups of results: "bodies", "frames/beam.tip", "joints/pivot", "springs", "energy",
    "momentum". Times and the iterations of Newton's method are recorded always.
    Energies and momenta are summed over every step, recorded or not.
    """

    every: int = 1
    quantities: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        if self.every < 1:
            raise ModelError(f"output: every: expected 1 or more, got {self.every}")
        if self.quantities is not None:
            object.__setattr__(self, "quantities", tuple(self.quantities))

    def selects(self, group: str) -> bool:
        """Whether "frames/beam.tip" and the like is recorded: by its own name or by that of its
        kind.
        """
        return (
            group == ALWAYS
            or self.quantities is None
            or not {group, group.partition("/")[0]}.isdisjoint(self.quantities)
        )

    def check(self, groups: Iterable[str]) -> None:
        """`ModelError` for a quantity that is none of the groups, nor a kind of them."""
        known = sorted({*groups, *(group.partition("/")[0] for group in groups)})
        for name in self.quantities or ():
            if name not in known:
                near = get_close_matches(name, known, n=1)
                meant = f"; did you mean {near[0]!r}?" if near else ""
                raise ModelError(
                    f"output: quantities: no {name!r}; there are: {', '.join(known)}{meant}"
                )
