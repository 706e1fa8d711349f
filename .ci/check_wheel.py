"""The wheel has every module and file of data, and what is installed from it runs a small model.

python .ci/check_wheel.py build/wheel/duhamel-*.whl
"""

import subprocess
import sys
import tempfile
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]

MODEL = """
[simulation]
t_end = 0.1
step = 1e-3
gravity = [0, 0, -9.81]

[bodies.arm]
mass = 0.2
inertia = [1e-3, 1e-3, 2e-3]
position = [0.5, 0, 0]
frames.end = {position = [-0.5, 0, 0]}

[[joints]]
name = "pivot"
type = "revolute"
between = ["ground", "arm.end"]
axis = [0, 1, 0]
"""


def main(wheel: str) -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    setuptools = settings["tool"]["setuptools"]
    folders = setuptools["package-dir"].items()
    wanted = {
        "/".join((*package.split("."), *path.relative_to(ROOT / folder).parts))
        for package, folder in folders
        for path in (ROOT / folder).rglob("*.py")
    }
    wanted |= set(data(setuptools["package-data"]))
    with zipfile.ZipFile(wheel) as file:
        if missing := sorted(wanted - set(file.namelist())):
            sys.exit(f"{wheel}: no {', '.join(missing)}: see packages in pyproject.toml")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "arm.toml").write_text(MODEL)
        duhamel = Path(sys.executable).with_name("duhamel")
        subprocess.run([duhamel, "run", "arm.toml", "-o", "arm.h5"], cwd=folder, check=True)
        subprocess.run([duhamel, "init", "beam"], cwd=folder, check=True)
        subprocess.run([sys.executable, "-m", "duhamel", "--version"], cwd=folder, check=True)
        place = "import duhamel.solver; print(duhamel.solver.__file__)"
        done = subprocess.run(
            [sys.executable, "-c", place], cwd=folder, check=True, capture_output=True, text=True
        )
        if Path(done.stdout).is_relative_to(ROOT / "solver"):
            sys.exit("the tree was imported, not the wheel")


def data(patterns: dict[str, list[str]]) -> Iterator[str]:
    """Files of data in the wheel, of patterns by packages; "*" stands for all packages."""
    for package, globs in patterns.items():
        if package != "*":
            folder = ROOT.joinpath(*package.split(".")[1:])
            for path in (path for pattern in globs for path in folder.glob(pattern)):
                yield f"duhamel/{path.relative_to(ROOT)}"


if __name__ == "__main__":
    main(*sys.argv[1:])
