"""Names of curves: every kind of quantity as a person writes it, and what a panel shares."""

from types import SimpleNamespace

import numpy as np
import pytest
from duhamel.results.quantities import KINDS_BY_NAME
from duhamel.results.transforms import Series
from duhamel.view import Curve, naming, title_and_labels

NAMES = {
    ("position:hub:x", "m"): "hub, position along x",
    ("displacement:beam.tip:hub.rim:y", "m"): "beam tip seen from hub rim, displacement along y",
    ("velocity:beam.tip:z", "m/s"): "beam tip, velocity along z",
    ("acceleration:shelf 2.tip:z", "m/s²"): "shelf 2 tip, acceleration along z",
    ("angle:hub:z", "rad"): "hub, angle about z",
    ("angular_velocity:hub:z", "rad/s"): "hub, angular velocity about z",
    ("angular_acceleration:hub", "rad/s²"): "hub, angular acceleration",
    ("elastic_displacement:beam.tip:y", "m"): "beam tip, elastic displacement along y",
    ("elastic_rotation:beam.tip:z", "rad"): "beam tip, elastic rotation about z",
    ("frame_force:beam.tip:x", "N"): "beam tip, force along x",
    ("frame_moment:beam.tip:x", "N m"): "beam tip, moment about x",
    ("force:hinge 1.5:x", "N"): "hinge 1.5, force along x",
    ("moment:hinge:x", "N m"): "hinge, moment about x",
    ("coordinate:hinge:angle", "rad"): "hinge, angle",
    ("coordinate:guide:distance_rate", "m/s"): "guide, rate of distance",
    ("coordinate:hinge:friction_state", "1"): "hinge, friction state",
    ("coupler_force:gear", "N m"): "gear, moment",
    ("gap:ends", "m"): "ends, gap",
    ("dent:ends", "m"): "ends, dent",
    ("normal_force:ends", "N"): "ends, normal force",
    ("normal_force:stop", "N m"): "stop, moment",
    ("impulse:ends", "N s"): "ends, impulse",
    ("impulse:stop", "N m s"): "stop, angular impulse",
    ("friction_force:corner 1:t1", "N"): "corner 1, friction force along t1",
    ("slip:corner 1:t2", "m/s"): "corner 1, slip along t2",
    ("contact_normal:corner 1:z", "1"): "corner 1, normal along z",
    ("contact_point:corner 1:z", "m"): "corner 1, point along z",
    ("contact_state:ends", "1"): "ends, state",
    ("strain:plate.gauge", "1"): "plate gauge, strain",
    ("stress:plate.middle:xx", "Pa"): "plate middle, stress xx",
    ("sensor_displacement:plate.middle:z", "m"): "plate middle, elastic displacement along z",
    ("sensor_acceleration:plate.middle:z", "m/s²"): "plate middle, acceleration along body z",
    ("pattern_load:plate.blast", "1"): "plate blast, amplitude of the load",
    ("pattern_displacement:plate.blast", "J"): "plate blast, elastic displacement under the load",
    ("area:floor", "m²"): "floor, area",
    ("center_of_pressure:floor:x", "m"): "floor, center of pressure along x",
    ("closed_rows:floor", "1"): "floor, closed rows",
    ("largest_pressure:floor", "Pa"): "floor, largest pressure",
    ("motor_torque:servo", "N m"): "servo, torque",
    ("motor_torque:jack", "N"): "jack, force",
    ("motor_reference:servo", "rad"): "servo, reference",
    ("motor_error:servo", "rad"): "servo, error",
    ("motor_power:servo", "W"): "servo, power",
    ("motor_work:servo", "J"): "servo, work",
    ("motor_state:servo", "1"): "servo, state",
    ("linear_momentum:x", "kg m/s"): "momentum along x",
    ("angular_momentum:z", "kg m²/s"): "angular momentum about z",
    ("newton_iterations", "1"): "Newton iterations",
    ("newton_residual", "1"): "Newton residual",
    ("fmu_input:drive:tau", "N m"): "drive, tau",
    ("energy:kinetic", "J"): "kinetic energy",
    ("energy:balance", "J"): "energy balance",
}


def named(quantity, unit="m", treatment=(), run=""):
    kind, *names = quantity.split(":")
    count = len(KINDS_BY_NAME[kind].names)
    names, axis = names[:count], "".join(names[count:])
    found = Series(kind, tuple(names), axis, (), unit, np.zeros(1), np.zeros(1))
    results = SimpleNamespace(bodies=("hub", "beam"))
    words = (naming.kind(found), naming.owner(results, found), axis, *treatment)
    return Curve(words, unit, np.zeros(1), along=KINDS_BY_NAME[kind].preposition, run=run)


@pytest.mark.parametrize(("quantity", "unit"), NAMES)
def test_a_quantity_reads_as_a_person_writes_it(quantity, unit):
    assert naming.in_full(named(quantity, unit)) == NAMES[quantity, unit]


def test_every_kind_of_quantity_is_read():
    assert {quantity.partition(":")[0] for quantity, _ in NAMES} == set(KINDS_BY_NAME)


@pytest.mark.parametrize(
    ("quantities", "title", "labels"),
    [
        (["velocity:hub:x", "velocity:hub:y"], "hub, velocity", ["x", "y"]),
        (["angle:hub:z", "angle:beam.tip:z"], "angle about z", ["hub", "beam tip"]),
        (["angle:hub:x", "angle:beam:z"], "angle", ["hub, x", "beam, z"]),
        (["energy:kinetic", "energy:modal_loss"], "energy", ["kinetic", "modal loss"]),
        (["energy:kinetic", "motor_work:servo"], "", ["kinetic energy", "servo, work"]),
        (["angle:hub:z", "coordinate:A:angle"], "angle", ["hub, z", "A"]),
        (["moment:A:z", "motor_torque:M"], "", ["A, moment about z", "M, torque"]),
        (["angle:hub:z", "angle:hub:z"], "hub, angle about z", ["", ""]),
    ],
)
def test_a_panel_says_once_what_its_curves_share(quantities, title, labels):
    assert title_and_labels([named(one, "N m") for one in quantities]) == (title, labels)


def test_runs_are_named_alone_or_behind_the_quantity():
    one, two = (named("angle:hub:z", run=run) for run in ("paper", "consistent"))
    assert title_and_labels([one, two]) == ("hub, angle about z", ["paper", "consistent"])
    other = named("angle:rim:z", run="paper")
    assert title_and_labels([one, two, other])[1] == [
        "hub (paper)",
        "hub (consistent)",
        "rim (paper)",
    ]


def test_what_was_made_of_a_quantity_is_shared_part_by_part():
    spectra = [
        named("velocity:hub:x", treatment=(f"shock response spectrum, Q = {q}",)) for q in (5, 10)
    ]
    title, labels = title_and_labels(spectra)
    assert title == "hub, velocity along x, shock response spectrum"
    assert labels == ["Q = 5", "Q = 10"]
