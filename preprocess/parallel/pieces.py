"""What each process gets of a body: its own unknowns, and the elements around them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp

from ..assembly.channels import SelectedChannels
from ..assembly.interfaces import Attachment
from ..assembly.structure import Attached
from ..errors import MethodError
from ..mesh.mesh import NO_NODES, IntArray
from ..mesh.nodes import Nodes
from ..sources.solids import SolidSource


@dataclass(frozen=True, eq=False)
class Piece:
    """The share of a process in a body of n_u unknowns, of which `own` are its own.

    source: all elements that an own unknown belongs to, so that the own rows of K and M need no
    others; T (n_source, n_u) sparse: their dofs from the unknowns. nodes: those of the own
    unknowns; P_C (n_c, n_own) and lumped (n_own, n_u), sparse; frames: the interfaces without what
    carries them.
    """

    source: SolidSource
    T: Any
    own: range
    n_u: int
    nodes: Nodes
    P_C: Any
    lumped: Any
    frames: dict[str, Attachment]
    channels: SelectedChannels | None

    def rows(self, matrix: Any) -> Any:
        """The own rows (n_own, n_u) of T^T A T, sparse, for A (n_source, n_source)."""
        own = self.T[:, self.own.start : self.own.stop]
        rows = (own.T @ matrix @ self.T).tocsr()
        rows.sort_indices()
        return rows


@dataclass(frozen=True, eq=False)
class Numbering:
    """The unknowns of a body in the order of the processes.

    attached, channels: the body, so numbered; owners (n_nodes,): the process of each node;
    starts (n_processes + 1,): where the unknowns of each begin.
    """

    attached: Attached
    channels: SelectedChannels | None
    owners: IntArray
    starts: IntArray


def numbered(
    source: SolidSource,
    attached: Attached,
    channels: SelectedChannels | None,
    parts: IntArray,
    size: int,
) -> Numbering:
    """The body with its unknowns in the order of `size` processes.

    parts (n_elements,): the process of every element. A node belongs to the first process that has
    an element with it, and a rigid frame to that of a node that follows it. `MethodError` where one
    is left without any.
    """
    of_source = np.full(len(source.mesh.points), size, dtype=np.int64)
    for kind, cells in source.mesh.elements.items():
        part = source.mesh.of_kind(parts, kind)
        # Any of the processes around a node would do, but it must be one and always the same.
        np.minimum.at(of_source, cells, part[:, None])
    followed = _of_nodes(attached.T, attached.nodes).tocsc()
    # The first node that follows an unknown: of a free node that is itself.
    owners = of_source[followed.indices[followed.indptr[:-1]]]

    order = np.argsort(owners, kind="stable")
    nodes = attached.nodes
    counts = np.where(nodes.rotations, 6, 3)
    dofs = np.repeat(nodes.first[order], counts[order]) + _within(counts[order])
    starts = np.cumsum([0, *np.bincount(owners, weights=counts, minlength=size)]).astype(np.int64)
    if (np.diff(starts) == 0).any():
        raise MethodError(
            f"{source.name}: {len(parts)} elements are too few for {size} processes: use fewer "
            "processes, or none"
        )
    renumbered = replace(
        attached,
        nodes=Nodes(nodes.points[order], nodes.rotations[order]),
        T=attached.T[:, dofs].tocsr(),
        rows={name: rows[:, dofs] for name, rows in attached.rows.items()},
        lumped=attached.lumped.tocsr()[dofs][:, dofs],
    )
    return Numbering(renumbered, _columns(channels, dofs), owners[order], starts)


def pieces(source: SolidSource, numbering: Numbering) -> Iterator[Piece]:
    """The piece of each process."""
    attached, starts = numbering.attached, numbering.starts
    followed = _of_nodes(attached.T, attached.nodes)
    P_C = sp.vstack(list(attached.rows.values()), format="csc")
    frames = {
        name: Attachment(frame.X, sp.csr_array((frame.rows.shape[0], 0)), NO_NODES)
        for name, frame in attached.frames.items()
    }
    for process in range(len(starts) - 1):
        own = range(int(starts[process]), int(starts[process + 1]))
        mine = numbering.owners == process
        around = followed @ mine.astype(float) > 0.0
        elements = np.concatenate(
            [around[cells].any(axis=1) for cells in source.mesh.elements.values()]
        )
        part, points = source.part(np.flatnonzero(elements))
        dofs = (3 * points[:, None] + np.arange(3)).ravel()
        nodes = attached.nodes
        yield Piece(
            source=part,
            T=attached.T[dofs],
            own=own,
            n_u=int(starts[-1]),
            nodes=Nodes(nodes.points[mine], nodes.rotations[mine]),
            P_C=P_C[:, own.start : own.stop].tocsr(),
            lumped=attached.lumped[own.start : own.stop],
            frames=frames,
            channels=_columns(numbering.channels, slice(own.start, own.stop)),
        )


def _of_nodes(T: Any, nodes: Nodes) -> Any:
    """The pattern (n_source_nodes, n_nodes) of T (3 n_source_nodes, n_u)."""
    entries = T.tocoo()
    ones = np.ones(len(entries.row))
    place = (entries.row // 3, nodes.owner[entries.col])
    return sp.coo_array((ones, place), shape=(T.shape[0] // 3, len(nodes.points))).tocsr()


def _within(counts: IntArray) -> IntArray:
    """0, 1, ..., counts - 1 for each of the counts."""
    first = np.cumsum(counts) - counts
    return np.arange(counts.sum()) - np.repeat(first, counts)


def _columns(channels: SelectedChannels | None, dofs: Any) -> SelectedChannels | None:
    """Channels on some of the unknowns, or on all in another order."""
    if channels is None:
        return None
    forces = {name: f[dofs] for name, f in channels.forces.items()}
    readings = {
        name: (kind, X, rows[:, dofs]) for name, (kind, X, rows) in channels.readings.items()
    }
    return SelectedChannels(forces, readings)
