"""The stiffness of the materials of a body that lose energy."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ..body.body import Body
from ..body.loss import scaled
from .source import Source
from .structure import Structure, assemble_on


def lossy_parts(body: Body, source: Source, structure: Structure) -> Mapping[str, Any]:
    """K (n_u, n_u) of each group of a body whose materials have different loss factors.

    What the body is stiffer by when the group is twice as stiff. Nothing where all have the same.
    """
    parts = {}
    for name in lossy_groups(body):
        # A difference of two sums: elements know no groups, and none of theirs is made twice.
        stiffer = replace(source, body=scaled(source.body, {name: 2.0}))  # type: ignore
        parts[name] = assemble_on(body, stiffer).K - structure.K
    return parts


def lossy_groups(body: Body) -> list[str]:
    """The groups whose materials lose energy; none where all have the same loss factor."""
    losses = body.loss_factors
    if len(set(losses.values())) == 1:
        return []
    return [name for name, loss in losses.items() if loss]
