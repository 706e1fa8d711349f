"""The HDF5 file of a superelement, schema version 1. Written under a temporary name and renamed when whole."""

import hashlib
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .interface import Interface
from .kernel import Kernel
from .modes import Modes
from .recovery import Recovery
from .scheme import GeneralizedAlpha
from .superelement import Provenance, Superelement
from .validation import SuperelementError

FORMAT = "duhamel-superelement"
VERSION = 1


def write(path: str | os.PathLike[str], superelement: Superelement) -> None:
    """Write a superelement; the file appears whole or not at all."""
    with _renamed_when_whole(Path(path)) as temporary, h5py.File(temporary, "w") as file:
        _fill(file, superelement)


def read(path: str | os.PathLike[str]) -> Superelement:
    """Read and validate a superelement; `SuperelementError` names file, dataset and what was found."""
    try:
        with h5py.File(path, "r") as file:
            return _superelement(file)
    except SuperelementError as error:
        raise SuperelementError(f"{path}: {error}") from error
    except FileNotFoundError as error:
        raise SuperelementError(f"{path}: no such file") from error
    except OSError as error:
        raise SuperelementError(f"{path}: not a readable HDF5 file: {error}") from error


def sha256(path: str | os.PathLike[str]) -> str:
    """The SHA-256 of a file, in hexadecimal."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _fill(file: h5py.File, body: Superelement) -> None:
    file.attrs.update(
        format=FORMAT,
        version=VERSION,
        name=body.name,
        units="SI",
        created_by=f"duhamel {metadata.version('duhamel')}",
    )

    rigid = file.create_group("rigid")
    _put(rigid, "mass", body.mass, "kg")
    _put(rigid, "J_rot", body.J_rot, "kg m^2")
    _put(rigid, "center", body.center, "m")

    interfaces = file.create_group("interfaces")
    interfaces.create_dataset("name", data=[i.name for i in body.interfaces], dtype=h5py.string_dtype())
    _put(interfaces, "X", np.array([i.X for i in body.interfaces]).reshape(-1, 3), "m")
    interfaces.create_dataset("rotations", data=np.array([i.rotations for i in body.interfaces], dtype=bool))
    interfaces.create_dataset("row", data=np.array([body.rows(i.name).start for i in body.interfaces], dtype=np.int64))

    kernel = file.create_group("kernel")
    kernel.attrs.update(h=body.kernel.h, rho_inf=body.kernel.scheme.rho_inf, error=body.kernel.error)
    _put(kernel, "g", body.kernel.g, "m/N, rad/N, rad/(N m)")
    _put(kernel, "g_initial", body.kernel.g_initial, "m/N, rad/N, rad/(N m)")

    if body.modes is not None:
        modes = file.create_group("modes")
        _put(modes, "omega", body.modes.omega, "rad/s")
        _put(modes, "zeta", body.modes.zeta, "1")
        _put(modes, "phi", body.modes.phi, "1/sqrt(kg), 1/(sqrt(kg) m)")

    static = file.create_group("static")
    _put(static, "compliance", body.compliance, "m/N, rad/N, rad/(N m)")
    _put(static, "mobility", body.mobility, "1/kg, 1/(kg m), 1/(kg m^2)")

    if body.recovery is not None:
        recovery = file.create_group("recovery")
        _put(recovery, "points", body.recovery.points, "m")
        recovery.create_dataset("cells", data=body.recovery.cells)
        _put(recovery, "phi", body.recovery.phi, "1/sqrt(kg)")
        if body.recovery.stress is not None:
            _put(recovery, "stress", body.recovery.stress, "Pa/(m sqrt(kg))")

    provenance = file.create_group("provenance")
    source = body.provenance
    provenance.attrs.update(
        body=source.body,
        mesh=source.mesh,
        mesh_sha256=source.mesh_sha256,
        method=source.method,
        tolerance=source.tolerance,
    )
    provenance.create_group("versions").attrs.update(source.versions)
    provenance.create_group("timings").attrs.update(source.timings)


def _superelement(file: h5py.File) -> Superelement:
    _check_identity(file)
    interfaces, rows = _interfaces(file)
    body = Superelement(
        name=str(_attribute(file, "name")),
        mass=float(_dataset(file, "rigid/mass")),
        J_rot=_dataset(file, "rigid/J_rot"),
        center=_dataset(file, "rigid/center"),
        interfaces=interfaces,
        kernel=_kernel(file),
        modes=_modes(file),
        compliance=_dataset(file, "static/compliance"),
        mobility=_dataset(file, "static/mobility"),
        recovery=_recovery(file),
        provenance=_provenance(file),
    )
    expected = [body.rows(interface.name).start for interface in interfaces]
    if rows != expected:
        raise SuperelementError(f"interfaces/row: expected {expected}, found {rows}")
    return body


def _check_identity(file: h5py.File) -> None:
    if (found := file.attrs.get("format")) != FORMAT:
        raise SuperelementError(f"attribute format: expected {FORMAT!r}, found {found!r}")
    if (version := file.attrs.get("version")) != VERSION:
        raise SuperelementError(f"attribute version: this reader knows version {VERSION}, found {version!r}")
    if (units := file.attrs.get("units")) != "SI":
        raise SuperelementError(f"attribute units: expected 'SI', found {units!r}")


def _interfaces(file: h5py.File) -> tuple[tuple[Interface, ...], list[int]]:
    names = [name.decode() for name in np.atleast_1d(_dataset(file, "interfaces/name"))]
    X = _dataset(file, "interfaces/X")
    rotations = np.atleast_1d(_dataset(file, "interfaces/rotations"))
    rows = np.atleast_1d(_dataset(file, "interfaces/row"))
    if not (X.shape == (len(names), 3) and rotations.shape == rows.shape == (len(names),)):
        raise SuperelementError(
            f"interfaces: expected one X, rotations and row for each of {names}, "
            f"found shapes {X.shape}, {rotations.shape} and {rows.shape}"
        )
    interfaces = tuple(Interface(name, x, bool(rotates)) for name, x, rotates in zip(names, X, rotations, strict=True))
    return interfaces, [int(row) for row in rows]


def _kernel(file: h5py.File) -> Kernel:
    group = _group(file, "kernel")
    return Kernel(
        h=float(_attribute(group, "h")),
        scheme=_scheme(float(_attribute(group, "rho_inf"))),
        g=_dataset(file, "kernel/g"),
        g_initial=_dataset(file, "kernel/g_initial"),
        error=float(_attribute(group, "error")),
    )


def _scheme(rho_inf: float) -> GeneralizedAlpha:
    try:
        return GeneralizedAlpha(rho_inf)
    except ValueError as error:
        raise SuperelementError(f"kernel: {error}") from error


def _modes(file: h5py.File) -> Modes | None:
    if "modes" not in file:
        return None
    return Modes(_dataset(file, "modes/omega"), _dataset(file, "modes/zeta"), _dataset(file, "modes/phi"))


def _recovery(file: h5py.File) -> Recovery | None:
    if "recovery" not in file:
        return None
    return Recovery(
        points=_dataset(file, "recovery/points"),
        cells=_dataset(file, "recovery/cells"),
        phi=_dataset(file, "recovery/phi"),
        stress=_dataset(file, "recovery/stress") if "recovery/stress" in file else None,
    )


def _provenance(file: h5py.File) -> Provenance:
    group = _group(file, "provenance")
    return Provenance(
        body=str(_attribute(group, "body")),
        mesh=str(_attribute(group, "mesh")),
        mesh_sha256=str(_attribute(group, "mesh_sha256")),
        method=str(_attribute(group, "method")),
        tolerance=float(_attribute(group, "tolerance")),
        versions={name: str(value) for name, value in _group(group, "versions").attrs.items()},
        timings={name: float(value) for name, value in _group(group, "timings").attrs.items()},
    )


def _put(group: h5py.Group, name: str, data: Any, units: str) -> None:
    group.create_dataset(name, data=data).attrs["units"] = units


def _group(parent: h5py.Group, name: str) -> h5py.Group:
    if not isinstance(parent.get(name), h5py.Group):
        raise SuperelementError(f"group {name!r} is missing")
    return parent[name]


def _dataset(file: h5py.File, name: str) -> Any:
    if not isinstance(file.get(name), h5py.Dataset):
        raise SuperelementError(f"dataset {name!r} is missing")
    return file[name][()]


def _attribute(group: h5py.Group, name: str) -> Any:
    if name not in group.attrs:
        where = "" if group.name == "/" else f" of group {group.name[1:]!r}"
        raise SuperelementError(f"attribute {name!r}{where} is missing")
    return group.attrs[name]


@contextmanager
def _renamed_when_whole(path: Path) -> Iterator[Path]:
    if not path.parent.is_dir():
        raise SuperelementError(f"{path}: no folder {path.parent}")
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
