"""A model at t = 0 with the records of one step at a time, for what takes its steps itself."""

from collections.abc import Sequence

import numpy as np

from ..files.blas import one_blas_thread
from .cosimulation.start import start_beside
from .errors import ModelError, about
from .model.model import Model
from .output.columns import check_names
from .output.validity import check_range
from .signals.curves import Input
from .start.initial import initialize, lower_to_start
from .step.system import Inputs, Run


class Stepper:
    """The records of a model, before its first step is prepared.

    The end of a step prepares the next one: `inputs` are the signals of one step, which `last` does
    not follow with another; `first` prepares without a step. Of steps of two sizes none is
    prepared, as the next one may be of the other: `flight` are then the records of long steps.
    `ModelError` for a model that cannot start, and for an unknown output.
    """

    def __init__(self, model: Model, outputs: Sequence[str]) -> None:
        with about(model.path), one_blas_thread():
            lowered, source = lower_to_start(model)
            if source and lowered.system.elastic.kernels.lags.any():
                raise ModelError("start: a Simulator continues a run only with recursive history")
            check_names(lowered, outputs)
            initial = initialize(model, lowered, source)
            self.initial, self.exchange = start_beside(initial, lowered, source, recorded=True)
            self.lowered = lowered = self.initial.lowered
            check_range(lowered, self.initial.state, 0)
        self.run = Run(
            system=self.exchange.lowered.system,
            state=self.initial.state,
            work=self.initial.work,
            output=self.exchange.row,
        )
        flight = self.exchange.lowered.flight
        self.flight = None if flight is None else self.run.replace(system=flight)
        self.inputs = Inputs(
            load=np.zeros((1, len(lowered.load_signals))),
            drive=np.zeros((1, len(lowered.drives))),
            motor=np.zeros((1, len(lowered.motor_signals))),
            row=np.zeros(1, dtype=np.int64),
            ahead=int(flight is None),
        )
        self.last = self.inputs.replace(ahead=0)
        arrays = {
            name: getattr(self.inputs, name)[:0] for name in ("load", "drive", "motor", "row")
        }
        self.first = self.inputs.replace(**arrays)
        self.signals = (
            *zip(self.inputs.load[0:1].T, lowered.load_signals, strict=True),
            *zip(self.inputs.drive[0:1].T, lowered.drives, strict=True),
            *zip(self.inputs.motor[0:1].T, lowered.motor_signals, strict=True),
        )
        """all signals, each with the place (1,) of its value at the end of the step"""
        given = [signal.name for _, signal in self.signals if isinstance(signal, Input)]
        by_fmus = {name for fmu in model.fmus for name in fmu.outputs.values()}
        self.input_names = tuple(name for name in dict.fromkeys(given) if name not in by_fmus)
        """inputs that no FMU gives"""
