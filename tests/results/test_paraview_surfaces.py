"""Surfaces in contact in VTKHDF files, as VTK itself reads them."""

import duhamel as du
import numpy as np
import pytest
from duhamel.preprocess import PlausibilityWarning
from duhamel.results import Results, write_vtk
from duhamel.results.exports.pressed import Pressed
from duhamel.solver import OutputRequest
from duhamel.superelement import Surface
from scipy.spatial.transform import Rotation

from ..surface_bodies import dome
from .test_paraview import Read, field_of, points_of

STEP = 2.5e-7


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A dome that slides on to the ground, and its results."""
    folder = tmp_path_factory.mktemp("dome")
    with pytest.warns(PlausibilityWarning, match="nodes in the shortest wave"):
        element = dome(2e-4, 3, 3, 5e-4).superelement(step=STEP, band=4e5)
    du.superelement.write(element, folder / "dome.h5")
    m = du.Mechanism()
    lowest = float(element.surface("dome").X[:, 2].min())
    body = m.add(
        folder / "dome.h5", name="dome", position=[0, 0, 2e-5 - lowest], velocity=[0.2, 0, -1.0]
    )
    floor = du.contacts.surface(body["dome"], m.ground, shape="plane", axis="z", friction=0.3)
    m.add(floor, name="floor")
    m.simulate(6e-5, STEP, output=folder / "run.h5", record=OutputRequest(nodes=True))
    return Results.read(folder / "run.h5"), element.surface("dome")


def in_space(body, k, X):
    return body.x[k] + Rotation.from_quat(body.R[k], scalar_first=True).apply(X)


def test_vtk_shows_surfaces_with_their_pressure(run, tmp_path):
    results, surface = run
    floor = results.contact("floor")
    k = int(floor.normal_force.argmax())
    paths = write_vtk(results, tmp_path, "run", np.array([0, k]))
    path = next(path for path in paths if path.name == "run-surfaces.vtkhdf")
    file = Read(path)
    np.testing.assert_array_equal(file.times, results.time[[0, k]])
    grid = file.at(results.time[k])
    pressure = field_of(grid, "pressure")[surface.corner_nodes]
    np.testing.assert_allclose(pressure, floor.pressure[k], rtol=1e-6)
    traction = field_of(grid, "traction")[surface.corner_nodes]
    np.testing.assert_allclose(traction, floor.traction[k], rtol=1e-6, atol=1e-3)
    assert traction[:, 0].min() < 0.0
    body = results.body("dome")
    there = in_space(body, k, surface.X + floor.displacement[k])
    np.testing.assert_allclose(points_of(grid), there, rtol=0.0, atol=1e-12)
    # What is pressed lies on the ground.
    assert np.abs(points_of(grid)[surface.corner_nodes[pressure > 0.0], 2]).max() < 2e-6
    at_rest = points_of(file.at(0.0))
    np.testing.assert_allclose(at_rest, body.x[0] + surface.X, rtol=0.0, atol=1e-12)
    names = (tmp_path / "run-names.csv").read_text()
    assert "surfaces,0,floor: dome.dome," in names


def test_magnified_surfaces_move_more(run, tmp_path):
    results, surface = run
    floor, body = results.contact("floor"), results.body("dome")
    k = int(floor.normal_force.argmax())
    *_, path, _ = write_vtk(results, tmp_path, "run", np.array([k]), 50.0)
    there = in_space(body, k, surface.X + 50.0 * floor.displacement[k])
    np.testing.assert_allclose(points_of(Read(path).at(results.time[k])), there, atol=1e-12)


@pytest.mark.parametrize(("kind", "nodes"), [("triangle6", 6), ("quad8", 8), ("quad9", 9)])
def test_middle_nodes_have_the_mean_of_their_corners(kind, nodes):
    triangle = [[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]]
    quad = [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5], [0.5, 0.5]]
    X = np.zeros((nodes, 3))
    X[:, :2] = (triangle if nodes == 6 else quad)[:nodes]
    up = np.tile([0.0, 0.0, 1.0], (nodes, 1))
    surface = Surface("top", np.arange(nodes), X, np.arange(nodes)[None], kind, up, area=1.0)
    linear = 3.0 + 2.0 * X[:, 0] - X[:, 1]
    values = Pressed("c", "b", surface).by_rows @ linear[surface.corner_nodes]
    np.testing.assert_allclose(values, linear)
