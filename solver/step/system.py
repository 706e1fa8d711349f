"""What the time loop reads and writes: data (`System`), state (`State`), scratch (`Workspace`).

They nest the records of all contributors, which stand in records/. `Inputs` are the signals of the
next steps, `Output` the rows of results, and `Run` is all but the inputs.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.motion import output_fields
from ..arrays import Array, Index
from ..compiler.struct import ArrayField, Struct, array
from .records.bodies import Bodies, BodyState, BodyWork
from .records.contacts import ContactState
from .records.couplings import (
    Couplings,
    CouplingState,
    CouplingWork,
    DriveState,
    DriveWork,
    ObserverState,
    ObserverWork,
    Rows,
    TermState,
    TermWork,
)
from .records.elastic import (
    Elastic,
    InterfaceState,
    InterfaceWork,
    ModalState,
    ModalWork,
    PastState,
    SecondOrderWork,
    Sensors,
)
from .records.extremes import EnergyState, ExtremeState
from .records.frames import Frames, FrameWork
from .records.laws import MotorState, MotorWork
from .records.loads import LoadPatterns, Loads, LoadState, LoadWork, PatternState
from .records.matrix import MatrixWork, Pattern
from .records.scheme import Newton, Scheme
from .records.surfaces import Surfaces, SurfaceState, SurfaceWork


class System(Struct):
    """The data of a model, which do not change in a run."""

    scheme: Scheme
    newton: Newton
    bodies: Bodies
    frames: Frames
    couplings: Couplings
    observers: Rows
    """joint coordinates that are only observed"""
    loads: Loads
    patterns: LoadPatterns
    sensors: Sensors
    elastic: Elastic
    surfaces: Surfaces
    pattern: Pattern


class State(Struct):
    """What a step takes from the one before."""

    step: Index = array(1)
    """time in units of the shortest step"""
    taken: Index = array(1)
    """number of steps taken, of any size"""
    recorded: Index = array(1)
    """number of rows recorded, without the first, and without a last one that is recorded only
    because it is the last"""
    in_flight: Index = array(1)
    """1: pseudo-accelerations are those of the longest step"""
    prepared: Index = array(1)
    """1: the next step is prepared, as far as it does not depend on its inputs"""
    bodies: BodyState
    interfaces: InterfaceState
    modes: ModalState
    past: PastState
    couplings: CouplingState
    terms: TermState
    contacts: ContactState
    surfaces: SurfaceState
    observers: ObserverState
    loads: LoadState
    patterns: PatternState
    drives: DriveState
    motors: MotorState
    energies: EnergyState
    extremes: ExtremeState


class Workspace(Struct):
    """Scratch of a step."""

    bodies: BodyWork
    frames: FrameWork
    interfaces: InterfaceWork
    second: SecondOrderWork
    modes: ModalWork
    couplings: CouplingWork
    terms: TermWork
    surfaces: SurfaceWork
    observers: ObserverWork
    loads: LoadWork
    drives: DriveWork
    motors: MotorWork
    matrix: MatrixWork


class Inputs(Struct):
    """Signals at the ends of the next n steps, and the rows of the output that record them."""

    load: Array = array("n", "n_y")
    """signals of loads on frames, then of load patterns"""
    drive: Array = array("n", "n_d")
    """signals of drives"""
    motor: Array = array("n", "n_motor_signals")
    """signals of motors, three of each (`MotorWork.value`)"""
    row: Index = array("n")
    """row of the output that records the step, -1: none"""
    ahead: int
    """1: prepare the step after them"""


DIMENSIONS_OF_RESULTS: dict[str, int | str] = {
    "time": "n",
    "axis": 3,
    "quaternion": 4,
    "body": "n_b",
    "frame": "n_f",
    "second_order_coordinate": "n_s",
    "coupling": "n_j",
    "row": "n_i",
    "joint_coordinate": "n_o",
    "contact": "n_k",
    "contact_axis": 3,
    "tangent_axis": 2,
    "joint_with_friction": "n_r",
    "pattern": "n_g",
    "sensor_channel": "n_z",
    "motor": "n_motors",
    "fmu_input": "n_fmu_inputs",
    "surface_contact": "n_contacts",
    "surface_row": "n_kept_rows",
    "surface_node": "n_kept_nodes",
    "mode": "n_kept_modes",
    "surface_load": "n_kept_loads",
}
"""dimensions of results as dimensions of a step"""


def _output_fields() -> dict[str, ArrayField]:
    return {
        name: ArrayField(
            tuple(DIMENSIONS_OF_RESULTS[dimension] for dimension in dimensions),
            np.int64 if integer else np.float64,
        )
        for name, (dimensions, integer) in output_fields().items()
    }


class Output(Struct, fields=_output_fields()):
    """The quantities of steps, one row per step: those of the records in results/motion.py."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...


class Run(Struct):
    """All that the time loop reads and writes, but for its inputs."""

    system: System
    state: State
    work: Workspace
    output: Output
