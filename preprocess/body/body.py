"""The body file: what a user writes to turn a mesh into a superelement."""

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field, NonNegativeFloat, PositiveFloat

from ...inputs import FORM_OF_NAMES, Table, expected, is_name, quoted, rule
from ...superelement import sha256
from ..mesh.mesh import Mesh
from .any_mesh import AnyMesh
from .cad import FaceSize, check_cad
from .damping import Damping, check_fit
from .derivative import Derivative, check_derivatives
from .impulse import Impulse, Method, SolverName
from .loads import LoadPattern
from .material import Material, Section
from .measured import Measured
from .named_body import NamedBody
from .selection import InterfaceSelection, Selection, SurfaceSelection
from .sensors import SensorPoint
from .shell import Shell
from .shell_checks import check_shells
from .values import FilePath, InertiaTensor

MAX_ROTATION_SHAPES = 32  # modes, or soft shapes, of which inertia and stiffness may depend


class PointMass(Selection):
    """A rigid piece that moves with an interface, or with a selection on the mesh.

    mass [kg]; inertia about its frame in mesh axes [kg m^2], principal values or a 3x3 matrix, none
    unless given. On facets or points of a solid it follows their mean motion.
    """

    mass: NonNegativeFloat
    inertia: InertiaTensor = ((0.0,) * 3,) * 3
    interface: str | None = None

    @rule
    def _one_place(self) -> None:
        others = self.selectors | self.model_fields_set & {"at"}
        if self.interface is not None and others:
            raise ValueError(
                f"interface stands alone, found it with {' and '.join(sorted(others))}"
            )
        if self.interface is None and not self.selectors:
            raise ValueError(
                "expected interface, or what it selects on the mesh: node, group, plane, "
                "..., found none"
            )

    @rule
    def _a_mass(self) -> None:
        # Rounding of a turned tensor may leave a tiny negative value, which is no mistake.
        J = np.array(self.inertia)
        if not np.array_equal(J, J.T) or np.linalg.eigvalsh(J)[0] < -1e-12 * np.abs(J).max():
            raise ValueError(
                "inertia: expected principal values or a symmetric matrix, "
                f"none of them negative, found {J.tolist()}"
            )
        if not (self.mass or J.any()):
            raise ValueError("expected a mass or an inertia, found neither")


class RecoveredFields(Table):
    """Fields that the superelement keeps: displacements of the surface or lines, perhaps stresses.

    stress: at the nodes of the surface of solids, for which the file grows by 24 bytes a node and
    mode.
    """

    stress: bool = False


class NonlinearCoordinates(Table):
    """The coordinates q of which interfaces, inertia and stiffness depend beyond the first order.

    modes: the lowest modes that loads or rotation stiffen. soft: shapes of the interfaces `loaded`
    (all unless given) that add what these modes lack, as many as matter ("auto") or that number.
    level 2 adds the energy of the fourth order, for thick and curved solids. Of matrices, which do
    not tell what loads stiffen, the lowest modes, and the softest shapes if a number is given.
    """

    modes: Annotated[int, Field(ge=1, le=MAX_ROTATION_SHAPES)] = 4
    soft: Annotated[
        Literal["auto"] | Annotated[int, Field(ge=0, le=MAX_ROTATION_SHAPES)],
        expected(f'"auto" or a number from 0 to {MAX_ROTATION_SHAPES}'),
    ] = "auto"
    loaded: Annotated[tuple[str, ...], expected("a list of interfaces")] | None = None
    level: Annotated[Literal[1, 2], expected("1 or 2")] = 1


class Matrices(Table):
    """Files of a finite element model of another program: K [N/m ...], M [kg ...], nodes [m].

    The body must be free in space. Nothing is scaled: all files must be in SI units.

    mass: the file of the stiffness unless given, where that holds both matrices. nodes: labels and
    coordinates; dofs: node and direction of every row of the matrices, where neither they say so
    nor the rows are three or six for each node in its order.
    """

    stiffness: FilePath
    mass: FilePath | None = None
    nodes: FilePath
    dofs: FilePath | None = None

    @property
    def files(self) -> dict[str, Path]:
        """The paths of the files by their keys."""
        # In the order in which messages and digests name them.
        return self.given("stiffness", "mass", "nodes", "dofs")

    def relative_to(self, folder: Path) -> "Matrices":
        return Matrices.model_validate({key: folder / path for key, path in self.files.items()})


class Body(NamedBody):
    """A body file: a mesh with materials or sections, or matrices; interfaces, or surfaces of
    solids; impulse responses.

    One of section and sections (by mesh group) for meshes of lines; one of material and materials
    for solids; with matrices none, or the material of elements beside them. For shells one of shell
    and shells (by mesh group), which take their materials from material, or by name from materials.
    scale: the unit of the mesh's coordinates in meters, 1e-3 for millimeters. All else is in SI
    units. order: 2 makes linear tetrahedra and wedges, which are too stiff in bending, tetrahedra
    with nodes in the middle of their edges. size [m]: of the elements that a CAD file is meshed
    with; sizes: smaller ones on holes and faces; solid: the name of one of its solids.

    Raises
    ------
    pydantic.ValidationError
        A ValueError that names each key, what was expected and what was found.

    Examples
    --------
    The keys are those of body files; `read_body` reads one.

    >>> rod = Body(
    ...     name="rod",
    ...     mesh="rod.msh",
    ...     material={"E": 210e9, "nu": 0.3, "rho": 7850.0},
    ...     interfaces={"tip": {"group": "tip"}},
    ...     impulse={"step": 1e-5, "steps": 1000},
    ... )
    >>> rod.impulse.method, rod.files
    ('auto', (PosixPath('rod.msh'),))
    """

    model_config = ConfigDict(
        json_schema_extra={"anyOf": [{"required": ["interfaces"]}, {"required": ["surfaces"]}]}
    )

    mesh: AnyMesh | None = None
    matrices: Matrices | None = None
    scale: PositiveFloat = 1.0
    order: Annotated[Literal[1, 2], expected("1 or 2")] = 1
    size: PositiveFloat | None = None
    sizes: dict[str, FaceSize] = Field(default_factory=dict)
    solid: str | None = None
    section: Section | None = None
    sections: dict[str, Section] = Field(default_factory=dict)
    material: Material | None = None
    materials: dict[str, Material] = Field(default_factory=dict)
    shell: Shell | None = None
    shells: dict[str, Shell] = Field(default_factory=dict)
    interfaces: dict[str, InterfaceSelection] = Field(default_factory=dict)
    surfaces: dict[str, SurfaceSelection] = Field(default_factory=dict)
    masses: dict[str, PointMass] = Field(default_factory=dict)
    loads: dict[str, LoadPattern] = Field(default_factory=dict)
    sensors: dict[str, SensorPoint] = Field(default_factory=dict)
    impulse: Impulse
    damping: Damping = Damping()
    recovery: RecoveredFields | None = None
    rotation: NonlinearCoordinates | None = None
    measured: Measured | None = None
    derivatives: dict[str, Derivative] = Field(default_factory=dict)

    @rule
    def _one_make(self) -> None:
        makes = ("section", "sections", "material", "materials")
        keys = [key for key in makes if getattr(self, key)]
        if self.mesh is None and self.matrices is None:
            raise ValueError("expected mesh or [matrices], found neither")
        if self.matrices is not None:
            # A material is that of elements beside the matrices, for stresses and stiffening.
            without = {"mesh", "scale", "order", "shell", "shells", *makes} - {"material"}
            others = self.model_fields_set & without
            if others:
                raise ValueError(
                    "matrices: expected no mesh and nothing made of it, "
                    f"found {', '.join(sorted(others))}"
                )
        elif len(keys) != 1:
            raise ValueError(
                f"expected one of {', '.join(makes)}, found {' and '.join(keys) or 'none'}"
            )

    @property
    def shells_by_key(self) -> dict[str, Shell]:
        """Shells by their keys in the file."""
        whole = self.given("shell")
        return whole | {f"shells.{name}": part for name, part in self.shells.items()}

    @property
    def ply_materials(self) -> set[str | None]:
        """Materials that shells have, by their names."""
        return {ply.material for shell in self.shells_by_key.values() for ply in shell.layers}

    @rule
    def _of_shells(self) -> None:
        check_shells(self)

    @rule
    def _of_cad(self) -> None:
        check_cad(self)

    @rule
    def _own_names(self) -> None:
        for table in ("interfaces", "surfaces", "masses", "loads", "sensors", "derivatives"):
            for name in getattr(self, table):
                if not is_name(name):
                    raise ValueError(
                        f"{table}: expected a name of {FORM_OF_NAMES}, found {quoted(name)}"
                    )
        for table in ("surfaces", "loads", "sensors"):
            for name in getattr(self, table):
                if name in self.interfaces:
                    raise ValueError(f"{table}: {quoted(name)} is the name of an interface")

    @rule
    def _places_that_are_there(self) -> None:
        if self.loads and self.matrices is not None:
            raise ValueError(
                "loads: expected a mesh, found [matrices], which tell neither surfaces nor volumes"
            )
        for table, selections in (("interfaces", self.interfaces), ("masses", self.masses)):
            for name, selection in selections.items():
                if selection.nodes is not None and self.matrices is None:
                    raise ValueError(
                        f"{table}.{name}: nodes are labels of [matrices]; "
                        "of a mesh use node or group"
                    )
        for name, mass in self.masses.items():
            if mass.interface is not None and mass.interface not in self.interfaces:
                known = ", ".join(self.interfaces)
                raise ValueError(
                    f"masses.{name}: no interface {mass.interface!r}; there are: {known}"
                )

    @rule
    def _surfaces_of_solids(self) -> None:
        if not (self.interfaces or self.surfaces):
            raise ValueError("expected [interfaces.NAME] or [surfaces.NAME], found neither")
        if not self.surfaces:
            return
        for key in ("matrices", "section", "sections", "shell", "shells"):
            if getattr(self, key):
                raise ValueError(f"surfaces: expected a mesh of solids, found {key}")
        for name in self.surfaces:
            if name in {*self.loads, *self.sensors}:
                raise ValueError(f"surfaces: {quoted(name)} is the name of a load or a sensor")
        impulse = self.impulse
        if impulse.band is None:
            raise ValueError(
                "impulse.band: surfaces need the frequency [Hz] up to which modes are kept, "
                "found none"
            )
        if impulse.method != "auto":
            raise ValueError(
                "impulse.method: with surfaces, whose modes are those of the band, expected auto, "
                f"found {impulse.method}"
            )
        if impulse.solver == "iterative":
            raise ValueError(
                "impulse.solver: surfaces need a factor: expected auto or factor, found iterative"
            )

    @rule
    def _rotation_of_elements(self) -> None:
        if self.rotation is None:
            return
        if self.impulse.method == "march":
            raise ValueError(
                "rotation: needs modes, which impulse.method march does not find: "
                "use auto, krylov, modal, craig-bampton or rubin"
            )
        if self.rotation.level == 2 and (self.section or self.sections):
            raise ValueError("rotation.level: expected 1 of lines, found 2, which is for solids")
        if self.rotation.level == 2 and self.shells_by_key:
            raise ValueError("rotation.level: expected 1 of shells, found 2, which is for solids")
        if self.rotation.level == 2 and self.matrices is not None:
            raise ValueError(
                "rotation.level: expected 1 of [matrices], found 2, which needs the elements of a "
                "mesh"
            )
        for name in self.rotation.loaded or ():
            if name not in self.interfaces:
                raise ValueError(
                    f"rotation.loaded: no interface {quoted(name)}; "
                    f"there are: {', '.join(self.interfaces)}"
                )

    @rule
    def _losses_in_a_band(self) -> None:
        losses, damping = self.loss_factors, self.damping
        # Without a band a loss factor would hold at all frequencies, which no material can.
        own = [key for key, part in self._parts.items() if part.loss_factor is not None]
        if own and damping.band is None:
            raise ValueError(
                f"{own[0]}.loss_factor: needs damping.band, the lowest and the highest frequency "
                "[Hz] at which it holds, found none"
            )
        if damping.band is not None:
            if not (own or damping.loss_factor is not None):
                raise ValueError("damping.band: belongs to a loss_factor, found none")
            for loss in losses.values():
                check_fit(loss, damping.band)
        stresses = [name for name, sensor in self.sensors.items() if sensor.kind == "stress"]
        if stresses and any(losses.values()):
            raise ValueError(
                f"sensors.{stresses[0]}: stress with a loss factor, which is not in its reading: "
                "expected direction, for a strain gauge; or [recovery] stress = true"
            )
        if self.impulse.method == "march" and len(set(losses.values())) > 1:
            raise ValueError(
                "impulse.method: march takes one loss factor for all materials, found "
                f"{len(set(losses.values()))}: use auto, krylov, modal, craig-bampton or rubin"
            )
        if self.rotation is not None and self.rotation.level == 2 and any(losses.values()):
            raise ValueError(
                "rotation.level: expected 1 with a loss factor, which the energy of level 2 does "
                "not have, found 2"
            )

    @rule
    def _measured_modes(self) -> None:
        if self.measured is None:
            return
        if self.impulse.method == "march":
            raise ValueError(
                "measured: needs modes, which impulse.method march does not find: "
                "use auto, krylov, modal, craig-bampton or rubin"
            )
        if self.damping.model_fields_set or any(self.loss_factors.values()):
            raise ValueError("damping: with [measured] it is that of the test, found another one")
        has_density = self.matrices is None and bool(self.material or self.materials)
        if self.measured.rigid.mass is not None and not has_density:
            raise ValueError(
                "measured.rigid.mass: scales the density of [material] or [materials], found none"
            )
        if self.measured.rigid.inertia is not None and self.rotation is not None:
            raise ValueError(
                "measured.rigid.inertia: expected no [rotation], whose terms have the inertia of "
                "the mesh"
            )

    @rule
    def _design_parameters(self) -> None:
        check_derivatives(self)

    @property
    def _parts(self) -> dict[str, Section | Material]:
        """Sections or materials by their keys in the file."""
        parts = self.given("section", "material")
        for key in ("sections", "materials"):
            parts.update({f"{key}.{name}": part for name, part in getattr(self, key).items()})
        return parts

    @property
    def solver(self) -> SolverName:
        """What solves with its matrices; of shells always a factor in double precision."""
        # Bending and stretch of thin shells lie too far apart for gradients, and for single digits.
        return "factor" if self.shells_by_key else self.impulse.solver

    @property
    def loss_factors(self) -> dict[str, float]:
        """Loss factors by the group of sections or materials; "" of a whole body."""
        usual = self.damping.loss_factor or 0.0
        found = {
            key.partition(".")[2]: usual if part.loss_factor is None else part.loss_factor
            for key, part in self._parts.items()
        }
        return found or {"": usual}

    @property
    def files(self) -> tuple[Path, ...]:
        """The file of the mesh, or those of the matrices; none of a mesh in memory."""
        mesh = (self.mesh,) if isinstance(self.mesh, Path) else ()
        matrices = () if self.matrices is None else self.matrices.files.values()
        return (*mesh, *matrices)

    @property
    def digests(self) -> str:
        """Digests of its mesh or matrices, its test and the meshes of its derivatives, by which a
        superelement knows them.
        """
        test = () if self.measured is None else self.measured.files
        mesh = [self.mesh.sha256] if isinstance(self.mesh, Mesh) else map(sha256, self.files)
        morphed = (one.mesh for one in self.derivatives.values() if one.mesh is not None)
        others = (one.sha256 if isinstance(one, Mesh) else sha256(one) for one in morphed)
        return ", ".join([*mesh, *map(sha256, test), *others])

    def relative_to(self, folder: Path) -> "Body":
        """A copy whose relative paths start from a folder."""
        paths: dict[str, Any] = {}
        if isinstance(self.mesh, Path):
            paths["mesh"] = folder / self.mesh
        if self.matrices is not None:
            paths["matrices"] = self.matrices.relative_to(folder)
        if self.measured is not None:
            paths["measured"] = self.measured.relative_to(folder)
        if self.derivatives:
            paths["derivatives"] = {
                name: one.relative_to(folder) for name, one in self.derivatives.items()
            }
        return self.model_copy(update=paths)

    def with_modes(self, method: Method, modes: int) -> "Body":
        """A copy of which the superelement has a number of modes, by one of `TRUNCATED_METHODS`.

        `pydantic.ValidationError`, a ValueError, for other methods and numbers below 1.
        """
        # Band, tolerance and solver belong to other methods, and would be refused with this one.
        kept = self.impulse.model_dump(include={"step", "steps", "rho_inf"})
        impulse = Impulse.model_validate({**kept, "method": method, "modes": modes})
        return self.model_copy(update={"impulse": impulse})

    def _values(self) -> dict[str, Any]:
        """All but the paths, which depend on the folder that the file is read from."""
        return self.model_dump(
            exclude={
                "mesh": True,
                "matrices": True,
                "measured": {"modes", "channels"},
                "derivatives": {"__all__": {"mesh"}},
            }
        )
