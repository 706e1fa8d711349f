"""A results file, and the motion it holds."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import h5py

from .errors import QuantityError, ResultsError
from .rotations import Array, inverse, product, rotate, twists

FORMAT = "duhamel-results"
VERSION = 1
QUATERNION, VECTOR, WRENCH = (4,), (3,), (6,)


@dataclass(frozen=True)
class Recording:
    """The motion in a results file, read when asked for.

    `bodies`, `frames` ("BODY.FRAME"), `interfaces` (the frames of flexible bodies), `joints`,
    `springs` and `energies` are the names it holds. All vectors are (n, 3), one row for each time,
    and in space unless said otherwise. Methods raise QuantityError for an unknown name,
    ResultsError for a dataset that is missing or of another shape.
    """

    path: Path
    bodies: tuple[str, ...]
    frames: tuple[str, ...]
    interfaces: tuple[str, ...]
    joints: tuple[str, ...]
    springs: tuple[str, ...]
    energies: tuple[str, ...]

    @property
    def time(self) -> Array:
        """(n,) [s]"""
        with _opened(self.path) as file:
            time: Array = file["time"][: _steps(file)]
        return time

    def position(self, name: str) -> Array:
        """Of the centre of mass of a body, or of the origin of a frame [m]."""
        return self._array(*self._place(name, "x", "position"), VECTOR)

    def rotation(self, name: str) -> Array:
        """The axes of a body or a frame to space, (n, 4) unit quaternion."""
        return self._array(*self._place(name, "R", "rotation"), QUATERNION)

    def angle(self, name: str) -> Array:
        """How far a body or frame has turned since t = 0 about the space axes x, y, z, beyond full
        turns too [rad].

        Each column is the twist about its axis (`twists`): for a body that turns about one axis,
        its angle.
        """
        q = self.rotation(name)
        return twists(product(q, inverse(q[0])))

    def velocity(self, name: str) -> Array:
        """Of the centre of mass of a body, or of the origin of a frame [m/s]."""
        return self._twist(name, "v", "velocity")[:, :3]

    def acceleration(self, name: str) -> Array:
        """Of the centre of mass of a body, or of the origin of a frame [m/s^2]."""
        return self._twist(name, "v_dot", "acceleration")[:, :3]

    def angular_velocity(self, name: str) -> Array:
        """R omega of a body, or that of a frame [rad/s]."""
        return self._spin(name, "v", "velocity")

    def angular_acceleration(self, name: str) -> Array:
        """d/dt (R omega) = R omega_dot of a body, or that of a frame [rad/s^2]."""
        return self._spin(name, "v_dot", "acceleration")

    def displacement(self, name: str, seen_from: str) -> Array:
        """The displacement of a body or frame in the axes D of another, since t = 0 [m].

            u(t) = s(t) - s(0),    s = D^T (r - r_reference)

        With the tip of a beam seen from the frame of the hub that carries it, this is the tip
        deflection, eq. (96).
        """
        apart = self.position(name) - self.position(seen_from)
        seen = rotate(inverse(self.rotation(seen_from)), apart)
        displacement: Array = seen - seen[0]
        return displacement

    def elastic_displacement(self, interface: str) -> Array:
        """Of an interface, in the axes of its body [m]."""
        return self._elastic(interface)[:, :3]

    def elastic_rotation(self, interface: str) -> Array:
        """Of an interface, rotation vector in the axes of its body [rad]."""
        return self._elastic(interface)[:, 3:]

    def force(self, coupling: str) -> Array:
        """Of a joint or spring on the second of its frames [N]."""
        return self._array(*self._coupling(coupling), "force", VECTOR)

    def moment(self, coupling: str) -> Array:
        """Of a joint or spring on the second of its frames, about it [N m]."""
        return self._array(*self._coupling(coupling), "moment", VECTOR)

    def coordinate(self, joint: str, name: str) -> Array:
        """A coordinate of a joint or its rate, as `angle` or `distance_rate` (n,), in the units
        that the file gives.
        """
        return self._array("joints", joint, self._coordinate(joint, name), ())

    def coordinate_unit(self, joint: str, name: str) -> str:
        with _opened(self.path) as file:
            return str(file[f"joints/{joint}/{self._coordinate(joint, name)}"].attrs["units"])

    def linear_momentum(self) -> Array:
        """Of all bodies [kg m/s]."""
        return self._momentum("linear")

    def angular_momentum(self) -> Array:
        """Of all bodies about the origin [kg m^2/s]."""
        return self._momentum("angular")

    def energy(self, name: str) -> Array:
        """(n,) [J]"""
        return self._array("energy", "", _known("energy", name, self.energies), ())

    def _place(self, name: str, of_body: str, of_frame: str) -> tuple[str, str, str]:
        name = _known("body or frame", name, self.bodies + self.frames)
        return ("bodies", name, of_body) if name in self.bodies else ("frames", name, of_frame)

    def _twist(self, name: str, of_body: str, of_frame: str) -> Array:
        return self._array(*self._place(name, of_body, of_frame), WRENCH)

    def _spin(self, name: str, of_body: str, of_frame: str) -> Array:
        spin = self._twist(name, of_body, of_frame)[:, 3:]
        return rotate(self.rotation(name), spin) if name in self.bodies else spin

    def _coupling(self, name: str) -> tuple[str, str]:
        _known("joint or spring", name, self.joints + self.springs)
        return ("joints" if name in self.joints else "springs"), name

    def _coordinate(self, joint: str, name: str) -> str:
        with _opened(self.path) as file:
            datasets = file["joints"][_known("joint", joint, self.joints)]
            return _known(
                f"coordinate of {joint}",
                name,
                tuple(key for key in datasets if datasets[key].ndim == 1),
            )

    def _elastic(self, interface: str) -> Array:
        return self._array("frames", _known("interface", interface, self.interfaces), "u", WRENCH)

    def _momentum(self, name: str) -> Array:
        with _opened(self.path) as file:
            recorded = tuple(file["momentum"])
        return self._array("momentum", "", _known("momentum", name, recorded), VECTOR)

    def _array(self, group: str, owner: str, name: str, row: tuple[int, ...]) -> Array:
        path = "/".join(part for part in (group, owner, name) if part)
        with _opened(self.path) as file:
            dataset = file.get(path)
            if not isinstance(dataset, h5py.Dataset):
                raise ResultsError(f"dataset {path!r} is missing")
            n = _steps(file)
            if len(dataset) < n or dataset.shape[1:] != row:
                raise ResultsError(
                    f"dataset {path!r}: expected shape {(n, *row)}, found {dataset.shape}"
                )
            array: Array = dataset[:n]
        return array


def read(path: str | os.PathLike[str]) -> Recording:
    """Open a results file; ResultsError if it is none, or holds no time step."""
    with _opened(path) as file:
        for key, expected in (("format", FORMAT), ("version", VERSION)):
            if (found := file.attrs.get(key)) != expected:
                raise ResultsError(f"attribute {key!r}: expected {expected}, found {found}")
        time = file.get("time")
        if not isinstance(time, h5py.Dataset) or time.ndim != 1 or not len(time):
            raise ResultsError(
                "dataset 'time' is missing or empty: the run stopped before its first step"
            )
        flexible = file["superelements"].attrs
        frames = tuple(file["frames"])
        return Recording(
            path=Path(path),
            bodies=tuple(file["bodies"]),
            frames=frames,
            interfaces=tuple(frame for frame in frames if frame.partition(".")[0] in flexible),
            joints=tuple(file["joints"]),
            springs=tuple(file["springs"]),
            energies=tuple(file["energy"]),
        )


def _steps(file: h5py.File) -> int:
    """The steps that all datasets hold: a run that is killed may leave some of them longer."""
    return int(file["solver"].attrs.get("written", len(file["time"])))


@contextmanager
def _opened(path: str | os.PathLike[str]) -> Iterator[h5py.File]:
    """The file, open as briefly as can be: an open one cannot be written again."""
    try:
        with h5py.File(path, "r") as file:
            yield file
    except ResultsError as error:
        raise ResultsError(f"{path}: {error}") from error
    except FileNotFoundError as error:
        raise ResultsError(f"{path}: no such file") from error
    except (OSError, RuntimeError, KeyError) as error:
        raise ResultsError(f"{path}: not a readable results file: {error}") from error


def _known(what: str, name: str, names: tuple[str, ...]) -> str:
    if name not in names:
        raise QuantityError(f"no {what} {name!r}; there are: {', '.join(names) or 'none'}")
    return name
