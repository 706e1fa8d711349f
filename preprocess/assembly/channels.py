"""Load patterns and sensors as rows on the dofs of a structure, beside those of its interfaces."""

from collections.abc import Iterator
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
from .rigid import RigidModes, relieve
from .source import Source

NOTHING = 1e-10
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

    @property
    def deforming(self) -> NDArray[np.bool_]:
        """(n,) False for patterns that only accelerate the body, whose rows are zero."""
        return np.asarray(np.diff(self.rows.indptr) > 0)


def channel_rows(
    body: Body, source: Source, T: Any, rigid: RigidModes, M: Any
) -> ChannelRows | None:
    """The patterns and sensors of a body file; None where it has none.

    T (n_source, n_u): dofs of the source from those that are left once nodes follow rigid frames.
    `PreprocessError` names the table and the key of one that selects nothing.
    """
    if not (body.loads or body.sensors):
        return None
    patterns, sensors, rows = [], [], []
    for name, load in body.loads.items():
        with _named(source, f"loads.{name}"):
            f = T.T @ source.forces(load)
        resultant = rigid.A.T @ f
        patterns.append(Pattern(name, resultant[:3], resultant[3:]))
        rows.append(_self_equilibrated(f, rigid, M))
    for name, sensor in body.sensors.items():
        with _named(source, f"sensors.{name}"):
            read, X = source.readings(sensor)
        sensors.append(Sensor(name, sensor.kind, X - rigid.center))
        rows.append(read @ T)
    return ChannelRows(tuple(patterns), tuple(sensors), sp.vstack(rows, format="csr"))


def _self_equilibrated(f: Array, rigid: RigidModes, M: Any) -> Any:
    """P^T f as one row; nothing where only its rounding is left."""
    left = relieve(f[:, None], rigid.U, M)
    if np.abs(left).max() <= NOTHING * np.abs(f).max():
        left[:] = 0.0
    return sp.csr_array(left.T)


@contextmanager
def _named(source: Source, key: str) -> Iterator[None]:
    try:
        yield
    except PreprocessError as error:
        raise type(error)(f"{source.name}: {key}: {error}") from error
