"""Cost of a step of bodies with [rotation]: beside geometrically exact beams of Exudyn in the
spin-up of Simo and Vu-Quoc, and beside the same body without it in the paper's Case 1.

One body with [rotation] stands against as many beams as come equally near to the largest lag of
the tip, and against twice as many. CPU time on one thread, medians over repeats in which all take
turns, as in `beside_exudyn.py`. Needs the extra `validation`. Run as
`python benchmarks/fast_rotation.py [--repeats N]`.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import argparse
import tempfile
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from beside_exudyn import ROOT, Entrant, case_1_model, heading, our_run, ours, race, theirs
from duhamel.preprocess import build, read_body
from duhamel.preprocess.body.body import NonlinearCoordinates
from duhamel.solver import Model
from duhamel.superelement import Superelement
from peer import spin_up
from peer.run import Run

from tests.validation.test_spin_up import FROM_ROOT, SPIN_UP, chain

STEP, T_END = 1e-2, 20.0
BEAMS = (16, 32)
COORDINATES = {"modes": 4, "soft": 4}
"""12 coordinates q: four modes, and two of each of four soft shapes"""


def lag(run: Run) -> float:
    """The largest deflection of the tip, across the driven section [m]."""
    psi = np.array([SPIN_UP(t) for t in run.time])
    return float((np.cos(psi) * run.tip[:, 1] - np.sin(psi) * run.tip[:, 0]).min())


def spin_up_beside_exudyn(folder: Path, repeats: int) -> None:
    one = chain(folder, 1, STEP, rotation=FROM_ROOT)
    entrants = [ours(one, "b0.tip")]
    for n in BEAMS:
        exact = partial(spin_up.exact_beams, n, STEP, T_END)
        entrants += theirs({f"{n} geometrically exact beams": exact})
    race("spin-up", entrants, repeats)
    for entrant in entrants:
        print(f"{entrant.name}: largest lag {lag(entrant.run()):.4f} m")


def with_and_without(repeats: int) -> None:
    """Case 1, its beam with 12 coordinates and with none."""
    model = case_1_model()
    body = read_body(ROOT / "meshes/beam/beam.toml")
    rotation = NonlinearCoordinates.model_validate(COORDINATES)
    bodies = {"without": body, "with [rotation]": body.model_copy(update={"rotation": rotation})}
    entrants = []
    for name, body in bodies.items():
        run = partial(our_run, with_beam(model, build(body)), "beam.tip", model.settings.tolerance)
        entrants.append(Entrant(name, run, model.settings.tolerance, 0.0))
    race("Case 1", entrants, max(repeats, 7))


def with_beam(model: Model, element: Superelement) -> Model:
    beam = replace(model.bodies["beam"], superelement=element, source="")
    return replace(model, bodies={**model.bodies, "beam": beam})


def main() -> None:
    parser = argparse.ArgumentParser(description="The cost of a step of fast rotation.")
    parser.add_argument("--repeats", type=int, default=3, help="of every measurement")
    chosen = parser.parse_args()
    heading("")
    with_and_without(chosen.repeats)
    with tempfile.TemporaryDirectory() as folder:
        spin_up_beside_exudyn(Path(folder), chosen.repeats)


if __name__ == "__main__":
    main()
