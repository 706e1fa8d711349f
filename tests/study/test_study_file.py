"""Study files: the cases that they describe, and errors that are found before anything runs."""

import tomllib

import pytest
from duhamel.solver import read_model
from duhamel.study import StudyError, read_study

from .conftest import STUDY


def test_a_grid_has_every_value_with_every_other_the_last_fastest(study_file):
    cases = read_study(study_file()).cases
    assert [case.name for case in cases] == [f"case-{n:04d}" for n in range(1, 7)]
    assert [tuple(case.parameters.values()) for case in cases] == [
        (inertia, torque) for inertia in ([2, 2, 4], [1, 1, 2]) for torque in (8, 4, 2)
    ]


def test_a_table_has_a_case_a_row(study_file, folder):
    (folder / "cases.csv").write_text(
        "case,bodies.hub.inertia,bodies.beam.superelement, joints.pivot.type\n"
        'slow,"[2, 2, 4]",parts/a.h5,spherical\n'
        'fast,"[1, 1, 2]","""parts/b.h5""",revolute\n'
    )
    slow, fast = read_study(study_file('model = "model/hub.toml"\ntable = "cases.csv"')).cases
    assert (slow.name, fast.name) == ("slow", "fast")
    assert slow.document["bodies"]["hub"]["inertia"] == [2, 2, 4]
    assert fast.document["bodies"]["hub"]["inertia"] == [1, 1, 2]
    assert slow.document["joints"][0]["type"] == "spherical"
    # Paths are relative to the file that says them: the study file here, the model file in the
    # base.
    assert slow.document["bodies"]["beam"]["superelement"] == "../parts/a.h5"
    assert fast.document["bodies"]["beam"]["superelement"] == "../parts/b.h5"


def test_the_file_of_a_case_is_a_model_file_of_its_own(study_file, folder):
    case = read_study(study_file(), folder / "far" / "away").cases[-1]
    case.folder.mkdir(parents=True)
    case.source.write_text(case.text)
    model = read_model(case.source)
    assert model.bodies["hub"].inertia.diagonal().tolist() == [1, 1, 2]
    assert model.loads[0].signal(0.0) == 2
    assert model.bodies["beam"].mass == 2.0
    assert tomllib.loads(case.text)["simulation"] == {"t_end": 0.05, "step": 5e-4}


MODEL_LINE = 'model = "model/hub.toml"\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[parameters]", "expected one of model and body, found none"),
        (MODEL_LINE + 'body = "b.toml"', "expected one of model and body, found model and body"),
        (MODEL_LINE, "expected one of parameters and table, found none"),
        (
            MODEL_LINE + "[parameters]",
            "parameters: expected lists of values by dotted key, found none",
        ),
        (MODEL_LINE + "parameter.x = [1]", "unknown key 'parameter'; did you mean 'parameters'?"),
        (
            MODEL_LINE + "parameters.bodies.hub.mass = 2",
            "parameters.bodies.hub.mass: expected a list of values, found 2",
        ),
        (
            MODEL_LINE + "parameters.bodies.hbu.mass = [2]",
            "no 'hbu' in bodies; there are: hub, beam",
        ),
        (
            MODEL_LINE + "parameters.bodies.hub.mas = [2]",
            "no 'mas' in bodies.hub; there are: mass, inertia",
        ),
        (
            MODEL_LINE + "parameters.body.hub = [2]",
            "no 'body' in the file; there are: simulation, bodies, joints, loads",
        ),
        (
            MODEL_LINE + 'parameters."joints.1.type" = ["x"]',
            "no '1' in joints; there are: 0, pivot",
        ),
        (
            MODEL_LINE + "parameters.bodies.hub.mass.x = [2]",
            "no 'x' in bodies.hub.mass; there are: no keys",
        ),
        (MODEL_LINE + 'table = "none.csv"', "none.csv: not a readable file"),
        ('model = "hub.toml"\nparameters.x = [1]', "hub.toml: not a readable file"),
    ],
)
def test_what_makes_no_sense_is_refused(study_file, text, message):
    path = study_file(text)
    with pytest.raises(StudyError) as error:
        read_study(path)
    assert str(error.value).startswith(f"{path}: ")
    assert message in str(error.value)


def test_a_loop_of_links_in_the_place_of_a_superelement_is_refused(study_file, folder):
    superelement = folder / "model" / "parts" / "beam.h5"
    superelement.unlink()
    superelement.symlink_to(superelement)
    path = study_file(STUDY)
    with pytest.raises(StudyError, match=f"^{path}: .*{superelement}") as error:
        read_study(path)
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("", "expected a line of different keys and a line a case"),
        ("simulation.step\n", "expected a line of different keys and a line a case"),
        (
            "simulation.step,simulation.step\n1,2\n",
            "expected a line of different keys and a line a case",
        ),
        ("simulation.step,simulation.t_end\n1e-3\n", "case 1: expected 2 values, found 1"),
        (
            "case,simulation.step\na,1e-3\na,1e-4\n",
            "case 2: expected a new name for files, found 'a'",
        ),
        (
            "case,simulation.step\n../a,1e-3\n",
            "case 1: expected a new name for files, found '../a'",
        ),
    ],
)
def test_a_table_that_makes_no_sense_is_refused(study_file, folder, table, message):
    (folder / "cases.csv").write_text(table)
    with pytest.raises(StudyError, match=message):
        read_study(study_file(MODEL_LINE + 'table = "cases.csv"'))


def test_reading_writes_nothing(study_file, folder):
    before = sorted(folder.rglob("*"))
    read_study(study_file(STUDY))
    assert sorted(path for path in folder.rglob("*") if path.name != "torques.toml") == before
