"""Whether two states of the sources make the same numbers of the same inputs, bit by bit.

    python tools/compare_results.py OLD NEW                  # checkouts with a .venv each
    python tools/compare_results.py OLD NEW --folder out --inputs models

Both preprocess every body file in meshes/ of OLD and run every model in examples/ of OLD. Then NEW
runs the models once more, on the superelements that OLD wrote, so that the time steps alone are
compared. Prints a table of what differs for each of these three comparisons.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

VARIES = re.compile(r"provenance/timings@|solver@seconds|@version|superelement_file")
"""what differs between runs of one state, or between any two states"""
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


@dataclass
class Comparison:
    """What the arrays of two files have in common."""

    arrays: int = 0
    identical: int = 0
    largest: float = 0.0
    """the largest difference, as a part of the largest entry of its array"""
    place: str = ""
    other: list[str] = field(default_factory=list)
    """arrays that one file lacks, or whose shapes or texts differ"""


def arrays(path: Path) -> dict[str, np.ndarray]:
    """All datasets of a file, and all attributes that are numbers, but for `VARIES`."""
    found: dict[str, np.ndarray] = {}

    def visit(name: str, node: h5py.Group | h5py.Dataset) -> None:
        if isinstance(node, h5py.Dataset):
            value = np.asarray(node[()])
            found[name] = value.astype(str) if value.dtype == object else value
        for key, value in node.attrs.items():
            if np.asarray(value).dtype.kind in "fiub":
                found[f"{name}@{key}"] = np.asarray(value)

    with h5py.File(path) as file:
        file.visititems(visit)
        visit("", file)
    return {name: value for name, value in found.items() if not VARIES.match(name)}


def compare(old: Path, new: Path) -> Comparison:
    first, second = arrays(old), arrays(new)
    result = Comparison(other=[f"only old: {name}" for name in sorted(first.keys() - second)])
    result.other += [f"only new: {name}" for name in sorted(second.keys() - first)]
    for name in sorted(first.keys() & second):
        a, b = first[name], second[name]
        result.arrays += 1
        if a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes():
            result.identical += 1
        elif a.shape != b.shape or a.dtype.kind not in "fiub" or b.dtype.kind not in "fiub":
            result.other.append(f"{name}: {a.dtype}{a.shape}, {b.dtype}{b.shape}")
        elif (difference := relative(a, b)) >= result.largest:
            result.largest, result.place = difference, name
    return result


def relative(a: np.ndarray, b: np.ndarray) -> float:
    """The largest difference of two arrays over their largest entry; infinite where NaN moved."""
    a, b = a.astype(float), b.astype(float)
    if not np.array_equal(np.isfinite(a), np.isfinite(b)):
        return np.inf
    a, b = np.nan_to_num(a), np.nan_to_num(b)
    scale = max(np.abs(a).max(initial=0.0), np.abs(b).max(initial=0.0))
    return float(np.abs(a - b).max(initial=0.0) / scale) if scale else 0.0


def is_model(path: Path) -> bool:
    return "simulation" in tomllib.loads(path.read_text(encoding="utf-8"))


def run(repository: Path, *words: str | Path) -> str:
    """The last line of the error of a command of a repository; nothing if it went well."""
    command = [repository / ".venv/bin/duhamel", *words]
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ | ONE_THREAD)
    return done.stderr.strip().splitlines()[-1] if done.returncode else ""


def preprocess(repository: Path, folder: Path) -> Iterator[tuple[Path, str]]:
    for body in sorted((folder / "meshes").rglob("*.toml")):
        yield body.with_suffix(".h5"), run(repository, "preprocess", body)


def simulate(repository: Path, folder: Path) -> Iterator[tuple[Path, str]]:
    for model in filter(is_model, sorted((folder / "examples").glob("*.toml"))):
        result = model.with_name(f"{model.stem}-results.h5")
        yield result, run(repository, "run", model, "-o", result)


def copied(inputs: Path, folder: Path) -> Path:
    """Meshes and models as they are in a checkout, without what was computed from them."""
    made = shutil.ignore_patterns("*.h5", "*.png", "__pycache__")
    for name in ("meshes", "examples"):
        shutil.copytree(inputs / name, folder / name, ignore=made)
    return folder


def row(name: Path, old: Path, new: Path, failed: str) -> str:
    if failed or not old.exists():
        return f"| {name} | | | | {failed or 'the old state made none'} |"
    found = compare(old, new)
    where = f"{found.largest:.1e} in {found.place}" if found.place else ""
    return f"| {name} | {found.arrays} | {found.identical} | {where} | {'; '.join(found.other)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--inputs", type=Path, help="meshes/ and examples/ of it, not of OLD")
    parser.add_argument("--folder", type=Path, help="where the files are made, and stay")
    chosen = parser.parse_args()

    with tempfile.TemporaryDirectory() as temporary:
        folder = chosen.folder or Path(temporary)
        inputs = chosen.inputs or chosen.old
        old, new = (copied(inputs, folder / name) for name in ("old", "new"))
        for stage in (preprocess, simulate):
            print(f"\n{stage.__name__}\n\n| file | arrays | identical | largest | other |")
            print("|---|---|---|---|---|", flush=True)
            for (first, error), (second, failed) in zip(
                stage(chosen.old, old), stage(chosen.new, new), strict=True
            ):
                print(row(first.relative_to(old), first, second, error or failed), flush=True)
        print("\nsimulate, with the superelements of the old state\n", flush=True)
        same = copied(inputs, folder / "same")
        for path in (old / "meshes").rglob("*.h5"):
            shutil.copy(path, same / path.relative_to(old))
        for second, failed in simulate(chosen.new, same):
            name = second.relative_to(same)
            print(row(name, old / name, second, failed), flush=True)


if __name__ == "__main__":
    sys.exit(main())
