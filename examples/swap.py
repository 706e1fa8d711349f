"""One rotor with one bar, made of beams and made of solids.

    python examples/swap.py [FOLDER]

runs examples/swap.toml with the superelement of the beam mesh, and again with that of the solid
mesh in its place; and Case 1 of the paper likewise, with the twin of its beam in solids. The two
motions must differ by no more than the meshes explain: the frequencies of the rotor with one bar
and with the other drift apart in phase, and the static deflections differ. Writes results and
pictures to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from duhamel.results import quantities
from duhamel.superelement import Superelement
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent


@dataclass(frozen=True)
class Swap:
    """A model in examples/ and its bar, for which a folder in meshes/ has beam.toml and solid.toml.

    tolerance: how near, relative to its peak, the angles of the hub must be.
    """

    model: str
    bar: str
    meshes: str
    picture: str
    title: str
    tolerance: float


SWAPS = (
    Swap("swap", "bar", "bar", "swap", "A rotor with one bar from two meshes", 1e-4),
    Swap(
        "case1",
        "beam",
        "beam",
        "case1-solid",
        "Case 1 of the paper with its beam from two meshes",
        1e-4,
    ),
)


@dataclass(frozen=True, eq=False)
class Motion:
    """time (n,) [s], angle of the hub (n,) [rad], deflection of the tip along y and z of the rim
    (n, 2) [m].
    """

    time: Array
    angle: Array
    deflection: Array


@dataclass(frozen=True, eq=False)
class Comparison:
    """Solid against beam, all relative: largest differences of the motions over their peaks, and
    what explains them.

    frequency: of the first two elastic modes of the rotor [Hz], with the beam; frequency_shift:
    their change; compliance_shift (2,): change of the static deflection of the clamped bar under a
    tip force along y and along z; explained: by the phase 2 pi |shift| f t_end that the slower or
    faster of the two gains, and the compliance.
    """

    angle: float
    deflection: float
    frequency: Array
    frequency_shift: Array
    compliance_shift: Array
    explained: float


def main(folder: Path, swap: Swap = SWAPS[0]) -> Comparison:
    folder.mkdir(parents=True, exist_ok=True)
    files = {kind: ensure(kind, swap.meshes) for kind in ("beam", "solid")}
    bars = {kind: superelement.read(file) for kind, file in files.items()}
    model = solver.read_model(ROOT / f"examples/{swap.model}.toml")
    motions = {}
    for kind, bar in bars.items():
        swapped = replace(model.bodies[swap.bar], superelement=bar, source=str(files[kind]))
        target = folder / f"{swap.model}-{kind}.h5"
        solver.simulate(replace(model, bodies={**model.bodies, swap.bar: swapped}), output=target)
        motions[kind] = motion(solver.Results.read(target), swap.bar)
    found = compare(model, bars, motions)
    with view.style():
        view.save(picture(motions, swap.title), folder / f"{swap.picture}.png")
    assert found.deflection < found.explained
    assert found.angle < swap.tolerance
    return found


def ensure(kind: str, meshes: str = "bar") -> Path:
    """The superelement of a mesh of a bar, made if it is not there."""
    body = ROOT / f"meshes/{meshes}/{kind}.toml"
    target = body.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(body)), target)
    return target


def motion(results: solver.Results, bar: str) -> Motion:
    deflection = quantities.displacement(results, f"{bar}.tip", seen_from="hub.rim")[:, 1:]
    return Motion(results.time, quantities.angle(results, "hub")[:, 2], deflection)


def compare(
    model: solver.Model, bars: dict[str, Superelement], motions: dict[str, Motion]
) -> Comparison:
    beam, solid = motions["beam"], motions["solid"]
    frequency, of_solid = (rotor_frequencies(model, bar) for bar in bars.values())
    compliance = [np.diag(clamped_compliance(bar))[1:3] for bar in bars.values()]
    frequency_shift, compliance_shift = (
        of_solid / frequency - 1.0,
        compliance[1] / compliance[0] - 1.0,
    )
    drift = 2.0 * np.pi * frequency * np.abs(frequency_shift) * model.settings.t_end
    return Comparison(
        angle=largest(solid.angle - beam.angle) / largest(beam.angle),
        deflection=largest(solid.deflection - beam.deflection) / largest(beam.deflection),
        frequency=frequency,
        frequency_shift=frequency_shift,
        compliance_shift=compliance_shift,
        explained=float(drift.sum() + largest(compliance_shift)),
    )


def largest(values: Array) -> float:
    return float(np.abs(values).max())


def rotor_frequencies(model: solver.Model, bar: Superelement) -> Array:
    """The first two elastic frequencies of hub and bar about rest [Hz].

    A load p between root and rim that leaves no gap between them, D(omega) p = 0:

        D = sum_i phi_i phi_i^T / (omega_i^2 - omega^2) - (U [m I, J_rot]^-1 U^T + d d^T / I_hub) /
        omega^2

    with all rows at the root of the bar, d the motion of the rim for a unit angle of the hub. D
    grows with omega up to the first frequency of the free bar, and each eigenvalue that changes
    sign is a frequency of the rotor.
    """
    hub = model.bodies["hub"]
    rim, axis = hub.frames["rim"], np.array([0.0, 0.0, 1.0])
    to_bar = Rotation.from_rotvec(rim.rotation).as_matrix().T
    d = np.concatenate([to_bar @ np.cross(axis, rim.position), to_bar @ axis])
    U, inertia = rigid_motion(bar, "root"), block_diag(bar.mass * np.eye(3), bar.J_rot)
    rigid = U @ np.linalg.solve(inertia, U.T) + np.outer(d, d) / hub.inertia[2, 2]
    squares, phi = bar.modes.omega**2, bar.modes.phi[bar.rows("root")]

    def eigenvalue(omega: float, k: int) -> float:
        D = phi / (squares - omega**2) @ phi.T - rigid / omega**2
        return float(np.linalg.eigvalsh(omega**2 * D)[-k])

    first_of_free_bar = float(bar.modes.omega.min())
    roots = [
        brentq(eigenvalue, 1.0, 0.999 * first_of_free_bar, args=(k,), xtol=1e-9) for k in (1, 2)
    ]
    return np.array(roots) / (2.0 * np.pi)


def clamped_compliance(bar: Superelement) -> Array:
    """Displacement of the tip under a load at the tip with the root held, (6, 6), from the
    inertia-relieved compliance.

    The root answers a load p on the tip with -X^T p, X = U_tip U_root^-1, so that the loads balance
    each other.
    """
    X = rigid_motion(bar, "tip") @ np.linalg.inv(rigid_motion(bar, "root"))
    balanced = np.hstack([-X, np.eye(6)])
    return balanced @ bar.compliance @ balanced.T


def rigid_motion(bar: Superelement, interface: str) -> Array:
    """U = [I, -skew(X); 0, I] (6, 6) of an interface, about the center of mass."""
    X = next(found.X for found in bar.interfaces if found.name == interface)
    U = np.eye(6)
    U[:3, 3:] = np.cross(np.eye(3), X).T  # columns e_i x X
    return U


def picture(motions: dict[str, Motion], title: str) -> Figure:
    """The angle, the deflections of the tip, without that of a plane in which nothing moves, and
    their differences.
    """
    blue, red, green, *_ = view.COLORS
    beam, solid = motions["beam"], motions["solid"]
    peaks = np.abs(beam.deflection).max(axis=0)
    moving = [(row, name) for row, name in enumerate("yz") if peaks[row] > 1e-6 * peaks.max()]
    figure, (angle, *deflections, difference) = view.panels(2 + len(moving))
    for (kind, found), color, line in zip(
        motions.items(), (blue, red), ("-", (0, (4, 3))), strict=True
    ):
        look = {"color": color, "linestyle": line, "label": f"{kind} mesh"}
        angle.plot(found.time, found.angle, **look)
        for axes, (row, _) in zip(deflections, moving, strict=True):
            axes.plot(found.time, 1e3 * found.deflection[:, row], **look)
    for axes, (row, name) in zip(deflections, moving, strict=True):
        axes.set(title=f"tip in the axes of the rim, {name}", ylabel="[mm]")
        apart = 1e6 * (solid.deflection - beam.deflection)[:, row]
        difference.plot(beam.time, apart, color=(green, "0.5")[row], label=name)
    angle.set(title="angle of the hub", ylabel="[rad]")
    difference.set(title="tip, solid mesh less beam mesh", ylabel="[µm]", xlabel="time [s]")
    for axes in (angle, difference):
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=2)
    view.entitle(figure, title)
    return figure


def report(found: Comparison) -> None:
    f, shift, compliance = found.frequency, found.frequency_shift, found.compliance_shift
    print(
        f"frequencies of the rotor    {f[0]:.3f}, {f[1]:.3f} Hz; solid less beam "
        f"{shift[0]:+.2e}, {shift[1]:+.2e}"
    )
    print(
        f"static tip compliance       solid less beam {compliance[0]:+.2e} (y), "
        f"{compliance[1]:+.2e} (z)"
    )
    print(f"angle of the hub            largest difference over its peak {found.angle:.2e}")
    print(f"deflection of the tip       largest difference over its peak {found.deflection:.2e}")
    print(f"                            explained by the meshes up to {found.explained:.2e}")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    for swap in SWAPS:
        print(swap.title)
        report(main(target, swap))
    print(f"results and picture: {target}")
