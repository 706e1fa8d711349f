"""Facts that hold of every elastic body, recomputed from the numbers of its superelement.

Those here take a millisecond, and every file that is read must pass them. `audit` has the others.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..files.arrays import Array
from .modes import Modes
from .rotation import Rotation
from .scheme import GeneralizedAlpha
from .superelement import Superelement
from .surfaces import Surfaces
from .validation import SuperelementError

# Iterative solvers of large systems leave that much, relative to the scale of the rows.
MAX_RELATIVE_DEVIATION = 1e-6
# Relative to the largest row of its kind, displacements or rotations: what is smaller is rounding
# of the others.
MIN_RELATIVE_ROW_SCALE = 1e-4
# Of the compliance of surfaces beside their modes, relative to its diagonal: rounding of solutions.
MAX_NEGATIVE_REST = 1e-8
# Of what is left beside the modes of the band: it is 10 or so where the mesh resolves the band, and
# grows without bounds where modes take up all that the mesh can do.
MAX_REST_SPREAD = 1e4
# A transform ends with the last lag of a kernel, which must be rounding at the delays looked at.
DECADES_OF_DECAY = 12.0


@dataclass(frozen=True)
class Check:
    """A fact that must hold of a superelement, and how far its numbers deviate from it.

    Parameters
    ----------
    where : str
        The dataset of the file that it is about.
    expected, measure : str
        The fact, and what `found` measures, in words.
    found, limit : float
        The deviation, and the largest one that is allowed.

    Examples
    --------
    >>> one = Check("kernel/g", "passivity", "a negative eigenvalue", found=0.5, limit=1e-6)
    >>> one.holds
    False
    >>> print(one)
    kernel/g: expected passivity, found a negative eigenvalue of 0.5, where 1e-06 is allowed
    """

    where: str
    expected: str
    measure: str
    found: float
    limit: float

    @property
    def holds(self) -> bool:
        """Whether the deviation is within its limit."""
        return bool(self.found <= self.limit)

    def __str__(self) -> str:
        """The fact and its deviation, for messages."""
        return (
            f"{self.where}: expected {self.expected}, found {self.measure} of {self.found:.3g}, "
            f"where {self.limit:.3g} is allowed"
        )


def require_sound(element: Superelement) -> None:
    """`SuperelementError` for the first of `quick_checks` that does not hold."""
    for check in quick_checks(element):
        if not check.holds:
            raise SuperelementError(str(check))


def quick_checks(element: Superelement) -> Iterator[Check]:
    """Inertia, definiteness of the static matrices, the start of the kernel, modes, and rotation.

    For an elastic body with modes phi_i, omega_i all of these are sums of phi_i phi_i^T with
    positive weights: 1 of the accelerance B, 1 / omega_i^2 of the compliance H, and of the start of
    the kernel less than either, 0 <= g[0] <= H and 0 <= g[0] <= B / beta', in the order of
    symmetric matrices. Source: docs/theory.md, What a superelement must satisfy.
    """
    yield _inertia(element.J_rot)
    for name in ("compliance", "accelerance"):
        yield _definite(element, f"static/{name}", getattr(element, name))
    if element.n_c:
        yield from _start(element)
        yield from _against_modes(element)
    if element.channels is not None and element.modes is None:
        yield from _of_channels(element)
    if element.rotation is not None:
        yield from _of_rotation(element, element.rotation)
    if element.surfaces is not None and element.modes is not None:
        yield from _of_surfaces(element.surfaces, element.modes, element.kernel.band or np.inf)


def deviation(found: Any, expected: Any, scale: Array) -> float:
    """The largest difference of matrices (..., n, n), each entry on the scale of its rows (n,)."""
    return float((np.abs(found - expected) / np.outer(scale, scale)).max(initial=0.0))


def negative_part(A: Any, scale: Array) -> float:
    """The most negative eigenvalue of a Hermitian matrix, its rows on their scale; 0 if none."""
    scaled = A / np.outer(scale, scale)
    # Where entries are far above the scale of their rows, rounding of these entries would pass for
    # a negative eigenvalue.
    scaled = scaled / max(1.0, MAX_RELATIVE_DEVIATION * np.abs(scaled).max(initial=0.0))
    return float(max(0.0, -np.linalg.eigvalsh(scaled).min(initial=0.0)))


def scale_of(element: Superelement, A: Array) -> Array:
    """The scale (n_c,) of each row of a matrix like A: the square root of its diagonal.

    At least the floor that other rows of the same unit give it.
    """
    diagonal = np.abs(A.diagonal())
    moves = np.concatenate(
        [np.zeros(0, dtype=bool), *(np.arange(face.n_dofs) < 3 for face in element.interfaces)]
    )
    # Never zero: scales are divided by.
    least = np.full(len(diagonal), np.finfo(float).tiny)
    for kind in (moves, ~moves):
        least[kind] += MIN_RELATIVE_ROW_SCALE * diagonal[kind].max(initial=0.0)
    scale: Array = np.sqrt(np.maximum(diagonal, least))
    return scale


def decay(steps: int) -> float:
    """The delay d < 1 whose powers fall by `DECADES_OF_DECAY` decades over the kernel's length."""
    return float(10.0 ** (-DECADES_OF_DECAY / steps))


def _inertia(J_rot: Array) -> Check:
    """The moments about two axes add up to more than that about the third, as y^2 + z^2 do."""
    # Ascending, so that only the largest can exceed the sum of the others.
    first, second, third = np.linalg.eigvalsh(J_rot)
    return Check(
        "rigid/J_rot",
        "principal inertias of which two are no less than the third",
        f"{first:.4g}, {second:.4g} and {third:.4g} kg m^2, an excess",
        float(max(0.0, third - first - second) / third),
        MAX_RELATIVE_DEVIATION,
    )


def _definite(element: Superelement, where: str, A: Array) -> Check:
    return Check(
        where,
        "a positive semidefinite matrix",
        "a negative eigenvalue, relative to the diagonal,",
        negative_part(A, scale_of(element, A)),
        MAX_RELATIVE_DEVIATION,
    )


def _start(element: Superelement) -> Iterator[Check]:
    """0 <= g[0] <= H, g[0] <= B / beta', the same of the transform, and g_initial[0] = 0."""
    kernel, H = element.kernel, element.compliance
    g_0 = kernel.g[0]
    yield _definite(element, "kernel/g", g_0)
    # Without stiffness a load of one step would move the body that far.
    bound = element.accelerance / kernel.scheme.beta_prime(kernel.h)
    yield _at_most(element, "kernel/g", "the start within the compliance", g_0, H)
    yield _at_most(element, "kernel/g", "the start within that of the accelerance", g_0, bound)
    transform = np.tensordot(decay(kernel.steps) ** np.arange(len(kernel.g)), kernel.g, 1)
    yield _definite(element, "kernel/g", transform)
    yield _at_most(element, "kernel/g", "its transform within the compliance", transform, H)
    yield Check(
        "kernel/g_initial",
        "no displacement at once",
        "a displacement, relative to the compliance,",
        deviation(kernel.g_initial[0], np.zeros_like(H), scale_of(element, H)),
        MAX_RELATIVE_DEVIATION,
    )


def _at_most(element: Superelement, where: str, what: str, A: Array, bound: Array) -> Check:
    return Check(
        where,
        what,
        "an excess, relative to that,",
        negative_part(bound - A, scale_of(element, bound)),
        MAX_RELATIVE_DEVIATION,
    )


def _against_modes(element: Superelement) -> Iterator[Check]:
    modes, kernel = element.modes, element.kernel
    if modes is None:
        return
    for name in ("compliance", "accelerance"):
        found, expected = getattr(element, name), getattr(modes, name)
        yield as_modes(element, f"static/{name}", "what the modes give", found, expected)
    lags, impulse, initial = powers_of_two(modes, kernel.h, kernel.scheme, kernel.steps)
    for name, coefficients in (("g", impulse), ("g_initial", initial)):
        found = getattr(kernel, name)[lags]
        expected = np.einsum("im,km,jm->kij", modes.phi, coefficients, modes.phi, optimize=True)
        yield as_modes(element, f"kernel/{name}", "what the modes give", found, expected)


def _of_channels(element: Superelement) -> Iterator[Check]:
    """Of a body without modes: definiteness of the matrices of interfaces and channels together,
    and the same numbers for the interfaces as by themselves.
    """
    n = element.n_c
    for name in ("compliance", "accelerance"):
        A = getattr(element, f"complete_{name}")
        # Rows of patterns and sensors have units of their own, so each is its own scale.
        own = np.sqrt(np.maximum(np.abs(A.diagonal()), np.finfo(float).tiny))
        yield Check(
            f"channels/{name}",
            "a positive semidefinite matrix",
            "a negative eigenvalue, relative to the diagonal,",
            negative_part(A, own),
            MAX_RELATIVE_DEVIATION,
        )
        alone = getattr(element, name)
        yield as_modes(element, f"channels/{name}", "that of the interfaces", A[:n, :n], alone)
    for name in ("g", "g_initial"):
        g, alone = getattr(element.complete_kernel, name), getattr(element.kernel, name)
        yield as_modes(element, f"channels/{name}", "that of the interfaces", g[:, :n, :n], alone)


def _of_rotation(element: Superelement, rotation: Rotation) -> Iterator[Check]:
    """Projections of orthonormal shapes, and changes of inertia that the body has the mass for.

        T_M T_M^T = 1,   T_K T_M^T = 1,   phi_inertia phi_inertia^T <= F^T M^-1 F

    of which the diagonal is 4 J_ii for changes of J_ii, J_kk for those of J_ij.
    """
    by_mass = rotation.by_mass
    for rows, name in ((by_mass, "mass"), (rotation.T[: rotation.n_stiff], "stiffness")):
        yield Check(
            "rotation/T",
            f"projections by {name} that give the shapes back",
            "a difference from the unit matrix",
            float(np.abs(rows @ by_mass.T - np.eye(len(rows))).max(initial=0.0)),
            MAX_RELATIVE_DEVIATION,
        )
    J = element.J_rot.diagonal()
    share = (rotation.phi_inertia**2).sum(axis=1) / np.concatenate([4.0 * J, J])
    yield Check(
        "modes/phi_inertia",
        "changes of inertia that the mass of the body allows",
        "an excess, relative to that,",
        float(max(0.0, share.max() - 1.0)),
        MAX_RELATIVE_DEVIATION,
    )
    for name in ("cubic", "quartic"):
        if (tensor := getattr(rotation, name)) is not None:
            yield _of_energy(f"rotation/{name}", tensor)
    if element.modes is not None and rotation.cubic is not None and rotation.quartic is not None:
        squares = rotation.by_mass**2 @ element.modes.omega**2
        yield _bounded(squares, rotation.cubic, rotation.quartic)


def _bounded(squares: Array, cubic: Array, quartic: Array) -> Check:
    """s q^2 / 2 + c q^3 / 6 + d q^4 / 8 >= 0 along each coordinate: c^2 <= 9 s d."""
    k = np.arange(len(cubic))
    c, d = cubic[k, k, k], quartic[k, k, k, k]
    largest = max(float(np.abs(quartic).max(initial=0.0)), np.finfo(float).tiny)
    missing = float((c**2 / (9.0 * squares[k]) - d).max(initial=0.0))
    return Check(
        "rotation/quartic",
        "no negative strain energy along a coordinate",
        "too little, relative to the largest,",
        missing / largest,
        MAX_RELATIVE_DEVIATION,
    )


def _of_energy(where: str, tensor: Array) -> Check:
    """The derivative of an energy is symmetric in any two of its coordinates."""
    k = tensor.ndim
    turned = (np.swapaxes(tensor, axis, (axis + 1) % k) for axis in range(k - 1))
    largest = max(float(np.abs(tensor).max(initial=0.0)), np.finfo(float).tiny)
    return Check(
        where,
        "the same numbers in any order of the indices",
        "a difference, relative to the largest,",
        max(float(np.abs(tensor - other).max(initial=0.0)) for other in turned) / largest,
        MAX_RELATIVE_DEVIATION,
    )


def _of_surfaces(surfaces: Surfaces, modes: Modes, band: float) -> Iterator[Check]:
    """No modes have more compliance than all, and those of the band [Hz] leave some everywhere."""
    scale = np.sqrt(np.maximum(surfaces.H.diagonal(), np.finfo(float).tiny))
    rest = surfaces.F(modes.omega) / np.outer(scale, scale)
    negative = 0.0
    if not _is_definite(rest + MAX_NEGATIVE_REST * np.eye(len(rest))):
        negative = -float(np.linalg.eigvalsh(rest)[0])
    yield Check(
        "static/surface",
        "no more compliance in the modes than there is",
        "a negative eigenvalue of the rest, relative to the diagonal,",
        negative,
        MAX_NEGATIVE_REST,
    )
    rest = band_rest(surfaces, modes, band)
    # The largest sum of a row is a bound of the largest eigenvalue.
    least = np.abs(rest).sum(axis=1).max(initial=0.0) / MAX_REST_SPREAD
    enough = _is_definite(rest - least * np.eye(len(rest)))
    yield rest_spread(0.0 if enough else eigenvalue_spread(rest))


def band_rest(surfaces: Surfaces, modes: Modes, band: float) -> Array:
    """The flexibility beside the modes up to a frequency [Hz], each node of the mesh once."""
    rows = surfaces.distinct
    rest: Array = surfaces.F(modes.omega, 2.0 * np.pi * band)[np.ix_(rows, rows)]
    return rest


def rest_spread(found: float) -> Check:
    """The check of the spread of eigenvalues of what is left beside the modes of the band."""
    return Check(
        "static/surface",
        "a static rest of every load beside the modes of the band",
        "a largest over its smallest eigenvalue",
        found,
        MAX_REST_SPREAD,
    )


def eigenvalue_spread(A: Array) -> float:
    """The largest over the smallest eigenvalue, infinite for a matrix that is not definite."""
    values = np.linalg.eigvalsh(A)
    return float(values[-1] / values[0]) if values[0] > 0.0 else np.inf


def _is_definite(A: Array) -> bool:
    """Whether a symmetric matrix is positive definite: far sooner known than its eigenvalues."""
    try:
        np.linalg.cholesky(A)
    except np.linalg.LinAlgError:
        return False
    return True


def as_modes(element: Superelement, where: str, what: str, found: Any, expected: Any) -> Check:
    """Both (..., n_c, n_c) relative to the larger, so that zeros beside what is not show as 1."""
    sizes = np.maximum(np.abs(found), np.abs(expected)).reshape(-1, element.n_c, element.n_c)
    return Check(
        where,
        what,
        "a difference, relative to the diagonal,",
        deviation(found, expected, scale_of(element, sizes.max(axis=0))),
        # A kernel that is not from modes may differ from them by the error that it states.
        MAX_RELATIVE_DEVIATION + 10.0 * element.kernel.error,
    )


def powers_of_two(
    modes: Modes, h: float, scheme: GeneralizedAlpha, steps: int
) -> tuple[list[int], Array, Array]:
    """Lags 0, 1, 2, 4, ... up to `steps`, and the responses (k, m) of the modes at them.

        y_n = A y_{n-1},   y = [eta, h eta', h^2 a, h^2 eta'']

    to a unit load at the first step, and to one at t_0, by squaring A: another way than the
    recursion of `respond`, and only its logarithm long. Source: docs/theory.md, Impulse responses.
    """
    A, loaded, initial = _amplification(modes, h, scheme)
    lags, impulse, start = [0], [loaded[:, 0]], [initial[:, 0]]
    power = 1
    while power <= steps:
        lags.append(power)
        impulse.append(np.einsum("mj,mj->m", A[:, 0], loaded))
        start.append(np.einsum("mj,mj->m", A[:, 0], initial))
        # Squaring reaches lag 2^k in k products.
        A, power = A @ A, 2 * power
    return lags, np.array(impulse), np.array(start)


def _amplification(modes: Modes, h: float, scheme: GeneralizedAlpha) -> tuple[Array, Array, Array]:
    """A (m, 4 + K, 4 + K) of a step without load; y (m, 4 + K) after a unit load at the first step;
    y at t_0. The springs q_k of a chain are the last of y.

    Rows: displacement and velocity before the step's pseudo-acceleration, and what it carries on.
    """
    alpha_m, alpha_f, beta, gamma = scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma
    m, (kept, gain, amplitude) = len(modes.omega), _chain_step(modes, h)
    n, springs = 4 + len(kept), np.zeros(len(kept))
    predicted = np.concatenate([[1.0, 1.0, 0.5 - beta, 0.0], springs])
    rate = np.concatenate([[0.0, 1.0, 1.0 - gamma, 0.0], springs])
    carried = np.concatenate([[0.0, 0.0, alpha_m, -alpha_f], springs]) / (1.0 - alpha_f)
    stretched = np.outer(gain, predicted - np.eye(n)[0]) + np.eye(n)[4:] * kept[:, None]
    stress = predicted + amplitude.T @ stretched
    stiffness, damping = (modes.omega * h) ** 2, 2.0 * modes.zeta * modes.omega * h
    hardened = stiffness * (1.0 + gain @ amplitude)
    S = scheme.inertia_ratio + gamma * damping + beta * hardened
    free = stiffness[:, None] * stress + np.outer(damping, rate) + carried
    a = -free / S[:, None]
    fed = np.concatenate([[beta, gamma, 1.0, scheme.inertia_ratio], beta * gain])
    carry = np.vstack([predicted, rate, np.zeros(n), carried, stretched])
    A = carry + fed[:, None] * a[:, None, :]
    initial = np.tile(np.concatenate([[0.0, 0.0, h * h, h * h], springs]), (m, 1))
    return A, h * h * fed / S[:, None], initial


def _chain_step(modes: Modes, h: float) -> tuple[Array, Array, Array]:
    """e, g (K,) and the amplitudes (K, m) of a chain; empty without one."""
    if modes.chain is None:
        return np.zeros(0), np.zeros(0), np.zeros((0, len(modes.omega)))
    return *modes.chain.step(h), modes.chain.amplitudes(len(modes.omega))
