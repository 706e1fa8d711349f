"""How far a linear analysis can be trusted: the limits of its equations, as those of a run.

Linear equations are exact for small motions about their equilibrium. What limits them is the model
of the bodies there: how far they deform, how fast they turn, what loads them along their length,
and up to which frequency their superelements are right. Sources of the limits: docs/linear.md.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ...results.criteria import CRITERIA, Criterion
from ...results.validity import Check, Validity
from ..arrays import Array
from ..model.bodies import FlexibleBody
from ..output.subjects import Subjects
from ..step.axial import axial_force
from ..step.gaps import contact_arm
from .modes import FirstOrder, LinearModes
from .pose import Pose

# of the inertia of a mode, from which on a body takes part in it
MIN_INERTIA_SHARE = 0.01
_ROTATION = "make its superelement with [rotation], for terms of second order"
LINEAR_CRITERIA = {
    criterion.name: criterion
    for criterion in (
        CRITERIA["elastic_rotation"],
        CRITERIA["elastic_displacement"],
        CRITERIA["second_order_rotation"],
        CRITERIA["second_order_displacement"],
        Criterion(
            "linear_spin",
            "body",
            "spin / first elastic frequency",
            "",
            0.03,
            0.05,
            f"stiffening by rotation is missing: {_ROTATION}",
            measures=(
                "the spin over the first elastic frequency of a body without [rotation], when free"
            ),
        ),
        Criterion(
            "second_order_spin",
            "body",
            "spin / frequency of its terms of second order",
            "",
            0.6,
            0.9,
            "its terms of second order are too few for this spin: raise rotation.modes of the body "
            "file, or divide the body into several superelements",
            measures=(
                "the spin over sqrt(f_1 f_n): the first frequency of a body with [rotation], "
                "when free, and the last one of rotation.modes"
            ),
        ),
        Criterion(
            "axial_preload",
            "body",
            "axial force / Euler load",
            "",
            0.02,
            0.05,
            f"the load changes its bending stiffness, which is left out: {_ROTATION}",
            measures=(
                "the mean axial force in the equilibrium over Euler's load of the body "
                "hinged at both ends"
            ),
        ),
        CRITERIA["contact_arm"],
        CRITERIA["hertz_radius"],
        CRITERIA["kernel_error"],
        CRITERIA["test_misfit"],
        Criterion(
            "linear_band",
            "body",
            "highest frequency / band of the superelement",
            "",
            0.8,
            1.0,
            "ask for lower frequencies, or make the superelement anew, with a wider band in "
            "[impulse]",
            measures=(
                "the highest frequency of a mode in which the body moves, or of a response, "
                "over the band of its superelement"
            ),
        ),
    )
}
"""Criteria of linear analyses, in the order of their table."""


class LinearValidity(Validity):
    """How far a linear analysis can be trusted: `print(linear.validity())` shows it."""

    @property
    def worst(self) -> tuple[Check, ...]:
        """The worst check of each criterion that applies."""
        groups = [
            [check for check in self.checks if check.criterion is criterion]
            for criterion in LINEAR_CRITERIA.values()
        ]
        return tuple(max(group, key=Check.distance) for group in groups if group)

    def _poor(self) -> Sequence[Check]:
        order = list(LINEAR_CRITERIA)
        poor = [check for check in self.checks if check.verdict == "poor"]
        return sorted(poor, key=lambda c: (order.index(c.criterion.name), -c.distance()))


def validity_of(
    form: FirstOrder | None, pose: Pose, modes: LinearModes | None, highest: float
) -> LinearValidity:
    """The validity of a pose, of modes that were found, and of responses up to a frequency [Hz]."""
    checks: list[Check] = []
    for e, (name, body) in enumerate(pose.lowered.model.flexible_bodies.items()):
        frequency = highest
        if form is not None and modes is not None:
            frequency = max(highest, _highest(form, modes, e))
        checks += _of_deformation(pose, e, body)
        for criterion, value in _of_body(pose, e, body, frequency):
            checks.append(Check(LINEAR_CRITERIA[criterion], name, value))
    return LinearValidity((*checks, *_of_contacts(pose)))


def _of_deformation(pose: Pose, e: int, body: FlexibleBody) -> Iterator[Check]:
    """The elastic motion of each interface in the equilibrium."""
    elastic, frames, u = pose.system.elastic, pose.system.frames, pose.state.interfaces.u
    order = "second_order" if _is_stiffened(body) else "elastic"
    for f in np.flatnonzero(frames.dof >= 0).tolist():
        if elastic.of_body[frames.body[f]] != e:
            continue
        dof, name = int(frames.dof[f]), pose.lowered.frame_names[f]
        moved = float(np.linalg.norm(u[dof : dof + 3])) / float(elastic.size[e])
        yield Check(LINEAR_CRITERIA[f"{order}_displacement"], name, moved)
        if frames.rotations[f]:
            turned = float(np.linalg.norm(u[dof + 3 : dof + 6]))
            yield Check(LINEAR_CRITERIA[f"{order}_rotation"], name, turned)


def _of_body(pose: Pose, e: int, body: FlexibleBody, highest: float) -> Iterator[tuple[str, float]]:
    kernel, modes = body.superelement.kernel, body.superelement.modes
    spin = pose.speed * abs(float(pose.ratios[pose.system.elastic.body[e]]))
    yield "test_misfit" if body.superelement.provenance.tested else "kernel_error", kernel.error
    if highest > 0.0:
        band = body.superelement.band
        if np.isfinite(band):
            yield "linear_band", highest / band
    if modes is None or not len(modes.omega):
        return
    omega = np.sort(modes.omega)
    rotation = body.rotation
    if rotation is None or not _is_stiffened(body):
        yield "axial_preload", _axial_load(pose, e)
        if spin > 0.0:
            yield "linear_spin", spin / float(omega[0])
    elif spin > 0.0:
        top = omega[max(rotation.n_low, 1) - 1]
        yield "second_order_spin", spin / float(np.sqrt(omega[0] * top))


def _of_contacts(pose: Pose) -> Iterator[Check]:
    """The contacts that are closed in the equilibrium."""
    subjects, system, work = Subjects(pose.lowered), pose.system, pose.work
    couplings, elastic = system.couplings, system.elastic
    closed = work.couplings.status[subjects.contacts] != 0
    for k in subjects.carried[closed[subjects.carried]].tolist():
        j = int(subjects.contacts[k])
        i = int(couplings.range[j])
        body = system.frames.body[couplings.rows.frame_a[i]]
        arm = float(np.linalg.norm(contact_arm(couplings.rows, i, work)))
        arm /= float(elastic.size[elastic.of_body[body]])
        yield Check(CRITERIA["contact_arm"], pose.lowered.coupling_names[j], arm)
    for k, patch in zip(subjects.hertzian.tolist(), subjects.patches.tolist(), strict=True):
        j = int(subjects.contacts[k])
        if closed[k]:
            depth = -float(work.couplings.coordinate[couplings.range[j]])
            size = patch * float(np.sqrt(max(depth, 0.0)))
            yield Check(CRITERIA["hertz_radius"], pose.lowered.coupling_names[j], size)


def _is_stiffened(body: FlexibleBody) -> bool:
    return body.rotation is not None and bool(body.rotation.stiffens)


def _axial_load(pose: Pose, e: int) -> float:
    """The largest axial force of a body over its Euler load, as runs have it (step/axial.py)."""
    own = np.flatnonzero(pose.system.elastic.axial.body == e).tolist()
    return max((abs(axial_force(pose.system, i, pose.state)) for i in own), default=np.nan)


def _highest(form: FirstOrder, modes: LinearModes, e: int) -> float:
    """The highest frequency [Hz] of modes in which a body takes part."""
    first = form.equations.sizes.n_r + sum(body.m for body in form.bodies[:e])
    own: Array = (np.abs(modes.y[first : first + form.bodies[e].m]) ** 2).sum(axis=0)
    whole: Any = (np.abs(form.coordinates @ modes.y) ** 2).sum(axis=0)
    return float(modes.frequencies[own > MIN_INERTIA_SHARE * whole].max(initial=0.0))
