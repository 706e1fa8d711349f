"""A trial of the first steps of a model: what they take, how valid they are, and why if not."""

import time
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..results.validity import Validity
from .cosimulation.exchange import Exchange
from .cosimulation.start import start_beside
from .history.cost import history_costs
from .lower.lower import LoweredModel
from .model.model import Model
from .output.validity import ValidityMonitor
from .output.writer import make_writer
from .simulation import PreparedRun, integrate
from .start.initial import InitialState, initialize

TRIAL_STEPS = 128
OF_VIBRATION = ("steps_per_period", "kernel_band")
"""criteria that a vibration by gravity's sudden start may pass alone"""
SUDDEN_GRAVITY = (
    "gravity acts suddenly at t = 0 and excites it, which start = 'equilibrium' in [simulation] "
    "avoids; else, "
)


class TrialRun(NamedTuple):
    """A trial of the first steps: their number, the estimated time of the run [s], validity."""

    steps: int
    seconds: float
    validity: Validity


def take_trial(initial: InitialState, exchange: Exchange) -> TrialRun:
    """Take the first steps. The time is theirs, with the growth of the history."""
    lowered, monitor = initial.lowered, ValidityMonitor(initial.lowered)
    begin = int(initial.state.step[0])
    # Counted in short steps, of which a long one has `ratio`.
    n = min(TRIAL_STEPS * lowered.ratio, lowered.n_steps - begin)
    if n == 0:
        return TrialRun(0, 0.0, monitor.validity(initial.state, 0))
    writer = make_writer(None, initial, n, monitor)
    started = time.perf_counter()
    integrate(
        PreparedRun(
            *(initial.lowered, initial.state, initial.work, initial.removed),
            *(exchange, monitor, writer, begin + n),
        )
    )
    measured = (time.perf_counter() - started) / n
    seconds = (lowered.n_steps - begin) * (measured + 1e-9 * _history_cost(lowered))
    return TrialRun(n // lowered.ratio, seconds, monitor.validity(initial.state, n))


def with_cause(model: Model, initial: InitialState, found: Validity) -> Validity:
    """The validity of a trial, with the cause of vibrations that a trial without gravity lacks."""
    poor = _poor_vibrations(found)
    met = initial.state.extremes.depth.any() or initial.state.contacts.total_impulse.any()
    # A body that falls on another one vibrates by gravity too, but not by its sudden start.
    if not poor or met or model.surface_contacts or model.fmus or model.settings.start != "given":
        return found
    if not model.gravity.any():
        return found
    floating = initialize(replace(model, gravity=np.zeros(3)))
    floating, exchange = start_beside(floating, floating.lowered, None)
    poor -= _poor_vibrations(take_trial(floating, exchange).validity)
    checks = (
        check._replace(cause=SUDDEN_GRAVITY)
        if (check.criterion.name, check.owner) in poor
        else check
        for check in found.checks
    )
    return Validity(tuple(checks))


def _poor_vibrations(validity: Validity) -> set[tuple[str, str]]:
    """Checks of vibrations beyond their limits, by criterion and owner."""
    poor = (check for check in validity.checks if check.verdict == "poor")
    return {(c.criterion.name, c.owner) for c in poor if c.criterion.name in OF_VIBRATION}


def _history_cost(lowered: LoweredModel) -> float:
    """Nanoseconds per step of sums over the past, which the first steps do not have yet."""
    elastic = lowered.system.elastic
    cost = 0.0
    for e in np.flatnonzero(elastic.kernels.lags).tolist():
        n_c, lags = int(elastic.dof[e + 1] - elastic.dof[e]), int(elastic.kernels.lags[e])
        n_active = int(elastic.loaded_range[e + 1] - elastic.loaded_range[e])
        costs = history_costs(n_c, n_active, None, lowered.n_steps, lags)
        cost += costs["fft" if elastic.kernels.by_fft[e] else "direct"]
    return cost
