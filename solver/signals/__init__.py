"""Functions of time: what drives joints and motions, and what loads and motors follow.

Whoever imports one of these modules has imported all: a model takes every form of signal.
"""

from . import composed, curves, noise, profiles, recorded

__all__ = ["composed", "curves", "noise", "profiles", "recorded"]
