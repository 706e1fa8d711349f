"""The test of a part: its tables, its responses, and the measurement that they make."""

from dataclasses import dataclass

import numpy as np

from ...superelement.validation import Array
from ..body.measured_body import MeasuredBody
from ..errors import MeasurementError
from ..identification.responses import Measurement
from .channels import ChannelTable, read_channels
from .coherence import require_coherence
from .coordinates import TestCoordinates, coordinates_of
from .first_resonance import BEYOND_CORDS, FirstResonance, first_resonance
from .frequency_data import FrequencyData, read_responses
from .hits import HitTable, read_hits
from .quantity import require_quantity
from .rigid import RigidProperties, rigid_properties


@dataclass(frozen=True, eq=False)
class PartTest:
    """All that a body file says of a test; first: its first resonance beyond those of the cords."""

    body: MeasuredBody
    channels: ChannelTable
    hits: HitTable
    data: FrequencyData
    rigid: RigidProperties
    coordinates: TestCoordinates
    first: FirstResonance | None


def read_part_test(body: MeasuredBody) -> PartTest:
    """The test of a body, whose lines are those of its band; `MeasurementError` names the file."""
    asked = body.measured
    channels, hits = read_channels(asked.channels), read_hits(asked.hits)
    data = read_responses(asked.frf, asked.quantity, channels, hits, asked.window)
    low, high = asked.lowest, asked.band[1]
    used = (data.f >= low) & (data.f <= high)
    chosen = data.lines(np.flatnonzero(used))
    require_coherence(asked.frf, chosen)
    require_quantity(asked.frf, chosen)
    beyond = max(asked.band[0], BEYOND_CORDS * (asked.suspension or 0.0))
    free = data.lines(np.flatnonzero((data.f >= beyond) & (data.f <= high)))
    first = first_resonance(free.f, free.H)
    # Coordinates move about the center, which the responses may have to tell.
    rigid = rigid_properties(asked, channels, hits, chosen, first)
    coordinates = coordinates_of(body.interfaces, channels, hits, rigid.center)
    # Fewer lines than coordinates cannot tell them apart.
    if used.sum() < len(coordinates.rigid):
        raise MeasurementError(
            f"measured.band: expected {len(coordinates.rigid)} frequencies of the file from "
            f"{low:g} to {high:g} Hz or more, found {int(used.sum())} of {data.f[0]:g} to "
            f"{data.f[-1]:g} Hz"
        )
    return PartTest(body, channels, hits, chosen, rigid, coordinates, first)


def measurement_of(test: PartTest) -> Measurement:
    """The measurement of the part with all that was mounted on it."""
    own, s = test.coordinates, test.data.laplace(test.body.measured.window)
    return Measurement(s, test.data.H, own.outputs, own.inputs, own.rigid, loaded_mass(test))


def loaded_mass(test: PartTest) -> Array:
    """Mass and inertia (6, 6) about the center of the part with its sensors."""
    M, mass = test.rigid.matrix, test.body.measured.sensor_mass
    if mass:
        by_rigid = sensor_motions(test) @ test.coordinates.rigid
        M = M + mass * by_rigid.T @ by_rigid
    return M


def sensor_motions(test: PartTest) -> Array:
    """The motions (3 n, q) of all sensors along x, y, z; `MeasurementError` if one is not known."""
    known = test.coordinates.motions
    for label in test.channels.labels:
        if label not in known:
            raise MeasurementError(
                f"measured.sensor_mass: sensor {label} is at no interface, and does not measure in "
                "three directions: where its mass moves is not known"
            )
    return np.vstack(list(known.values()))
