"""An FMU that is loaded: its calls, by FMI 2 or 3, its log, and its end."""

import ctypes
import os
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ..arrays import Array, Index
from ..errors import ModelError
from .description import REAL_TYPES, WHOLE_TYPES, Description, FMUVariable
from .fmpy import fmpy

LOG_LINES, LOG_LINE_LENGTH = 5, 300
"""of the log of an FMU, at the end of a message"""
FATAL_STATUS = 4
"""the status after which no function of the FMU may be called"""


class FMUInstance:
    """A loaded FMU, from before its initialization to its end, `close`.

    All calls raise `ModelError` with the time and the last lines of the log of the FMU.
    """

    def __init__(self, description: Description) -> None:
        self.description, self.fmu = description, description.fmu
        self._log: deque[str] = deque(maxlen=LOG_LINES)
        self._runs, self._failed = False, 0
        self._loaded: Any = None
        self.time = 0.0
        # One folder each: two instances of one file must not share the variables of a library.
        self._folder = TemporaryDirectory(prefix="duhamel-fmu-", ignore_cleanup_errors=True)
        try:
            with self._calls("cannot be loaded"):
                self._load()
            with self._calls("refuses a parameter"):
                self._set_parameters()
        except BaseException:
            self.close()
            raise

    def start(self, t: float, inputs: Array) -> None:
        """Initialize at time t with the inputs (n,)."""
        self.time, loaded = t, self._loaded
        with self._calls("cannot be initialized"):
            if self.description.version == 2:
                loaded.setupExperiment(startTime=t)
                loaded.enterInitializationMode()
            else:
                loaded.enterInitializationMode(startTime=t)
            self._set_inputs(inputs)
            loaded.exitInitializationMode()
            self._runs = True

    def step(self, t: float, h: float, inputs: Array) -> Array:
        """Step from t to t + h with the inputs (n,) at t; the outputs (n,) at the end."""
        self.time = t
        with self._calls("fails in its step"):
            self._set_inputs(inputs)
            told = self._loaded.doStep(t, h, not self.description.saves)
            if told is not None:
                _check_step(*told)
        self.time = t + h
        return self.outputs()

    def outputs(self) -> Array:
        """The outputs (n,) at the present time."""
        # Checked here: Newton's method would fail with no word of the FMU.
        with self._calls("cannot give its outputs"):
            values = self._get(self.description.outputs)
        if not np.isfinite(values).all():
            first = int(np.flatnonzero(~np.isfinite(values))[0])
            name = self.description.outputs[first].name
            raise self._error(f"gives {values[first]:g} as {name}: expected a number")
        return values

    def derivative(self, output: str, inputs: Sequence[str]) -> Array:
        """Derivatives of an output by inputs (n,) at the present time."""
        (y,) = (one for one in self.description.outputs if one.name == output)
        found = []
        with self._calls("cannot give its derivatives"):
            for name in inputs:
                (u,) = (one for one in self.description.inputs if one.name == name)
                found += self._loaded.getDirectionalDerivative([y.reference], [u.reference], [1.0])
        return np.array(found, dtype=np.float64)

    @contextmanager
    def saved(self) -> Iterator[Any]:
        """The present state, for `restore`, until the block ends."""
        with self._calls("cannot save its state"):
            state = self._loaded.getFMUState()
        try:
            yield state
        finally:
            with suppress(Exception):
                self._loaded.freeFMUState(state)

    def restore(self, state: Any) -> None:
        with self._calls("cannot restore its state"):
            self._loaded.setFMUState(state)

    def serialized(self) -> Index:
        """The present state as whole numbers (n,): its length in bytes, and these in eights."""
        with self.saved() as state, self._calls("cannot serialize its state"):
            content = self._loaded.serializeFMUState(state)
        padded = content + bytes(-len(content) % 8)
        return np.concatenate([[len(content)], np.frombuffer(padded, dtype=np.int64)])

    def deserialize(self, numbers: Index) -> None:
        """Go on from a state as `serialized` gave it."""
        content = numbers[1:].tobytes()[: int(numbers[0])]
        with self._calls("cannot read its state"):
            state = self._loaded.deserializeFMUState(content)
            self._loaded.setFMUState(state)
            self._loaded.freeFMUState(state)

    def close(self) -> None:
        """End the FMU and remove its folder; a second call does nothing."""
        loaded, self._loaded = self._loaded, None
        # Each by itself: an FMU that has failed may refuse any of them.
        if loaded is not None and loaded.component and self._failed != FATAL_STATUS:
            if self._runs and not self._failed:
                with suppress(Exception):
                    loaded.terminate()
            with suppress(Exception):
                loaded.freeInstance()
        self._folder.cleanup()

    def _load(self) -> None:
        description, file = self.description, self.fmu.file
        fmpy(self.fmu).extract(file, self._folder.name)
        calls = fmpy(self.fmu, f"fmi{description.version}")
        make = calls.FMU2Slave if description.version == 2 else calls.FMU3Slave
        place = os.getcwd()
        try:
            loaded = make(
                guid=description.token,
                modelIdentifier=description.identifier,
                unzipDirectory=self._folder.name,
                instanceName=self.fmu.name,
            )
        finally:
            # FMPy stays in the folder of a library that cannot be loaded.
            os.chdir(place)
        self._loaded = loaded
        if description.version == 2:
            loaded.instantiate(callbacks=self._callbacks_of_fmi_2(calls), loggingOn=True)
        else:
            loaded.instantiate(logMessage=self._note, loggingOn=True)

    def _callbacks_of_fmi_2(self, calls: Any) -> Any:
        callbacks = calls.fmi2CallbackFunctions()
        callbacks.logger = calls.fmi2CallbackLoggerTYPE(
            lambda _, name, status, category, message: self._note(None, status, category, message)
        )
        callbacks.allocateMemory = calls.fmi2CallbackAllocateMemoryTYPE(calls.calloc)
        callbacks.freeMemory = calls.fmi2CallbackFreeMemoryTYPE(calls.free)
        # FMI 2 logs as printf does, with arguments that only C can read.
        with suppress(Exception):
            fmpy(self.fmu, "logging").addLoggerProxy(ctypes.byref(callbacks))
        return callbacks

    def _note(self, _: Any, status: int, category: bytes | None, message: bytes | None) -> None:
        text = (message or b"").decode("utf-8", errors="replace").strip()
        # What an FMU tells of its normal work would hide what went wrong.
        if text and status > 0:
            self._log.append(" ".join(text.split())[:LOG_LINE_LENGTH])

    def _set_parameters(self) -> None:
        for variable, start in self.description.parameters:
            kind = variable.type
            if kind == "Enumeration":
                kind = "Integer" if self.description.version == 2 else "Int64"
            value = float(start) if kind in REAL_TYPES else start
            value = int(start) if kind in WHOLE_TYPES else value
            getattr(self._loaded, f"set{kind}")([variable.reference], [value])

    def _set_inputs(self, values: Array) -> None:
        for kind, numbers, references in _by_type(self.description.inputs):
            getattr(self._loaded, f"set{kind}")(references, values[numbers].tolist())

    def _get(self, variables: Sequence[FMUVariable]) -> Array:
        values = np.zeros(len(variables))
        for kind, numbers, references in _by_type(variables):
            values[numbers] = getattr(self._loaded, f"get{kind}")(references)
        return values

    @contextmanager
    def _calls(self, what: str) -> Iterator[None]:
        """Let errors of calls name the FMU, the time, and what it logged."""
        self._log.clear()
        try:
            yield
        except Exception as error:  # of any kind: FMPy raises plain ones
            self._failed = int(getattr(error, "status", 0)) or 1
            raise self._error(f"{what}: {error}") from error

    def _error(self, message: str) -> ModelError:
        log = f"; its log: {' | '.join(self._log)}" if self._log else ""
        return self.fmu.error(f"at t = {self.time:.9g} s it {message.rstrip('.')}{log}")


def _check_step(event: bool, ends: bool, early: bool, reached: float) -> None:
    """ModelError for a step of FMI 3 that was not taken whole; FMI 2 tells by its status alone."""
    if ends:
        raise ModelError("it asks to end the simulation")
    if early:
        raise ModelError(f"it returned early, at t = {reached:.9g} s")


def _by_type(variables: Sequence[FMUVariable]) -> Iterator[tuple[str, list[int], list[int]]]:
    """Type, places and references of the variables of each type."""
    for kind in dict.fromkeys(one.type for one in variables):
        chosen = [(i, one.reference) for i, one in enumerate(variables) if one.type == kind]
        yield kind, [i for i, _ in chosen], [reference for _, reference in chosen]
