"""Tables of peaks: values, times and places."""

import numpy as np
import pytest
from duhamel.results import QuantityError, Results, peaks
from duhamel.results.transforms import series

from .disc import TIME, TRAVEL


@pytest.fixture
def results(results_file):
    return Results.read(results_file)


def test_the_extremes_of_a_number_and_when(results):
    (peak,) = peaks(results, ["elastic_displacement:beam.tip:y"])
    assert peak.quantity == "elastic_displacement:beam.tip:y"
    assert peak.largest == TRAVEL[:, 1].max()
    assert peak.at_largest == TIME[TRAVEL[:, 1].argmax()]
    assert peak.smallest == TRAVEL[:, 1].min()
    assert peak.at_smallest == TIME[TRAVEL[:, 1].argmin()]
    assert (peak.unit, peak.base) == ("m", "s")


def test_a_vector_has_a_row_for_each_axis_and_its_length(results):
    found = {peak.quantity: peak for peak in peaks(results, ["elastic_displacement:beam.tip"])}
    length = np.linalg.norm(TRAVEL, axis=1)
    assert found["|elastic_displacement:beam.tip|"].largest == length.max()
    assert found["|elastic_displacement:beam.tip|"].at_largest == TIME[length.argmax()]
    assert len(found) == 4


def test_the_place_of_the_largest_comes_first(results):
    """Of what a star stands for."""
    found = peaks(results, ["angular_acceleration:*:z", "position:*.t*:z"])
    assert [peak.quantity for peak in found[:2]] == [
        "angular_acceleration:disc:z",
        "angular_acceleration:beam.tip:z",
    ]
    sizes = [peak.magnitude for peak in found[:-1]]
    assert sizes == sorted(sizes, reverse=True)
    assert found[-1].quantity == "position:beam.tip:z"


def test_peaks_of_spectra_have_their_frequency(results):
    made = series(results, "srs(acceleration:beam.tip:x)")
    (found, *_) = peaks(results, ["srs(acceleration:beam.*:x)"])
    assert found.quantity == "srs(acceleration:beam.tip:x)"
    assert found.largest == made.values.max()
    assert found.at_largest == made.abscissa[made.values.argmax()]
    assert found.base == "Hz"
    assert all("|" not in peak.quantity for peak in peaks(results, ["srs(acceleration:beam.tip)"]))


def test_in_g(results):
    plain, in_g = (peaks(results, ["acceleration:beam.tip:x"], g)[0] for g in (False, True))
    assert in_g.unit == "g"
    assert in_g.largest == pytest.approx(plain.largest / 9.80665, rel=1e-12)


def test_unasked_accelerations_forces_and_deflections(results):
    kinds = {peak.quantity.strip("|").partition(":")[0] for peak in peaks(results)}
    assert kinds == {"acceleration", "force", "elastic_displacement"}


def test_stars_that_stand_for_nothing(results):
    with pytest.raises(QuantityError, match=r"acceleration:arm.\*: found no acceleration:arm"):
        peaks(results, ["acceleration:arm.*"])
    with pytest.raises(QuantityError, match="no quantity 'speed'; there are"):
        peaks(results, ["speed:*"])
    with pytest.raises(QuantityError, match=r"'forc'; did you mean 'force'\? there are"):
        peaks(results, ["forc:weld"])
