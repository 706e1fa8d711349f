"""Fits to measured series: parameters and their deviations against an oscillator's closed form."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from duhamel.cli import app
from duhamel.solver import read_model, simulate
from duhamel.study import Parameter, StudyError, fit, fit_model
from duhamel.study.covariance import covariance_of
from typer.testing import CliRunner

MASS, STIFFNESS, DAMPING, SHIFT, NOISE = 2.0, 800.0, 1.5, 0.013, 2e-4
TIME = np.arange(0.05, 1.5, 0.005)
MODEL = """
[simulation]
t_end = 1.5
step = 2e-3
[bodies.mass]
mass = 2.0
inertia = [1, 1, 1]
position = [0.02, 0, 0]
[ground.frames.wall]
position = [0, 0, 0]
[[joints]]
type = "prismatic"
between = ["ground.wall", "mass"]
axis = [1, 0, 0]
[[springs]]
name = "mount"
type = "bushing"
between = ["ground.wall", "mass"]
axis = [0, 0, 1]
second_axis = [1, 0, 0]
stiffness = [700, 0, 0, 0, 0, 0]
damping = [1, 0, 0, 0, 0, 0]
rest = [0, 0, 0, 0, 0, 0]
"""
STUDY = """
model = "mount.toml"
[parameters]
k = {log_uniform = [300, 3000]}
springs.mount.damping.0 = {uniform = [0, 10]}
[derived]
springs.mount.stiffness.0 = "k"
[fit]
shift = true
[[fit.series]]
quantity = "position:mass:x"
file = "tip.csv"
time = "time"
column = "tip"
sigma = 2e-4
"""


def swing(k=STIFFNESS, c=DAMPING, shift=SHIFT, t=TIME):
    omega, zeta = np.sqrt(k / MASS), 0.5 * c / np.sqrt(k * MASS)
    damped, t = omega * np.sqrt(1.0 - zeta**2), t - shift
    rest = zeta * omega / damped
    return 0.02 * np.exp(-zeta * omega * t) * (np.cos(damped * t) + rest * np.sin(damped * t))


def write_tip(folder, values):
    rows = np.column_stack([TIME, values])
    np.savetxt(folder / "tip.csv", rows, delimiter=",", header="time,tip", comments="")


@pytest.fixture
def bench(tmp_path):
    (tmp_path / "mount.toml").write_text(MODEL)
    (tmp_path / "study.toml").write_text(STUDY)
    write_tip(tmp_path, swing())
    return tmp_path


def changed(folder: Path, old: str, new: str) -> Path:
    text = (folder / "study.toml").read_text()
    assert old in text
    (folder / "study.toml").write_text(text.replace(old, new))
    return folder / "study.toml"


def test_exact_series_give_the_parameters_and_their_deviations(bench):
    found = fit(bench / "study.toml", bench / "fitted.toml")
    k, c, shift = found.parameters
    truth = np.array([STIFFNESS, DAMPING, SHIFT])
    # As exact as steps of 2 ms integrate it.
    np.testing.assert_allclose([k.value, c.value, shift.value], truth, rtol=2e-3)
    steps = 1e-5 * truth
    J = np.array(
        [(swing(*(truth + d)) - swing(*(truth - d))) / (2.0 * d.max()) for d in np.diag(steps)]
    ).T
    covariance = NOISE**2 * np.linalg.inv(J.T @ J)
    expected = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose([p.deviation for p in found.parameters], expected, rtol=0.01)
    np.testing.assert_allclose(
        found.correlation, covariance / np.outer(expected, expected), atol=0.01
    )
    assert found.rank == 3
    assert list(found.notes) == []
    model = read_model(bench / "fitted.toml")
    assert model.springs[0].stiffness[0, 0] == k.value
    np.testing.assert_allclose(
        np.interp(TIME - shift.value, (run := simulate(model)).time, run.body("mass").x[:, 0]),
        found.fitted[0],
        atol=1e-12,
    )


def test_deviations_cover_the_truth(bench):
    """Of tests with noise about two thirds lie within one deviation, and all within 4."""
    changed(bench, "shift = true\n", "")
    rng, errors = np.random.default_rng(4), []
    write_tip(bench, swing(shift=0.0))
    exact = fit(bench / "study.toml")
    for _ in range(8):
        noisy = swing(shift=0.0) + rng.normal(scale=NOISE, size=len(TIME))
        write_tip(bench, noisy)
        found = fit(bench / "study.toml")
        errors += [
            (one.value - true.value) / one.deviation
            for one, true in zip(found.parameters, exact.parameters, strict=True)
        ]
    assert 7 <= np.sum(np.abs(errors) < 1.0) <= 14
    assert np.abs(errors).max() < 4.0


def test_without_sigma_the_noise_is_that_of_the_residuals(bench):
    noisy = swing() + np.random.default_rng(2).normal(scale=NOISE, size=len(TIME))
    write_tip(bench, noisy)
    known = fit(bench / "study.toml")
    free = fit(changed(bench, "sigma = 2e-4\n", ""))
    for one, other in zip(known.parameters, free.parameters, strict=True):
        assert one.value == pytest.approx(other.value, rel=1e-5)
        assert one.deviation == pytest.approx(other.deviation, rel=0.15)
    assert free.rms[0] == pytest.approx(NOISE, rel=0.1)


def test_what_the_series_do_not_tell_is_told(bench):
    changed(bench, "[derived]", "bodies.mass.inertia.1 = {uniform = [0.5, 1.5]}\n[derived]")
    changed(bench, "[300, 3000]", "[300, 750]")
    found = fit(bench / "study.toml")
    assert found.rank == 3
    assert found.parameters[2].deviation == np.inf
    notes = list(found.notes)
    assert "the series tell 3 of 4 combinations of the parameters" in notes[0]
    assert "k is at a bound, 750" in notes
    assert any("times sigma: the model does not move as the test did" in note for note in notes)


def test_series_come_from_results_and_uff(bench):
    import pyuff

    model = read_model(bench / "mount.toml").with_settings(t_end=1.0)
    run = simulate(model, output=bench / "truth.h5")
    record = {
        **pyuff.prepare_58(
            binary=0,
            func_type=1,
            rsp_node=1,
            rsp_dir=1,
            ref_node=1,
            ref_dir=1,
            data=run.body("mass").x[:, 0],
            x=run.time,
            id1="tip",
            abscissa_spec_data_type=17,
            ordinate_spec_data_type=8,
            orddenom_spec_data_type=0,
            abscissa_inc=1e-3,
            abscissa_min=0.0,
            abscissa_spacing=1,
            num_pts=len(run.time),
        )
    }
    pyuff.UFF(str(bench / "tip.uff")).write_sets([record], mode="add")
    changed(bench, "shift = true\n", "")
    csv = 'file = "tip.csv"\ntime = "time"\ncolumn = "tip"\n'
    found = fit(changed(bench, csv, 'file = "truth.h5"\n'))
    assert [p.value for p in found.parameters] == pytest.approx([700.0, 1.0], rel=1e-6)
    found = fit(changed(bench, 'file = "truth.h5"\n', 'file = "tip.uff"\ncolumn = 1\n'))
    assert [p.value for p in found.parameters] == pytest.approx([700.0, 1.0], rel=1e-3)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("[fit]\nshift = true\n", "", None),
        ('column = "tip"', 'column = "top"', "fit.series.0: .*tip.csv: no column 'top'"),
        ("position:mass:x", "position:mass", "is of a vector: expected an axis"),
        ("position:mass:x", "position:block:x", "study.toml: fit.series.0.quantity: .*'block'"),
        ("position:mass:x", "psd(position:mass:x)", "is over Hz: expected one over s"),
        ("[300, 3000]", "[3000, 300]", "expected two positive numbers that rise"),
        (
            "{uniform = [0, 10]}",
            "{uniform = [2, 10]}",
            "expected a start between 2 and 10",
        ),
        (
            "[[fit.series]]\nq",
            '[[fit.series]]\nscale = "2"\nq',
            "fit.series.0.scale: .*number, found",
        ),
    ],
)
def test_what_is_wrong_is_named(old, new, told, bench):
    path = changed(bench, old, new)
    if told is None:
        path = changed(bench, (bench / "study.toml").read_text().partition("[[fit")[2], "")
        path = changed(bench, "[[fit", "")
        told = "expected the table .fit. with"
    with pytest.raises(StudyError, match=told) as error:
        fit(path)
    assert str(path) in str(error.value)


def test_the_name_of_the_shift_is_its_own(bench):
    changed(bench, "k = {", "shift = {")
    with pytest.raises(StudyError, match=r"parameters.shift: is the time shift"):
        fit(changed(bench, '"k"', '"shift"'))


def test_series_must_lie_within_the_run(bench):
    (bench / "mount.toml").write_text(MODEL.replace("t_end = 1.5", "t_end = 1.0"))
    with pytest.raises(StudyError, match=r"to 1.495 s, and the run goes from 0 s to 1 s"):
        fit(bench / "study.toml")


def test_the_command_writes_the_model_and_a_picture(bench):
    command = ["fit", str(bench / "study.toml")]
    shown = CliRunner().invoke(app, command)
    assert shown.exit_code == 0, shown.output
    assert "deviation" in shown.output
    assert (bench / "study-fitted.toml").exists()
    assert (bench / "study-fitted.png").stat().st_size
    refused = CliRunner().invoke(app, [*command, "-o", str(bench / "mount.toml")])
    assert refused.exit_code == 1
    assert (bench / "mount.toml").read_text() == MODEL


def test_what_stands_for_a_sum_alone_is_not_known(bench):
    changed(bench, "[300, 3000]}", "[300, 3000]}\nadded = {uniform = [-100, 100]}")
    changed(bench, '"k"', '"k + added"')
    found = fit(bench / "study.toml")
    by_name = {one.name: one for one in found.parameters}
    assert found.rank == 3
    assert by_name["k"].deviation == by_name["added"].deviation == np.inf
    assert by_name["springs.mount.damping.0"].deviation < 0.1
    assert by_name["k"].value + by_name["added"].value == pytest.approx(STIFFNESS, rel=2e-3)


def test_two_samples_do_not_tell_three_parameters(bench):
    rows = "\n".join(f"{t}, {swing(t=t)}" for t in (0.1, 0.3))
    (bench / "tip.csv").write_text(f"time, tip\n{rows}\n")
    found = fit(changed(bench, "sigma = 2e-4\n", ""))
    assert found.rank == 2
    assert all(one.deviation == np.inf for one in found.parameters)


def test_residuals_that_are_met_exactly_tell_nothing_of_the_noise():
    J, residuals = np.diag([2.0, 4.0]), np.zeros(2)
    unknown = covariance_of(J, residuals, noise_is_known=False)
    assert (unknown.deviations == np.inf).all()
    known = covariance_of(J, residuals, noise_is_known=True)
    np.testing.assert_allclose(known.deviations, [0.5, 0.25])


def test_a_search_that_has_not_ended_is_told(bench, monkeypatch):
    monkeypatch.setattr(import_module("duhamel.study.fit"), "MOST_SEARCH_STEPS", 2)
    first = next(fit(bench / "study.toml").notes)
    assert first == "the search has not ended: begin nearer, or fix parameters"


def test_a_shift_keeps_all_samples_within_the_run(bench):
    """The series lags by more than it begins after the run."""
    rows = np.column_stack([TIME[TIME < 1.4], swing(shift=0.09, t=TIME[TIME < 1.4])])
    np.savetxt(bench / "tip.csv", rows, delimiter=",", header="time,tip", comments="")
    found = fit(bench / "study.toml")
    assert found.parameters[-1].value == pytest.approx(0.05, abs=1e-4)
    assert "shift is at a bound, 0.05" in found.notes
    assert found.parameters[-1].start == 0.0
    rows[0, 0], rows[-1, 0] = 0.0, 1.5
    np.savetxt(bench / "tip.csv", rows, delimiter=",", header="time,tip", comments="")
    with pytest.raises(StudyError, match=r"fit.shift: expected series that begin after the run"):
        fit(bench / "study.toml")


@pytest.mark.parametrize("sigma", [0.0, -1.0, np.inf, {"position:mass:x": 0.0}])
def test_a_deviation_of_the_noise_is_above_0(sigma):
    series = {"position:mass:x": (TIME, swing())}
    with pytest.raises(StudyError, match=r"position:mass:x.*expected sigma above 0, found"):
        fit_model(lambda m: None, {"m": Parameter(start=1.0)}, series, sigma=sigma)


def test_a_fit_to_nothing_is_refused():
    with pytest.raises(StudyError, match="series: expected times and values by quantity"):
        fit_model(lambda m: None, {"m": Parameter(start=1.0)}, {})
