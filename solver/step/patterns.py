"""Load patterns: loads that are spread over flexible bodies, in body axes.

A pattern of the amplitude s acts on the rigid motion of its body by its resultants, s R F and s M,
which turn with it, and on the elastic one as a load s on a dof of its own, of which the
displacement is no unknown: it joins the displacements of the active dofs, history + w G_0 p, with
the columns of that dof. The resultants are those of the undeformed body.
"""

from ..compiler.marks import compiled
from ..compiler.memory import copy
from .records.elastic import Elastic
from .records.loads import LoadPatterns
from .records.scheme import Scheme
from .rotations import relative_rotation
from .system import State, System, Workspace
from .vectors import UNIT_AXES, cross, magnitude, rotate, row, scale


@compiled
def load_patterns(patterns: LoadPatterns, state: State, work: Workspace) -> None:
    """Generalized forces of the patterns on bodies, which frames have loaded, and on their dofs."""
    p, force = state.interfaces.p, work.bodies.force
    for t in range(len(patterns.body)):
        p[patterns.dof[t]] = 0.0
    for t in range(len(patterns.body)):
        b, amplitude = patterns.body[t], work.loads.value[patterns.signal[t]]
        # Two loads may use one pattern, so they add up after all are cleared.
        p[patterns.dof[t]] += amplitude
        resultant = rotate(state.bodies.R, b, scale(amplitude, row(patterns.force, t)))
        for i in range(3):
            force[b, i] += resultant[i]
            force[b, 3 + i] += amplitude * patterns.moment[t, i]


@compiled
def add_pattern_displacements(
    elastic: Elastic, scheme: Scheme, patterns: LoadPatterns, work: Workspace
) -> None:
    """residual += w G_0 p of the patterns, at the active dofs of their bodies."""
    for t in range(len(patterns.body)):
        amplitude = scheme.weight * work.loads.value[patterns.signal[t]]
        e = elastic.of_body[patterns.body[t]]
        first, n = elastic.dof[e], elastic.dof[e + 1] - elastic.dof[e]
        start = elastic.G_0_start[e] + patterns.dof[t] - first
        for i in range(elastic.active_range[e], elastic.active_range[e + 1]):
            entry = start + (elastic.active[i] - first) * n
            work.interfaces.residual[i] += elastic.G_0[entry] * amplitude


@compiled
def add_pattern_tangents(system: System, work: Workspace) -> None:
    """K += e_j x F: the resultants turn with their bodies."""
    patterns, block = system.patterns, system.pattern.body_block
    for t in range(len(patterns.body)):
        b = patterns.body[t]
        start, stride = block[b, 0], block[b, 1]
        F = scale(work.loads.value[patterns.signal[t]], row(patterns.force, t))
        for j in range(3):
            turned = cross(UNIT_AXES[j], F)
            for i in range(3):
                work.matrix.S[start + i * stride + 3 + j] += turned[i]


@compiled
def add_pattern_scales(patterns: LoadPatterns, work: Workspace) -> None:
    """The resultants join the force scales of the bodies."""
    for t in range(len(patterns.body)):
        b, amplitude = patterns.body[t], abs(work.loads.value[patterns.signal[t]])
        work.bodies.force_scale[b, 0] += amplitude * magnitude(row(patterns.force, t))
        work.bodies.force_scale[b, 1] += amplitude * magnitude(row(patterns.moment, t))


@compiled
def add_pattern_work(patterns: LoadPatterns, state: State, work: Workspace) -> None:
    """Trapezoidal means of resultants times motions of the body, and of s dy of the elastic one.

    The latter is what `add_elastic_work` counts, so that both meet in the balance.
    """
    old, motion = state.patterns, work.loads.motion
    u, u_n = state.interfaces.u, work.interfaces.u_n
    for t in range(len(patterns.body)):
        b, k, amplitude = patterns.body[t], patterns.dof[t], work.loads.value[patterns.signal[t]]
        total = 0.5 * (amplitude + old.value[t]) * (u[k] - u_n[k] - work.second.bend[k])
        force = rotate(state.bodies.R, b, scale(amplitude, row(patterns.force, t)))
        moment = rotate(state.bodies.R, b, scale(amplitude, row(patterns.moment, t)))
        relative_rotation(old.axes[t], state.bodies.R[b], motion)
        for i in range(3):
            path = state.bodies.x[b, i] - old.position[t, i]
            total += 0.5 * (force[i] + old.wrench[t, i]) * path
            total += 0.5 * (moment[i] + old.wrench[t, 3 + i]) * motion[i]
        state.energies.work[0] += total
        keep_pattern(patterns, t, state, work)


@compiled
def keep_pattern(patterns: LoadPatterns, t: int, state: State, work: Workspace) -> None:
    """The load and the place of pattern t, from which its next work is counted."""
    old, b, amplitude = state.patterns, patterns.body[t], work.loads.value[patterns.signal[t]]
    force = rotate(state.bodies.R, b, scale(amplitude, row(patterns.force, t)))
    moment = rotate(state.bodies.R, b, scale(amplitude, row(patterns.moment, t)))
    old.value[t] = amplitude
    copy(state.bodies.x[b], old.position[t])
    copy(state.bodies.R[b], old.axes[t])
    for i in range(3):
        old.wrench[t, i] = force[i]
        old.wrench[t, 3 + i] = moment[i]
