"""The derivative of a superelement by a design parameter of its body."""

from dataclasses import dataclass

import numpy as np

from ..files.arrays import Array
from .validation import SYMMETRY_TOLERANCE, SuperelementError, check_positive, checked


@dataclass(frozen=True, eq=False)
class DesignDerivative:
    """Derivatives by a parameter p of a body, in the basis of the m modes of its superelement.

        K_p = Phi^T dK/dp Phi,    M_p = Phi^T dM/dp Phi,    phi_p = d/dp (P_C P) Phi

    with the mode shapes Phi held: no mode is differentiated by itself.

    Parameters
    ----------
    value : float
        p of the body.
    reach : float
        The change of p up to which the first order is right to a hundredth.
    error : float
        Of `compliance` by the modes, relative to the compliance, for a change of p by `reach`.
    K, M : (m, m) [1/s^2, 1, per unit of p]
    phi : (n_c, m) [1/sqrt(kg)]
    mass : float [kg]
    J_rot : (3, 3) [kg m^2]
        About the center of mass, which moves.
    center : (3,) [m]
    X : (n, 3) [m]
        Of the interfaces from the center of mass.
    compliance : (n_c, n_c) [m/N ...]
        From statics of the whole mesh.

    Raises
    ------
    SuperelementError
        For arrays that do not fit each other.

    See `redesigned` for an example.
    """

    value: float
    reach: float
    error: float
    K: Array
    M: Array
    phi: Array
    mass: float
    J_rot: Array
    center: Array
    X: Array
    compliance: Array

    def __post_init__(self) -> None:
        for name in ("value", "error", "mass"):
            if not np.isfinite(getattr(self, name)):
                raise SuperelementError(
                    f"{name}: expected a finite number, found {getattr(self, name)}"
                )
        check_positive("reach", self.reach)
        K = checked("K", self.K, ("m", "m"))
        m = len(K)
        shapes: dict[str, tuple[int | str, ...]] = {
            "K": (m, m),
            "M": (m, m),
            "phi": ("n_c", m),
            "J_rot": (3, 3),
            "center": (3,),
            "X": ("n", 3),
            "compliance": ("n_c", "n_c"),
        }
        for name, shape in shapes.items():
            object.__setattr__(self, name, checked(name, getattr(self, name), shape))
        for name in ("K", "M", "J_rot", "compliance"):
            matrix = getattr(self, name)
            defect = np.abs(matrix - matrix.T).max(initial=0.0)
            if defect > SYMMETRY_TOLERANCE * np.abs(matrix).max(initial=0.0):
                raise SuperelementError(
                    f"{name}: expected symmetry, found entries that differ by {defect:.3e}"
                )

    def check_fits(self, n_c: int, m: int, n: int) -> None:
        """`SuperelementError` unless it is of n_c dofs of n interfaces, and m modes."""
        expected = {"K": (m, m), "phi": (n_c, m), "X": (n, 3), "compliance": (n_c, n_c)}
        for name, shape in expected.items():
            if (found := getattr(self, name).shape) != shape:
                raise SuperelementError(f"{name}: expected shape {shape}, found {found}")
