"""Studies in one process: numbers against closed forms, what runs again and what does not, what is
told of failures.
"""

import csv

import h5py
import pytest
from duhamel.results import Results
from duhamel.solver import (
    ConvergenceError,
    ModelError,
    OutOfRangeError,
    StateError,
    read_model,
    simulate,
)
from duhamel.study import Row, StudyError, read_study, read_summary, sweep
from duhamel.superelement import StepWarning, read, write

from .conftest import MODEL, STUDY, datasets, make_element


def run(path, **settings) -> tuple[list[str], tuple[Row, ...]]:
    """The cases whose files changed, and what is said of all cases."""
    study = read_study(path)
    before = {
        case.name: case.target.stat().st_mtime_ns for case in study.cases if case.target.exists()
    }
    rows = sweep(study, workers=0, **settings)
    targets = [case for case in study.cases if case.target.exists()]
    return [
        case.name for case in targets if case.target.stat().st_mtime_ns != before.get(case.name)
    ], rows


def summary(path) -> list[dict[str, str]]:
    with (path.with_suffix("") / "summary.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_study_gives_the_closed_form_and_what_single_runs_give(study_file):
    path = study_file()
    ran, _ = run(path)
    rows = summary(path)
    assert ran == [row["case"] for row in rows] == [f"case-{n:04d}" for n in range(1, 7)]
    for row in rows:
        J, C = (
            float(row["bodies.hub.inertia"].strip("[]").split(",")[2]),
            float(row["loads.0.signal"]),
        )
        assert float(row["angle"]) == pytest.approx(C * 0.05**2 / (2 * J), rel=1e-12)
        assert (row["status"], row["steps"], row["message"]) == ("done", "100", "")
        source = path.with_suffix("") / f"{row['case']}.toml"
        simulate(read_model(source), output=source.with_name("alone.h5"))
        assert datasets(source.with_name("alone.h5")) == datasets(source.with_suffix(".h5"))


def test_a_second_call_runs_nothing_and_sums_up_the_same(study_file):
    path = study_file()
    run(path)
    first = summary(path)
    ran, _ = run(path)
    assert ran == []
    assert summary(path) == first
    ran, _ = run(path, force=True)
    assert len(ran) == 6


def test_only_what_is_missing_unfinished_or_damaged_runs_again(study_file):
    path = study_file()
    run(path)
    cases = path.with_suffix("")
    (cases / "case-0002.h5").unlink()
    (cases / "case-0004.h5").write_bytes((cases / "case-0004.h5").read_bytes()[:3000])
    with h5py.File(cases / "case-0005.h5", "a") as file:
        file["solver"].attrs["finished"] = False
    ran, rows = run(path)
    assert ran == ["case-0002", "case-0004", "case-0005"]
    assert {row.status for row in rows} == {"done"}


def test_a_value_added_to_the_first_parameter_leaves_the_cases_before_as_they_are(study_file):
    run(study_file())
    ran, _ = run(study_file(STUDY.replace("[1, 1, 2]]", "[1, 1, 2], [3, 3, 6]]")))
    assert ran == ["case-0007", "case-0008", "case-0009"]


def test_changed_inputs_run_again(study_file, folder):
    path = study_file()
    run(path)
    ran, _ = run(study_file(STUDY.replace("[8, 4, 2]", "[8, 5, 2]")))
    assert ran == ["case-0002", "case-0005"]
    (folder / "model" / "hub.toml").write_text(
        MODEL.replace("velocity = [1, 0, 0]", "velocity = [2, 0, 0]")
    )
    assert len(run(path)[0]) == 6
    write(folder / "model" / "parts" / "beam.h5", make_element(mass=3.0))
    assert len(run(path)[0]) == 6
    assert run(path)[0] == []


def test_changed_columns_of_a_signal_run_again(study_file, folder):
    columns, base = folder / "model" / "torque.csv", folder / "model" / "hub.toml"
    columns.write_text("0, 8\n1, 8\n")
    signal = 'signal = {file = "torque.csv", column = 2}'
    base.write_text(MODEL.replace("signal = 8", signal))
    path = study_file(STUDY.replace("loads.0.signal = [8, 4, 2]", ""))
    assert len(run(path)[0]) == 2
    assert run(path)[0] == []
    columns.write_text("0, 4\n1, 4\n")
    ran, rows = run(path)
    assert len(ran) == 2
    assert rows[0].numbers["angle"] == pytest.approx(4 * 0.05**2 / (2 * 4), rel=1e-12)


def test_what_looks_wrong_in_a_case_is_among_its_warnings(study_file):
    values = "[1, {amplitude = 1, frequency = 900}]"
    text = STUDY.replace("[8, 4, 2]", values).replace("[2, 2, 4], ", "")
    _, (calm, fast) = run(study_file(text))
    assert calm.warnings == ()
    assert fast.warnings[0].startswith("loads.0.signal: its highest frequency, 900 Hz, has 2.2")


def test_other_outputs_are_read_from_the_results_that_are_there(study_file):
    run(study_file())
    ran, rows = run(
        study_file(STUDY + 'speed = "max |angular_velocity:hub|"\nmean = "mean angle:hub:z"\n')
    )
    assert ran == []
    assert rows[0].numbers["speed"] == pytest.approx(8 * 0.05 / 4, rel=1e-12)
    # The trapezoids over the steps of a parabola exceed its mean by h^2 / 12 times its second
    # derivative.
    assert rows[0].numbers["mean"] == pytest.approx(2 * (0.05**2 / 6 + 5e-4**2 / 12), rel=1e-12)


def test_reductions(study_file):
    outputs = {
        "max": "max angle:hub:z",
        "min": "min angle:hub:z",
        "final": "final |angle:hub:z|",
        "peak-to-peak": "peak-to-peak angle:hub:z",
    }
    lines = "".join(f'{name} = "{text}"\n' for name, text in outputs.items())
    text = STUDY.replace("[8, 4, 2]", "[-8]").replace('angle = "final angle:hub:z"\n', lines)
    _, (row, _) = run(study_file(text))
    end = 8 * 0.05**2 / (2 * 4)
    expected = {"max": 0.0, "min": -end, "final": end, "peak-to-peak": end}
    assert {name: row.numbers[name] for name in outputs} == pytest.approx(
        expected, rel=1e-12, abs=1e-15
    )


@pytest.mark.parametrize(
    ("output", "message"),
    [
        (
            "top angle:hub:z",
            "expected REDUCTION QUANTITY or REDUCTION |QUANTITY| with one of max, min, final",
        ),
        ("max |angle:hub:z", "expected REDUCTION QUANTITY"),
        (
            "max angle:hub",
            "is of a vector: expected an axis, angle:hub:x, or its length, |angle:hub|",
        ),
        ("max angle:hbu:z", "no body or frame 'hbu'; there are: beam, hub, beam.tip"),
        ("max angel:hub:z", "no quantity 'angel'"),
    ],
)
def test_an_output_that_the_results_cannot_have_is_refused_before_anything_runs(
    study_file, folder, output, message
):
    path = study_file(STUDY.replace("final angle:hub:z", output))
    with pytest.raises(StudyError) as error:
        run(path)
    assert str(error.value).startswith(f"{path}: outputs.angle: ")
    assert message in str(error.value)
    assert not path.with_suffix("").exists()


@pytest.mark.parametrize(
    ("change", "key"),
    [
        (("mass = 1.0", "mass = -1.0"), "bodies.hub.mass"),
        (('"parts/beam.h5"', "3"), "bodies.beam.superelement"),
    ],
)
def test_a_base_file_that_does_not_run_is_refused_before_anything_runs(
    study_file, folder, change, key
):
    (folder / "model" / "hub.toml").write_text(MODEL.replace(*change))
    path = study_file()
    with pytest.raises(StudyError, match=rf"the base file does not run by itself: .*{key}"):
        run(path)
    assert not path.with_suffix("").exists()


FAILING = """
model = "model/hub.toml"
[parameters]
simulation.step = [5e-4, -1.0, 1e-3]
[outputs]
angle = "final angle:hub:z"
"""


def test_cases_that_start_from_another_run(study_file, folder):
    """The path of its results is relative to the model, or to the study where that gives it."""
    model = folder / "model" / "hub.toml"
    first = read_model(model).with_settings(checkpoint={"every": 100})
    simulate(first, output=folder / "model" / "first.h5")
    after = 't_end = 0.1\nstart = {from = "first.h5"}'
    model.write_text(MODEL.replace("t_end = 0.05", after))
    path = study_file(
        'model = "model/hub.toml"\n'
        'parameters.simulation.start.from = ["model/first.h5", "model/none.h5"]\n'
        'outputs.angle = "final angle:hub:z"\n'
    )
    _, rows = run(path)
    assert [row.status for row in rows] == ["done", "failed"]
    # C t^2 / (2 J) from the end of the first run on
    assert rows[0].numbers["angle"] == pytest.approx(8.0 * (0.1**2 - 0.05**2) / (2.0 * 4.0))
    assert "none.h5" in rows[1].message


@pytest.mark.parametrize("kind", [ConvergenceError, ModelError, OutOfRangeError, StateError])
def test_whatever_ends_a_run_is_a_failure_of_its_case(kind, study_file):
    assert issubclass(kind, read_study(study_file()).kind.failures)


def test_a_case_that_fails_is_told_and_the_others_run(study_file):
    path = study_file(FAILING)
    _, rows = run(path)
    assert [row.status for row in rows] == ["done", "failed", "done"]
    assert (
        "simulation.step: expected a positive time, 1e-100 to 1e100, found -1.0" in rows[1].message
    )
    told = summary(path)[1]
    assert (told["status"], told["angle"], told["message"]) == ("failed", "", rows[1].message)
    assert not (path.with_suffix("") / "case-0002.h5").exists()
    # A failed case runs again, and one that is mended takes its place.
    ran, rows = run(study_file(FAILING.replace("-1.0", "2.5e-4")))
    assert ran == ["case-0002"]
    assert {row.status for row in rows} == {"done"}


def test_a_run_that_stops_on_its_way_leaves_its_steps_and_runs_again(study_file, folder):
    spun = MODEL.replace("signal = 8", "signal = {times = [0, 0.02], values = [0, 1e12]}")
    model = spun.replace("step = 5e-4", "step = 5e-4\nmax_iterations = 2").replace(
        'type = "revolute"', 'type = "spherical"'
    )
    model = model.replace('["ground", "hub"]', '["ground", "hub.rim"]').replace(
        "axis = [0, 0, 1]\n", ""
    )
    (folder / "model" / "hub.toml").write_text(
        model.replace("[bodies.beam]", "frames.rim = {position = [1, 0, 0]}\n\n[bodies.beam]")
    )
    path = study_file('model = "model/hub.toml"\nparameters.bodies.hub.mass = [1.0]')
    _, (row,) = run(path)
    assert row.status == "failed"
    assert "no convergence in step 40 " in row.message
    with h5py.File(path.with_suffix("") / "case-0001.h5") as file:
        assert (file["solver"].attrs["written"], file["solver"].attrs["finished"]) == (40, False)
    assert run(path)[0] == ["case-0001"]


def test_warnings_of_a_case_are_told(study_file, folder):
    beam = make_element(mass=2.0)
    modes = type(beam.modes)(beam.modes.omega, beam.modes.zeta, beam.modes.phi, h_min=4e-4)
    write(folder / "model" / "parts" / "beam.h5", type(beam)(**{**vars(beam), "modes": modes}))
    _, rows = run(study_file('model = "model/hub.toml"\nparameters.simulation.step = [5e-4, 2e-4]'))
    assert [len(row.warnings) for row in rows] == [0, 1]
    with pytest.warns(StepWarning) as caught:
        simulate(read_model(rows[1].case.source))
    assert rows[1].warnings == (str(caught[0].message),)


BODY = """
name = "bar"
mesh = "bar.msh"

[section]
EA = 1e7
EI_y = 5.0
EI_z = 5.0
GJ = 4.0
mass_per_length = 0.1
polar_inertia_per_length = 4e-8

[interfaces.root]
node = [0, 0, 0]

[impulse]
step = 1e-4
steps = 10
"""


def test_bodies_are_preprocessed(study_file, folder, line_mesh):
    line_mesh(folder / "model" / "bar.msh", 4)
    (folder / "model" / "bar.toml").write_text(BODY)
    path = study_file('body = "model/bar.toml"\nparameters.section.mass_per_length = [0.1, 0.4]')
    ran, rows = run(path)
    assert ran == ["case-0001", "case-0002"]
    assert [row.numbers["mass"] for row in rows] == pytest.approx([0.05, 0.2], rel=1e-12)
    assert read(rows[1].case.target).provenance.body == rows[1].case.text
    # Four times the mass, half the frequency, but for the rotary inertia, which is not scaled.
    slow, fast = rows[1].numbers["first_frequency"], rows[0].numbers["first_frequency"]
    assert slow / fast == pytest.approx(0.5, rel=1e-9)
    assert run(path)[0] == []
    line_mesh(folder / "model" / "bar.msh", 5)
    assert run(path)[0] == ["case-0001", "case-0002"]
    with pytest.raises(StudyError, match="outputs: expected with a model"):
        run(
            study_file(
                'body = "model/bar.toml"\nparameters.name = ["a"]\noutputs.x = "max energy:work"'
            )
        )


ROTATION = """
[rotation]
modes = 2
soft = 0
"""


def test_the_second_order_of_bodies_is_a_parameter(study_file, folder, line_mesh):
    """Of the body file, and of the model with a superelement that it made."""
    line_mesh(folder / "model" / "bar.msh", 4)
    (folder / "model" / "bar.toml").write_text(BODY + ROTATION)
    path = study_file('body = "model/bar.toml"\nparameters.rotation.modes = [2, 4]')
    _, rows = run(path)
    elements = [read(row.case.target) for row in rows]
    assert [element.rotation.n_low for element in elements] == [2, 4]
    write(folder / "model" / "parts" / "beam.h5", elements[1])
    model = folder / "model" / "hub.toml"
    spun = 'second_order = "auto"\nangular_velocity = [0, 0, 300]\nvelocity'
    model.write_text(MODEL.replace("velocity", spun))
    path = study_file(
        'model = "model/hub.toml"\nparameters.bodies.beam.second_order = ["off", "full"]\n'
        'outputs.stretch = "max |elastic_displacement:beam.root|"'
    )
    run(path)
    off, full = (row["stretch"] for row in summary(path))
    assert float(off) == 0.0
    assert float(full) > 1e-6


WALL = """
[[stops]]
name = "wall"
joint = "pivot"
coordinate = "angle"
range = [-inf, 1e-3]
stiffness = 4e5

[[stops]]
name = "never"
joint = "pivot"
coordinate = "angle"
range = [-1, 1]
stiffness = 4e5
"""


def test_numbers_of_events_are_outputs(study_file):
    """With the same torque and stop, half the inertia hits as fast again by the root of two."""
    path = study_file(
        STUDY.replace("[8, 4, 2]", "[8]").replace('angle = "final angle:hub:z"', EVENTS)
    )
    model = path.parent / "model" / "hub.toml"
    model.write_text(model.read_text() + WALL)
    run(path)
    for row in summary(path):
        case = path.with_suffix("") / f"{row['case']}.h5"
        events = Results.read(case).events["wall"]
        assert float(row["impacts"]) == len(events) > 0
        assert float(row["peak"]) == events.peak.max()
        assert float(row["shortest"]) == events.steps[events.whole].min()
        assert float(row["impulse"]) == pytest.approx(events.impulse.sum(), rel=1e-12)
        assert (row["none"], row["no_peak"]) == ("0.0", "nan")


EVENTS = """impacts = "count event:wall"
peak = "max event:wall:peak"
shortest = "min event:wall:steps"
impulse = "sum |event:wall:impulse|"
none = "count event:never"
no_peak = "max event:never:peak"
"""


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ("max event:floor:peak", "event:floor:peak: no contact or stop 'floor'; there are: none"),
        ("sum angle:hub:z", "expected REDUCTION QUANTITY or .* with one of max, min, final"),
        ("rms event:floor:peak", "with one of max, .*, sum, count, found"),
    ],
)
def test_outputs_of_events_that_there_are_not_are_refused(study_file, output, message):
    path = study_file(STUDY.replace("final angle:hub:z", output))
    with pytest.raises(StudyError, match=message):
        run(path)


def test_a_case_follows_a_record_and_runs_again_when_that_has_changed(study_file):
    path = study_file('model = "model/hub.toml"\n\n[parameters]\nloads.0.signal.scale = [1, 2]\n')
    base, record = path.parent / "model/hub.toml", path.parent / "model/torque.csv"
    signal = 'signal = {file = "torque.csv", column = 2, scale = 1}'
    base.write_text(base.read_text().replace("signal = 8", signal))
    record.write_text("0,8\n1,8\n")
    ran, _ = run(path)
    assert ran == ["case-0001", "case-0002"]
    angles = [Results.read(path.with_suffix("") / f"{case}.h5").joint("pivot") for case in ran]
    for scale, pivot in zip((1.0, 2.0), angles, strict=True):
        assert pivot.angle[-1] == pytest.approx(8.0 * scale * 0.05**2 / 8.0, rel=1e-9)
    assert run(path)[0] == []
    record.write_text("0,4\n1,4\n")
    assert run(path)[0] == ran


def test_units_of_outputs_stand_beside_the_summary_and_the_size_is_told_before(study_file):
    """What is told is what the files of the cases take, but for what they have besides rows."""
    text = STUDY.replace("[outputs]", '[outputs]\nlate = "argmax angle:hub:z"')
    study = read_study(study_file(text))
    told = []
    sweep(study, workers=0, on_begin=lambda cases, size: told.append((cases, size)))
    ((cases, size),) = told
    assert cases == len(study.cases)
    written = sum(case.target.stat().st_size for case in study.cases)
    assert 0.2 * written < size < written
    units = read_summary(study.summary).units
    assert units["late"] == "s"
    assert set(units) == set(study.outputs)
    sweep(study, workers=0, on_begin=lambda cases, size: told.append((cases, size)))
    assert len(told) == 1


def test_failed_cases_are_in_the_summary_that_is_read(study_file):
    study = read_study(study_file(FAILING))
    sweep(study, workers=0)
    found = read_summary(study.summary)
    assert found.failed == {"simulation.step": [-1.0]}
    assert len(found.parameters["simulation.step"]) == 2


def test_repeated_tests_of_a_part_are_a_study(study_file, folder, line_mesh):
    """Of frequencies that were measured, one file for each test, whose paths are those there."""
    model = folder / "model"
    line_mesh(model / "bar.msh", 4)
    measured = (
        '[measured]\nmodes = "first.csv"\nchannels = "channels.csv"\nupdate = "frequencies"\n'
    )
    # Bending in two planes of one stiffness would have shapes in any of them.
    (model / "bar.toml").write_text(BODY.replace("EI_y = 5.0", "EI_y = 8.0") + measured)
    sensors = dict(zip("abcde", (0.0, 0.125, 0.25, 0.375, 0.5), strict=True))
    places = [f"{name},{x},0,0,{axis}" for name, x in sensors.items() for axis in "yz"]
    (model / "channels.csv").write_text("\n".join(["label,x,y,z,axis", *places]))
    names = [f"{name}:{axis}" for name in sensors for axis in "yz"]
    bend = [1.0, 0.0, -0.1, 0.0, -0.6, 0.0, -0.1, 0.0, 1.0, 0.0]
    for name, frequency in (("first", 100.0), ("second", 110.0)):
        rows = [["frequency", "damping", *names], [frequency, 0.01, *bend]]
        (model / f"{name}.csv").write_text("\n".join(",".join(map(str, row)) for row in rows))
    path = study_file(
        'body = "model/bar.toml"\n'
        'parameters.measured.modes = ["model/first.csv", "model/second.csv"]'
    )
    _, rows = run(path)
    assert [row.message for row in rows] == ["", ""]
    assert [row.numbers["first_frequency"] for row in rows] == pytest.approx([100.0, 110.0])
    assert run(path)[0] == []
    (model / "second.csv").write_text((model / "first.csv").read_text())
    assert run(path)[0] == ["case-0002"]
