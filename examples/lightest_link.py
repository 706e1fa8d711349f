"""A link of least mass that bears a blow.

    python examples/lightest_link.py [FOLDER]

A steel link of two round bars, clamped at its root, is hit at its tip. The radii of the bars are
parameters: superelements are made anew for each. Its mass becomes least within a limit of the
bending stress at the root and where the bars meet. A search in all of the bounds is compared with
one from the start, which ends in another valley, and with the lightest link of one radius. Writes a
picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Literal

import duhamel as du
import numpy as np
from duhamel import view
from duhamel.study import Optimum
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
STEEL = du.Material(E=210e9, nu=0.3, rho=7850.0)
HALF = 0.25
"""length of each bar [m]"""
FORCE, DURATION = 800.0, 2e-3
"""of the blow, a half sine [N, s]"""
LIMIT = 200e6
"""of the bending stress [Pa]"""
STEP, T_END = 2e-5, 0.012
BOUNDS = 0.004, 0.03
"""of the radii [m]"""
START = 0.012
OUTPUTS = {"at_root": "max |root.moment|", "at_middle": "max |middle.moment|"}
INNER_STRESS = "4 * at_root / (pi * inner**3)"
OUTER_STRESS = "4 * at_middle / (pi * outer**3)"
MASS = f"{STEEL.rho} * pi * {HALF} * (inner**2 + outer**2)"


@dataclass(frozen=True, eq=False)
class Links:
    """Optima with two radii, in all of the bounds and from the start, and with one; and runs."""

    two: Optimum
    near: Optimum
    one: Optimum
    runs: dict[str, du.Run]

    @property
    def saved(self) -> float:
        """Mass, over that of the link of one radius."""
        return 1.0 - self.two.value / self.one.value


def main(folder: Path) -> Links:
    folder.mkdir(parents=True, exist_ok=True)
    link = bare_link()
    apart = {name: radius(change) for name, change in (("inner", inner), ("outer", outer))}
    stresses = {INNER_STRESS: (None, LIMIT), OUTER_STRESS: (None, LIMIT)}
    two = lightest(link, apart, MASS, stresses, "global")
    near = lightest(link, apart, MASS, stresses)
    both = {"radius": radius(uniform)}
    mass, stress = (text.replace("inner", "radius") for text in (MASS, INNER_STRESS))
    one = lightest(link, both, mass.replace("outer", "radius"), {stress: (None, LIMIT)})
    runs = {
        "start": link.with_values(apart, dict.fromkeys(apart, START)),
        "one radius": link.with_values(both, one.values),
        "two radii": link.with_values(apart, two.values),
    }
    found = Links(two, near, one, {name: mechanism.simulate() for name, mechanism in runs.items()})
    view.save(picture(found), folder / "lightest-link.png")
    for optimum in (two, near, one):
        assert optimum.converged
        assert any(constraint.is_active for constraint in optimum.constraints)
    assert two.value <= near.value <= one.value
    return found


def bare_link() -> du.Mechanism:
    """Without bars, which the parameters add."""
    link = du.Mechanism()
    link.settings = du.solver.Settings(t_end=T_END, step=STEP)
    return link


@lru_cache(maxsize=100)
def bar(r: float, name: str) -> du.Superelement:
    points = np.linspace([0.0, 0.0, 0.0], [HALF, 0.0, 0.0], 7)
    part = du.Beam(points, section=du.Section.circle(STEEL, r), name=name)
    part.interface("start", points[0])
    part.interface("end", points[-1])
    part.damping(modal=0.01)
    return part.superelement(step=STEP, duration=T_END)


def inner(link: du.Mechanism, r: float) -> None:
    """Clamp the first bar to the ground."""
    body = link.add(bar(r, "inner"), position=[0.5 * HALF, 0.0, 0.0])
    link.add(du.joints.Fixed(link.ground, body["start"], name="root"))


def outer(link: du.Mechanism, r: float) -> None:
    """Clamp the second bar to the first, and hit its end."""
    body = link.add(bar(r, "outer"), position=[1.5 * HALF, 0.0, 0.0])
    link.add(du.joints.Fixed(link["inner"]["end"], body["start"], name="middle"))
    blow = du.signals.HalfSine(FORCE, DURATION)
    link.add(du.loads.Force(body["end"], [0, 1, 0], blow))


def uniform(link: du.Mechanism, r: float) -> None:
    inner(link, r)
    outer(link, r)


def radius(change: object) -> du.Parameter:
    return du.Parameter(change, bounds=BOUNDS, start=START)


def lightest(
    link: du.Mechanism,
    parameters: dict[str, du.Parameter],
    mass: str,
    stresses: dict[str, tuple[None, float]],
    method: Literal["local", "global"] = "local",
) -> Optimum:
    return link.optimize(parameters, OUTPUTS, minimize=mass, constraints=stresses, method=method)


def picture(found: Links) -> Figure:
    figure, (root, middle) = view.panels(2)
    with view.style():
        for (name, run), color in zip(found.runs.items(), view.COLORS, strict=False):
            radii = {
                "start": (START, START),
                "one radius": (found.one.values["radius"],) * 2,
                "two radii": tuple(found.two.values.values()),
            }[name]
            for axes, joint, r in zip((root, middle), ("root", "middle"), radii, strict=True):
                moment = np.linalg.norm(run[joint].moment, axis=1)
                stress = 4.0 * moment / (np.pi * r**3)
                label = f"{name},\n{1e3 * r:.2f} mm"
                axes.plot(1e3 * run.time, 1e-6 * stress, color=color, label=label, linewidth=1.0)
        for axes, title in ((root, "at the root"), (middle, "where the bars meet")):
            axes.axhline(1e-6 * LIMIT, color="0.3", linestyle="--", linewidth=0.9)
            axes.set(title=f"bending stress {title}", ylabel="[MPa]")
            axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        middle.set_xlabel("time [ms]")
    view.entitle(figure, "A link of least mass that bears a blow")
    return figure


def report(found: Links) -> None:
    optima = {"one radius": found.one, "two, nearby": found.near, "two radii": found.two}
    for name, one in optima.items():
        radii = ", ".join(f"{key} {1e3 * value:.3f} mm" for key, value in one.values.items())
        print(f"{name:12}{one.value:.4f} kg ({one.start:.4f} kg at the start): {radii}")
        for constraint in one.constraints:
            stress, worth = 1e-6 * constraint.value, 1e6 * constraint.multiplier
            print(f"            {stress:.3f} MPa; 1 MPa more would save {1e3 * worth:.2f} g")
        print(f"            {one.state}; {one.runs} runs")
    print(f"two radii save {100.0 * found.saved:.1f} % of the mass")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"picture: {target}")
