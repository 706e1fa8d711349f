"""Superelements of rods and beams with all modes, or few of them."""

import tempfile
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import meshio
import numpy as np
from duhamel.preprocess import Body, Structure, assemble, build, read_body
from duhamel.preprocess.responses.truncated import REDUCTION_METHODS
from duhamel.superelement import Modes, Superelement, sample_kernel
from numpy.typing import NDArray

from .exact import ArmOnStop, Rod, SphereOnBeam

BRACKET = Path(__file__).parents[2] / "meshes/bracket/bracket.toml"
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
    places = {"left": 0, "middle": elements // 2, "right": elements}
    return _line(impact.length, elements, _soft_in_z(impact), places)


def arm_body(impact: ArmOnStop, elements: int) -> Body:
    """The arm along x, soft in z alone; interfaces root and tip."""
    return _line(impact.length, elements, _soft_in_z(impact), {"root": 0, "tip": elements})


def _soft_in_z(impact: SphereOnBeam | ArmOnStop) -> dict[str, float]:
    stiff = STIFF * impact.EI
    return {
        "EA": STIFF**2 * impact.EI / impact.length**2,
        "EI_y": impact.EI,
        "EI_z": stiff,
        "GJ": stiff,
        "mass_per_length": impact.mass_per_length,
        "polar_inertia_per_length": 1e-4 * impact.mass_per_length * impact.length**2,
    }


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


@dataclass(frozen=True, eq=False)
class Reducible:
    """A body with all its modes, and what it takes to give it few.

    touch: the interface that an impact moves along axis (3,). Modes that do not move it are not
    counted: `asked` of a method hold `count` that do, or as many as it takes where that is not
    known.
    """

    body: Body
    touch: str
    axis: tuple[float, float, float]
    known: int | None = 1
    """modes asked for one that moves the point of contact; None where that is not known"""

    @cached_property
    def whole(self) -> Superelement:
        return build(self.body)

    @cached_property
    def _structure(self) -> Structure:
        return assemble(self.body)

    def with_modes(self, method: str, count: int | None) -> Superelement:
        """With modes that move the point of contact: the first of the free body, for "free", or
        those of Craig and Bampton, or Rubin, beside the ones they add for interfaces; all of them
        for no count.
        """
        if count is None:
            return self.whole
        if method == "free":
            modes = self.whole.modes
            assert modes is not None
            return self._of(_kept(modes, self._moving(modes)[:count]))
        if self.known is not None:
            return self._of(self._truncated(method, self.known * count))
        return self._of(self._searched(method, count))

    def _truncated(self, method: str, asked: int) -> Modes:
        return REDUCTION_METHODS[method](self._structure, self.body.damping, asked).modes

    def _searched(self, method: str, count: int) -> Modes:
        """With one interface: Rubin adds one that moves it, Craig and Bampton none."""
        asked, wanted = count, count + (method == "rubin")
        while True:
            modes = self._truncated(method, asked)
            missing = wanted - len(self._moving(modes))
            if missing <= 0:
                return modes
            asked += missing

    def _moving(self, modes: Modes) -> NDArray[np.int64]:
        rows = self.whole.rows(self.touch)
        moves = np.abs(np.array(self.axis) @ modes.phi[rows][:3])
        return np.flatnonzero(moves > MOVING * moves.max())

    def _of(self, modes: Modes) -> Superelement:
        whole = self.whole
        kernel = sample_kernel(modes, whole.kernel.h, whole.kernel.scheme, whole.kernel.steps)
        return replace(
            whole,
            modes=modes,
            kernel=kernel,
            compliance=modes.compliance,
            accelerance=modes.accelerance,
            recovery=None,
        )


def _kept(modes: Modes, kept: NDArray[np.int64]) -> Modes:
    return replace(modes, omega=modes.omega[kept], zeta=modes.zeta[kept], phi=modes.phi[:, kept])


def reducible_rod(rod: Rod, elements: int) -> Reducible:
    return Reducible(rod_body(rod, elements), "touch", (1.0, 0.0, 0.0), known=None)


def reducible_beam(impact: SphereOnBeam, elements: int) -> Reducible:
    """Every second mode moves the middle."""
    return Reducible(beam_body(impact, elements), "middle", (0.0, 0.0, 1.0), known=2)


def reducible_arm(impact: ArmOnStop, elements: int) -> Reducible:
    return Reducible(arm_body(impact, elements), "tip", (0.0, 0.0, 1.0))


def reducible_bracket(step: float) -> Reducible:
    """The bracket of the gallery, hit on a lug, with all modes that steps [s] resolve."""
    body = read_body(BRACKET)
    impulse = body.impulse.model_copy(update={"step": step})
    return Reducible(body.model_copy(update={"impulse": impulse}), "lug_1", (1.0, 0.0, 0.0))
