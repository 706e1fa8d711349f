"""Superelements and a model to motion."""

from .errors import ConvergenceError, ModelError, RecoveryError, ResultsError
from .joints import Joint
from .model import FlexibleBody, Frame, Load, Model, Place, RigidBody, Start, SteadyRotation
from .model_file import read_model
from .motions import PrescribedDisplacement, PrescribedRotation
from .output_request import OutputRequest
from .results import Results
from .signals import (
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
from .simulation import simulate
from .simulator import Simulator
from .springs import Law, Spring

__all__ = [
    "Constant",
    "ConvergenceError",
    "FlexibleBody",
    "Frame",
    "Function",
    "Harmonic",
    "Impulse",
    "Input",
    "Joint",
    "Law",
    "Load",
    "Model",
    "ModelError",
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
    "Simulator",
    "SmoothFunction",
    "Spline",
    "Spring",
    "Start",
    "SteadyRotation",
    "Steps",
    "Table",
    "read_model",
    "simulate",
]
