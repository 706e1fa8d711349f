"""Simulated hammer tests, beside a bench of their own, and what `duhamel measure` says."""

import re
from dataclasses import replace

import duhamel as du
import numpy as np
import pytest
from duhamel import preprocess
from duhamel.cli import app
from duhamel.preprocess import MeasurementError
from duhamel.preprocess.hammer.bench import bench_of
from duhamel.preprocess.hammer.made_plan import LARGEST_CONDITION_OF_PLAN, facet_middles, made_plan
from duhamel.preprocess.hammer.prediction import predicted_errors
from duhamel.preprocess.hammer.simulation import HammerErrors, hammer_test
from duhamel.preprocess.hammer.struck_part import solids_of, struck_part
from duhamel.preprocess.measured.channels import read_channels
from duhamel.preprocess.measured.frequency_data import read_responses
from duhamel.preprocess.measured.hits import read_hits
from duhamel.preprocess.progress import Stages
from duhamel.superelement import GeneralizedAlpha, sample_kernel
from typer.testing import CliRunner

from .hammer_bench import HITS, SENSORS, STEEL, Errors, angle_mesh, measure, truth, write_tables

NO_ERRORS = HammerErrors(noise=0.0, floor=0.0, angle=0.0, place=0.0, gain=0.0)
PLACES = {f"s{label}": np.array(X) for label, X in SENSORS.items()}
PLACES |= {f"h{label}": np.array(X) for label, (X, _) in HITS.items()}


@pytest.fixture(scope="module")
def angle():
    part = du.Part(angle_mesh(), STEEL, name="angle")
    part.interface("foot", du.plane(z=0.03) & du.box([0.26, 0.0, 0.03], [0.3, 0.05, 0.03]))
    part.interface("top", du.plane(x=0.025) & du.box([0.025, 0.0, 0.115], [0.025, 0.05, 0.15]))
    part.damping(modal=0.01)
    return part.body(step=2e-5, duration=2e-3)


@pytest.fixture(scope="module")
def struck(angle):
    pushes = {f"h{label}": np.array(d, dtype=float) for label, (_, d) in HITS.items()}
    return struck_part(angle, PLACES, pushes, 5000.0, Stages())


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tables")
    write_tables(folder)
    return read_channels(folder / "channels.csv"), read_hits(folder / "hits.csv")


@pytest.mark.parametrize("keys", [{}, {"window": 9.2}, {"mass": 0.008}, {"mass": 0.1}])
def test_responses_are_those_of_a_superelement_with_all_points_as_interfaces(struck, tables, keys):
    bench = measure(Errors(**keys))
    # Modes of that bench have damping of their own, in the order of frequencies up to 6 kHz.
    known = np.interp(struck.modes.omega, truth().element.modes.omega, truth().zeta)
    part = replace(struck, modes=replace(struck.modes, zeta=known))
    window, mass = keys.get("window", 0.0), keys.get("mass", 0.0)
    found = hammer_test(part, *tables, bench.f, NO_ERRORS, window, mass)
    np.testing.assert_allclose(found.H, bench.H, atol=1e-5 * np.abs(bench.H).max())


def test_motion_beside_a_point_is_that_of_the_mesh_there(angle):
    # Within an element, for gradients jump between them.
    middle, along = PLACES["s7"] + [0.012, 0.01, 0.004], np.array([0.6, 0.64, 0.48])
    lengths = 0.0, 2e-3, 4e-3
    points = {f"{length}": middle + length * along for length in lengths}
    struck = struck_part(angle, points, {}, 5000.0, Stages())
    s = 2j * np.pi * np.array([900.0, 3000.0])
    top = struck.at_interface("top")
    errors = []
    for k in (1, 2):
        expected = struck.accelerance(s, struck.at(k, np.zeros(3)), top)
        found = struck.accelerance(s, struck.at(0, lengths[k] * along), top)
        errors.append(np.abs(found - expected).max() / np.abs(expected).max())
    assert errors[1] < 0.01
    assert errors[0] == pytest.approx(0.25 * errors[1], rel=0.1)


def test_the_same_seed_gives_the_same_test(struck, tables):
    f = np.arange(100.0, 400.0, 10.0)
    one, same, other = (
        hammer_test(struck, *tables, f, HammerErrors(seed=seed)).H for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(one, same)
    assert 0.01 < np.linalg.norm(one - other) / np.linalg.norm(one) < 0.2


@pytest.mark.parametrize(
    ("key", "low", "high"),
    [("noise", 0.015, 0.025), ("gain", 0.004, 0.03), ("angle", 0.005, 0.08), ("place", 1e-3, 0.08)],
)
def test_each_error_is_as_large_as_it_says(struck, tables, key, low, high):
    f = np.arange(100.0, 400.0, 10.0)
    value = getattr(HammerErrors(), key)
    clean = hammer_test(struck, *tables, f, NO_ERRORS).H
    off = hammer_test(struck, *tables, f, replace(NO_ERRORS, **{key: value})).H
    assert low < np.linalg.norm(off - clean) / np.linalg.norm(clean) < high


def test_cords_make_six_resonances_below_the_first_mode(struck, tables):
    f = np.arange(0.5, 60.0, 0.05)
    H = hammer_test(struck, *tables, f, replace(NO_ERRORS, cords=8.0)).H
    level = np.sqrt((np.abs(H) ** 2).mean(axis=(1, 2)))
    peaks = np.flatnonzero((level[1:-1] > level[:-2]) & (level[1:-1] > level[2:])) + 1
    assert 3 <= len(peaks) <= 6
    # All of its translations would be at 8 Hz if the cords were at its center.
    assert 2.0 < f[peaks[0]] < 8.0 < f[peaks[-1]] < 40.0


def test_plans_push_and_turn_each_interface_about_all_axes(angle):
    source = solids_of(angle)
    frames = preprocess.assemble(angle).frames
    plan = made_plan(source, frames)
    X, d = plan.surface.points, plan.surface.inwards
    for name, one in plan.interfaces.items():
        assert (len(one.sensors), len(set(one.hits.tolist()))) == (3, 9)
        levers = X[one.hits] - frames[name].X
        W = np.hstack(
            [d[one.hits], np.cross(levers, d[one.hits]) / np.linalg.norm(levers, axis=1).max()]
        )
        assert np.linalg.cond(W) < 2.0 * LARGEST_CONDITION_OF_PLAN
    chosen = [*plan.sensors, *plan.hits, *(k for i in plan.interfaces.values() for k in i.hits)]
    assert len(set(chosen)) == len(chosen)


def test_hits_push_into_the_part(angle):
    source = solids_of(angle)
    surface = facet_middles(source)
    inside = surface.points + 1e-4 * surface.inwards
    low = np.array([0.0, 0.0, 0.0])
    assert (inside[:, 1] > low[1]).all()
    assert (inside[:, 1] < 0.05).all()
    np.testing.assert_allclose(np.linalg.norm(surface.inwards, axis=1), 1.0)
    # A closed surface: the sum of areas times normals would vanish; of points, each has a far side.
    struck_part(angle, {f"{k}": X for k, X in enumerate(inside[::40])}, {}, 500.0, Stages())


def test_measure_makes_a_plan_that_preprocess_takes(angle, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    preprocess.write_body(angle, "angle.toml")
    run = CliRunner().invoke
    made = run(app, ["measure", "angle.toml", "--band", "20", "3000", "--lines", "600"])
    assert made.exit_code == 0, made.output
    assert sorted(path.name for path in (tmp_path / "angle-test").iterdir()) == [
        "angle.uff",
        "channels.csv",
        "hits.csv",
        "tested.toml",
    ]
    element = preprocess.build(preprocess.read_body("angle-test/tested.toml"))
    assert 186.0 < element.modes.frequencies.min() < 186.6
    # By its plan, without errors and as arrays, the same part.
    again = run(
        app,
        [
            *("measure", "angle.toml", "--plan", "angle-test/tested.toml", "-o", "again.npz"),
            *("--noise", "0", "--angle", "0", "--place", "0", "--gain", "0", "--lines", "600"),
        ],
    )
    assert again.exit_code == 0, again.output
    plan = preprocess.read_body("angle-test/tested.toml")
    channels, hits = read_channels(plan.measured.channels), read_hits(plan.measured.hits)
    exact, noisy = (
        read_responses(path, None, channels, hits, 0.0)
        for path in (tmp_path / "again.npz", plan.measured.frf)
    )
    np.testing.assert_allclose(exact.f, noisy.f, rtol=1e-6)
    assert 0.01 < np.linalg.norm(exact.H - noisy.H) / np.linalg.norm(exact.H) < 0.3


def test_predictions_tell_what_fewer_errors_are_worth(angle, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "160")
    preprocess.write_body(angle, "angle.toml")
    run = CliRunner().invoke
    common = ["measure", "angle.toml", "--band", "20", "2500", "--lines", "500", "--predict", "1"]
    rows = [
        run(app, [*common, "--place", str(place), "--angle", "0", "--gain", "0"]).output
        for place in (0.0, 4e-3)
    ]
    shares = [float(re.search(r"([\d.]+), [\d.]+, [\d.]+ %", row)[1]) for row in rows]
    assert re.search(r"as made +│ +24 +│ +21 +│", rows[0])
    assert 3.0 * shares[0] < shares[1]
    assert [path.name for path in tmp_path.iterdir() if path.is_dir()] == []


def test_what_cannot_be_tested_is_refused(angle, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    preprocess.write_body(angle, "angle.toml")
    undamped = angle.model_copy(update={"damping": type(angle.damping)()})
    preprocess.write_body(undamped, "undamped.toml")
    steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0)], section=section, name="beam")
    beam.interface("tip", (0.5, 0.0, 0.0))
    preprocess.write_body(beam.body(step=1e-4), "beam.toml")
    (tmp_path / "there").mkdir()
    for arguments, said in (
        (
            ["beam.toml"],
            "beam.toml: expected a mesh of solids, whose surface a hammer hits, found a mesh with",
        ),
        (
            ["undamped.toml", "--band", "20", "500"],
            "undamped.toml: damping: a part that is tested needs some",
        ),
        (["angle.toml", "-o", "there"], "there exists, and may be what was measured"),
        (["angle.toml", "--plan", "angle.toml"], "expected a plan"),
    ):
        result = CliRunner().invoke(app, ["measure", *arguments])
        assert result.exit_code == 1
        assert said in result.output
    for arguments, said in (
        (["angle.toml", "--format", "mat"], "uff or npz"),
        (["angle.toml", "--plan", "a.toml", "--plan", "b.toml"], "several plans"),
        (["angle.toml", "--plan", "a.toml", "--window", "3"], "those of the --plan"),
    ):
        result = CliRunner().invoke(app, ["measure", *arguments])
        assert result.exit_code == 2
        assert said in " ".join(result.output.replace("│", " ").split())


def test_a_place_that_the_mesh_lacks_is_named(angle):
    with pytest.raises(MeasurementError, match="sensor 9: expected a point within the body"):
        struck_part(angle, {"sensor 9": np.array([0.1, 0.0, 0.1])}, {}, 500.0, Stages())


@pytest.mark.parametrize(
    ("key", "sensors", "hits"),
    [("angle", True, True), ("place", True, True), ("gain", True, False)],
)
def test_errors_are_those_of_sensors_and_of_hits(struck, tables, key, sensors, hits):
    """Far below the first resonance, where no rigid motion explains what is off."""
    value = getattr(HammerErrors(), key)
    f = np.array([2.0])
    H = hammer_test(struck, *tables, f, replace(NO_ERRORS, **{key: value})).H[0].real
    channels, hits_table = tables
    for table, A, wrong in ((channels, H, sensors), (hits_table, H.T, hits)):
        X, e = table.points - struck.rigid.center, table.directions
        R = np.hstack([e, np.cross(X, e)])
        left = A - R @ np.linalg.pinv(R) @ A
        share = np.linalg.norm(left) / np.linalg.norm(A)
        assert (share > 2e-3) == wrong
        assert wrong or share < 5e-4


def test_points_beside_those_of_the_mesh_are_told_before_anything_is_predicted(angle, tmp_path):
    preprocess.write_body(angle, tmp_path / "angle.toml")
    path = measure().write(tmp_path)
    plan = preprocess.read_body(path)
    moved = replace_at(plan, "foot", [0.28, 0.025, 0.0])
    told = [doubt for doubt in bench_of(angle, moved, Stages()).doubts(F) if "interfaces" in doubt]
    assert told == [
        "interfaces.foot.at: the mesh has it at [0.28, 0.025, 0.03], the plan 30 mm from there"
    ]
    renamed = plan.model_copy(update={"interfaces": {"head": plan.interfaces["foot"]}})
    with pytest.raises(MeasurementError, match=r"interfaces\.head: the mesh has none; there are: "):
        bench_of(angle, renamed, Stages())


F = np.arange(20.0, 500.0, 1.0)


def replace_at(plan, name, at):
    point = plan.interfaces[name].model_copy(update={"at": tuple(at)})
    return plan.model_copy(update={"interfaces": plan.interfaces | {name: point}})


def test_one_mode_that_is_missing_does_not_shift_the_others(struck):
    """Eight modes of which one was not found, and two that are none of the part."""
    true = np.sort(struck.modes.resonances)[:8]
    found = np.concatenate([np.delete(true, 3), true[-1] * np.array([1.1, 1.2])])
    modes = replace(
        struck.modes,
        omega=found,
        zeta=np.full(9, 0.01),
        phi=np.zeros((len(struck.modes.phi), 9)),
    )
    part = replace(
        struck, modes=replace(struck.modes, omega=true, zeta=np.full(8, 0.01), phi=modes.phi[:, :8])
    )
    element = du.Superelement(
        name="found",
        mass=part.rigid.mass,
        J_rot=part.rigid.inertia,
        center=part.rigid.center,
        interfaces=part.interfaces,
        kernel=sample_kernel(modes, 2e-5, GeneralizedAlpha(), 10, 0.0, 4000.0),
        modes=modes,
        compliance=modes.compliance,
        accelerance=modes.accelerance,
    )
    errors = predicted_errors(part, element, 20.0)
    assert (errors.found, errors.modes) == (7, 8)
    assert errors.frequency < 1e-12
