"""Files of earlier versions, where a later one has a quantity more."""

import h5py
import numpy as np
import pytest
from duhamel.results import (
    QuantityError,
    Results,
    ResultsError,
    contents,
    motion,
    peaks,
    quantities,
    write_csv,
    write_mat,
)
from duhamel.results import file as file_module
from duhamel.results.contents import EARLIEST_VERSION, RESULTS_VERSION
from duhamel.results.file import FileWriter
from duhamel.results.motion import BodyMotion, Energy
from duhamel.results.quantities import evaluate
from duhamel.results.quantity import quantity
from duhamel.view import curves, overview

from .disc import write_disc
from .writing import NOTES, batch, make_contents, make_output

VERSIONS = range(EARLIEST_VERSION, RESULTS_VERSION + 1)
NEW = RESULTS_VERSION + 1


@pytest.fixture
def add(monkeypatch):
    """Add a quantity to the set, as a line in its class does."""

    def add(kind, attribute, field):
        field.quantities = tuple(
            one.within(attribute, kind.group, kind.owner, plot="{}") for one in field.quantities
        )
        monkeypatch.setattr(kind, attribute, field, raising=False)
        monkeypatch.setattr(kind, "quantities", (*kind.quantities, *field.quantities))
        every = (*motion.QUANTITIES, *field.quantities)
        for module in (motion, contents, file_module, quantities):
            monkeypatch.setattr(module, "QUANTITIES", every)
        for name, found in quantities._of_records().items():
            monkeypatch.setitem(quantities.KINDS_BY_NAME, name, found)

    return add


def write_old(path, version):
    """A file of a version, with what that had, by the writer of this one."""
    without = {"contacts": 0, "stops": 0} if version < 4 else {}
    without |= {"second_order": 0} if version < 5 else {}
    without |= {"motors": 0, "couplers": 0, "sensors": 0} if version < 6 else {}
    without |= {"surfaces": 0} if version < 9 else {}
    without |= {"fmus": 0} if version < 10 else {}
    held = make_contents(**without)
    kept = tuple(one for one in held.quantities if one.since <= version)
    held = contents.Contents(held.axes, kept, held.superelements)
    output = make_output(make_contents(), 4)
    writer = FileWriter(path, held, NOTES, "model", 4)
    writer.append(batch(output, 0, 4))
    writer.flush()
    writer.finish()
    with h5py.File(path, "a") as file:
        file.attrs["version"] = version
    return Results.read(path), output


def everything(results):
    """All that results give of their owners."""
    owners = {
        "body": results.bodies,
        "frame": results.frames,
        "joint": results.joints,
        "spring": results.springs,
        "coupler": results.couplers,
        "contact": results.contacts,
        "surface_contact": results.surface_contacts,
        "stop": results.stops,
        "pattern": results.patterns,
        "sensor": results.sensors,
        "motor": results.motors,
        "fmu": results.fmus,
    }
    return [getattr(results, kind)(name) for kind, names in owners.items() for name in names]


@pytest.mark.parametrize("version", VERSIONS)
def test_they_are_read_when_a_quantity_is_added(version, tmp_path, add):
    path = tmp_path / "old.h5"
    results, output = write_old(path, version)
    before = [vars(one).keys() for one in everything(results)]
    add(BodyMotion, "heat", quantity("K", "temperature", since=NEW))
    add(Energy, "heat", quantity("J", "energy of heat", name="heat_energy", plot="", since=NEW))
    results = Results.read(path)
    assert [vars(one).keys() for one in everything(results)] == before
    body = results.body("b1")
    np.testing.assert_array_equal(body.x, output.body_position[:, 1])
    np.testing.assert_array_equal(results.energy.kinetic, output.kinetic_energy)
    found = f"found none in a file of version {version}; files have it since version {NEW}$"
    with pytest.raises(ResultsError, match=f"^{path}: variable 'body_heat': .* {found}"):
        _ = body.heat
    with pytest.raises(ResultsError, match=f"variable 'heat_energy': .* {found}"):
        _ = results.energy.heat
    with pytest.raises(QuantityError, match=f"^heat:b1: {path}: .* {found}"):
        evaluate(results, "heat:b1")
    with pytest.raises(QuantityError, match="no energy 'heat'; there are: balance, diss"):
        evaluate(results, "energy:heat")


@pytest.mark.parametrize("version", VERSIONS)
def test_what_is_made_of_them_does_without_it(version, tmp_path, add):
    results, _ = write_old(tmp_path / "old.h5", version)
    expected = peaks(results)
    add(BodyMotion, "heat", quantity("K", "temperature", since=NEW, in_peaks=True, section="Heat"))
    results = Results.read(tmp_path / "old.h5")
    assert peaks(results) == expected
    assert overview(results)
    assert write_csv(results, tmp_path / "tables")
    assert write_mat(results, tmp_path / "run.mat").exists()


def test_a_file_by_hand_is_read_when_a_quantity_is_added(tmp_path, add):
    path = write_disc(tmp_path / "disc.h5")
    add(BodyMotion, "heat", quantity("K", "temperature", since=NEW))
    body = Results.read(path).body("disc")
    assert body.x.shape == (181, 3)
    with pytest.raises(ResultsError, match=f"^{path}: variable 'body_heat': .* version 3;"):
        _ = body.heat


def test_a_new_file_has_it_everywhere(tmp_path, add):
    add(BodyMotion, "heat", quantity("K", "temperature", since=NEW, in_peaks=True))
    held = make_contents()
    output = make_output(held, 4)
    writer = FileWriter(tmp_path / "new.h5", held, NOTES, "model", 4)
    writer.append(batch(output, 0, 4))
    writer.flush()
    writer.finish()
    results = Results.read(tmp_path / "new.h5")
    np.testing.assert_array_equal(results.body("b1").heat, output.body_heat[:, 1])
    (curve,) = curves(results, "heat:b1")
    assert (curve.words[0], curve.unit) == ("heat", "K")
    np.testing.assert_array_equal(curve.values, output.body_heat[:, 1])
    assert "heat:b1" in {peak.quantity for peak in peaks(results)}
