"""Axial forces in flexible bodies over the forces at which they would buckle, as sums over loads.

Without terms of second order a body is neither stiffened by tension nor softened by compression.
What is missing of the strain energy is N/2 int w'^2 dx, with the slopes w' in the floating frame:
of a uniform body of length L, whatever holds it, at most N / P of the bending energy, where

    P = pi^2 EI / L^2

is Euler's load of the body hinged at both ends. Rotations of the frame itself are not small, so
that other ends change little: of a clamped column the model misses a fifth of what a force on its
tip does, whose critical load is a fourth of P.

Between two interfaces with rotations, opposite unit moments across their line turn them against
each other by c = L / EI, which the static compliance knows of any body:

    P = pi^2 / (c L),       c the larger of both planes.

The mean axial force is the dipole of the loads p_i at the interfaces along the line e, for inertia
forces of translation have none about the center of mass:

    N = sum_i (e . X_i)(e . p_i) / L

and likewise of the forces of contacts on the nodes of surfaces.
A spin omega adds the tension of the centrifugal forces about the center of mass,

    N = (omega^2 - (e . omega)^2) int (e . x)^2 dm / L,       int x x^T dm = tr J / 2 I - J

A body with one interface that turns is judged along the line from there to its center of mass. A
unit moment at the end of a uniform free bar, which the inertia of the bar balances, is
1 - 3 s^2 + 2 s^3 along it, so that it turns that end by 13 L / (35 EI). With a heavy mass at both
ends that is L / (3 EI), with one at the other end 17 L / (35 EI): a third at most, where its
frequency would mislead by the ratio of masses. A body of which no interface turns is judged along
its axis of least inertia as a uniform bar with its first frequency when free,
omega_1^2 = 500.56 EI / (m L^3).

Source: Timoshenko and Gere, Theory of Elastic Stability, 2.1; Blevins, Formulas for Natural
Frequency and Mode Shape, table 8-1.
"""

from collections.abc import Collection, Iterator
from weakref import WeakKeyDictionary

import numpy as np

from ...superelement import Interface, Superelement
from ..arrays import Array, as_index
from ..model.bodies import FlexibleBody
from ..step.records.elastic import AxialForces
from .packing import packed

TURN_OF_END = 13.0 / 35.0
"""EI / L by which a unit moment at the end of a free uniform bar turns that"""
FREE_BAR = 22.373**2
"""omega^2 m L^3 / EI of the first bending mode of a free uniform bar"""
# in each body, the softest first
AXIAL_DIRECTIONS = 3
# pairs grow with the square
MAX_AXIAL_INTERFACES = 40
# of two lines from which on the softer one stands for both
PARALLEL_COSINE = 0.9

KNOWN_LINES: WeakKeyDictionary[Superelement, list[tuple[Array, float]]] = WeakKeyDictionary()
"""of superelements that were asked for: runs of a study share theirs"""


def lay_out_axial(bodies: Collection[FlexibleBody], h: float) -> AxialForces:
    """The axial forces of all bodies that stress does not stiffen, for steps h [s]."""
    shares: list[float] = []
    weights: list[Array] = []
    lines: list[Array] = []
    factors: list[float] = []
    spreads: list[float] = []
    of_body: list[int] = []
    for e, body in enumerate(bodies):
        if body.rotation is not None and body.rotation.stiffens:
            continue
        element = body.superelement
        for line, factor in _lines(element):
            weight = _dipole(element, line, factor)
            weights.append(np.pad(weight, (0, body.n_dofs - len(weight))))
            lines.append(line)
            factors.append(factor)
            spreads.append(factor * _second_moment(element, line))
            of_body.append(e)
            shares.append(_share(element, h))
    together, start = packed(weights, range(len(weights)))
    return AxialForces(
        body=as_index(of_body),
        start=start,
        weight=together,
        line=np.array(lines).reshape(-1, 3),
        factor=np.array(factors, dtype=np.float64),
        spread=np.array(spreads, dtype=np.float64),
        share=np.array(shares),
    )


def _share(element: Superelement, h: float) -> float:
    """Of a step in a mean over 1 / omega_1; 1 where the frequency is not known."""
    if element.modes is None or not len(element.modes.omega):
        return 1.0
    angle = h * float(element.modes.omega.min())
    return angle / (1.0 + angle)


def axial_weights(element: Superelement) -> list[Array]:
    """Rows w (n_c,) with N / P = w . p for loads p at the interfaces; none where P is unknown."""
    return [_dipole(element, line, factor) for line, factor in _lines(element)]


def _lines(element: Superelement) -> list[tuple[Array, float]]:
    """Directions (3,) with 1 / (P L)."""
    if element not in KNOWN_LINES:
        turning = [interface for interface in element.interfaces if interface.rotations]
        if len(turning) > 1:
            lines = _lines_between(element, turning)
        else:
            lines = _line_from(element, turning[0]) if turning else _line_of_bar(element)
        KNOWN_LINES[element] = list(lines)
    return KNOWN_LINES[element]


def _lines_between(
    element: Superelement, interfaces: list[Interface]
) -> Iterator[tuple[Array, float]]:
    """Directions between interfaces with 1 / (P L) = c / pi^2, the softest first."""
    turning = _far_apart(interfaces)
    points = np.array([interface.X for interface in turning])
    rows = np.array([element.rows(interface.name).start + 3 for interface in turning])
    rotations = (rows[:, None] + np.arange(3)).ravel()
    n = len(turning)
    C = element.compliance[np.ix_(rotations, rotations)].reshape(n, 3, n, 3).transpose(0, 2, 1, 3)
    own = np.einsum("iiab->iab", C)
    i, j = np.triu_indices(n, 1)
    apart = points[j] - points[i]
    length = np.linalg.norm(apart, axis=1)
    distinct = length > 1e-6 * element.size
    i, j, e = i[distinct], j[distinct], apart[distinct] / length[distinct, None]
    # How far opposite unit moments at both ends turn these against each other.
    relative = own[i] + own[j] - C[i, j] - C[j, i]
    across = np.eye(3) - e[:, :, None] * e[:, None, :]
    softness = np.linalg.eigvalsh(across @ relative @ across)[:, -1] / np.pi**2
    chosen: list[Array] = []
    # Directions that are nearly parallel tell the same: the softest stands for them.
    for k in np.argsort(-softness):
        if len(chosen) < AXIAL_DIRECTIONS and all(
            abs(e[k] @ other) < PARALLEL_COSINE for other in chosen
        ):
            chosen.append(e[k])
            yield e[k], float(softness[k])


def _line_from(element: Superelement, end: Interface) -> Iterator[tuple[Array, float]]:
    """The direction from an interface to the center of mass, and 1 / (P L) by how it turns."""
    apart = float(np.linalg.norm(end.X))
    if apart <= 1e-6 * element.size:
        return
    e = end.X / apart
    turns = slice(element.rows(end.name).start + 3, element.rows(end.name).stop)
    across = np.eye(3) - np.outer(e, e)
    softest = np.linalg.eigvalsh(across @ element.compliance[turns, turns] @ across)[-1]
    yield e, float(softest) / TURN_OF_END / np.pi**2


def _far_apart(interfaces: list[Interface]) -> list[Interface]:
    """At most `MAX_AXIAL_INTERFACES` of them, each the farthest from those before it."""
    if len(interfaces) <= MAX_AXIAL_INTERFACES:
        return interfaces
    points = np.array([interface.X for interface in interfaces])
    chosen, distance = [], np.linalg.norm(points, axis=1)
    for _ in range(MAX_AXIAL_INTERFACES):
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return [interfaces[i] for i in chosen]


def _line_of_bar(element: Superelement) -> Iterator[tuple[Array, float]]:
    """The axis of least inertia, and 1 / (P L) of a uniform bar with the first frequency."""
    if element.modes is not None and len(element.modes.omega):
        axis: Array = np.linalg.eigh(element.J_rot)[1][:, 0]
        stiffness = float(element.modes.omega.min()) ** 2 * element.mass / FREE_BAR
        yield axis, 1.0 / (np.pi**2 * stiffness * element.size**2)


def _second_moment(element: Superelement, e: Array) -> float:
    """int (e . x)^2 dm about the center of mass [kg m^2]"""
    return float(0.5 * np.trace(element.J_rot) - e @ element.J_rot @ e)


def _dipole(element: Superelement, e: Array, factor: float) -> Array:
    weight = np.zeros(element.n_c)
    for interface in element.interfaces:
        first = element.rows(interface.name).start
        weight[first : first + 3] = factor * float(e @ interface.X) * e
    return weight
