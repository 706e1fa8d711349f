"""A soft pendulum that falls and bends: one body with the terms of fast rotation.

    python examples/soft_pendulum.py [FOLDER]

runs examples/soft_pendulum.toml with the terms of second order and without them, and with four
bodies in the place of the beam, of either kind. The distance is that from four bodies with the
terms, of which each bends a sixteenth as far. Writes results and a picture to FOLDER, by default
out/.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/beam/soft.toml"
L, PARTS = 0.5, 4
"""length of the beam [m], and how many bodies it is divided into"""


@dataclass(frozen=True, eq=False)
class Fall:
    """time (n,) [s]; positions of the tip (n, 3) [m] with one body and with PARTS: of first order,
    and with the terms of second.
    """

    time: Array
    one_linear: Array
    linear: Array
    one: Array
    parts: Array

    def distance(self, tip: Array) -> Array:
        """From the tip of PARTS bodies with the terms of second order, over the length (n,)."""
        return np.linalg.norm(tip - self.parts, axis=1) / L


def main(folder: Path) -> Fall:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/soft_pendulum.toml")
    divided = in_parts(model)
    found = Fall(
        solver.simulate(model, output=folder / "soft-pendulum.h5").time,
        *(tip(each) for each in (linear(model), linear(divided), model, divided)),
    )
    with view.style():
        view.save(curves(found), folder / "soft-pendulum.png")
    distances = {name: found.distance(getattr(found, name)) for name in ("one", "linear")}
    assert distances["one"].max() < 2e-5
    assert mean_square(distances["one"]) < 0.02 * mean_square(distances["linear"])
    return found


def ensure_superelement() -> None:
    if not (target := BODY.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)


def linear(model: solver.Model) -> solver.Model:
    bodies = {name: replace(body, second_order="off") for name, body in model.bodies.items()}
    return replace(model, bodies=bodies)


def in_parts(model: solver.Model) -> solver.Model:
    """The beam in PARTS equal bodies, each fixed to the one before."""
    body = preprocess.read_body(BODY).model_copy(update={"scale": 1.0 / PARTS})
    part = solver.FlexibleBody(
        preprocess.build(body), solver.Start(position=[0.5 * L / PARTS, 0, 0])
    )
    bodies, joints = (
        {"part_1": part},
        [replace(model.joints[0], frame_a="ground", frame_b="part_1.root")],
    )
    for n in range(1, PARTS):
        before = f"part_{n}.tip"
        start = solver.Start(place=solver.Place("root", before))
        bodies[f"part_{n + 1}"] = replace(part, start=start)
        joints.append(solver.Fixed(before, f"part_{n + 1}.root", name=f"joint_{n}"))
    return replace(model, bodies=bodies, joints=tuple(joints))


def tip(model: solver.Model) -> Array:
    *_, last = model.bodies
    return solver.simulate(model).frame(f"{last}.tip").position


def mean_square(values: Array) -> float:
    return float((values**2).mean())


def curves(found: Fall) -> Figure:
    figure, (fall, apart) = view.panels(2)
    blue, red, green, *_ = view.COLORS
    for axis, color in ((0, blue), (1, green)):
        fall.plot(found.time, found.one[:, axis], color=color, label="xy"[axis])
    kinds = (
        (found.one_linear, red, "one linear body"),
        (found.linear, "0.5", f"{PARTS} linear bodies"),
        (found.one, blue, "one body with [rotation]"),
    )
    for position, color, label in kinds:
        apart.semilogy(found.time[1:], found.distance(position)[1:], color=color, label=label)
    fall.set(title="tip", ylabel="[m]")
    apart.set(
        title="distance over the length",
        xlabel="time [s]",
        ylim=(1e-9, 1e-2),
    )
    fall.legend(loc="lower left")
    apart.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=3)
    view.entitle(figure, "A soft pendulum that falls from the horizontal")
    return figure


def report(found: Fall) -> None:
    for name, label in (
        ("one_linear", "one linear body"),
        ("linear", f"{PARTS} linear bodies"),
        ("one", "one with [rotation]"),
    ):
        apart = found.distance(getattr(found, name))
        print(
            f"{label:28}largest {apart.max():.1e}, root mean square "
            f"{np.sqrt(mean_square(apart)):.1e} of the length apart from {PARTS} with [rotation]"
        )


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"results and picture: {target}")
