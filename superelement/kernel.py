"""The sampled impulse responses of a superelement, and how modes produce them."""

from dataclasses import dataclass
from itertools import repeat

import numpy as np

from ..files.arrays import Array
from .modes import Modes
from .response import respond
from .scheme import GeneralizedAlpha
from .validation import SuperelementError, check_positive, check_symmetric, checked

# BLAS rounds products of few rows differently, see `spread`; so all products have as many.
PRODUCT_ROWS = 64


@dataclass(frozen=True, eq=False)
class Kernel:
    """Impulse responses of the interfaces without rigid motion, for one step and one scheme.

        u_n = g_initial[n] p_0 + sum_{j=1..n} g[n-j] p_j

    All in body axes; units: m/N, rad/N, m/(N m), rad/(N m). In the numbering of the paper
    g[k] = h H_{k+2}. Source: docs/theory.md, Impulse responses.

    Parameters
    ----------
    h : float [s]
        The time step.
    scheme : GeneralizedAlpha
    g : (n_k, n_c, n_c)
        g[k] is the displacement k steps after the step that ends in a unit load; g[0] is the
        instantaneous compliance.
    g_initial : (n_k, n_c, n_c)
        The displacement k steps after t_0 under a unit load that acts at t_0 alone.
    error : float
        Relative error of the transfer function from 0 to `band`; 0 where it is exact.
    band : float [Hz], optional
        None for all frequencies.

    Raises
    ------
    SuperelementError
        For arrays of other shapes or without symmetry, and numbers that are not positive.

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel.superelement import GeneralizedAlpha
    >>> g = np.ones((5, 1, 1))
    >>> kernel = Kernel(1e-3, GeneralizedAlpha(), g, g_initial=g)
    >>> kernel.n_c, kernel.steps, kernel.length
    (1, 4, 0.004)
    """

    h: float
    scheme: GeneralizedAlpha
    g: Array
    g_initial: Array
    error: float = 0.0
    band: float | None = None

    def __post_init__(self) -> None:
        check_positive("kernel: h", self.h)
        if not (np.isfinite(self.error) and self.error >= 0.0):
            raise SuperelementError(f"kernel: error: expected a number >= 0, found {self.error}")
        if self.band is not None:
            check_positive("kernel: band", self.band)
        g = checked("kernel: g", self.g, ("n_k", "n_c", "n_c"))
        n_k, n_c, columns = g.shape
        if n_c != columns or n_k < 2:
            raise SuperelementError(
                f"kernel: g: expected two or more square matrices, found shape {g.shape}"
            )
        g_initial = checked("kernel: g_initial", self.g_initial, (n_k, n_c, n_c))
        check_symmetric("kernel: g", g)
        check_symmetric("kernel: g_initial", g_initial)
        object.__setattr__(self, "g", g)
        object.__setattr__(self, "g_initial", g_initial)

    @property
    def n_c(self) -> int:
        """The number of interface dofs."""
        return int(self.g.shape[1])

    @property
    def steps(self) -> int:
        """The number of time steps that the kernel covers."""
        return len(self.g) - 1

    @property
    def length(self) -> float:
        """The time that the kernel covers [s]."""
        return self.steps * self.h


def sample_kernel(
    modes: Modes,
    h: float,
    scheme: GeneralizedAlpha,
    steps: int,
    error: float = 0.0,
    band: float | None = None,
) -> Kernel:
    """Sample the impulse responses of modes as generalized-alpha time stepping produces them.

        g[k] = phi diag(c_k) phi^T
        c_k: the scalar recursion of each omega, zeta under a unit load at one step

    Parameters
    ----------
    modes : Modes
    h : float [s]
        The time step.
    scheme : GeneralizedAlpha
    steps : int
        One or more.
    error, band
        Those of the modes, which the kernel states.

    Returns
    -------
    Kernel
        With steps + 1 lags, exact to rounding. Source: docs/theory.md, Impulse responses.

    Raises
    ------
    SuperelementError
        For a step that is not positive, or fewer steps than one.

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel.superelement import GeneralizedAlpha, Modes
    >>> modes = Modes(omega=np.array([100.0]), zeta=np.array([0.1]), phi=np.array([[1.0]]))
    >>> kernel = sample_kernel(modes, 1e-3, GeneralizedAlpha(), steps=2000)

    Its sum is the static compliance, here 1 / omega^2:

    >>> float(kernel.g.sum().round(10))
    0.0001
    """
    check_positive("kernel: h", h)
    if steps < 1:
        raise SuperelementError(f"kernel: steps: expected one or more, found {steps}")
    impulse, initial = _scalar_responses(modes, h, scheme, steps)
    return Kernel(h, scheme, spread(modes.phi, impulse), spread(modes.phi, initial), error, band)


def _scalar_responses(
    modes: Modes, h: float, scheme: GeneralizedAlpha, steps: int
) -> tuple[Array, Array]:
    """Responses (steps + 1, m) of each mode to a unit load at the first step, and to one at t_0."""
    # One step more, whose start is dropped: g[0] is the response at the end of the loaded step.
    impulse = respond(modes, h, scheme, [1.0, *repeat(0.0, steps)])
    initial = respond(modes, h, scheme, repeat(0.0, steps), acceleration=1.0)
    return np.array(list(impulse))[1:], np.array(list(initial))


def spread(phi: Array, coefficients: Array) -> Array:
    """phi diag(c_k) phi^T (n_k, n_c, n_c) for rows c_k of real coefficients, exactly symmetric.

    Matrix products over the pairs i <= j: no array of n_k n_c m numbers for the many modes of a
    large mesh. BLAS rounds products of few rows otherwise than those of many: all have
    `PRODUCT_ROWS` rows, so that a matrix does not depend on how many follow it.
    """
    n_c, n_k = len(phi), len(coefficients)
    i, j = np.triu_indices(n_c)
    pairs = (phi[i] * phi[j]).T
    # Rows of zeros fill the last product, see above.
    block = np.zeros((PRODUCT_ROWS, len(phi.T)))
    g = np.empty((n_k, n_c, n_c))
    for first in range(0, n_k, PRODUCT_ROWS):
        rows = coefficients[first : first + PRODUCT_ROWS]
        block[: len(rows)] = rows
        g[first : first + PRODUCT_ROWS, i, j] = (block @ pairs)[: len(rows)]
    # Mirrored rather than computed twice, so that the symmetry is exact.
    g[:, j, i] = g[:, i, j]
    return g
