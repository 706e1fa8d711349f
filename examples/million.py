"""An impact hammer with a connecting rod of a million unknowns, and with a coarse mesh of it.

    python examples/million.py [FOLDER] [--size MILLIMETERS]

runs examples/million.toml with the rod of meshes/connecting_rod/struck.toml, 21 thousand unknowns,
and with the same rod in elements of the given size, which Gmsh makes: 5 mm unless given, 1.2 mm for
a million unknowns. It prints what each superelement takes to make and to step, and what is found
with it, and checks the momentum of the blow, that nothing outruns waves of pressure, and that the
meshes agree. Writes the mesh, its superelement, results of it and of a rigid rod, and a picture to
FOLDER, by default out/; superelements that are there are taken as they are.
"""

from argparse import ArgumentParser
from dataclasses import dataclass, replace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from duhamel.preprocess.mesh.reading import read_mesh
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
PART = ROOT / "meshes/connecting_rod"
SIZE = 5.0
"""of the elements [mm]"""
COMPARED = 8
"""frequencies of the free rod"""
BORE_TO_BORE = 0.15 - 0.022 - 0.010
"""the steel that a wave has to cross [m]"""
BEFORE, AFTER = 5e-5, 5e-4
"""what is looked at, before and after the contact closes [s]"""
RUNS = 3
"""of which the quickest is told"""


@dataclass(frozen=True, eq=False)
class Rod:
    """The superelement of a rod; unknowns: of its mesh; seconds: that it took."""

    element: superelement.Superelement
    unknowns: int
    seconds: float

    @property
    def frequencies(self) -> Array:
        """Of the free rod (n,) [Hz]."""
        lowest: Array = np.sort(self.element.modes.frequencies)[:COMPARED]
        return lowest

    @property
    def stretch(self) -> float:
        """Of the distance between the bores, per force along it [m/N]."""
        along = np.zeros(len(self.element.compliance))
        along[[self.element.rows(name).start for name in ("big_end", "small_end")]] = -1.0, 1.0
        return float(along @ self.element.compliance @ along)


@dataclass(frozen=True, eq=False)
class Blow:
    """time (n,) [s] from the closing of the contact on; contact (n,): force of the blow, pin (n,):
    force of the crank on the rod, both along the line of the ram [N]; gained: momentum of the block
    [kg m/s], impulse: of the blow [N s]; step: what a step takes [s].
    """

    time: Array
    contact: Array
    pin: Array
    gained: float
    impulse: float
    step: float

    @property
    def peaks(self) -> Array:
        """Of contact and pin (2,) [N]."""
        return np.array([self.contact.max(), self.pin.max()])


@dataclass(frozen=True)
class Checks:
    """momentum: of the block less the impulse, relative; early: what the pin feels before waves can
    be there, over its largest force; frequencies, stretch, peaks: largest differences of the
    meshes, relative.
    """

    momentum: float
    early: float
    frequencies: float
    stretch: float
    peaks: float


def main(folder: Path, size: float = SIZE) -> tuple[list[Rod], list[Blow], Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    coarse, fine = PART / "rod.msh", folder / f"rod-{size:g}mm.msh"
    if not fine.exists():
        make_mesh(size, fine)
    rods = [rod_of(coarse, PART / "struck.h5"), rod_of(fine, fine.with_suffix(".h5"))]
    model = solver.read_model(ROOT / "examples/million.toml")
    blows = [strike(with_rod(model, rod), folder / "million.h5") for rod in rods]
    rigid = strike(with_rigid_rod(model), folder / "million-rigid.h5")
    checks = compare(rods, blows)
    with view.style():
        view.save(picture(rods, [*blows, rigid]), folder / "million.png")
    assert checks.momentum < 1e-5
    assert checks.early < 1e-3
    assert max(checks.frequencies, checks.stretch, checks.peaks) < 0.03
    return rods, blows, checks


def make_mesh(size: float, target: Path) -> None:
    """By the script beside the part, which needs Gmsh."""
    spec = spec_from_file_location("make_mesh", PART / "make_mesh.py")
    assert spec is not None
    assert spec.loader is not None
    script = module_from_spec(spec)
    spec.loader.exec_module(script)
    script.write(size, target)


def rod_of(mesh: Path, file: Path) -> Rod:
    """The rod on a mesh; its superelement is made where there is no file of it."""
    body = preprocess.read_body(PART / "struck.toml").model_copy(update={"mesh": mesh})
    if not file.exists():
        superelement.write(preprocess.build(body, progress=True), file)
    element = superelement.read(file)
    seconds = sum(element.provenance.timings.values())
    return Rod(element, 3 * len(read_mesh(mesh, body.scale).points), seconds)


def with_rod(model: solver.Model, rod: Rod) -> solver.Model:
    body = replace(model.bodies["rod"], superelement=rod.element, source="")
    return replace(model, bodies={**model.bodies, "rod": body})


def with_rigid_rod(model: solver.Model) -> solver.Model:
    rod = model.bodies["rod"]
    kernel = rod.superelement.kernel
    rigid = solver.RigidBody(rod.mass, rod.inertia, rod.frames, rod.start)
    return replace(model, bodies={**model.bodies, "rod": rigid}).with_settings(
        step=kernel.h, rho_inf=kernel.scheme.rho_inf
    )


def strike(model: solver.Model, output: Path) -> Blow:
    runs = [solver.simulate(model, output=output) for _ in range(RUNS)]
    results = runs[-1]
    event, block = results.events["blow"], results.body("block")
    time = results.time - event.start[0]
    shown = (time > -BEFORE) & (time < AFTER)
    return Blow(
        time=time[shown],
        contact=results.contact("blow").force[shown, 0],
        pin=results.joint("crank_pin").force[shown, 0],
        gained=model.bodies["block"].mass * float(np.ptp(block.v[:, 0])),
        impulse=float(event.impulse.sum()),
        step=min(run.solver["seconds"] for run in runs) / results.solver["steps"],
    )


def compare(rods: list[Rod], blows: list[Blow]) -> Checks:
    """Of two meshes, the coarse one first."""
    coarse, fine = rods
    frequencies = np.abs(coarse.frequencies / fine.frequencies - 1.0).max()
    peaks = np.abs(blows[0].peaks / blows[1].peaks - 1.0).max()
    return Checks(
        momentum=max(abs(blow.gained / blow.impulse - 1.0) for blow in blows),
        early=max(early(blow) for blow in blows),
        frequencies=float(frequencies),
        stretch=abs(coarse.stretch / fine.stretch - 1.0),
        peaks=float(peaks),
    )


def early(blow: Blow) -> float:
    """What the pin feels before a wave of pressure can have come to it, c_p = sqrt((lambda + 2 mu)
    / rho), over its largest force.
    """
    steel = preprocess.read_body(PART / "struck.toml").material
    stiffness = steel.E * (1.0 - steel.nu) / ((1.0 + steel.nu) * (1.0 - 2.0 * steel.nu))
    arrival = BORE_TO_BORE / np.sqrt(stiffness / steel.rho)
    before = blow.time < arrival
    return float(np.ptp(blow.pin[before]) / blow.pin.max())


def picture(rods: list[Rod], blows: list[Blow]) -> Figure:
    """Forces on both ends of the rods, and of a rigid one, which comes last."""
    figure, (struck, held) = view.panels(2)
    blue, red, *_ = view.COLORS
    names = [f"{rod.unknowns:,} unknowns".replace(",", " ") for rod in rods] + ["rigid rod"]
    styles = [(red, (0, (4, 3))), (blue, "-"), ("0.6", "-")]
    for axes, quantity in ((struck, "contact"), (held, "pin")):
        for k in (2, 1, 0):
            color, line = styles[k]
            force = 1e-3 * getattr(blows[k], quantity)
            axes.plot(1e6 * blows[k].time, force, color=color, linestyle=line, label=names[k])
        axes.set(ylabel="[kN]", ylim=(-8.0, 1.15e-3 * blows[1].peaks.max()))
    struck.set(title="force of the blow")
    held.set(title="force on the crank pin", xlabel="time after the contact has closed [us]")
    struck.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=3)
    view.entitle(figure, "A blow through a connecting rod")
    return figure


def report(rods: list[Rod], blows: list[Blow], checks: Checks) -> None:
    rows = [
        ("unknowns", *(f"{rod.unknowns}" for rod in rods)),
        ("superelement", *(f"{rod.seconds:.1f} s" for rod in rods)),
        ("modes", *(f"{len(rod.element.modes.omega)}" for rod in rods)),
        ("error of its kernel", *(f"{rod.element.kernel.error:.1e}" for rod in rods)),
        ("a step", *(f"{1e6 * blow.step:.1f} us" for blow in blows)),
        ("first frequencies", *(f"{rod.frequencies[0]:.2f} Hz" for rod in rods)),
        *(("", *(f"{rod.frequencies[k]:.2f} Hz" for rod in rods)) for k in range(1, COMPARED)),
        ("stretch of the bores", *(f"{1e9 * rod.stretch:.5f} nm/N" for rod in rods)),
        ("force of the blow", *(f"{blow.peaks[0]:.1f} N" for blow in blows)),
        ("force on the crank pin", *(f"{blow.peaks[1]:.1f} N" for blow in blows)),
    ]
    for name, coarse, fine in rows:
        print(f"{name:24}{coarse:>16}{fine:>16}")
    print(
        f"meshes apart            frequencies {checks.frequencies:.1e}, stretch "
        f"{checks.stretch:.1e}, forces {checks.peaks:.1e}"
    )
    print(f"momentum of the block   impulse of the blow within {checks.momentum:.1e}")
    print(f"before a wave can come  the pin feels {checks.early:.1e} of its largest force")


if __name__ == "__main__":
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, nargs="?", default=ROOT / "out")
    parser.add_argument("--size", type=float, default=SIZE, help="of the elements [mm]")
    given = parser.parse_args()
    report(*main(given.folder, given.size))
    print(f"results and picture: {given.folder}")
