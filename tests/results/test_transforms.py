"""Quantities and what is made of them, by words."""

import re
from pathlib import Path

import numpy as np
import pytest
from duhamel.cli.commands.plot import plot
from duhamel.results import QuantityError, Results, SeriesError, SeriesWarning, series
from duhamel.results.transforms import STANDARD_GRAVITY, TRANSFORMS, check, parse, split
from duhamel.results.transforms import series as evaluated

from .disc import TIME, TRAVEL

TIP = "acceleration:beam.tip:x"


@pytest.fixture
def results(results_file):
    return Results.read(results_file)


def test_a_quantity_alone_is_itself(results):
    found = evaluated(results, TIP)
    np.testing.assert_array_equal(found.values, TRAVEL[:, 0] + 9.0)
    np.testing.assert_array_equal(found.abscissa, TIME)
    assert (found.unit, found.base, found.treatment) == ("m/s²", "s", ())


def test_a_shock_spectrum_by_words(results):
    text = f"srs({TIP}, pseudo-velocity, residual, q=25, from=6, to=15, per_octave=6)"
    found = evaluated(results, text)
    frequencies = series.octave_frequencies(6.0, 15.0, 6)
    expected = series.shock_spectrum(
        TIME, TRAVEL[:, 0] + 9.0, frequencies, q=25, response="pseudo-velocity", span="residual"
    )
    np.testing.assert_array_equal(found.abscissa, expected.frequency)
    np.testing.assert_array_equal(found.values, expected.values)
    assert (found.unit, found.base, found.paper) == ("m/s", "Hz", "tripartite")
    assert found.ordinate == "pseudo-velocity"
    assert found.treatment == ("shock response spectrum, Q = 25, residual",)


def test_numbers_stand_in_order_or_by_key(results):
    first = evaluated(results, f"srs({TIP}, 25, 6, 15)")
    second = evaluated(results, f"srs({TIP}, to=15, from=6, zeta=0.02)")
    np.testing.assert_array_equal(first.values, second.values)
    undamped = evaluated(results, f"srs({TIP}, zeta=0, static)")
    assert undamped.treatment == ("shock response spectrum, no damping",)


def test_transforms_are_made_from_the_inside_out(results):
    low = series.butterworth(TIME, TRAVEL[:, 0] + 9.0, "lowpass", (20.0,), 2)
    found = evaluated(results, f"fourier(lowpass({TIP}, 20, order=2), hann, amplitude)")
    expected = series.fourier(TIME, low.values, scale="amplitude", window="hann")
    np.testing.assert_allclose(found.values, expected.values[1:], rtol=1e-12)
    assert found.treatment == ("below 20 Hz", "Fourier spectrum, hann")
    assert found.unit == "m/s²"


def test_a_vector_keeps_its_axes(results):
    found = evaluated(results, "octaves(acceleration:beam.tip, 1)")
    assert found.axes == ("x", "y", "z")
    assert found.values.shape == (len(found.abscissa), 3)
    alone = evaluated(results, "octaves(acceleration:beam.tip:y, fraction=1)")
    np.testing.assert_array_equal(found.values[:, 1], alone.values)


@pytest.mark.parametrize(
    ("quantity", "plain", "unit", "factor"),
    [
        (f"g({TIP})", TIP, "g", STANDARD_GRAVITY),
        (f"g(srs({TIP}))", f"srs({TIP})", "g", STANDARD_GRAVITY),
        (f"srs(g({TIP}))", f"srs({TIP})", "g", STANDARD_GRAVITY),
        (f"fourier(g({TIP}))", f"fourier({TIP})", "g s", STANDARD_GRAVITY),
        (f"psd(g({TIP}))", f"psd({TIP})", "g²/Hz", STANDARD_GRAVITY**2),
        (f"srs(g({TIP}), pseudo-velocity)", f"srs({TIP}, pseudo-velocity)", "m/s", 1.0),
        (f"srs(g({TIP}), displacement)", f"srs({TIP}, displacement)", "m", 1.0),
    ],
)
def test_accelerations_in_g(results, quantity, plain, unit, factor):
    found, expected = evaluated(results, quantity), evaluated(results, plain)
    assert found.unit == unit
    np.testing.assert_allclose(found.values, expected.values / factor, rtol=1e-12)


@pytest.mark.parametrize("text", ["cumulative_rms(energy:work)", "psd(energy:work, resolution=10)"])
def test_any_quantity_has_a_density(results, text):
    found = evaluated(results, text)
    assert found.unit == ("J" if text.startswith("cum") else "(J)²/Hz")
    assert found.abscissa[0] > 0.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"shock({TIP})", r"no transform 'shock'; there are: srs, fourier, psd, .*, g$"),
        ("srs(velocity:disc:x)", r"srs: expected an acceleration, .*, found \[m/s\]"),
        (f"srs(srs({TIP}))", "srs: expected a quantity over time, found a spectrum"),
        (f"cfc({TIP})", r"found no class; expected cfc\(QUANTITY, class\)"),
        (f"cfc({TIP}, 60, 180)", "found '180'; expected cfc"),
        (f"srs({TIP}, q=10, q=20)", "found 'q=20'; expected srs"),
        (f"srs({TIP}, Q=10)", "found 'Q=10'"),
        (f"srs({TIP}, q=ten)", "expected a number for q, found 'ten'"),
        (f"srs({TIP}, q=nan)", "expected a number for q"),
        (f"fourier({TIP}, window=round)", "found window='round'"),
        ("g(velocity:disc:x)", r"g: expected an acceleration, \[m/s²\], found \[m/s\]"),
        (f"g({TIP}, 2)", r"expected g\(QUANTITY\)"),
        ("srs(acceleration:wheel:x)", "no body or frame 'wheel'"),
        ("srs", r"srs: expected srs\(QUANTITY, q=, from=, to=, per_octave=, zeta=, absolute|"),
        ("srs()", "no quantity ''"),
        (f"srs({TIP}", r"found no closing bracket; expected srs\(QUANTITY"),
    ],
)
def test_words_that_there_are_not(results, text, message):
    for function in (evaluated, check):
        with pytest.raises(QuantityError, match=message):
            function(results, text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"cfc({TIP}, 60)", "CFC 60: expected 600 samples per second or more, found 200"),
        (f"srs({TIP}, to=50)", "expected frequencies up to 20 Hz, a tenth"),
        (f"srs({TIP}, per_octave=1.5)", "per_octave: expected a whole number, found 1.5"),
        (f"srs({TIP}, from=30)", "expected frequencies 0 < from < to, found from 30 to 20 Hz"),
        (f"srs({TIP}, q=3, zeta=0.1)", "expected q, or a zeta"),
        (f"bandpass({TIP}, 20, 10)", "expected corners that increase"),
    ],
)
def test_series_of_which_it_cannot_be_made(results, text, message):
    with pytest.raises(SeriesError, match=message) as error:
        evaluated(results, text)
    assert str(error.value).startswith(f"{text}: ")


def test_names_with_brackets_mean_what_they_did():
    assert parse("force:pin (left):x") == ("force:pin (left):x", [])
    assert parse("force:pin(1):x") == ("force:pin(1):x", [])
    quantity, steps = parse("cfc(force:pin(1):x, 60)")
    assert quantity == "force:pin(1):x"
    assert steps == [("cfc", {"class": 60.0})]


def test_commas_within_brackets_part_nothing():
    assert split("a,srs(b, q=1),c") == ["a", "srs(b, q=1)", "c"]
    assert split("force:pin(:x,force:b") == ["force:pin(:x", "force:b"]


def test_one_step_in_several_warns_of_what_is_folded(edit):
    def every(file):
        file["solver"].attrs["every"] = 4

    results = Results.read(edit(every))
    with pytest.warns(SeriesWarning, match="recorded one step in 4: what vibrates above 100 Hz"):
        evaluated(results, f"octaves({TIP})")
    evaluated(results, f"g({TIP})")


def test_every_transform_is_told_in_words(results):
    for name, transform in TRANSFORMS.items():
        numbers = ", ".join(["5", "15"][: transform.required])
        text = f"{name}({TIP}{', ' if numbers else ''}{numbers})"
        if name == "cfc":
            text = f"cfc({TIP}, 180)"
        assert check(results, text).treatment[-1]


def test_the_page_and_the_help_name_every_transform():
    page = Path(__file__).parents[2] / "docs" / "spectra.md"
    for text in (page.read_text(encoding="utf-8"), plot.__doc__):
        assert [name for name in TRANSFORMS if not re.search(rf"\b{name}\b", text)] == []
