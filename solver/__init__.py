"""Dynamics of mechanisms of rigid bodies and superelements."""

from ..results.results import Results
from .checkpoint.moment import Moment
from .errors import (
    ConvergenceError,
    ModelError,
    OutOfRangeError,
    RecoveryError,
    ResultsError,
    StateError,
    ValidityWarning,
)
from .inspection import ModelCheck, check
from .laws.law import ForceLaw
from .laws.tabulated import TabulatedLaw
from .model.bodies import FlexibleBody, Frame, Place, RigidBody, Start
from .model.contacts import Contact, ForceTable, Hertz, Impact, Stop
from .model.file import read_model, write_model
from .model.friction import Coulomb, JointFriction, Stribeck
from .model.joints import Joint
from .model.loads import Load
from .model.model import Model
from .model.motions import PrescribedDisplacement, PrescribedRotation
from .model.output_request import OutputRequest
from .model.settings import Settings, StartFrom, SteadyRotation
from .model.signals import (
    Constant,
    Function,
    Harmonic,
    Impulse,
    Input,
    Polynomial,
    Pulse,
    SmoothFunction,
    Spline,
    Steps,
    Table,
)
from .model.springs import Spring
from .simulation import simulate, start
from .simulator import Simulator

__all__ = [
    "Constant",
    "Contact",
    "ConvergenceError",
    "Coulomb",
    "FlexibleBody",
    "ForceLaw",
    "ForceTable",
    "Frame",
    "Function",
    "Harmonic",
    "Hertz",
    "Impact",
    "Impulse",
    "Input",
    "Joint",
    "JointFriction",
    "Load",
    "Model",
    "ModelCheck",
    "ModelError",
    "Moment",
    "OutOfRangeError",
    "OutputRequest",
    "Place",
    "Polynomial",
    "PrescribedDisplacement",
    "PrescribedRotation",
    "Pulse",
    "RecoveryError",
    "Results",
    "ResultsError",
    "RigidBody",
    "Settings",
    "Simulator",
    "SmoothFunction",
    "Spline",
    "Spring",
    "Start",
    "StartFrom",
    "StateError",
    "SteadyRotation",
    "Steps",
    "Stop",
    "Stribeck",
    "Table",
    "TabulatedLaw",
    "ValidityWarning",
    "check",
    "read_model",
    "simulate",
    "start",
    "write_model",
]
