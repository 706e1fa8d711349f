"""Superelements as arrays: the modes or the kernel of every flexible body, whichever carries its
history.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...superelement import GeneralizedAlpha, Superelement, SuperelementError
from ..arrays import Array, Index, as_index
from ..errors import ModelError
from ..model.model import Model
from ..step.system import Elastic, Frames, Kernels, Modes
from .cost import cheapest_history
from .truncation import truncate, truncation_error

LARGEST_TRUNCATION = 0.1
"""relative error of a kernel that is cut off; those that err by more can gain energy from step to
step
"""


class _Memory(NamedTuple):
    """How one body remembers: by modes (then g is empty) or by its kernel (then phi is)."""

    recursion: Array  # (3, m) stiffness, damping and step stiffness of the scalar recursions
    phi: Array  # (n_c, m)
    g: Array  # (n_c, n_c, lags), reversed
    g_initial: Array  # (lags, n_c, n_c)
    lags: int
    by_fft: bool
    error: float  # of a kernel that was cut off
    G_0: Array  # (n_c, n_c)
    compliance: Array  # (n_c, n_c) static, as this memory sums to


def lay_out_elastic(
    model: Model, frames: Frames, h: float, scheme: GeneralizedAlpha, n_steps: int, weight: float
) -> tuple[Elastic, list[Array], float]:
    """Number the interface dofs of all flexible bodies; bodies with the same superelement share its
    data.

    Also their static compliances, and the largest error of kernels that `kernel_length` cuts off.
    """
    bodies = model.flexible_bodies
    owners = [id(body.superelement) for body in bodies.values()]
    dofs = np.cumsum([0, *(body.superelement.n_c for body in bodies.values())])
    active = np.array(sorted(_active_dofs(frames)), dtype=np.int64)
    active_range = np.searchsorted(active, dofs)
    most_active: dict[int, int] = {}
    for owner, n_active in zip(owners, np.diff(active_range).tolist(), strict=True):
        most_active[owner] = max(n_active, most_active.get(owner, 0))
    made: dict[int, _Memory] = {}
    for owner, (name, body) in zip(owners, bodies.items(), strict=True):
        if owner not in made:
            made[owner] = _remember(
                name, body.superelement, most_active[owner], model, h, scheme, n_steps
            )
    memories = [made[owner] for owner in owners]
    stiffness, damping, step_stiffness = np.hstack(
        [np.empty((3, 0)), *(memory.recursion for memory in memories)]
    )
    G_0, G_0_start = _packed([memory.G_0 for memory in memories], owners)
    phi, phi_start = _packed([memory.phi for memory in memories], owners)
    g, g_start = _packed([memory.g for memory in memories], owners)
    g_initial, _ = _packed([memory.g_initial for memory in memories], owners)
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
        modes=Modes(
            range=as_index(np.cumsum([0, *(memory.recursion.shape[1] for memory in memories)])),
            stiffness=stiffness.copy(),
            damping=damping.copy(),
            step_stiffness=step_stiffness.copy(),
            phi=phi,
            phi_start=phi_start,
        ),
        kernels=Kernels(
            g=g,
            g_initial=g_initial,
            g_start=g_start,
            lags=as_index([memory.lags for memory in memories]),
            by_fft=as_index([memory.by_fft for memory in memories]),
        ),
    )
    return (
        elastic,
        [memory.compliance for memory in memories],
        max((memory.error for memory in memories), default=0.0),
    )


def active_flexibility(
    matrices: Sequence[Array], active: Index, active_range: Index, dofs: Index, weight: float
) -> tuple[Array, Index]:
    """weight times the rows and columns of the active dofs of every body's matrix (n_c, n_c), and
    where each starts.
    """
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


def _remember(
    name: str,
    element: Superelement,
    n_active: int,
    model: Model,
    h: float,
    scheme: GeneralizedAlpha,
    n_steps: int,
) -> _Memory:
    history: str = model.settings.history
    length = model.settings.kernel_length
    lags = n_steps + 1 if length is None else min(n_steps, round(length / h)) + 1
    if history == "auto":
        m = None if element.modes is None else len(element.modes.omega)
        history = cheapest_history(element.n_c, n_active, m, n_steps, lags)
    if history == "recursive":
        if element.modes is None:
            raise ModelError(
                f"body {name!r}: history 'recursive' needs modes, and superelement {element.name!r} has none"
            )
        return _by_modes(element, h, scheme)
    return _by_kernel(element, h, scheme, lags, lags <= n_steps, history == "fft")


def _by_modes(element: Superelement, h: float, scheme: GeneralizedAlpha) -> _Memory:
    modes = element.modes_for(h)
    stiffness = modes.omega**2
    damping = 2.0 * modes.zeta * modes.omega
    step_stiffness = scheme.inertia_ratio + scheme.gamma * h * damping
    step_stiffness += scheme.beta * h * h * stiffness
    G_0 = (modes.phi * (scheme.beta * h * h / step_stiffness)) @ modes.phi.T
    recursion, empty = np.array([stiffness, damping, step_stiffness]), np.empty(0)
    return _Memory(recursion, modes.phi, empty, empty, 0, False, 0.0, G_0, modes.compliance)


def _by_kernel(
    element: Superelement,
    h: float,
    scheme: GeneralizedAlpha,
    lags: int,
    cut: bool,
    by_fft: bool,
) -> _Memory:
    try:
        kernel = element.kernel_for(h, scheme, lags - 1)
        error = 0.0
        if cut:
            whole, kernel = kernel, truncate(kernel, lags, element.compliance)
            error = truncation_error(whole, kernel, element.modes, element.compliance)
            if error > LARGEST_TRUNCATION:
                raise ModelError(
                    f"superelement {element.name!r}: memory: its impulse responses have not decayed in "
                    f"{(lags - 1) * h:.3g} s: cut off there they would err by {error:.1g} of static displacements, "
                    f"more than {LARGEST_TRUNCATION:g}"
                )
    except SuperelementError as reason:
        raise ModelError(f"superelement {reason}") from reason
    g, g_initial = kernel.g[:lags], kernel.g_initial[:lags]
    return _Memory(
        np.empty((3, 0)),
        np.empty(0),
        _reversed_lags(g),
        g_initial,
        lags,
        by_fft,
        error,
        g[0],
        element.compliance,
    )


def _reversed_lags(g: Array) -> Array:
    """Kernels (lags, n_c, n_c) as the time loop reads them: (n_c, n_c, lags), from the last to the
    first.
    """
    return np.ascontiguousarray(g[::-1].transpose(1, 2, 0))


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
