"""What is covered by derivatives of runs, and where a run may have kinks."""

from collections.abc import Iterator

import numpy as np

from ..errors import DerivativeError
from ..history.dyadic import DyadicConvolution
from ..laws.maxwell import MaxwellLaw
from ..laws.user import UserLaw
from ..lower.lower import LoweredModel


def check_scope(lowered: LoweredModel) -> None:
    """`DerivativeError` for a model whose runs have no derivatives here."""
    if reason := next(_reasons(lowered), None):
        raise DerivativeError(f"{reason}: its runs have no exact derivatives")


def _reasons(lowered: LoweredModel) -> Iterator[str]:
    model, settings, n = lowered.model, lowered.model.settings, lowered.n_steps
    if model.fmus:
        yield "the model has FMUs"
    if model.surface_contacts:
        yield "the model has contacts of surfaces"
    if lowered.flight is not None:
        yield "the model has two sizes of steps (contact_step)"
    if lowered.system.newton.fixed_iterations:
        yield "the model has a fixed number of iterations"
    if DyadicConvolution(lowered.system.elastic).steps_until_due(0, n) < n:
        yield "bodies without modes have a longer history than is summed directly"
    if settings.steady_rotation is not None:
        yield "the model starts in a steady rotation"
    laws = lowered.system.couplings.laws
    for law in np.flatnonzero(laws.number == UserLaw.number).tolist():
        row = int(np.searchsorted(laws.range, law, side="right")) - 1
        yield f"{lowered.owner_of(row)} has a law that is a function of Python"


def has_kinks(lowered: LoweredModel) -> bool:
    """Whether laws of springs have kinks, of which a run tells nothing."""
    laws, couplings = lowered.system.couplings.laws, lowered.system.couplings
    for law in np.flatnonzero(laws.number != MaxwellLaw.number).tolist():
        row = int(np.searchsorted(laws.range, law, side="right")) - 1
        if couplings.contact_of[lowered.coupling_of(row)] < 0:
            return True
    return False
