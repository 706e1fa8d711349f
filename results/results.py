"""`Results`: what a run recorded, read from its file when asked for."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..solver.arrays import Array
from ..solver.errors import RecoveryError, ResultsError
from ..superelement import Recovery, Superelement, SuperelementError, von_mises
from .quantities import BodyMotion, Coupling, Energy, FrameMotion, Momentum
from .recovery import (
    Instants,
    instants,
    interface_loads,
    modal_coordinates,
    place,
    read_again,
    stepping,
)

FORMAT = "duhamel-results"
VERSION = 1


class Results:
    """The results of a run; arrays are read when asked for, and between reads the file is closed.

    Fields of flexible bodies (`displacement`, `stress`, `von_mises`, `position`) are superposed
    from the modes of their superelements, at times t [s], one or several (k,), of the run; between
    steps they are linear in time. They take one pass over the steps before t: ask for many times at
    once. `RecoveryError` says what is missing.
    """

    def __init__(
        self, source: h5py.File | Path, superelements: Mapping[str, Superelement] | None = None
    ) -> None:
        self._source = source
        self._superelements = dict(superelements or {})

    @classmethod
    def read(
        cls, path: str | os.PathLike[str], superelements: Mapping[str, Superelement] | None = None
    ) -> "Results":
        """Open a results file; `ResultsError` if it is none.

        superelements: by body, for fields, where the files that the run read are no longer where
        they were.
        """
        results = cls(Path(path), superelements)
        try:
            with results._open() as file:
                found = file.attrs.get("format")
        except OSError as error:
            raise ResultsError(f"{path}: not a readable HDF5 file: {error}") from error
        if found != FORMAT:
            raise ResultsError(f"{path}: attribute format: expected {FORMAT!r}, found {found!r}")
        return results

    @property
    def recorded(self) -> tuple[str, ...]:
        """What the run recorded: "bodies/hub", "frames/beam.tip", "energy", ...; all there is
        unless asked for less.
        """
        with self._open() as file:
            return _groups(file)

    @property
    def time(self) -> Array:
        """(n,) [s]"""
        return self._array("time")

    @property
    def energy(self) -> Energy:
        return Energy(**self._group("energy"))

    @property
    def iterations(self) -> Array:
        """(n,) Newton iterations of each recorded step"""
        return self._array("solver/iterations")

    @property
    def residual(self) -> Array:
        """(n,) relative residual of each recorded step"""
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
        """Elastic displacements of the points of the recovery, (p, 3) or (k, p, 3), in body axes
        [m].
        """
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
        return place(x, R, recovery.points + recovery.displacement(eta)).reshape(
            *np.shape(t), -1, 3
        )

    def superelement(self, body: str) -> Superelement:
        """The superelement of a flexible body, read again from its file if need be; `RecoveryError`
        if it changed.
        """
        if body not in self._superelements:
            with self._open() as file:
                hashes = file["superelements"].attrs
                paths = (
                    file["superelements/files"].attrs if "files" in file["superelements"] else {}
                )
                digest, path = hashes.get(body), paths.get(body)
            self._superelements[body] = read_again(body, path, digest)
        return self._superelements[body]

    def _recover(self, body: str, t: Any) -> tuple[Recovery, Array, Instants]:
        """The recovery of a body, its modal coordinates (k, m) at times t (k,), and where these
        lie.
        """
        element = self.superelement(body)
        if element.recovery is None or element.modes is None:
            raise RecoveryError(
                f"body {body!r}: superelement {element.name!r} holds no recovery, for which its body file needs a "
                f"table [recovery]"
            )
        self._check_recoverable(body, element)
        when = instants(self.time, np.atleast_1d(np.asarray(t, dtype=float)))
        R = self.body(body).R
        frames = [
            (self.frame(f"{body}.{interface.name}"), interface.rotations)
            for interface in element.interfaces
        ]
        p = np.hstack(
            [interface_loads(R, frame.u, frame.force, rotations) for frame, rotations in frames]
        )
        steps = np.concatenate([when.before, when.after])
        both = modal_coordinates(element.modes, p, stepping(str(self._source), self.solver), steps)
        return element.recovery, when.of(*np.split(both, 2)), when

    def _check_recoverable(self, body: str, element: Superelement) -> None:
        if (every := int(self.solver.get("every", 1))) > 1:
            raise RecoveryError(
                f"body {body!r}: fields need every step, and the run recorded one in {every}"
            )
        recorded = self.recorded
        needed = [
            f"bodies/{body}",
            *(f"frames/{body}.{interface.name}" for interface in element.interfaces),
        ]
        if missing := [name for name in needed if name not in recorded]:
            raise RecoveryError(
                f"body {body!r}: fields need {', '.join(missing)}, which the run did not record"
            )

    def _coupling(self, name: str) -> Coupling:
        data = self._group(name)
        forces = {key: data.pop(key) for key in ("multipliers", "force", "moment")}
        return Coupling(**forces, coordinates=data)

    def _group(self, name: str) -> dict[str, Array]:
        with self._open() as file:
            n = self._written(file)
            if name not in file or not len(file[name]):  # empty: energies that were not asked for
                kind, _, _ = name.partition("/")
                recorded = _groups(file)
                like = [
                    group.partition("/")[2] for group in recorded if group.startswith(f"{kind}/")
                ]
                raise KeyError(f"no {name}; there are: {', '.join(like or recorded)}")
            return {key: dataset[:n] for key, dataset in file[name].items()}

    def _array(self, name: str) -> Array:
        with self._open() as file:
            n = self._written(file)
            array: Array = file[name][:n]
        return array

    def _written(self, file: h5py.File) -> int:
        """The number of rows that every dataset holds, one or more."""
        if not (written := int(file["solver"].attrs["written"])):
            raise ResultsError(f"{self._source}: no step has been written yet")
        return written

    @contextmanager
    def _open(self) -> Iterator[h5py.File]:
        if isinstance(self._source, h5py.File):
            yield self._source
        else:
            with h5py.File(self._source, "r") as file:
                yield file


def _groups(file: h5py.File) -> tuple[str, ...]:
    """What was recorded: "bodies/hub", "energy", ..."""
    owned = [
        f"{kind}/{name}"
        for kind in ("bodies", "frames", "joints", "springs")
        for name in file[kind]
    ]
    return (*owned, *(kind for kind in ("energy", "momentum") if len(file[kind])))
