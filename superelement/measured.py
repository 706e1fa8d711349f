"""What a test of the part has told about the modes of its model."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..files.arrays import Array
from .validation import checked


@dataclass(frozen=True, eq=False)
class MeasuredModes:
    """Measured modes, by which those of a model were updated.

    Parameters
    ----------
    frequency : (m,) [Hz]
        Undamped, as measured.
    damping : (m,)
        Of critical, as measured.
    calculated : (m,) [Hz]
        The frequency that the model had; 0 where no mode of the model is like it.
    mac : (m,)
        Modal assurance criterion of both shapes at the channels of the test.
    complexity : (m,)
        The part of the measured shape that is out of phase.

    Raises
    ------
    SuperelementError
        For entries that do not fit each other.

    Examples
    --------
    >>> import numpy as np
    >>> one = np.ones(1)
    >>> MeasuredModes(186.1 * one, 0.01 * one, 190.5 * one, 0.99 * one, 0.0 * one).matched
    array([ True])
    """

    frequency: Array
    damping: Array
    calculated: Array
    mac: Array
    complexity: Array

    def __post_init__(self) -> None:
        m = len(self.frequency)
        for key in ("frequency", "damping", "calculated", "mac", "complexity"):
            object.__setattr__(self, key, checked(f"measured: {key}", getattr(self, key), (m,)))

    @property
    def matched(self) -> NDArray[np.bool_]:
        """Which of them the model has (m,)."""
        return self.calculated > 0.0
