"""Rows that the time loop hands over, and what is derived from them."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..files.arrays import Array, Index


class Energies(NamedTuple):
    """Energies of a step [J] that others are measured from."""

    springs: float
    total: float

    @classmethod
    def of(cls, output: Any) -> "Energies":
        """Those of the first row of an output."""
        springs, *others = (getattr(output, name)[0] for name in STORED_ENERGIES)
        return cls(float(springs), float(sum(others, springs)))


class EventRows(NamedTuple):
    """Events: numbers of their owners (m,), and their values (m, 9) in the order of `EVENTS`."""

    owner: Index
    values: Array

    @classmethod
    def none(cls) -> "EventRows":
        return cls(np.empty(0, dtype=np.int64), np.empty((0, 9)))

    @classmethod
    def joined(cls, parts: Sequence["EventRows"]) -> "EventRows":
        owners, values = zip(cls.none(), *parts, strict=True)
        return cls(np.concatenate(owners), np.concatenate(values))


class Batch(NamedTuple):
    """Steps (n,) that the time loop recorded in the first rows of its output.

    With the step size h [s], the energies of t = 0, and the contacts that ended meanwhile. is_last:
    the loop does not write to this output again.
    """

    steps: Any
    h: float
    output: Any
    start: Energies
    events: EventRows = EventRows.none()
    is_last: bool = False


STORED_ENERGIES = ("spring_energy", "kinetic_energy", "elastic_energy", "potential_energy")
# Energies are derived from these arrays (n,) [J] of the time loop: the work of springs and dampers
# on bodies; the work of loads on modes, less their energy; the loss by modal damping.
FURTHER_WORKS = ("compliance_work", "modal_loss", "modal_damping")


def time_of(batch: Batch) -> Array:
    found: Array = batch.h * batch.steps
    return found


def dissipated(batch: Batch) -> Array:
    """The work of springs and dampers that springs have not stored, and what modal damping took."""
    n, output = len(batch.steps), batch.output
    # Energies are relative to t = 0, where springs may be stretched.
    stored = output.spring_energy[:n] - batch.start.springs
    found: Array = output.modal_damping[:n] - output.compliance_work[:n] - stored
    return found


def numerical(batch: Batch) -> Array:
    """The work on modes that they have neither stored nor lost to their damping."""
    n, output = len(batch.steps), batch.output
    found: Array = output.modal_loss[:n] - output.modal_damping[:n]
    return found


def balance(batch: Batch) -> Array:
    """The change of all energies, and what they lost, less the work from outside."""
    n, output = len(batch.steps), batch.output
    stored = sum(
        (getattr(output, name)[:n] for name in STORED_ENERGIES[1:]),
        getattr(output, STORED_ENERGIES[0])[:n],
    )
    lost = dissipated(batch) + numerical(batch)
    found: Array = stored + lost - output.external_work[:n] - batch.start.total
    return found
