"""Superelements of rods and beams with all modes, or few of them."""

import tempfile
from pathlib import Path

import meshio
import numpy as np
from duhamel.preprocess import Body, build
from duhamel.preprocess.body.body import Method
from duhamel.superelement import Superelement

from .exact import Rod, SphereOnBeam

STIFF = 100.0
"""The second bending stiffness of a beam over the first: what does not take part comes late."""

MOVING = 1e-6
"""Least displacement of a mode, over the largest, that is not rounding."""


def rod_body(rod: Rod, elements: int) -> Body:
    """A rod along x with one interface, `touch`, at its right end.

    So stiff in bending and torsion that the first modes are axial.
    """
    bending = rod.EA * rod.length**2
    section = {
        "EA": rod.EA,
        "EI_y": bending,
        "EI_z": bending,
        "GJ": bending,
        "mass_per_length": rod.mass_per_length,
        "polar_inertia_per_length": 1e-3 * rod.mass_per_length * rod.length**2,
    }
    return _line(rod.length, elements, section, {"touch": elements})


def beam_body(impact: SphereOnBeam, elements: int) -> Body:
    """Timoshenko's beam along x, soft in z alone; interfaces left, middle, right."""
    stiff = STIFF * impact.EI
    section = {
        "EA": STIFF**2 * impact.EI / impact.length**2,
        "EI_y": impact.EI,
        "EI_z": stiff,
        "GJ": stiff,
        "mass_per_length": impact.mass_per_length,
        "polar_inertia_per_length": 1e-4 * impact.mass_per_length * impact.length**2,
    }
    places = {"left": 0, "middle": elements // 2, "right": elements}
    return _line(impact.length, elements, section, places)


def _line(length: float, elements: int, section: dict[str, float], places: dict[str, int]) -> Body:
    points = np.zeros((elements + 1, 3))
    points[:, 0] = np.linspace(0.0, length, elements + 1)
    cells = [("line", np.column_stack([np.arange(elements), np.arange(1, elements + 1)]))]
    path = Path(tempfile.mkdtemp()) / "line.vtk"
    meshio.Mesh(points, cells).write(path)
    return Body.model_validate(
        {
            "name": "line",
            "mesh": path,
            "section": section,
            "interfaces": {name: {"node": points[i].tolist()} for name, i in places.items()},
            "impulse": {"step": 1e-6, "steps": 1, "method": "modal"},
        }
    )


def axial(body: Body, method: Method, count: int) -> Superelement:
    """The superelement of a rod with `count` axial modes, and all others that come before them.

    Rubin's residual mode is one more.
    """
    residual = 1 if method == "rubin" else 0
    modes = count
    while True:
        element = build(body.with_modes(method, modes))
        assert element.modes is not None
        moves = np.abs(element.modes.phi[0])
        moving = moves > MOVING * moves.max()
        missing = count + residual - int(moving.sum())
        if missing <= 0:
            return element
        modes += missing
