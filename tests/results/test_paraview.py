"""VTKHDF files as VTK itself reads them: times, points, fields, cells."""

import errno
import os

import h5py
import numpy as np
import pytest
from duhamel.files.whole_hdf5 import written_whole
from duhamel.results import ExportError, Results, write_vtk
from duhamel.results.exports.vtkhdf import Cells, Grid
from duhamel.results.source import Memory
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersCore import vtkPassThrough
from vtkmodules.vtkIOHDF import vtkHDFReader

from .disc import TIME
from .writing import NOTES, batch, make_contents, make_output

STEPS = np.array([0, 40, 41, 180])


class Read:
    """A file in the hands of VTK, at the times that a pipeline asks for."""

    def __init__(self, path):
        self._reader = vtkHDFReader()
        self._reader.SetFileName(str(path))
        self._end = vtkPassThrough()
        self._end.SetInputConnection(self._reader.GetOutputPort())
        self._end.UpdateInformation()

    @property
    def times(self):
        information = self._reader.GetOutputInformation(0)
        return np.array(information.Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()))

    def at(self, time):
        self._end.UpdateTimeStep(time)
        return self._end.GetOutputDataObject(0)


def points_of(grid):
    return vtk_to_numpy(grid.GetPoints().GetData())


def field_of(grid, name):
    return vtk_to_numpy(grid.GetPointData().GetArray(name))


@pytest.fixture
def results(results_file):
    return Results.read(results_file)


@pytest.mark.parametrize("magnification", [1.0, 30.0])
def test_vtk_shows_the_outlines_of_all_bodies_at_every_time(results, tmp_path, magnification):
    """Of a results file of version 3 without its superelement."""
    path, *_ = write_vtk(results, tmp_path, "disc", STEPS, magnification)
    read = Read(path)
    np.testing.assert_array_equal(read.times, TIME[STEPS])
    for time in reversed(read.times):
        expected = [results.outline_position(b, time, magnification) for b in results.bodies]
        np.testing.assert_allclose(points_of(read.at(time)), np.concatenate(expected), atol=1e-12)


def test_cells_are_those_of_the_outlines_and_say_their_body(results, tmp_path):
    path, *_ = write_vtk(results, tmp_path, "disc", STEPS)
    grid = Read(path).at(TIME[40])
    bodies = vtk_to_numpy(grid.GetCellData().GetArray("body"))
    first, cell = 0, 0
    for number, body in enumerate(results.bodies):
        outline = results.outline(body)
        for row in outline.cells:
            corners = row[row >= 0]
            assert bodies[cell] == number
            ids = grid.GetCell(cell).GetPointIds()
            assert [ids.GetId(i) for i in range(ids.GetNumberOfIds())] == list(first + corners)
            cell += 1
        first += len(outline.points)
    assert grid.GetNumberOfCells() == cell


def test_fields_turn_with_their_bodies(results, tmp_path):
    """Displacements in space have the lengths of those in body axes, and move the points."""
    still, *_ = write_vtk(results, tmp_path, "still", STEPS, 0.0)
    moved, *_ = write_vtk(results, tmp_path, "moved", STEPS, 1.0)
    time = TIME[41]
    grid, apart = Read(moved).at(time), points_of(Read(still).at(time))
    u = field_of(grid, "displacement")
    np.testing.assert_allclose(points_of(grid) - apart, u, atol=1e-9)
    lengths = [results.outline_field(body, time, "displacement") for body in results.bodies]
    np.testing.assert_allclose(np.linalg.norm(u, axis=1), np.concatenate(lengths), rtol=1e-6)
    speeds = [results.outline_field(body, time, "velocity") for body in results.bodies]
    speed = np.linalg.norm(field_of(grid, "velocity"), axis=1)
    np.testing.assert_allclose(speed, np.concatenate(speeds), rtol=1e-6)
    assert grid.GetPointData().GetArray("von_mises") is None


def test_velocities_are_the_rates_of_positions(results):
    rows = np.arange(60, 70)
    moved = results.outline_position("disc", TIME)
    rate = (moved[rows + 1] - moved[rows - 1]) / (TIME[rows + 1] - TIME[rows - 1])[:, None, None]
    found = results.outline_velocity("disc", TIME[rows])
    np.testing.assert_allclose(found, rate, atol=0.02 * np.abs(rate).max())


def test_batches_of_times_give_the_same_file(results, tmp_path, monkeypatch):
    whole, points, _ = write_vtk(results, tmp_path, "whole", STEPS)
    monkeypatch.setattr("duhamel.results.exports.paraview.BATCH_POINTS", 1)
    monkeypatch.setattr("duhamel.results.exports.paraview.SCATTERED_READ_NUMBERS", 1)
    parts, points_in_parts, _ = write_vtk(results, tmp_path, "parts", STEPS)
    for one, other in ((whole, parts), (points, points_in_parts)):
        with h5py.File(one) as a, h5py.File(other) as b:
            for name in ("Points", "PointData/velocity"):
                np.testing.assert_array_equal(a["VTKHDF"][name], b["VTKHDF"][name])


@pytest.fixture(scope="module")
def run():
    contents = make_contents(flexible=0)
    memory = Memory(contents, NOTES, "a model")
    memory.append(batch(make_output(contents, 7), 0, 7))
    return Results(memory)


def test_frames_and_contacts_are_points_with_their_forces(run, tmp_path):
    _, path, names = write_vtk(run, tmp_path, "run", np.array([1, 6]))
    grid = Read(path).at(run.time[6])
    contact = run.contact("k1")
    np.testing.assert_array_equal(points_of(grid)[1], run.frame("b1.tip").position[6])
    np.testing.assert_array_equal(points_of(grid)[3], contact.point[6])
    force = run.frame("b1.tip").force[6]
    np.testing.assert_allclose(field_of(grid, "force")[1], force[:3], rtol=1e-6)
    np.testing.assert_allclose(field_of(grid, "moment")[1], force[3:], rtol=1e-6)
    pushed = contact.force[6, 0] * contact.normal[6]
    np.testing.assert_allclose(field_of(grid, "force")[3], pushed, rtol=1e-6)
    lines = names.read_text().splitlines()
    assert lines[0] == "file,number,name,deformation"
    assert lines[1] == "bodies,0,b0,rigid"
    assert lines[-1] == "points,3,k1,"


def test_a_kilometer_away_points_are_as_exact(tmp_path):
    points = 1e3 + np.random.default_rng(0).normal(size=(1, 4, 3))
    with written_whole(tmp_path / "far.vtkhdf") as file:
        grid = Grid(file, np.array([0.5]), Cells.of_points(4), {})
        grid.put(points, {})
    np.testing.assert_array_equal(points_of(Read(tmp_path / "far.vtkhdf").at(0.5)), points[0])


@pytest.mark.parametrize(
    ("corners", "name"),
    [
        (2, "vtkLine"),
        (3, "vtkTriangle"),
        (4, "vtkQuad"),
        (6, "vtkQuadraticTriangle"),
        (8, "vtkQuadraticQuad"),
        (9, "vtkBiQuadraticQuad"),
    ],
)
def test_each_kind_of_facet_is_that_of_vtk(corners, name, tmp_path):
    rows = np.full((2, 9), -1)
    rows[0, :3], rows[1, :corners] = np.arange(3), np.arange(corners)
    with written_whole(tmp_path / "cells.vtkhdf") as file:
        Grid(file, np.zeros(1), Cells.of_rows(9, rows), {}).put(np.zeros((1, 9, 3)), {})
    cell = Read(tmp_path / "cells.vtkhdf").at(0.0).GetCell(1)
    assert cell.GetClassName() == name
    assert cell.GetNumberOfPoints() == corners


def test_a_run_of_which_nothing_moves_is_refused(tmp_path):
    contents = make_contents(selects=lambda group: group == "energy")
    memory = Memory(contents, NOTES, "")
    memory.append(batch(make_output(contents, 3), 0, 3))
    with pytest.raises(ExportError, match="recorded no body, frame or contact"):
        write_vtk(Results(memory), tmp_path, "run", np.arange(3))


def test_a_full_disk_is_an_error_and_leaves_nothing(tmp_path, monkeypatch):
    """HDF5 itself would bring the process down."""
    path = tmp_path / "run.vtkhdf"
    path.write_text("an earlier one")

    def fails(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def write():
        with written_whole(path) as file:
            file["first"] = np.zeros(1000)
            file.flush()
            monkeypatch.setattr("duhamel.files.whole_hdf5.written", fails)
            file["second"] = np.zeros(100_000)

    with pytest.raises(OSError, match="No space left"):
        write()
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.vtkhdf"]
    assert path.read_text() == "an earlier one"
