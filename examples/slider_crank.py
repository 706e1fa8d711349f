"""A slider-crank with a solid connecting rod, and the stresses in the rod through the strokes of an
engine.

    python examples/slider_crank.py [FOLDER]

runs examples/slider_crank.toml with the superelement of meshes/connecting_rod, and again with a
rigid rod of the same inertia. It checks the force on the piston of the rigid rod against its closed
form, that of the elastic rod against the rigid one, and the stresses in the middle of the shank
against the force that Newton's law wants there. Writes results and pictures to FOLDER, by default
out/.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from duhamel.preprocess.mesh.reading import read_mesh
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/connecting_rod/rod.toml"
CRANK, ROD, PISTON = 0.04, 0.15, 0.4
"""length of crank and of rod [m], mass of the piston [kg]"""
SPEED = 628.3185307179587
"""of the crank [rad/s]"""
CYCLE = (0.02, 0.04)
"""the strokes that are drawn, when what the start left has died away [s]"""
COLD = (0.02, 0.025)
"""before the compression [s]"""
SECTION = 0.075
"""the place on x of the middle of the shank, from the big end [m]"""
HEIGHT, WEB, THICKNESS = (27.0e-3, 17.0e-3), 6.0e-3, 16.0e-3
"""of the I there: height over its flanges and between them, thickness of web and of flanges [m]"""
ENLARGED = 60.0
"""displacements in the picture of the rod"""


@dataclass(frozen=True, eq=False)
class Strokes:
    """Forces and stresses in the rod through a cycle.

    time (n,) [s]; largest (n,): von Mises stress anywhere [Pa]; flanges (n, 2): axial stress in the
    middle of the shank at its sides y > 0 and y < 0 [Pa]; force (n,): in that section from its
    stresses, wanted (n,): from Newton's law without the centrifugal forces of the turning rod,
    centrifugal (n,): what these would add [N], tension positive.
    """

    time: Array
    largest: Array
    flanges: Array
    force: Array
    wanted: Array
    centrifugal: Array

    @property
    def worst(self) -> float:
        """The time of the largest stress [s]."""
        return float(self.time[self.largest.argmax()])


@dataclass(frozen=True)
class Checks:
    """Largest differences of forces over their peaks.

    rigid: on the piston, rigid rod less closed form; elastic: on the piston, elastic rod less rigid
    one, before the compression; section: in the shank, from stresses less Newton's law;
    centrifugal: what is left out of the latter.
    """

    rigid: float
    elastic: float
    section: float
    centrifugal: float


def main(folder: Path) -> tuple[Strokes, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/slider_crank.toml")
    elastic = solver.simulate(model, output=folder / "slider-crank.h5")
    rigid = solver.simulate(with_rigid_rod(model), output=folder / "slider-crank-rigid.h5")
    found = strokes(elastic)
    checks = compare(model, elastic, rigid, found)
    with view.style():
        view.save(curves(found, elastic, rigid), folder / "slider-crank.png")
        view.save(stressed_rod(elastic, found.worst), folder / "slider-crank-rod.png")
    assert checks.rigid < 1e-4
    assert checks.elastic < 0.01
    assert checks.section < 0.03
    return found, checks


def ensure_superelement() -> Path:
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    return target


def with_rigid_rod(model: solver.Model) -> solver.Model:
    rod = model.bodies["rod"]
    kernel = rod.superelement.kernel
    rigid = solver.RigidBody(rod.mass, rod.inertia, rod.frames, rod.start)
    return replace(model, bodies={**model.bodies, "rod": rigid}).with_settings(
        step=kernel.h, rho_inf=kernel.scheme.rho_inf
    )


def inertia_force(angle: Array) -> Array:
    """The force that accelerates the piston along x (n,) [N] when crank and rod are rigid: m times
    the second derivative of

    x = r cos(a) + l sqrt(1 - k^2 sin(a)^2),   k = r / l
    """
    k = CRANK / ROD
    root = np.sqrt(1.0 - (k * np.sin(angle)) ** 2)
    swing = (np.cos(2.0 * angle) * root**2 + (0.5 * k * np.sin(2.0 * angle)) ** 2) / root**3
    return -PISTON * CRANK * SPEED**2 * (np.cos(angle) + k * swing)


def strokes(results: solver.Results) -> Strokes:
    time = results.time
    time = time[(time >= CYCLE[0]) & (time <= CYCLE[1])]
    recovery = results.superelement("rod").recovery
    stress = results.stress("rod", time)
    x, y, z = (recovery.points + results.superelement("rod").center).T
    # The outer faces of the flanges, a quarter of the height of the section along x.
    near = (
        (np.abs(x - SECTION) < 0.25 * HEIGHT[0])
        & (np.abs(z) < 0.499 * THICKNESS)
        & (np.abs(y) > 0.45 * HEIGHT[0])
    )
    flanges = np.stack(
        [stress[:, near & (side * y > 0.0), 0].mean(axis=1) for side in (1.0, -1.0)], axis=1
    )
    wanted, centrifugal = section_force(results, time)
    return Strokes(
        time=time,
        largest=superelement.von_mises(stress).max(axis=1),
        flanges=flanges,
        force=area() * flanges.mean(axis=1),
        wanted=wanted,
        centrifugal=centrifugal,
    )


def area() -> float:
    """Of the section in the middle of the shank [m^2]."""
    height, inner = HEIGHT
    return (height - inner) * THICKNESS + inner * WEB


def section_force(results: solver.Results, time: Array) -> tuple[Array, Array]:
    """N = F_x - m a_x in the section (n,), tension positive, and what centrifugal forces would add
    to it (n,) [N].

    F is the force on the rod at its small end, m the mass beyond the section and a the acceleration
    of its center, all in the axes of the rod. The superelement answers to loads on its interfaces
    and the inertia forces of the rigid acceleration that goes with them, a + alpha x c; it does not
    know omega x (omega x c).
    """
    body, shown = results.body("rod"), np.isin(results.time, time)
    rotation = Rotation.from_quat(body.R[shown], scalar_first=True)
    force = rotation.inv().apply(results.frame("rod.small_end").force[shown, :3])
    acceleration = rotation.inv().apply(body.v_dot[shown, :3])
    omega, alpha = body.v[shown, 3:], body.v_dot[shown, 3:]
    mass, center = beyond_section()
    arm = center - results.superelement("rod").center
    centrifugal = np.cross(omega, np.cross(omega, arm))
    return force[:, 0] - mass * (acceleration + np.cross(alpha, arm))[:, 0], -mass * centrifugal[
        :, 0
    ]


def beyond_section() -> tuple[float, Array]:
    """Mass [kg] and center (3,) [m] of the rod on the side of the small end, from the corners of
    its tetrahedra.
    """
    body = preprocess.read_body(BODY)
    mesh = read_mesh(body.mesh, body.scale)
    corners = mesh.points[mesh.cells["tetra10"][:, :4]]
    centers, edges = corners.mean(axis=1), corners[:, 1:] - corners[:, :1]
    masses = body.material.rho * np.abs(np.linalg.det(edges)) / 6.0
    beyond = centers[:, 0] > SECTION
    mass = float(masses[beyond].sum())
    return mass, masses[beyond] @ centers[beyond] / mass


def compare(
    model: solver.Model, elastic: solver.Results, rigid: solver.Results, found: Strokes
) -> Checks:
    time = rigid.time
    gas = model.loads[0].signal.samples(time, time[1])
    exact = inertia_force(SPEED * time) + gas
    pistons = [results.joint("wrist_pin").force[:, 0] for results in (rigid, elastic)]
    cold = (time >= COLD[0]) & (time <= COLD[1])
    return Checks(
        rigid=largest(pistons[0] - exact) / largest(exact),
        elastic=largest((pistons[1] - pistons[0])[cold]) / largest(pistons[0][cold]),
        section=largest(found.force - found.wanted) / largest(found.wanted),
        centrifugal=largest(found.centrifugal) / largest(found.wanted),
    )


def largest(values: Array) -> float:
    return float(np.abs(values).max())


def curves(found: Strokes, elastic: solver.Results, rigid: solver.Results) -> Figure:
    figure, (pin, section, stress) = view.panels(3)
    blue, red, green, *_ = view.COLORS
    degrees = np.rad2deg(SPEED * (found.time - CYCLE[0]))
    shown = np.isin(rigid.time, found.time)
    for results, color, name in ((rigid, "0.6", "rigid rod"), (elastic, blue, "elastic rod")):
        pin.plot(
            degrees, 1e-3 * results.joint("wrist_pin").force[shown, 0], color=color, label=name
        )
    section.plot(degrees, 1e-3 * found.force, color=blue, label="from stresses")
    section.plot(
        degrees, 1e-3 * found.wanted, color=red, linestyle=(0, (4, 3)), label="from Newton's law"
    )
    stress.plot(degrees, 1e-6 * found.largest, color=red, label="largest von Mises stress")
    for side, color, name in ((0, blue, "+y"), (1, green, "-y")):
        stress.plot(
            degrees,
            1e-6 * found.flanges[:, side],
            color=color,
            label=f"middle of the shank, {name}",
        )
    pin.set(title="force on the piston, along the cylinder", ylabel="[kN]")
    section.set(title="force in the middle of the shank", ylabel="[kN]")
    stress.set(
        title="stress",
        ylabel="[MPa]",
        xlabel="angle of the crank [degrees]",
        xticks=range(0, 721, 90),
    )
    for axes in (pin, section, stress):
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=3)
    view.entitle(figure, "A connecting rod at 6000 revolutions a minute")
    return figure


def stressed_rod(results: solver.Results, time: float) -> Figure:
    recovery = results.superelement("rod").recovery
    points = recovery.points + ENLARGED * results.displacement("rod", time)
    field = view.Field(points, recovery.cells, results.von_mises("rod", time))
    return view.draw_fields([field], "von Mises stress [MPa]", 1e-6)


def report(found: Strokes, checks: Checks) -> None:
    k = found.largest.argmax()
    print(
        f"largest stress              {1e-6 * found.largest[k]:.1f} MPa at "
        f"{1e3 * found.worst:.2f} ms"
    )
    print(
        f"force in the shank          {1e-3 * found.force.min():.2f} to "
        f"{1e-3 * found.force.max():.2f} kN"
    )
    print(f"rigid rod, closed form      piston force within {checks.rigid:.2e} of its peak")
    print(
        f"elastic rod, rigid rod      piston force within {checks.elastic:.2e} before the "
        "compression"
    )
    print(f"stresses, Newton's law      force in the shank within {checks.section:.2e} of its peak")
    print(
        "                            centrifugal forces, left out, would add up to "
        f"{checks.centrifugal:.2e}"
    )


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
