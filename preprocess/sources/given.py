"""Bodies given by the matrices of another program."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

from ...superelement.validation import Array
from ..assembly.interfaces import Attachment, nodal_frame, point_frame
from ..assembly.selected import nearest_node, table_nodes
from ..assembly.source import FieldPoints, Tensors
from ..body.loads import LoadPattern
from ..body.selection import Selection, SurfaceSelection
from ..body.sensors import SensorPoint
from ..elements.inertia import NodalTensors, scalar_mass
from ..errors import BodyError
from ..given.free_body import check_free_body
from ..given.matrices import GivenModel
from ..mesh.nodes import Nodes

if TYPE_CHECKING:
    from .given_elements import GivenElements


@dataclass(frozen=True, eq=False)
class GivenSource:
    """Stiffness and mass without elements; nodes have three dofs or six.

    stiffening: by which K is divided, to be the static one of a material with a loss factor.
    elements: those of the mesh that has the nodes, None where it has no solids.
    """

    model: GivenModel
    stiffening: float = 1.0
    elements: "GivenElements | None" = None
    geometry: None = None

    @property
    def name(self) -> str:
        return self.model.table.name

    @property
    def nodes(self) -> Nodes:
        return self.model.nodes

    def matrices(self) -> tuple[Any, Any]:
        # Matrices of a held body would simulate without complaint, and wrongly.
        check_free_body(self.model)
        K = self.model.K if self.stiffening == 1.0 else self.model.K / self.stiffening
        return K, self.model.M

    def tensors(self, M: Any, center: Array) -> Tensors:
        """Inertia and momentum, where nodes have three dofs of the same mass.

        With a material and elements beside the matrices, their stiffening too.
        """
        if self.elements is not None and self.elements.body.material is not None:
            return self.elements.tensors(M, center)
        M_s = None if self.nodes.rotations.any() else scalar_mass(M)
        if M_s is None:
            raise BodyError(
                f"[rotation]: {self.model.name}: expected nodes with three dofs and a mass that is "
                "the same in all directions, found another: it does not tell how the inertia "
                "changes"
            )
        return NodalTensors(self.name, M_s, self.nodes.points - center)

    def attachment(self, selection: Selection) -> Attachment:
        """The dofs of one node, or a frame with six that several carry."""
        table = self.model.table
        if selection.node is not None:
            return nodal_frame(nearest_node(selection, table.points, table.size), self.nodes)
        return point_frame(selection, table_nodes(selection, table), self.nodes)

    def touched(self, selection: SurfaceSelection) -> NoReturn:
        """`BodyError`: matrices tell no facets."""
        raise BodyError(f"[surfaces]: expected a mesh, found the matrices {self.model.name}")

    def forces(self, load: LoadPattern) -> NoReturn:
        """`BodyError`: matrices tell neither surfaces nor volumes."""
        raise BodyError(f"[loads]: expected a mesh, found the matrices {self.model.name}")

    def readings(self, sensor: SensorPoint) -> tuple[Any, Array]:
        """The motion of the node at a point."""
        if sensor.kind != "motion":
            raise BodyError(f"{sensor.kind}: expected a mesh, found the matrices {self.model.name}")
        table = self.model.table
        node = nearest_node(Selection(node=sensor.point), table.points, table.size)
        frame = nodal_frame(node, self.nodes)
        return frame.rows[:3], frame.X

    def check_fields(self, stress: bool) -> None:
        """`BodyError`: without elements there are neither cells nor strains."""
        self._some_elements().check_fields(stress)

    def field_points(self, stress: bool) -> FieldPoints:
        return self._some_elements().field_points(stress)

    def _some_elements(self) -> "GivenElements":
        if self.elements is None:
            raise BodyError(
                f"[recovery]: expected a mesh, found the matrices {self.model.name}: name a file "
                "with solid elements in matrices.nodes"
            )
        return self.elements
