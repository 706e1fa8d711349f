"""Superelements as arrays: the modes or the kernel of every flexible body, whichever carries its history."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..superelement import GeneralizedAlpha, Superelement, SuperelementError
from .compiled import Array, Index, as_index
from .errors import ModelError
from .model import Model
from .system import Elastic, Frames


class _Memory(NamedTuple):
    """How one body remembers: by modes (then g is empty) or by its kernel (then phi is)."""

    recursion: Array  # (3, m) stiffness, damping and pivot of the scalar recursions
    phi: Array  # (n_c, m)
    g: Array  # (n_k, n_c, n_c)
    g_initial: Array
    G_0: Array  # (n_c, n_c)
    compliance: Array  # (n_c, n_c) static, as this memory sums to


def lay_out_elastic(
    model: Model, frames: Frames, h: float, scheme: GeneralizedAlpha, n_steps: int, weight: float
) -> tuple[Elastic, list[Array]]:
    """Number the interface dofs of all flexible bodies; bodies with the same superelement share its data.

    Also their static compliances.
    """
    bodies = model.flexible_bodies
    owners = [id(body.superelement) for body in bodies.values()]
    made: dict[int, _Memory] = {}
    for owner, (name, body) in zip(owners, bodies.items(), strict=True):
        if owner not in made:
            made[owner] = (
                _by_modes(body.superelement, h, scheme)
                if _has_modes(name, body.superelement, model.history)
                else _by_kernel(body.superelement, h, scheme, n_steps)
            )
    memories = [made[owner] for owner in owners]
    dofs = np.cumsum([0, *(body.superelement.n_c for body in bodies.values())])
    active = np.array(sorted(_active_dofs(frames)), dtype=np.int64)
    stiffness, damping, pivot = np.hstack([np.empty((3, 0)), *(memory.recursion for memory in memories)])
    G_0, G_0_start = _packed([memory.G_0 for memory in memories], owners)
    phi, phi_start = _packed([memory.phi for memory in memories], owners)
    g, g_start = _packed([memory.g for memory in memories], owners)
    g_initial, _ = _packed([memory.g_initial for memory in memories], owners)
    active_range = np.searchsorted(active, dofs)
    G_active, G_active_start = active_flexibility(
        [memory.G_0 for memory in memories], active, active_range, dofs, weight
    )
    numbers = {name: b for b, name in enumerate(model.bodies)}
    flexible = as_index([numbers[name] for name in bodies])
    of_body = np.full(len(numbers), -1)
    of_body[flexible] = np.arange(len(flexible))
    elastic = Elastic(
        body=flexible,
        dof=as_index(dofs),
        active=active,
        active_range=as_index(active_range),
        of_body=of_body,
        G_0=G_0,
        G_0_start=G_0_start,
        G_active=G_active,
        G_active_start=G_active_start,
        mode_range=as_index(np.cumsum([0, *(memory.recursion.shape[1] for memory in memories)])),
        stiffness=stiffness.copy(),
        damping=damping.copy(),
        pivot=pivot.copy(),
        phi=phi,
        phi_start=phi_start,
        g=g,
        g_initial=g_initial,
        g_start=g_start,
    )
    return elastic, [memory.compliance for memory in memories]


def active_flexibility(
    matrices: Sequence[Array], active: Index, active_range: Index, dofs: Index, weight: float
) -> tuple[Array, Index]:
    """weight times the rows and columns of the active dofs of every body's matrix (n_c, n_c), and where each starts."""
    parts = []
    for e, matrix in enumerate(matrices):
        own = active[active_range[e] : active_range[e + 1]] - dofs[e]
        parts.append(weight * matrix[np.ix_(own, own)])
    return _packed(parts, range(len(parts)))


def _active_dofs(frames: Frames) -> list[int]:
    return [
        int(frames.dof[f]) + i
        for f in range(frames.n_acting)
        if frames.dof[f] >= 0
        for i in range(3 + 3 * int(frames.rotations[f]))
    ]


def _has_modes(name: str, element: Superelement, history: str) -> bool:
    if history == "recursive" and element.modes is None:
        raise ModelError(f"body {name!r}: history 'recursive' needs modes, and superelement {element.name!r} has none")
    return history != "direct" and element.modes is not None


def _by_modes(element: Superelement, h: float, scheme: GeneralizedAlpha) -> _Memory:
    modes = element.modes_for(h)
    stiffness = modes.omega**2
    damping = 2.0 * modes.zeta * modes.omega
    ratio = (1.0 - scheme.alpha_m) / (1.0 - scheme.alpha_f)
    pivot = ratio + scheme.gamma * h * damping + scheme.beta * h * h * stiffness
    G_0 = (modes.phi * (scheme.beta * h * h / pivot)) @ modes.phi.T
    compliance = (modes.phi / stiffness) @ modes.phi.T
    return _Memory(np.array([stiffness, damping, pivot]), modes.phi, np.empty(0), np.empty(0), G_0, compliance)


def _by_kernel(element: Superelement, h: float, scheme: GeneralizedAlpha, n_steps: int) -> _Memory:
    try:
        kernel = element.kernel_for(h, scheme, n_steps)
    except SuperelementError as error:
        raise ModelError(f"superelement {error}") from error
    return _Memory(np.empty((3, 0)), np.empty(0), kernel.g, kernel.g_initial, kernel.g[0], element.compliance)


def _packed(arrays: Sequence[Array], owners: Sequence[int]) -> tuple[Array, Index]:
    """The arrays one after the other, each owner's once, and where each of them starts."""
    starts: dict[int, int] = {}
    parts: list[Array] = []
    length = 0
    for array, owner in zip(arrays, owners, strict=True):
        if owner not in starts:
            starts[owner] = length
            parts.append(array.ravel())
            length += array.size
    return np.concatenate([np.empty(0), *parts]), as_index([starts[owner] for owner in owners])
