"""The second order of elastic motion: what a body that turns fast, or bends far, needs too."""

from dataclasses import dataclass, replace

import numpy as np

from ..files.arrays import Array
from .modes import Modes
from .validation import SuperelementError, checked

# Moments of inertia in the order 11, 22, 33, 23, 13, 12.
N_INERTIA_CHANGES = 6


@dataclass(frozen=True, eq=False)
class Rotation:
    """The second order of elastic motion: changes of inertia, foreshortening, geometric stiffness.

        z = [u; d] = [phi; phi_inertia] eta + 1/2 A(q, q),     q = T eta
        J = J_0 + mat(d),     Gamma_i = q . gyroscopic_i q'

    u (n_c,): displacements of the interfaces; d (6,): changes of the moments of inertia J_11, J_22,
    J_33, J_23, J_13, J_12; Gamma (3,): angular momentum of the elastic motion. All in body axes.
    The strain energy beyond 1/2 omega^2 eta^2 in the first k of q is

        W = cubic(q, q, q) / 6 + quartic(q, q, q, q) / 8      [J for q in sqrt(kg) m].

    Parameters
    ----------
    phi_inertia : (6, m) [sqrt(kg) m]
    T : (r, m) [1]
        The first `n_low` rows belong to the lowest modes, the others to soft shapes: first
        projections by stiffness, which carry stress, then those by mass, which carry inertia.
    A_interface : (n_c, r, r) [1/(kg m), 1/(kg m^2)]
        Symmetric in q.
    A_inertia : (6, r, r) [1]
        Symmetric in q.
    gyroscopic : (3, r, r) [1]
    kappa : (candidates,)
        How much loads stiffen the body in each coordinate that was considered, relative to the
        largest, in descending order; empty where this is unknown, so that nothing stiffens.
    n_low : int
    A_surface : (3 n, r, r), optional [1/(kg m)]
        That of displacements of the nodes of surfaces; of bodies that have them.
    cubic : (k, k, k), optional
        Symmetric; given together with `quartic`.
    quartic : (k, k, k, k), optional

    Raises
    ------
    SuperelementError
        For arrays that do not fit each other, or without symmetry.

    Examples
    --------
    >>> import numpy as np
    >>> rotation = Rotation(
    ...     phi_inertia=np.zeros((6, 4)), T=np.eye(4), A_interface=np.zeros((3, 4, 4)),
    ...     A_inertia=np.zeros((6, 4, 4)), gyroscopic=np.zeros((3, 4, 4)), kappa=np.ones(1), n_low=2
    ... )
    >>> rotation.r, rotation.n_soft, rotation.n_stiff, rotation.stiffens
    (4, 1, 3, True)
    """

    phi_inertia: Array
    T: Array
    A_interface: Array
    A_inertia: Array
    gyroscopic: Array
    kappa: Array
    n_low: int
    A_surface: Array | None = None
    cubic: Array | None = None
    quartic: Array | None = None

    def __post_init__(self) -> None:
        T = checked("rotation: T", self.T, ("r", "m"))
        r, m = T.shape
        shapes = {
            "phi_inertia": (N_INERTIA_CHANGES, m),
            "A_interface": ("n_c", r, r),
            "A_inertia": (N_INERTIA_CHANGES, r, r),
            "gyroscopic": (3, r, r),
            "kappa": ("candidates",),
        }
        object.__setattr__(self, "T", T)
        for name, shape in shapes.items():
            array = checked(f"rotation: {name}", getattr(self, name), shape)
            object.__setattr__(self, name, array)
        if self.A_surface is not None:
            A_surface = checked("rotation: A_surface", self.A_surface, ("3 n", r, r))
            object.__setattr__(self, "A_surface", A_surface)
            _check_bilinear("A_surface", A_surface)
        if (self.cubic is None) != (self.quartic is None):
            raise SuperelementError("rotation: expected both or none of cubic and quartic")
        if self.cubic is not None:
            cubic = checked("rotation: cubic", self.cubic, ("k", "k", "k"))
            k = len(cubic)
            quartic = checked("rotation: quartic", self.quartic, (k, k, k, k))
            if cubic.shape != (k, k, k) or k > r:
                raise SuperelementError(
                    f"rotation: cubic: expected shape (k, k, k) with k up to {r}, "
                    f"found {cubic.shape}"
                )
            object.__setattr__(self, "cubic", cubic)
            object.__setattr__(self, "quartic", quartic)
        for name in ("A_interface", "A_inertia"):
            _check_bilinear(name, getattr(self, name))
        if not 0 <= self.n_low <= r:
            raise SuperelementError(f"rotation: n_low: expected 0 to {r}, found {self.n_low}")

    @property
    def r(self) -> int:
        """The number of coordinates q."""
        return len(self.T)

    @property
    def n_soft(self) -> int:
        """The number of soft shapes, which follow the modes in q: twice, by stiffness and mass."""
        return (self.r - self.n_low) // 2

    @property
    def n_stiff(self) -> int:
        """The number of coordinates that carry stress, the first of q: modes and soft shapes."""
        return self.n_low + self.n_soft

    @property
    def stiffens(self) -> bool:
        """Whether A has what stress does; the matrices of another program do not tell it."""
        return len(self.kappa) > 0

    @property
    def by_mass(self) -> Array:
        """The rows of T (n_stiff, m) that project by mass: modes, and the last n_soft."""
        return np.vstack([self.T[: self.n_low], self.T[self.n_stiff :]])

    def complete(self, modes: Modes) -> Modes:
        """Modes at the interfaces, the inertia and the coordinates q: phi (n_c + 6 + r, m)."""
        return replace(modes, phi=np.vstack([modes.phi, self.phi_inertia, self.T]))


def _check_bilinear(name: str, A: Array) -> None:
    defect = np.abs(A - A.transpose(0, 2, 1)).max(initial=0.0)
    if defect > 1e-8 * np.abs(A).max(initial=0.0):
        raise SuperelementError(
            f"rotation: {name}: expected symmetry in the coordinates, found entries that differ by "
            f"{defect:.3e}"
        )
