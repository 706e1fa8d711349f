"""What a run leaves behind: an HDF5 file, written as the run goes on, and `Results`, which reads it.

Every dataset has the time steps, t = 0 included, along its first axis and its units as an attribute. Between writes
the file is closed, so that a run that is killed leaves what it had: the first `written` rows, an attribute of /solver.
"""

import io
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from ..superelement import GeneralizedAlpha, Recovery, Superelement, SuperelementError, sha256, von_mises
from .compilation import CompiledModel
from .compiled import Array
from .errors import ModelError, RecoveryError
from .model import GROUND
from .recovery import Instants, Stepping, instants, interface_loads, modal_coordinates, place, read_again
from .system import Output

FORMAT = "duhamel-results"
VERSION = 1


class _Column(NamedTuple):
    """A dataset: its units, and the field of the output that holds it, with what to take of each row."""

    units: str
    field: str
    part: tuple[int | slice, ...] = ()

    def rows(self, output: Output, n: int) -> Any:
        return getattr(output, self.field)[(slice(n), *self.part)]


class ResultsFile:
    """Appends chunks of output to a file, or to memory where no path is given."""

    def __init__(self, path: Path | None, compiled: CompiledModel) -> None:
        self._path = path
        self._memory = None if path else h5py.File(io.BytesIO(), "w")
        self._columns = _columns(compiled)
        self._h = compiled.h
        self._superelements = {name: body.superelement for name, body in compiled.model.flexible_bodies.items()}
        self._energy_start: tuple[float, float] | None = None
        with self._open("w") as file:
            _describe(file, compiled)

    def append(self, first: int, output: Output, n: int) -> None:
        """Write the first n rows of the output: the steps from `first` on."""
        with self._open("a") as file:
            _extend(file, "time", "s", self._h * np.arange(first, first + n), first)
            for name, column in self._columns.items():
                _extend(file, name, column.units, column.rows(output, n), first)
            for name, values in self._balances(output, n).items():
                _extend(file, f"energy/{name}", "J", values, first)
        # Rows count once they are all in the file: a run can be killed while it writes them.
        self.note(written=first + n)

    def _balances(self, output: Output, n: int) -> dict[str, Array]:
        """What dampers took, and what is missing in the sum of all energies; both 0 at the start."""
        kinetic, elastic, springs, potential, work, compliance_work, _ = output.energy[:n].T
        if self._energy_start is None:
            self._energy_start = (springs[0], (kinetic + elastic + springs + potential)[0])
        springs_start, total_start = self._energy_start
        dissipated = -compliance_work - (springs - springs_start)
        balance = kinetic + elastic + springs + potential + dissipated - work - total_start
        return {"dissipated": dissipated, "balance": balance}

    def note(self, **attributes: Any) -> None:
        """Attributes of the group /solver."""
        with self._open("a") as file:
            file["solver"].attrs.update(attributes)

    def results(self) -> "Results":
        return Results(self._memory or self._path, self._superelements)

    @contextmanager
    def _open(self, mode: str) -> Iterator[h5py.File]:
        if self._memory is not None:
            yield self._memory
        else:
            with h5py.File(self._path, mode) as file:
                yield file


@dataclass(frozen=True, eq=False)
class BodyMotion:
    """Motion of a centre of mass and of body axes."""

    x: Array
    """(n, 3) position in space [m]"""
    R: Array
    """(n, 4) unit quaternion (w, x, y, z), body axes to space"""
    v: Array
    """(n, 6) velocity in space [m/s], angular velocity in body axes [rad/s]"""
    v_dot: Array
    """(n, 6) their derivatives"""


@dataclass(frozen=True, eq=False)
class FrameMotion:
    """Motion of a frame and the wrench on its body there."""

    position: Array
    """(n, 3) in space [m]"""
    rotation: Array
    """(n, 4) unit quaternion, frame axes to space"""
    velocity: Array
    """(n, 6) velocity [m/s] and angular velocity [rad/s], in space"""
    acceleration: Array
    """(n, 6) their derivatives"""
    u: Array
    """(n, 6) elastic displacement [m] and rotation [rad] in body axes, 0 on rigid bodies"""
    force: Array
    """(n, 6) force [N] and moment [N m] of joints and loads on the body, in space"""


@dataclass(frozen=True, eq=False)
class Coupling:
    multipliers: Array
    """(n, rows) one per row of the joint, in the order of its table [N, N m]"""
    force: Array
    """(n, 3) on the second body, in space [N]"""
    moment: Array
    """(n, 3) on the second body about its frame, in space [N m]"""
    coordinates: dict[str, Array]
    """(n,) joint coordinates and their rates by name: angle [rad], angle_rate, distance [m], distance_rate, ...

    Of a spring "coordinates" (n, rows). Angles go on over full turns.
    """


@dataclass(frozen=True, eq=False)
class Energy:
    """Energies over time (n,) [J].

    kinetic (of the rigid motion), elastic (vibration included, from the work of interface loads), springs, potential
    (gravity), work (of loads and drives), dissipated (by dampers); balance: the sum of all but work, plus dissipated,
    less work and less its value at t = 0. modal: the same energy as elastic, from the modes themselves; None where
    some body convolves a kernel directly. Where elastic falls below zero, the convolution has created energy.
    """

    kinetic: Array
    elastic: Array
    springs: Array
    potential: Array
    work: Array
    dissipated: Array
    balance: Array
    modal: Array | None = None


@dataclass(frozen=True, eq=False)
class Momentum:
    """Linear (n, 3) [kg m/s] and angular momentum about the origin (n, 3) [kg m^2/s], in space."""

    linear: Array
    angular: Array


class Results:
    """The results of a run; arrays are read when asked for, and between reads the file is closed.

    Fields of flexible bodies (`displacement`, `stress`, `von_mises`, `position`) are superposed from the modes of
    their superelements, at times t [s], one or several (k,), of the run; between steps they are linear in time. They
    take one pass over the steps before t: ask for many times at once. `RecoveryError` says what is missing.
    """

    def __init__(self, source: h5py.File | Path, superelements: Mapping[str, Superelement] | None = None) -> None:
        self._source = source
        self._superelements = dict(superelements or {})

    @classmethod
    def read(cls, path: str | os.PathLike[str], superelements: Mapping[str, Superelement] | None = None) -> "Results":
        """Open a results file; ValueError if it is none.

        superelements: by body, for fields, where the files that the run read are no longer where they were.
        """
        results = cls(Path(path), superelements)
        try:
            with results._open() as file:
                found = file.attrs.get("format")
        except OSError as error:
            raise ValueError(f"{path}: not a readable HDF5 file: {error}") from error
        if found != FORMAT:
            raise ValueError(f"{path}: attribute format: expected {FORMAT!r}, found {found!r}")
        return results

    @property
    def time(self) -> Array:
        """(n,) [s]"""
        return self._array("time")

    @property
    def energy(self) -> Energy:
        return Energy(**self._group("energy"))

    @property
    def iterations(self) -> Array:
        """(n,) Newton iterations of each step"""
        return self._array("solver/iterations")

    @property
    def residual(self) -> Array:
        """(n,) relative residual of each step"""
        return self._array("solver/residual")

    @property
    def solver(self) -> dict[str, Any]:
        """How the run went: steps, step size, seconds, rule, history, ..."""
        with self._open() as file:
            return dict(file["solver"].attrs)

    def body(self, name: str) -> BodyMotion:
        return BodyMotion(**self._group(f"bodies/{name}"))

    def frame(self, name: str) -> FrameMotion:
        """A frame as "BODY.FRAME"."""
        return FrameMotion(**self._group(f"frames/{name}"))

    @property
    def momentum(self) -> Momentum:
        return Momentum(**self._group("momentum"))

    def joint(self, name: str) -> Coupling:
        """A joint or a prescribed motion."""
        return self._coupling(f"joints/{name}")

    def spring(self, name: str) -> Coupling:
        return self._coupling(f"springs/{name}")

    def displacement(self, body: str, t: Any) -> Array:
        """Elastic displacements of the points of the recovery, (p, 3) or (k, p, 3), in body axes [m]."""
        recovery, eta, _ = self._recover(body, t)
        return recovery.displacement(eta).reshape(*np.shape(t), -1, 3)

    def stress(self, body: str, t: Any) -> Array:
        """Stresses xx, yy, zz, yz, xz, xy at these points, (p, 6) or (k, p, 6), in body axes [Pa]."""
        recovery, eta, _ = self._recover(body, t)
        try:
            return recovery.stresses(eta).reshape(*np.shape(t), -1, 6)
        except SuperelementError as error:
            raise RecoveryError(f"body {body!r}: {error}") from error

    def von_mises(self, body: str, t: Any) -> Array:
        """The equivalent stress at these points, (p,) or (k, p) [Pa]."""
        return von_mises(self.stress(body, t))

    def position(self, body: str, t: Any) -> Array:
        """Where these points are in space, x + R (X + u), (p, 3) or (k, p, 3) [m]."""
        recovery, eta, when = self._recover(body, t)
        motion = self.body(body)
        x, R = (when.of(rows[when.before], rows[when.after]) for rows in (motion.x, motion.R))
        return place(x, R, recovery.points + recovery.displacement(eta)).reshape(*np.shape(t), -1, 3)

    def superelement(self, body: str) -> Superelement:
        """The superelement of a flexible body, read again from its file if need be; `RecoveryError` if it changed."""
        if body not in self._superelements:
            with self._open() as file:
                hashes = file["superelements"].attrs
                paths = file["superelements/files"].attrs if "files" in file["superelements"] else {}
                digest, path = hashes.get(body), paths.get(body)
            self._superelements[body] = read_again(body, path, digest)
        return self._superelements[body]

    def _recover(self, body: str, t: Any) -> tuple[Recovery, Array, Instants]:
        """The recovery of a body, its modal coordinates (k, m) at times t (k,), and where these lie."""
        element = self.superelement(body)
        if element.recovery is None or element.modes is None:
            raise RecoveryError(
                f"body {body!r}: superelement {element.name!r} holds no recovery, for which its body file needs a "
                f"table [recovery]"
            )
        when = instants(self.time, np.atleast_1d(np.asarray(t, dtype=float)))
        R = self.body(body).R
        frames = [(self.frame(f"{body}.{interface.name}"), interface.rotations) for interface in element.interfaces]
        p = np.hstack([interface_loads(R, frame.u, frame.force, rotations) for frame, rotations in frames])
        both = modal_coordinates(element.modes, p, self._stepping, np.concatenate([when.before, when.after]))
        return element.recovery, when.of(*np.split(both, 2)), when

    @property
    def _stepping(self) -> Stepping:
        run = self.solver
        return Stepping(float(run["h"]), GeneralizedAlpha(float(run["rho_inf"])), str(run["rule"]), str(run["start"]))

    def _coupling(self, name: str) -> Coupling:
        data = self._group(name)
        forces = {key: data.pop(key) for key in ("multipliers", "force", "moment")}
        return Coupling(**forces, coordinates=data)

    def _group(self, name: str) -> dict[str, Array]:
        with self._open() as file:
            if name not in file:
                parent = name.partition("/")[0]
                raise KeyError(f"no {name}; there are: {', '.join(file[parent])}")
            return {key: dataset[: _written(file)] for key, dataset in file[name].items()}

    def _array(self, name: str) -> Array:
        with self._open() as file:
            array: Array = file[name][: _written(file)]
        return array

    @contextmanager
    def _open(self) -> Iterator[h5py.File]:
        if isinstance(self._source, h5py.File):
            yield self._source
        else:
            with h5py.File(self._source, "r") as file:
                yield file


def _written(file: h5py.File) -> int:
    """The number of rows, t = 0 included, that every dataset holds."""
    return int(file["solver"].attrs.get("written", 0))


def check_folder(path: Path) -> None:
    if not path.parent.is_dir():
        raise ModelError(f"{path}: no folder {path.parent}")


def make_output(compiled: CompiledModel, n: int) -> Output:
    """Room for n steps."""
    system = compiled.system
    n_b, n_f = len(system.bodies.mass), len(system.frames.body)
    n_rows, n_j, n_o = len(system.couplings.rows.kind), len(compiled.coupling_names), len(compiled.observers)
    return Output(
        x=np.zeros((n, n_b, 3)),
        R=np.zeros((n, n_b, 4)),
        v=np.zeros((n, n_b, 6)),
        v_dot=np.zeros((n, n_b, 6)),
        frame_position=np.zeros((n, n_f, 3)),
        frame_rotation=np.zeros((n, n_f, 4)),
        frame_u=np.zeros((n, n_f, 6)),
        frame_force=np.zeros((n, n_f, 6)),
        frame_velocity=np.zeros((n, n_f, 6)),
        frame_acceleration=np.zeros((n, n_f, 6)),
        multipliers=np.zeros((n, n_rows)),
        coordinates=np.zeros((n, n_rows)),
        observed=np.zeros((n, n_o)),
        observed_rates=np.zeros((n, n_o)),
        coupling_wrench=np.zeros((n, n_j, 6)),
        energy=np.zeros((n, 7)),
        momentum=np.zeros((n, 6)),
        iterations=np.zeros(n, dtype=np.int64),
        residual=np.zeros(n),
    )


def _columns(compiled: CompiledModel) -> dict[str, _Column]:
    columns: dict[str, _Column] = {}
    for b, name in enumerate(compiled.body_names):
        columns |= {
            f"bodies/{name}/x": _Column("m", "x", (b,)),
            f"bodies/{name}/R": _Column("1", "R", (b,)),
            f"bodies/{name}/v": _Column("m/s, rad/s", "v", (b,)),
            f"bodies/{name}/v_dot": _Column("m/s^2, rad/s^2", "v_dot", (b,)),
        }
    for f, name in enumerate(compiled.frame_names):
        if "." not in name or name.startswith(f"{GROUND}."):
            continue
        columns |= {
            f"frames/{name}/position": _Column("m", "frame_position", (f,)),
            f"frames/{name}/rotation": _Column("1", "frame_rotation", (f,)),
            f"frames/{name}/velocity": _Column("m/s, rad/s", "frame_velocity", (f,)),
            f"frames/{name}/acceleration": _Column("m/s^2, rad/s^2", "frame_acceleration", (f,)),
            f"frames/{name}/u": _Column("m, rad", "frame_u", (f,)),
            f"frames/{name}/force": _Column("N, N m", "frame_force", (f,)),
        }
    columns |= _coupling_columns(compiled)
    for i, name in enumerate(("kinetic", "elastic", "springs", "potential", "work")):
        columns[f"energy/{name}"] = _Column("J", "energy", (i,))
    if compiled.all_modal:
        columns["energy/modal"] = _Column("J", "energy", (6,))
    columns["momentum/linear"] = _Column("kg m/s", "momentum", (slice(0, 3),))
    columns["momentum/angular"] = _Column("kg m^2/s", "momentum", (slice(3, 6),))
    columns["solver/iterations"] = _Column("1", "iterations")
    columns["solver/residual"] = _Column("1", "residual")
    return columns


def _coupling_columns(compiled: CompiledModel) -> dict[str, _Column]:
    columns: dict[str, _Column] = {}
    first = compiled.system.couplings.range.tolist()
    groups = {spring.name: "springs" for spring in compiled.model.springs}
    for j, name in enumerate(compiled.coupling_names):
        rows = slice(first[j], first[j + 1])
        group = groups.get(name, "joints")
        columns |= {
            f"{group}/{name}/multipliers": _Column("N, N m", "multipliers", (rows,)),
            f"{group}/{name}/force": _Column("N", "coupling_wrench", (j, slice(0, 3))),
            f"{group}/{name}/moment": _Column("N m", "coupling_wrench", (j, slice(3, 6))),
        }
        if group == "springs":
            columns[f"{group}/{name}/coordinates"] = _Column("m, rad", "coordinates", (rows,))
    for i, (joint, coordinate) in enumerate(compiled.observers):
        units = "rad" if "angle" in coordinate else "m"
        columns[f"joints/{joint}/{coordinate}"] = _Column(units, "observed", (i,))
        columns[f"joints/{joint}/{coordinate}_rate"] = _Column(f"{units}/s", "observed_rates", (i,))
    return columns


def _describe(file: h5py.File, compiled: CompiledModel) -> None:
    model = compiled.model
    file.attrs.update(
        format=FORMAT,
        version=VERSION,
        units="SI",
        created_by=f"duhamel {metadata.version('duhamel')}",
        model=model.source,
    )
    for group in ("bodies", "frames", "joints", "springs", "energy", "momentum"):
        file.create_group(group)
    hashes = file.create_group("superelements")
    for name, body in model.flexible_bodies.items():
        hashes.attrs[name] = sha256(body.source) if body.source else ""
    files = hashes.create_group("files")
    files.attrs.update({name: str(Path(b.source).resolve()) for name, b in model.flexible_bodies.items() if b.source})
    file.create_group("solver").attrs.update(
        h=compiled.h,
        rho_inf=compiled.scheme.rho_inf,
        steps=compiled.n_steps,
        rule=model.rule,
        start=model.start,
        finished=False,
    )


def _extend(file: h5py.File, name: str, units: str, rows: Any, first: int) -> None:
    """Append rows to a dataset, which is made when the first rows come."""
    if first == 0:
        shape = rows.shape[1:]
        # a joint may have lost all its rows; HDF5 then wants room for one
        maxshape, chunks = (None, *(width or None for width in shape)), (1024, *(width or 1 for width in shape))
        dataset = file.create_dataset(name, data=rows, maxshape=maxshape, chunks=chunks)
        dataset.attrs["units"] = units
    else:
        file[name].resize(first + len(rows), axis=0)
        file[name][first:] = rows
