"""Shells on their reference domains: shapes, points of integration, assumed transverse shear."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss

from ...superelement.validation import Array

BUBBLE_SPREAD = 1e-4
"""Distance of the points D, E, F of MITC3+ from the middle of the triangle, as published."""
_NEAR, _FAR = 0.445948490915965, 0.091576213509771
_OF_NEAR, _OF_FAR = 0.5 * 0.223381589678011, 0.5 * 0.109951743655322


@dataclass(frozen=True, eq=False)
class ShellShape:
    """The shapes of a shell with k nodes, over reference coordinates xi = (r, s).

    N (k, q) and dN (k, 2, q) at points xi (2, q); xi, weights (q,): points of integration.
    ties (2, p): where the transverse shear is sampled; weights_of_ties: at points (2, q) the
    weights (q, 2, p, 2) of 2 e_rt and 2 e_st there in the assumed ones. bubble: values (q,) and
    slopes (2, q) of what is added to the director, None for nothing.
    """

    N: Callable[[Array], Array]
    dN: Callable[[Array], Array]
    xi: Array
    weights: Array
    middle: Array
    ties: Array
    weights_of_ties: Callable[[Array], Array]
    bubble: Callable[[Array], tuple[Array, Array]] | None
    incompatible: bool

    @property
    def corners(self) -> Array:
        """The nodes (2, k) in reference coordinates."""
        return TRIANGLE_CORNERS if self.bubble is not None else QUADRANGLE_CORNERS


TRIANGLE_CORNERS = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
QUADRANGLE_CORNERS = np.array([[-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0]])


def _bilinear(xi: Array) -> Array:
    r, s = (1.0 + c[:, None] * x for c, x in zip(QUADRANGLE_CORNERS, xi, strict=True))
    return np.asarray(0.25 * r * s)


def _bilinear_slopes(xi: Array) -> Array:
    (r, s), (c, d) = xi, QUADRANGLE_CORNERS[:, :, None]
    return np.asarray(0.25 * np.stack([c * (1.0 + d * s), d * (1.0 + c * r)], axis=1))


def _linear(xi: Array) -> Array:
    r, s = xi
    return np.stack([1.0 - r - s, r, s])


def _linear_slopes(xi: Array) -> Array:
    slopes = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    return np.repeat(slopes[:, :, None], xi.shape[1], axis=2)


def _cubic(xi: Array) -> tuple[Array, Array]:
    """The bubble 27 r s (1 - r - s), 1 in the middle and 0 on the sides."""
    r, s = xi
    slopes = np.stack([s * (1.0 - 2.0 * r - s), r * (1.0 - r - 2.0 * s)])
    return 27.0 * r * s * (1.0 - r - s), 27.0 * slopes


def _quadrangle_shear(xi: Array) -> Array:
    """MITC4: e_rt of the middles of two sides, linear in s, and e_st likewise in r."""
    r, s = xi
    weights = np.zeros((xi.shape[1], 2, 4, 2))
    weights[:, 0, 0, 0], weights[:, 0, 1, 0] = 0.5 * (1.0 - s), 0.5 * (1.0 + s)
    weights[:, 1, 2, 1], weights[:, 1, 3, 1] = 0.5 * (1.0 - r), 0.5 * (1.0 + r)
    return weights


def _triangle_shear(xi: Array) -> Array:
    """MITC3+, from six points A to F.

    e_rt = 2/3 (e_rt^B - 1/2 e_st^B) + 1/3 (e_rt^C + e_st^C) + 1/3 c (3 s - 1)
    e_st = 2/3 (e_st^A - 1/2 e_rt^A) + 1/3 (e_rt^C + e_st^C) + 1/3 c (1 - 3 r)
    c = e_rt^F - e_rt^D - e_st^F + e_st^E
    """
    r, s = xi
    a, b, c, d, e, f = range(6)
    weights = np.zeros((xi.shape[1], 2, 6, 2))
    weights[:, 0, b] = weights[:, 1, a] = 2.0 / 3.0, -1.0 / 3.0
    weights[:, 1, a] = -1.0 / 3.0, 2.0 / 3.0
    weights[:, :, c] = 1.0 / 3.0
    for row, factor in ((0, (3.0 * s - 1.0) / 3.0), (1, (1.0 - 3.0 * r) / 3.0)):
        weights[:, row, f, 0] += factor
        weights[:, row, d, 0] -= factor
        weights[:, row, f, 1] -= factor
        weights[:, row, e, 1] += factor
    return weights


def _quadrangle() -> ShellShape:
    x, w = leggauss(2)
    return ShellShape(
        N=_bilinear,
        dN=_bilinear_slopes,
        xi=np.array([np.repeat(x, 2), np.tile(x, 2)]),
        weights=np.outer(w, w).ravel(),
        middle=np.zeros((2, 1)),
        ties=np.array([[0.0, 0.0, -1.0, 1.0], [-1.0, 1.0, 0.0, 0.0]]),
        weights_of_ties=_quadrangle_shear,
        bubble=None,
        incompatible=True,
    )


def _triangle() -> ShellShape:
    third, h = 1.0 / 3.0, BUBBLE_SPREAD
    near, far = (np.array([[p, p, 1 - 2 * p], [p, 1 - 2 * p, p]]) for p in (_NEAR, _FAR))
    ties = [
        [1.0 / 6.0, 2.0 / 3.0],
        [2.0 / 3.0, 1.0 / 6.0],
        [1.0 / 6.0, 1.0 / 6.0],
        [third + h, third - 2.0 * h],
        [third - 2.0 * h, third + h],
        [third + h, third + h],
    ]
    return ShellShape(
        N=_linear,
        dN=_linear_slopes,
        # Exact for the squares of the slopes of the bubble, of fourth order.
        xi=np.hstack([near, far]),
        weights=np.repeat([_OF_NEAR, _OF_FAR], 3),
        middle=np.full((2, 1), third),
        ties=np.array(ties).T,
        weights_of_ties=_triangle_shear,
        bubble=_cubic,
        incompatible=False,
    )


SHELL_SHAPES = {"triangle": _triangle(), "quad": _quadrangle()}
"""By the type of cell, as meshio names it."""
