"""Quantities by name, what the default picture shows, and what stands on the panels."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel import view
from duhamel.results import Results
from duhamel.view.naming import in_full

from ..results.disc import ANGLE, TIME, TRAVEL


@pytest.fixture
def results(results_file):
    return Results.read(results_file)


def words(curves):
    return [in_full(curve) for curve in curves]


def test_a_quantity_with_an_axis_is_one_curve(results):
    (curve,) = view.curves(results, "displacement:beam.tip:disc.rim:y")
    assert curve.words == ("displacement", "beam tip seen from disc rim", "y")
    assert curve.unit == "m"
    np.testing.assert_allclose(curve.values, TRAVEL[:, 1] - TRAVEL[0, 1], rtol=0, atol=1e-15)


def test_without_an_axis_components_that_are_zero_are_left_out(results):
    assert words(view.curves(results, "angle:disc")) == ["disc, angle about z"]
    assert words(view.curves(results, "elastic_rotation:beam.tip")) == [
        f"beam tip, elastic rotation about {axis}" for axis in "xyz"
    ]
    assert len(view.curves(results, "velocity:beam")) == 3


def test_an_energy_has_no_axis(results):
    (curve,) = view.curves(results, "energy:elastic")
    assert curve.words == ("energy", "elastic", "")
    with pytest.raises(view.QuantityError, match=r"energy:elastic:x: expected energy:ENERGY$"):
        view.curves(results, "energy:elastic:x")


@pytest.mark.parametrize(
    ("quantity", "message"),
    [
        ("speed:disc", "speed:disc: no quantity 'speed'; there are: position:BODY|FRAME"),
        ("von_mises:beam", "von_mises:beam: a field .* `duhamel peaks .* plot .* --field"),
        ("angle", r"angle: expected angle:BODY|FRAME\[:x|y|z\]"),
        ("angle:disc:w", r"angle:disc:w: expected angle"),
        (
            "displacement:beam.tip:y",
            "displacement:beam.tip:y: no body or frame 'y'; there are: beam, disc",
        ),
        ("angle:wheel:z", "angle:wheel:z: no body or frame 'wheel'; there are: beam, disc"),
    ],
)
def test_a_quantity_that_is_not_there(results, quantity, message):
    with pytest.raises(view.QuantityError, match=message.replace("|", r"\|")):
        view.curves(results, quantity)


@pytest.mark.parametrize(
    ("quantity", "unit", "count"),
    [
        ("coordinate:clamp:angle", "rad", 1),
        ("coordinate:clamp:angle_rate", "rad/s", 1),
        ("linear_momentum", "kg m/s", 3),
    ],
)
def test_units_of_coordinates_and_momenta(results, quantity, unit, count):
    found = view.curves(results, quantity)
    assert [curve.unit for curve in found] == [unit] * count


def test_rounding_on_a_level_is_not_magnified(results):
    curve = view.curves(results, "energy:kinetic")[0]
    level = replace(curve, values=20.0 + 1e-9 * np.sin(results.time))
    low, high = view.draw(results.time, [[level]]).axes[0].get_ylim()
    assert high - low >= 1e-4 * 20.0
    assert low < 20.0 < high


def test_the_overview_of_a_flexible_model(results):
    angle, bent, speed, energies, balance = view.overview(results)
    assert words(angle) == ["clamp, angle"]
    assert words(bent) == [f"beam tip, elastic displacement along {axis}" for axis in "xyz"]
    assert words(speed) == ["disc, angular velocity about z"]
    assert words(energies) == ["kinetic energy", "work from outside"]
    assert words(balance) == ["energy balance"]


def without_joints(file):
    for name in list(file):
        if name.startswith("joint"):
            del file[name]


def test_the_overview_shows_positions_where_no_joint_has_a_coordinate(edit):
    travel, *_ = view.overview(Results.read(edit(without_joints)))
    assert words(travel) == ["beam, position along x", "beam, position along y"]


def test_the_overview_shows_velocities_where_positions_would_be_levels(edit):
    """A kilometer from the origin the way of a second cannot be seen."""

    def far(file):
        without_joints(file)
        file["body_position"][:, 0] += [1000.0, 0.0, 0.0]
        file["body_velocity"][:, 0, 1] = TIME

    travel, *others = view.overview(Results.read(edit(far)))
    assert words(travel) == ["beam, velocity along y"]
    assert not any("velocity along" in word for panel in others for word in words(panel))


def test_the_overview_leaves_out_what_was_not_recorded(edit):
    def energies_alone(file):
        for name in list(file):
            kind = name.partition("_")[0]
            others = {"body", "frame", "joint", "spring", "linear", "angular"}
            if kind in others and name != "spring_energy":
                del file[name]

    def no_energies(file):
        for name in list(file):
            if "energy" in name or name in ("external_work", "numerical_dissipation"):
                del file[name]

    results = Results.read(edit(energies_alone))
    energies, balance = view.overview(results)
    assert words(balance) == ["energy balance"]
    assert all(curve.words[0] == "energy" for curve in energies)
    for quantity, message in (
        ("angle:disc", "no body or frame 'disc'; there are: none"),
        ("linear_momentum", "no momentum 'linear'; there are: none"),
    ):
        with pytest.raises(view.QuantityError, match=message):
            view.curves(results, quantity)
    with pytest.raises(
        view.QuantityError, match="there is nothing that is shown unasked: name quantities"
    ):
        view.overview(Results.read(edit(no_energies)))


def test_the_overview_shows_velocities_where_nothing_turns(edit):
    def stop(file):
        file["body_angular_velocity"][:] = 0.0
        file["body_velocity"][:, 0, 0] = TIME

    *_, speed, _, _ = view.overview(Results.read(edit(stop)))
    assert words(speed) == ["beam, velocity along x"]


def test_titles_say_what_curves_share_and_legends_what_they_do_not(results):
    panel = [*view.curves(results, "angle:disc:z"), *view.curves(results, "angle:beam.tip:z")]
    figure = view.draw(results.time, [panel], "disc")
    (axes,) = figure.axes
    assert axes.get_title("left") == "angle about z"
    assert axes.get_ylabel() == "[rad]"
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["disc", "beam tip"]
    np.testing.assert_allclose(axes.lines[0].get_ydata(), ANGLE, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("quantity", "unit", "factor"),
    [
        ("elastic_displacement:beam.tip:x", "[mm]", 1e3),
        ("energy:balance", "[nJ]", 1e9),
        ("energy:potential", "[J]", 1.0),
        ("angular_acceleration:disc:z", "[rad/s²]", 1.0),
        ("energy:kinetic", "[kJ]", 1e-3),
    ],
)
def test_prefixes_make_numbers_easy_to_read(results, quantity, unit, factor):
    (curve,) = view.curves(results, quantity)
    (axes,) = view.draw(results.time, [[curve]]).axes
    assert axes.get_ylabel() == unit
    np.testing.assert_allclose(axes.lines[0].get_ydata(), factor * curve.values, rtol=1e-14)


def test_a_panel_has_one_unit(results):
    panel = [*view.curves(results, "angle:disc:z"), *view.curves(results, "energy:work")]
    with pytest.raises(
        view.PictureError, match=r"found disc, angle about z \[rad\] and work from outside \[J\]"
    ):
        view.draw(results.time, [panel])


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_pictures_are_written_in_the_format_of_their_name(results, tmp_path, suffix):
    target = tmp_path / f"picture.{suffix}"
    view.save(view.draw(results.time, view.overview(results)), target)
    assert target.read_bytes().startswith(
        {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[suffix]
    )


def test_a_picture_that_cannot_be_written(results, tmp_path):
    figure = view.draw(results.time, view.overview(results))
    with pytest.raises(
        view.PictureError, match=r"picture.h5: expected a suffix of .*png.*, found '.h5'"
    ):
        view.save(figure, tmp_path / "picture.h5")
    with pytest.raises(view.PictureError, match="no folder"):
        view.save(figure, tmp_path / "absent/picture.png")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["disc-results.h5"]


def test_short_runs_have_their_time_in_milliseconds(results):
    curve = view.curves(results, "energy:kinetic")[0]
    for span, label, factor in ((0.3, "time [s]", 1.0), (4e-3, "time [ms]", 1e3)):
        time = np.linspace(0.0, span, len(curve.values))
        (axes,) = view.draw(time, [[curve]]).axes
        assert axes.get_xlabel() == label
        np.testing.assert_allclose(axes.lines[0].get_xdata(), factor * time, rtol=1e-14)


def test_a_coordinate_is_not_seen_from_anywhere(results):
    (curve,) = view.curves(results, "coordinate:clamp:angle")
    assert curve.words == ("angle", "clamp", "")
