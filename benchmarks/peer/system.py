"""Exudyn as it is run here: one thread, generalized-alpha, modified Newton."""

from typing import Any

import exudyn
import numpy as np

from tests.validation.exudyn_beam import settings

from .run import Run, Stopwatch

TIGHT = 1e-13
"""a tolerance near the least with which Newton's increments still converge"""


class System:
    """A system of Exudyn to be filled, assembled and marched; what a run stores is the position of
    its tip.

    tolerance of Newton's increments; the iteration matrix is kept while it contracts. Factors are
    dense, which is faster for one body of few unknowns, or sparse.
    """

    def __init__(self, step: float, tolerance: float, dense: bool = False) -> None:
        self._container = exudyn.SystemContainer()  # owns the system, and has to outlive it
        self.items = self._container.AddSystem()
        self._step = step
        self.settings = settings()
        newton = self.settings.timeIntegration.newton
        newton.relativeTolerance = newton.absoluteTolerance = tolerance
        if dense:
            self.settings.linearSolver.solverType = exudyn.LinearSolverType.EXUdense
        self._stopwatch, self._iterations = Stopwatch(), 0
        self._times, self._tips, self._tip = [np.zeros(1)], [], None

    def watch(self, sensor: type, **where: Any) -> None:
        """Where the tip is."""
        position = exudyn.OutputVariableType.Position
        self._tip = self.items.AddSensor(
            sensor(outputVariableType=position, storeInternal=True, writeToFile=False, **where)
        )

    def march(self, end: float) -> None:
        """Advance to the time `end` [s] by equal steps, none longer than the step."""
        integration, start = self.settings.timeIntegration, self._times[-1][-1]
        steps = int(np.ceil((end - start) / self._step - 1e-9))
        integration.startTime, integration.endTime, integration.numberOfSteps = start, end, steps
        with self._stopwatch.running():
            self.items.SolveDynamic(self.settings, updateInitialValues=True)
        self._iterations += self.items.sys["dynamicSolver"].it.newtonStepsCount
        self._times.append(np.linspace(start, end, steps + 1)[1:])
        # Every march stores its initial state too, which is the end of the one before.
        self._tips.append(
            np.asarray(self.items.GetSensorStoredData(self._tip))[1 if self._tips else 0 :, 1:]
        )

    def run(self) -> Run:
        """What the marches found."""
        time, tip = np.concatenate(self._times), np.concatenate(self._tips)
        steps = len(time) - 1
        seconds = (self._stopwatch.cpu, self._stopwatch.wall)
        return Run(*(1e6 * s / steps for s in seconds), self._iterations / steps, time, tip)
