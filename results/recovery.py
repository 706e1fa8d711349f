"""Fields of a flexible body from recorded results: its modes, driven by the loads on interfaces.

    u(X, t) = phi(X) eta(t),   eta'' + 2 zeta omega eta' + omega^2 eta = phi_C^T p

and for a body with terms of second order by those on inertia and coordinates q too, as the time
step has them (solver/step/second_order.py): the stress is then that of the bent body; of the
displacement, what is quadratic in q, as the foreshortening of a beam, is left out. All of it is
stepped as the run was, whatever the form of its history, so that phi_C eta are the displacements
that it recorded. It adds no cost to the time loop.
"""

import json
from collections.abc import Iterator, Mapping
from itertools import islice, pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..files.arrays import Array, Index
from ..superelement import (
    Chain,
    GeneralizedAlpha,
    Modes,
    Superelement,
    read,
    stressed,
    with_parameters,
)
from ..superelement.chain import Springs
from .contents import SuperelementFile
from .errors import RecoveryError
from .rotations import apply_tangent

# A run that continues another one starts with modes in motion, which its file does not have.
STARTS_AT_REST = ("given", "equilibrium")


# 512 MiB of modal coordinates: stepping them again takes far longer than reading memory.
MAX_KEPT_MODAL_BYTES = 1 << 29


class Stepping(NamedTuple):
    """The time integration of a run.

    h: steps [s], all the same or one after the other; rule: "consistent" or "paper"; start: one of
    `STARTS_AT_REST`.
    """

    h: float | Array
    scheme: GeneralizedAlpha
    rule: str
    start: str


def stepping(file: str, run: Mapping[str, Any], times: Array) -> Stepping:
    """The time integration by the notes of a run, of which all steps are recorded at the times.

    `RecoveryError` if one of the notes is missing.
    """
    missing = [name for name in ("h", "rho_inf", "rule", "start") if name not in run]
    if missing:
        raise RecoveryError(
            f"{file}: group solver has no attribute {', '.join(missing)}, which fields need"
        )
    return Stepping(
        _steps(float(run["h"]), run.get("contact_h"), times),
        GeneralizedAlpha(float(run["rho_inf"])),
        str(run["rule"]),
        str(run["start"]),
    )


def _steps(h: float, contact_h: float | None, times: Array) -> float | Array:
    """The steps of a run: h, or h and contact_h as they come."""
    if contact_h is None:
        return h
    # By the recorded times: files have no list of the steps.
    return np.where(np.diff(times) > 0.5 * (h + contact_h), h, contact_h)


class Instants(NamedTuple):
    """Times among the steps of a run: the steps before and after each, its share of the way."""

    before: Index
    after: Index
    share: Array

    def of(self, before: Array, after: Array) -> Array:
        """Linear between values (k, ...) at the steps before and after."""
        share = self.share.reshape(-1, *[1] * (before.ndim - 1))
        value: Array = (1.0 - share) * before + share * after
        return value


def read_again(body: str, file: SuperelementFile | None) -> Superelement:
    """The superelement that a run read for a body, from its file.

    `RecoveryError` if the run has no such flexible body or read no file for it, or if the file is
    gone or another.
    """
    if file is None:
        raise RecoveryError(f"the run has no flexible body {body!r}")
    if not Path(file.path).is_file():
        why = (
            f"{file.path}, the file of its superelement, is gone"
            if file.path
            else "the run read no file for its superelement"
        )
        raise RecoveryError(
            f"body {body!r}: {why}: give it to Results.read, superelements = {{{body!r}: ...}}"
        )
    if change := file.change():
        raise RecoveryError(f"body {body!r}: {file.path} has changed since the run: {change}")
    return as_in_run(read(file.path), file)


def as_in_run(element: Superelement, file: SuperelementFile | None) -> Superelement:
    """A superelement as its file has it, at the parameters that the body had in the run."""
    if file is None or not file.variation or element.variation is not None:
        return element
    return with_parameters(element, json.loads(file.variation))


def instants(times: Array, t: Array) -> Instants:
    """The instants of times t (k,) among those of the steps (n,); `RecoveryError` outside them."""
    # The end may be asked for as a decimal number.
    outside = t[(t < times[0]) | (t > times[-1] * (1.0 + 1e-12))]
    if outside.size:
        raise RecoveryError(
            f"time {outside[0]:.9g} s is outside the run, {times[0]:.9g} to {times[-1]:.9g} s"
        )
    after = np.searchsorted(times, t).clip(0, len(times) - 1)
    before = (after - 1).clip(0)
    # At the first step both are the same, and the length is none.
    length = np.where(after > before, times[after] - times[before], 1.0)
    return Instants(before, after, ((t - times[before]) / length).clip(0.0, 1.0))


def interface_loads(R: Array, u: Array, force: Array, rotations: bool) -> Array:
    """Loads p = [F; T(w) M] (n, 6) on the dofs of an interface, or F (n, 3) without rotations.

    In body axes. R (n, 4): body axes to space; u (n, 6): displacement and rotation w; force (n, 6):
    force R F and moment R M, in space. Source: frames.py.
    """
    F = _into_body(R, force[:, :3])
    if not rotations:
        return F
    return np.hstack([F, apply_tangent(u[:, 3:], _into_body(R, force[:, 3:]))])


def second_order_loads(omega: Array, force: Array, mass: float) -> Array:
    """Loads (n, 6 + r) on inertia and coordinates of second order, s(omega) and f_q.

    omega (n, 3): in body axes; force (n, r): as it is recorded. Source: docs/theory.md.
    """
    x, y, z = omega.T
    on_inertia = [0.5 * x * x, 0.5 * y * y, 0.5 * z * z, y * z, x * z, x * y]
    return np.hstack([np.column_stack(on_inertia), force / np.sqrt(mass)])


class RecordedModes:
    """Modal coordinates (n, m) of a body as a run recorded them; see `ModalSteps`.

    h: steps [s], all the same or one after the other; of bodies with a chain all are recorded;
    loads (n, k): further coordinates, of which stresses depend in the same way.
    """

    def __init__(self, modes: Modes, eta: Array, h: float | Array, loads: Array) -> None:
        self._eta = self._stress = np.hstack([eta, loads])
        if modes.chain is not None:
            stretched = np.array(list(_stretched(modes.chain, eta, h)))
            self._stress = np.hstack([stretched, loads])

    @property
    def nbytes(self) -> int:
        return self._eta.nbytes + (0 if self._stress is self._eta else self._stress.nbytes)

    @property
    def n(self) -> int:
        return len(self._eta)

    def at(self, steps: Index, stress: bool = False) -> Array:
        return (self._stress if stress else self._eta)[steps]

    def blocks(self, rows: slice, length: int, stress: bool = False) -> Iterator[tuple[int, Array]]:
        first, last, _ = rows.indices(self.n)
        for start in range(first, last, length):
            yield start, self.at(np.arange(start, min(start + length, last)), stress)


def _stretched(chain: Chain, eta: Array, h: float | Array) -> Iterator[Array]:
    """eta + sum_k a_k q_k (m,) at each of the steps of eta (n, m), from relaxed springs."""
    springs = Springs(chain, eta.shape[1])
    yield springs.stress(eta[0])
    steps = np.broadcast_to(h, len(eta) - 1).tolist()
    for step, (before, after) in zip(steps, pairwise(eta), strict=True):
        springs.set_step(step)
        springs.follow(after - before)
        yield springs.stress(after)


class ModalSteps:
    """Modal coordinates of a body at the steps of a run, from one pass over them.

    eta of displacements, or eta + sum_k a_k q_k of stresses: they differ by the springs of a chain,
    of a material with a loss factor. What was passed is kept where there is room for all, so that
    nothing is stepped twice.

    p (n, n_dofs): the loads of all steps, on the rows of phi.

    A start in equilibrium is at eta = phi_C^T p_0 / omega^2, any other at eta = 0 with the
    acceleration phi_C^T p_0, which is zero in eq. (55), the paper's rule. Source:
    initial.py, docs/theory.md, Impulse responses.
    """

    def __init__(self, modes: Modes, p: Array, run: Stepping) -> None:
        self._modes, self._p, self._run = modes, p, run
        self._apart = modes.chain is not None
        self._next, self._etas = 0, self._steps()
        size = (2 if self._apart else 1) * 8 * len(p) * len(modes.omega)
        self._kept: list[Array] | None = None
        # Otherwise each call steps the modes from the start again.
        if size <= MAX_KEPT_MODAL_BYTES:
            self._kept = [np.empty((len(p), len(modes.omega))) for _ in range(1 + self._apart)]

    @property
    def nbytes(self) -> int:
        """Of what is kept, when all steps were passed."""
        return sum(kept.nbytes for kept in self._kept or ())

    @property
    def n(self) -> int:
        """How many steps there are, with the start."""
        return len(self._p)

    def at(self, steps: Index, stress: bool = False) -> Array:
        """eta (k, m) at some steps (k,)."""
        which = int(stress and self._apart)
        if self._kept is not None:
            self._pass_to(int(steps.max(initial=-1)) + 1)
            return self._kept[which][steps]
        chosen = set(steps.tolist())
        passed = enumerate(islice(self._steps(), max(chosen, default=-1) + 1))
        eta_at = {n: eta[which] for n, eta in passed if n in chosen}
        return np.array([eta_at[n] for n in steps.tolist()])

    def blocks(self, rows: slice, length: int, stress: bool = False) -> Iterator[tuple[int, Array]]:
        """All steps of a range, some at once: the number of the first one, and eta (k, m)."""
        first, last, _ = rows.indices(self.n)
        starts = range(first, last, length)
        if self._kept is not None:
            for start in starts:
                yield start, self.at(np.arange(start, min(start + length, last)), stress)
            return
        which = int(stress and self._apart)
        passing = islice(self._steps(), first, last)
        for start in starts:
            yield start, np.array([eta[which] for eta in islice(passing, length)])

    def _pass_to(self, end: int) -> None:
        """Keep the steps before this one."""
        assert self._kept is not None
        for n, eta in zip(range(self._next, end), self._etas, strict=False):
            for kept, values in zip(self._kept, eta, strict=False):
                kept[n] = values
        self._next = max(self._next, end)

    def _steps(self) -> Iterator[tuple[Array, Array]]:
        modes, p, run = self._modes, self._p, self._run
        at_once = p[0] @ modes.phi
        start: dict[str, Array] = {}
        # As the solver itself starts its modes, see docs/theory.md.
        if run.start == "equilibrium":
            start = {"eta": at_once / modes.omega**2}
        elif run.rule == "consistent":
            start = {"acceleration": at_once}
        # The rule of the paper has the mean of the loads at both ends of a step.
        halves = run.rule != "consistent"
        loads = (0.5 * (a + b) if halves else b for a, b in pairwise(p))
        return stressed(modes, run.h, run.scheme, (load @ modes.phi for load in loads), **start)


def in_space(x: Array, R: Array, points: Array) -> Array:
    """Points of bodies in space, x + R X (k, p, 3).

    x (k, 3): positions; R (k, 4): quaternions of any length; points X (k, p, 3), in body axes.
    """
    w, axis = np.split(R[:, None] / np.linalg.norm(R, axis=1)[:, None, None], [1], axis=2)
    twice = 2.0 * np.cross(axis, points)
    positions: Array = x[:, None] + points + w * twice + np.cross(axis, twice)
    return positions


def _into_body(R: Array, vectors: Array) -> Array:
    """R^T a (n, 3) for unit quaternions R (n, 4) and vectors a (n, 3) in space."""
    back = R * [1.0, -1.0, -1.0, -1.0]
    return in_space(np.zeros((len(R), 3)), back, vectors[:, None])[:, 0]
