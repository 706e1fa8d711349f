"""The stiffness of the materials of a body that lose energy."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ..body.body import Body
from ..body.loss import scaled
from .source import Source
from .structure import assemble_on

MODULUS_STEP = 1e-3  # relative, of the difference of stiffnesses


def lossy_parts(body: Body, source: Source) -> Mapping[str, Any]:
    """K (n_u, n_u) of each group of a body whose materials have different loss factors.

    dK / d(factor) of the moduli of the group: their sum over all groups is K. Nothing where all
    have the same.
    """
    parts = {}
    for name in lossy_groups(body):
        # Plies that shear in series are not linear in the moduli of one of them. Of all other
        # bodies the difference is exact, whatever its step.
        stiffer, softer = (
            assemble_on(body, replace(source, body=scaled(source.body, {name: factor}))).K  # type: ignore
            for factor in (1.0 + MODULUS_STEP, 1.0 - MODULUS_STEP)
        )
        parts[name] = (stiffer - softer) / (2.0 * MODULUS_STEP)
    return parts


def lossy_groups(body: Body) -> list[str]:
    """The groups whose materials lose energy; none where all have the same loss factor."""
    losses = body.loss_factors
    if len(set(losses.values())) == 1:
        return []
    return [name for name, loss in losses.items() if loss]
