"""The materials of a body that lose energy: relaxed, and their Maxwell elements."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...superelement.relaxation import Fit, fit, fitted, stiffening
from ...superelement.validation import Array
from .body import Body
from .damping import Damping
from .material import Material, Section

STIFFNESS_KEYS = ("E", "G", "EA", "EI_y", "EI_z", "GJ", "GA_y", "GA_z")
"""Keys of materials and sections that a softer material scales."""


def relaxed(body: Body) -> Body:
    """The body with static moduli, with which those of the file hold at the reference."""
    # Files give moduli at the reference frequency; Maxwell elements add to the static ones.
    softness = {name: 1.0 / factor for name, factor in stiffenings(body).items() if factor != 1.0}
    return scaled(body, softness)


def stiffenings(body: Body) -> dict[str, float]:
    """The modulus at the reference frequency over the static one, by group; "" of a whole."""
    fits = fits_of(body)
    return {
        name: 1.0
        if found is None
        else stiffening(found.tau, found.amplitude, body.damping.reference)
        for name, found in fits.items()
    }


def fits_of(body: Body) -> dict[str, Fit | None]:
    """The Maxwell elements of each group, of the relaxation times of the one that loses most.

    None where there is no loss.
    """
    losses, band = body.loss_factors, body.damping.band
    if band is None or not any(losses.values()):
        return dict.fromkeys(losses)
    # Common relaxation times: modes then share their internal variables, whatever the group.
    widest = fit(max(losses.values()), band)
    assert widest is not None
    return {name: fitted(loss, band, widest.tau) if loss else None for name, loss in losses.items()}


def damping_of(body: Body) -> Damping:
    """The damping of the body file, with the largest loss factor of its materials."""
    largest = max(body.loss_factors.values())
    if largest == (body.damping.loss_factor or 0.0):
        return body.damping
    return body.damping.model_copy(update={"loss_factor": largest})


def amplitudes(body: Body, shares: Mapping[str, Array]) -> Array:
    """a (K, m) of modes with shares (m,) of their strain energy in each group.

    a_ki = sum over groups of a_k share_i: what the groups leave between modes is left out.
    """
    total: Any = 0.0
    for name, found in fits_of(body).items():
        if found is not None:
            total = total + np.outer(found.amplitude, shares[name])
    amplitude: Array = total
    return amplitude


def ripple_of(body: Body) -> float:
    """The largest relative error of the loss factor of a material."""
    return max(found.ripple for found in fits_of(body).values() if found is not None)


def scaled(body: Body, factors: Mapping[str, float]) -> Body:
    """The body with the stiffness of groups multiplied by factors; "" is the whole."""
    changes: dict[str, Any] = {}
    for key in ("section", "material"):
        if (whole := getattr(body, key)) is not None and "" in factors:
            changes[key] = _scaled(whole, factors[""])
    for key in ("sections", "materials"):
        groups = getattr(body, key)
        if groups:
            changes[key] = {
                name: _scaled(part, factors[name]) if name in factors else part
                for name, part in groups.items()
            }
    return body.model_copy(update=changes) if changes else body


def _scaled(part: Section | Material, factor: float) -> Section | Material:
    changes = {}
    for key in STIFFNESS_KEYS:
        value = getattr(part, key, None)
        if isinstance(value, tuple):
            changes[key] = tuple(factor * entry for entry in value)
        elif value is not None:
            changes[key] = factor * value
    return part.model_copy(update=changes)
