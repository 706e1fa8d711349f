"""Dynamics of mechanisms of rigid bodies and superelements."""

from typing import TYPE_CHECKING

from ..files.lazy import lazily_loaded

if TYPE_CHECKING:
    from ..results.results import Results
    from .checkpoint.saved_state import Moment as Moment
    from .checkpoint.saved_state import SavedState
    from .couplings.bearings import Bearing
    from .couplings.contacts import Contact, Hertz
    from .couplings.couplers import Coupler
    from .couplings.friction import Coulomb, JointFriction, Stribeck
    from .couplings.impact import ForceTable, Impact
    from .couplings.joint import Joint
    from .couplings.joints import (
        JOINTS,
        ConstantVelocity,
        Cylindrical,
        Fixed,
        Planar,
        PointOnLine,
        PointOnPlane,
        Prismatic,
        Revolute,
        Rod,
        RollingDisc,
        Screw,
        Spherical,
        Universal,
    )
    from .couplings.motions import PrescribedDisplacement, PrescribedOrientation, PrescribedRotation
    from .couplings.motors import Motor
    from .couplings.springs import Spring
    from .couplings.stops import Stop
    from .couplings.surface_contacts import SurfaceContact
    from .errors import (
        ConvergenceError,
        MissedContactError,
        ModelError,
        OutOfRangeError,
        RecoveryError,
        ResultsError,
        StateError,
        ValidityWarning,
    )
    from .inspection import ModelCheck, check, given_moduli
    from .laws.bouc_wen import BoucWenLaw
    from .laws.check import check_law
    from .laws.dampers import DamperLaw, TabulatedDamperLaw
    from .laws.elastoplastic import ElastoplasticLaw
    from .laws.iwan import IwanLaw
    from .laws.law import ForceLaw
    from .laws.maxwell import MaxwellLaw
    from .laws.one_sided import OneSidedLaw
    from .laws.tabulated import TabulatedLaw
    from .laws.user import UserLaw
    from .linear.campbell import Campbell, campbell
    from .linear.floquet import Floquet, floquet
    from .linear.frf import FrequencyResponse
    from .linear.linearize import LinearModel, linearize
    from .linear.modes import LinearModes
    from .linear.rotors import rotor_at
    from .linear.stability import StabilityMap, stability_map
    from .linear.state_space import StateSpace
    from .linear.unbalance import UnbalanceResponse, unbalance_response
    from .many import simulate_many
    from .model.bodies import FlexibleBody, Frame, Place, RigidBody, RigidSuperelement, Start
    from .model.body_shapes import Box, Cylinder, Sphere, Surface
    from .model.file import model_schema, read_model, write_model
    from .model.fmus import FMU
    from .model.loads import LOADS, Drag, Force, Load, PatternLoad, Torque
    from .model.model import Model
    from .model.output_request import OutputRequest
    from .model.settings import Settings, StartFrom, SteadyRotation
    from .plausibility import Doubt as Doubt
    from .plausibility import Implausible, plausibility_warnings
    from .plausibility import doubts as doubts
    from .signals.composed import Delayed, Product, Sum
    from .signals.curves import (
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
    from .signals.noise import Noise, ShapedNoise
    from .signals.profiles import (
        Chirp,
        HalfSine,
        Haversine,
        LogarithmicChirp,
        Sawtooth,
        SmoothStep,
        Trapezoid,
        Window,
    )
    from .signals.recorded import Recorded, RecordedSpline
    from .simulation import simulate, start
    from .simulator import Simulator

__all__ = [
    "FMU",
    "JOINTS",
    "LOADS",
    "Bearing",
    "BoucWenLaw",
    "Box",
    "Campbell",
    "Chirp",
    "Constant",
    "ConstantVelocity",
    "Contact",
    "ConvergenceError",
    "Coulomb",
    "Coupler",
    "Cylinder",
    "Cylindrical",
    "DamperLaw",
    "Delayed",
    "Drag",
    "ElastoplasticLaw",
    "Fixed",
    "FlexibleBody",
    "Floquet",
    "Force",
    "ForceLaw",
    "ForceTable",
    "Frame",
    "FrequencyResponse",
    "Function",
    "HalfSine",
    "Harmonic",
    "Haversine",
    "Hertz",
    "Impact",
    "Implausible",
    "Impulse",
    "Input",
    "IwanLaw",
    "Joint",
    "JointFriction",
    "LinearModel",
    "LinearModes",
    "Load",
    "LogarithmicChirp",
    "MaxwellLaw",
    "MissedContactError",
    "Model",
    "ModelCheck",
    "ModelError",
    "Motor",
    "Noise",
    "OneSidedLaw",
    "OutOfRangeError",
    "OutputRequest",
    "PatternLoad",
    "Place",
    "Planar",
    "PointOnLine",
    "PointOnPlane",
    "Polynomial",
    "PrescribedDisplacement",
    "PrescribedOrientation",
    "PrescribedRotation",
    "Prismatic",
    "Product",
    "Pulse",
    "Recorded",
    "RecordedSpline",
    "RecoveryError",
    "Results",
    "ResultsError",
    "Revolute",
    "RigidBody",
    "RigidSuperelement",
    "Rod",
    "RollingDisc",
    "SavedState",
    "Sawtooth",
    "Screw",
    "Settings",
    "ShapedNoise",
    "Simulator",
    "SmoothFunction",
    "SmoothStep",
    "Sphere",
    "Spherical",
    "Spline",
    "Spring",
    "StabilityMap",
    "Start",
    "StartFrom",
    "StateError",
    "StateSpace",
    "SteadyRotation",
    "Steps",
    "Stop",
    "Stribeck",
    "Sum",
    "Surface",
    "SurfaceContact",
    "Table",
    "TabulatedDamperLaw",
    "TabulatedLaw",
    "Torque",
    "Trapezoid",
    "UnbalanceResponse",
    "Universal",
    "UserLaw",
    "ValidityWarning",
    "Window",
    "campbell",
    "check",
    "check_law",
    "floquet",
    "given_moduli",
    "linearize",
    "model_schema",
    "plausibility_warnings",
    "read_model",
    "rotor_at",
    "simulate",
    "simulate_many",
    "stability_map",
    "start",
    "unbalance_response",
    "write_model",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily_loaded(
        __name__,
        {
            "..results.results": "Results",
            ".checkpoint.saved_state": "Moment SavedState",
            ".couplings.bearings": "Bearing",
            ".couplings.contacts": "Contact Hertz",
            ".couplings.couplers": "Coupler",
            ".couplings.friction": "Coulomb JointFriction Stribeck",
            ".couplings.impact": "ForceTable Impact",
            ".couplings.joint": "Joint",
            ".couplings.joints": (
                "JOINTS ConstantVelocity Cylindrical Fixed Planar PointOnLine PointOnPlane "
                "Prismatic Revolute Rod RollingDisc Screw Spherical Universal"
            ),
            ".couplings.motions": "PrescribedDisplacement PrescribedOrientation PrescribedRotation",
            ".couplings.motors": "Motor",
            ".couplings.springs": "Spring",
            ".couplings.stops": "Stop",
            ".couplings.surface_contacts": "SurfaceContact",
            ".errors": (
                "ConvergenceError MissedContactError ModelError OutOfRangeError RecoveryError "
                "ResultsError StateError ValidityWarning"
            ),
            ".inspection": "ModelCheck check given_moduli",
            ".laws.bouc_wen": "BoucWenLaw",
            ".laws.check": "check_law",
            ".laws.dampers": "DamperLaw TabulatedDamperLaw",
            ".laws.elastoplastic": "ElastoplasticLaw",
            ".laws.iwan": "IwanLaw",
            ".laws.law": "ForceLaw",
            ".laws.maxwell": "MaxwellLaw",
            ".laws.one_sided": "OneSidedLaw",
            ".laws.tabulated": "TabulatedLaw",
            ".laws.user": "UserLaw",
            ".linear.campbell": "Campbell campbell",
            ".linear.floquet": "Floquet floquet",
            ".linear.frf": "FrequencyResponse",
            ".linear.linearize": "LinearModel linearize",
            ".linear.modes": "LinearModes",
            ".linear.rotors": "rotor_at",
            ".linear.stability": "StabilityMap stability_map",
            ".linear.state_space": "StateSpace",
            ".linear.unbalance": "UnbalanceResponse unbalance_response",
            ".model.bodies": "FlexibleBody Frame Place RigidBody RigidSuperelement Start",
            ".model.body_shapes": "Box Cylinder Sphere Surface",
            ".model.file": "model_schema read_model write_model",
            ".model.fmus": "FMU",
            ".model.loads": "LOADS Drag Force Load PatternLoad Torque",
            ".model.model": "Model",
            ".model.output_request": "OutputRequest",
            ".model.settings": "Settings StartFrom SteadyRotation",
            ".plausibility": "Doubt Implausible plausibility_warnings doubts",
            ".signals.composed": "Delayed Product Sum",
            ".signals.curves": (
                "Constant Function Harmonic Impulse Input Polynomial Pulse SmoothFunction "
                "Spline Steps Table"
            ),
            ".signals.noise": "Noise ShapedNoise",
            ".signals.profiles": (
                "Chirp HalfSine Haversine LogarithmicChirp Sawtooth SmoothStep Trapezoid Window"
            ),
            ".signals.recorded": "Recorded RecordedSpline",
            ".many": "simulate_many",
            ".simulation": "simulate start",
            ".simulator": "Simulator",
        },
    )
