"""Load patterns: loads that are spread over a body, each with one amplitude."""

from dataclasses import dataclass

from ..files.arrays import Array
from .validation import check_name, checked


@dataclass(frozen=True, eq=False)
class Pattern:
    """A load that is spread over a body, and that a signal multiplies.

    Parameters
    ----------
    name : str
        One line without '/' and '.'.
    force : (3,) [N]
        The resultant at amplitude 1, in body axes. What deforms the body is among its `Channels`.
    moment : (3,) [N m]
        The resultant about the center of mass.

    Raises
    ------
    SuperelementError
        For a name or a vector that is not one.

    Examples
    --------
    >>> import numpy as np
    >>> Pattern("wind", force=np.array([0.0, 5.0, 0.0]), moment=np.zeros(3)).force.tolist()
    [0.0, 5.0, 0.0]
    """

    name: str
    force: Array
    moment: Array

    def __post_init__(self) -> None:
        check_name("pattern", self.name)
        for key in ("force", "moment"):
            vector = checked(f"pattern {self.name!r}: {key}", getattr(self, key), (3,))
            object.__setattr__(self, key, vector)
