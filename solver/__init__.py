"""Superelements and a model to motion."""

from ..results.results import Results
from .errors import ConvergenceError, ModelError, RecoveryError, ResultsError
from .model.file import read_model
from .model.joints import Joint
from .model.model import FlexibleBody, Frame, Load, Model, Place, RigidBody, Start, SteadyRotation
from .model.motions import PrescribedDisplacement, PrescribedRotation
from .model.output_request import OutputRequest
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
from .model.springs import Law, Spring
from .simulation import simulate, start
from .simulator import Simulator

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
    "start",
]
