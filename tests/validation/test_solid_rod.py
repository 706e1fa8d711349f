"""A wave in a free rod of solids (d'Alembert), as `test_rod_wave` has it with bars: a force on one
end from t = 0 on.

The loaded end moves at v = F / (A sqrt(E rho)) until the wave has been to the far end and back, 2 L
/ c with c = sqrt(E / rho); the far end rests until L / c, then moves at 2 v. With nu = 0 a solid
rod is one of these: the force on a frame that follows the mean motion of its face is a uniform
traction, and what it makes stays uniform across.

Steel, L = 1 m, 10 x 10 mm, one element across; krylov. Steps are fine and rho_inf is low, so that
the frequencies which belong to the mesh die out soon. Elements with nodes at their middles have a
gap between two branches of frequencies; at its edge waves stand where they are made, and the loaded
end rings longer than with elements of eight nodes. Tolerances, from what was measured: the
velocities are looked at 10 % of L / c before and after the front, and may ripple by 5 % of v; their
means are those of the closed form to 1e-3.
"""

import numpy as np
import pytest
from duhamel.solver import Constant, FlexibleBody, Load, Model, Settings, simulate

from .solid_bar import solid_superelement

pytestmark = pytest.mark.validation

E, rho, SIDE, L, F = 2e11, 8000.0, 0.01, 1.0, 1e3
c = np.sqrt(E / rho)
v = F / (SIDE**2 * np.sqrt(E * rho))
STEP, RHO_INF = 5e-7, 0.2
RIPPLE, MEAN = 0.05, 1e-3


@pytest.fixture(
    scope="module", params=[("hexahedron", 200), ("hexahedron27", 80)], ids=["8 nodes", "27 nodes"]
)
def motion(request, tmp_path_factory):
    kind, elements = request.param
    rod = solid_superelement(
        tmp_path_factory.mktemp("rod"),
        kind,
        (L, SIDE, SIDE),
        (elements, 1, 1),
        {"E": E, "nu": 0.0, "rho": rho},
        {"step": STEP, "rho_inf": RHO_INF, "band": 1.5e5, "tolerance": 1e-4},
    )
    model = Model(
        bodies={"rod": FlexibleBody(rod)},
        loads=(Load("force", "rod.root", [F, 0, 0], Constant(1.0)),),
        settings=Settings(t_end=2.0 * L / c, step=STEP, rho_inf=RHO_INF),
    )
    results = simulate(model)
    print(f"{kind}: {len(rod.modes.omega)} modes, error {rod.kernel.error:.1e}")
    return results


@pytest.mark.parametrize(
    ("end", "begin", "until", "reference"),
    [("root", 0.1, 1.9, 1.0), ("tip", 0.0, 0.9, 0.0), ("tip", 1.1, 2.0, 2.0)],
    ids=["loaded end", "far end before the wave", "far end after it"],
)
def test_the_ends_move_as_dalembert_says(motion, end, begin, until, reference):
    arrived = motion.time * c / L
    velocity = motion.frame(f"rod.{end}").velocity[(arrived > begin) & (arrived < until)] / v
    ripple, mean = np.abs(velocity[:, 0] - reference).max(), velocity[:, 0].mean()
    aside = np.abs(velocity[:, 1:3]).max()
    print(
        f"{end}: mean velocity {mean:.6f} v, reference {reference:g} v, ripple {ripple:.1e} v, "
        f"aside {aside:.1e} v"
    )
    assert abs(mean - reference) < MEAN
    assert ripple < RIPPLE
