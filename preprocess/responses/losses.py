"""Chains of bodies whose materials have different loss factors."""

from dataclasses import replace
from typing import Any

import numpy as np

from ...superelement import Modes
from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..body.body import Body
from ..body.loss import amplitudes, ripple_of
from .shapes import Shapes


def with_losses(body: Body, structure: Structure, modes: Modes, shapes: Shapes) -> Modes:
    """The modes, each with a chain of its own by where its strain energy is.

        a_ki = sum over groups of a_k phi_i^T K_group phi_i / omega_i^2

    What the groups leave between modes, phi_i^T K_group phi_j, is left out: modes whose
    frequencies are apart by more than the loss factors do not feel it. Where all materials lose
    the same, the modes themselves. Source: docs/theory.md, Material damping.
    """
    if not structure.lossy or modes.chain is None:
        return modes
    shares = {name: _energy(shapes, K) / modes.omega**2 for name, K in structure.lossy.items()}
    chain = replace(
        modes.chain, amplitude=amplitudes(body, shares), loss_factor=0.0, ripple=ripple_of(body)
    )
    return replace(modes, chain=chain)


def _energy(shapes: Shapes, K: Any) -> Array:
    """phi_i^T K phi_i (m,)"""
    V, Q = shapes.V, shapes.Q
    if Q is None:
        return shapes.processes.total(np.einsum("im,im->m", V, K @ V))
    return np.asarray(np.einsum("im,im->m", Q, shapes.processes.total(V.T @ (K @ V)) @ Q))
