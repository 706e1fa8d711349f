"""A box that falls, tumbles and comes to rest.

    python examples/tumbling_box.py [FOLDER]

runs examples/tumbling_box.toml and checks that the box lies still on one face, carries its weight
on four corners, and has lost as much energy as it fell. Writes results and a picture to FOLDER, by
default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from duhamel import solver, view
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
CORNERS = [f"corner {n}" for n in range(1, 9)]
EDGES = [(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b).bit_count() == 1]
"""corners are numbered from 1 by the bits of their signs on x, y and z"""
FRICTION = 0.4
SLIPS = 2
"""state of a contact"""
SHOWN = (0.0, 0.07, 0.145, 0.22, 0.3, 0.39, 0.9)
"""times of the picture [s]"""


@dataclass(frozen=True)
class Rest:
    """The box at the end of the run.

    height of its center over the floor [m], speed [m/s], turning [rad/s]; load: sum of the normal
    forces over its weight, less 1; corners that carry it; blows: of all corners; still: when it
    last moved faster than 1 mm/s [s]; rubbing: of corners that slip, over mu N, less 1; balance:
    error of the energy over what it fell.
    """

    height: float
    speed: float
    turning: float
    load: float
    corners: int
    blows: int
    still: float
    rubbing: float
    balance: float


def main(folder: Path) -> Rest:
    folder.mkdir(parents=True, exist_ok=True)
    model = solver.read_model(ROOT / "examples/tumbling_box.toml")
    results = solver.simulate(model, output=folder / "tumbling-box.h5")
    found = rest(model, results)
    with view.style():
        view.save(picture(results), folder / "tumbling-box.png")
    assert max(found.speed, found.turning) < 1e-9
    assert abs(found.load) < 1e-6
    assert found.corners == 4
    assert found.rubbing < 1e-9
    assert found.balance < 1e-3
    return found


def rest(model: solver.Model, results: solver.Results) -> Rest:
    box = results.body("box")
    forces = np.array([results.contact(name).force[-1, 0] for name in CORNERS])
    weight = model.bodies["box"].mass * abs(model.gravity[2])
    fallen = weight * (box.x[0, 2] - box.x[-1, 2])
    speed = np.linalg.norm(box.v[:, :3], axis=1)
    contacts = [results.contact(name) for name in CORNERS]
    ratios = [
        np.linalg.norm(contact.force[contact.state == SLIPS, 1:], axis=1)
        / (FRICTION * contact.force[contact.state == SLIPS, 0])
        for contact in contacts
    ]
    return Rest(
        height=float(box.x[-1, 2]),
        speed=float(speed[-1]),
        turning=float(np.linalg.norm(box.v[-1, 3:])),
        load=float(forces.sum() / weight) - 1.0,
        corners=int((forces > 0.0).sum()),
        blows=sum(len(results.events[name]) for name in CORNERS),
        still=float(results.time[speed > 1e-3].max()),
        rubbing=float(np.abs(np.concatenate(ratios) - 1.0).max()),
        balance=float(np.abs(results.energy.balance).max() / fallen),
    )


def picture(results: solver.Results) -> Figure:
    figure, (side, speed, energy) = view.panels(3, share_time=False)
    blue, red, green, *_ = view.COLORS
    draw_boxes(side, results)
    box, time = results.body("box"), results.time
    speed.plot(time, np.linalg.norm(box.v[:, :3], axis=1), color=blue)
    energy.plot(time, results.energy.kinetic, color=blue, label="kinetic")
    energy.plot(time, results.energy.potential, color=green, label="potential")
    energy.plot(time, results.energy.dissipated, color=red, label="dissipated")
    side.set(title="from the side", xlabel="x [m]", ylabel="z [m]", aspect="equal")
    speed.set(title="speed of the center", ylabel="[m/s]", xlabel="time [s]")
    energy.set(title="energies", ylabel="[J]", xlabel="time [s]")
    energy.legend(loc="center right")
    view.entitle(figure, "A box that tumbles to rest")
    return figure


def draw_boxes(axes: Axes, results: solver.Results) -> None:
    """Edges of the box, seen along y, at some times; the last one darkest."""
    corners = np.array(
        [results.frame(f"box.{name.replace(' ', '_')}").position for name in CORNERS]
    )
    for n, time in enumerate(SHOWN):
        now = corners[:, np.searchsorted(results.time, time)]
        look = {"color": view.COLORS[n % len(view.COLORS)], "linewidth": 1.0}
        for a, b in EDGES:
            axes.plot(now[[a, b], 0], now[[a, b], 2], **look)
        axes.annotate(
            f"{time:g} s",
            (now[:, 0].mean(), now[:, 2].max()),
            (0, 3),
            textcoords="offset points",
            ha="center",
            fontsize=8,
            color=look["color"],
        )
    axes.axhline(0.0, color="0.2", linewidth=1.0)


def report(found: Rest) -> None:
    print(f"blows of all corners        {found.blows}, slower than 1 mm/s from {found.still:.3f} s")
    print(f"corners that slip           rub by mu N within {found.rubbing:.1e}")
    print(f"at the end                  {found.speed:.1e} m/s, {found.turning:.1e} rad/s")
    print(f"carried by                  {found.corners} corners, weight within {found.load:.1e}")
    print(f"energy                      balance within {found.balance:.1e} of what it fell")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"results and picture: {target}")
