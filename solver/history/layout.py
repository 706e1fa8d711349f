"""Superelements as arrays: the modes or the kernel that carries the history of each body."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ...files.memory import shortage
from ...superelement import Chain, GeneralizedAlpha, Superelement, SuperelementError
from ..arrays import Array, Index, as_index, distinct, starts
from ..errors import ModelError
from ..model.bodies import FlexibleBody
from ..model.model import Model
from ..model.settings import Settings
from ..step.records.elastic import Elastic, Kernels, Modes
from ..step.records.frames import Frames
from .axial import lay_out_axial
from .chains import elements_of, hardening_of, lay_out_chains
from .cost import cheapest_history
from .dyadic import power_above
from .packing import packed
from .second_order import lay_out_second_order, lengths_of
from .shares import Shares, shares_of, with_rest
from .truncation import truncate, truncation_error

# beyond, integers of 8 bytes might overflow before memory is compared with what is there
MAX_KERNEL_STEPS = 1e15
# in memory while it is laid out
KERNEL_COPIES = 3
LARGEST_TRUNCATION = 0.1
"""relative error of a kernel that is cut off; with a larger one, motions can gain energy"""


class Horizon(NamedTuple):
    """Numbers of steps of the run that a run continues: `planned` at first, and laid out for."""

    planned: int
    steps: int


class Stepping(NamedTuple):
    """The time integration of a run: step h [s], scheme, number of steps.

    weight: of p_{n+1} against p_n in the convolution, 1, or 1/2 in eq. (55); planned: the number of
    steps for which the forms of history are chosen, that of the run that this one continues. ratio:
    of the longest step to h, in flight between contacts; stride: of this step to h.
    """

    h: float
    scheme: GeneralizedAlpha
    n_steps: int
    weight: float
    planned: int
    ratio: int = 1
    stride: int = 1

    @property
    def in_flight(self) -> "Stepping":
        """The longest steps."""
        return self._replace(h=self.h * self.ratio, stride=self.ratio)

    @property
    def shortest(self) -> float:
        """The shortest step [s]."""
        return self.h / self.stride


NO_MODES: Index = np.empty(0, dtype=np.int64)


class _History(NamedTuple):
    """The history of one body: by modes (then g is empty) or by its kernel (then phi is)."""

    recursion: Array  # (3, m) stiffness, damping and step stiffness of the scalar recursions
    phi: Array  # (n_c, m)
    g: Array  # (n_c, n_c, lags), reversed
    g_initial: Array  # (lags, n_c, n_c)
    lags: int
    by_fft: bool
    error: float  # of a kernel that was cut off
    G_0: Array  # (n_c, n_c)
    compliance: Array  # (n_c, n_c) static: the sum of the kernel, or of the modes
    accelerance: Array  # (n_c, n_c) accelerations under unit loads at rest
    chain: Chain | None = None  # of the modes
    quasi_static: Index = NO_MODES  # those without inertia


class Responses(NamedTuple):
    """Of every flexible body: its static compliance and accelerance (n_dofs, n_dofs).

    And the error of its kernel where that is cut off, of static displacements (n_e,).
    """

    compliances: list[Array]
    accelerances: list[Array]
    truncations: Array


def lay_out_elastic(model: Model, frames: Frames, stepping: Stepping) -> tuple[Elastic, Responses]:
    """Number the elastic dofs of all flexible bodies, and lay out their histories.

    Bodies with the same superelement share its data.
    """
    bodies = model.flexible_bodies
    dofs = starts(body.n_dofs for body in bodies.values())
    inner = [
        np.arange(last - body.n_inner, last)
        for body, last in zip(bodies.values(), dofs[1:], strict=True)
    ]
    active = distinct(np.concatenate([_active_dofs(frames), *inner])).astype(np.int64)
    active_range = np.searchsorted(active, dofs)
    numbers = {name: b for b, name in enumerate(model.bodies)}
    patterns = _pattern_dofs(bodies, dofs)
    loaded_patterns = [patterns[load.owner_of_pattern] for load in model.pattern_loads]
    loaded = distinct(np.concatenate([active, as_index(loaded_patterns)])).astype(np.int64)
    loaded_range = np.searchsorted(loaded, dofs)
    # Ids are even addresses: bodies that use terms of second order, bodies that do not, and bodies
    # with surfaces in contact differ by less.
    pressed = model.bodies_with_pressed_surfaces
    owners = [
        8 * id(body.superelement) + 2 * (body.rotation is None) + (name in pressed)
        for name, body in bodies.items()
    ]
    histories = _histories(model, owners, np.diff(loaded_range).tolist(), stepping)
    G_0, G_0_start = packed([history.G_0 for history in histories], owners)
    G_active, G_active_start = active_flexibility(
        [history.G_0 for history in histories], active, active_range, dofs, stepping.weight
    )
    flexible = as_index([numbers[name] for name in bodies])
    of_body = np.full(len(numbers), -1)
    of_body[flexible] = np.arange(len(flexible))
    elastic = Elastic(
        body=flexible,
        dof=dofs,
        active=active,
        active_range=as_index(active_range),
        loaded=loaded,
        loaded_range=as_index(loaded_range),
        pattern_dof=as_index(list(patterns.values())),
        of_body=of_body,
        size=np.array([body.superelement.size for body in bodies.values()], dtype=np.float64),
        G_0=G_0,
        G_0_start=G_0_start,
        G_active=G_active,
        G_active_start=G_active_start,
        length=np.concatenate([np.empty(0), *map(lengths_of, bodies.values())])[active],
        axial=lay_out_axial(bodies.values(), stepping.h),
        modes=_lay_out_modes(histories, owners, stepping.h),
        kernels=_lay_out_kernels(histories, owners),
        second=lay_out_second_order(
            list(bodies.values()),
            [
                active[begin:end] - first
                for begin, end, first in zip(
                    active_range[:-1], active_range[1:], dofs[:-1], strict=True
                )
            ],
        ),
    )
    return elastic, Responses(
        [history.compliance for history in histories],
        [history.accelerance for history in histories],
        np.array([history.error for history in histories], dtype=np.float64),
    )


def _histories(
    model: Model, owners: Sequence[int], n_active: Sequence[int], stepping: Stepping
) -> list[_History]:
    """The history of every flexible body; those with the same superelement share one."""
    most_active: dict[int, int] = {}
    for owner, n in zip(owners, n_active, strict=True):
        # Bodies that share a history must agree on its form: the busiest decides.
        most_active[owner] = max(n, most_active.get(owner, 0))
    histories: dict[int, _History] = {}
    for owner, (name, body) in zip(owners, model.flexible_bodies.items(), strict=True):
        if owner not in histories:
            if name in model.bodies_with_pressed_surfaces:
                histories[owner] = _with_surfaces(name, body, model.settings, stepping)
                continue
            histories[owner] = _choose_history(
                name, body, most_active[owner], model.settings, stepping
            )
    return [histories[owner] for owner in owners]


def _lay_out_modes(histories: Sequence[_History], owners: Sequence[int], h: float) -> Modes:
    recursions = [history.recursion for history in histories]
    stiffness, damping, step_stiffness = np.hstack([np.empty((3, 0)), *recursions])
    phi, phi_start = packed([history.phi for history in histories], owners)
    ranges = starts(recursion.shape[1] for recursion in recursions)
    quasi_static = [
        first + history.quasi_static
        for first, history in zip(ranges.tolist(), histories, strict=False)
    ]
    return Modes(
        range=ranges,
        stiffness=stiffness.copy(),
        damping=damping.copy(),
        step_stiffness=step_stiffness.copy(),
        phi=phi,
        phi_start=phi_start,
        quasi_static=as_index(np.concatenate([NO_MODES, *quasi_static])),
        damped=int(damping.any()),
        chains=lay_out_chains(
            [history.chain for history in histories],
            [recursion.shape[1] for recursion in recursions],
            h,
        ),
    )


def _lay_out_kernels(histories: Sequence[_History], owners: Sequence[int]) -> Kernels:
    g, g_start = packed([history.g for history in histories], owners)
    g_initial, _ = packed([history.g_initial for history in histories], owners)
    return Kernels(
        g=g,
        g_initial=g_initial,
        g_start=g_start,
        lags=as_index([history.lags for history in histories]),
        by_fft=as_index([history.by_fft for history in histories]),
    )


def active_flexibility(
    matrices: Sequence[Array], active: Index, active_range: Index, dofs: Index, weight: float
) -> tuple[Array, Index]:
    """weight times the active rows and columns of every body's matrix, packed, and their starts.

    matrices: (n_c, n_c) of each flexible body; active, active_range, dofs: as in `Elastic`.
    """
    blocks = []
    for e, matrix in enumerate(matrices):
        columns = active[active_range[e] : active_range[e + 1]] - dofs[e]
        blocks.append(weight * matrix[np.ix_(columns, columns)])
    return packed(blocks, range(len(blocks)))


def _pattern_dofs(bodies: Mapping[str, FlexibleBody], dofs: Index) -> dict[str, int]:
    """The dof of every load pattern, by BODY.PATTERN."""
    return {
        f"{name}.{pattern.name}": int(first) + body.superelement.n_c + i
        for (name, body), first in zip(bodies.items(), dofs[:-1], strict=True)
        for i, pattern in enumerate(body.superelement.patterns)
    }


def _active_dofs(frames: Frames) -> list[int]:
    return [
        int(frames.dof[f]) + i
        for f in range(frames.n_acting)
        if frames.dof[f] >= 0
        for i in range(3 + 3 * int(frames.rotations[f]))
    ]


def _choose_history(
    name: str, body: FlexibleBody, n_active: int, settings: Settings, stepping: Stepping
) -> _History:
    """The history that the settings ask for, or the cheapest, for the body of this name."""
    if body.rotation is not None:
        _check_second_order(name, settings, stepping)
        return _by_modes(body, stepping.h, stepping.scheme)
    element = body.superelement
    h, n_steps, planned = stepping.h, stepping.n_steps, stepping.planned
    # Modes hold for any step, kernels are sampled at one.
    form = "recursive" if stepping.ratio > 1 else str(settings.history)
    wanted = settings.kernel_length
    length = n_steps if wanted is None else round(min(wanted / h, MAX_KERNEL_STEPS))
    if form == "auto":
        m = None if element.modes is None else len(element.modes.omega)
        elements = 0 if element.modes is None else elements_of(element.modes.chain)
        # `planned`, not n_steps: a run that goes on keeps the form that it began with.
        lags = min(planned, length) + 1
        form = cheapest_history(body.n_outer, n_active, m, planned, lags, elements)
    if form == "recursive":
        if element.modes is None:
            raise ModelError(
                f"body {name!r}: {_what_is_recursive(stepping)} needs modes, "
                f"and superelement {element.name!r} has none"
            )
        return _by_modes(body, h, stepping.scheme)
    lags = min(n_steps, length) + 1
    if form == "fft" and lags > n_steps:
        lags = _whole_blocks(element, n_steps) + 1
    _check_memory(name, body.n_outer, lags)
    return _by_kernel(element, stepping, lags, form == "fft")


def _check_memory(name: str, n_c: int, lags: int) -> None:
    """`ModelError` for impulse responses, and loads in the past, that memory cannot hold."""
    if lacking := shortage(8.0 * lags * (2 * KERNEL_COPIES * n_c * n_c + n_c)):
        raise ModelError(
            f"body {name!r}: its history of {lags} steps {lacking}: shorten t_end or "
            "`memory`, lengthen the step, or set history = 'recursive'"
        )


def _whole_blocks(element: Superelement, n_steps: int) -> int:
    """The steps of a kernel that is transformed in blocks: those of the largest block as a whole.

    So the transforms of a block are the same in a longer run, to the bit. A body without modes has
    no more steps than it has.
    """
    steps = power_above(n_steps + 1)
    return steps if element.modes is not None else max(n_steps, min(steps, element.kernel.steps))


def _what_is_recursive(stepping: Stepping) -> str:
    return "contact_step" if stepping.ratio > 1 else "history 'recursive'"


def _check_second_order(name: str, settings: Settings, stepping: Stepping) -> None:
    """`ModelError` for what terms of second order have no place in."""
    asked = "rule 'paper'" if stepping.weight != 1.0 else ""
    if settings.history not in ("auto", "recursive"):
        asked = f"history {str(settings.history)!r}"
    elif settings.kernel_length is not None:
        asked = "memory"
    if asked:
        raise ModelError(
            f"body {name!r}: {asked} has no terms of second order: give it second_order = 'off'"
        )


def _with_surfaces(
    name: str, body: FlexibleBody, settings: Settings, stepping: Stepping
) -> _History:
    """The history of a body with surfaces in contact, whose modes move up to a band."""
    element, problem = body.superelement, ""
    if stepping.weight != 1.0:
        problem = "rule 'paper'"
    elif settings.history not in ("auto", "recursive"):
        problem = f"history {str(settings.history)!r}"
    elif settings.kernel_length is not None:
        problem = "memory"
    elif element.modes and element.modes.chain and element.modes.chain.amplitude.ndim == 2:
        problem = "loss factors that differ between its materials"
    if problem:
        raise ModelError(f"body {name!r}: its surfaces are in contact, which excludes {problem}")
    return _by_modes(body, stepping.h, stepping.scheme, shares_of(body, stepping.shortest))


def _by_modes(
    body: FlexibleBody, h: float, scheme: GeneralizedAlpha, shares: Shares | None = None
) -> _History:
    element, second = body.superelement, body.rotation
    # Beyond their band the modes of bodies with surfaces are static: no step is too fine for them.
    modes = element.modes if shares is not None else element.modes_for(h)
    assert modes is not None
    modes = element.complete_modes(modes)
    if second is not None:
        modes = second.complete(modes)
    quasi_static = np.zeros(len(modes.omega), dtype=bool)
    if shares is not None:
        modes = shares.of(with_rest(element, modes), second)
        quasi_static = shares.quasi_static
    stiffness = modes.omega**2
    damping = 2.0 * modes.zeta * modes.omega
    # By what generalized-alpha divides: inertia, damping and stiffness of a mode in one step.
    step_stiffness = scheme.inertia_ratio + scheme.gamma * h * damping
    hardened = stiffness * (1.0 + hardening_of(modes.chain, h, len(stiffness)))
    step_stiffness[quasi_static] = 0.0
    step_stiffness += scheme.beta * h * h * hardened
    G_0 = (modes.phi * (scheme.beta * h * h / step_stiffness)) @ modes.phi.T
    recursion, empty = np.array([stiffness, damping, step_stiffness]), np.empty(0)
    return _History(
        recursion=recursion,
        phi=modes.phi,
        g=empty,
        g_initial=empty,
        lags=0,
        by_fft=False,
        error=0.0,
        G_0=G_0,
        compliance=modes.compliance,
        accelerance=element.complete_accelerance if second is None else modes.accelerance,
        chain=modes.chain,
        quasi_static=np.flatnonzero(quasi_static),
    )


def _by_kernel(element: Superelement, stepping: Stepping, lags: int, by_fft: bool) -> _History:
    """The kernel of so many lags, cut off where the run is longer."""
    try:
        kernel = element.complete_kernel_for(stepping.h, stepping.scheme, lags - 1)
        error = 0.0
        # Otherwise the kernel is as long as the run, and nothing is cut.
        if lags <= stepping.n_steps:
            compliance, modes = element.complete_compliance, element.modes
            whole, kernel = kernel, truncate(kernel, lags, compliance)
            complete = None if modes is None else element.complete_modes(modes)
            error = truncation_error(whole, kernel, complete, compliance)
    except SuperelementError as reason:
        raise ModelError(f"superelement {reason}") from reason
    if error > LARGEST_TRUNCATION:
        raise ModelError(
            f"superelement {element.name!r}: memory: its impulse responses have not decayed "
            f"in {(lags - 1) * stepping.h:.3g} s: truncation there causes an error of {error:.1g} "
            f"of the static displacements, more than {LARGEST_TRUNCATION:g}"
        )
    g, g_initial = kernel.g[:lags], kernel.g_initial[:lags]
    return _History(
        recursion=np.empty((3, 0)),
        phi=np.empty(0),
        g=_reversed_lags(g),
        g_initial=g_initial,
        lags=lags,
        by_fft=by_fft,
        error=error,
        G_0=g[0],
        compliance=element.complete_compliance,
        accelerance=element.complete_accelerance,
    )


def _reversed_lags(g: Array) -> Array:
    """A kernel (lags, n_c, n_c) as the time loop reads it: (n_c, n_c, lags), last lag first."""
    # The sum over past loads then runs through memory forward in both arrays.
    return np.ascontiguousarray(g[::-1].transpose(1, 2, 0))
