"""The order of imports between the rooms of preprocess, and within its meshes."""

import pytest
from import_order import ROOMS, edges, upward


@pytest.mark.parametrize("folder", ["preprocess", "preprocess/mesh"])
def test_no_import_points_upwards(folder, files_and_folders):
    order = ROOMS[folder]
    assert files_and_folders(folder) == set(order), f"{folder}: the order must name all rooms"
    assert upward(edges("preprocess"), tuple(folder.split("/")), order) == []
