"""The start from the end of another run, with its elastic vibration and its past.

Bodies are taken over by name; what has no name there starts as the model gives it. Time goes on. A
change of forces, as of a joint that is no longer there, acts within the first step, as a load that
jumps does.
"""

from collections.abc import Collection, Mapping
from pathlib import Path

import numpy as np

from ...results.file import FileSource
from ..arrays import Array, Index
from ..checkpoint.file import STATE_SUFFIX, StateFile, read_state
from ..checkpoint.identity import digest_of
from ..checkpoint.layout import layout_of, take_over
from ..errors import ModelError, StateError
from ..history.dyadic import power_above
from ..lower.lower import LoweredModel
from ..model.model import Model
from ..model.settings import StartFrom
from ..step.equations import evaluate
from ..step.history import modal_energy
from ..step.system import State, Workspace
from .assembly import drive_rates
from .full_turns import continue_angles
from .jacobian import row_rates

# relative to the size of the model, or in rad; of rates relative to the fastest body
MAX_NEW_OPENING = 1e-6
TAKEN_OVER = ("bodies", "interfaces", "modes", "past", "couplings", "terms", "motors", "observers")
"""records of the state; all others begin anew"""


def predecessor(model: Model) -> StateFile | None:
    """The state from which a model starts; None where it starts as it says itself."""
    start = model.settings.start
    if not isinstance(start, StartFrom):
        return None
    path = Path(start.path)
    beside = path.with_name(path.name + STATE_SUFFIX)
    if path.exists() and not beside.exists() and path.suffix != STATE_SUFFIX:
        raise StateError(
            f"{beside}: no such file: the run saved no state: set [simulation] checkpoint"
        )
    # The path may be that of results or of a state alone.
    state = read_state(beside if beside.exists() else path)
    # Results may have been overwritten after the state was kept.
    if path.exists() and beside.exists() and FileSource(path).run != state.run:
        raise StateError(f"{path}: the results and the state beside them are of different runs")
    return state


def hand_over(lowered: LoweredModel, source: StateFile, state: State, work: Workspace) -> None:
    """Let a state go on from that of another run; `StateError` where it cannot.

    Loads and drives in `work` are those of the present time.
    """
    layout, earlier = layout_of(lowered), source.identity.layout
    _check(lowered, source)
    numbers, kept = layout.numbers(earlier), source.snapshot.arrays
    for name in TAKEN_OVER:
        take_over(f"state/{name}", getattr(state, name), kept, numbers)
    state.step[0] = source.snapshot.step
    state.in_flight[:] = kept["state/in_flight"]
    work.couplings.elapsed[0] = 0.0
    continue_angles(lowered, state, work)
    _expect_turns(numbers, state, work)
    _evaluate(lowered, state, work)
    # Again: evaluation has written over displacements and rates of the interfaces.
    take_over("state/interfaces", state.interfaces, kept, numbers)
    state.energies.modal[0] = modal_energy(lowered.system.elastic, state)
    state.energies.convolved[0] = kept["state/energies/convolved"][0]
    known = dict(zip(*(rows.tolist() for rows in numbers["n_i"]), strict=True))
    changed = source.identity.changed_joints(lowered.model)
    _check_closed(lowered, known, kept["work/couplings/phi"], changed, state, work)


def _evaluate(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Evaluate the state as it is, with the forces of springs that belong to it."""
    system, motion, scheme = lowered.system, state.interfaces, lowered.system.scheme
    work.bodies.quaternion_n[:] = state.bodies.quaternion
    change = motion.acceleration / scheme.beta_prime
    # Newmark's formulas backwards: the prediction from which the step ended where it did.
    work.interfaces.u_predicted[:] = motion.u - change
    work.interfaces.rate_predicted[:] = motion.rate - scheme.gamma_prime * change
    evaluate(system, state, work)
    # phi of a law is lambda less its force: now lambda is the force.
    state.couplings.lam[:] -= work.couplings.phi * system.couplings.compliant
    state.couplings.lam[system.couplings.laws.motors.row] = work.motors.torque
    evaluate(system, state, work)


def _expect_turns(
    numbers: Mapping[str, tuple[Index, Index]], state: State, work: Workspace
) -> None:
    """Angles of couplings that were there go on with their turns."""
    rows, terms = numbers["n_i"][0], numbers["n_terms"][0]
    work.couplings.near[rows] = state.couplings.coordinate[rows]
    work.terms.near[terms] = state.terms.coordinate[terms]


def _check(lowered: LoweredModel, source: StateFile) -> None:
    identity, step = source.identity, source.snapshot.step
    if step >= lowered.n_steps:
        raise ModelError(
            f"simulation: t_end: expected more than the time of the state, "
            f"{step * lowered.h:.9g} s, got {lowered.model.settings.t_end:.9g}"
        )
    for name, value in lowered.system.scheme.leaves():
        if identity.system.get(f"scheme/{name}") != digest_of(value):
            raise StateError(
                "simulation: start: the state was computed with another step, rho_inf or rule "
                f"({name})"
            )
    _check_bodies(lowered, source)
    first, lags = int(source.snapshot.arrays["state/past/first"][0]), identity.kernels.values()
    span = power_above(max((kernel[1] for kernel in lags), default=0))
    # Blocks of the convolution are powers of two: the state keeps loads as far as its own reach.
    own = power_above(int(lowered.system.elastic.kernels.lags.max(initial=0)))
    if first and own != span:
        raise StateError(
            "simulation: memory: expected that of the state, which has dropped older loads"
        )


def _check_bodies(lowered: LoweredModel, source: StateFile) -> None:
    identity, flexible = source.identity, lowered.model.flexible_bodies
    for name in identity.layout.n_b:
        was, now = name in identity.layout.n_e, name in flexible
        if name in lowered.model.bodies and was != now:
            raise StateError(f"body {name!r}: was {_kind(was)}, is {_kind(now)}")
        if not now and name in identity.kernels:
            raise StateError(
                f"body {name!r}: is missing from this model, so that its stored energy is unknown"
            )
    for name in flexible.keys() & identity.layout.n_e.keys():
        digest = digest_of(flexible[name].superelement)
        if identity.model[f"bodies.{name}.superelement"] != digest:
            raise StateError(
                f"body {name!r}: its superelement is not that of the state, so that the past does "
                "not apply"
            )
        if identity.model[f"bodies.{name}.second_order"] != (flexible[name].rotation is not None):
            raise StateError(
                f"body {name!r}: second_order: in use in only one of the state and this model"
            )
    identity.check_kernels(lowered, flexible.keys() & identity.layout.n_e.keys())


def _kind(flexible: bool) -> str:
    return "flexible" if flexible else "rigid"


def _check_closed(
    lowered: LoweredModel,
    known: Mapping[int, int],
    opening: Array,
    changed: Collection[str],
    state: State,
    work: Workspace,
) -> None:
    """`StateError` for a joint that is new, or another than before, and open, or that opens.

    known: rows here and there; opening: of those there, as it was; changed: joints of the same name
    that are declared otherwise, whose rates may be off by what a step changes.
    """
    couplings, size = lowered.system.couplings, lowered.system.bodies.size
    lengths = np.array([1.0, 1.0, 1.0, size, size, size])
    v, v_dot = (float((np.abs(x) * lengths).max()) for x in (state.bodies.v, state.bodies.v_dot))
    rates = row_rates(couplings, work) + drive_rates(lowered, work)
    for i in np.flatnonzero(couplings.compliant == 0).tolist():
        length = size if lowered.measures_lengths[i] else 1.0
        unit = "m" if lowered.measures_lengths[i] else "rad"
        phi, limit = float(work.couplings.phi[i]), MAX_NEW_OPENING * v
        if i in known:
            # What was open before, by rounding, may stay so: only what is new counts.
            phi, limit = phi - opening[known[i]], max(limit, lowered.h * v_dot)
        if abs(phi) > MAX_NEW_OPENING * length:
            raise StateError(
                f"{lowered.owner_of(i)}: is open by {abs(phi):.6g} {unit} in the state"
            )
        same = i in known and lowered.coupling_names[lowered.coupling_of(i)] not in changed
        if not same and abs(rates[i]) > length / size * limit:
            raise StateError(
                f"{lowered.owner_of(i)}: opens at {abs(rates[i]):.6g} {unit}/s in the state: "
                "closing it would need an impulse"
            )
