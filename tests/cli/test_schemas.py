"""JSON schemas: those of the code; they take what runs, and refuse what they can know is wrong."""

import json
import tomllib
from itertools import chain
from typing import Any

import pytest
from duhamel.cli import app
from duhamel.preprocess import Body
from duhamel.solver.model.file import table_of_any_model
from import_order import ROOT
from jsonschema import Draft7Validator
from make_schemas import FOLDER, text

from tests.bad_inputs.models import DOCUMENTS, LAWS, SIGNALS
from tests.bad_inputs.values import DEEP, UNKNOWN, Place, changed, declared
from tests.docs.walk import blocks

KINDS = "body", "tested", "model", "study"
FILES = sorted(chain((ROOT / "examples").glob("*.toml"), (ROOT / "meshes").glob("*/*.toml")))
BODY: dict[str, Any] = {
    "name": "rod",
    "mesh": "rod.msh",
    "material": {"E": 2.1e11, "nu": 0.3, "rho": 7850},
    "interfaces": {
        "root": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}},
        "tip": {"group": "tip", "kind": "rigid"},
    },
    "impulse": {"step": 1e-5, "steps": 100, "method": "krylov"},
    "damping": {"rayleigh": {"mass": 1.0, "stiffness": 1e-6}},
    "masses": {"nut": {"mass": 0.1, "interface": "tip", "inertia": [1, 1, 1]}},
    "recovery": {"stress": True},
    "rotation": {"modes": 4, "soft": "auto"},
}


def validator(kind: str) -> Draft7Validator:
    return Draft7Validator(json.loads((FOLDER / f"{kind}.json").read_text()))


MODEL = validator("model")
MODEL_FILE = table_of_any_model()


@pytest.mark.parametrize("kind", KINDS)
def test_the_schemas_of_the_repository_are_those_of_the_code(kind):
    """`python tools/make_schemas.py` writes them again."""
    assert (FOLDER / f"{kind}.json").read_text() == text(kind)


@pytest.mark.parametrize("kind", KINDS)
def test_a_schema_is_one_of_its_draft(kind):
    Draft7Validator.check_schema(json.loads(text(kind)))


def test_the_schema_of_tested_parts_keeps_the_guide_and_refuses_a_slip():
    (guide,) = [block for block in blocks("how-to/measured.md") if block.title == "tested.toml"]
    document, tested = tomllib.loads(guide.text), validator("tested")
    tested.validate(document)
    slip = document | {"measured": document["measured"] | {"hit": "hits.csv"}}
    assert [error.message for error in tested.iter_errors(slip)] == [
        "Additional properties are not allowed ('hit' was unexpected)"
    ]
    assert list(tested.iter_errors({**document, "mesh": "angle.msh"}))


def test_the_command_prints_the_schema(runner):
    assert json.loads(runner.invoke(app, ["schema", "study"]).stdout) == json.loads(text("study"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_example_names_its_schema_and_keeps_it(path):
    text = path.read_text()
    first = text.partition("\n")[0]
    schema = path.parent / first.removeprefix("#:schema ")
    assert schema.resolve().parent == FOLDER
    assert messages(validator(schema.stem), tomllib.loads(text)) == []


@pytest.mark.parametrize("name", DOCUMENTS)
def test_models_that_run_keep_the_schema(name):
    assert messages(MODEL, DOCUMENTS[name]) == []


@pytest.mark.parametrize("form", SIGNALS)
def test_every_form_of_signal_keeps_the_schema(form):
    document = changed(DOCUMENTS["push"], ("loads", 0, "signal"), SIGNALS[form])
    assert messages(MODEL, document) == []


@pytest.mark.parametrize("form", LAWS)
def test_every_form_of_force_law_keeps_the_schema(form):
    document = changed(DOCUMENTS["mechanism"], ("springs", 0, "law"), LAWS[form])
    assert messages(MODEL, document) == []


@pytest.mark.parametrize("name", DOCUMENTS)
def test_an_unknown_key_and_a_wrong_type_are_refused_at_every_key_of_a_model(name):
    assert taken(MODEL, DOCUMENTS[name], declared(MODEL_FILE, DOCUMENTS[name])) == []


def test_an_unknown_key_and_a_wrong_type_are_refused_at_every_key_of_a_body():
    body = validator("body")
    assert messages(body, BODY) == []
    assert taken(body, BODY, declared(Body, BODY)) == []


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("joints", 0, "type"), "revolut"),
        (("simulation", "rule"), "papers"),
        (("simulation", "start"), "rest"),
        (("joints", 0, "between"), ["ground"]),
        (("joints", 0, "axis"), [0, 1]),
        (("loads", 0, "type"), "moment"),
        (("loads", 0, "signal"), {"amplitude": 1, "frequenzy": 2}),
        (("loads", 0, "signal"), {"amplitude": 1}),
        (("springs", 0, "law"), {"gap": "wide", "stiffness": 1}),
        (("bodies", "hub", "mass"), None),
        (("bodies", "hub", "mass"), "heavy"),
        (("simulation", "t_end"), None),
    ],
)
def test_a_wrong_word_a_missing_key_and_a_wrong_length_are_refused(place, value):
    assert messages(MODEL, changed(DOCUMENTS["mechanism"], place, value)) != []


def test_keys_are_described_with_their_units():
    model = json.loads(text("model"))
    mass = model["$defs"]["Body"]["properties"]["mass"]["description"]
    assert mass.startswith("mass [kg]")


def messages(schema: Draft7Validator, document: Any) -> list[str]:
    return [f"{error.json_path}: {error.message[:200]}" for error in schema.iter_errors(document)]


def taken(schema: Draft7Validator, document: Any, places: Any) -> list[Place]:
    """The places at which the schema takes a value of a type that no key has."""
    return [
        place
        for place in places
        if schema.is_valid(changed(document, place, 1 if place[-1] == UNKNOWN else DEEP))
    ]
