"""Names of a study's own, and keys that follow from them and from others."""

import pytest
from duhamel.study import StudyError, read_study

MODEL_LINE = 'model = "model/hub.toml"\n'


def document(study_file, text):
    return read_study(study_file(MODEL_LINE + text)).cases[0].document


def test_one_parameter_gives_several_keys(study_file):
    found = document(
        study_file,
        """
        parameters.J = [4]
        [derived]
        bodies.hub.inertia = ["J / 2", "J / 2", "J"]
        loads.0.signal = "3 * J"
        simulation.step = 1e-3
        """,
    )
    assert found["bodies"]["hub"]["inertia"] == [2, 2, 4]
    assert found["loads"][0]["signal"] == 12
    assert found["simulation"]["step"] == 1e-3


def test_each_follows_what_it_asks_for_in_any_order(study_file):
    found = document(
        study_file,
        """
        parameters.m = [4]
        [derived]
        loads.0.signal = "bodies.hub.inertia[2] + bodies.hub.mass"
        bodies.hub.inertia = ["J", "J", "2 * J"]
        bodies.hub.mass = "m"
        J = "m + 1"
        """,
    )
    assert found["loads"][0]["signal"] == 14


def test_a_key_may_scale_its_value_in_the_base_file(study_file):
    found = document(
        study_file,
        'parameters.k = [1.5]\n[derived]\nloads.0.signal = "k * loads[0].signal"',
    )
    assert found["loads"][0]["signal"] == 12


def test_names_stand_for_text_and_paths(study_file):
    found = document(
        study_file,
        'parameters.part = ["parts/a.h5"]\n[derived]\nbodies.beam.superelement = "part"',
    )
    assert found["bodies"]["beam"]["superelement"] == "../parts/a.h5"


def test_files_of_signals_are_where_the_file_that_names_them_says(study_file, folder):
    """Those of the base model beside it, those of parameters beside the study."""
    columns = "0, 0\n1, 2\n"
    (folder / "model" / "base.csv").write_text(columns)
    (folder / "own.csv").write_text(columns)
    base = folder / "model" / "hub.toml"
    signal = 'signal = {file = "base.csv", column = 2}'
    base.write_text(base.read_text().replace("signal = 8", signal))
    text = 'parameters.loads.0.signal = [{file = "own.csv", column = 2}, 1]'
    study = read_study(study_file(MODEL_LINE + text))
    assert study.cases[0].document["loads"][0]["signal"]["file"] == "../own.csv"
    text = "parameters.simulation.step = [1e-3]"
    study = read_study(study_file(MODEL_LINE + text))
    assert study.cases[0].document["loads"][0]["signal"]["file"] == "../model/base.csv"
    assert folder / "torques" / "../model/base.csv" in study.inputs


def test_samples_and_tables_have_names_too(study_file, folder):
    text = '[derived]\nloads.0.signal = "2 * c"\n[design]\nsamples = 4\n[parameters]\nc = '
    cases = read_study(study_file(MODEL_LINE + text + "{uniform = [1, 2]}")).cases
    for case in cases:
        assert case.document["loads"][0]["signal"] == 2 * case.parameters["c"]
    (folder / "cases.csv").write_text("c\n5\n")
    text = 'table = "cases.csv"\nderived.loads.0.signal = "2 * c"'
    assert document(study_file, text)["loads"][0]["signal"] == 10


def test_the_cases_do_not_share_what_is_changed(study_file):
    text = 'parameters.v = [[1, 1, 2]]\nparameters.z = [3, 4]\n[derived]\nbodies.hub.inertia = "v"'
    text += '\nbodies.hub.mass = "z * bodies.hub.inertia[2]"'
    cases = read_study(study_file(MODEL_LINE + text)).cases
    assert [case.document["bodies"]["hub"]["mass"] for case in cases] == [6, 8]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("parameters.J = [1]", "parameters.J: no key of the base file, and no name that"),
        (
            'parameters.J = [1]\nderived.K = "J"',
            "derived.K: no key of the base file, and no name that",
        ),
        (
            'parameters.J = [1]\nderived.bodies.hub.mas = "J"',
            "derived.bodies.hub.mas: no 'mas' in bodies.hub; there are: mass",
        ),
        (
            'parameters.J = [1]\nderived.bodies.hub.mass = "J * X"',
            "derived.bodies.hub.mass: no 'X'; there are: J, simulation",
        ),
        (
            'parameters.J = [1]\nderived.bodies.hub.mass = "J * bodies.bib.mass"',
            "no 'bib' in bodies; there are: hub, beam",
        ),
        (
            'parameters.J = [1]\nderived.bodies.hub.mass = "J * L"\nderived.L = "bodies.hub.mass"',
            "depends on itself",
        ),
        (
            'parameters.J = [1]\nderived.bodies.hub.mass = "J"\nparameters.bodies.hub.mass = [1]',
            "derived.bodies.hub.mass: is a parameter too",
        ),
        ("parameters.pi = [1]", "parameters.pi: expected a name that is one word and no function"),
        (
            'parameters.J = [1]\nderived.bodies.hub.mass = "1 / (J - 1)"',
            "derived.bodies.hub.mass: expected arithmetic, found '1 / (J - 1)'",
        ),
        ("parameters.J = [1]\nderived.bodies.hub.mass = true", "expected arithmetic, found True"),
        (
            'parameters.J = [1]\nderived.bodies.hub.mass = "J * joints.pivot.name"',
            "joints.pivot.name: expected numbers, found the text 'pivot'",
        ),
        (
            "parameters.simulation.step = {uniform = [1, 2]}",
            "parameters.simulation.step.uniform: a distribution wants samples: expected [design]",
        ),
        ("parameters.J = [1]\ndesign.samples = 0", "design.samples: "),
        ('table = "x.csv"\ndesign.samples = 3', "design: expected with parameters"),
    ],
)
def test_what_makes_no_sense_is_refused(study_file, text, message):
    path = study_file(MODEL_LINE + text)
    with pytest.raises(StudyError) as error:
        read_study(path)
    assert str(error.value).startswith(f"{path}: ")
    assert message in str(error.value)
    assert len(str(error.value).splitlines()) == 1
