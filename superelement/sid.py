"""Standard Input Data (SID) of a flexible body in a floating frame, for other multibody codes.

The frame has the axes and the origin of the mesh. It follows the mean motion of the body, so that
Ct = 0 and Cr = 0 at rest. With q the elastic coordinates, a and w' the accelerations of the frame,
w its angular velocity, all in its axes,

    [ m    mc~^T  Ct^T ] [ a   ]   [ w~ w~ mc + 2 w~ Ct^T q'     ]   [ sum f           ]
    [ mc~  J      Cr^T ] [ w'  ] + [ w~ J w + sum q'_j Gr_j w    ] = [ sum (m + r x f) ]
    [ Ct   Cr     Me   ] [ q'' ]   [ sum q'_j Ge_j w + Oe Omega  ]   [ h_e             ]

    h_e = sum (phi^T f + psi^T m) - Ke q - De q'
    Omega = [w1^2, w2^2, w3^2, w1 w2, w2 w3, w1 w3]

J, Cr, Oe, phi and psi are of first order in q where the superelement has [rotation]: Oe, phi and
psi then have the stiffening by stress of rotation and of loads on the frames. Stress of loads is
that of loads with the inertia that balances them, so that Ct and Cr need no stiffening.

Source: O. Wallrapp, Standardization of flexible body modeling in multibody system codes, Part I:
Definition of Standard Input Data, Mechanics of Structures and Machines 22 (1994) 283-304.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

import numpy as np

from ..files.arrays import Array
from .attachments import attachments
from .modes import Modes
from .superelement import Superelement
from .validation import SuperelementError

INERTIA_ORDER = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Entries of J in its six rows."""
SPIN_ORDER = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
"""Products of w in the six columns of Oe."""
_OWN_ORDER = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
"""Entries of J in the six rows of `Rotation`."""
_TO_INERTIA = [_OWN_ORDER.index(pair) for pair in INERTIA_ORDER]
_TO_SPIN = [_OWN_ORDER.index(pair) for pair in SPIN_ORDER]
# Squares count half in 1/2 w . J w, products of two components once.
_SPIN_SHARES = np.array([0.5, 0.5, 0.5, 1.0, 1.0, 1.0])


@dataclass(frozen=True, eq=False)
class Taylor:
    """A matrix M = m0 + sum q_k m1[:, k], m0 (rows, columns), of first order with m1 (rows, n_q,
    columns).
    """

    m0: Array
    m1: Array | None = None


@dataclass(frozen=True, eq=False)
class NodeFrame:
    """A frame on the body, one of the interfaces: its position, orientation and shapes.

    origin [m] and AP, the rotation to the axes of the body, are those of the deformed body to first
    order; phi and psi (3, n_q): displacements and rotations by q. Frames without rotations have
    psi = 0, and do not turn.
    """

    name: str
    origin: Taylor
    phi: Taylor
    psi: Taylor
    AP: Taylor


@dataclass(frozen=True, eq=False)
class StandardInputData:
    """The data of a flexible body, as the head of this file has them, in n_q coordinates.

    These are in sqrt(kg) m, for Me is the unit matrix. Columns of Gr (3, 3 n_q) and Ge (n_q, 3 n_q)
    go through all coordinates for w1, then for w2 and w3. J (6, 1) is 11, 22, 33, 12, 13, 23.
    coordinates: what each q is, in words.
    """

    name: str
    mass: float
    coordinates: tuple[str, ...]
    frames: tuple[NodeFrame, ...]
    mdCM: Taylor
    J: Taylor
    Ct: Taylor
    Cr: Taylor
    Me: Taylor
    Gr: Taylor
    Ge: Taylor
    Oe: Taylor
    ksigma: Taylor
    Ke: Taylor
    De: Taylor

    @property
    def n_q(self) -> int:
        """The number of elastic coordinates."""
        return len(self.coordinates)


def standard_input_data(e: Superelement, modes: int) -> StandardInputData:
    """The lowest modes of a superelement, and static responses to its interfaces beyond them.

    Parameters
    ----------
    e : Superelement
        With modes. Without [rotation] J is constant and Cr, Gr, Ge and Oe are zero.
    modes : int
        How many modes; all that there are if there are fewer.

    Raises
    ------
    SuperelementError
        For a body without modes.

    Examples
    --------
    A block of 2 kg with one interface, which vibrates along each axis:

    >>> import numpy as np
    >>> from duhamel.superelement import (
    ...     GeneralizedAlpha, Interface, Modes, Superelement, sample_kernel
    ... )
    >>> vibration = Modes(2.0 * np.pi * np.array([1e2, 2e2, 3e2]), np.zeros(3), phi=np.eye(3))
    >>> block = Superelement(
    ...     "block", mass=2.0, J_rot=np.eye(3), center=np.array([0.0, 0.0, 1.0]),
    ...     interfaces=(Interface("top", np.zeros(3), rotations=False),),
    ...     kernel=sample_kernel(vibration, 1e-4, GeneralizedAlpha(), steps=9), modes=vibration,
    ...     compliance=vibration.compliance, accelerance=vibration.accelerance,
    ... )
    >>> sid = standard_input_data(block, modes=1)
    >>> sid.coordinates[:2]
    ('Eigen Mode    1 :      100.000 Hz', 'Static Shape    1 :      200.000 Hz')
    >>> sid.J.m0.ravel().tolist()  # about the origin of the mesh
    [3.0, 3.0, 1.0, 0.0, 0.0, 0.0]
    """
    if e.modes is None:
        raise SuperelementError(
            f"{e.name}: expected modes, which impulse.method march does not find, found none"
        )
    Y, squares, coordinates = _coordinates(e.modes, modes)
    n_q, center = len(squares), e.center
    J = e.J_rot + e.mass * (center @ center * np.eye(3) - np.outer(center, center))
    second = _second_order(e, Y)

    def first_order(m1: Array) -> Array | None:
        return None if e.rotation is None else m1

    return StandardInputData(
        name=e.name,
        mass=e.mass,
        coordinates=coordinates,
        frames=tuple(_frames(e, e.modes.phi @ Y, second)),
        mdCM=Taylor(e.mass * center[:, None]),
        J=Taylor(
            np.array([[J[i, j]] for i, j in INERTIA_ORDER]),
            first_order(second.inertia[_TO_INERTIA, :, None]),
        ),
        Ct=Taylor(np.zeros((n_q, 3))),
        Cr=Taylor(np.zeros((n_q, 3)), first_order(second.momentum.transpose(2, 1, 0))),
        Me=Taylor(np.eye(n_q)),
        Gr=Taylor(second.gyroscopic_of_frame),
        Ge=Taylor(second.gyroscopic_of_coordinates),
        Oe=Taylor(
            -(_SPIN_SHARES[:, None] * second.inertia[_TO_SPIN]).T,
            first_order(-_SPIN_SHARES * second.inertia_slope[_TO_SPIN].transpose(2, 1, 0)),
        ),
        ksigma=Taylor(np.zeros((n_q, 1))),
        Ke=Taylor(np.diag(squares)),
        De=Taylor(Y.T @ ((2.0 * e.modes.zeta * e.modes.omega)[:, None] * Y)),
    )


def _coordinates(modes: Modes, count: int) -> tuple[Array, Array, tuple[str, ...]]:
    """Shapes Y (m, n_q) in the modes, orthonormal, their stiffnesses (n_q,), and what they are."""
    low = np.argsort(modes.omega, kind="stable")[:count]
    soft, squares = attachments(modes, low, np.arange(len(modes.phi)))
    Y = np.hstack([np.eye(len(modes.omega))[:, low], soft])
    frequencies = np.sqrt(squares) / (2.0 * pi)
    words = [f"Eigen Mode {i:4d} : {f:12.3f} Hz" for i, f in enumerate(modes.frequencies[low], 1)]
    words += [f"Static Shape {i:4d} : {f:12.3f} Hz" for i, f in enumerate(frequencies, 1)]
    return Y, np.concatenate([modes.omega[low] ** 2, squares]), tuple(words)


@dataclass(frozen=True, eq=False)
class _SecondOrder:
    """[rotation] in the coordinates q, zero without it.

    inertia (6, n_q) and inertia_slope (6, n_q, n_q): first and second derivatives of J, in the
    order of `Rotation`; momentum (3, n_q, n_q): the angular momentum is momentum(q, q'); frames
    (n_c, n_q, n_q): second derivatives of the displacements and rotations of interfaces.
    """

    inertia: Array
    inertia_slope: Array
    momentum: Array
    frames: Array

    @property
    def gyroscopic_of_frame(self) -> Array:
        """Gr (3, 3 n_q): J' w + w x (Cr^T q'), of which the second is zero to first order."""
        rows = [[_OWN_ORDER.index((min(i, k), max(i, k))) for k in range(3)] for i in range(3)]
        return self.inertia[rows].reshape(3, -1)

    @property
    def gyroscopic_of_coordinates(self) -> Array:
        """Ge (n_q, 3 n_q): the Coriolis forces w . (h(q', .) - h(., q'))."""
        both = self.momentum - self.momentum.transpose(0, 2, 1)
        return both.transpose(2, 0, 1).reshape(both.shape[2], -1)


def _second_order(e: Superelement, Y: Array) -> _SecondOrder:
    n_q = Y.shape[1]
    if e.rotation is None:
        none = np.zeros((6, n_q, n_q))
        return _SecondOrder(none[:, 0], none, none[:3], np.zeros((e.n_c, n_q, n_q)))
    T = e.rotation.T @ Y
    inertia_slope, momentum, frames = (
        T.T @ A @ T for A in (e.rotation.A_inertia, e.rotation.gyroscopic, e.rotation.A_interface)
    )
    return _SecondOrder(e.rotation.phi_inertia @ Y, inertia_slope, momentum, frames)


def _frames(e: Superelement, shapes: Array, second: _SecondOrder) -> Iterator[NodeFrame]:
    """shapes (n_c, n_q): displacements and rotations of the interfaces by q."""
    n_q, start = shapes.shape[1], 0

    def shape(rows: slice) -> Taylor:
        return Taylor(shapes[rows], None if e.rotation is None else second.frames[rows])

    for interface in e.interfaces:
        phi = shape(slice(start, start + 3))
        psi, AP = Taylor(np.zeros((3, n_q))), Taylor(np.eye(3))
        if interface.rotations:
            psi = shape(slice(start + 3, start + 6))
            AP = Taylor(np.eye(3), _skew(psi.m0))
        origin = Taylor((interface.X + e.center)[:, None], phi.m0[:, :, None])
        yield NodeFrame(interface.name, origin, phi, psi, AP)
        start += interface.n_dofs


def _skew(vectors: Array) -> Array:
    """The matrices v~ (3, n_q, 3) of vectors (3, n_q)."""
    x, y, z = vectors
    o = np.zeros_like(x)
    return np.array([[o, -z, y], [z, o, -x], [-y, x, o]]).transpose(0, 2, 1)
