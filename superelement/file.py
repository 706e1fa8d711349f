"""The HDF5 file of a superelement, schema version 7; files of versions 1 to 6 are read too.

Written under a temporary name and renamed when whole.
"""

import hashlib
import io
import os
from dataclasses import replace
from importlib import metadata
from pathlib import Path
from typing import Any, overload

import h5py
import numpy as np

from ..files import object_and_path, renamed_when_whole
from ..files.arrays import Array
from ..files.hdf5 import decoded, opened, require_kind
from ..files.outputs import AnyPath, in_words, resolved
from .chain import Chain
from .channels import Channels
from .checks import require_sound
from .derivative import DesignDerivative
from .fields import (
    dataset,
    expect,
    group,
    names,
    number,
    numbers,
    pair,
    put,
    put_large,
    rank,
    require_shape,
    scalar,
    text,
    texts,
)
from .interface import Interface
from .kernel import Kernel
from .measured import MeasuredModes
from .modes import Modes
from .outline import Outline
from .pattern import Pattern
from .recovery import Recovery, SurfaceRest
from .rotation import N_INERTIA_CHANGES, Rotation
from .scheme import GeneralizedAlpha
from .sensor import Sensor
from .superelement import Provenance, Superelement
from .surfaces import Surface, Surfaces
from .validation import SuperelementError

SUPERELEMENT_FORMAT = "duhamel-superelement"
SUPERELEMENT_VERSION = 7
# Version 1 has the accelerance under another name.
ACCELERANCE_DATASETS = {1: "static/mobility"} | dict.fromkeys(
    range(2, SUPERELEMENT_VERSION + 1), "static/accelerance"
)
# The versions from which on a file may hold a part; in earlier ones such a group is unknown, and
# passed over.
FIRST_WITH_ROTATION = 3
FIRST_WITH_CHAIN = 4
FIRST_WITH_CHANNELS = 4
FIRST_WITH_OUTLINE = 5
FIRST_WITH_SURFACES = 6
FIRST_WITH_MEASURED = 6
FIRST_WITH_DERIVATIVES = 7
DERIVATIVE_UNITS = {
    "K": "1/s^2",
    "M": "1",
    "phi": "1/sqrt(kg), 1/(sqrt(kg) m)",
    "mass": "kg",
    "J_rot": "kg m^2",
    "center": "m",
    "X": "m",
    "compliance": "m/N, rad/N, rad/(N m)",
}
"""of derivatives, per unit of their parameters"""
# The digest of rigid properties and positions of interfaces, which nothing else in the file can
# confirm.
PLACEMENT_ATTRIBUTE = "sha256"
MAX_LISTED_VALUES = 10
# Two projections of each soft shape: by stiffness (K) and by mass (M).
ROTATION_FORM = "KM"


@overload
def write(superelement: Superelement, path: AnyPath, /) -> None: ...
@overload
def write(path: AnyPath, superelement: Superelement, /) -> None: ...
def write(superelement: Any, path: Any, /) -> None:
    """Write a superelement to an HDF5 file; `write(path, superelement)` is accepted too.

    The file appears whole or not at all, and an older one stays until then.

    Parameters
    ----------
    superelement : Superelement
    path : path

    Raises
    ------
    SuperelementError
        Where the folder is missing or cannot be written to; and for one that was scaled, which
        would no longer be that of its body file.

    Examples
    --------
    >>> import duhamel as du
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    >>> section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    >>> beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)], section=section)
    >>> beam.interface("tip", (1.0, 0.0, 0.0))
    >>> element = beam.superelement(step=1e-4)
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     write(element, Path(folder) / "beam.h5")
    ...     read(Path(folder) / "beam.h5")
    <Superelement 'beam': 1.57 kg, at tip, 12 modes>
    """
    superelement, path = object_and_path(superelement, path)
    if superelement.variation is not None:
        raise SuperelementError(
            f"{superelement.name}: was made from another one by {superelement.variation}: "
            "write its base, and give these to the body in the model"
        )
    # The file is made in memory first: HDF5 itself brings the process down when the disk is full.
    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        _fill(file, superelement)
    require_writable(path)
    try:
        with renamed_when_whole(Path(path)) as temporary:
            temporary.write_bytes(image.getbuffer())
    except OSError as error:
        raise SuperelementError(f"{path}: cannot be written: {in_words(error)}") from error


def require_writable(path: str | os.PathLike[str]) -> None:
    """Raise `SuperelementError` for a path at which no file can be written.

    To be called before long work, whose result would be lost otherwise.

    Examples
    --------
    >>> require_writable("missing/beam.h5")
    Traceback (most recent call last):
    duhamel.superelement.validation.SuperelementError: missing/beam.h5: no folder missing
    """
    target = Path(path)
    try:
        if not target.parent.is_dir():
            why = f"no folder {target.parent}"
        elif resolved(target).exists() and not target.is_file():
            why = "cannot be written: not a regular file"
        elif not os.access(target.parent, os.W_OK):
            why = f"cannot be written: no right to write into {target.parent}"
        else:
            return
    except (OSError, ValueError) as error:  # a name that is too long, or with a NUL
        why = f"cannot be written: {in_words(error)}"
    raise SuperelementError(f"{path}: {why}")


def read(path: str | os.PathLike[str], recovery: bool = True) -> Superelement:
    """Read and validate a superelement file of versions 1 to 7; unknown groups are ignored.

    Parameters
    ----------
    path : path
    recovery : bool
        Whether to read that too. For a large body it is nearly all of the file, and a simulation
        does not need it.

    Returns
    -------
    Superelement

    Raises
    ------
    SuperelementError
        Names the file, the dataset or attribute, what was expected and what was found; also for
        numbers that no elastic body can have (`checks`). See `write` for an example.
    """
    with opened(path, SuperelementError) as file:
        return _superelement(file, recovery)


def sha256(path: str | os.PathLike[str]) -> str:
    """The SHA-256 of a file, in hexadecimal, by which results recognize their superelements.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "empty"
    ...     path.touch()
    ...     sha256(path)[:16]
    'e3b0c44298fc1c14'
    """
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _fill(file: h5py.File, body: Superelement) -> None:
    file.attrs.update(
        format=SUPERELEMENT_FORMAT,
        version=SUPERELEMENT_VERSION,
        name=body.name,
        units="SI",
        created_by=f"duhamel {metadata.version('duhamel')}",
    )
    rigid = file.create_group("rigid")
    put(rigid, "mass", body.mass, "kg")
    put(rigid, "J_rot", body.J_rot, "kg m^2")
    put(rigid, "center", body.center, "m")
    rigid.attrs[PLACEMENT_ATTRIBUTE] = _placement_digest(body)
    _put_interfaces(file.create_group("interfaces"), body)
    _put_kernel(file.create_group("kernel"), body.kernel)
    if body.modes is not None:
        modes = file.create_group("modes")
        modes.attrs["h_min"] = body.modes.h_min
        put(modes, "omega", body.modes.omega, "rad/s")
        put(modes, "zeta", body.modes.zeta, "1")
        put(modes, "phi", body.modes.phi, "1/sqrt(kg), 1/(sqrt(kg) m)")
        if body.modes.chain is not None:
            _put_chain(modes.create_group("chain"), body.modes.chain)
    if body.rotation is not None:
        _put_rotation(file, body.rotation)
    if body.channels is not None:
        _put_channels(file.create_group("channels"), body.channels)
    if body.surfaces is not None:
        _put_surfaces(file, body.surfaces)
    put(file, "static/compliance", body.compliance, "m/N, rad/N, rad/(N m)")
    put(
        file,
        ACCELERANCE_DATASETS[SUPERELEMENT_VERSION],
        body.accelerance,
        "1/kg, 1/(kg m), 1/(kg m^2)",
    )
    if body.recovery is not None:
        _put_recovery(file.create_group("recovery"), body.recovery)
    if body.outline is not None:
        _put_outline(file, body.outline, body.recovery)
    if body.measured is not None:
        _put_measured(file.create_group("measured"), body.measured)
    for name, tangent in body.derivatives.items():
        _put_derivative(file.create_group(f"derivatives/{name}"), tangent)
    _put_provenance(file.create_group("provenance"), body.provenance)


def _put_derivative(parent: h5py.Group, tangent: DesignDerivative) -> None:
    """Units are those of the data themselves, per unit of the parameter."""
    parent.attrs.update(value=tangent.value, reach=tangent.reach, error=tangent.error)
    for name, units in DERIVATIVE_UNITS.items():
        put(parent, name, getattr(tangent, name), units)


def _put_measured(parent: h5py.Group, measured: MeasuredModes) -> None:
    put(parent, "frequency", measured.frequency, "Hz")
    put(parent, "damping", measured.damping, "1")
    put(parent, "calculated", measured.calculated, "Hz")
    put(parent, "mac", measured.mac, "1")
    put(parent, "complexity", measured.complexity, "1")


def _put_interfaces(parent: h5py.Group, body: Superelement) -> None:
    names = [interface.name for interface in body.interfaces]
    X = np.array([interface.X for interface in body.interfaces]).reshape(-1, 3)
    rotations = np.array([interface.rotations for interface in body.interfaces], dtype=bool)
    # Redundant, but other programs find the rows of an interface without counting dofs.
    rows = np.array([body.rows(name).start for name in names], dtype=np.int64)
    parent.create_dataset("name", data=names, dtype=h5py.string_dtype())
    put(parent, "X", X, "m")
    parent.create_dataset("rotations", data=rotations)
    parent.create_dataset("row", data=rows)


def _put_kernel(parent: h5py.Group, kernel: Kernel) -> None:
    parent.attrs.update(h=kernel.h, rho_inf=kernel.scheme.rho_inf, error=kernel.error)
    if kernel.band is not None:
        parent.attrs["band"] = kernel.band
    put(parent, "g", kernel.g, "m/N, rad/N, rad/(N m)")
    put(parent, "g_initial", kernel.g_initial, "m/N, rad/N, rad/(N m)")


def _put_rotation(file: h5py.File, rotation: Rotation) -> None:
    put(file, "modes/phi_inertia", rotation.phi_inertia, "sqrt(kg) m")
    parent = file.create_group("rotation")
    parent.attrs.update(n_low=rotation.n_low, n_soft=rotation.n_soft, form=ROTATION_FORM)
    put(parent, "T", rotation.T, "1")
    put(parent, "A_interface", rotation.A_interface, "1/(kg m), 1/(kg m^2)")
    put(parent, "A_inertia", rotation.A_inertia, "1")
    if rotation.A_surface is not None:
        put(parent, "A_surface", rotation.A_surface, "1/(kg m)")
    put(parent, "gyroscopic", rotation.gyroscopic, "1")
    put(parent, "kappa", rotation.kappa, "1")
    if rotation.cubic is not None:
        put(parent, "cubic", rotation.cubic, "1/(sqrt(kg) m s^2)")
        put(parent, "quartic", rotation.quartic, "1/(kg m^2 s^2)")


def _put_channels(parent: h5py.Group, channels: Channels) -> None:
    patterns, sensors = channels.patterns, channels.sensors
    labels = h5py.string_dtype()
    parent.create_dataset("pattern/name", data=[p.name for p in patterns], dtype=labels)
    force = np.array([pattern.force for pattern in patterns]).reshape(-1, 3)
    put(parent, "pattern/force", force, "N")
    moment = np.array([pattern.moment for pattern in patterns]).reshape(-1, 3)
    put(parent, "pattern/moment", moment, "N m")
    parent.create_dataset("sensor/name", data=[s.name for s in sensors], dtype=labels)
    parent.create_dataset("sensor/kind", data=[s.kind for s in sensors], dtype=labels)
    put(parent, "sensor/X", np.array([sensor.X for sensor in sensors]).reshape(-1, 3), "m")
    if channels.phi is not None:
        put(
            parent,
            "phi",
            channels.phi,
            "sqrt(kg) m/s^2, 1/sqrt(kg), 1/(sqrt(kg) m), Pa/(sqrt(kg) m)",
        )
    if channels.kernel is not None:
        put(parent, "g", channels.kernel.g, "of interfaces, patterns and sensors")
        put(parent, "g_initial", channels.kernel.g_initial, "of the same")
    if channels.compliance is not None and channels.accelerance is not None:
        put(parent, "compliance", channels.compliance, "of the same")
        put(parent, "accelerance", channels.accelerance, "of the same")


def _put_surfaces(file: h5py.File, surfaces: Surfaces) -> None:
    put(file, "modes/phi_surface", surfaces.phi, "1/sqrt(kg)")
    put(file, "static/surface", surfaces.H, "m/N")
    for patch in surfaces.patches:
        parent = file.create_group(f"surfaces/{patch.name}")
        # HDF5 lists groups by name: the first row of each keeps their order.
        parent.attrs.update(facet_type=patch.facet_type, row=surfaces.rows(patch.name).start)
        parent.create_dataset("nodes", data=patch.nodes)
        parent.create_dataset("facets", data=patch.facets)
        put(parent, "points", patch.X, "m")
        put(parent, "normals", patch.normals, "1")
        put(parent, "area", patch.area, "m^2")


def _put_chain(parent: h5py.Group, chain: Chain) -> None:
    put(parent, "tau", chain.tau, "s")
    put(parent, "amplitude", chain.amplitude, "1")
    parent.attrs.update(
        loss_factor=chain.loss_factor,
        band=np.array(chain.band),
        reference=chain.reference,
        ripple=chain.ripple,
    )


def _put_recovery(parent: h5py.Group, recovery: Recovery) -> None:
    put_large(parent, "points", recovery.points, "m")
    put_large(parent, "cells", recovery.cells)
    # Modes are right to 1e-6 or so: single precision, 6e-8, halves what takes nearly all of the
    # file.
    put_large(parent, "phi", recovery.phi, "1/sqrt(kg)", np.float32)
    if recovery.stress is not None:
        put_large(parent, "stress", recovery.stress, "Pa/(m sqrt(kg))", np.float32)
    if recovery.phi_rotation is not None:
        put_large(parent, "phi_rotation", recovery.phi_rotation, "1/(sqrt(kg) m)", np.float32)
    if recovery.nodes is not None:
        put_large(parent, "node", recovery.nodes)
    if recovery.rest is not None:
        rest = parent.create_group("rest")
        put_large(rest, "displacement", recovery.rest.displacement, "m/N", np.float32)
        if recovery.rest.stress is not None:
            put_large(rest, "stress", recovery.rest.stress, "Pa/N", np.float32)


def _put_outline(file: h5py.File, outline: Outline, recovery: Recovery | None) -> None:
    """The outline; where the recovery has the same points and cells, by links to these."""
    parent = file.create_group("outline")
    for name, data in (("points", outline.points), ("cells", outline.cells)):
        if recovery is not None and np.array_equal(data, getattr(recovery, name)):
            parent[name] = file[f"recovery/{name}"]
        else:
            put_large(parent, name, data)
    parent["points"].attrs["units"] = "m"
    if outline.node is not None:
        put_large(parent, "node", outline.node)


def _put_provenance(parent: h5py.Group, source: Provenance) -> None:
    parent.attrs.update(
        body=source.body,
        mesh=source.mesh,
        mesh_sha256=source.mesh_sha256,
        method=source.method,
        tolerance=source.tolerance,
    )
    parent.create_group("versions").attrs.update(source.versions)
    parent.create_group("timings").attrs.update(source.timings)


def _superelement(file: h5py.File, recovery: bool) -> Superelement:
    require_kind(file, SUPERELEMENT_FORMAT)
    version = expect(file, "version", *ACCELERANCE_DATASETS)
    expect(file, "units", "SI")
    interfaces = _interfaces(file)
    n_c = sum(interface.n_dofs for interface in interfaces)
    kernel = _kernel(file, n_c)
    body = Superelement(
        name=text(file, "name"),
        mass=scalar(file, "rigid/mass"),
        J_rot=numbers(file, "rigid/J_rot", 3, 3),
        center=numbers(file, "rigid/center", 3),
        interfaces=interfaces,
        kernel=kernel,
        modes=_modes(file, n_c, version),
        compliance=numbers(file, "static/compliance", n_c, n_c),
        accelerance=numbers(file, ACCELERANCE_DATASETS[version], n_c, n_c),
        recovery=_recovery(file) if recovery else None,
        rotation=_rotation(file, n_c) if version >= FIRST_WITH_ROTATION else None,
        channels=_channels(file, n_c, kernel) if version >= FIRST_WITH_CHANNELS else None,
        provenance=_provenance(file),
        outline=_outline(file) if version >= FIRST_WITH_OUTLINE else None,
        surfaces=_surfaces(file) if version >= FIRST_WITH_SURFACES else None,
        measured=_measured(file) if version >= FIRST_WITH_MEASURED else None,
        derivatives=_derivatives(file, n_c) if version >= FIRST_WITH_DERIVATIVES else {},
    )
    _check_rows(file, body)
    require_sound(body)
    # Last: a file that is wrong elsewhere has a clearer message by then.
    _check_placement(file, body)
    return body


def _interfaces(file: h5py.File) -> tuple[Interface, ...]:
    """The interfaces; names are read when all shapes fit, for a damaged file may have many."""
    rotations = numbers(file, "interfaces/rotations", "n")
    n = len(rotations)
    if not np.isin(rotations, (0, 1)).all():
        raise SuperelementError(
            "interfaces/rotations: expected true or false, found "
            f"{rotations[:MAX_LISTED_VALUES].tolist()}"
        )
    n_c = 3 * n + 3 * int(rotations.sum())
    require_shape(file, "interfaces/name", n)
    require_shape(file, "interfaces/row", n)
    require_shape(file, "static/compliance", n_c, n_c)
    X = numbers(file, "interfaces/X", n, 3)
    labels = texts(file, "interfaces/name")
    return tuple(
        Interface(name, x, bool(rotates))
        for name, x, rotates in zip(labels, X, rotations, strict=True)
    )


def _check_rows(file: h5py.File, body: Superelement) -> None:
    expected = [body.rows(interface.name).start for interface in body.interfaces]
    found = numbers(file, "interfaces/row", len(expected)).tolist()
    if found != expected:
        raise SuperelementError(f"interfaces/row: expected {expected}, found {found}")


def _check_placement(file: h5py.File, body: Superelement) -> None:
    """`SuperelementError` where rigid properties or positions are not those that were written.

    Nothing else in the file depends on them, so that damage to them shows nowhere else. Files of
    earlier builds, and those of other programs, have no digest.
    """
    parent = group(file, "rigid")
    if PLACEMENT_ATTRIBUTE in parent.attrs and text(
        parent, PLACEMENT_ATTRIBUTE
    ) != _placement_digest(body):
        raise SuperelementError(
            "rigid, interfaces: expected the numbers whose digest is in the file (attribute "
            f"{PLACEMENT_ATTRIBUTE!r} of group 'rigid'), found others: the file is damaged or was "
            "edited; "
            "make it again with `duhamel preprocess`"
        )


def _placement_digest(body: Superelement) -> str:
    """The SHA-256 of mass, inertia and center of mass, of positions and kinds of interfaces, and of
    the geometry of surfaces.
    """
    X = [interface.X for interface in body.interfaces]
    rotations = [interface.rotations for interface in body.interfaces]
    patches = () if body.surfaces is None else body.surfaces.patches
    drawn = [
        part
        for patch in patches
        for part in (patch.X.ravel(), patch.facets.ravel(), patch.normals.ravel(), [patch.area])
    ]
    values = np.concatenate([[body.mass], body.J_rot.ravel(), body.center, *X, rotations, *drawn])
    return hashlib.sha256(values.astype("<f8").tobytes()).hexdigest()


def _kernel(file: h5py.File, n_c: int) -> Kernel:
    attributes = group(file, "kernel")
    g = numbers(file, "kernel/g", "n_k", n_c, n_c)
    return Kernel(
        h=number(attributes, "h"),
        scheme=_scheme(number(attributes, "rho_inf")),
        g=g,
        g_initial=numbers(file, "kernel/g_initial", len(g), n_c, n_c),
        error=number(attributes, "error"),
        band=number(attributes, "band") if "band" in attributes.attrs else None,
    )


def _scheme(rho_inf: float) -> GeneralizedAlpha:
    try:
        return GeneralizedAlpha(rho_inf)
    except ValueError as error:
        raise SuperelementError(f"kernel: {error}") from error


def _modes(file: h5py.File, n_c: int, version: int) -> Modes | None:
    if "modes" not in file:
        return None
    attributes = group(file, "modes")
    omega = numbers(file, "modes/omega", "m")
    return Modes(
        omega=omega,
        zeta=numbers(file, "modes/zeta", len(omega)),
        phi=numbers(file, "modes/phi", n_c, len(omega)),
        h_min=number(attributes, "h_min") if "h_min" in attributes.attrs else 0.0,
        chain=_chain(file, len(omega)) if version >= FIRST_WITH_CHAIN else None,
    )


def _chain(file: h5py.File, m: int) -> Chain | None:
    """The Maxwell elements of m modes; None where there are none."""
    if "modes/chain" not in file:
        return None
    attributes = group(file, "modes/chain")
    tau = numbers(file, "modes/chain/tau", "k")
    shape = (len(tau), m)[: max(1, rank(file, "modes/chain/amplitude"))]
    low, high = pair(attributes, "band")
    return Chain(
        tau=tau,
        amplitude=numbers(file, "modes/chain/amplitude", *shape),
        loss_factor=number(attributes, "loss_factor"),
        band=(low, high),
        reference=number(attributes, "reference"),
        ripple=number(attributes, "ripple"),
    )


def _rotation(file: h5py.File, n_c: int) -> Rotation | None:
    if "rotation" not in file:
        if "modes/phi_inertia" in file:
            raise SuperelementError(
                "group 'rotation' is missing, although there is modes/phi_inertia"
            )
        return None
    attributes = group(file, "rotation")
    expect(attributes, "form", ROTATION_FORM)
    T = numbers(file, "rotation/T", "r", "m")
    r, m = T.shape
    rotation = Rotation(
        phi_inertia=numbers(file, "modes/phi_inertia", N_INERTIA_CHANGES, m),
        T=T,
        A_interface=numbers(file, "rotation/A_interface", n_c, r, r),
        A_inertia=numbers(file, "rotation/A_inertia", N_INERTIA_CHANGES, r, r),
        gyroscopic=numbers(file, "rotation/gyroscopic", 3, r, r),
        kappa=numbers(file, "rotation/kappa", "candidates"),
        A_surface=_optional(file, "rotation/A_surface", "3 n", r, r),
        n_low=_count(attributes, "n_low"),
        cubic=_optional(file, "rotation/cubic", *["k"] * 3),
        quartic=_optional(file, "rotation/quartic", *["k"] * 4),
    )
    if rotation.n_low + 2 * (n_soft := _count(attributes, "n_soft")) != r:
        raise SuperelementError(
            "rotation/T: expected a row for each of n_low modes and two for each of n_soft shapes, "
            f"found {r} with n_low = {rotation.n_low}, n_soft = {n_soft}"
        )
    return rotation


def _count(attributes: h5py.Group, name: str) -> int:
    found = number(attributes, name)
    if not found.is_integer():
        raise SuperelementError(
            f"attribute {name!r} of group 'rotation': expected a whole number, found {found}"
        )
    return int(found)


def _optional(file: h5py.File, name: str, *shape: str | int) -> Array | None:
    return numbers(file, name, *shape) if name in file else None


def _channels(file: h5py.File, n_c: int, kernel: Kernel) -> Channels | None:
    if "channels" not in file:
        return None
    names_of_patterns = texts(file, "channels/pattern/name")
    force = numbers(file, "channels/pattern/force", len(names_of_patterns), 3)
    moment = numbers(file, "channels/pattern/moment", len(names_of_patterns), 3)
    names_of_sensors = texts(file, "channels/sensor/name")
    X = numbers(file, "channels/sensor/X", len(names_of_sensors), 3)
    kinds = texts(file, "channels/sensor/kind")
    channels = Channels(
        patterns=tuple(map(Pattern, names_of_patterns, force, moment)),
        sensors=tuple(map(Sensor, names_of_sensors, kinds, X)),
    )
    if "channels/phi" in file:
        return replace(channels, phi=numbers(file, "channels/phi", channels.n, "m"))
    n = n_c + channels.n
    g = numbers(file, "channels/g", len(kernel.g), n, n)
    g_initial = numbers(file, "channels/g_initial", len(kernel.g), n, n)
    return replace(
        channels,
        kernel=replace(kernel, g=g, g_initial=g_initial),
        compliance=numbers(file, "channels/compliance", n, n),
        accelerance=numbers(file, "channels/accelerance", n, n),
    )


def _surfaces(file: h5py.File) -> Surfaces | None:
    if "surfaces" not in file:
        return None
    parent = group(file, "surfaces")
    labels = [decoded("the name of a surface", label) for label in parent]
    first = {label: number(group(parent, label), "row") for label in labels}
    patches = tuple(
        Surface(
            name=label,
            nodes=dataset(parent, f"{label}/nodes", "n"),
            X=numbers(parent, f"{label}/points", "n", 3),
            facets=dataset(parent, f"{label}/facets", "n", "k"),
            facet_type=text(group(parent, label), "facet_type"),
            normals=numbers(parent, f"{label}/normals", "n", 3),
            area=scalar(parent, f"{label}/area"),
        )
        for label in sorted(labels, key=first.__getitem__)
    )
    rows = 3 * sum(patch.n for patch in patches)
    surfaces = Surfaces(
        patches,
        phi=numbers(file, "modes/phi_surface", rows, "m"),
        H=numbers(file, "static/surface", rows, rows),
    )
    for patch in patches:
        if surfaces.rows(patch.name).start != first[patch.name]:
            raise SuperelementError(
                f"surfaces/{patch.name}: row: expected {surfaces.rows(patch.name).start}, found "
                f"{first[patch.name]:g}"
            )
    return surfaces


def _measured(file: h5py.File) -> MeasuredModes | None:
    if "measured" not in file:
        return None
    parent = group(file, "measured")
    keys = ("frequency", "damping", "calculated", "mac", "complexity")
    return MeasuredModes(*(numbers(parent, key, "m") for key in keys))


def _derivatives(file: h5py.File, n_c: int) -> dict[str, DesignDerivative]:
    if "derivatives" not in file:
        return {}
    parent, found = group(file, "derivatives"), {}
    for name in parent:
        label = decoded("the name of a derivative", name)
        try:
            found[label] = _derivative(group(parent, label), n_c)
        except SuperelementError as error:
            raise SuperelementError(f"derivatives/{label}: {error}") from error
    return found


def _derivative(parent: h5py.Group, n_c: int) -> DesignDerivative:
    K = numbers(parent, "K", "m", "m")
    return DesignDerivative(
        value=number(parent, "value"),
        reach=number(parent, "reach"),
        error=number(parent, "error"),
        K=K,
        M=numbers(parent, "M", len(K), len(K)),
        phi=numbers(parent, "phi", n_c, len(K)),
        mass=scalar(parent, "mass"),
        J_rot=numbers(parent, "J_rot", 3, 3),
        center=numbers(parent, "center", 3),
        X=numbers(parent, "X", "n", 3),
        compliance=numbers(parent, "compliance", n_c, n_c),
    )


def _recovery(file: h5py.File) -> Recovery | None:
    if "recovery" not in file:
        return None
    points = numbers(file, "recovery/points", "p", 3)
    phi = numbers(file, "recovery/phi", len(points), 3, "m")
    stress = None
    if "recovery/stress" in file:
        stress = numbers(file, "recovery/stress", len(points), 6, phi.shape[2])
    turns = None
    if "recovery/phi_rotation" in file:
        turns = numbers(file, "recovery/phi_rotation", len(points), 3, phi.shape[2])
    nodes = dataset(file, "recovery/node", len(points)) if "recovery/node" in file else None
    cells = dataset(file, "recovery/cells", "n", "k")
    return Recovery(points, cells, phi, stress, turns, nodes, _surface_rest(file))


def _surface_rest(file: h5py.File) -> SurfaceRest | None:
    if "recovery/rest" not in file:
        return None
    u, stress = numbers(file, "recovery/rest/displacement", "p", 3, "3n"), None
    if "recovery/rest/stress" in file:
        stress = numbers(file, "recovery/rest/stress", len(u), 6, u.shape[2])
    return SurfaceRest(u, stress)


def _outline(file: h5py.File) -> Outline | None:
    if "outline" not in file:
        return None
    points = numbers(file, "outline/points", "p", 3)
    node = dataset(file, "outline/node", len(points)) if "outline/node" in file else None
    return Outline(points, dataset(file, "outline/cells", "n", "k"), node)


def _provenance(file: h5py.File) -> Provenance:
    source = group(file, "provenance")
    versions, timings = group(source, "versions"), group(source, "timings")
    return Provenance(
        body=text(source, "body"),
        mesh=text(source, "mesh"),
        mesh_sha256=text(source, "mesh_sha256"),
        method=text(source, "method"),
        tolerance=number(source, "tolerance"),
        versions={name: text(versions, name) for name in names(versions)},
        timings={name: number(timings, name) for name in names(timings)},
    )
