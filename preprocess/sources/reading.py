"""The choice of the source that a body file names."""

from pathlib import Path

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
    measured = () if body.measured is None else body.measured.files
    if isinstance(body.mesh, Path):
        return (*mesh_files(body.mesh), *measured)
    if body.matrices is None:
        return measured
    of_nodes = mesh_files(body.matrices.nodes) if body.matrices.nodes.is_file() else []
    return (*body.files, *of_nodes, *measured)


def mesh_of_body(body: Body, given: Path | Mesh) -> Mesh:
    """A mesh of a body as its elements use it: in meters, and of the order that is asked for."""
    # A mesh in memory was scaled when it was made.
    if isinstance(given, Mesh):
        mesh = given
    elif is_cad(given):
        mesh = mesh_of_cad(body, given)
    else:
        mesh = read_mesh(given, body.scale)
    return quadratic(mesh) if body.order == 2 else mesh


def read_mesh_source(body: Body) -> MeshSource:
    """Read the mesh of a body; `BodyError` for a body of matrices."""
    if body.mesh is None:
        raise BodyError("a dry run draws what was selected on a mesh, found [matrices]")
    mesh = mesh_of_body(body, body.mesh)
    if mesh.body_types == LINE_CELLS:
        if body.shell is not None or body.shells:
            raise BodyError(f"{mesh.name}: [shell] is for triangles and quadrangles, found lines")
        return LineSource(mesh, body)
    if set(mesh.body_types) <= set(FACET_TYPES):
        from .shells import ShellSource

        return ShellSource(divided(mesh), body)
    if body.shell is not None or body.shells:
        raise BodyError(
            f"{mesh.name}: [shell] is for a mesh of triangles and quadrangles alone, found "
            f"{', '.join(mesh.body_types)}: shells beside solids are not supported: make two "
            "bodies, and fix a rigid interface of one to one of the other"
        )
    # scikit-fem takes its time to import, and lines do without.
    from .solids import SolidSource

    return SolidSource(mesh, body)
