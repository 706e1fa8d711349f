"""A run with a beam of the library and a stop, whose names try to leave the page."""

from pathlib import Path

import pytest
from duhamel import preprocess, solver
from duhamel.results import Results

ROOT = Path(__file__).parents[3]
EVIL = "<img src=x onerror=alert(1)>"
MODEL = f"""# A beam on a hub </script></style></title></pre> & more.
# It swings against a stop.
[simulation]
t_end = 0.03
gravity = [0, -9.81, 0]

[bodies.hub]
mass = 1.0
inertia = [0.01, 0.01, 0.01]
frames.rim = {{position = [0.05, 0, 0]}}

[bodies.beam]
superelement = "beam.h5"
place = {{frame = "root", on = "hub.rim"}}

[[joints]]
name = "{EVIL}"
type = "revolute"
between = ["ground", "hub"]
axis = [0, 0, 1]

[[joints]]
name = "clamp"
type = "fixed"
between = ["hub.rim", "beam.root"]

[[stops]]
name = "buffer <b>"
joint = "{EVIL}"
coordinate = "angle"
range = [-0.002, inf]
stiffness = 1e4
"""


@pytest.fixture(scope="session")
def beam_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from duhamel import superelement

    path = tmp_path_factory.mktemp("beam") / "beam.h5"
    body = preprocess.read_body(ROOT / "meshes/beam/beam.toml")
    superelement.write(path, preprocess.build(body))
    return path


@pytest.fixture(scope="session")
def run_file(beam_file: Path) -> Path:
    """The results of the model beside the beam."""
    model = beam_file.with_name("swing.toml")
    model.write_text(MODEL)
    results = beam_file.with_name("swing-results.h5")
    solver.simulate(solver.read_model(model), output=results)
    return results


@pytest.fixture(scope="session")
def results(run_file: Path) -> Results:
    return Results.read(run_file)


@pytest.fixture(scope="session")
def page_file(results: Results, tmp_path_factory: pytest.TempPathFactory) -> Path:
    from duhamel import view

    path = tmp_path_factory.mktemp("page") / "a page.html"
    view.write_report(results, path)
    return path
