"""Beams with load patterns and sensors, and the unreduced model under the same loads."""

from dataclasses import replace

import meshio
import numpy as np
from duhamel.preprocess.body.loads import LoadPattern
from duhamel.preprocess.body.sensors import SensorPoint
from duhamel.superelement import Channels, Pattern

from .conftest import make_beam
from .monolithic import Reference

LOADS = {
    "wind": {"force_per_length": [0.3, 1.0, -0.4], "group": "outer"},
    "pull": {"force_per_length": [1.0, 0.0, 0.0]},
}
SENSORS = {
    "end": {"point": [0.5, 0.0, 0.0]},
    "middle": {"point": [0.2, 0.003, 0.001]},
    "gauge": {"point": [0.0, 0.003, 0.0], "direction": [1, 0, 0]},
}


def channelled_beam(folder, elements=3, loads=LOADS, sensors=SENSORS, **changes):
    """The paper's beam in a few elements, with patterns and sensors.

    The group "outer" is the half, or the larger part of three, at the tip.
    """
    return make_beam(
        mesh=divided_mesh(folder / "channelled.msh", elements),
        loads={name: LoadPattern.model_validate(load) for name, load in loads.items()},
        sensors={name: SensorPoint.model_validate(sensor) for name, sensor in sensors.items()},
        **changes,
    )


def divided_mesh(path, elements):
    """A bar of 0.5 m along x, in two parts."""
    points = np.zeros((elements + 1, 3))
    points[:, 0] = np.linspace(0.0, 0.5, elements + 1)
    lines = np.stack([np.arange(elements), np.arange(1, elements + 1)], axis=1)
    inner = elements // 2
    tags = [np.array([1]), np.full(inner, 2), np.full(elements - inner, 3)]
    names = {"tip": [1, 0], "inner": [2, 1], "outer": [3, 1]}
    meshio.Mesh(
        points,
        [("vertex", np.array([[elements]])), ("line", lines[:inner]), ("line", lines[inner:])],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array(tag) for name, tag in names.items()},
    ).write(path, file_format="gmsh22", binary=False)
    return path


def with_pattern_of(element, interface, direction):
    """A body with a pattern "same" that is a force on one of its interfaces."""
    X, rows = element.interface(interface).X, element.modes.phi[element.rows(interface)][:3]
    pattern = Pattern("same", direction, np.cross(X, direction))
    return replace(element, channels=Channels((pattern,), (), direction @ rows[None]))


class SpreadReference(Reference):
    """The unreduced model under a pattern beside a force on the tip, (n, 4) with the amplitude."""

    pattern = "wind"

    def _equations(self, x, R, u, v, v_dot, lam, torque, tip_force):
        residual, phi, B = super()._equations(x, R, u, v, v_dot, lam, torque, tip_force[:3])
        channels, amplitude = self.structure.channels, tip_force[3]
        names = [pattern.name for pattern in channels.patterns]
        number = names.index(self.pattern)
        pattern = channels.patterns[number]
        residual[6:9] -= amplitude * R[1] @ pattern.force
        residual[9:12] -= amplitude * pattern.moment
        residual[12:] -= amplitude * channels.rows[[number]].toarray()[0]
        return residual, phi, B
