"""Two steel rods that meet end to end: what each keeps comes out of the waves.

    python examples/colliding_rods.py [FOLDER]

runs examples/colliding_rods.toml, a rod of 1 m against one of 2 m, and again against one of 1 m.
Forces, times and velocities are compared with those that Saint-Venant found (1867): a force Z v / 2
for as long as a wave needs there and back in the shorter rod. Writes results and a picture to
FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from duhamel.results.motion import Events
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
MESHES = ROOT / "meshes/impact"
EA, MASS_PER_LENGTH, LENGTH, SPEED = 2.1e7, 0.785, 1.0, 1.0
"""[N], [kg/m], of the striker [m], of the striker [m/s]"""
STRUCK = {"rod": 1.0, "long_rod": 2.0}
"""lengths [m] by names of body files"""
WAVE_SPEED = (EA / MASS_PER_LENGTH) ** 0.5
"""[m/s]"""
FORCE = 0.5 * EA / WAVE_SPEED * SPEED
"""Z v / 2 [N]"""
DURATION = 2.0 * LENGTH / WAVE_SPEED
"""of the contact [s]"""


@dataclass(frozen=True, eq=False)
class Collision:
    """time (n,) [s], force (n,) [N]; velocities (n, 2) [m/s] of the centers of striker and struck;
    gap (n,) [m].
    """

    time: Array
    force: Array
    velocities: Array
    events: Events


@dataclass(frozen=True)
class Checks:
    """Differences from the exact collision: of the plateau of the force, of impulse and momentum
    relative; of the velocities over that of the striker; restitution: of mean velocities.
    """

    plateau: float
    peak: float
    duration: float
    velocities: float
    momentum: float
    restitution: float
    contacts: int


def main(folder: Path) -> dict[str, tuple[Collision, Checks]]:
    folder.mkdir(parents=True, exist_ok=True)
    files = {name: ensure_superelement(name) for name in STRUCK}
    model = solver.read_model(ROOT / "examples/colliding_rods.toml")
    found = {}
    for name, file in files.items():
        rod = replace(
            model.bodies["struck"], superelement=superelement.read(file), source=str(file)
        )
        swapped = replace(model, bodies={**model.bodies, "struck": rod})
        met = collision(solver.simulate(swapped, output=folder / f"colliding-{name}.h5"))
        found[name] = met, compare(met, STRUCK[name])
    with view.style():
        view.save(picture(found), folder / "colliding-rods.png")
    for _, checks in found.values():
        assert checks.plateau < 0.01
        assert checks.peak < 0.02
        assert checks.velocities < 0.01
        assert checks.momentum < 1e-12
        assert checks.contacts == 1
    return found


def ensure_superelement(name: str) -> Path:
    target = MESHES / f"{name}.h5"
    if not target.exists():
        body = preprocess.read_body(target.with_suffix(".toml"))
        superelement.write(preprocess.build(body), target)
    return target


def collision(results: solver.Results) -> Collision:
    ends = results.contact("ends")
    velocities = [results.body(name).v[:, 0] for name in ("striker", "struck")]
    return Collision(
        results.time, ends.force[:, 0], np.stack(velocities, axis=1), results.events["ends"]
    )


def after(length: float) -> Array:
    """Velocities (2,) [m/s] of striker and struck after the exact collision."""
    return SPEED * np.array([0.0, LENGTH / length])


def compare(met: Collision, length: float) -> Checks:
    masses = MASS_PER_LENGTH * np.array([LENGTH, length])
    last, start = met.velocities[-1], met.events.start[0]
    middle = (met.time > start + 0.2 * DURATION) & (met.time < start + 0.8 * DURATION)
    return Checks(
        plateau=abs(float(met.force[middle].mean() / FORCE) - 1.0),
        peak=abs(float(met.force.max() / FORCE) - 1.0),
        duration=float((met.events.end[0] - start) / DURATION) - 1.0,
        velocities=float(np.abs(last - after(length)).max() / SPEED),
        momentum=abs(float(masses @ last / (masses[0] * SPEED)) - 1.0),
        restitution=float(last[1] - last[0]) / SPEED,
        contacts=len(met.events),
    )


def picture(found: dict[str, tuple[Collision, Checks]]) -> Figure:
    figure, panels = view.panels(2, 2)
    blue, red, *_ = view.COLORS
    dashed = (0, (4, 3))
    for (name, (met, _)), force, speed in zip(found.items(), panels[:2], panels[2:], strict=True):
        time, start = 1e3 * met.time, 1e3 * met.events.start[0]
        end = start + 1e3 * DURATION
        force.plot(time, 1e-3 * met.force, color=blue, label="contact")
        exact = [0.0, 0.0, FORCE, FORCE, 0.0, 0.0]
        force.plot(
            [0.0, start, start, end, end, time[-1]],
            1e-3 * np.array(exact),
            color="0.2",
            linestyle=dashed,
            label="exact",
        )
        for k, (body, color) in enumerate((("striker", red), ("struck", blue))):
            speed.plot(time, met.velocities[:, k], color=color, label=body)
            speed.plot(
                [0.0, start, end, time[-1]],
                [SPEED * (k == 0)] * 2 + [after(STRUCK[name])[k]] * 2,
                color="0.2",
                linestyle=dashed,
                linewidth=0.8,
            )
        force.set(title=f"force, 1 m against {STRUCK[name]:.0f} m", ylabel="[kN]")
        speed.set(title="velocities of the centers of mass", ylabel="[m/s]", xlabel="time [ms]")
        for axes in (force, speed):
            axes.legend(loc="center right")
    view.entitle(figure, "Colliding rods")
    return figure


def report(found: dict[str, tuple[Collision, Checks]]) -> None:
    for name, (met, checks) in found.items():
        print(f"1 m against {STRUCK[name]:.0f} m")
        print(
            f"  force                     {met.force.max():.1f} N at most, exact {FORCE:.1f} N; "
            f"plateau within {checks.plateau:.2e}"
        )
        print(
            f"  contacts                  {checks.contacts}, longer by {checks.duration:.2e} than "
            f"{1e3 * DURATION:.4f} ms"
        )
        v = met.velocities[-1]
        print(
            f"  velocities                {v[0]:.4f}, {v[1]:.4f} m/s, exact "
            f"{after(STRUCK[name])[0]:.4f}, {after(STRUCK[name])[1]:.4f}; restitution "
            f"{checks.restitution:.4f}; momentum within {checks.momentum:.1e}"
        )


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"results and picture: {target}")
