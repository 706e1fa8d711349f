"""Every command on a part of some 20 000 nodes that is held in a joint and falls on a stand.

Its surface has more points than an animation shows at all instants.
"""

import contextlib
from pathlib import Path

import numpy as np
import pytest
from duhamel.cli import app
from duhamel.results import Results
from duhamel.superelement import read
from typer.testing import CliRunner

from ..preprocess.blocks import box_mesh

pytestmark = pytest.mark.validation

BODY = """
name = "block"
mesh = "block.msh"

[material]
E = 2.1e11
nu = 0.3
rho = 7850

[interfaces.root]
group = "root"

[interfaces.tip]
group = "tip"

[impulse]
step = 2e-5
steps = 100

[recovery]
stress = true
"""
MODEL = """
[simulation]
t_end = 0.02
gravity = [0, 0, -9.81]

[ground]
frames.stand = {position = [1.0, 0, -0.0502]}

[bodies.block]
superelement = "block.h5"
place = {frame = "root", on = "ground"}

[[joints]]
name = "hinge"
type = "revolute"
between = ["ground", "block.root"]
axis = [0, 1, 0]

[[contacts]]
name = "stand"
between = ["ground.stand", "block.tip"]
shape = "plane"
axis = [0, 0, 1]
ball = 0.05
stiffness = 1e8
"""
STUDY = """
model = "fall.toml"
[parameters]
contacts.stand.stiffness = [1e8]
[outputs]
force = "max normal_force:stand"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files of the part and its model, after preprocessing and a run."""
    folder = tmp_path_factory.mktemp("large")
    mesh = box_mesh("hexahedron", (1.0, 0.14, 0.14), (100, 14, 14))
    mesh.write(folder / "block.msh", file_format="gmsh")
    for name, text in (("block", BODY), ("fall", MODEL), ("study", STUDY)):
        (folder / f"{name}.toml").write_text(text)
    for words in ("preprocess block.toml --dry-run", "preprocess block.toml", "run fall.toml"):
        succeed(folder, words)
    return folder


def succeed(folder: Path, words: str) -> str:
    """The output of a command in a folder."""
    with contextlib.chdir(folder):
        result = CliRunner().invoke(app, words.split())
    assert result.exit_code == 0, f"{words}: {result.output}{result.exception!r}"
    return result.output


@pytest.mark.parametrize(
    "words",
    [
        "info block.h5",
        "check fall.toml",
        "peaks fall-results.h5",
        "plot fall-results.h5",
        "plot fall-results.h5 --field von_mises:block",
        "plot fall-results.h5 --field displacement:block --at 0.01",
        "animate fall-results.h5 --at worst",
        "animate fall-results.h5 --frames 2",
        "report fall-results.h5",
        "export fall-results.h5 tables --to csv",
        "export fall-results.h5 matlab --to mat",
        "export fall-results.h5 paraview --to vtk --frames 2",
        "modes fall.toml",
        "frf fall.toml --from force:block.tip:z --to elastic_displacement:block.tip:z",
        "sweep study.toml",
    ],
)
def test_a_command_succeeds(folder, words):
    succeed(folder, words)


def test_the_largest_stress_is_that_of_all_points_and_steps(folder):
    results = Results.read(folder / "fall-results.h5")
    element = read(folder / "block.h5")
    assert len(element.recovery.points) > 4958
    found = results.field_extremes("block", "von_mises")
    over_time = [results.von_mises("block", part).max(axis=1) for part in np.split(results.time, 7)]
    every = np.concatenate(over_time)
    assert found.largest == pytest.approx(every.max(), rel=1e-12)
    assert found.at_largest == every.argmax()
    assert "of the mesh, node " in succeed(folder, "peaks fall-results.h5 von_mises:block")
