"""Models are read and checked before anything is compiled, and compilation says that it happens."""

import os
import subprocess
import sys

import pytest

MODEL = """
[simulation]
t_end = 0.01
step = 1e-3
{settings}

[bodies.disk]
mass = 1.0
inertia = [1, 1, 2]

[[joints]]
name = "pin"
type = "revolute"
between = ["ground", "disk"]
axis = [0, 0, 1]
{joint}

{more}
"""
MISTAKES = {
    "joints: no body": {
        "more": '[[loads]]\ntype = "force"\non = "dish"\ndirection = [1, 0, 0]\nsignal = 1'
    },
    "quantities": {"more": '[output]\nquantities = ["bodies/dish"]'},
    "acceleration": {
        "settings": 'start = "equilibrium"',
        "joint": "angle = {polynomial = [0, 0, 1]}",
    },
}


def run(folder, parts):
    path = folder / "model.toml"
    path.write_text(MODEL.format(**{"settings": "", "joint": "", "more": ""} | parts))
    return subprocess.run(
        [sys.executable, "-c", "from duhamel.cli import app; app()", "run", str(path)],
        env=os.environ | {"DUHAMEL_CACHE": str(folder / "cache")},
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_told_before_anything_is_compiled(mistake, tmp_path):
    done = run(tmp_path, MISTAKES[mistake])
    assert done.returncode == 1
    assert len(done.stderr.strip().splitlines()) == 1
    assert "model.toml" in done.stderr
    assert "compiling" not in done.stderr
    assert not list(tmp_path.glob("cache/*.o"))
