"""What is covered by derivatives of runs, and where a run may have kinks."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..errors import DerivativeError, ForeignError
from ..laws.maxwell import MaxwellLaw
from ..laws.user import UserLaw
from ..lower.lower import LoweredModel
from ..step.shapes import Plane, Sphere

SHAPE_ERROR, FACET_ERROR = 1e-5, 8e-4
"""least errors of derivatives where surfaces meet shapes, and facets: misses are 8e-6 and 3e-4"""


class LawOfUser(NamedTuple):
    """owner: what has it; addresses: of its functions, of which the second may be 0; places: of
    these among the parameters of all laws.
    """

    owner: str
    addresses: list[int]
    places: slice

    def addresses_with_derivatives(self, k: int) -> list[int]:
        """Those of the same functions of numbers with k derivatives."""
        from ..compiler.dual_calls import address_with_derivatives

        return [
            address_with_derivatives(one, i == 0, k) if one else 0
            for i, one in enumerate(self.addresses)
        ]


def user_laws(lowered: LoweredModel) -> Iterator[LawOfUser]:
    """The laws that are functions of Python."""
    laws = lowered.system.couplings.laws
    for law in np.flatnonzero(laws.number == UserLaw.number).tolist():
        row = int(np.searchsorted(laws.range, law, side="right")) - 1
        first = int(laws.first[law])
        places = slice(first, first + UserLaw.addresses)
        addresses = [int(one) for one in laws.parameters[places]]
        yield LawOfUser(lowered.owner_of(row), addresses, places)


def check_scope(lowered: LoweredModel, k: int = 1) -> None:
    """`DerivativeError` for a model whose runs have no k derivatives here."""
    if reason := next(_reasons(lowered, k), None):
        raise DerivativeError(f"{reason}: its runs have no exact derivatives")


def _reasons(lowered: LoweredModel, k: int) -> Iterator[str]:
    model = lowered.model
    if model.fmus:
        yield "the model has FMUs"
    if lowered.system.newton.fixed_iterations:
        yield "the model has a fixed number of iterations"
    for law in user_laws(lowered):
        try:
            law.addresses_with_derivatives(k)
        except ForeignError as error:
            yield (
                f"{law.owner} has a law that is a function of Python which cannot be compiled with "
                f"derivatives ({error})"
            )


def surface_error(lowered: LoweredModel) -> float:
    """The least error of derivatives by which that of Newton's matrix, which they lack, counts."""
    targets = lowered.system.surfaces.contacts.target
    return FACET_ERROR if (targets >= 0).any() else SHAPE_ERROR if len(targets) else 0.0


def has_kinks(lowered: LoweredModel) -> bool:
    """Whether there are kinks of which a run tells nothing: of laws of springs, and of the facets
    and rims of surfaces that others meet.
    """
    surfaces = lowered.system.surfaces.contacts
    # Of shapes these alone have no ends.
    endless = np.isin(surfaces.shape, [Plane.number, Sphere.number])
    if ((surfaces.target >= 0) | ~endless).any():
        return True
    laws, couplings = lowered.system.couplings.laws, lowered.system.couplings
    for law in np.flatnonzero(laws.number != MaxwellLaw.number).tolist():
        row = int(np.searchsorted(laws.range, law, side="right")) - 1
        if couplings.contact_of[lowered.coupling_of(row)] < 0:
            return True
    return False
