"""Modes of a model with the frequencies and the damping of a test.

A mode with a measured partner takes its frequency and its damping. The others keep their place
among these: their frequencies change by the median ratio of the pairs, their damping is the median
one. Shapes stay, so that H = phi omega^-2 phi^T changes along, and all that is made of shapes is
as it was.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ...superelement import MeasuredModes, Modes, Superelement, sample_kernel
from ...superelement.validation import Array
from ..assembly.source import Source
from ..assembly.structure import Structure, assemble_on
from ..body.body import Body
from ..body.material import Material
from ..body.measured import Measured
from ..body.sensors import SensorPoint
from ..errors import MeasurementError
from ..progress import Warn
from ..responses.impulse import ImpulseResponses
from .channels import ChannelTable, read_channels
from .matching import Matches, matched
from .modal_data import DOUBTED_COMPLEXITY, ModalData, read_modes

SENSOR_NAME = "measured_{}"
"""of the sensors of a superelement at those of the test"""
FARTHEST_NODE = 0.05
"""distance of a sensor from a mesh, over its size, beyond which it is of another one"""


@dataclass(frozen=True, eq=False)
class ModalTest:
    """What a body file says of a test, its channels and its modes."""

    asked: Measured
    channels: ChannelTable
    modes: ModalData


def read_test(body: Body) -> ModalTest | None:
    """The test of a body, None where there is none."""
    if body.measured is None:
        return None
    channels = read_channels(body.measured.channels)
    return ModalTest(body.measured, channels, read_modes(body.measured.modes, channels))


def with_test(body: Body, test: ModalTest, source: Source) -> Body:
    """The body with the mass that was weighed, and with sensors where the test had some."""
    sensors = dict(body.sensors)
    for label, point in _on_mesh(test, source).items():
        name = SENSOR_NAME.format(label)
        if name in sensors or name in body.interfaces or name in body.loads:
            raise MeasurementError(f"{test.asked.channels}: {label}: the body has a {name} already")
        sensors[name] = SensorPoint(point=tuple(point.tolist()))
    changes: dict[str, object] = {"sensors": sensors}
    # By the density, so that shapes stay normalized by the mass, and inertia follows.
    mass = test.asked.rigid.mass
    if mass is not None:
        ratio = _density_ratio(body, mass, assemble_on(body, source).rigid.mass)
        if body.material is not None:
            changes["material"] = _denser(body.material, ratio)
        changes["materials"] = {key: _denser(m, ratio) for key, m in body.materials.items()}
    return body.model_copy(update=changes)


def _on_mesh(test: ModalTest, source: Source) -> dict[str, Array]:
    """The node of a mesh that is nearest to each sensor, for these stand on the part, not in it."""
    sensors = test.channels.sensors
    mesh = getattr(source, "mesh", None)
    if mesh is None:
        return sensors  # of matrices: it is read at their nodes
    points = mesh.points
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    for label, point in sensors.items():
        apart = np.linalg.norm(points - point, axis=1)
        nearest = int(apart.argmin())
        if apart[nearest] > FARTHEST_NODE * size:
            raise MeasurementError(
                f"{test.asked.channels}: sensor {label}: expected a place on the mesh, in its axes "
                f"and in m, found {point.tolist()}, {apart[nearest]:.3g} m from the nearest node"
            )
        sensors[label] = points[nearest]
    return sensors


def _density_ratio(body: Body, mass: float, found: float) -> float:
    """What densities are multiplied with, so that the body has a mass; point masses stay."""
    # Point masses were weighed by themselves.
    points = sum(point.mass for point in body.masses.values())
    if not mass > points:
        raise MeasurementError(
            f"measured.rigid.mass: expected more than the masses of the body, {points:g} kg, found "
            f"{mass:g}"
        )
    return (mass - points) / (found - points)


def _denser(material: Material, ratio: float) -> Material:
    return material.model_copy(update={"rho": ratio * material.rho})


def updated(
    test: ModalTest, structure: Structure, responses: ImpulseResponses, warn: Warn
) -> tuple[ImpulseResponses, MeasuredModes]:
    """Responses with measured frequencies and damping, and what was matched.

    `MeasurementError` where no mode of the model is like a measured one.
    """
    modes = responses.modes
    if modes is None or structure.channels is None:
        raise MeasurementError("measured: needs modes, which impulse.method march does not find")
    measured, own = test.modes, _shapes_at_channels(test, structure, modes)
    pairs = matched(
        (measured.frequency, measured.shapes),
        (modes.omega / (2.0 * np.pi), own),
        test.asked.least_mac,
    )
    calculated = np.where(
        pairs.mode >= 0, modes.omega[np.maximum(pairs.mode, 0)] / (2.0 * np.pi), 0.0
    )
    found = MeasuredModes(
        measured.frequency, measured.damping, calculated, pairs.mac, measured.complexity
    )
    if not found.matched.any():
        raise MeasurementError(
            f"{test.asked.modes}: no mode of the mesh is like a measured one: the largest MAC is "
            f"{pairs.mac.max():.2f}, expected {test.asked.least_mac:g}: are channels in mesh axes, "
            "and in m?"
        )
    for doubt in _doubts(test, found, pairs, modes):
        warn(doubt)
    return _with_modes(structure, responses, modes, _new_modes(modes, found, pairs)), found


def _shapes_at_channels(test: ModalTest, structure: Structure, modes: Modes) -> Array:
    """Shapes (m, n) of the model at the channels of the test."""
    rows = structure.channels
    assert rows is not None
    # Load patterns that deform nothing have no rows among the responses.
    phi = np.zeros((len(rows.deforming), len(modes.omega)))
    phi[rows.deforming] = modes.phi[structure.n_c :]
    first, place = len(rows.patterns), {}
    for sensor in rows.sensors:
        place[sensor.name] = first
        first += len(sensor.channels)
    shapes = np.empty((len(modes.omega), len(test.channels.names)))
    for k, (label, direction) in enumerate(
        zip(test.channels.labels, test.channels.directions, strict=True)
    ):
        start = place[SENSOR_NAME.format(label)]
        shapes[:, k] = direction @ phi[start : start + 3]
    return shapes


def _new_modes(modes: Modes, found: MeasuredModes, pairs: Matches) -> Modes:
    has = found.matched
    # The median, for one pair that is wrong does not move it.
    ratio = float(np.median(found.frequency[has] / found.calculated[has]))
    omega = ratio * modes.omega
    zeta = np.full(len(omega), float(np.median(found.damping[has])))
    omega[pairs.mode[has]] = 2.0 * np.pi * found.frequency[has]
    zeta[pairs.mode[has]] = found.damping[has]
    return replace(modes, omega=omega, zeta=zeta)


def _with_modes(
    structure: Structure, responses: ImpulseResponses, old: Modes, new: Modes
) -> ImpulseResponses:
    # The error is that of the method: shapes are as they were.
    kernel = responses.kernel
    sampled = sample_kernel(
        new, kernel.h, kernel.scheme, len(kernel.g) - 1, kernel.error, kernel.band
    )
    H = responses.surface_compliance
    if H is not None and responses.shapes is not None and structure.surfaces is not None:
        # What modes of the band do not have stays as it was.
        phi = responses.shapes(structure.surfaces.rows)
        H = H + (phi * (new.omega**-2.0 - old.omega**-2.0)) @ phi.T
    return replace(responses, modes=new, kernel=sampled, surface_compliance=H)


def _doubts(test: ModalTest, found: MeasuredModes, pairs: Matches, modes: Modes) -> Iterator[str]:
    name = test.asked.modes
    for i in range(len(found.frequency)):
        mode = f"{name}: the mode at {found.frequency[i]:.5g} Hz"
        if not found.matched[i]:
            yield (
                f"{mode} is not used: no mode of the mesh is like it, the largest MAC is "
                f"{found.mac[i]:.2f}"
            )
        elif pairs.rivals[i] >= 0:
            other = modes.omega[pairs.rivals[i]] / (2.0 * np.pi)
            yield (
                f"{mode} may be that of the mesh at {found.calculated[i]:.5g} Hz or at "
                f"{other:.5g} Hz: its channels do not tell these apart"
            )
        if found.complexity[i] > DOUBTED_COMPLEXITY:
            yield (
                f"{mode} is complex: {100.0 * found.complexity[i]:.0f} % of its shape is out of "
                "phase, which real modes do not have"
            )


def with_rigid(element: Superelement, test: ModalTest, found: MeasuredModes) -> Superelement:
    """The superelement with the inertia that was measured, and what was matched."""
    inertia = test.asked.rigid.inertia
    J = element.J_rot if inertia is None else np.diag(inertia)
    return replace(element, J_rot=J, measured=found)
