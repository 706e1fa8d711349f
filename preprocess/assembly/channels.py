"""Load patterns and sensors as rows on the dofs of a structure, beside those of its interfaces."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from ...superelement import Pattern, Sensor
from ...superelement.validation import Array
from ..body.body import Body
from ..errors import PreprocessError
from ..processes import ONE_PROCESS, Processes
from .rigid import RigidModes, relieve
from .source import Source

NEGLIGIBLE_FORCE = 1e-10
"""of the forces of a pattern, relative to the largest: what is left by rounding of one that only
accelerates the body as a whole
"""


@dataclass(frozen=True, eq=False)
class ChannelRows:
    """Patterns and sensors of a body, with rows (n, n_u), sparse.

    Of a pattern the row is the load that deforms the body, P^T f, at the amplitude 1.
    """

    patterns: tuple[Pattern, ...]
    sensors: tuple[Sensor, ...]
    rows: Any
    deforming: NDArray[np.bool_]
    """(n,) False for patterns that only accelerate the body, whose rows are zero"""


@dataclass(frozen=True, eq=False)
class SelectedChannels:
    """Patterns and sensors on the dofs of a structure, before its mass is known.

    forces (n_u,) of each pattern by name; of each sensor by name its kind, its place X (3,) and the
    rows (k, n_u), sparse, that read it.
    """

    forces: Mapping[str, Array]
    readings: Mapping[str, tuple[str, Array, Any]]


def selected_channels(body: Body, source: Source, T: Any) -> SelectedChannels | None:
    """The patterns and sensors of a body file; None where it has none.

    T (n_source, n_u): dofs of the source from those that are left once nodes follow rigid frames.
    `PreprocessError` names the table and the key of one that selects nothing.
    """
    if not (body.loads or body.sensors):
        return None
    forces, readings = {}, {}
    for name, load in body.loads.items():
        with _named(source, f"loads.{name}"):
            # Work stays the same: loads on tied nodes become loads and moments on their frame.
            forces[name] = T.T @ source.forces(load)
    for name, sensor in body.sensors.items():
        with _named(source, f"sensors.{name}"):
            read, X = source.readings(sensor)
        readings[name] = sensor.kind, X, read @ T
    return SelectedChannels(forces, readings)


def channel_rows(
    selected: SelectedChannels, rigid: RigidModes, M: Any, processes: Processes = ONE_PROCESS
) -> ChannelRows:
    """The channels of a body with its mass M; of several processes each has its own columns."""
    patterns, sensors, rows = [], [], []
    for name, f in selected.forces.items():
        resultant = processes.total(rigid.A.T @ f)
        patterns.append(Pattern(name, resultant[:3], resultant[3:]))
        rows.append(_self_equilibrated(f, rigid, M, processes))
    for name, (kind, X, read) in selected.readings.items():
        sensors.append(Sensor(name, kind, X - rigid.center))
        rows.append(read)
    # Of several processes each sees its own columns: a row is empty only if it is in all.
    table = sp.vstack(rows, format="csr")
    entries = processes.total(np.diff(table.indptr).astype(float))
    return ChannelRows(tuple(patterns), tuple(sensors), table, entries > 0.0)


def _self_equilibrated(f: Array, rigid: RigidModes, M: Any, processes: Processes) -> Any:
    """P^T f as one row; nothing where only its rounding is left."""
    left = relieve(f[:, None], rigid.U, M, processes)
    largest, size = (processes.largest(float(np.abs(g).max(initial=0.0))) for g in (left, f))
    if largest <= NEGLIGIBLE_FORCE * size:
        left[:] = 0.0
    return sp.csr_array(left.T)


@contextmanager
def _named(source: Source, key: str) -> Iterator[None]:
    try:
        yield
    except PreprocessError as error:
        # The same kind of error, which callers tell apart, with the place in front.
        raise type(error)(f"{source.name}: {key}: {error}") from error
