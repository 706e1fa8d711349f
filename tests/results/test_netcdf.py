"""The file in the hands of others: xarray by way of h5netcdf."""

import h5netcdf
import numpy as np
import pytest
import xarray as xr
from duhamel.results.dimensions import DIMENSIONS
from duhamel.results.file import FileWriter
from duhamel.results.motion import EVENT_OWNER, EVENT_QUANTITIES, QUANTITIES

from .writing import NOTES, batch, make_contents, make_events, make_output


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    path, contents = tmp_path_factory.mktemp("netcdf") / "out.nc", make_contents()
    output = make_output(contents, 7)
    writer = FileWriter(path, contents, NOTES, "a model", 7)
    writer.append(batch(output, 0, 3, make_events(contents, 9)))
    writer.append(batch(output, 3, 4))
    writer.flush()
    writer.note(finished=True, seconds=0.5)
    return path, output


def test_xarray_finds_dimensions_coordinates_and_units(written):
    path, output = written
    with xr.open_dataset(path, engine="h5netcdf") as data:
        assert data.sizes == {
            "time": 7,
            "axis": 3,
            "quaternion": 4,
            "body": 2,
            "second_order_coordinate": 3,
            "mode": 5,
            "surface_load": 4,
            "frame": 2,
            "joint": 3,
            "joint_constraint": 5,
            "joint_coordinate": 2,
            "spring": 1,
            "spring_component": 1,
            "flexible_body": 1,
            "contact": 2,
            "surface_contact": 1,
            "surface_row": 3,
            "surface_node": 4,
            "stop": 2,
            "motor": 2,
            "fmu": 1,
            "fmu_input": 2,
            "coupler": 1,
            "contact_axis": 3,
            "tangent_axis": 2,
            "joint_with_friction": 1,
            "pattern": 2,
            "sensor": 3,
            "sensor_channel": 3,
            "event": 9,
            "event_owner": 4,
        }
        assert set(data.coords) == set(data.sizes) == set(DIMENSIONS) - {"check"}
        assert data.attrs["format"] == "duhamel-results"
        assert data.attrs["model"] == "a model"
        for quantity in QUANTITIES:
            variable = data[quantity.name]
            assert variable.dims == quantity.dimensions
            assert variable.attrs["long_name"] == quantity.description
            if isinstance(quantity.unit, str):
                assert variable.attrs["units"] == quantity.unit
        for quantity in (EVENT_OWNER, *EVENT_QUANTITIES):
            assert data[quantity.name].dims == ("event",)
        np.testing.assert_array_equal(data.event, np.arange(9))
        assert data.event_peak.attrs["ancillary_variables"] == "event_peak_units"
        assert data.event_peak_units.sel(event_owner="e1").item() == "N m"
        assert data.stop_gap_units.sel(stop="e0").item() == "m"
        normal = data.contact_force.sel(contact="k1", contact_axis="n")
        np.testing.assert_array_equal(normal, output.contact_force[:, 1, 0])
        moment = data.frame_moment.sel(frame="b1.tip", axis="z")
        np.testing.assert_array_equal(moment, output.frame_moment[:, 2, 2])
        np.testing.assert_allclose(data.time, 0.1 * np.arange(7), rtol=1e-15)
        units = data.joint_multiplier_units
        assert data.joint_multiplier.attrs["ancillary_variables"] == units.name
        assert units.sel(joint_constraint="j2.1").item() == "N"
        assert units.sel(joint_constraint="j0.2").item() == "N m"
        assert data.superelement_file.sel(flexible_body="b0").item() == "/nowhere/0.h5"
    with xr.open_dataset(path, engine="h5netcdf", group="solver") as solver:
        assert solver.attrs["finished"] == 1
        assert solver.attrs["written"] == 7
        assert solver.attrs["assembly_error_at"] == ""


def test_time_is_unlimited_and_nothing_is_outside_netcdf(written):
    """h5netcdf refuses to write what netCDF cannot hold, and says so of what it reads."""
    path, _ = written
    with h5netcdf.File(path) as file:
        unlimited = [name for name, size in file.dimensions.items() if size.isunlimited()]
        assert sorted(unlimited) == ["event", "time"]
        for name, variable in file.variables.items():
            assert variable.dimensions
            assert set(variable.dimensions) <= set(DIMENSIONS), name
            assert variable.dtype == object or variable.dtype in (np.float64, np.int64, str), name
