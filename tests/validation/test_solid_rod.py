"""A wave in a free rod of solids (d'Alembert), as `test_rod_wave` has it with bars: a force on one
end from t = 0 on.

The loaded end moves at v = F / (A sqrt(E rho)) until the wave has been to the far end and back, 2 L
/ c with c = sqrt(E / rho); the far end rests until L / c, then moves at 2 v. With nu = 0 a solid
rod is one of these: the force on a frame that follows the mean motion of its face is a uniform
traction, and what it makes stays uniform across.

Steel, L = 1 m; krylov. 10 x 10 mm and one element across: steps are fine and rho_inf is low, so
that the frequencies which belong to the mesh die out soon. Elements with nodes at their middles
have a gap between two branches of frequencies; at its edge waves stand where they are made, and the
loaded end rings longer than with elements of eight nodes. Tolerances, from what was measured: the
velocities are looked at 10 % of L / c before and after the front, and may ripple by 5 % of v; their
means are those of the closed form to 1e-3.

20 x 20 mm in up to a million unknowns, which no factor is made of: the front is as wide as steps
four times as long let it be, and velocities are looked at 30 % of L / c before and after it.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Force,
    Model,
    Settings,
    simulate,
)

from .solid_bar import solid_superelement

E, rho, L, F = 2e11, 8000.0, 1.0, 1e3
c = np.sqrt(E / rho)
RHO_INF = 0.2
RIPPLE, MEAN = 0.05, 1e-3


@dataclass(frozen=True)
class Case:
    """A mesh of a rod, how finely it is stepped, and how far from the front it is looked at, over
    L / c.
    """

    kind: str
    divisions: tuple[int, int, int]
    side: float
    step: float
    band: float
    margin: float
    solver: str

    @property
    def speed(self) -> float:
        """v [m/s]"""
        return float(F / (self.side**2 * np.sqrt(E * rho)))


THIN = (0.01, 5e-7, 1.5e5, 0.1, "factor")
WIDE = (0.02, 2e-6, 2.5e4, 0.3, "iterative")
CASES = {
    "8 nodes": Case("hexahedron", (200, 1, 1), *THIN),
    "27 nodes": Case("hexahedron27", (80, 1, 1), *THIN),
    "10 nodes, no factor": Case("tetra10", (100, 4, 4), *WIDE),
}
MILLION = Case("hexahedron27", (200, 14, 14), *WIDE)
PARAMETERS = [
    *(pytest.param(case, id=name, marks=pytest.mark.validation) for name, case in CASES.items()),
    pytest.param(MILLION, id="a million unknowns, no factor", marks=pytest.mark.large),
]


@pytest.fixture(scope="module", params=PARAMETERS)
def motion(request, tmp_path_factory):
    case = request.param
    rod = solid_superelement(
        tmp_path_factory.mktemp("rod"),
        case.kind,
        (L, case.side, case.side),
        case.divisions,
        {"E": E, "nu": 0.0, "rho": rho},
        {
            "step": case.step,
            "rho_inf": RHO_INF,
            "band": case.band,
            "tolerance": 1e-4,
            "solver": case.solver,
        },
    )
    model = Model(
        bodies={"rod": FlexibleBody(rod)},
        loads=(Force("rod.root", [F, 0, 0], Constant(1.0)),),
        settings=Settings(t_end=2.0 * L / c, step=case.step, rho_inf=RHO_INF),
    )
    print(f"{case.kind}: {len(rod.modes.omega)} modes, error {rod.kernel.error:.1e}")
    return case, simulate(model)


@pytest.mark.parametrize(
    ("end", "begin", "until", "reference"),
    [("root", 0, 2, 1.0), ("tip", None, 1, 0.0), ("tip", 1, None, 2.0)],
    ids=["loaded end", "far end before the wave", "far end after it"],
)
def test_the_ends_move_as_dalembert_says(motion, end, begin, until, reference):
    """begin, until: fronts, over L / c."""
    case, results = motion
    arrived = results.time * c / L
    seen = np.full(len(arrived), True)
    if begin is not None:
        seen &= arrived > begin + case.margin
    if until is not None:
        seen &= arrived < until - case.margin
    velocity = results.frame(f"rod.{end}").velocity[seen] / case.speed
    ripple, mean = np.abs(velocity[:, 0] - reference).max(), velocity[:, 0].mean()
    aside = np.abs(velocity[:, 1:3]).max()
    print(
        f"{end}: mean velocity {mean:.6f} v, reference {reference:g} v, ripple {ripple:.1e} v, "
        f"aside {aside:.1e} v"
    )
    assert abs(mean - reference) < MEAN
    assert ripple < RIPPLE
