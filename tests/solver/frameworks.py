"""Superelements of beams in space, joined rigidly at their ends: bars, a T, a grid."""

from pathlib import Path

import meshio
import numpy as np
from duhamel.preprocess import Body, build
from duhamel.superelement import Superelement

SECTION = {
    "EA": 2.16e7,
    "EI_y": 5.5,
    "EI_z": 5.5,
    "GJ": 4.0,
    "mass_per_length": 0.0858,
    "polar_inertia_per_length": 4.4e-8,
}
"""of the paper's beam"""
ELASTIC = ("EA", "EI_y", "EI_z", "GJ")


def framework(
    folder, ends, interfaces, elements=4, stiffness=1.0, step=2e-4, steps=10, rotation=False
):
    """Straight bars, each given by its two ends and cut into `elements`; bars that share an end are
    joined there.

    interfaces: points by name; stiffness: a factor on all of them; rotation: with terms of second
    order.
    """
    points, lines = _mesh(np.asarray(ends, dtype=float), elements)
    path = Path(folder) / "framework.msh"
    tags = [np.ones(len(lines), dtype=int)]
    meshio.Mesh(
        points, [("line", lines)], cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}
    ).write(path, file_format="gmsh22", binary=False)
    body = {
        "name": "framework",
        "mesh": path,
        "section": SECTION | {name: stiffness * SECTION[name] for name in ELASTIC},
        "interfaces": {name: {"node": list(point)} for name, point in interfaces.items()},
        "impulse": {"step": step, "steps": steps},
    }
    if rotation:
        body["rotation"] = {"modes": 4}
    return build(Body.model_validate(body))


def bar(folder, length, elements=6, **changes) -> Superelement:
    """Along x, with interfaces "left" and "right"."""
    left, right = (0.0, 0.0, 0.0), (length, 0.0, 0.0)
    return framework(folder, [(left, right)], {"left": left, "right": right}, elements, **changes)


def _mesh(ends, elements):
    """Nodes (n, 3), those at the same place made one, and lines (m, 2)."""
    along = np.linspace(0.0, 1.0, elements + 1)[:, None]
    stations = np.concatenate([a + along * (b - a) for a, b in ends])
    points, number = np.unique(np.round(stations, 9), axis=0, return_inverse=True)
    number = number.reshape(len(ends), elements + 1)
    return points, np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)
