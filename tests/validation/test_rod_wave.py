"""A wave in a free rod (d'Alembert): a constant force on one end, of a rod at rest, from t = 0 on.

The loaded end moves at v = F / (A sqrt(E rho)) until the wave has been to the far end and back, 2 L
/ c with c = sqrt(E / rho); the far end rests until L / c, then moves at 2 v.

Steel, L = 1 m, 200 elements, so that all 1200 elastic modes of the superelement take part. The step
is half the time that the wave needs for an element; rho_inf = 0.5 takes out the frequencies that
belong to the mesh. Tolerances: the front runs over a few elements, so the velocities are looked at
10 % of L / c before and after it, and may ripple by 3 %; their means are those of the closed form
to 1e-4.
"""

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

from .straight_beam import along, beam_superelement

pytestmark = pytest.mark.validation

E, rho, A, L, F = 2e11, 8000.0, 1e-4, 1.0, 1e3
ELEMENTS = 200
SECTION = {
    "EA": E * A,
    "EI_y": 1e-2 * E * A,
    "EI_z": 1e-2 * E * A,
    "GJ": 1e-2 * E * A,
    "mass_per_length": rho * A,
    "polar_inertia_per_length": 1e-2 * rho * A,
}
c = np.sqrt(E / rho)
v = F / (A * np.sqrt(E * rho))
RIPPLE, MEAN = 0.03, 1e-4


@pytest.fixture(scope="module")
def motion(tmp_path_factory):
    rod = beam_superelement(
        tmp_path_factory.mktemp("rod"), along(L, ELEMENTS), SECTION, {"near": 0, "far": ELEMENTS}
    )
    model = Model(
        bodies={"rod": FlexibleBody(rod)},
        loads=(Force("rod.near", [F, 0, 0], Constant(1.0)),),
        settings=Settings(t_end=2.0 * L / c, step=0.5 * L / (ELEMENTS * c), rho_inf=0.5),
    )
    results = simulate(model)
    print(f"{results.iterations.mean():.2f} iterations per step, {results.solver['seconds']:.2f} s")
    return results


@pytest.mark.parametrize(
    ("end", "begin", "until", "reference"),
    [("near", 0.1, 1.9, 1.0), ("far", 0.0, 0.9, 0.0), ("far", 1.1, 2.0, 2.0)],
    ids=["loaded end", "far end before the wave", "far end after it"],
)
def test_the_ends_move_as_dalembert_says(motion, end, begin, until, reference):
    arrived = motion.time * c / L
    speed = motion.frame(f"rod.{end}").velocity[(arrived > begin) & (arrived < until), 0] / v
    ripple, mean = np.abs(speed - reference).max(), speed.mean()
    print(
        f"{end} end: mean velocity {mean:.6f} v, reference {reference:g} v, ripple {ripple:.1e} v"
    )
    assert abs(mean - reference) < MEAN
    assert ripple < RIPPLE
