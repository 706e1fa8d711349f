"""The finite element model that kernels are computed from: mesh, matrices, rigid modes and
interfaces.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement import Interface
from ...superelement.validation import Array
from ..body.body import Body, Matrices
from ..body.material import Material, Section
from ..elements.beam import beam_matrices
from ..errors import BodyError, InterfaceError
from ..given.free_body import check_free_body
from ..given.matrices import GivenModel, read_matrices
from ..mesh.cells import LINES
from ..mesh.connectivity import check_connected, check_no_mechanism
from ..mesh.facets import facets_of
from ..mesh.mesh import IntArray, Mesh
from ..mesh.nodes import Nodes, node_dofs
from ..mesh.reading import read_mesh
from .interfaces import Attachment, attachments, node_attachments
from .masses import lumped_mass, placed_masses
from .rigid import RigidModes, relieve, rigid_modes
from .ties import tie


@dataclass(frozen=True, eq=False)
class Structure:
    """M u'' + K u = P_C^T p, free in space.

    nodes: the points of the dofs; K [N/m ...] and M [kg ...] (n_u, n_u) sparse and symmetric;
    rigid: the rigid modes about the centre of mass; interfaces, and P_C (n_c, n_u) sparse: u_C =
    P_C u, so that P_C^T p is the load of interface forces p; T (3 n, n_u) sparse: the displacements
    of the mesh's n points are T u, tied ones included. All in mesh axes.
    """

    nodes: Nodes
    K: Any
    M: Any
    rigid: RigidModes
    interfaces: tuple[Interface, ...]
    P_C: Any
    T: Any

    @property
    def n_u(self) -> int:
        return int(self.M.shape[0])

    @property
    def U(self) -> Array:
        """Rigid modes (n_u, 6) with U^T M U = I."""
        return self.rigid.U

    @cached_property
    def loads(self) -> Array:
        """P^T P_C^T (n_u, n_c): unit loads at the interfaces, made free of rigid acceleration."""
        return relieve(self.P_C.T.toarray(), self.U, self.M)


def assemble(body: Body) -> Structure:
    """The finite element model of a body, from its mesh or matrix files."""
    return assemble_on(body, read_source(body))


def read_source(body: Body) -> Mesh | GivenModel:
    """What the files of a body hold, before it is made into a model with interfaces and masses."""
    source = body.source
    return read_matrices(source) if isinstance(source, Matrices) else read_mesh(source, body.scale)


def assemble_on(body: Body, source: Mesh | GivenModel) -> Structure:
    """The finite element model of a body on what its files hold."""
    if isinstance(source, Mesh):
        return assemble_mesh(body, source)
    check_free_body(source)
    try:
        return _given_structure(body, source)
    except InterfaceError as error:
        raise InterfaceError(f"{source.table.name}: {error}") from error


def assemble_mesh(body: Body, mesh: Mesh) -> Structure:
    """The finite element model of a body on a mesh that is already read."""
    check_connected(mesh)
    try:
        return (
            _beam_structure(body, mesh)
            if mesh.body_types == LINES
            else _solid_structure(body, mesh)
        )
    except InterfaceError as error:
        raise InterfaceError(f"{mesh.name}: {error}") from error


def _beam_structure(body: Body, mesh: Mesh) -> Structure:
    nodes = Nodes(mesh.points, np.ones(len(mesh.points), dtype=bool))
    stiffness, mass = beam_matrices(mesh, _sections(body, mesh))
    dofs = node_dofs(mesh.cells["line"], 6)
    K, M = _scatter(stiffness, dofs, nodes.n_dofs), _scatter(mass, dofs, nodes.n_dofs)

    frames = attachments("interfaces", body.interfaces, mesh, nodes, None)
    rows = {name: frame.rows for name, frame in frames.items()}
    masses = attachments("masses", placed_masses(body), mesh, nodes, None)
    placed = {name: mass.rows for name, mass in masses.items()}
    T = sp.eye_array(nodes.n_dofs, format="csr")[nodes.displacements.ravel()]
    return _structure(nodes, K, M + _symmetric(lumped_mass(body, rows, placed)), frames, rows, T)


def _solid_structure(body: Body, mesh: Mesh) -> Structure:
    from ..elements.solid import solid_matrices

    nodes = Nodes(mesh.points, np.zeros(len(mesh.points), dtype=bool))
    K, M = solid_matrices(mesh, *materials_of(body, mesh))
    facets = facets_of(mesh)
    check_no_mechanism(mesh, facets)

    frames = attachments("interfaces", body.interfaces, mesh, nodes, facets)
    masses = attachments("masses", placed_masses(body), mesh, nodes, facets)
    return _tied_structure(body, nodes, K, M, frames, masses)


def _given_structure(body: Body, model: GivenModel) -> Structure:
    nodes = model.nodes
    frames = node_attachments("interfaces", body.interfaces, model.table, nodes)
    masses = node_attachments("masses", placed_masses(body), model.table, nodes)
    structure = _tied_structure(body, nodes, model.K, model.M, frames, masses)
    return replace(structure, T=structure.T[nodes.displacements.ravel()])


def _tied_structure(
    body: Body,
    nodes: Nodes,
    K: Any,
    M: Any,
    frames: Mapping[str, Attachment],
    masses: Mapping[str, Attachment],
) -> Structure:
    """On the dofs that are left once nodes follow rigid frames; T (n_u, n_left) gives those of all
    nodes.
    """
    left, T, rows = tie(nodes, frames)
    placed = {name: mass.rows @ T for name, mass in masses.items()}
    if left.n_dofs < nodes.n_dofs:
        K, M = (_symmetric(T.T @ matrix @ T) for matrix in (K, M))
    return _structure(left, K, M + _symmetric(lumped_mass(body, rows, placed)), frames, rows, T)


def _structure(
    nodes: Nodes, K: Any, M: Any, frames: Mapping[str, Attachment], rows: Mapping[str, Any], T: Any
) -> Structure:
    rigid = rigid_modes(nodes, M)
    interfaces = tuple(Interface(name, a.X - rigid.center, a.rotates) for name, a in frames.items())
    return Structure(
        nodes, K, M, rigid, interfaces, sp.vstack(list(rows.values()), format="csr"), T
    )


def _sections(body: Body, mesh: Mesh) -> list[Section]:
    """The section of every line."""
    if body.section is not None:
        return [body.section] * mesh.n_elements
    if not body.sections:
        raise BodyError(
            f"{mesh.name} is a mesh of lines: expected [section] or [sections.GROUP], "
            "found a material"
        )
    sections = list(body.sections.values())
    return [sections[i] for i in _owners(list(body.sections), mesh, "sections")]


def materials_of(body: Body, mesh: Mesh) -> tuple[list[Material], IntArray]:
    """The materials of a body of solids, and for every element (n_elements,) which of them it is
    made of.
    """
    if body.material is not None:
        return [body.material], np.zeros(mesh.n_elements, dtype=np.int64)
    if not body.materials:
        raise BodyError(
            f"{mesh.name} is a mesh of solids: expected [material] or [materials.GROUP], "
            "found a section"
        )
    return list(body.materials.values()), _owners(list(body.materials), mesh, "materials")


def _owners(groups: list[str], mesh: Mesh, key: str) -> IntArray:
    """The number of the group of every element (n,); `BodyError` unless it is in exactly one."""
    members = np.zeros((len(groups), mesh.n_elements), dtype=bool)
    for i, name in enumerate(groups):
        members[i, mesh.members(name)] = True
    count = members.sum(axis=0)
    if (count != 1).any():
        kind, row = mesh.element(int(np.flatnonzero(count != 1)[0]))
        raise BodyError(
            f"{mesh.name}: every element must be in exactly one of the groups of [{key}] "
            f"({', '.join(groups)}): {(count == 0).sum()} are in none and {(count > 1).sum()} in "
            f"several, first {kind} element {row}"
        )
    owner: IntArray = members.argmax(axis=0)
    return owner


def _scatter(blocks: Array, dofs: IntArray, n_dofs: int) -> Any:
    """The sum of element matrices (n, k, k) in rows and columns `dofs` (n, k)."""
    rows = np.broadcast_to(dofs[:, :, None], blocks.shape)
    columns = np.broadcast_to(dofs[:, None, :], blocks.shape)
    matrix = sp.coo_array((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(n_dofs, n_dofs))
    return _symmetric(matrix.tocsc())


def _symmetric(matrix: Any) -> Any:
    """The same matrix, symmetric to the last bit."""
    return (0.5 * (matrix + matrix.T)).tocsc()
