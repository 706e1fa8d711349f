"""Cases 3 to 5 of the paper: a beam on a hub that slides and turns, with gravity, a tip mass and a
blow at the tip.

    python examples/helicoidal_beam.py [FOLDER]

runs every case with both readings of the bending stiffness out of the plane, with the consistent
rule of convolution and with that of the paper (eq. 55), Case 4 with a hub without weight, and Case
5 with the tip mass in the superelement, with the terms of fast rotation, and with the blow as
printed. Checks balances and what
docs/paper.md says, and writes results and pictures like the paper's Figs 12 to 23 to FOLDER, by
default out/.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from duhamel.preprocess.body.body import NonlinearCoordinates, PointMass
from duhamel.results import quantities
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

Array = NDArray[np.float64]
LineStyle = str | tuple[int, tuple[int, int]]

ROOT = Path(__file__).parent.parent
CASES = ("case3", "case4", "case5")
STIFFNESS = {"beam": 5.5, "flat": 0.55}
"""EI_y of the superelements, for bending out of the plane of rotation [N m^2]"""

BOTH_WAYS = {"beam": 0.01, "flat": 0.05}
"""how far the tips may be apart with the tip mass on a joint and in the superelement, over L:
neglected terms
"""

WITH_ROTATION = 1e-5
"""the same until the blow, with the terms of fast rotation and 5.5 N m^2"""

L, G, PRINTED_IMPULSE = 0.5, 9.81, 0.2
TITLES = {
    "case3": "Case 3: helicoidal motion",
    "case4": "Case 4: helicoidal motion under gravity",
    "case5": "Case 5: tip mass, hit at 0.2 s",
}
BLUE, RED, GREEN, *_ = view.COLORS
GREY = "0.6"
BLOW = 0.2
"""when the tip is hit in Case 5 [s]"""


@dataclass(frozen=True, eq=False)
class Run:
    """A model and its motion. `deflection` (n, 3): the tip in the axes of the hub, eq. (96) put
    right [m].
    """

    model: solver.Model
    results: solver.Results

    @property
    def time(self) -> Array:
        return self.results.time

    @property
    def deflection(self) -> Array:
        return quantities.displacement(self.results, "beam.tip", seen_from="hub.rim")

    @property
    def turns(self) -> float:
        return float(self.results.joint("axis").coordinates["angle"][-1] / (2.0 * np.pi))

    @property
    def height(self) -> Array:
        """Of the center of mass of the beam (n,) [m]."""
        return quantities.position(self.results, "beam")[:, 2]


def main(folder: Path) -> dict[str, Run]:
    """Run, check and draw; the runs by case, body and variant, as "case5-flat-lumped"."""
    for name in STIFFNESS:
        ensure_superelement(name)
    folder.mkdir(parents=True, exist_ok=True)
    models = {name: model for case in CASES for name, model in variants(case)}
    runs = {name: run(model, folder / f"{name}.h5") for name, model in models.items()}
    check(runs)
    with view.style():
        for case in CASES:
            view.save(overview(case, runs[f"{case}-beam"].results), folder / f"{case}.png")
            view.save(tip(case, runs), folder / f"{case}-tip.png")
            view.save(
                trajectory(case, runs[f"{case}-beam"].results), folder / f"{case}-trajectory.png"
            )
        view.save(after_the_blow(runs), folder / "case5-both-ways.png")
        view.save(with_rotation(runs), folder / "case5-rotation.png")
    return runs


def ensure_superelement(name: str) -> None:
    """Make the superelement of a beam if it is not there."""
    body = ROOT / f"meshes/beam/{name}.toml"
    if not (target := body.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(body)), target)


def variants(case: str) -> Iterator[tuple[str, solver.Model]]:
    printed = solver.read_model(ROOT / f"examples/{case}.toml")
    for name in STIFFNESS:
        element = superelement.read(ROOT / f"meshes/beam/{name}.h5")
        model = with_beam(printed, element)
        yield f"{case}-{name}", model
        yield f"{case}-{name}-paper", model.with_settings(rule="paper")
        if case == "case5":
            yield f"{case}-{name}-lumped", with_lumped_tip(model, body_file(name))
            yield f"{case}-{name}-printed", with_impulse(model, PRINTED_IMPULSE)
    if case == "case5":
        body = body_file("beam").model_copy(update={"rotation": NonlinearCoordinates()})
        yield f"{case}-beam-rotation", with_beam(printed, preprocess.build(body))
        yield f"{case}-beam-rotation-lumped", with_lumped_tip(printed, body)
    if case == "case4":
        weight = printed.bodies["hub"].mass * G
        lift = solver.Force("hub", [0, 0, weight], solver.Constant(1.0))
        yield f"{case}-beam-weightless", replace(printed, loads=(*printed.loads, lift))


def with_beam(model: solver.Model, element: superelement.Superelement) -> solver.Model:
    beam = replace(model.bodies["beam"], superelement=element)
    return replace(model, bodies={**model.bodies, "beam": beam})


def body_file(name: str) -> preprocess.Body:
    return preprocess.read_body(ROOT / f"meshes/beam/{name}.toml")


def with_lumped_tip(model: solver.Model, beam: preprocess.Body) -> solver.Model:
    """The ball in the mass matrix of the beam instead of on a joint."""
    ball = model.bodies["ball"]
    mass = PointMass(mass=ball.mass, inertia=ball.inertia.tolist(), interface="tip")
    body = beam.model_copy(update={"masses": {"tip": mass}})
    without = replace(
        model,
        bodies={key: value for key, value in model.bodies.items() if key != "ball"},
        joints=tuple(joint for joint in model.joints if joint.name != "weld"),
        loads=tuple(
            replace(load, on="beam.tip") if load.on == "ball.center" else load
            for load in model.loads
        ),
    )
    return with_beam(without, preprocess.build(body))


def with_impulse(model: solver.Model, area: float) -> solver.Model:
    *pulses, blow = model.loads
    return replace(
        model, loads=(*pulses, replace(blow, signal=solver.Impulse(area, blow.signal.at)))
    )


def run(model: solver.Model, target: Path) -> Run:
    return Run(model, solver.simulate(model, output=target))


def check(runs: dict[str, Run]) -> None:
    for found in runs.values():
        check_momentum(found)
    for name in STIFFNESS:
        # A rigid beam would make C_0 t_1 (T - t_1 / 2) / (I_R + I_T) / 2 pi turns: 1.957 and 3.814.
        assert abs(runs[f"case3-{name}"].turns / 1.957 - 1.0) < 0.01
        assert abs(runs[f"case4-{name}"].turns / 3.814 - 1.0) < 0.005
        both = [runs[f"case5-{name}{kind}"] for kind in ("", "-lumped")]
        assert apart(*both) < BOTH_WAYS[name]
        assert abs(both[0].turns / both[1].turns - 1.0) < 1e-3
    rotation = [runs[f"case5-beam-rotation{kind}"] for kind in ("", "-lumped")]
    assert apart(*rotation, BLOW) < WITH_ROTATION
    assert apart(*rotation) < 0.3 * apart(runs["case5-beam"], runs["case5-beam-lumped"])
    # The paper: the tip rises by some 20 % of the length in Cases 3 and 4. That takes the softer
    # beam.
    for case in ("case3", "case4"):
        assert peak(runs[f"{case}-beam"].deflection[:, 2]) < 0.03 * L
        assert 0.16 * L < peak(runs[f"{case}-flat"].deflection[:, 2]) < 0.22 * L
    # The paper: 1.2 m in Case 4, which takes a hub without weight.
    assert abs(runs["case4-beam"].height.max() - 0.902) < 0.005
    assert abs(runs["case4-beam-weightless"].height.max() - 1.168) < 0.005


def check_momentum(found: Run) -> None:
    """Upwards, what the loads brought less what gravity took; about the axis, what the torque
    brought until 0.2 s.
    """
    impulse = sum(
        load.direction[2] * area(load.signal) for load in found.model.loads if load.type == "force"
    )
    mass = sum(body.mass for body in found.model.bodies.values())
    momentum = found.results.momentum
    expected = impulse + mass * found.model.gravity[2] * found.model.settings.t_end
    assert abs(momentum.linear[-1, 2] - expected) < 1e-10
    (torque,) = [load for load in found.model.loads if load.type == "torque"]
    before = int(np.searchsorted(found.time, 0.199))
    assert abs(momentum.angular[before, 2] / area(torque.signal) - 1.0) < 1e-4


def area(signal: solver.Pulse | solver.Impulse | solver.Constant) -> float:
    """The integral of a signal from 0 to 1 s."""
    match signal:
        case solver.Pulse():
            return signal.value * (signal.end - signal.start)
        case solver.Impulse():
            return signal.area
        case _:
            return signal.value


def apart(one: Run, other: Run, until: float = np.inf) -> float:
    """The largest distance of the tips until a time, over the length of the beam."""
    shown = one.time < until
    paths = [quantities.position(found.results, "beam.tip")[shown] for found in (one, other)]
    return float(np.linalg.norm(paths[0] - paths[1], axis=1).max()) / L


def peak(values: Array) -> float:
    return float(np.abs(values).max())


def swings(found: Run, start: float, end: float) -> Iterator[tuple[Array, Array]]:
    """Turning [rad/s] and rising [m/s] of hub and beam from start to end (n,), the latter without
    what gravity adds.
    """
    shown = (found.time > start) & (found.time < end - 1e-9)
    fall = found.model.gravity[2] * found.time
    for body in ("hub", "beam"):
        velocity = quantities.velocity(found.results, body)[:, 2] - fall
        yield quantities.angular_velocity(found.results, body)[shown, 2], velocity[shown]


def out_of_phase(found: Run) -> float:
    """The largest angle about the axis between tip and center of mass [rad]."""
    tip, center = (
        quantities.position(found.results, place)[:, :2] @ [1.0, 1.0j]
        for place in ("beam.tip", "beam")
    )
    return peak(np.angle(tip * center.conj()))


def fast(deflection: Array, h: float) -> Array:
    """The part of a deflection (n,) above 70 Hz, without the first two modes of the system."""
    filtered: Array = sosfiltfilt(butter(4, 70.0, "highpass", fs=1.0 / h, output="sos"), deflection)
    return filtered


def overview(case: str, results: solver.Results) -> Figure:
    """Angles, heights, horizontal motion and their rates, as Figs 12, 13, 16, 17, 20 and 21."""
    figure, panels = view.panels(5, 2, share_time=False)
    kinds = (
        "angle",
        "angular_velocity",
        "position",
        "velocity",
        "angular_acceleration",
        "acceleration",
    )
    places = (panels[0], panels[1], panels[2], panels[3], panels[8], panels[9])
    for kind, axes in zip(kinds, places, strict=True):
        # Angles and heights of hub and beam all but coincide: there the upper curve is dashed.
        over = (0, (4, 4)) if kind in ("angle", "position") else "-"
        for body, color, line in (("hub", RED, "-"), ("beam", BLUE, over)):
            (curve,) = view.curves(results, f"{kind}:{body}:z")
            axes.plot(
                results.time,
                curve.values,
                color=color,
                linestyle=line,
                label=body,
                linewidth=0.9,
            )
        if kind.endswith("acceleration"):
            show_the_blow(case, axes)
        label_axes(axes, f"{curve.words[0]}, z", f"[{curve.unit}]")
    panels[0].plot(
        results.time,
        quantities.elastic_rotation(results, "beam.root")[:, 2],
        color=GREEN,
        label="elastic, root",
    )
    label_axes(panels[0], "angle, z", "[rad]")
    for axis, name in enumerate("xy"):
        for place, color in (("beam", BLUE), ("beam.tip", GREEN)):
            label = "tip" if "." in place else "beam"
            panels[4 + axis].plot(
                results.time,
                quantities.position(results, place)[:, axis],
                color=color,
                label=label,
            )
        label_axes(panels[4 + axis], f"position, {name}", "[m]")
        panels[6 + axis].plot(
            results.time, quantities.velocity(results, "beam")[:, axis], color=BLUE
        )
        label_axes(panels[6 + axis], f"velocity of the beam, {name}", "[m/s]")
    view.entitle(figure, TITLES[case])
    return figure


def tip(case: str, runs: dict[str, Run]) -> Figure:
    """The tip in the axes of the hub, as Figs 14, 18 and 22, and in the floating frame, by both
    stiffnesses.
    """
    figure, panels = view.panels(3, 2, share_time=False)
    for column, (name, stiffness) in enumerate(STIFFNESS.items()):
        found = runs[f"{case}-{name}"]
        seen, floating, turned = panels[column], panels[2 + column], panels[4 + column]
        for axis, color in enumerate((GREY, BLUE, RED)):
            look = {"color": color, "label": "xyz"[axis], "linewidth": 0.9}
            seen.plot(found.time, 1e3 * found.deflection[:, axis], **look)
            floating.plot(
                found.time,
                1e3 * quantities.elastic_displacement(found.results, "beam.tip")[:, axis],
                **look,
            )
            turned.plot(
                found.time, quantities.elastic_rotation(found.results, "beam.root")[:, axis], **look
            )
        show_the_blow(case, floating, turned)
        label_axes(seen, f"tip in hub axes, $EI_y$ = {stiffness} N m²", "[mm]")
        label_axes(floating, "tip in the floating frame", "[mm]")
        label_axes(turned, "rotation at the hub", "[rad]")
    view.entitle(figure, TITLES[case])
    return figure


def trajectory(case: str, results: solver.Results) -> Figure:
    """Of center of mass and tip, as Figs 15, 19 and 23; a ring at the start, and a star at the
    blow.
    """
    figure = Figure(figsize=(6.0, 5.0), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    for place, color, label in (("beam", BLUE, "center of mass"), ("beam.tip", GREEN, "tip")):
        path = quantities.position(results, place)
        axes.plot(*path.T, color=color, label=label, linewidth=0.9)
        axes.plot(*path[0], marker="o", markerfacecolor="white", color=color)
        if case == "case5":
            axes.plot(
                *path[np.searchsorted(results.time, BLOW - 1e-9)],
                marker="*",
                markersize=9,
                color=color,
            )
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", box_aspect=(1, 1, 1.2))
    axes.legend(loc="upper left")
    view.entitle(figure, TITLES[case])
    return figure


def show_the_blow(case: str, *panels: Axes) -> None:
    """Of Case 5 only the time around the blow: over the whole of it, vibrations are a
    solid band.
    """
    if case == "case5":
        for axes in panels:
            axes.set_xlim(BLOW - 0.02, BLOW + 0.1)


def after_the_blow(runs: dict[str, Run]) -> Figure:
    """The lateral deflections of Case 5 with the tip mass both ways, and by the rule of
    the paper.
    """
    return around_the_blow(
        (runs["case5-beam-paper"], RED, "-", "rule of the paper"),
        (runs["case5-beam"], BLUE, "-", "mass on a joint"),
        (runs["case5-beam-lumped"], "black", (0, (1, 2)), "mass in the superelement"),
    )


def with_rotation(runs: dict[str, Run]) -> Figure:
    """The same with the terms of fast rotation, and without them."""
    return around_the_blow(
        (runs["case5-beam"], RED, "-", "linear"),
        (runs["case5-beam-rotation"], BLUE, "-", "with [rotation]"),
        (runs["case5-beam-rotation-lumped"], "black", (0, (1, 2)), "mass in the superelement"),
    )


def around_the_blow(*kinds: tuple[Run, str, LineStyle, str]) -> Figure:
    figure, panels = view.panels(2)
    for found, color, line, label in kinds:
        shown = (found.time > 0.18) & (found.time < 0.4)
        for axis, axes in zip((1, 2), panels, strict=True):
            axes.plot(
                found.time[shown],
                1e3 * found.deflection[shown, axis],
                color=color,
                linestyle=line,
                label=label,
            )
            label_axes(
                axes, f"tip in hub axes, {'xyz'[axis]}", "[mm]", "time [s]" if axis == 2 else ""
            )
    view.entitle(figure, TITLES["case5"])
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


def report(runs: dict[str, Run]) -> None:
    print(
        f"{'':24}{'turns':>8}{'height [m]':>20}{'tip, hub axes [mm]':>24}{'floating [mm]':>18}",
        end="",
    )
    print(f"{'root turns [rad]':>18}{'acceleration [rad/s²], [m/s²]':>34}")
    print(
        f"{'':24}{'':8}{'largest':>10}{'at 1 s':>10}"
        f"{'x':>8}{'y':>8}{'z':>8}{'y':>9}{'z':>9}{'y':>9}{'z':>9}"
    )
    for name, found in runs.items():
        results = found.results
        floating = quantities.elastic_displacement(results, "beam.tip")
        turned = quantities.elastic_rotation(results, "beam.root")
        print(
            f"{name:24}{found.turns:8.3f}{found.height.max():10.3f}{found.height[-1]:10.3f}", end=""
        )
        print("".join(f"{1e3 * peak(found.deflection[:, axis]):8.2f}" for axis in range(3)), end="")
        print("".join(f"{1e3 * peak(floating[:, axis]):9.2f}" for axis in (1, 2)), end="")
        print("".join(f"{peak(turned[:, axis]):9.3f}" for axis in (1, 2)), end="")
        for body in ("hub", "beam"):
            angular, linear = (
                quantities.angular_acceleration(results, body),
                quantities.acceleration(results, body),
            )
            print(f"{peak(angular[:, 2]):11.0f}{peak(linear[:, 2]):7.0f}", end="")
        print()
    report_speeds(runs)
    for name in (*STIFFNESS, "beam-rotation"):
        both = [runs[f"case5-{name}{kind}"] for kind in ("", "-lumped")]
        size = [peak(both[0].deflection[:, axis]) for axis in (1, 2)]
        deflection = [
            peak(both[0].deflection[:, axis] - both[1].deflection[:, axis]) for axis in (1, 2)
        ]
        relative = [d / s for d, s in zip(deflection, size, strict=True)]
        print(
            f"case5-{name}, the tip mass both ways: tips {apart(*both, BLOW):.1e} of the length "
            f"apart until the blow, {apart(*both):.1e} until the end, ",
            end="",
        )
        print(f"deflections y and z {relative[0]:.1e}, {relative[1]:.1e} of their peaks")


def report_speeds(runs: dict[str, Run]) -> None:
    """After the pulses, and of Case 5 also after the blow; what the blow leaves above 70 Hz."""
    print(
        "speeds: turning [rad/s], from and to; rising [m/s] without what gravity adds; tip and "
        "center out of phase"
    )
    for name, found in runs.items():
        if name.endswith("weightless"):  # gravity adds less to it
            continue
        pulse = max(
            load.signal.end for load in found.model.loads if isinstance(load.signal, solver.Pulse)
        )
        instants = (
            [pulse, BLOW, found.model.settings.t_end]
            if name.startswith("case5")
            else [pulse, found.model.settings.t_end]
        )
        for start, end in pairwise(instants):
            print(f"{name:24}{start:5.2f} to {end:.2f} s", end="")
            for body, (turning, rising) in zip(
                ("hub", "beam"), swings(found, start, end), strict=True
            ):
                print(f"   {body} {turning.min():7.2f}{turning.max():7.2f}", end="")
                print(f"{rising.mean():7.2f} ± {np.ptp(rising) / 2:.2f}", end="")
            print(f"{out_of_phase(found):10.3f} rad")
        if len(instants) > 2:
            y = fast(found.deflection[:, 1], found.model.settings.step)
            after = [
                peak(y[(found.time > t) & (found.time <= t + 0.05)]) for t in (0.205, 0.3, 0.6, 0.9)
            ]
            print(
                f"{'':24}tip above 70 Hz, y: "
                f"{', '.join(f'{1e3 * size:.3f}' for size in after)} mm ",
                end="",
            )
            print("after 0, 0.1, 0.4, 0.7 s")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"results and pictures: {target}")
