"""Cases 1 and 2 of the paper: a beam on a hub, turned by a torque and brought back to rest.

    python examples/rotating_beam.py [FOLDER]

runs both cases with the consistent rule of convolution, with the rule of the paper (eq. 55) and
with a rigid beam, checks the numbers at the top of this file, and writes results and pictures like
the paper's Figs 3, 5 to 7, 9 and 10 to FOLDER, by default out/. Where Exudyn is installed, a
geometrically exact model is drawn beside.
"""

import sys
from dataclasses import dataclass, replace
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import numpy as np
from duhamel import preprocess, solver, superelement, view
from duhamel.results import quantities
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/beam/beam.toml"
I_T = 4.75475e-3
"""inertia of the beam about the axis of the hub [kg m^2]"""

TORQUE_TIMES, TORQUE_VALUES = (0.0, 0.05, 0.15, 0.2), (1.0, 0.0, -1.0, 0.0)
"""the torque of the model files, over C_0"""

BLUE, RED, GREEN, *_ = view.COLORS


@dataclass(frozen=True)
class Case:
    """phi, C_0 [N m]; peaks of hub speed [rad/s] and tip deflection [m] by Exudyn, and how near
    ours must come to them.

    `residual`: bounds of the tip deflection after the torque, over its peak.
    """

    name: str
    phi: float
    C0: float
    peak_speed: float
    peak_deflection: float
    tolerance: float
    residual: tuple[float, float]


CASES = (
    Case("case1", 4.0, 2.0, 4.21397, 8.6127e-3, tolerance=7e-4, residual=(0.0, 0.05)),
    Case("case2", 0.5, 1.0, 9.52197, 2.81448e-2, tolerance=3e-3, residual=(0.9, 1.0)),
)


@dataclass(frozen=True, eq=False)
class Motion:
    """time (n,) [s], angle [rad] and speed [rad/s] of the hub, deflection of the tip in the hub
    frame [m], all (n,).
    """

    time: Array
    angle: Array
    speed: Array
    deflection: Array


def main(folder: Path, with_reference: bool = True) -> dict[str, Motion]:
    """Run, check and draw both cases; the motions by case and kind, as "case1-paper"."""
    ensure_superelement()
    folder.mkdir(parents=True, exist_ok=True)
    motions = {}
    for case in CASES:
        elastic, paper, rigid = (
            run(model, folder / name) for name, model in variants(case).items()
        )
        reference = exudyn_motion(case) if with_reference else None
        check(case, motion(elastic), motion(rigid))
        with view.style():
            view.save(overview(case, elastic), folder / f"{case.name}.png")
            view.save(
                comparison(case, motion(elastic), motion(paper), reference),
                folder / f"{case.name}-rules.png",
            )
            view.save(
                with_rigid(case, motion(elastic), motion(rigid)), folder / f"{case.name}-rigid.png"
            )
        found = {"consistent": elastic, "paper": paper, "rigid": rigid}
        motions |= {f"{case.name}-{kind}": motion(results) for kind, results in found.items()}
        if reference is not None:
            motions[f"{case.name}-exudyn"] = reference
    return motions


def ensure_superelement() -> None:
    """Make the superelement of the beam if it is not there."""
    if not (target := BODY.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)


def variants(case: Case) -> dict[str, solver.Model]:
    """The model of a case, with the rule of the paper, and with a rigid beam, by the names of their
    results files.
    """
    model = solver.read_model(ROOT / f"examples/{case.name}.toml")
    beam = model.bodies["beam"]
    kernel = beam.superelement.kernel
    rigid_beam = solver.RigidBody(beam.mass, beam.inertia, beam.frames, beam.start)
    rigid = replace(model, bodies={**model.bodies, "beam": rigid_beam}).with_settings(
        step=kernel.h, rho_inf=kernel.scheme.rho_inf
    )
    return {
        f"{case.name}.h5": model,
        f"{case.name}-paper-rule.h5": model.with_settings(rule="paper"),
        f"{case.name}-rigid.h5": rigid,
    }


def run(model: solver.Model, target: Path) -> solver.Results:
    solver.simulate(model, output=target)
    return solver.Results.read(target)


def motion(results: solver.Results) -> Motion:
    """About and across the axis z. The deflection is eq. (96) put right: the tip seen from the rim
    of the hub.
    """
    return Motion(
        results.time,
        quantities.angle(results, "hub")[:, 2],
        quantities.angular_velocity(results, "hub")[:, 2],
        quantities.displacement(results, "beam.tip", seen_from="hub.rim")[:, 1],
    )


def exudyn_motion(case: Case) -> Motion | None:
    """The same problem by the model of tests/validation/exudyn_beam.py, None where Exudyn is not
    installed.
    """
    if find_spec("exudyn") is None:
        return None
    spec = spec_from_file_location("exudyn_beam", ROOT / "tests/validation/exudyn_beam.py")
    module: Any = module_from_spec(spec)
    spec.loader.exec_module(module)
    beam = module.rotating_beam(
        case.phi, case.C0, TORQUE_TIMES, TORQUE_VALUES, t_end=0.3, step=2e-5
    )
    return Motion(beam.time, beam.hub_angle, beam.hub_speed, beam.tip[:, 1])


def check(case: Case, elastic: Motion, rigid: Motion) -> None:
    assert abs(np.abs(elastic.speed).max() / case.peak_speed - 1.0) < case.tolerance
    assert abs(np.abs(elastic.deflection).max() / case.peak_deflection - 1.0) < case.tolerance
    low, high = case.residual
    assert low <= residual(elastic) <= high
    # The first pulse leaves the rigid system with this speed; it coasts for 0.1 s, and each pulse
    # counts for half.
    speed = case.C0 * 0.05 / ((1.0 + case.phi) * I_T)
    assert abs(np.interp(0.1, rigid.time, rigid.speed) / speed - 1.0) < 1e-7
    assert abs(rigid.angle[-1] / (0.15 * speed) - 1.0) < 1e-6


def residual(motion: Motion) -> float:
    """The tip deflection after the torque, over its peak."""
    size = np.abs(motion.deflection)
    return float(size[motion.time > TORQUE_TIMES[-1]].max() / size.max())


def overview(case: Case, results: solver.Results) -> Figure:
    """Six panels as in Figs 3 and 7. What the fourth showed, the text of the paper does not say."""
    figure, (angles, speeds, accelerations, body_axes, hub_axes, phase) = view.panels(
        3, 2, share_time=False
    )
    time = results.time
    for axes, kind in (
        (angles, "angle"),
        (speeds, "angular_velocity"),
        (accelerations, "angular_acceleration"),
    ):
        for body, color, label in (("hub", RED, "hub"), ("beam", BLUE, "beam")):
            (curve,) = view.curves(results, f"{kind}:{body}:z")
            axes.plot(time, curve.values, color=color, label=label)
        label_axes(axes, curve.words[0], f"[{curve.unit}]")
    angles.plot(
        time,
        quantities.elastic_rotation(results, "beam.root")[:, 2],
        color=GREEN,
        label="elastic, at the hub",
    )
    label_axes(angles, "angle", "[rad]")

    for interface, color in (("root", RED), ("tip", BLUE)):
        transverse = quantities.elastic_displacement(results, f"beam.{interface}")[:, 1]
        body_axes.plot(time, 1e3 * transverse, color=color, label=interface)
    label_axes(body_axes, "elastic displacement y, body axes", "[mm]")

    tip = 1e3 * quantities.displacement(results, "beam.tip", seen_from="hub.rim")
    hub_axes.plot(time, tip[:, 0], color=GREEN, label="x")
    hub_axes.plot(time, tip[:, 1], color=BLUE, label="y")
    label_axes(hub_axes, "displacement of the tip, hub axes", "[mm]")

    phase.plot(tip[:, 1], 1e-3 * np.gradient(tip[:, 1], time), color=BLUE, linewidth=0.8)
    label_axes(phase, "phase diagram of the tip, y in hub axes", "rate [m/s]", "displacement [mm]")
    view.entitle(figure, titled(case))
    return figure


def comparison(case: Case, consistent: Motion, paper: Motion, reference: Motion | None) -> Figure:
    """Hub speed and tip deflection as in Figs 5 and 9, by both rules, and their distance from the
    exact solution.
    """
    figure, (speed, deflection, *distance) = view.panels(2 if reference is None else 3)
    found = [(paper, RED, "-", "rule of the paper"), (consistent, BLUE, "-", "consistent rule")]
    if reference is not None:
        found.append((reference, "black", (0, (1, 3)), "geometrically exact"))
    for motion, color, line, label in found:
        look = {"color": color, "linestyle": line, "label": label}
        speed.plot(motion.time, motion.speed, **look)
        deflection.plot(motion.time, 1e3 * motion.deflection, **look)
        for axes in distance if motion is not reference else ():
            exact = np.interp(motion.time, reference.time, reference.deflection)
            axes.plot(motion.time, 1e3 * (motion.deflection - exact), **look)
            label_axes(axes, "deflection less the exact one", "[mm]")
    label_axes(speed, "angular velocity of the hub", "[rad/s]", "")
    label_axes(deflection, "deflection of the tip", "[mm]", "" if distance else "time [s]")
    view.entitle(figure, titled(case))
    return figure


def with_rigid(case: Case, elastic: Motion, rigid: Motion) -> Figure:
    """Hub speed with an elastic and with a rigid beam, as in Figs 6 and 10."""
    figure, (speed,) = view.panels(1)
    speed.plot(rigid.time, rigid.speed, color=RED, label="rigid beam")
    speed.plot(elastic.time, elastic.speed, color=BLUE, label="elastic beam")
    label_axes(speed, "angular velocity of the hub", "[rad/s]")
    view.entitle(figure, titled(case))
    return figure


def label_axes(axes: Axes, title: str, ylabel: str, xlabel: str = "time [s]") -> None:
    axes.set(title=title, xlabel=xlabel, ylabel=ylabel)
    if len(axes.lines) > 1:
        axes.legend(
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            borderaxespad=0.2,
            ncols=3,
            handlelength=1.4,
        )


def titled(case: Case) -> str:
    return f"Case {case.name[-1]}: φ = {case.phi:g}, C₀ = {case.C0:g} N m"


def report(motions: dict[str, Motion]) -> None:
    print(
        f"{'':18}{'peak speed':>12}{'peak deflection, residual':>28}"
        f"{'largest distance from Exudyn':>32}"
    )
    print(f"{'':18}{'[rad/s]':>12}{'[mm]':>16}{'[1]':>12}{'speed':>18}{'deflection':>14}")
    for name, found in motions.items():
        print(f"{name:18}{np.abs(found.speed).max():12.5f}", end="")
        if not name.endswith("rigid"):
            print(f"{1e3 * np.abs(found.deflection).max():16.5f}{residual(found):12.4f}", end="")
            print(distances(found, motions.get(f"{name.partition('-')[0]}-exudyn")), end="")
        print()


def distances(found: Motion, reference: Motion | None) -> str:
    """Over time, relative to the peaks of the reference."""
    if reference is None or found is reference:
        return ""
    pairs = ((found.speed, reference.speed), (found.deflection, reference.deflection))
    ours = [(np.interp(reference.time, found.time, mine), theirs) for mine, theirs in pairs]
    speed, deflection = (
        np.abs(mine - theirs).max() / np.abs(theirs).max() for mine, theirs in ours
    )
    return f"{speed:18.1e}{deflection:14.1e}"


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"results and pictures: {target}")
