"""The full examination of a superelement: every lag, and transforms over all frequencies.

Seconds, where `checks` takes milliseconds.
"""

from collections.abc import Iterator

import numpy as np

from ..files.arrays import Array, Complex
from .cells import normals
from .checks import (
    DECADES_OF_DECAY,
    MAX_RELATIVE_DEVIATION,
    Check,
    as_modes,
    band_rest,
    decay,
    deviation,
    eigenvalue_spread,
    negative_part,
    quick_checks,
    rest_spread,
    scale_of,
)
from .kernel import sample_kernel
from .modes import Modes
from .outline import Outline
from .superelement import Superelement
from .transfer import summed, transfer
from .validation import SYMMETRY_TOLERANCE

# Each costs a sum over all lags; a kernel with fewer lags has no more independent values.
MAX_TRANSFORM_FREQUENCIES = 256
# Along the real axis the transform falls smoothly from the compliance to the first lag.
N_REAL_DELAYS = 8


def check(element: Superelement) -> tuple[Check, ...]:
    """Check everything that must hold of a superelement, by recomputing it.

    These are reciprocity, the quick checks that every file passes when it is read, and that the
    kernel is passive and free of rigid motion. Where there are modes, every lag and the transfer
    function over the band are compared with them. It takes seconds for large bodies.

    Parameters
    ----------
    element : Superelement

    Returns
    -------
    tuple of Check
        Also those that hold. Source: docs/theory.md, What a superelement must satisfy.

    Examples
    --------
    >>> import duhamel as du
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    >>> section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    >>> beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)], section=section)
    >>> beam.interface("tip", (1.0, 0.0, 0.0))
    >>> element = beam.superelement(step=1e-4)
    >>> all(one.holds for one in check(element))
    True
    """
    return tuple(_checks(element))


def _checks(element: Superelement) -> Iterator[Check]:
    for name in ("compliance", "accelerance"):
        yield _reciprocal(f"static/{name}", getattr(element, name)[None])
    for name in ("g", "g_initial"):
        yield _reciprocal(f"kernel/{name}", getattr(element.kernel, name))
    if element.outline is not None and element.outline.n_facets:
        yield _closed(element.outline)
    yield from quick_checks(element)
    if element.surfaces is not None and element.modes is not None:
        yield _reciprocal("static/surface", element.surfaces.H[None])
        band = element.kernel.band or np.inf
        yield rest_spread(eigenvalue_spread(band_rest(element.surfaces, element.modes, band)))
    # A body without interfaces has no kernel that could be wrong.
    if element.n_c:
        yield _free_of_rigid_motion(element)
        yield _passive(element)
        if element.modes is not None:
            yield from _every_lag(element, element.modes)
            yield _transfer(element, element.modes)


def _reciprocal(where: str, matrices: Array) -> Check:
    scale = np.sqrt(np.abs(np.diagonal(matrices, axis1=1, axis2=2)).max(axis=0))
    return Check(
        where,
        "reciprocity, a symmetric matrix",
        "a difference from the mirror image, relative to the diagonal,",
        deviation(matrices, matrices.transpose(0, 2, 1), np.maximum(scale, np.finfo(float).tiny)),
        SYMMETRY_TOLERANCE,
    )


def _closed(outline: Outline) -> Check:
    """The areas of facets as vectors, which sum up to none on a closed surface."""
    # Gauss: the integral of the outer normal over a closed surface is zero.
    areas = normals(outline.points, outline.triangles)
    total = float(np.linalg.norm(areas, axis=1).sum())
    found = float(np.linalg.norm(areas.sum(axis=0))) / max(total, np.finfo(float).tiny)
    return Check(
        "outline/cells", "a closed surface", "an area without facets", found, MAX_RELATIVE_DEVIATION
    )


def _free_of_rigid_motion(element: Superelement) -> Check:
    """The share e of rigid motion in the kernel, G(d) - H <= e U U^T / sigma(d).

    U: unit rigid modes at the interfaces. They would grow as t, and stand out at the delays next to
    1; elastic ones are at most H.
    """
    kernel = element.kernel
    d = (
        decay(kernel.steps) ** np.geomspace(1.0, kernel.steps / DECADES_OF_DECAY, N_REAL_DELAYS)
    ).astype(complex)
    sigma, _ = kernel.scheme.symbols(kernel.h, d)
    # Least squares: with few interfaces the rigid modes at them can be dependent.
    back = np.linalg.pinv(_rigid_modes(element))
    excess = back @ (summed(kernel, d).real - element.compliance) @ back.T
    # Of a body that is soft for so short a kernel, the rounding of H would pass for rigid motion.
    rounding = MAX_RELATIVE_DEVIATION * np.linalg.norm(back @ element.compliance @ back.T, 2)
    share = sigma.real * (np.linalg.eigvalsh(excess)[:, -1] - rounding)
    found = float(max(0.0, share.max()))
    return Check("kernel/g", "no rigid motion", "a share of it", found, MAX_RELATIVE_DEVIATION)


def _rigid_modes(element: Superelement) -> Array:
    """U (n_c, 6) [1/sqrt(kg) ...]: mass-normalized translations, and turns about the center."""
    inertias, axes = np.linalg.eigh(element.J_rot)
    rows = []
    for face in element.interfaces:
        arms = np.cross(axes.T, face.X).T
        rows.append(np.hstack([np.eye(3), arms]))
        if face.rotations:
            rows.append(np.hstack([np.zeros((3, 3)), axes]))
    U: Array = np.vstack(rows) / np.sqrt([*[element.mass] * 3, *inertias])
    return U


def _passive(element: Superelement) -> Check:
    """Loads never get back more energy than they gave: chi G + (chi G)^H >= 0 where |d| < 1.

    chi G: velocities per load.
    """
    kernel = element.kernel
    d = _circle(element, np.pi)[1:-1]
    _, chi = kernel.scheme.symbols(kernel.h, d)
    found = 0.0
    for V in chi[:, None, None] * summed(kernel, d):
        found = max(found, negative_part(0.5 * (V + V.conj().T), scale_of(element, np.abs(V))))
    return Check(
        "kernel/g",
        "passivity, a positive real transform of the velocities",
        "a negative eigenvalue, relative to the diagonal,",
        found,
        MAX_RELATIVE_DEVIATION,
    )


def _every_lag(element: Superelement, modes: Modes) -> Iterator[Check]:
    kernel = element.kernel
    # The recursion that made the kernel; `powers_of_two` in the quick checks is another way to it.
    again = sample_kernel(modes, kernel.h, kernel.scheme, kernel.steps)
    for name in ("g", "g_initial"):
        found, expected = getattr(kernel, name), getattr(again, name)
        yield as_modes(
            element, f"kernel/{name}", "at every lag what the modes give", found, expected
        )


def _transfer(element: Superelement, modes: Modes) -> Check:
    """The transfer function of the lags against that of the modes in closed form, over the band."""
    kernel = element.kernel
    # Beyond a quarter of the sampling rate time stepping differs from the body in any case.
    band = 0.25 / kernel.h if kernel.band is None else kernel.band
    d = _circle(element, min(2.0 * np.pi * band * kernel.h, np.pi))
    expected = transfer(modes, kernel.h, kernel.scheme, d)
    what = f"up to {band:.4g} Hz the transfer function of the modes"
    return as_modes(element, "kernel/g", what, summed(kernel, d), expected)


def _circle(element: Superelement, last: float) -> Complex:
    """Delays from angle 0 to the last on the circle on which the lags fade away."""
    steps = element.kernel.steps
    angles = np.linspace(0.0, last, min(MAX_TRANSFORM_FREQUENCIES, steps) + 2)
    d: Complex = decay(steps) * np.exp(-1j * angles)
    return d
