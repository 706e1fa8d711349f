"""The superelement: the data of an elastic body that a multibody solver needs."""

import json
import tomllib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..files.arrays import Array
from ..files.html import listed, table
from ..files.kept_warnings import warn
from . import summary
from .channels import Channels
from .derivative import DesignDerivative
from .interface import Interface
from .kernel import Kernel, sample_kernel
from .measured import MeasuredModes
from .modes import Modes
from .outline import Outline
from .pattern import Pattern
from .recovery import Recovery
from .rotation import Rotation
from .scheme import GeneralizedAlpha
from .sensor import Sensor
from .surfaces import Surface, Surfaces
from .validation import (
    SuperelementError,
    check_name,
    check_positive,
    check_symmetric,
    checked,
)


class StepWarning(UserWarning):
    """A step so fine that the modes of a body leave out frequencies that it would resolve."""


TESTED_METHOD = "measured with"
"""how the method begins of a part that is known from its test alone"""


@dataclass(frozen=True)
class Provenance:
    """The origin of a superelement: enough to make it again and to recognize it.

    Examples
    --------
    >>> Provenance(mesh="arm.msh", method="krylov", tolerance=1e-6).method
    'krylov'
    """

    body: str = ""
    """the text of the body file; of a body that was made in Python, its values in JSON"""
    mesh: str = ""
    """the name of the mesh"""
    mesh_sha256: str = ""
    method: str = ""
    """the method of the impulse responses: march, modal, ..."""
    tolerance: float = 0.0
    """the error asked of the method; 0 where it is exact"""
    versions: Mapping[str, str] = field(default_factory=dict)
    timings: Mapping[str, float] = field(default_factory=dict)
    """seconds by stage"""

    @property
    def tables(self) -> dict[str, Any]:
        """The tables of the body file; none where it is not known."""
        for parse in (tomllib.loads, json.loads):
            with suppress(ValueError):
                found: dict[str, Any] = parse(self.body)
                return found
        return {}

    @property
    def tested(self) -> bool:
        """Whether the modes were identified from a test, against which their error is stated."""
        return self.method.startswith(TESTED_METHOD)


@dataclass(frozen=True, eq=False)
class SuperelementVariation:
    """A superelement at other parameters than those of its file.

    Parameters
    ----------
    base : Superelement
        As its file has it.
    scale : mapping of float
        Factors of `scaled`: stiffness, density, damping.
    design : mapping of float
        Values of parameters of `redesigned`, by name.

    See `scaled` and `redesigned` for an example.
    """

    base: "Superelement"
    scale: Mapping[str, float] = field(default_factory=dict)
    design: Mapping[str, float] = field(default_factory=dict)

    @property
    def tables(self) -> dict[str, dict[str, float]]:
        """Its parameters as a model file has them, by key of a body."""
        both = {"scale": dict(self.scale), "design": dict(self.design)}
        return {key: table for key, table in both.items() if table}

    def __str__(self) -> str:
        entries = (
            f"{table}.{key} = {value:g}"
            for table, values in self.tables.items()
            for key, value in values.items()
        )
        return ", ".join(entries)

    @property
    def text(self) -> str:
        """Its parameters in one line, as results keep them."""
        return json.dumps(self.tables)


@dataclass(frozen=True, eq=False)
class Superelement:
    """An elastic body, reduced to its interfaces.

    Body axes are the mesh axes with the origin at the center of mass of the finite element mass
    matrix. The dofs of the interfaces, in their order, are the rows (and columns) of everything of
    size n_c.

    Parameters
    ----------
    name : str
    mass : float [kg]
    J_rot : (3, 3) [kg m^2]
        Inertia about the center of mass; like mass and center from U^T M U with rigid modes U.
    center : (3,) [m]
        Center of mass in mesh coordinates.
    interfaces : tuple of Interface
    kernel : Kernel
        The sampled impulse responses.
    modes : Modes or None
        The same body without a step size.
    compliance : (n_c, n_c) [m/N ...]
        The inertia-relieved static compliance P_C P K^+ P^T P_C^T.
    accelerance : (n_c, n_c) [1/kg ...]
        Accelerations under unit loads at rest, P_C M^-1 P^T P_C^T.
    recovery : Recovery, optional
        Displacements and stresses of the surface.
    rotation : Rotation, optional
        Terms of second order, for fast rotation and large bending.
    channels : Channels, optional
        Load patterns and sensors.
    provenance : Provenance
        Where it comes from.
    outline : Outline, optional
        What it looks like; None where that is not known, as of matrices of another program.
    surfaces : Surfaces, optional
        What other bodies may touch, node by node.
    measured : MeasuredModes, optional
        The modes of a test by which its own were updated.
    derivatives : mapping of DesignDerivative
        By design parameters of the body, by name.
    variation : SuperelementVariation, optional
        Of one that was made from another one, not from a mesh, and of which one.

    Raises
    ------
    SuperelementError
        For entries that do not fit each other; the message names the entry.

    Examples
    --------
    A body of 2 kg with one interface, which vibrates at 100 Hz along each axis:

    >>> import numpy as np
    >>> from duhamel.superelement import GeneralizedAlpha, Interface, Modes, sample_kernel
    >>> modes = Modes(2.0 * np.pi * np.full(3, 100.0), zeta=np.full(3, 0.01), phi=np.eye(3))
    >>> Superelement(
    ...     "block", mass=2.0, J_rot=np.eye(3), center=np.zeros(3),
    ...     interfaces=(Interface("top", np.zeros(3), rotations=False),),
    ...     kernel=sample_kernel(modes, 1e-4, GeneralizedAlpha(), steps=100), modes=modes,
    ...     compliance=modes.compliance, accelerance=modes.accelerance,
    ... )
    <Superelement 'block': 2 kg, at top, 3 modes>
    """

    name: str
    mass: float
    J_rot: Array
    center: Array
    interfaces: tuple[Interface, ...]
    kernel: Kernel
    modes: Modes | None
    compliance: Array
    accelerance: Array
    recovery: Recovery | None = None
    rotation: Rotation | None = None
    channels: Channels | None = None
    provenance: Provenance = field(default_factory=Provenance)
    outline: Outline | None = None
    surfaces: Surfaces | None = None
    measured: MeasuredModes | None = None
    derivatives: Mapping[str, DesignDerivative] = field(default_factory=dict)
    variation: SuperelementVariation | None = None

    def __post_init__(self) -> None:
        if not (self.name and self.name.isprintable()):
            raise SuperelementError(f"name: expected one line of text, found {self.name!r}")
        check_positive("mass", self.mass)
        J_rot = checked("J_rot", self.J_rot, (3, 3))
        _check_inertia(J_rot)
        interfaces = tuple(self.interfaces)
        names = [interface.name for interface in interfaces]
        if len(set(names)) != len(names):
            raise SuperelementError(f"interfaces: expected different names, found {names}")
        n_c = sum(interface.n_dofs for interface in interfaces)
        if self.kernel.n_c != n_c:
            raise SuperelementError(
                f"kernel: g: expected {n_c} rows, the dofs of interfaces {names}, "
                f"found {self.kernel.n_c}"
            )
        if self.modes is not None and len(self.modes.phi) != n_c:
            raise SuperelementError(
                f"modes: phi: expected {n_c} rows, the dofs of interfaces {names}, "
                f"found {len(self.modes.phi)}"
            )
        if self.rotation is not None:
            self._check_rotation(self.rotation, n_c)
        if self.channels is not None:
            self._check_channels(self.channels, n_c)
        if self.surfaces is not None:
            self._check_surfaces(self.surfaces)
        if self.derivatives:
            self._check_derivatives()
        if self.recovery is not None:
            n_modes = 0 if self.modes is None else len(self.modes.omega)
            if self.recovery.phi.shape[2] != n_modes:
                raise SuperelementError(
                    f"recovery: phi: expected {n_modes} columns, one per mode, "
                    f"found {self.recovery.phi.shape[2]}"
                )
            self._check_rest(self.recovery)
        object.__setattr__(self, "J_rot", J_rot)
        object.__setattr__(self, "center", checked("center", self.center, (3,)))
        object.__setattr__(self, "interfaces", interfaces)
        for field_name in ("compliance", "accelerance"):
            matrix = checked(field_name, getattr(self, field_name), (n_c, n_c))
            check_symmetric(field_name, matrix)
            object.__setattr__(self, field_name, matrix)

    def __repr__(self) -> str:
        names = listed(interface.name for interface in self.interfaces)
        n_modes = 0 if self.modes is None else len(self.modes.omega)
        return f"<Superelement {self.name!r}: {self.mass:.6g} kg, at {names}, {n_modes} modes>"

    def _repr_html_(self) -> str:
        method = self.provenance.method
        shown = summary.rows(self.mass, self.interfaces, self.modes, self.kernel, method)
        return table(f"Superelement {self.name}", shown)

    @property
    def base(self) -> "Superelement":
        """What it was made from by other parameters, as a file has it; else itself."""
        return self if self.variation is None else self.variation.base

    @property
    def n_c(self) -> int:
        """The number of interface dofs."""
        return self.kernel.n_c

    @property
    def band(self) -> float:
        """The frequency up to which it is right [Hz]; infinite where it is exact."""
        h_min = 0.0 if self.modes is None else self.modes.h_min
        by_modes = 0.25 / h_min if h_min > 0.0 else np.inf
        return float(min(by_modes, self.kernel.band or np.inf))

    @cached_property
    def size(self) -> float:
        """The length of the body [m]: of a uniform bar of its mass and largest moment of inertia.

            sqrt(12 J_max / m)

        or the largest distance between interfaces, if that is longer.
        """
        points = np.array([interface.X for interface in self.interfaces]).reshape(-1, 3)
        apart = np.linalg.norm(points[:, None] - points, axis=2).max(initial=0.0)
        bar = np.sqrt(12.0 * np.linalg.eigvalsh(self.J_rot)[-1] / self.mass)
        return float(max(bar, apart))

    def _check_rotation(self, rotation: Rotation, n_c: int) -> None:
        if len(rotation.A_interface) != n_c:
            raise SuperelementError(
                f"rotation: A_interface: expected {n_c} rows, the dofs of the interfaces, "
                f"found {len(rotation.A_interface)}"
            )
        rows = 0 if self.surfaces is None else 3 * self.surfaces.n
        if rotation.A_surface is not None and len(rotation.A_surface) != rows:
            raise SuperelementError(
                f"rotation: A_surface: expected {rows} rows, three of each node of surfaces, "
                f"found {len(rotation.A_surface)}"
            )
        n_modes = 0 if self.modes is None else len(self.modes.omega)
        if rotation.T.shape[1] != n_modes:
            raise SuperelementError(
                f"rotation: T: expected {n_modes} columns, one per mode, "
                f"found {rotation.T.shape[1]}"
            )

    def _check_channels(self, channels: Channels, n_c: int) -> None:
        channels.check_sizes(n_c, self.modes)
        taken = {interface.name for interface in self.interfaces}
        names = [pattern.name for pattern in channels.patterns]
        names += [sensor.name for sensor in channels.sensors]
        if both := [name for name in names if name in taken]:
            raise SuperelementError(
                f"patterns, sensors: expected other names than those of interfaces, found {both[0]}"
            )

    def _check_rest(self, recovery: Recovery) -> None:
        if recovery.rest is None:
            return
        found = recovery.rest.displacement.shape[2]
        expected = 0 if self.surfaces is None else 3 * self.surfaces.n
        if found != expected:
            raise SuperelementError(
                f"recovery: rest: expected {expected} columns, the dofs of surfaces, found {found}"
            )

    def _check_derivatives(self) -> None:
        for name in ("rotation", "channels", "surfaces", "measured"):
            if getattr(self, name) is not None:
                raise SuperelementError(
                    f"derivatives: expected no {name}, of which they have nothing"
                )
        m = 0 if self.modes is None else len(self.modes.omega)
        for name, tangent in self.derivatives.items():
            try:
                check_name("derivative", name)
                tangent.check_fits(self.n_c, m, len(self.interfaces))
            except SuperelementError as error:
                raise SuperelementError(f"derivatives: {name}: {error}") from error

    def _check_surfaces(self, surfaces: Surfaces) -> None:
        if self.modes is None:
            raise SuperelementError("surfaces: expected a body with modes, found none")
        if surfaces.phi.shape[1] != len(self.modes.omega):
            raise SuperelementError(
                f"surfaces: phi: expected {len(self.modes.omega)} columns, one per mode, "
                f"found {surfaces.phi.shape[1]}"
            )
        taken = {
            *(interface.name for interface in self.interfaces),
            *(pattern.name for pattern in self.patterns),
            *(sensor.name for sensor in self.sensors),
        }
        if both := [patch.name for patch in surfaces.patches if patch.name in taken]:
            raise SuperelementError(
                "surfaces: expected other names than those of interfaces, patterns and sensors, "
                f"found {both[0]}"
            )

    @property
    def patterns(self) -> tuple[Pattern, ...]:
        """Its load patterns."""
        return () if self.channels is None else self.channels.patterns

    @property
    def sensors(self) -> tuple[Sensor, ...]:
        """Its sensors."""
        return () if self.channels is None else self.channels.sensors

    @property
    def n_channels(self) -> int:
        """The number of rows of patterns and sensors, which stand behind those of interfaces."""
        return 0 if self.channels is None else self.channels.n

    def complete_modes(self, modes: Modes) -> Modes:
        """Modes at interfaces and channels: phi (n_c + n_channels, m)."""
        return modes if self.channels is None else self.channels.complete(modes)

    @property
    def complete_kernel(self) -> Kernel:
        """The stored kernel of interfaces and channels, of a body without modes."""
        if self.channels is None or self.channels.kernel is None:
            return self.kernel
        return self.channels.kernel

    @property
    def complete_compliance(self) -> Array:
        """Static compliance of interfaces and channels (n_c + n_channels, n_c + n_channels)."""
        if self.channels is None:
            return self.compliance
        if self.modes is not None:
            return self.complete_modes(self.modes).compliance
        assert self.channels.compliance is not None
        return self.channels.compliance

    @property
    def complete_accelerance(self) -> Array:
        """Accelerations at rest of interfaces and channels, of the same shape."""
        if self.channels is None:
            return self.accelerance
        if self.modes is not None:
            return self.complete_modes(self.modes).accelerance
        assert self.channels.accelerance is not None
        return self.channels.accelerance

    def interface(self, name: str) -> Interface:
        """The interface of a name; `SuperelementError` lists the names where there is none."""
        return self.interfaces[self._index(name)]

    def surface(self, name: str) -> Surface:
        """The surface of a name; `SuperelementError` lists the names where there is none."""
        if self.surfaces is None:
            raise SuperelementError(f"{self.name}: no surface {name!r}; it has none")
        return self.surfaces.surface(name)

    def rows(self, name: str) -> slice:
        """The rows of an interface in kernel, modes, compliance and accelerance."""
        index = self._index(name)
        start = sum(interface.n_dofs for interface in self.interfaces[:index])
        return slice(start, start + self.interfaces[index].n_dofs)

    def kernel_for(self, h: float, scheme: GeneralizedAlpha, steps: int) -> Kernel:
        """The kernel for any step and scheme over at least `steps` steps.

        The stored one, as it is, where it fits and is long enough; else the modes give it. Raises
        `SuperelementError` where the body has no modes and the stored kernel does not fit; warns as
        `modes_for` does.
        """
        return self._fitting(self.kernel, h, scheme, steps)

    def complete_kernel_for(self, h: float, scheme: GeneralizedAlpha, steps: int) -> Kernel:
        """The kernel of interfaces and channels together for any step and scheme.

        As `kernel_for`, over at least `steps` steps.
        """
        channels = self.channels
        if channels is None:
            return self.kernel_for(h, scheme, steps)
        if self.modes is not None:
            modes = self.complete_modes(self.modes_for(h))
            return sample_kernel(modes, h, scheme, steps, self.kernel.error, self.kernel.band)
        return self._fitting(self.complete_kernel, h, scheme, steps)

    def _fitting(self, stored: Kernel, h: float, scheme: GeneralizedAlpha, steps: int) -> Kernel:
        # Steps come from text files and divisions; a last digit must not cost a new kernel.
        same = np.isclose(stored.h, h, rtol=1e-12, atol=0.0) and stored.scheme == scheme
        if same and stored.steps >= steps:
            return stored
        if self.modes is None:
            raise SuperelementError(
                f"{self.name}: no modes, so the kernel is fixed: h = {stored.h} s, rho_inf = "
                f"{stored.scheme.rho_inf}, {stored.steps} steps; asked for h = {h} s, rho_inf = "
                f"{scheme.rho_inf}, {steps} steps: make it anew, by these in [impulse]"
            )
        return sample_kernel(self.modes_for(h), h, scheme, steps, stored.error, stored.band)

    def modes_for(self, h: float) -> Modes:
        """The modes, for time stepping by h [s]; `SuperelementError` where the body has none.

        Warns (`StepWarning`) of a step finer than `h_min`: up to 1 / (4 h) [Hz] it would resolve
        more than they hold.
        """
        modes = self.modes
        if modes is None:
            raise SuperelementError(f"{self.name}: no modes")
        # Not for a last digit that differs by rounding.
        if h < modes.h_min * (1.0 - 1e-9):
            warn(
                f"{self.name}: modes for steps down to {modes.h_min:g} s, right up to "
                f"{0.25 / modes.h_min:g} Hz; asked for steps of {h:g} s, "
                f"which resolve {0.25 / h:g} Hz: make it anew, by step or band in [impulse]",
                StepWarning,
                stacklevel=2,
            )
        return modes

    def _index(self, name: str) -> int:
        for index, interface in enumerate(self.interfaces):
            if interface.name == name:
                return index
        known = ", ".join(interface.name for interface in self.interfaces)
        raise SuperelementError(f"{self.name}: no interface {name!r}; it has: {known}")


def _check_inertia(J_rot: Array) -> None:
    check_symmetric("J_rot", J_rot)
    principal = np.linalg.eigvalsh(J_rot)
    if principal.min() <= 0.0:
        raise SuperelementError(
            f"J_rot: expected positive principal inertias, found {principal.tolist()}"
        )
    check_positive("J_rot", float(principal.min()))
