"""A superelement of a part from its frequency response test."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib import metadata

import numpy as np

from ...files.blas import one_blas_thread
from ...superelement import (
    Channels,
    GeneralizedAlpha,
    Interface,
    Modes,
    Provenance,
    Sensor,
    Superelement,
    sample_kernel,
)
from ...superelement.validation import Array
from ..body.measured_body import MeasuredBody
from ..errors import MeasurementError
from ..identification.identify import Identification, identify
from ..identification.loading import FreeModes, without_masses
from ..identification.responses import REST_DAMPING, Measurement
from ..progress import Stages
from .channels import ChannelTable, read_channels
from .coordinates import TestCoordinates, coordinates_of
from .frequency_data import FrequencyData, read_responses
from .hits import HitTable, read_hits
from .mass_line import doubts_of_mass_line
from .update import SENSOR_NAME

TOLD_DOUBTS = 3
DOUBTED_MISFIT = 0.1
"""of a fit, of which a warning tells"""
DOUBTED_SIGN = 0.9
"""of the driving points of a mode: of true ones it is above 0.98"""
BAND_OF_TEST = 0.9
"""of the highest frequency: above it the flanks of modes beyond the band are missing"""


@dataclass(frozen=True, eq=False)
class PartTest:
    """All that a body file says of a test."""

    body: MeasuredBody
    channels: ChannelTable
    hits: HitTable
    data: FrequencyData
    coordinates: TestCoordinates


def read_part_test(body: MeasuredBody) -> PartTest:
    """The test of a body, whose lines are those of its band; `MeasurementError` names the file."""
    asked = body.measured
    channels, hits = read_channels(asked.channels), read_hits(asked.hits)
    center = np.array(asked.rigid.center)
    coordinates = coordinates_of(body.interfaces, channels, hits, center)
    data = read_responses(asked.frf, asked.quantity, channels, hits, asked.window)
    low, high = asked.band
    # Fewer lines than coordinates cannot tell them apart.
    used = (data.f >= low) & (data.f <= high)
    if used.sum() < len(coordinates.rigid):
        raise MeasurementError(
            f"measured.band: expected {len(coordinates.rigid)} frequencies of the file from "
            f"{low:g} to {high:g} Hz or more, found {int(used.sum())} of {data.f[0]:g} to "
            f"{data.f[-1]:g} Hz"
        )
    return PartTest(body, channels, hits, FrequencyData(data.f[used], data.H[used]), coordinates)


@dataclass(frozen=True, eq=False)
class IdentifiedPart:
    """A test, what was identified of it, and what is doubtful about it."""

    test: PartTest
    measurement: Measurement
    found: Identification
    doubts: tuple[str, ...]


def identified(body: MeasuredBody, stages: Stages) -> IdentifiedPart:
    """The modes of a part that is known from its test, whatever they are like."""
    with stages.stage("test"):
        test = read_part_test(body)
        measurement = measurement_of(test)
    with stages.stage("identification"), one_blas_thread():
        center = np.array(body.measured.rigid.center)
        doubts = list(doubts_of_mass_line(measurement, test.channels, test.hits, center))
        found = identify(measurement)
    return IdentifiedPart(test, measurement, found, (*doubts, *_doubts_of_fit(found)))


def build_measured(body: MeasuredBody, stages: Stages) -> Superelement:
    """The superelement of a part that is known from its test."""
    part, asked = identified(body, stages), body.measured
    fit = part.found.fit
    if fit.misfit > asked.accept:
        # What is wrong with the wires says more than what the fit is like.
        raise MeasurementError(
            f"{asked.frf}: the responses of {len(fit.omega)} modes differ from those measured by "
            f"{fit.misfit:.2f} of these, expected at most measured.accept = {asked.accept:g}"
            + "".join(f"; {doubt}" for doubt in part.doubts[:TOLD_DOUBTS])
        )
    for doubt in part.doubts:
        stages.warn(f"{asked.frf}: {doubt}")
    modes = _free_modes(part.test, part.found)
    return _superelement(part.test, modes, fit.misfit, len(fit.omega), stages)


def measurement_of(test: PartTest) -> Measurement:
    """The measurement of the part with all that was mounted on it."""
    own, asked = test.coordinates, test.body.measured
    s = np.asarray(2j * np.pi * test.data.f + asked.window, dtype=complex)
    return Measurement(s, test.data.H, own.outputs, own.inputs, own.rigid, _loaded_mass(test))


def _loaded_mass(test: PartTest) -> Array:
    asked = test.body.measured
    M = np.zeros((6, 6))
    M[:3, :3] = asked.rigid.mass * np.eye(3)
    M[3:, 3:] = asked.rigid.inertia
    for rows in _sensor_rows(test) if asked.sensor_mass else ():
        by_rigid = rows @ test.coordinates.rigid
        M += asked.sensor_mass * by_rigid.T @ by_rigid
    return M


def _sensor_rows(test: PartTest) -> list[Array]:
    """The motion of each sensor (3, q); `MeasurementError` where it is not known."""
    known = test.coordinates.motions
    for label in test.channels.labels:
        if label not in known:
            raise MeasurementError(
                f"measured.sensor_mass: sensor {label} is at no interface, and does not measure in "
                "three directions: where its mass moves is not known"
            )
    return list(known.values())


def _free_modes(test: PartTest, found: Identification) -> FreeModes:
    fit, own, mass = found.fit, test.coordinates, test.body.measured.sensor_mass
    # The rest becomes modes like all others, beyond the band.
    counts = [L.shape[1] for L in fit.rest]
    modes = FreeModes(
        np.concatenate([fit.omega, np.repeat(fit.rest_omega, counts)]),
        np.concatenate([fit.zeta, np.full(sum(counts), REST_DAMPING)]),
        np.hstack([fit.shapes, *fit.rest]),
    )
    if not mass:
        return modes
    rows = np.vstack(_sensor_rows(test))
    n = len(own.rigid)
    # Masses move with sensors, which are further coordinates here.
    wide = replace(modes, shapes=np.vstack([modes.shapes, rows @ modes.shapes]))
    masses = np.concatenate([np.zeros(n), np.full(len(rows), mass)])
    rigid = np.vstack([own.rigid, rows @ own.rigid])
    try:
        free = without_masses(wide, rigid, _loaded_mass(test), masses)
    except ValueError as error:
        raise MeasurementError(
            f"measured.sensor_mass: expected less than the modes of the test have, found {mass:g}"
        ) from error
    return replace(free, shapes=free.shapes[:n])


def _doubts_of_fit(found: Identification) -> Iterator[str]:
    fit = found.fit
    if fit.misfit > DOUBTED_MISFIT:
        yield (
            f"the responses of {len(fit.omega)} modes differ from those measured by "
            f"{fit.misfit:.2f} of these"
        )
    for frequency in fit.frequencies[found.signs < DOUBTED_SIGN]:
        yield (
            f"the mode at {frequency:.5g} Hz has another shape by hits than by sensors: are all of "
            "them where the tables say?"
        )


def _superelement(
    test: PartTest, free: FreeModes, misfit: float, count: int, stages: Stages
) -> Superelement:
    body, own = test.body, test.coordinates
    asked, impulse = body.measured, body.impulse
    band = BAND_OF_TEST * float(test.data.f[-1])
    rows = np.concatenate([np.arange(q.start, q.stop) for q in own.interfaces.values()])
    order = np.argsort(free.omega)
    modes = Modes(
        free.omega[order], free.zeta[order], free.shapes[rows][:, order], h_min=0.25 / band
    )
    sensors = tuple(
        Sensor(SENSOR_NAME.format(label), "motion", own.places[label]) for label in own.sensors
    )
    channels = None
    if sensors:
        at = np.concatenate([np.arange(q.start, q.stop) for q in own.sensors.values()])
        channels = Channels((), sensors, phi=free.shapes[at][:, order])
    scheme = GeneralizedAlpha(impulse.rho_inf)
    return Superelement(
        name=body.name,
        mass=asked.rigid.mass,
        J_rot=np.array(asked.rigid.inertia),
        center=np.array(asked.rigid.center),
        interfaces=tuple(
            Interface(name, own.places[name], point.rotations)
            for name, point in body.interfaces.items()
        ),
        kernel=sample_kernel(modes, impulse.step, scheme, impulse.steps, misfit, band),
        modes=modes,
        compliance=modes.compliance,
        accelerance=modes.accelerance,
        channels=channels,
        provenance=Provenance(
            body=body.text,
            mesh=", ".join(path.name for path in body.files),
            mesh_sha256=body.digests,
            method=f"measured with {count} modes, misfit {misfit:.2g} of the responses",
            tolerance=asked.accept,
            versions={name: metadata.version(name) for name in ("duhamel", "numpy", "scipy")},
            timings=stages.seconds,
        ),
    )
