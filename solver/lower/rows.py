"""The rows of couplings as arrays."""

from collections.abc import Sequence

import numpy as np

from ..arrays import Array, Index, as_index, as_rows, starts
from ..couplings.friction import Bristle
from ..couplings.rows import Row
from ..signals.signal import SmoothSignal
from ..step.records.contacts import Friction
from ..step.records.couplings import Couplings, Rows, Terms
from ..step.records.laws import Laws, Motors, SpinTables
from ..step.rows import slips


def lay_out_rows(rows: Sequence[Row]) -> Rows:
    return Rows(
        kind=as_index([row.kind for row in rows]),
        frame_a=as_index([row.frame_a for row in rows]),
        frame_b=as_index([row.frame_b for row in rows]),
        a=as_rows([row.a for row in rows]),
        a_turned=as_rows([row.a_turned for row in rows]),
        b=as_rows([row.b for row in rows]),
        shape=as_index([row.shape for row in rows]),
        size=np.array([row.size for row in rows], dtype=np.float64),
        first=starts(len(row.parameters) for row in rows),
        parameters=np.array([x for row in rows for x in row.parameters], dtype=np.float64),
        zero=np.array([row.zero for row in rows], dtype=np.float64),
        axis=np.full(len(rows), -1, dtype=np.int64),
    )


def _first_drives(drives: Sequence[Sequence[SmoothSignal]]) -> Index:
    """The number of the first drive of each row, -1 of those that have none."""
    first = starts(map(len, drives))[:-1]
    return as_index(np.where([bool(signals) for signals in drives], first, -1))


def _lay_out_terms(couplings: Sequence[list[Row]]) -> Terms:
    """The terms of all rows, in their order."""
    terms = [
        (term, i, j)
        for j, rows in enumerate(couplings)
        for i, row in enumerate(rows)
        for term in row.terms
    ]
    before = starts(map(len, couplings))
    return Terms(
        rows=lay_out_rows([term.row for term, _, _ in terms]),
        ratio=np.array([term.ratio for term, _, _ in terms], dtype=np.float64),
        row=as_index([before[j] + i for _, i, j in terms]),
        number=as_index([i for _, i, _ in terms]),
        own=as_index([j if term.same_frames else -1 for term, _, j in terms]),
        # Ranges of n rows have n + 1 ends, so that row i has range[i] to range[i + 1] without a
        # test.
        range=starts(len(row.terms) for rows in couplings for row in rows),
    )


def lay_out_couplings(
    couplings: Sequence[list[Row]], bristles: Sequence[Bristle | None], contacts: Sequence[bool]
) -> tuple[Couplings, list[SmoothSignal]]:
    """The rows of all couplings one after the other, and the signals that drive some of them.

    bristles: of each coupling; contacts: whether it is one.
    """
    rows = [row for coupling in couplings for row in coupling]
    drives = [drive for row in rows for drive in row.drives]
    first = _first_drives([row.drives for row in rows])
    attitudes = np.array([bool(row.axis) for row in rows], dtype=bool)
    rub = [any(row.has_friction for row in coupling) for coupling in couplings]
    laid_out = Couplings(
        rows=lay_out_rows(rows).replace(axis=np.where(attitudes, first, -1)),
        terms=_lay_out_terms(couplings),
        laws=_lay_out_laws(rows),
        friction=_lay_out_friction(rows, [bristle for bristle in bristles if bristle]),
        friction_of=_numbers(rub),
        contact=as_index(np.flatnonzero(contacts)),
        contact_of=_numbers(contacts),
        switching=as_index(np.flatnonzero(np.array(contacts, bool) | np.array(rub, bool))),
        n_compliant=sum(row.compliant for row in rows),
        n_by_rate=sum(row.compliant or slips(row.kind) for row in rows),
        range=starts(map(len, couplings)),
        # Forces are recorded on the second frame as the model names it: in a swapped row that is A.
        second=as_index([0 if row.swapped else 6 for row in rows]),
        drive=first,
        driven=as_index(np.repeat(np.arange(len(rows)), [len(row.drives) for row in rows])),
        compliant=as_index([row.compliant for row in rows]),
    )
    return laid_out, drives


def _numbers(chosen: Sequence[bool]) -> Index:
    """The number of each among those that are chosen, -1 of the others."""
    return as_index(np.where(chosen, np.cumsum(chosen) - 1, -1))


def _lay_out_friction(rows: Sequence[Row], bristles: Sequence[Bristle]) -> Friction:
    rub = np.array([row.has_friction for row in rows], dtype=bool)
    first = np.flatnonzero(np.diff(rub.astype(int), prepend=0) == 1).tolist()
    coefficients = [bristle.coefficient for bristle in bristles]
    return Friction(
        first=as_index(first),
        # argmin of booleans: the first False, which the sentinel provides at the end.
        n=as_index([int(np.argmin([*rub[i:], False])) for i in first]),
        static=np.array([mu.static for mu in coefficients], dtype=float),
        sliding=np.array([mu.sliding for mu in coefficients], dtype=float),
        speed=np.array([mu.speed for mu in coefficients], dtype=float),
        stiffness=np.array([bristle.stiffness for bristle in bristles], dtype=float),
        damping=np.array([bristle.damping for bristle in bristles], dtype=float),
        viscous=np.array([bristle.viscous for bristle in bristles], dtype=float),
        preload=np.array([bristle.preload for bristle in bristles], dtype=float),
        weight=np.array([row.normal[0] for row in rows], dtype=float),
        group=as_index([row.normal[1] for row in rows]),
    )


def _lay_out_laws(rows: Sequence[Row]) -> Laws:
    laws = [law for row in rows for law in row.laws]
    parameters = [law.parameters() for law in laws]
    return Laws(
        rest=np.array([row.rest for row in rows], dtype=np.float64),
        stiffness=_six_wide([row.stiffness for row in rows]),
        damping=_six_wide([row.damping for row in rows]),
        range=starts(len(row.laws) for row in rows),
        number=as_index([law.number for law in laws]),
        first=starts(map(len, parameters)),
        parameters=np.array([number for numbers in parameters for number in numbers], dtype=float),
        memory=starts(len(law.memories()) for law in laws),
        motor=_numbers([row.motor is not None for row in rows]),
        motors=_lay_out_motors(rows),
        tables=_lay_out_tables(rows),
    )


def _lay_out_tables(rows: Sequence[Row]) -> SpinTables:
    tables = [row.over_spin for row in rows if row.over_spin is not None]
    # The row of the spin is the first one after them that has no table.
    spin = [
        next(k for k in range(i, len(rows)) if rows[k].over_spin is None)
        for i, row in enumerate(rows)
        if row.over_spin is not None
    ]
    return SpinTables(
        of=_numbers([row.over_spin is not None for row in rows]),
        spin=as_index(spin),
        first=as_index(np.cumsum([0, *(len(table.speeds) for table in tables)])),
        speed=np.concatenate([np.empty(0), *(table.speeds for table in tables)]),
        stiffness=np.concatenate([np.empty((0, 2)), *(table.stiffness for table in tables)]),
        damping=np.concatenate([np.empty((0, 2)), *(table.damping for table in tables)]),
    )


def _lay_out_motors(rows: Sequence[Row]) -> Motors:
    motors = [row.motor for row in rows if row.motor is not None]
    limits = [(-np.inf, np.inf) if motor.limit is None else motor.limit for motor in motors]
    speeds = [np.inf if motor.speed is None else motor.speed for motor in motors]
    return Motors(
        row=as_index([i for i, row in enumerate(rows) if row.motor is not None]),
        stiffness=np.array([motor.stiffness for motor in motors], dtype=float),
        damping=np.array([motor.damping for motor in motors], dtype=float),
        integral=np.array([motor.integral for motor in motors], dtype=float),
        lower=np.array([lower for lower, _ in limits], dtype=float),
        upper=np.array([upper for _, upper in limits], dtype=float),
        speed=np.array(speeds, dtype=float),
        tracking=np.array([motor.tracking for motor in motors], dtype=float),
    )


def _six_wide(vectors: Sequence[Array | None]) -> Array:
    # Couplings have at most six compliant rows: fixed width, so that compiled code needs no ranges.
    out = np.zeros((len(vectors), 6))
    for i, vector in enumerate(vectors):
        if vector is not None:
            out[i, : len(vector)] = vector
    return out
