"""Equivalent radiated sound power of the surface of a flexible body.

    P(t) = rho c sum_p A_p v_n(p, t)^2

as if each part of the surface radiated a plane wave (a radiation efficiency of 1). With modes,
v_n = a(p) . w, where w are the rates of modal coordinates: P is a quadratic form of w, whose matrix
is as small as there are modes. Source: Fahy, Gardonio: Sound and Structural Vibration (2007), 3.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..files.arrays import Array, IntArray
from ..superelement import Recovery, Superelement
from ..superelement.cells import normals, triangles
from .errors import RecoveryError
from .results import Results
from .rotations import inverse, rotate
from .series.bands import Bands, octave_bands

AIR_DENSITY = 1.204
"""[kg/m^3], at 20 degrees Celsius and 1013 hPa"""
AIR_SOUND_SPEED = 343.2
"""[m/s], there"""
REFERENCE_POWER = 1e-12
"""[W], ISO 1683"""
NEGLIGIBLE_EIGENVALUE = 1e-14
"""eigenvalues of the quadratic form, over the largest, that are rounding"""
NEAREST_NODE = 1e-9
"""distance of a node of a surface from its point, over the size of the body, that is rounding"""
SPLINE_DEGREE = 5


@dataclass(frozen=True, eq=False)
class RadiatedPower:
    """The equivalent radiated sound power of a surface, see `radiated_power`.

    Parameters
    ----------
    time : (n,) [s]
    amplitudes : (n, k) [sqrt(W)]
        The sum of whose squares is the power.
    area : float [m^2]

    Examples
    --------
    >>> found = RadiatedPower(np.arange(3.0), np.full((3, 1), 2.0), area=0.5)
    >>> found.power.tolist(), round(found.level, 2)
    ([4.0, 4.0, 4.0], 126.02)
    """

    time: Array
    amplitudes: Array
    area: float

    @property
    def power(self) -> Array:
        """(n,) [W]"""
        total: Array = np.square(self.amplitudes).sum(axis=1)
        return total

    @property
    def mean(self) -> float:
        """The mean over the run [W]."""
        return float(np.trapezoid(self.power, self.time) / (self.time[-1] - self.time[0]))

    @property
    def level(self) -> float:
        """The level of the mean [dB], relative to 1 pW."""
        return float(decibels(np.array(self.mean)))

    def bands(self, fraction: int = 3) -> Bands:
        """The power [W] in bands of 1/fraction of an octave, as `octave_bands` has them."""
        found = octave_bands(self.time, self.amplitudes, fraction)
        power = np.square(found.values).sum(axis=1)
        return Bands(found.center, found.lower, found.upper, power)


def decibels(power: Array) -> Array:
    """Levels [dB] of powers [W], relative to 1 pW; -inf of none.

    Examples
    --------
    >>> decibels(np.array([1e-12, 1.0])).tolist()
    [0.0, 120.0]
    """
    with np.errstate(divide="ignore"):
        levels: Array = 10.0 * np.log10(power / REFERENCE_POWER)
    return levels


def radiated_power(
    results: Results,
    body: str,
    surface: str = "",
    *,
    where: Callable[[Array], Array] | None = None,
    rigid: bool = False,
    density: float = AIR_DENSITY,
    sound_speed: float = AIR_SOUND_SPEED,
) -> RadiatedPower:
    """Compute the equivalent radiated sound power of a flexible body, or of a part of its surface.

    It is an upper estimate: below the critical frequency of a plate less is radiated, since
    neighboring parts that move against each other cancel.

    Parameters
    ----------
    results : Results
        Of a run that allows fields of the body (`[recovery]` in its body file).
    body : str
    surface : str
        One of the `[surfaces]` of its body file; all of its boundary unless given.
    where : callable, optional
        Of positions (p, 3) of points in body axes [m], from the center of mass: which of them
        belong to the surface (p,). A triangle belongs if its corners do.
    rigid : bool
        Whether the motion of the body axes radiates too, as of a housing on soft mounts. Not that
        of a part of a mechanism, which moves far.
    density, sound_speed : float [kg/m^3], [m/s]
        Of the fluid, by default air.

    Returns
    -------
    RadiatedPower

    Raises
    ------
    RecoveryError
        Where the run does not allow fields, for a body of lines, and for a surface that there is
        not.
    """
    for name, value in (("density", density), ("sound_speed", sound_speed)):
        if not 0.0 < value < np.inf:
            raise RecoveryError(f"{name}: expected a positive number, got {value:g}")
    recovery, eta = results.modal_state(body, results.time)
    corners = _corners(results.superelement(body), recovery, body, surface, where)
    vectors = normals(recovery.points, corners)
    areas = 0.5 * np.linalg.norm(vectors, axis=1)
    rates = _rates(results.time, eta)
    shapes = _normal_shapes(recovery.points, recovery.phi, corners, vectors, rigid)
    if rigid:
        motion = results.body(body)
        velocity = rotate(inverse(motion.R), motion.velocity)
        rates = np.hstack([rates, velocity, motion.v[:, 3:]])
    # Each corner stands for a third of its triangle.
    weights = density * sound_speed * np.repeat(areas / 3.0, 3)
    form = shapes.T @ (weights[:, None] * shapes)
    # As a sum of squares the power has spectra: products of rates would need all pairs of modes.
    values, along = np.linalg.eigh(form)
    kept = values > NEGLIGIBLE_EIGENVALUE * values[-1]
    factor = along[:, kept] * np.sqrt(values[kept])
    return RadiatedPower(results.time, rates @ factor, float(areas.sum()))


def _corners(
    element: Superelement,
    recovery: Recovery,
    body: str,
    surface: str,
    where: Callable[[Array], Array] | None,
) -> IntArray:
    """The triangles (m, 3) of the surface, by the points of the recovery."""
    # Quadratic facets are cut at their middle nodes, where shapes are known too.
    found = triangles(recovery.cells)
    if surface:
        found = _of_surface(element, recovery, body, surface)
    if where is not None:
        inside = np.asarray(where(recovery.points), dtype=bool)
        if inside.shape != (len(recovery.points),):
            raise RecoveryError(
                f"where: expected shape ({len(recovery.points)},), got {inside.shape}"
            )
        found = found[inside[found].all(axis=1)]
    if not len(found):
        raise RecoveryError(f"body {body!r}: expected a surface of solids, found no facets")
    return found


def _of_surface(element: Superelement, recovery: Recovery, body: str, name: str) -> IntArray:
    from scipy.spatial import cKDTree  # slow to load

    patches = () if element.surfaces is None else element.surfaces.patches
    by_name = {patch.name: patch for patch in patches}
    if name not in by_name:
        known = ", ".join(by_name) or "none"
        raise RecoveryError(f"body {body!r}: no surface {name!r}; there are: {known}")
    patch = by_name[name]
    # Surfaces count nodes as the mesh does, the recovery as its file does: places are the same.
    apart, nearest = cKDTree(recovery.points).query(patch.X)
    size = float(np.ptp(recovery.points, axis=0).max())
    if apart.max() > NEAREST_NODE * size:
        raise RecoveryError(f"body {body!r}: surface {name!r} is not part of its recovery")
    of_points: IntArray = np.asarray(nearest, dtype=np.int64)
    return of_points[triangles(patch.facets)]


def _normal_shapes(
    points: Array, phi: Array, corners: IntArray, vectors: Array, rigid: bool
) -> Array:
    """The normal velocity (3 m, k) at the corners of the triangles, by the rates of coordinates."""
    n = np.repeat(vectors / np.linalg.norm(vectors, axis=1)[:, None], 3, axis=0)
    at = corners.ravel()
    elastic: Array = np.einsum("pi,pim->pm", n, phi[at])
    return np.hstack([elastic, n, np.cross(points[at], n)]) if rigid else elastic


def _rates(time: Array, eta: Array) -> Array:
    """Derivatives (n, m) of coordinates, by splines whose error is of fifth order in the step."""
    from scipy.interpolate import make_interp_spline  # slow to load

    # Of few steps the spline is the polynomial through all of them.
    degree = min(SPLINE_DEGREE, len(time) - 1)
    if degree < 1:
        return np.zeros_like(eta)
    rates: Array = make_interp_spline(time, eta, k=degree).derivative()(time)
    return rates
