"""The names that belong to the numbers of a state, by which another model takes them over."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Index, as_index
from ..compiler.struct import Struct
from ..lower.lower import LoweredModel
from ..step.records.elastic import Elastic

Ranges = Mapping[str, Sequence[int]]
"""the first number of each name, and the one after its last"""


class Layout(NamedTuple):
    """Numbers of each dimension (step/system.py), by body, coupling or coordinate."""

    n_b: Ranges
    n_e: Ranges
    n_u: Ranges
    n_m: Ranges
    n_x: Ranges
    n_i: Ranges
    n_h: Ranges
    n_o: Ranges
    n_terms: Ranges
    n_motors: Ranges

    def numbers(self, earlier: "Layout") -> dict[str, tuple[Index, Index]]:
        """The numbers here and there, by dimension, of what has a name in both.

        Couplings that have another number of rows count as others.
        """
        return {
            dimension: _common(here, there)
            for dimension, here, there in zip(self._fields, self, earlier, strict=True)
        }


def layout_of(lowered: LoweredModel) -> Layout:
    elastic, flexible = lowered.system.elastic, list(lowered.model.flexible_bodies)
    couplings = lowered.system.couplings
    rows, laws = couplings.range.tolist(), couplings.laws
    # Of couplings, by their rows, by the laws of these: the first number of memory of each.
    remembered = laws.memory[laws.range[couplings.range]]
    return Layout(
        n_b=_one_each(lowered.body_names),
        n_e=_one_each(flexible),
        n_u=_ranges(flexible, elastic.dof.tolist()),
        n_m=_ranges(flexible, elastic.modes.range.tolist()),
        n_x=_ranges(flexible, _springs(elastic)),
        n_i=_ranges(lowered.coupling_names, rows),
        n_h=_ranges(lowered.coupling_names, remembered.tolist()),
        n_terms=_ranges(lowered.coupling_names, couplings.terms.range[couplings.range].tolist()),
        n_o=_one_each([f"{joint}.{name}" for joint, name in lowered.observers]),
        n_motors=_one_each([motor.name for motor in lowered.model.motors]),
    )


def _springs(elastic: Elastic) -> list[int]:
    """The first spring of the chain of each flexible body, and the one after the last."""
    chains, n_modes = elastic.modes.chains, np.diff(elastic.modes.range)
    n_springs = np.zeros(len(n_modes), dtype=np.int64)
    n_springs[chains.body] = np.diff(chains.element) * n_modes[chains.body]
    ends: list[int] = np.cumsum([0, *n_springs]).tolist()
    return ends


def _one_each(names: Sequence[str]) -> Ranges:
    return _ranges(names, range(len(names) + 1))


def _ranges(names: Sequence[str], ends: Sequence[int]) -> Ranges:
    return dict(zip(names, map(list, pairwise(ends)), strict=True))


def _common(here: Ranges, there: Ranges) -> tuple[Index, Index]:
    pairs = [(range(*here[name]), range(*there[name])) for name in here if name in there]
    # Another number of rows is another joint of the same name: it begins anew.
    same = [(own, other) for own, other in pairs if len(own) == len(other)]
    own = [number for numbers, _ in same for number in numbers]
    other = [number for _, numbers in same for number in numbers]
    return as_index(own), as_index(other)


def take_over(
    name: str, record: Struct, kept: Mapping[str, Any], numbers: Mapping[str, tuple[Index, Index]]
) -> None:
    """Fill the arrays of a record, nested ones apart, with what was kept of the same names."""
    for field, (_, kind) in record.layout.items():
        dimension = getattr(kind, "dims", ("",))[0]
        if dimension in numbers:
            own, other = numbers[dimension]
            array, values = getattr(record, field), kept[f"{name}/{field}"][other]
            if array.ndim > 1:
                # Columns are steps of the past, of which both runs keep as many as they need.
                n = min(array.shape[1], values.shape[1])
                array[own, :n] = values[:, :n]
            else:
                array[own] = values
        # Records of one number, or of dimensions that have no names.
        elif dimension:
            getattr(record, field)[...] = np.resize(kept[f"{name}/{field}"], 1)
