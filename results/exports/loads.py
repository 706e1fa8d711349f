"""The loads of a flexible body at an instant, as decks of Abaqus and Nastran.

A static analysis of the mesh under them gives the stresses of that instant, but for the inertia of
the vibration within the body. Forces F_i and moments M_i of all interfaces, in body axes, are
balanced by the inertia of the rigid motion, as a body force at X from the center of mass,

    b(X) = -rho (a + alpha x X + omega x (omega x X))
    m a = sum F_i,    J alpha + omega x J omega = sum (X_i x F_i + M_i)

so a is the acceleration of the center of mass less gravity. Forces act at the undeformed places of
the interfaces, as linear statics has them.
"""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from ...files.arrays import Array
from ...superelement import Superelement
from ..errors import ExportError
from ..results import Results
from ..rotations import inverse, rotate
from ..steps import inside
from .folder import distinct, exported

At = float | Literal["worst"]
Program = Literal["abaqus", "nastran"]

# Far above the nodes of meshes, and below 100 000 000, where Nastran's numbers end.
FIRST_NODE = 90_000_001
# Nastran's LOAD card with this number combines the loads that follow it.
FIRST_SET = 9000
# The decks expect an element set of Abaqus with all elements of the body.
ALL_ELEMENTS = "EALL"
# Characters of a number in Nastran's large field format.
NASTRAN_FIELD_WIDTH = 16
FULL_TURN = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class Wrench:
    """A force (3,) [N] and a moment (3,) [N m] at a point X (3,) from the center of mass [m]."""

    X: Array
    force: Array
    moment: Array


@dataclass(frozen=True, eq=False)
class LoadSet:
    """The loads on a body at a time [s], in body axes, which are those of its mesh.

    interfaces: loads by name; patterns: amplitudes of load patterns by name; center (3,): of mass,
    in coordinates of the mesh [m]; acceleration (3,): of the center of mass less gravity [m/s^2];
    angular_velocity (3,) [rad/s], angular_acceleration (3,) [rad/s^2]; unit: of the mesh [m].
    """

    body: str
    time: float
    interfaces: Mapping[str, Wrench]
    patterns: Mapping[str, float]
    center: Array
    acceleration: Array
    angular_velocity: Array
    angular_acceleration: Array
    unit: float


def load_set(results: Results, body: str, at: At) -> LoadSet:
    """Collect the loads on a flexible body at one recorded step.

    Parameters
    ----------
    results : Results
    body : str
    at : float [s] or "worst"
        The recorded step nearest to a time, or that of the largest |F| + |M| / size at an
        interface.

    Returns
    -------
    LoadSet

    Raises
    ------
    ExportError
        Where the run did not record the body and all of its interfaces, or contacts press on it.
    RecoveryError
        Where the superelement is not there. See `write_loads` for an example.
    """
    if body in results.pressed:
        raise ExportError(
            f"body {body!r}: its surfaces are in contact, whose pressure is not exported: loads on "
            "interfaces alone would balance another motion"
        )
    element = results.superelement(body)
    wrenches = _wrenches(results, body, element)
    row = _worst(wrenches, element.size) if at == "worst" else _nearest(results.time, at)
    loads = {
        name: Wrench(each.X, each.force[row], each.moment[row]) for name, each in wrenches.items()
    }
    owned = (name for name in results.patterns if name.rpartition(".")[0] == body)
    patterns = {
        name.rpartition(".")[2]: float(results.pattern(name).load[row].item()) for name in owned
    }
    force = sum((each.force for each in loads.values()), np.zeros(3))
    moment = sum(
        (each.moment + np.cross(each.X, each.force) for each in loads.values()), np.zeros(3)
    )
    for pattern in element.patterns:
        amplitude = patterns.get(pattern.name, 0.0)
        force = force + amplitude * pattern.force
        moment = moment + amplitude * pattern.moment
    omega, J = results.body(body).v[row, 3:], element.J_rot
    return LoadSet(
        body=body,
        time=float(results.time[row]),
        interfaces=loads,
        patterns={name: amplitude for name, amplitude in patterns.items() if amplitude},
        center=element.center,
        acceleration=force / element.mass,
        angular_velocity=omega,
        angular_acceleration=np.asarray(
            np.linalg.solve(J, moment - np.cross(omega, J @ omega)), dtype=np.float64
        ),
        unit=_unit(element),
    )


def write_loads(
    results: Results,
    folder: str | os.PathLike[str],
    name: str,
    program: Program,
    bodies: Sequence[str] = (),
    at: At = "worst",
) -> tuple[Path, ...]:
    """Write the loads on flexible bodies at an instant as decks for Abaqus or Nastran.

    Abaqus: NAME-BODY-nodes.inp, for the model, and NAME-BODY-loads.inp, for a step; Nastran:
    NAME-BODY.bdf.

    Parameters
    ----------
    results : Results
    folder : path
    name : str
    program : {"abaqus", "nastran"}
    bodies : sequence of str
        By default all flexible bodies.
    at : float [s] or "worst"
        See `load_set`.

    Returns
    -------
    tuple of Path

    Raises
    ------
    ExportError
        Where there is no flexible body, or a file cannot be written; else as `load_set`.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import duhamel as du
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    >>> section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    >>> beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)], section=section)
    >>> beam.interface("root", (0.0, 0.0, 0.0))
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -9.81])
    >>> arm = m.add(beam.superelement(step=1e-4), name="arm")
    >>> fixed = m.add(du.joints.Fixed(m.ground, arm["root"]))
    >>> results = m.simulate(0.01, step=1e-4).results
    >>> with TemporaryDirectory() as folder:
    ...     [path.name for path in write_loads(results, folder, "run", "nastran")]
    ['run-arm.bdf']
    """
    chosen = tuple(bodies) or tuple(results.superelement_files)
    if not chosen:
        raise ExportError(
            "the run has no flexible body; loads are written for flexible bodies only"
        )
    sets = [load_set(results, body, at) for body in chosen]
    with exported(folder) as export:
        for stem, loads in zip(distinct(f"{name}-{body}" for body in chosen), sets, strict=True):
            for suffix, lines in DECKS[program].items():
                with export.file(f"{stem}{suffix}") as path:
                    path.write_text("".join(f"{line}\n" for line in lines(loads)), encoding="utf-8")
    return export.paths


def _wrenches(results: Results, body: str, element: Superelement) -> dict[str, Wrench]:
    """The loads of each interface at all steps, forces and moments (n, 3)."""
    names = [interface.name for interface in element.interfaces]
    missing = [name for name in names if f"{body}.{name}" not in results.frames]
    if body not in results.bodies or missing:
        raise ExportError(
            f"body {body!r}: expected the body and all of its interfaces in the results, but the "
            f"run did not record {', '.join(missing) or 'its position and rotation'}"
        )
    back = inverse(results.body(body).R)
    found = {}
    for interface in element.interfaces:
        wrench = results.frame(f"{body}.{interface.name}").force
        force, moment = rotate(back, wrench[:, :3]), rotate(back, wrench[:, 3:])
        found[interface.name] = Wrench(interface.X, force, moment)
    return found


def _worst(wrenches: Mapping[str, Wrench], size: float) -> int:
    sizes = [
        np.linalg.norm(each.force, axis=1) + np.linalg.norm(each.moment, axis=1) / size
        for each in wrenches.values()
    ]
    return int(np.max(sizes, axis=0).argmax())


def _nearest(time: Array, at: float) -> int:
    if not inside(np.append(time, at), time[0], time[-1])[-1]:
        raise ExportError(f"expected a time from {time[0]:.9g} to {time[-1]:.9g} s, found {at:.9g}")
    return int(np.abs(time - at).argmin())


def _unit(element: Superelement) -> float:
    """The unit of the coordinates of its mesh [m], `scale` of the body file that it keeps."""
    scale = element.provenance.tables.get("scale", 1.0)
    return float(scale) if isinstance(scale, int | float) else 1.0


def _heading(loads: LoadSet, comment: str) -> Iterator[str]:
    unit = loads.unit
    yield f"{comment} Loads on body {loads.body} at t = {loads.time:.9g} s, by Duhamel"
    yield (
        f"{comment} in axes of the mesh; unit of length {unit:g} m, forces in N, moments in N "
        "times it, densities in N s^2 over its fourth power"
    )
    yield (
        f"{comment} body force -rho (a + alpha x X + omega x (omega x X)), X from the center of "
        "mass; supports of a free body must have no reactions"
    )
    for name, amplitude in loads.patterns.items():
        yield f"{comment} add load pattern {name} times {amplitude:.15g}: it is in the balance"


def _nodes(loads: LoadSet) -> Iterator[tuple[int, str, Array]]:
    """Number, name and place in coordinates of the mesh of each interface."""
    for number, (name, each) in enumerate(loads.interfaces.items(), start=FIRST_NODE):
        yield number, name, (loads.center + each.X) / loads.unit


def _rates(loads: LoadSet) -> Iterator[tuple[str, float, Array]]:
    """The angular velocity and the angular acceleration that are not zero: size and direction."""
    both = {"velocity": loads.angular_velocity, "acceleration": loads.angular_acceleration}
    for what, vector in both.items():
        if size := float(np.linalg.norm(vector)):
            yield what, size, vector / size


def _abaqus_nodes(loads: LoadSet) -> Iterator[str]:
    yield from _heading(loads, "**")
    yield "** couple each node with the faces or nodes of its interface (*COUPLING)"
    for number, name, place in _nodes(loads):
        yield f"** interface {name}"
        yield "*NODE"
        yield ", ".join([str(number), *map(_exact, place.tolist())])


def _abaqus_loads(loads: LoadSet) -> Iterator[str]:
    yield from _heading(loads, "**")
    yield f"** for a step; element set {ALL_ELEMENTS} has all elements of the body"
    yield "*CLOAD"
    for (number, _, _), each in zip(_nodes(loads), loads.interfaces.values(), strict=True):
        values = [*each.force.tolist(), *(each.moment / loads.unit).tolist()]
        for dof, value in enumerate(values, start=1):
            if value:
                yield f"{number}, {dof}, {_exact(value)}"
    yield "*DLOAD"
    if size := float(np.linalg.norm(loads.acceleration)):
        along = (-loads.acceleration / size).tolist()
        yield _joined(ALL_ELEMENTS, "GRAV", size / loads.unit, *along)
    center = (loads.center / loads.unit).tolist()
    for what, rate, axis in _rates(loads):
        label, value = ("CENTRIF", rate**2) if what == "velocity" else ("ROTA", rate)
        yield _joined(ALL_ELEMENTS, label, value, *center, *axis.tolist())


def _exact(value: float) -> str:
    """A number that reads back to the same one, with a point as Abaqus has them."""
    return f"{value!r}"


def _joined(*items: str | float) -> str:
    return ", ".join(item if isinstance(item, str) else _exact(item) for item in items)


def _nastran(loads: LoadSet) -> Iterator[str]:
    yield from _heading(loads, "$")
    yield f"$ LOAD = {FIRST_SET} in the case control; RFORCE pushes outwards, RACC along R"
    yield "$ couple each grid with the faces or grids of its interface (RBE2, RBE3)"
    center = FIRST_NODE + len(loads.interfaces)
    for number, name, place in _nodes(loads):
        yield f"$ interface {name}"
        yield from _card("GRID", number, 0, *place.tolist())
    yield "$ center of mass"
    spc = "", 123456
    yield from _card("GRID", center, 0, *(loads.center / loads.unit).tolist(), *spc)
    cards = [
        _card(name, FIRST_SET + 1, number, 0, 1.0, *vector.tolist())
        for (number, _, _), each in zip(_nodes(loads), loads.interfaces.values(), strict=True)
        for name, vector in (("FORCE", each.force), ("MOMENT", each.moment / loads.unit))
        if vector.any()
    ]
    used = [FIRST_SET + 1] if cards else []
    if loads.acceleration.any():
        used.append(FIRST_SET + 2)
        along = (-loads.acceleration / loads.unit).tolist()
        cards.append(_card("GRAV", used[-1], 0, 1.0, *along))
    for what, rate, axis in _rates(loads):
        used.append(FIRST_SET + (3 if what == "velocity" else 4))
        turns = rate / FULL_TURN
        speeds = (turns, 0.0) if what == "velocity" else (0.0, -turns)
        head = (used[-1], center, 0, speeds[0], *axis.tolist())
        cards.append(_card("RFORCE", *head, 1, speeds[1]))
    for card in cards:
        yield from card
    scaled = [item for number in used for item in (1.0, number)]
    yield from _card("LOAD", FIRST_SET, 1.0, *scaled)


def _card(name: str, *fields: str | float) -> list[str]:
    """A card of Nastran in large fields, four a line."""
    lines = [fields[i : i + 4] for i in range(0, len(fields), 4)]
    starts = [f"{name}*", *["*"] * (len(lines) - 1)]
    return [
        f"{start:8s}" + "".join(_field(item) for item in line)
        for start, line in zip(starts, lines, strict=True)
    ]


def _field(value: str | float) -> str:
    """A number in 16 characters, with as many digits as fit."""
    if isinstance(value, str | int):
        return f"{value:>{NASTRAN_FIELD_WIDTH}}"
    for digits in range(12, 6, -1):
        text = f"{value:.{digits}E}"
        if len(text) <= NASTRAN_FIELD_WIDTH:
            return f"{text:>{NASTRAN_FIELD_WIDTH}}"
    return f"{value:{NASTRAN_FIELD_WIDTH}.6E}"


Lines = Callable[[LoadSet], Iterator[str]]
# The files of each program by the ends of their names.
DECKS: dict[Program, dict[str, Lines]] = {
    "abaqus": {"-nodes.inp": _abaqus_nodes, "-loads.inp": _abaqus_loads},
    "nastran": {".bdf": _nastran},
}
