"""A bracket that is known from its hammer test alone, beside the mesh that was tested, struck.

    python examples/measured_bracket.py [FOLDER]

simulates the test of meshes/angle, makes the superelement of what was measured, and runs
examples/measured_bracket.toml. Both brackets are hinged at their feet and hit by a hammer: forces
and motions are compared. Writes results and a picture to FOLDER, by default out/.
"""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/angle/angle.toml"
TEST = BODY.with_name("test")
BENCH = ("--band", "20", "7000", "--lines", "2400", "--place", "5e-4", "--angle", "1")
"""of the test: its band, and what a careful bench has of errors"""
KINDS = "mesh", "tested"


@dataclass(frozen=True, eq=False)
class StruckBracket:
    """time (n,) [s]; force of the blow (n,) and bearing force (n, 3) [N]; tip (n, 3) [m]: elastic
    motion of the top.
    """

    time: Array
    blow: Array
    bearing: Array
    tip: Array


@dataclass(frozen=True)
class Differences:
    """Of the tested bracket from the mesh: of the peak and the impulse of the blow, relative; of
    the motion of the top and the bearing force in the plane of the bracket, root mean squares over
    those of the mesh; across: the largest bearing force across that plane over the largest in it.
    """

    peak: float
    impulse: float
    motion: float
    bearing: float
    across: float


def main(folder: Path) -> Differences:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelements()
    model = solver.read_model(ROOT / "examples/measured_bracket.toml")
    results = solver.simulate(model, output=folder / "measured-bracket.h5")
    brackets = [bracket(results, kind) for kind in KINDS]
    found = differences(*brackets)
    with view.style():
        view.save(curves(*brackets), folder / "measured-bracket.png")
    assert found.peak < 0.01
    assert found.impulse < 0.01
    assert found.motion < 0.08
    assert found.bearing < 0.15
    return found


def ensure_superelements() -> None:
    """The superelement of the mesh, and that of its test, which is made if there is none."""
    if not TEST.exists():
        command = [sys.executable, "-m", "duhamel", "measure", BODY, *BENCH, "-o", TEST]
        subprocess.run([*map(str, command), "--format", "npz"], check=True)
    for body in (BODY, TEST / "tested.toml"):
        if not (target := body.with_suffix(".h5")).exists():
            superelement.write(preprocess.build(preprocess.read_body(body)), target)


def bracket(results: solver.Results, kind: str) -> StruckBracket:
    owner = {"mesh": "the mesh", "tested": "the tested part"}[kind]
    return StruckBracket(
        time=results.time,
        blow=results.contact(f"blow on {owner}").force[:, 0],
        bearing=results.joint(f"hinge of {owner}").force,
        tip=results.frame(f"{kind}.top").u[:, :3],
    )


def differences(mesh: StruckBracket, tested: StruckBracket) -> Differences:
    def relative(found: Array, expected: Array) -> float:
        return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))

    def impulse(one: StruckBracket) -> float:
        return float(np.trapezoid(one.blow, one.time))

    plane = [0, 2]
    return Differences(
        peak=abs(float(tested.blow.max() / mesh.blow.max()) - 1.0),
        impulse=abs(impulse(tested) / impulse(mesh) - 1.0),
        motion=relative(tested.tip[:, plane], mesh.tip[:, plane]),
        bearing=relative(tested.bearing[:, plane], mesh.bearing[:, plane]),
        across=float(np.abs(tested.bearing[:, 1]).max() / np.abs(mesh.bearing).max()),
    )


def curves(mesh: StruckBracket, tested: StruckBracket) -> Figure:
    figure, (blow, motion, bearing) = view.panels(3, share_time=False)
    blue, red, *_ = view.COLORS
    time = 1e3 * mesh.time
    early = time < 2.0
    for one, color, style, label in (
        (mesh, blue, "-", "mesh"),
        (tested, red, (0, (4, 3)), "from its test"),
    ):
        blow.plot(time[early], one.blow[early], color=color, linestyle=style, label=label)
        motion.plot(time, 1e3 * one.tip[:, 0], color=color, linestyle=style)
        bearing.plot(time, one.bearing[:, 0], color=color, linestyle=style)
    blow.set(title="force of the blow", ylabel="[N]", xlabel="time [ms]")
    motion.set(title="elastic motion of the top along x", ylabel="[mm]")
    bearing.set(title="force of the bearing along x", ylabel="[N]", xlabel="time [ms]")
    blow.legend(loc="upper right")
    view.entitle(figure, "A bracket from its hammer test, and its mesh")
    return figure


def report(found: Differences) -> None:
    print(f"peak of the blow            within {100.0 * found.peak:.2g} %")
    print(f"impulse of the blow         within {100.0 * found.impulse:.2g} %")
    print(f"motion of the top           within {100.0 * found.motion:.2g} %")
    print(f"force of the bearing        within {100.0 * found.bearing:.2g} %")
    print(
        f"across the plane            {100.0 * found.across:.2g} % of that, where the mesh has none"
    )


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"results and picture: {target}")
