"""A plastic snap-fit hook that is pushed over its catch, beside the formulas of handbooks.

    python examples/snap_fit.py [FOLDER]

runs examples/snap_fit.toml. Checks the force on the crest of the nose against that of a cantilever,
the push against friction there, the frequency with which the hook rings once it has snapped, and
the energy. Writes results and a picture to FOLDER, by default out/.
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
BODY = ROOT / "meshes/snap_hook/snap_hook.toml"
E, RHO, THICKNESS, WIDTH, FRICTION = 2.4e9, 1100.0, 0.002, 0.006, 0.2
LIFT, ARM = 0.0009, 0.0172
"""of the crest over the catch, and its distance from the root [m]"""
ON_CREST = 0.0165, 0.0185
"""when the crest slides on the catch [s]"""
RINGING = 0.023
"""from when on the hook rings freely [s]"""


@dataclass(frozen=True, eq=False)
class Snap:
    """time (n,) [s]; normal force (n,) of the catch and push (n,) at the root [N]; lift (n,) of the
    end of the hook over its root [m].
    """

    time: Array
    force: Array
    push: Array
    lift: Array


@dataclass(frozen=True)
class Checks:
    """Relative: force on the crest over that of a cantilever, less 1; errors of the push there
    against friction, and of the frequency of ringing [Hz] against that of linear analysis.
    """

    crest: float
    push: float
    ringing: float
    frequency: float
    balance: float


def main(folder: Path) -> tuple[Snap, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/snap_fit.toml")
    results = solver.simulate(model, output=folder / "snap_fit.h5")
    found = snap(results)
    checks = compare(found, results, first_frequency(model))
    with view.style():
        view.save(curves(found), folder / "snap-fit.png")
    assert abs(checks.crest) < 0.06
    assert checks.push < 0.01
    assert checks.ringing < 0.03
    assert checks.balance < 5e-4
    return found, checks


def ensure_superelement() -> Path:
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    return target


def snap(results: solver.Results) -> Snap:
    end, root = (results.frame(f"hook.{name}").position[:, 1] for name in ("tip", "root"))
    return Snap(
        time=results.time,
        force=results.surface_contact("catch").normal_force,
        push=results.joint("push").force[:, 0],
        lift=end - root - (end[0] - root[0]),
    )


def first_frequency(model: solver.Model) -> float:
    """Of the hook with its root held, which moves in the model [Hz]."""
    (push,) = model.joints
    still = replace(push, velocity=solver.Constant(0.0))
    hook = model.bodies["hook"]
    hook = replace(hook, start=replace(hook.start, velocity=np.zeros(3)))
    # A step for the modes of its band: with the surfaces open no static rest takes shorter ones.
    settings = replace(model.settings, step=2e-5)
    held = replace(model, bodies={"hook": hook}, joints=(still,), settings=settings)
    return float(solver.linearize(held).modes().frequencies.min())


def compare(found: Snap, results: solver.Results, first: float) -> Checks:
    on = (found.time > ON_CREST[0]) & (found.time < ON_CREST[1])
    force, push = float(found.force[on].mean()), abs(float(found.push[on].mean()))
    frequency = ringing(found)
    return Checks(
        crest=force / cantilever() - 1.0,
        push=abs(push / (FRICTION * force) - 1.0),
        ringing=abs(frequency / first - 1.0),
        frequency=frequency,
        balance=max(results.validity.values("energy_balance").values()),
    )


def cantilever() -> float:
    """3 EI lift / arm^3"""
    return 3.0 * E * WIDTH * THICKNESS**3 / 12.0 * LIFT / ARM**3


def ringing(found: Snap) -> float:
    """The frequency of the free hook by its passages through the mean."""
    late = found.time > RINGING
    time, lift = found.time[late], found.lift[late] - found.lift[late].mean()
    up = np.flatnonzero((lift[:-1] < 0.0) & (lift[1:] >= 0.0))
    times = time[up] - lift[up] * (time[up + 1] - time[up]) / (lift[up + 1] - lift[up])
    return float((len(times) - 1) / (times[-1] - times[0]))


def curves(found: Snap) -> Figure:
    figure, (force, push, lift) = view.panels(3)
    time = 1e3 * found.time
    force.plot(time, found.force)
    force.axhline(cantilever(), color="0.5", linestyle="--", label="cantilever on the crest")
    push.plot(time, found.push)
    lift.plot(time, 1e3 * found.lift)
    force.set(title="normal force of the catch", ylabel="[N]")
    push.set(title="force at the root along the way", ylabel="[N]")
    lift.set(title="lift of the end over the root", ylabel="[mm]", xlabel="time [ms]")
    force.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    view.entitle(figure, "A snap-fit hook that is pushed over its catch")
    return figure


def report(found: Snap, checks: Checks) -> None:
    print(f"force on the crest          {100.0 * checks.crest:+.1f} % of a cantilever's")
    print(f"push on the crest           friction within {checks.push:.1e}")
    print(f"largest push                {np.abs(found.push).max():.1f} N")
    print(
        f"ringing                     {checks.frequency:.0f} Hz, linear within {checks.ringing:.1e}"
    )
    print(f"error of the energy         {checks.balance:.1e} of the largest")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
