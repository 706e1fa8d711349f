"""Terms of second order of superelements as arrays."""

from collections.abc import Sequence

import numpy as np

from ...superelement import Rotation
from ...superelement.rotation import N_INERTIA_CHANGES
from ..arrays import Array, Index, as_index, starts
from ..model.bodies import FlexibleBody
from ..step.records.elastic import SecondOrder
from .packing import packed


def lengths_of(body: FlexibleBody) -> Array:
    """Factors that make lengths or angles of elastic dofs (n_dofs,): 1 at interfaces."""
    ones, second = np.ones(body.n_outer), body.rotation
    if second is None:
        return ones
    mass, size = body.mass, body.superelement.size
    inertia = np.full(N_INERTIA_CHANGES, 1.0 / (mass * size))
    return np.concatenate([ones, inertia, np.full(second.r, mass**-0.5)])


def lay_out_second_order(bodies: Sequence[FlexibleBody], active: Sequence[Index]) -> SecondOrder:
    """The terms of all flexible bodies; those with the same superelement share them.

    active: of each body the numbers of its active dofs.
    """
    terms = [_Terms(body.rotation, body.superelement.n_channels) for body in bodies]
    owners = [id(body.rotation) for body in bodies]
    A, A_start = packed([term.A for term in terms], owners)
    loaded = [term.of_active(dofs) for term, dofs in zip(terms, active, strict=True)]
    A_active, A_active_start = packed(loaded, range(len(loaded)))
    gyroscopic, gyroscopic_start = packed([term.h.transpose(1, 0, 2) for term in terms], owners)
    turned, _ = packed([term.h.transpose(2, 0, 1) for term in terms], owners)
    cubic, cubic_start = packed([term.cubic for term in terms], owners)
    quartic, quartic_start = packed([term.quartic for term in terms], owners)
    return SecondOrder(
        r=as_index([term.r for term in terms]),
        J_0=np.array([body.inertia for body in bodies], dtype=np.float64).reshape(-1, 3, 3),
        A=A,
        A_start=A_start,
        A_active=A_active,
        A_active_start=A_active_start,
        gyroscopic=gyroscopic,
        turned=turned,
        gyroscopic_start=gyroscopic_start,
        stiff=as_index([len(term.cubic) for term in terms]),
        cubic=cubic,
        cubic_start=cubic_start,
        quartic=quartic,
        quartic_start=quartic_start,
        row=starts(A.size // max(A.shape[0], 1) for A in loaded),
    )


class _Terms:
    """The terms of a body; arrays without entries where it has none."""

    def __init__(self, second: Rotation | None, n_channels: int) -> None:
        none = np.empty(0)
        self.r = 0 if second is None else second.r
        self.A, self.h = np.empty((0, 0, 0)), np.empty((3, 0, 0))
        if second is not None:
            # load patterns and sensors are of first order
            none_of_channels = np.zeros((n_channels, self.r, self.r))
            self.A = np.vstack([second.A_interface, none_of_channels, second.A_inertia])
            self.h = second.gyroscopic
        stiff = None if second is None else second.cubic
        self.cubic = none if stiff is None else stiff
        self.quartic = none if second is None or second.quartic is None else second.quartic

    def of_active(self, dofs: Index) -> Array:
        """A of the active dofs before q (r, n, r)."""
        return self.A[dofs[dofs < len(self.A)]].transpose(1, 0, 2)
