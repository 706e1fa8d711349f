"""The order of imports between the rooms of the solver."""

from import_order import ROOMS, edges, upward


def test_no_import_points_upwards(files_and_folders):
    order = ROOMS["solver"]
    assert files_and_folders("solver") == set(order), "solver: the order must name all rooms"
    assert upward(edges("solver"), ("solver",), order) == []


def test_the_time_step_knows_nothing_of_models():
    """It can be read by itself, and an edit elsewhere compiles nothing anew."""
    imported = [target for module, target in edges("solver") if module[1] == "step"]
    assert {target[1] for target in imported if target[0] == "solver"} == {
        "arrays",
        "compiler",
        "laws",
        "step",
    }
    # The records of quantities, from which the output of a step is allocated.
    assert {target for target in imported if target[0] != "solver"} == {("results", "motion")}
