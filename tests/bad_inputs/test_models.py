"""Bad values at every key of a model file: each is refused in one line that names file and key."""

import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from duhamel.inputs import Table
from duhamel.solver import (
    ConvergenceError,
    Model,
    ModelError,
    ResultsError,
    read_model,
    simulate,
)
from duhamel.solver.laws.law import FORCE_LAWS
from duhamel.solver.model.body_shapes import BODY_SHAPES
from duhamel.solver.model.file import table_of_any_model
from duhamel.solver.signals import signal as signals

from ..solver.controller_fmu import controller
from .messages import complaint
from .models import DOCUMENTS, KINDS, LAWS, PART, RECORD, SHAPES, SIGNALS
from .values import UNKNOWN, VALUES, Place, changed, declared, dotted, table_kinds, value_at

REFUSALS = ModelError, ConvergenceError, ResultsError

NAMES = "joint '", "contact '", "joints: ", "motion '", "body '", "fmu '", "step "
"""of the parts that are at odds with a bad value elsewhere"""

MODEL_FILE = table_of_any_model()
PARTS = 4
"""of the bad values, of which every run tries one at each key"""
FORMS = {
    "signal": (("push", "loads", 0, "signal"), SIGNALS),
    "law": (("mechanism", "springs", 0, "law"), LAWS),
    "shape": (("mechanism", "bodies", "hub", "shape"), SHAPES),
}


def keys() -> Iterator[tuple[str, Place]]:
    """Each key of each table, in the first of the documents that has the table."""
    for name in ("mechanism", "steady"):
        yield from ((name, place) for place in declared(MODEL_FILE, DOCUMENTS[name]))
    coupled = declared(MODEL_FILE, DOCUMENTS["coupled"])
    yield from (("coupled", place) for place in coupled if place[0] == "fmus")
    for name in KINDS:
        places = declared(MODEL_FILE, DOCUMENTS[name])
        yield from ((name, at) for at in places if at[0] in ("joints", "loads") and len(at) == 3)


def keys_of_forms() -> Iterator[tuple[str, Place, dict[str, Any]]]:
    """Each key of each form of signals and laws, with a table of that form."""
    for (name, *place), forms in FORMS.values():
        for form in forms.values():
            for key in (*form, UNKNOWN):
                yield name, (*place, key), form


def complaints(folder: Path, name: str, document: Any, place: Place, part: int) -> Iterator[str]:
    """What is wrong with the answers to one part of the bad values at a place of a document."""
    values = VALUES if value_at(document, place) is None else VALUES | {"no key": None}
    for what, value in list(values.items())[part::PARTS]:
        if found := answer(folder, changed(document, place, value), place):
            yield f"{what}: {found}"


def answer(folder: Path, document: Any, place: Place) -> str:
    """What is wrong with the answer to a model: reading it, and running it where it was read."""
    path = folder / "model.toml"
    path.write_text(tomli_w.dumps(document), encoding="utf-8")
    path.with_name("record.csv").write_text(RECORD, encoding="utf-8")
    path.with_name("part.stl").write_text(PART, encoding="utf-8")
    if "fmus" in document and not path.with_name("drive.fmu").exists():
        controller(path.with_name("drive.fmu"))
    names, model = [*(key for key in place if isinstance(key, str)), *NAMES], None
    try:
        model = read_model(path)
        _run(model)
    except REFUSALS as error:
        return complaint(error, path, names) or ("" if model is None else _left(path, model))
    except Exception as error:
        return f"{type(error).__name__}: {error}"[:300]
    return ""


def _run(model: Model, output: Path | None = None) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        simulate(model, output=output)


def _left(path: Path, model: Model) -> str:
    """Files that a refused run leaves behind, besides the results before a failing step."""
    target, before = path.with_name("model.h5"), {file.name for file in path.parent.iterdir()}
    with pytest.raises(REFUSALS):
        _run(model, target)
    target.unlink(missing_ok=True)
    left = {file.name for file in path.parent.iterdir()} - before
    return f"left behind {sorted(left)}" if left else ""


def parts(cases: Iterable[tuple[str, tuple[Any, ...]]]) -> list[Any]:
    """Each named case with every part of the bad values: one in every run, the others with `soak`.

    Which one alternates, so that every run has all values, each at every fourth key.
    """
    found = []
    for number, (name, case) in enumerate(cases):
        for part in range(PARTS):
            marks = () if (part + number) % PARTS == 0 else pytest.mark.soak
            found.append(pytest.param(*case, part, id=f"{name}, part {part}", marks=marks))
    return found


@pytest.mark.parametrize(
    ("name", "place", "part"), parts((f"{key[0]}: {dotted(key[1])}", key) for key in keys())
)
def test_a_bad_value_is_one_line_that_names_the_key(name, place, part, beam_file, beam_read_once):
    assert list(complaints(beam_file.parent, name, DOCUMENTS[name], place, part)) == []


@pytest.mark.parametrize(
    ("name", "place", "form", "part"),
    parts((f"{sorted(case[2])}: {case[1][-1]}", case) for case in keys_of_forms()),
)
def test_a_bad_value_in_a_signal_or_a_law_is_one_line(
    name, place, form, part, beam_file, beam_read_once
):
    document = changed(DOCUMENTS[name], place[:-1], form)
    assert list(complaints(beam_file.parent, name, document, place, part)) == []


def test_the_documents_are_models(beam_file):
    for document in DOCUMENTS.values():
        assert answer(beam_file.parent, document, ()) == ""


def test_every_table_of_a_model_file_is_in_a_document():
    """Else keys of a new table would go untried."""
    tables = {kind.__name__ for kind in _all_tables(MODEL_FILE)}
    tried = {kind.__name__ for document in DOCUMENTS.values() for kind in _tables_of(document)}
    assert tables == tried


def test_every_form_of_signal_law_and_shape_is_tried():
    families = ((signals.SIGNAL_FORMS, SIGNALS), (FORCE_LAWS, LAWS), (BODY_SHAPES, SHAPES))
    for family, forms in families:
        known = {form.kind.__name__ for group in family.forms.values() for form in group}
        assert known == forms.keys()


def _all_tables(kind: type[Any]) -> Iterator[type[Any]]:
    yield kind
    for field in kind.model_fields.values():
        for inner in table_kinds(field.annotation):
            yield from _all_tables(inner)


def _tables_of(document: Any) -> Iterator[type[Any]]:
    """The tables that a document has: those of which it has all the places of `declared`."""
    places = {place for place in declared(MODEL_FILE, document) if place[-1] == UNKNOWN}
    for kind in _all_tables(MODEL_FILE):
        keys = set(kind.model_fields)
        for place in places:
            below = {key for *at, key in declared(MODEL_FILE, document) if tuple(at) == place[:-1]}
            if below - {UNKNOWN} == keys and issubclass(kind, Table):
                yield kind
