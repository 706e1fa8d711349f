"""Whether shafts start at spins that the tables of their bearings have."""

from typing import cast

from ..couplings.bearings import Bearing
from ..lower.lower import LoweredModel
from ..step.spin_tables import beyond_table
from ..step.system import Workspace


def check_spins(lowered: LoweredModel, work: Workspace) -> None:
    """`ModelError` for a spin beyond the margins of a table, where its coefficients are no numbers.

    work: with the rates of the start.
    """
    tables = lowered.system.couplings.laws.tables
    for t, row in enumerate(tables.spin.tolist()):
        spin = float(work.couplings.rate[row])
        if beyond_table(tables, t, spin) > 0.0:
            bearing = cast(Bearing, lowered.model.couplings[lowered.coupling_of(row)])
            bearing.coefficients(spin)
