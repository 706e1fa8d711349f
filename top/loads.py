"""Loads on frames and on flexible bodies: `du.loads.Force(rod["tip"], [0, 1, 0], signal)`."""

from duhamel.solver.model.loads import Drag, Force, PatternLoad, Torque

__all__ = ["Drag", "Force", "PatternLoad", "Torque"]
