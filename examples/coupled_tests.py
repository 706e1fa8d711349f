"""Two parts that are known by tests alone, joined in a model, beside a test of both together.

    python examples/coupled_tests.py FOLDER --stand-in
    python examples/coupled_tests.py FOLDER --lab FOLDER_OF_MEASUREMENTS --sha256 Y_B.p=DIGEST
    python examples/coupled_tests.py FOLDER

FOLDER has, all in the axes of the assembly:

- a.toml, b.toml: body files of both parts by `[measured]`, whose responses are .npz files with f
  and H, accelerances in the order of their tables. Tables have the columns label, x, y, z, dx, dy,
  dz. Interfaces with one name in both parts are welded.
- ab.npz, ab_channels.csv, ab_hits.csv: the same of the assembly. A further column, interface, says
  with which interface of a part a channel or hit moves, as a.root.

Of files that are there, parts are identified, and parts and assembly compared with what was
measured, in three bands: rms of the difference over that of the measurement, channels and hits each
in their own size, and mean difference in dB; coupled-tests.png shows a response of each.
`--stand-in` writes a simulated test of two beams to FOLDER.

Measurements that are free to load, but not by this script:

- The laboratory testbench of pyFBS, https://gitlab.com/pyFBS/pyFBS_data, folder
  lab_testbench/Measurements: Y_A.p, Y_B.p, Y_AB.p and decoupling_example_SVT.xlsx, whose sheets
  Channels_B and Impacts_B are to be saved as Channels_B.csv and Impacts_B.csv beside the first.
  `--lab` makes b.npz, b_channels.csv and b_hits.csv of them, likewise for A and AB; what pyFBS
  1.0.7 reads in its notebooks 09 and 20 says how. Mass, center, inertia and the places of virtual
  points are not in these files: body files are yours to write. Y_A.p has six channels and hits,
  none at the joint, by which A is no superelement: only B can be compared.
- FrameWing_Data.mat of https://github.com/spcarte/IMAC_Substructuring_ShortCourse, in
  Example_Scripts/Module_7, has modes (phi, wn, zt, names) of four assemblies, no responses, for
  frame with wing = first - second + third. Parts cannot be subtracted here: it is not read.

Digests (SHA-256) of Y_A.p and its like are printed before they are read. None is known here: give
those that you trust by `--sha256 NAME=DIGEST`, and another file stops the script.
"""

import argparse
import csv
import hashlib
import pickle
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import duhamel as du
import numpy as np
from duhamel import preprocess, view
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

PARTS = "a", "b"
BANDS = 3
"""of equal width, up to where the parts claim to be right"""
SMALL = 0.02
"""of the mean of a response: valleys below it are noise in dB"""
LOADS, MOTIONS = ("force", "torque"), ("acceleration", "angular_acceleration")
ROW = "label", "x", "y", "z", "dx", "dy", "dz"
OF_NUMPY = {"_reconstruct", "ndarray", "dtype", "scalar", "_frombuffer"}
"""all that files of arrays need of NumPy"""


@dataclass(frozen=True, eq=False)
class Measured:
    """Accelerances H (k, n_o, n_i) at f (k,) [Hz], and what channels and hits are of the motions
    and loads of frames: outputs (n_o, 6 n), inputs (n_i, 6 n).
    """

    f: Array
    H: ComplexArray
    frames: tuple[str, ...]
    outputs: Array
    inputs: Array


@dataclass(frozen=True)
class Differences:
    """Of computed responses from measured ones in a band [Hz]: relative, and in dB."""

    what: str
    band: tuple[float, float]
    relative: float
    decibels: float


@dataclass(frozen=True, eq=False)
class Comparison:
    """Measured H and computed Y (k, n_o, n_i) at f (k,) [Hz]."""

    what: str
    f: Array
    H: ComplexArray
    Y: ComplexArray

    @property
    def size(self) -> Array:
        """(n_o, n_i): what is zero by symmetry is measured as noise, and has that of its channel
        and hit.
        """
        square = (np.abs(self.H) ** 2).mean(axis=0)
        return np.sqrt(np.outer(square.mean(axis=1), square.mean(axis=0)) / square.mean())

    def rows(self) -> Iterator[Differences]:
        """One for each band."""
        counts = np.abs(self.H) > SMALL * self.size
        decibels = np.abs(20.0 * np.log10(np.abs(self.Y) / np.abs(self.H)))
        for low, high in pairwise(np.linspace(self.f[0], self.f[-1], BANDS + 1).tolist()):
            k = (self.f >= low) & (self.f <= high)
            off, whole = (np.linalg.norm(x[k] / self.size) for x in (self.Y - self.H, self.H))
            mean = float(decibels[k][counts[k]].mean())
            yield Differences(self.what, (low, high), float(off / whole), mean)


def main(
    folder: Path,
    stand_in: bool = False,
    lab: Path | None = None,
    digests: Mapping[str, str] | None = None,
) -> list[Differences]:
    folder.mkdir(parents=True, exist_ok=True)
    if stand_in:
        write_stand_in(folder)
    if lab is not None:
        for name in ("A", "B", "AB"):
            convert_lab(lab, name, folder, digests or {})
    elements = {
        name: preprocess.build(preprocess.read_body(folder / f"{name}.toml"))
        for name in PARTS
        if (folder / f"{name}.toml").exists()
    }
    compared = []
    for name, element in elements.items():
        body = preprocess.read_body(folder / f"{name}.toml")
        paths = body.measured.frf, body.measured.channels, body.measured.hits
        measured = read_test(paths, places({name: element}), _owner(name, body.interfaces))
        compared.append(compare(name, {name: element}, measured))
    paths = folder / "ab.npz", folder / "ab_channels.csv", folder / "ab_hits.csv"
    if len(elements) == len(PARTS) and paths[0].exists():
        measured = read_test(paths, places(elements), lambda line, _: line["interface"])
        compared.append(compare("a and b", elements, measured))
    found = [row for one in compared for row in one.rows()]
    if compared:
        with view.style():
            view.save(curves(compared), folder / "coupled-tests.png")
    for row in found:
        low, high = row.band
        print(
            f"{row.what:8s} {low:6.0f} to {high:6.0f} Hz: {100.0 * row.relative:5.1f} %, "
            f"{row.decibels:.2f} dB"
        )
    return found


def places(elements: Mapping[str, du.Superelement]) -> dict[str, Array]:
    """Frames that turn, by PART.INTERFACE, in the axes of the tables."""
    return {
        f"{name}.{interface.name}": element.center + interface.X
        for name, element in elements.items()
        for interface in element.interfaces
        if interface.rotations
    }


def _owner(name: str, interfaces: Mapping[str, Any]) -> Callable[[dict[str, str], str], str]:
    """The interface with which a line of the channels or hits of a part moves, "" for none."""

    def owner(line: dict[str, str], key: str) -> str:
        own = (i for i, point in interfaces.items() if line["label"] in getattr(point, key))
        return f"{name}.{next(own, '')}"

    return owner


def read_test(
    paths: Sequence[Path],
    known: Mapping[str, Array],
    owner: Callable[[dict[str, str], str], str],
) -> Measured:
    """Of responses, channels and hits, those that move with frames that are known.

    A channel along e at X and a force along e there both have the row [e, (X - X_v) x e].
    """
    chosen, rows = [], []
    for path, key in zip(paths[1:], ("channels", "hits"), strict=True):
        with path.open(newline="") as file:
            lines = list(csv.DictReader(file, skipinitialspace=True))
        frames = [owner(line, key) for line in lines]
        used = [k for k, frame in enumerate(frames) if frame in known]
        if not used:
            raise SystemExit(f"{path}: expected a line at one of {', '.join(known)}, found none")
        of_all = np.zeros((len(used), 6 * len(known)))
        for row, k in zip(of_all, used, strict=True):
            X, e = (np.array([float(lines[k][x]) for x in axes]) for axes in (ROW[1:4], ROW[4:]))
            first = 6 * list(known).index(frames[k])
            row[first : first + 6] = [*e, *np.cross(X - known[frames[k]], e)]
        chosen.append(used)
        rows.append(of_all)
    with np.load(paths[0]) as arrays:
        f, H = arrays["f"], arrays["H"]
    return Measured(f, H[:, chosen[0]][:, :, chosen[1]], tuple(known), rows[0], rows[1])


def assembly(elements: Mapping[str, du.Superelement]) -> du.Mechanism:
    """Parts where their tables are, interfaces of one name welded."""
    m = du.Mechanism()
    bodies = [m.add(x, name=name, position=x.center) for name, x in elements.items()]
    for first, second in pairwise(bodies):
        for name in [name for name in first.frames if name in second.frames]:
            m.add(du.joints.Fixed(first[name], second[name]), name=name)
    return m


def responses(m: du.Mechanism, frames: Sequence[str], f: Array) -> ComplexArray:
    """Accelerances (k, 6 n, 6 n) of frames."""
    inputs, outputs = (
        [f"{kind}:{frame}:{axis}" for frame in frames for kind in kinds for axis in "xyz"]
        for kinds in (LOADS, MOTIONS)
    )
    return m.frf(inputs, outputs, f).values


def compare(what: str, elements: Mapping[str, du.Superelement], measured: Measured) -> Comparison:
    """The responses of parts in a model, at the lines up to which these claim to be right."""
    highest = min(element.kernel.band for element in elements.values())
    used = (measured.f > 0.0) & (measured.f <= highest)
    f = measured.f[used]
    Y = responses(assembly(elements), measured.frames, f)
    return Comparison(what, f, measured.H[used], measured.outputs @ Y @ measured.inputs.T)


def curves(found: Sequence[Comparison]) -> Figure:
    """The largest response of each."""
    figure, panels = view.panels(len(found))
    blue, red, *_ = view.COLORS
    for axes, one in zip(np.atleast_1d(panels), found, strict=True):
        o, i = np.unravel_index(one.size.argmax(), one.size.shape)
        axes.semilogy(one.f, np.abs(one.H[:, o, i]), color=blue, label="measured")
        axes.semilogy(
            one.f, np.abs(one.Y[:, o, i]), color=red, linestyle=(0, (4, 3)), label="superelements"
        )
        axes.set(title=one.what, ylabel="[1/kg]")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=2)
    axes.set(xlabel="frequency [Hz]")
    view.entitle(figure, "Tested parts, and both together")
    return figure


class ArraysOnly(pickle.Unpickler):
    """Reads arrays of NumPy alone: other files of this kind may run what they like."""

    def find_class(self, module: str, name: str) -> Any:
        if module.split(".")[0] == "numpy" and name in OF_NUMPY:
            return super().find_class(module.replace("numpy.core", "numpy._core"), name)
        if (module, name) == ("_codecs", "encode"):
            return super().find_class(module, name)
        raise pickle.UnpicklingError(f"expected arrays, found {module}.{name}")


def convert_lab(lab: Path, name: str, folder: Path, digests: Mapping[str, str]) -> None:
    """A test of pyFBS's testbench as .npz and tables, if its files are there.

    Y_NAME.p: frequencies (k,) [Hz] and accelerances (n_o, n_i, k); the sheets: Name, "S1 X" of
    channels, Position_1 to 3 [m], Direction_1 to 3.
    """
    source = lab / f"Y_{name}.p"
    if not source.exists():
        return
    check_digest(source, digests)
    with source.open("rb") as file:
        f, Y = ArraysOnly(file).load()
    counts = {}
    for sheet, table in (("Channels", "channels"), ("Impacts", "hits")):
        path = lab / f"{sheet}_{name}.csv"
        with path.open(newline="", encoding="utf-8-sig") as file:
            lines = list(csv.DictReader(file))
        counts[table] = len(lines)
        columns = [f"{of}_{k}" for of in ("Position", "Direction") for k in (1, 2, 3)]
        _write_table(
            folder / f"{name.lower()}_{table}.csv",
            [[line["Name"].split()[0], *(line[column] for column in columns)] for line in lines],
        )
    H = np.transpose(np.asarray(Y), (2, 0, 1))
    expected = len(np.ravel(f)), counts["channels"], counts["hits"]
    if H.shape != expected:
        raise SystemExit(f"{source}: expected lines, channels and hits {expected}, found {H.shape}")
    above = np.ravel(f) > 0.0
    np.savez(
        folder / f"{name.lower()}.npz", f=np.ravel(f)[above], H=H[above], quantity="accelerance"
    )


def check_digest(path: Path, digests: Mapping[str, str]) -> None:
    """Print the digest of a file, and stop if another one is expected."""
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    expected = digests.get(path.name)
    print(f"{found}  {path.name}: {'as expected' if expected else 'nothing to compare it with'}")
    if expected not in (None, found):
        raise SystemExit(f"{path}: expected the SHA-256 {expected}, found {found}")


def _write_table(path: Path, lines: Sequence[Sequence[Any]], head: Sequence[str] = ROW) -> None:
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([head, *lines])


LENGTHS = {"a": (0.0, 0.6), "b": (0.6, 1.0)}
ENDS = {"a": ("root", "joint"), "b": ("joint", "tip")}
STEEL = du.Material(E=210e9, nu=0.3, rho=7850.0)
SECTIONS = {"a": (0.016, 0.01), "b": (0.014, 0.011)}
"""width and height of the stand-ins [m]"""
REACH = np.array([[0.0, 0.04, 0.03], [0.01, -0.03, 0.04], [0.02, 0.01, -0.04]])
"""of sensors from the ends of the stand-ins [m]: on brackets of no mass"""
NOISE, SEED = 0.02, 1
STAND_IN_LINES = np.arange(20.0, 5000.0, 4.0)
STAND_IN = """name = "{name}"
[measured]
frf = "{name}.npz"
channels = "{name}_channels.csv"
hits = "{name}_hits.csv"
band = [20, 5000]
[measured.rigid]
mass = {mass}
center = {center}
inertia = {inertia}
{interfaces}[impulse]
step = 6e-5
steps = 100
"""


def write_stand_in(folder: Path) -> None:
    """A simulated test, with noise, of two beams of steel, one after the other along x."""
    elements = {name: _beam(name) for name in PARTS}
    rng = np.random.default_rng(SEED)
    for name, element in elements.items():
        frames = list(places({name: element}))
        _simulate(folder, name, {name: element}, frames, rng)
        interfaces = "".join(
            f"[interfaces.{frame.split('.')[1]}]\nat = {place.tolist()}\n"
            f"channels = {_labels(frame)}\n"
            f"hits = {[f'{label}{axis}' for label in _labels(frame) for axis in 'xyz']}\n"
            for frame, place in places({name: element}).items()
        )
        rigid = element.mass, element.center.tolist(), element.J_rot.tolist()
        text = STAND_IN.format(
            name=name, mass=rigid[0], center=rigid[1], inertia=rigid[2], interfaces=interfaces
        )
        (folder / f"{name}.toml").write_text(text)
    _simulate(folder, "ab", elements, ["a.root", "b.tip"], rng)


def _labels(frame: str) -> list[str]:
    return [f"{frame.split('.')[1]}_{k}" for k in range(len(REACH))]


def _beam(name: str) -> du.Superelement:
    points = np.zeros((31, 3))
    points[:, 0] = np.linspace(*LENGTHS[name], 31)
    width, height = SECTIONS[name]
    section = du.Section.rectangle(STEEL, width=width, height=height, orientation=[0.0, 1.0, 0.0])
    part = du.Beam(points, section=section, name=name)
    for end, place in zip(ENDS[name], points[[0, -1]], strict=True):
        part.interface(end, place)
    part.damping(modal=0.01)
    return part.superelement(step=2e-5, duration=2e-3, method="modal")


def _simulate(
    folder: Path,
    name: str,
    elements: Mapping[str, du.Superelement],
    frames: Sequence[str],
    rng: np.random.Generator,
) -> None:
    """Triaxial sensors at the frames, and hits along x, y and z at the same places."""
    known = places(elements)
    tables: dict[str, list[list[Any]]] = {"channels": [], "hits": []}
    for frame in frames:
        for label, X in zip(_labels(frame), known[frame] + REACH, strict=True):
            for axis, e in zip("xyz", np.eye(3), strict=True):
                tables["channels"].append([label, *X, *e, frame])
                tables["hits"].append([f"{label}{axis}", *X, *e, frame])
    for key, lines in tables.items():
        _write_table(folder / f"{name}_{key}.csv", lines, (*ROW, "interface"))
    count = len(tables["hits"])
    empty = np.zeros((len(STAND_IN_LINES), count, count), dtype=complex)
    np.savez(folder / f"{name}.npz", f=STAND_IN_LINES, H=empty, quantity="accelerance")
    paths = folder / f"{name}.npz", folder / f"{name}_channels.csv", folder / f"{name}_hits.csv"
    test = read_test(paths, known, lambda line, _: line["interface"])
    H = test.outputs @ responses(assembly(elements), test.frames, test.f) @ test.inputs.T
    parts = rng.standard_normal((2, *H.shape)) / np.sqrt(2.0)
    noisy = H * (1.0 + NOISE * (parts[0] + 1j * parts[1]))
    np.savez(folder / f"{name}.npz", f=test.f, H=noisy, quantity="accelerance")


def _parsed(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Tested parts, and a test of both together.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--stand-in", action="store_true", help="write a simulated test first")
    parser.add_argument("--lab", type=Path, help="measurements of pyFBS's laboratory testbench")
    parser.add_argument("--sha256", action="append", default=[], metavar="NAME=DIGEST")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    given = _parsed()
    expected_digests = dict(pair.split("=", 1) for pair in given.sha256)
    main(given.folder, given.stand_in, given.lab, expected_digests)
