"""Signals: functions of time that loads, drives and motors follow."""

from duhamel.solver.signals.composed import Delayed, Product, Sum
from duhamel.solver.signals.curves import (
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
from duhamel.solver.signals.noise import Noise, ShapedNoise
from duhamel.solver.signals.profiles import (
    Chirp,
    HalfSine,
    Haversine,
    LogarithmicChirp,
    Sawtooth,
    SmoothStep,
    Trapezoid,
    Window,
)
from duhamel.solver.signals.recorded import Recorded, RecordedSpline

__all__ = [
    "Chirp",
    "Constant",
    "Delayed",
    "Function",
    "HalfSine",
    "Harmonic",
    "Haversine",
    "Impulse",
    "Input",
    "LogarithmicChirp",
    "Noise",
    "Polynomial",
    "Product",
    "Pulse",
    "Recorded",
    "RecordedSpline",
    "Sawtooth",
    "ShapedNoise",
    "SmoothFunction",
    "SmoothStep",
    "Spline",
    "Steps",
    "Sum",
    "Table",
    "Trapezoid",
    "Window",
]
