"""The steps and quantities that a run records."""

from collections.abc import Iterable

from ...inputs.errors import did_you_mean
from ..errors import ModelError
from ..schema.entry import Entry, entry
from ..schema.values import Count, Words

ALWAYS_RECORDED = "solver"
ON_REQUEST = {"surface_nodes": ("nodes", "surface_contacts"), "body_modes": ("modes", "bodies")}
"""groups that are recorded where a key says so, this key, and the group of their owners"""


@entry(eq=True)
class OutputRequest(Entry):
    """The steps and quantities that a run records.

    Times and the iterations of Newton's method are always recorded. Energies and momenta are summed
    over every step, recorded or not.

    Parameters
    ----------
    every : int
        One step in so many, besides the first and the last.
    quantities : sequence of str, optional
        Groups of results, by default all: "bodies", "frames/beam.tip", "joints/pivot", "springs",
        "energy", "momentum".
    nodes : bool
        Of contacts of surfaces also the pressure, gap and displacement of every node, which are
        many numbers.
    modes : bool
        Of bodies whose surfaces are in contact also the coordinates of modes, which fields need.

    Examples
    --------
    >>> OutputRequest(every=10, quantities=["bodies"]).every
    10
    """

    label = "output"

    every: Count = 1
    quantities: Words | None = None
    nodes: bool = False
    modes: bool = False

    def selects(self, group: str) -> bool:
        """True for a group such as "frames/beam.tip" that is recorded.

        By its own name or by that of its kind, "frames"; nodes of contacts by those of the contact,
        and modes by those of the body.
        """
        kind, _, owner = group.partition("/")
        if kind in ON_REQUEST:
            key, group = ON_REQUEST[kind]
            return bool(getattr(self, key)) and self.selects(f"{group}/{owner}")
        return (
            group == ALWAYS_RECORDED
            or self.quantities is None
            or not {group, kind}.isdisjoint(self.quantities)
        )

    def check(self, groups: Iterable[str]) -> None:
        """`ModelError` for a quantity that is none of the groups, nor a kind of them."""
        known = sorted({*groups, *(group.partition("/")[0] for group in groups)})
        for name in self.quantities or ():
            if name not in known:
                # The list of groups of a large model is long: the nearest name is what a user looks
                # for.
                meant = did_you_mean(name, known)
                raise ModelError(
                    f"output: quantities: no {name!r}; there are: {', '.join(known)}{meant}"
                )
