"""The finite element model that kernels are computed from: matrices, rigid modes and interfaces."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement import Interface
from ...superelement.validation import MAX_MAGNITUDE, Array
from ..body.body import Body
from ..errors import InterfaceError, MeshError
from ..mesh.nodes import Nodes
from ..processes import ONE_PROCESS, Processes
from .channels import ChannelRows, channel_rows, selected_channels
from .interfaces import Attachment, attachments
from .masses import lumped_mass, mass_selections
from .rigid import RigidModes, relieve, rigid_modes
from .source import Source
from .surfaces import Patches, selected_surfaces
from .ties import reduced, tie

RIGID_DOFS = 6  # dofs of a body that cannot deform


@dataclass(frozen=True, eq=False)
class Structure:
    """M u'' + K u = P_C^T p, free in space, in mesh axes.

    See `assemble` for an example.

    Parameters
    ----------
    nodes : Nodes
        The points of the dofs; of several processes, of the own ones.
    K, M : (n_u, n_u), sparse and symmetric
        [N/m ...] and [kg ...].
    rigid : RigidModes
        About the center of mass.
    interfaces : tuple of Interface
    P_C : (n_c, n_u), sparse
        u_C = P_C u, so that P_C^T p is the load of interface forces p.
    T : (3 n, n_u), sparse
        The displacements of the n points of the source are T u, tied ones included.
    frames, masses : mapping of str to Attachment
        Where interfaces and masses are attached to the source; a mass on an interface has its
        frame.
    inertia : (n_u, 6), optional
        F of the change d = F^T u of the moments of inertia, and so the loads of rotation; None
        where that is not asked for.
    channels : ChannelRows, optional
        Rows of load patterns and sensors.
    turns : (3 n, n_u), sparse, optional
        The rotations of the n points of the source, zeros for those that have none; None where none
        has.
    lossy : mapping of str to (n_u, n_u)
        K of each group whose material loses energy, where loss factors differ.
    surfaces : Patches, optional
        Those that other bodies may touch.
    processes : Processes
        Where there are several, each has its own rows of vectors (n_u, k), and columns of P_C.
    solvers : list of str
        What has solved with its matrices, in that order; copies with other rows share the list.
    """

    nodes: Nodes
    K: Any
    M: Any
    rigid: RigidModes
    interfaces: tuple[Interface, ...]
    P_C: Any
    T: Any
    frames: Mapping[str, Attachment]
    masses: Mapping[str, Attachment]
    inertia: Array | None = None
    channels: ChannelRows | None = None
    turns: Any | None = None
    lossy: Mapping[str, Any] = field(default_factory=dict)
    surfaces: Patches | None = None
    processes: Processes = ONE_PROCESS
    solvers: list[str] = field(default_factory=list)

    @property
    def n_u(self) -> int:
        """The unknowns of the whole body."""
        return int(self.M.shape[0])

    @cached_property
    def n_here(self) -> int:
        """Those whose vectors the memory of this machine has to hold."""
        return self.processes.on_this_machine(len(self.U))

    @property
    def n_c(self) -> int:
        """The dofs of the interfaces, the first rows of P_C."""
        return sum(6 if interface.rotations else 3 for interface in self.interfaces)

    def with_channels(self) -> "Structure":
        """The same with patterns and sensors as rows of P_C behind the interfaces.

        Without patterns that do not deform the body.
        """
        if self.channels is None:
            return self
        # A zero row would be a load without response, and a zero column in every basis.
        rows = self.channels.rows[self.channels.deforming]
        return replace(self, P_C=sp.vstack([self.P_C, rows], format="csr"))

    @cached_property
    def rows(self) -> dict[str, Any]:
        """The rows of P_C of every interface, by name."""
        sizes = [6 if interface.rotations else 3 for interface in self.interfaces]
        first = np.cumsum([0, *sizes])
        return {
            interface.name: self.P_C[start : start + size]
            for interface, start, size in zip(self.interfaces, first, sizes, strict=False)
        }

    @property
    def U(self) -> Array:
        """Rigid modes (n_u, 6) with U^T M U = I."""
        return self.rigid.U

    @cached_property
    def loads(self) -> Array:
        """P^T P_C^T (n_u, n_c): unit loads at the interfaces, made free of rigid acceleration."""
        return self.relieve(self.P_C.T.toarray())

    @cached_property
    def inertia_loads(self) -> Array:
        """P^T F (n_u, 6): loads of rotation, made free of rigid acceleration; (n_u, 0) without."""
        F = np.zeros((len(self.U), 0)) if self.inertia is None else self.inertia
        return self.relieve(F)

    def relieve(self, f: Array) -> Array:
        """P^T f (n_u, k): loads without their inertia relief."""
        return relieve(f, self.U, self.M, self.processes)

    def total(self, part: Array) -> Array:
        """The sum over all unknowns, from that over those of this process: total(U.T @ f)."""
        return self.processes.total(part)


@dataclass(frozen=True, eq=False)
class Attached:
    """A body on its source, but for the matrices of the latter.

    nodes: those of the dofs that are left once nodes follow rigid frames; T (n_source, n_u) sparse:
    the dofs of the source from them; rows (3 or 6, n_u) of each interface; lumped (n_u, n_u): the
    masses. All else is as in `Structure`.
    """

    nodes: Nodes
    T: Any
    rows: Mapping[str, Any]
    frames: Mapping[str, Attachment]
    masses: Mapping[str, Attachment]
    lumped: Any


def attach(body: Body, source: Source) -> Attached:
    """The interfaces and masses of a body on its source; `InterfaceError` as `attachments`."""
    try:
        frames = attachments("interfaces", body.interfaces, source)
        selected = attachments("masses", mass_selections(body), source)
        masses = {
            name: selected[name] if mass.interface is None else frames[mass.interface]
            for name, mass in body.masses.items()
        }
        # Masses come after ties, for they may sit on nodes that follow a frame.
        nodes, T, rows = tie(source.nodes, frames)
        selected_rows = {name: frame.rows @ T for name, frame in selected.items()}
        lumped = _symmetric(lumped_mass(body, rows, selected_rows, nodes.n_dofs))
    except InterfaceError as error:
        raise InterfaceError(f"{source.name}: {error}") from error
    if nodes.n_dofs <= RIGID_DOFS:
        raise MeshError(
            f"{source.name}: expected nodes that can move against each other, found all of them on "
            "rigid interfaces"
        )
    return Attached(nodes, T, rows, frames, masses, lumped)


def assemble_on(body: Body, source: Source) -> Structure:
    """The finite element model of a body on its source, with interfaces and masses.

        K_left = T^T K T,   M_left = T^T (M + sum rows^T diag(m I, J) rows) T

    on the dofs that are left once nodes follow rigid frames.
    """
    # What is too large is said of the sums.
    with np.errstate(over="ignore", invalid="ignore"):
        K, M = source.matrices()
    attached = attach(body, source)
    nodes, T = attached.nodes, attached.T
    # A frame on one node with six dofs leaves as many as there were, in another order.
    if n_tied := RIGID_DOFS * sum(frame.rigid for frame in attached.frames.values()):
        K = reduced(K, T, n_tied)
        M = reduced(M, T, n_tied)
    if attached.lumped.nnz:
        M = M + attached.lumped
    for what, matrix in (("stiffness", K), ("mass", M)):
        check_size(source.name, what, largest_entry(matrix.data))
    # From the matrix that is used, not from the geometry: both then agree to rounding.
    rigid = rigid_modes(nodes, M)
    channels = selected_channels(body, source, T)
    moved = T[source.nodes.displacements.ravel()]
    return Structure(
        nodes=nodes,
        K=K,
        M=M,
        rigid=rigid,
        interfaces=interfaces_of(attached.frames, rigid.center),
        P_C=sp.vstack([sp.csr_array((0, nodes.n_dofs)), *attached.rows.values()], format="csr"),
        T=moved,
        frames=attached.frames,
        masses=attached.masses,
        channels=None if channels is None else channel_rows(channels, rigid, M),
        turns=_turns(source.nodes, T),
        surfaces=selected_surfaces(body, source, attached.frames, moved, rigid.center),
    )


def interfaces_of(frames: Mapping[str, Attachment], center: Array) -> tuple[Interface, ...]:
    """The interfaces of frames, about the center of mass (3,)."""
    return tuple(Interface(name, frame.X - center, frame.rotates) for name, frame in frames.items())


def _turns(nodes: Nodes, T: Any) -> Any | None:
    """The rows (3 n, n_u) of the rotations of nodes, zeros for those without; None for no turn."""
    turning = nodes.first[nodes.rotations]
    if not len(turning):
        return None
    rows = T[(turning[:, None] + np.arange(3, 6)).ravel()]
    if len(turning) == len(nodes.points):
        return rows
    starts = np.zeros(3 * len(nodes.points) + 1, dtype=rows.indptr.dtype)
    starts[1:][np.repeat(nodes.rotations, 3)] = np.diff(rows.indptr)
    return sp.csr_array(
        (rows.data, rows.indices, np.cumsum(starts)), shape=(len(starts) - 1, rows.shape[1])
    )


def largest_entry(data: Array) -> float:
    """The largest absolute value, without the copy that absolute values are."""
    return max(float(data.max(initial=0.0)), -float(data.min(initial=0.0)))


def check_size(name: str, what: str, largest: float) -> None:
    """`MeshError` for a stiffness or mass whose largest entry has no bounds."""
    if not largest <= MAX_MAGNITUDE:
        raise MeshError(
            f"{name}: expected a {what} up to {MAX_MAGNITUDE:g}, found {largest}: look at the "
            "scale "
            "of the mesh, its sections or materials, and masses"
        )


def _symmetric(matrix: Any) -> Any:
    """The mean of a matrix and its transpose: symmetric to the last bit."""
    return (0.5 * (matrix + matrix.T)).tocsc()
