"""From a body to its superelement on several processes, all of which run this."""

from dataclasses import replace
from typing import Any, cast

from ...superelement import Superelement
from ..assembly.channels import SelectedChannels, channel_rows, selected_channels
from ..assembly.losses import lossy_groups
from ..assembly.rigid import rigid_modes
from ..assembly.structure import (
    Attached,
    Structure,
    attach,
    check_size,
    interfaces_of,
    largest_entry,
)
from ..body.body import Body
from ..body.loss import scaled
from ..build import (
    MIN_INTERFACE_DOFS,
    checked_source,
    doubts_of_responses,
    memory_shortage_told,
    superelement_of,
)
from ..errors import MethodError
from ..plausibility import refused_where_singular
from ..progress import Stages, Warn, shown_stages
from ..responses.impulse import krylov_found, krylov_responses, require_memory
from ..responses.modal import FULL_MODAL_UNKNOWNS
from ..sources.solids import SolidSource
from .matrices import SpreadMass, SpreadMatrix
from .partition import neighbors, partition
from .pieces import Numbering, Piece, numbered, pieces
from .ranks import Ranks
from .shapes import AskedShapes, answer
from .solve import spread_solver

SPREAD_METHODS = ("auto", "krylov")  # values of impulse.method that more than one process can do


def build_together(body: Body, ranks: Ranks, progress: bool, warn: Warn) -> Superelement | None:
    """The superelement of a body, as `build` makes it, in the first process; None in the others.

    The first process reads the mesh, selects interfaces, and deals out the elements; each process
    assembles its own rows of K and M, and holds those of all vectors. Raises what `build` raises,
    and `MethodError` for what takes one process.
    """
    with (
        memory_shortage_told(),
        refused_where_singular(),
        shown_stages(progress and ranks.first, warn) as stages,
    ):
        return _build(body, ranks, stages)


def _build(body: Body, ranks: Ranks, stages: Stages) -> Superelement | None:
    with stages.stage("mesh"):
        source = ranks.in_first(lambda: _read(body, stages.warn))
    with stages.stage("assembly"):
        piece, numbering = _dealt_out(body, source, ranks)
        structure = _assembled(body, piece, ranks)
    with stages.stage("impulse"):
        wide = structure.with_channels()
        ranks.in_first(lambda: require_memory(body.impulse.steps, wide.P_C.shape[0]))
        solver = spread_solver(ranks, body.impulse.solver)
        modes, shapes, error = krylov_found(wide, body, stages, solver)
    if source is None or numbering is None:
        answer(shapes, ranks)
        return None
    asked = AskedShapes(shapes.V, shapes.Q, ranks=ranks, starts=numbering.starts)
    try:
        responses = krylov_responses(body, modes, asked, error)
        for doubt in doubts_of_responses(body, responses):
            stages.warn(doubt)
        whole = _of_first(structure, numbering)
        return superelement_of(body, source, whole, None, responses, stages)
    finally:
        # The others are about to end: a failure from here on is told by this process alone.
        ranks.apart = True
        asked.close()


def _read(body: Body, warn: Warn) -> SolidSource:
    """The mesh of a body of solids; `MethodError` for a body that takes one process."""
    require_memory(body.impulse.steps, MIN_INTERFACE_DOFS * len(body.interfaces))
    if body.impulse.method not in SPREAD_METHODS:
        raise MethodError(
            f"impulse.method {body.impulse.method} takes one process: expected krylov or auto, or "
            "no MPI"
        )
    if body.rotation is not None:
        raise MethodError("[rotation] takes one process: expected none, or no MPI")
    if body.surfaces:
        raise MethodError("[surfaces] take one process: expected none, or no MPI")
    if body.derivatives:
        raise MethodError("[derivatives] take one process: expected none, or no MPI")
    if body.measured is not None:
        raise MethodError("[measured] takes one process: expected none, or no MPI")
    if body.matrices is not None:
        raise MethodError("[matrices] take one process: expected a mesh of solids, or no MPI")
    source = checked_source(body, warn)
    if not isinstance(source, SolidSource):
        raise MethodError(
            f"{source.name}, no mesh of solids, takes one process: run it without MPI"
        )
    if body.impulse.method == "auto" and source.nodes.n_dofs <= FULL_MODAL_UNKNOWNS:
        raise MethodError(
            f"{source.name}: all modes of {source.nodes.n_dofs} unknowns are found at once by one "
            'process: run it without MPI, or with impulse.method = "krylov"'
        )
    source.check()
    return source


def _dealt_out(
    body: Body, source: SolidSource | None, ranks: Ranks
) -> tuple[Piece, Numbering | None]:
    """The piece of this process, and in the first one the numbering of all."""

    def prepared() -> tuple[Attached, SelectedChannels | None, Any]:
        assert source is not None
        attached = attach(body, source)
        channels = selected_channels(body, source, attached.T)
        return attached, channels, neighbors(source.facets)

    found = ranks.in_first(prepared)
    owners = partition(ranks.comm, None if found is None else found[2])

    def in_order() -> Numbering:
        assert source is not None
        assert found is not None
        assert owners is not None
        return numbered(source, found[0], found[1], owners, ranks.size)

    numbering = ranks.in_first(in_order)
    if source is None or numbering is None:
        return cast(Piece, ranks.comm.recv(source=0)), None
    dealt = pieces(source, numbering)
    own = next(dealt)
    for process, piece in enumerate(dealt, start=1):
        ranks.comm.send(piece, process)
    return own, numbering


def _assembled(body: Body, piece: Piece, ranks: Ranks) -> Structure:
    """The structure on the own unknowns."""
    name, comm = piece.source.name, ranks.comm
    stiffness, mass = piece.source.sums()
    K_rows, M_rows = piece.rows(stiffness), piece.rows(mass) + piece.lumped
    del stiffness, mass
    for what, rows in (("stiffness", K_rows), ("mass", M_rows)):
        check_size(name, what, ranks.largest(largest_entry(rows.data)))
    lossy = {}
    for group in lossy_groups(body):
        stiffer = replace(piece.source, body=scaled(piece.source.body, {group: 2.0}))
        lossy[group] = SpreadMatrix(piece.rows(stiffer.sums()[0]) - K_rows, comm)
    K, M = SpreadMatrix(K_rows, comm), SpreadMass(M_rows, comm)
    rigid = rigid_modes(piece.nodes, M, ranks)
    channels = piece.channels
    return Structure(
        nodes=piece.nodes,
        K=K,
        M=M,
        rigid=rigid,
        interfaces=interfaces_of(piece.frames, rigid.center),
        P_C=piece.P_C,
        T=None,
        frames=piece.frames,
        masses={},
        channels=None if channels is None else channel_rows(channels, rigid, M, ranks),
        lossy=lossy,
        processes=ranks,
    )


def _of_first(structure: Structure, numbering: Numbering) -> Structure:
    """The structure with what only the first process has: the displacements of all points."""
    attached = numbering.attached
    return replace(structure, T=attached.T, frames=attached.frames, masses=attached.masses)
