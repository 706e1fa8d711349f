"""Elastic parts: a mesh with materials or sections and interfaces, which becomes a superelement."""

import html
import math
import os
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, Self, TypedDict, Unpack

import numpy as np
from duhamel import preprocess, view
from duhamel.cad import is_cad
from duhamel.inputs import InputError, Table, quoted, read_part
from duhamel.preprocess.body.body import PointMass
from duhamel.preprocess.body.cad import FaceSize
from duhamel.preprocess.body.damping import Damping
from duhamel.preprocess.body.derivative import Derivative
from duhamel.preprocess.body.impulse import Method, SolverName
from duhamel.preprocess.body.loads import LoadPattern
from duhamel.preprocess.body.material import Material, Section
from duhamel.preprocess.body.selection import InterfaceSelection, Selection, SurfaceSelection
from duhamel.preprocess.body.sensors import SensorPoint
from duhamel.preprocess.mesh.in_memory import mesh_of
from duhamel.superelement import Superelement
from numpy.typing import ArrayLike

from .pictures import Picture, embedded
from .selections import selection_of
from .vectors import vector

Where = Selection | str | ArrayLike
"""a selection, the name of a group of the mesh, or a point (3,) [m] for the node nearest to it"""
TABLE_KINDS: dict[str, type[Table]] = {
    "interfaces": InterfaceSelection,
    "surfaces": SurfaceSelection,
    "masses": PointMass,
    "loads": LoadPattern,
    "sensors": SensorPoint,
    "sizes": FaceSize,
    "derivatives": Derivative,
}
"""what body files give by name"""


class ImpulseOptions(TypedDict, total=False):
    """What impulse responses are asked for, as the keys of `[impulse]` in body files."""

    band: float
    """[Hz], up to where they are to be right; half the Nyquist frequency unless given"""
    method: Method
    """"modal", "krylov", "march", "craig-bampton" or "rubin", by default what fits the size"""
    modes: int
    """how many, of the methods "craig-bampton" and "rubin" """
    tolerance: float
    """the error of the transfer function in the band that "krylov" may make"""
    rho_inf: float
    """the spectral radius at infinite frequency"""
    solver: SolverName
    """"factor" or "iterative", by default what takes less time"""


class Part:
    """An elastic part on a mesh of solids, of shells or of lines.

    Parameters
    ----------
    mesh
        A mesh of scikit-fem, meshio, PyVista (an unstructured grid) or gmsh (the module, with a
        meshed model); a pair `(points, cells)`; or the path of a mesh file.
    properties : Material, Section, or one of them for each group by name
        Materials of solids, sections of lines.
    name : str
        Its name in messages and files.
    scale : float [m]
        The unit of length of the mesh: 1e-3 for millimeters. All else is in SI units.
    order : {1, 2}
        2 makes linear tetrahedra and wedges, which are too stiff in bending, tetrahedra with nodes
        in the middle of their edges.
    shell, shells : dict
        Of a mesh of triangles and quadrangles the thickness [m] and what else `[shell]` of body
        files has, of the whole mesh or of each group by name. Materials of groups are named there.
        Beside solids the shells are those in the groups.

    Examples
    --------
    A cantilever of two hexahedra, and its superelement:

    >>> import duhamel as du
    >>> import numpy as np
    >>> x, y, z = np.meshgrid([0.0, 0.5, 1.0], [0.0, 0.1], [0.0, 0.1], indexing="ij")
    >>> points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    >>> first = [0, 4, 6, 2, 1, 5, 7, 3]
    >>> cells = np.array([first, [node + 4 for node in first]])
    >>> part = du.Part((points, cells), du.Material(E=70e9, nu=0.33, rho=2700.0))
    >>> part.interface("root", du.plane(x=0.0))
    >>> part.interface("tip", du.plane(x=1.0))
    >>> part.superelement(step=2e-5)
    <Superelement 'part': 27 kg, at root, tip, 30 modes>
    """

    def __init__(
        self,
        mesh: Any,
        properties: Material | Section | Mapping[str, Material] | Mapping[str, Section],
        *,
        name: str = "part",
        scale: float = 1.0,
        order: Literal[1, 2] = 1,
        shell: Mapping[str, Any] | None = None,
        shells: Mapping[str, Mapping[str, Any]] | None = None,
    ) -> None:
        self.name = name
        self._table: dict[str, Any] = {"name": name, **_keyed(properties)}
        if shell is not None:
            self._table["shell"] = dict(shell)
        if shells is not None:
            self._table["shells"] = {group: dict(of) for group, of in shells.items()}
        if order != 1:
            self._table["order"] = order
        if isinstance(mesh, str | os.PathLike) and is_cad(Path(mesh)):
            raise preprocess.BodyError(
                f"{mesh}: is geometry, no mesh: use du.Part.from_step with the size of elements"
            )
        if isinstance(mesh, str | os.PathLike):
            self._table |= {"mesh": Path(mesh), "scale": scale}
        else:
            self._table["mesh"] = mesh_of(mesh, scale, shells or ())

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Self:
        """The part of a body file; its step and its method count where `body` is given none."""
        body = preprocess.read_body(path)
        if not isinstance(body, preprocess.Body):
            raise preprocess.BodyError(
                f"{path}: expected a mesh or matrices, found a test alone: use "
                "preprocess.build(preprocess.read_body(path))"
            )
        part = cls.__new__(cls)
        part.name = body.name
        part._table = {key: getattr(body, key) for key in body.model_fields_set}
        return part

    @classmethod
    def from_step(
        cls,
        path: str | os.PathLike[str],
        properties: Material | Mapping[str, Material],
        size: float,
        *,
        name: str | None = None,
        solid: str | None = None,
        scale: float | None = None,
    ) -> Self:
        """The part of a CAD file (.step, .iges, .brep), meshed with tetrahedra of ten nodes.

        It needs gmsh: `pip install 'duhamel[cad]'`. The file says its unit of length; what is
        selected is in meters, in the axes of the file: `du.hole`, `du.face`.

        Parameters
        ----------
        path : path
        properties : Material
        size : float [m]
            Of the elements; `refine` gives smaller ones on holes and faces.
        name : str
            Its name in messages and files, by default that of the file.
        solid : str
            The name of a solid, of a file with several.
        scale : float [m]
            The unit of length of a .brep file, which does not say it.

        Raises
        ------
        PreprocessError
            When the part is used: names the file, and what it does not have.
        """
        part = cls.__new__(cls)
        part.name = name or Path(path).stem
        part._table = {"name": part.name, **_keyed(properties), "mesh": Path(path), "size": size}
        part._table |= {} if solid is None else {"solid": solid}
        part._table |= {} if scale is None else {"scale": scale}
        return part

    def __repr__(self) -> str:
        interfaces = ", ".join(self._table.get("interfaces", ())) or "none"
        surfaces = ", ".join(self._table.get("surfaces", ()))
        held = f"interfaces: {interfaces}" + (f", surfaces: {surfaces}" if surfaces else "")
        return f"<Part {self.name!r} on {_named(self._table['mesh'])}, {held}>"

    def interface(
        self,
        name: str,
        where: Where,
        *,
        kind: Literal["average", "rigid"] = "average",
        at: ArrayLike | None = None,
    ) -> None:
        """Add an interface: a frame to which joints, loads and contacts may be attached.

        Parameters
        ----------
        name : str
        where
            What carries it: a selection, the name of a group, or a point for the nearest node.
        kind : {"average", "rigid"}
            Whether the frame follows the facets as their mean motion does, or stiffens them.
        at : (3,) [m]
            The position of the frame, by default the centroid of the facets.
        """
        selection = selection_of(where).model_dump(exclude_unset=True)
        if kind != "average":
            selection["kind"] = kind
        if at is not None:
            selection["at"] = vector(at)
        self._add("interfaces", name, selection)

    def derivative(
        self,
        name: str,
        *,
        key: str | None = None,
        powers: Mapping[str, float] | None = None,
        mesh: Any = None,
    ) -> None:
        """Give the superelement derivatives by a parameter of the part, of one of three kinds.

        Parameters
        ----------
        name : str
        key : str
            Of a number as in body files, as "section.EI_z" or "shell.thickness".
        powers : mapping of float
            Several such keys, that grow as these powers of the parameter, which is 1.
        mesh
            Another mesh with the same cells, in meters, toward which points move as the parameter
            grows from 0 to 1; or a file, in the unit of that of the part.
        """
        given = {"key": key, "powers": None if powers is None else dict(powers)}
        entry: dict[str, Any] = {key: one for key, one in given.items() if one is not None}
        if mesh is not None:
            entry["mesh"] = Path(mesh) if isinstance(mesh, str | os.PathLike) else mesh_of(mesh)
        self._add("derivatives", name, entry)

    def refine(self, name: str, where: Selection, size: float) -> None:
        """Give elements on a hole or face of a CAD file a smaller size.

        Parameters
        ----------
        name : str
        where
            `du.hole` or `du.face`.
        size : float [m]
        """
        self._add("sizes", name, {**where.model_dump(exclude_unset=True), "size": float(size)})

    def surface(self, name: str, where: Where) -> None:
        """Add a surface: facets that other bodies may touch, of which all nodes are kept.

        `superelement` then needs a `band`.

        Parameters
        ----------
        name : str
        where
            Facets of the boundary: a selection, or the name of a group.
        """
        self._add("surfaces", name, selection_of(where).model_dump(exclude_unset=True))

    def mass(
        self,
        name: str,
        mass: float,
        where: Where | None = None,
        *,
        interface: str | None = None,
        inertia: ArrayLike | None = None,
        at: ArrayLike | None = None,
    ) -> None:
        """Add a rigid piece that moves with an interface, or with what carries it on the mesh.

        Parameters
        ----------
        name : str
        mass : float [kg]
        where, interface
            One of them: what carries it on the mesh, or the name of an interface.
        inertia : (3,) or (3, 3) [kg m^2]
            About its frame in mesh axes, principal values or a matrix.
        at : (3,) [m]
            The position of its frame, by default the centroid of the facets.
        """
        piece: dict[str, Any] = {"mass": float(mass)}
        if where is not None:
            piece |= selection_of(where).model_dump(exclude_unset=True)
        if interface is not None:
            piece["interface"] = interface
        if inertia is not None:
            piece["inertia"] = np.asarray(inertia, dtype=np.float64).tolist()
        if at is not None:
            piece["at"] = vector(at)
        self._add("masses", name, piece)

    def load(
        self,
        name: str,
        where: Where | None = None,
        *,
        pressure: float | None = None,
        traction: ArrayLike | None = None,
        force_per_volume: ArrayLike | None = None,
        force_per_length: ArrayLike | None = None,
    ) -> None:
        """Add a load pattern, whose amplitude a `du.loads.PatternLoad` of a mechanism gives.

        Parameters
        ----------
        name : str
        where
            What it acts on; by default the whole part, for forces per volume or length.
        pressure : float [Pa]
            Against the outward normal of facets of solids.
        traction : (3,) [Pa]
            On facets of solids. Vectors are in mesh axes and turn with the part.
        force_per_volume : (3,) [N/m^3]
        force_per_length : (3,) [N/m]
            On lines.
        """
        vectors = {
            "traction": traction,
            "force_per_volume": force_per_volume,
            "force_per_length": force_per_length,
        }
        pattern: dict[str, Any] = {
            key: vector(value) for key, value in vectors.items() if value is not None
        }
        if pressure is not None:
            pattern["pressure"] = float(pressure)
        if where is not None:
            pattern |= selection_of(where).model_dump(exclude_unset=True)
        self._add("loads", name, pattern)

    def sensor(
        self,
        name: str,
        point: ArrayLike,
        *,
        direction: ArrayLike | None = None,
        length: float | None = None,
        stress: bool = False,
    ) -> None:
        """Add a sensor: a point that is read, and never loaded.

        Parameters
        ----------
        name : str
        point : (3,) [m]
            In mesh coordinates, within an element, or beside the axis of a beam.
        direction : (3,)
            That of a strain gauge; without one and without `stress` the motion is read.
        length : float [m]
            Over which a gauge takes the mean, at the point unless given.
        stress : bool
            Read the stresses at the point, of solids.
        """
        reading: dict[str, Any] = {"point": vector(point)}
        if direction is not None:
            reading["direction"] = vector(direction)
        if length is not None:
            reading["length"] = float(length)
        if stress:
            reading["stress"] = True
        self._add("sensors", name, reading)

    def damping(
        self,
        *,
        modal: float | None = None,
        loss_factor: float | None = None,
        band: Sequence[float] | None = None,
        reference_frequency: float | None = None,
        rayleigh: Mapping[str, Any] | None = None,
    ) -> None:
        """Set the damping; without it the part has none.

        Parameters
        ----------
        modal : float
            The ratio of every mode of the free part.
        loss_factor : float
            That of the material, the same at all frequencies of `band`, whatever holds the part.
        band : (2,) [Hz]
            The lowest and the highest frequency of the loss factor.
        reference_frequency : float [Hz]
            At which the moduli are those given; by default they are those at rest.
        rayleigh : dict
            `mass` [1/s] and `stiffness` [s], or `ratios` at two `frequencies` [Hz].
        """
        given = {
            "modal": modal,
            "loss_factor": loss_factor,
            "band": None if band is None else tuple(map(float, band)),
            "reference_frequency": reference_frequency,
            "rayleigh": None if rayleigh is None else dict(rayleigh),
        }
        table: dict[str, Any] = {key: value for key, value in given.items() if value is not None}
        self._table["damping"] = Damping(**table)

    def recover(self, *, stress: bool = False) -> None:
        """Keep the displacements of the whole surface, and perhaps its stresses, for pictures."""
        self._table["recovery"] = {"stress": stress}

    def rotation(
        self,
        *,
        modes: int = 4,
        soft: Literal["auto"] | int = "auto",
        loaded: Sequence[str] | None = None,
        level: Literal[1, 2] = 1,
    ) -> None:
        """Add what fast rotation and large loads change: terms of second order.

        Parameters
        ----------
        modes : int
            The lowest modes that loads or rotation stiffen.
        soft : "auto" or int
            Shapes of the interfaces that add what these modes lack.
        loaded : list of str
            The interfaces of these shapes, by default all.
        level : {1, 2}
            2 adds the energy of the fourth order, for thick and curved solids.
        """
        table: dict[str, Any] = {"modes": modes, "soft": soft, "level": level}
        if loaded is not None:
            table["loaded"] = tuple(loaded)
        self._table["rotation"] = table

    def measured(
        self,
        modes: str | os.PathLike[str],
        channels: str | os.PathLike[str],
        *,
        mass: float | None = None,
        inertia: ArrayLike | None = None,
        least_mac: float = 0.8,
    ) -> None:
        """Take frequencies and damping of a modal test; the shapes stay those of the mesh.

        Parameters
        ----------
        modes : path
            A table (.csv) or arrays (.npz) of frequencies, damping ratios and shapes.
        channels : path
            A table (.csv) of the places and directions of the sensors, in mesh axes [m].
        mass : float, optional [kg]
            That of the tested part: all densities are scaled.
        inertia : (3,), optional [kg m^2]
            The diagonal about the center of mass, in place of that of the mesh.
        least_mac : float
            The modal assurance criterion from which on a measured mode is one of the mesh.
        """
        rigid: dict[str, Any] = {} if mass is None else {"mass": mass}
        if inertia is not None:
            rigid["inertia"] = vector(inertia)
        self._table["measured"] = {
            "modes": Path(modes),
            "channels": Path(channels),
            "update": "frequencies",
            "least_mac": least_mac,
            "rigid": rigid,
        }

    def body(
        self,
        step: float | None = None,
        duration: float | None = None,
        **impulse: Unpack[ImpulseOptions],
    ) -> preprocess.Body:
        """The part with the impulse responses that are asked for, as a body file has it.

        The parameters are those of `superelement`.
        """
        known = ["step", "duration", *ImpulseOptions.__annotations__]
        if unknown := [name for name in impulse if name not in known]:
            raise preprocess.BodyError(
                f"part {self.name!r}: unknown keyword {unknown[0]!r}; known are {', '.join(known)}"
            )
        asked: dict[str, Any] = {"step": step, **impulse}
        if step is not None and duration is not None:
            asked["steps"] = _steps(duration, step)
        table, read = dict(self._table), self._table.get("impulse")
        before = {} if read is None else read.model_dump(exclude_unset=True)
        table["impulse"] = before | {
            key: value for key, value in asked.items() if value is not None
        }
        if "step" not in table["impulse"]:
            raise preprocess.BodyError(
                f"part {self.name!r}: step: expected that of the impulse responses [s], found none"
            )
        try:
            return read_part(table, preprocess.Body)
        except InputError as error:
            raise preprocess.BodyError(f"part {self.name!r}: {error}") from error

    def superelement(
        self,
        step: float | None = None,
        duration: float | None = None,
        *,
        progress: bool = False,
        **impulse: Unpack[ImpulseOptions],
    ) -> Superelement:
        """The superelement of the part, for `Mechanism.add`.

        Parameters
        ----------
        step : float [s]
            The time step of its impulse responses; runs may take other ones.
        duration : float [s]
            Of the impulse responses as they are sampled. Motions may last as long as they like.
        progress : bool
            Show on the terminal what is being done.
        **impulse
            `ImpulseOptions`: band, method, modes, tolerance, rho_inf, solver.

        Returns
        -------
        Superelement
            Its stated error is `kernel.error`.

        Raises
        ------
        PreprocessError
            If the part, its mesh or its method do not allow it.

        Warns
        -----
        PlausibilityWarning
            Of each thing that looks like a mistake: units, sizes, elements that are too stiff.
        """
        body = self.body(step, duration, **impulse)
        told = list(preprocess.doubts_of_body(body))
        built = preprocess.build(body, progress=progress, on_warning=told.append)
        for doubt in told:
            warnings.warn(f"{self.name}: {doubt}", preprocess.PlausibilityWarning, stacklevel=2)
        return built

    def draw(self, step: float = 1e-5) -> Picture:
        """Draw the part with its interfaces, masses and sensors, as the dry run does.

        Parameters
        ----------
        step : float [s]
            That of its impulse responses, as far as it is not known.
        """
        from duhamel.cli.survey import scene
        from duhamel.preprocess.survey import survey

        known = "impulse" in self._table
        return Picture(view.draw_scene(scene(survey(self.body(None if known else step)))))

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(repr(self))}</p>{embedded(self.draw()._repr_png_())}"

    def write(
        self,
        path: str | os.PathLike[str],
        step: float | None = None,
        duration: float | None = None,
        **impulse: Unpack[ImpulseOptions],
    ) -> None:
        """Write a body file for `duhamel preprocess`; a mesh in memory is written beside it.

        The other parameters are those of `superelement`.
        """
        preprocess.write_body(self.body(step, duration, **impulse), path)

    def _add(self, table: str, name: str, entry: dict[str, Any]) -> None:
        entries = dict(self._table.get(table, {}))
        if name in entries:
            raise preprocess.BodyError(
                f"part {self.name!r}: {table}: {quoted(name)} is there already"
            )
        try:
            entries[name] = read_part(entry, TABLE_KINDS[table])
        except InputError as error:
            raise preprocess.BodyError(f"part {self.name!r}: {table}: {name}: {error}") from error
        self._table[table] = entries


class Beam(Part):
    """An elastic part of beams in space.

    Parameters
    ----------
    points : (n, 3) [m]
        The nodes.
    lines : (m, 2)
        The nodes of each beam element; by default each node and the next one.
    section : Section
        Of all elements.
    name : str

    Examples
    --------
    >>> import duhamel as du
    >>> import numpy as np
    >>> points = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 21)
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    >>> section = du.Section.rectangle(steel, width=0.01, height=0.01)
    >>> beam = du.Beam(points, section=section)
    >>> beam.interface("root", points[0])
    >>> beam.interface("tip", points[-1])
    >>> beam.superelement(step=1e-5).mass.__round__(6)
    0.785
    """

    def __init__(
        self,
        points: ArrayLike,
        lines: ArrayLike | None = None,
        section: Section | None = None,
        *,
        name: str = "beam",
    ) -> None:
        nodes = np.asarray(points, dtype=np.float64)
        if lines is None:
            lines = np.column_stack([np.arange(len(nodes) - 1), np.arange(1, len(nodes))])
        if section is None:
            raise InputError("Beam: expected a section, found none")
        super().__init__((nodes, {"line": lines}), section, name=name)


def _keyed(properties: Any) -> dict[str, Any]:
    """Materials or sections by their keys in body files."""
    if isinstance(properties, Material):
        return {"material": properties}
    if isinstance(properties, Section):
        return {"section": properties}
    if isinstance(properties, Mapping) and properties:
        for key, kind in (("materials", Material), ("sections", Section)):
            if all(isinstance(value, kind) for value in properties.values()):
                return {key: dict(properties)}
    raise InputError(
        f"Part: expected a Material, a Section, or one of them for each group by name, "
        f"found {quoted(properties)}"
    )


def _named(mesh: Any) -> str:
    return mesh.name if hasattr(mesh, "points") else str(mesh)


def _steps(duration: float, step: float) -> int:
    if not (math.isfinite(duration) and duration > 0.0):
        raise InputError(f"duration: expected a positive number [s], found {duration}")
    return max(1, math.ceil(duration / step * (1.0 - 1e-9)))
