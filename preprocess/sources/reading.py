"""The choice of the source that a body file names."""

from pathlib import Path
from typing import cast

from ...cad import is_cad
from ..assembly.source import MeshSource, Source
from ..body.body import Body
from ..body.loss import relaxed, stiffenings
from ..body.measured_body import MeasuredBody
from ..body.reading import AnyBody
from ..errors import BodyError
from ..given.matrices import GivenModel, read_matrices
from ..mesh.cells import FACET_TYPES, LINE_CELLS
from ..mesh.divided import divided
from ..mesh.mesh import Mesh
from ..mesh.quadratic import quadratic
from ..mesh.reading import files_of as mesh_files
from ..mesh.reading import read_mesh
from .cad import mesh_of_cad
from .given import GivenSource
from .lines import LineSource


def read_source(body: Body) -> Source:
    """Read the files of a body; `PreprocessError` names the file that cannot be read.

    Materials with a loss factor have their static moduli.
    """
    if body.matrices is not None:
        return _given(read_matrices(body.matrices), body)
    return read_mesh_source(relaxed(body))


def _given(model: GivenModel, body: Body) -> GivenSource:
    """Given matrices, with the solid elements of the file of their nodes."""
    stiffening = stiffenings(body)[""]
    if model.mesh is None:
        return GivenSource(model, stiffening)
    # scikit-fem takes its time to import, and tables of nodes do without.
    from .given_elements import GivenElements

    return GivenSource(model, stiffening, GivenElements(model.mesh, model, relaxed(body)))


def files_of(body: AnyBody) -> tuple[Path, ...]:
    """All files that a body is read from, with those that they include.

    Parameters
    ----------
    body : Body

    Returns
    -------
    tuple of Path
        None of a mesh in memory.

    Raises
    ------
    MeshError
        Names a file that is missing or damaged.

    Examples
    --------
    >>> import duhamel as du
    >>> from duhamel.preprocess import mesh_of
    >>> mesh = mesh_of(([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]]))
    >>> part = du.Part(mesh, du.Material(E=210e9, nu=0.3, rho=7850.0))
    >>> part.interface("tip", (1, 0, 0))
    >>> files_of(part.body(step=1e-5))
    ()
    """
    if isinstance(body, MeasuredBody):
        return body.files
    meshes = [body.mesh, *(one.mesh for one in body.derivatives.values())]
    files = [file for mesh in meshes if isinstance(mesh, Path) for file in mesh_files(mesh)]
    files += () if body.measured is None else body.measured.files
    if body.matrices is None:
        return tuple(files)
    of_nodes = mesh_files(body.matrices.nodes) if body.matrices.nodes.is_file() else []
    return (*body.files, *of_nodes, *files)


def mesh_of_body(body: Body, given: Path | Mesh) -> Mesh:
    """A mesh of a body as its elements use it: in meters, and of the order that is asked for."""
    # A mesh in memory was scaled when it was made.
    if isinstance(given, Mesh):
        mesh = given.with_shells(body.shells)
        # Made with shells that this body does not have.
        mesh = mesh if mesh.used.all() else mesh.without_loose_nodes()
    elif is_cad(given):
        mesh = mesh_of_cad(body, given)
    else:
        mesh = read_mesh(given, body.scale, body.shells)
    return quadratic(mesh) if body.order == 2 else mesh


def read_mesh_source(body: Body) -> MeshSource:
    """Read the mesh of a body; `BodyError` for a body of matrices."""
    if body.mesh is None:
        raise BodyError("a dry run draws what was selected on a mesh, found [matrices]")
    return source_of(mesh_of_body(body, body.mesh), body)


def with_body(source: Source, body: Body) -> Source:
    """A source for other materials, loads or sensors, on the mesh that it has."""
    if body.matrices is not None:
        return read_source(body)
    return source_of(mesh_as_read(cast(MeshSource, source)), relaxed(body))


def mesh_as_read(source: MeshSource) -> Mesh:
    """The mesh that a source was made of; the one of solids and shells tells them not apart."""
    from .mixed import MixedSource

    return source.given if isinstance(source, MixedSource) else source.mesh


def source_of(mesh: Mesh, body: Body) -> MeshSource:
    """The source of a mesh, as its elements use it."""
    if mesh.body_types == LINE_CELLS:
        if body.shell is not None or body.shells:
            raise BodyError(f"{mesh.name}: [shell] is for triangles and quadrangles, found lines")
        return LineSource(mesh, body)
    if set(mesh.body_types) <= set(FACET_TYPES):
        from .shells import ShellSource

        _check_used(body)
        return ShellSource(divided(mesh), body)
    # scikit-fem takes its time to import, and lines do without.
    if body.shell is not None or body.shells:
        from .mixed import MixedSource

        return MixedSource(_with_all_shells(mesh, body), body)
    from .solids import SolidSource

    return SolidSource(mesh, body)


def _check_used(body: Body) -> None:
    """`BodyError` for a material that no shell has."""
    if unused := [name for name in body.materials if name not in body.ply_materials]:
        raise BodyError(f"materials.{unused[0]}: expected a shell of it, found none")


def _with_all_shells(mesh: Mesh, body: Body) -> Mesh:
    """A mesh with solids too; `BodyError` unless each group of [shells] has its shells in it."""
    if body.shell is not None:
        raise BodyError(
            f"{mesh.name}: beside {', '.join(mesh.body_types)} expected [shells.GROUP], which "
            "tells shells from facets of solids, found [shell]"
        )
    for name in body.shells:
        group = mesh.group(name)
        if len(group.loose):
            raise BodyError(
                f"shells.{name}: {len(group.loose)} nodes of the group were left out of the mesh "
                "when it was made: pass shells to mesh_of"
            )
        if not set(group.cells) & set(mesh.shells):
            raise BodyError(
                f"shells.{name}: expected triangles or quadrangles in the group, found "
                f"{', '.join(group.kinds) or 'nothing'}"
            )
    return mesh
