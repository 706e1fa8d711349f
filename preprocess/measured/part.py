"""A superelement of a part from its frequency response test."""

from dataclasses import dataclass
from importlib import metadata

import numpy as np

from ...files.arrays import Array
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
from ...superelement.superelement import TESTED_METHOD
from ..body.measured_body import MeasuredBody
from ..errors import MeasurementError
from ..identification.complexity import OutOfPhase, out_of_phase
from ..identification.identify import Identification, identify
from ..identification.loading import FreeModes, without_masses
from ..identification.responses import REST_DAMPING, Measurement
from ..progress import Stages
from .delays import delays_of
from .doubts import (
    BAND_OF_TEST,
    LARGEST_SHARE,
    doubts_of_fit,
    doubts_of_test,
    most_out_of_phase,
    too_complex,
)
from .part_test import PartTest, loaded_mass, measurement_of, read_part_test, sensor_motions
from .rigidity import doubts_of_rigidity
from .update import SENSOR_NAME

TOLD_DOUBTS = 3


@dataclass(frozen=True, eq=False)
class IdentifiedPart:
    """A test, what was identified of it, and what is doubtful about it."""

    test: PartTest
    measurement: Measurement
    found: Identification
    phases: OutOfPhase
    doubts: tuple[str, ...]


def identified(body: MeasuredBody, stages: Stages) -> IdentifiedPart:
    """The modes of a part that is known from its test, whatever they are like."""
    with stages.stage("test"):
        test = read_part_test(body)
        measurement = measurement_of(test)
    with stages.stage("identification"), one_blas_thread():
        doubts = list(doubts_of_test(test, measurement))
        # What is wired wrong does not move as a rigid piece either.
        if not doubts:
            doubts += doubts_of_rigidity(measurement, test.coordinates.interfaces)
        found = identify(measurement, _given_poles(body))
        delays = delays_of(measurement, found.fit)
        # What is late is out of phase, and is told as that.
        phases = out_of_phase(delays.undone(measurement), found.fit)
        doubts += doubts_of_fit(test, measurement, found, delays, phases)
    return IdentifiedPart(test, measurement, found, phases, tuple(doubts))


def _given_poles(body: MeasuredBody) -> Array | None:
    """Circular frequencies and damping ratios (p, 2) of the body file, None if it has none."""
    given = body.measured.poles
    return None if given is None else np.array(given) * [2.0 * np.pi, 1.0]


def build_measured(body: MeasuredBody, stages: Stages) -> Superelement:
    """The superelement of a part that is known from its test."""
    part, asked = identified(body, stages), body.measured
    fit = part.found.fit
    # What is wrong with the wires says more than what the fit is like.
    if fit.misfit > asked.accept:
        raise MeasurementError(
            f"{asked.frf}: the responses of {len(fit.omega)} modes differ from those measured by "
            f"{fit.misfit:.2f} of these, expected at most measured.accept = {asked.accept:g}"
            + "".join(f"; {doubt}" for doubt in part.doubts[:TOLD_DOUBTS])
        )
    if said := too_complex(part.measurement, part.found, part.phases, LARGEST_SHARE):
        others = [doubt for doubt in part.doubts if doubt != said]
        raise MeasurementError(
            f"{asked.frf}: {said}, expected at most {100.0 * LARGEST_SHARE:g} %"
            + "".join(f"; {doubt}" for doubt in others[:TOLD_DOUBTS])
        )
    for doubt in part.doubts:
        stages.warn(f"{asked.frf}: {doubt}")
    return _superelement(part, _free_modes(part.test, part.found), stages)


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
    try:
        return without_masses(modes, own.rigid, loaded_mass(test), sensor_motions(test), mass)
    except ValueError as error:
        raise MeasurementError(
            f"measured.sensor_mass: expected less than the modes of the test have, found {mass:g}"
        ) from error


def _superelement(part: IdentifiedPart, free: FreeModes, stages: Stages) -> Superelement:
    test, fit = part.test, part.found.fit
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
    _, share = most_out_of_phase(part.measurement, part.found, part.phases)
    method = (
        f"{TESTED_METHOD} {len(fit.omega)} modes, misfit {fit.misfit:.2g} of the responses, "
        f"at most {100.0 * share:.2g} % out of phase"
    )
    return Superelement(
        name=body.name,
        mass=test.rigid.mass,
        J_rot=test.rigid.inertia,
        center=test.rigid.center,
        interfaces=tuple(
            Interface(name, own.places[name], point.rotations)
            for name, point in body.interfaces.items()
        ),
        kernel=sample_kernel(modes, impulse.step, scheme, impulse.steps, fit.misfit, band),
        modes=modes,
        compliance=modes.compliance,
        accelerance=modes.accelerance,
        channels=channels,
        provenance=Provenance(
            body=body.text,
            mesh=", ".join(path.name for path in body.files),
            mesh_sha256=body.digests,
            method="; ".join([method, *filter(None, [test.rigid.told])]),
            tolerance=asked.accept,
            versions={name: metadata.version(name) for name in ("duhamel", "numpy", "scipy")},
            timings=stages.seconds,
        ),
    )
