"""Fourier spectra, densities and bands: sums that must be kept, and signals that are known."""

import numpy as np
import pytest
from duhamel.results import SeriesError
from duhamel.results.series import cumulative_rms, fourier, octave_bands, psd, rms
from duhamel.results.series.bands import band_edges

STEP, N = 1e-3, 4000
TIME = STEP * np.arange(N)
NOISE = np.random.default_rng(5).normal(size=N)


@pytest.mark.parametrize("n", [N, N - 1])
def test_parseval(n):
    """integral of x^2 dt = 2 integral of |X|^2 df, the ends counted once."""
    X = fourier(TIME[:n], NOISE[:n]).values
    weights = np.full(len(X), 2.0)
    weights[0] = 1.0
    if n % 2 == 0:
        weights[-1] = 1.0
    width = 1.0 / (n * STEP)
    assert width * (weights * X**2).sum() == pytest.approx(STEP * (NOISE[:n] ** 2).sum(), rel=1e-12)


def test_the_transform_of_a_half_sine():
    """|X| = 2 A T / pi |cos(pi f T) / (1 - 4 f^2 T^2)|."""
    T, step = 0.01, 1e-5
    time = step * np.arange(20_000)
    found = fourier(time, np.where(time < T, 3.0 * np.sin(np.pi * time / T), 0.0))
    f = found.frequency[found.frequency < 1000.0]
    expected = 2 * 3.0 * T / np.pi * np.abs(np.cos(np.pi * f * T) / (1 - 4 * (f * T) ** 2 + 1e-15))
    regular = np.abs(f * T - 0.5) > 1e-6
    np.testing.assert_allclose(found.values[: len(f)][regular], expected[regular], atol=2e-8)


@pytest.mark.parametrize("window", ["rectangular", "hann", "flattop", "blackmanharris"])
def test_the_amplitude_of_a_sine_whatever_the_window(window):
    wave = 2.0 + 3.0 * np.sin(2 * np.pi * 100.0 * TIME + 0.4)
    peak = fourier(TIME, wave, scale="amplitude", window=window)
    line = int(np.abs(peak.frequency - 100.0).argmin())
    assert peak.values[line] == pytest.approx(3.0, rel=1e-9)
    assert peak.values[0] == pytest.approx(2.0, rel=1e-9)
    root = fourier(TIME, wave, scale="rms", window=window)
    assert root.values[line] == pytest.approx(3.0 / np.sqrt(2.0), rel=1e-9)
    assert root.values[0] == pytest.approx(2.0, rel=1e-9)


def test_a_flat_top_has_the_amplitude_between_lines_too():
    wave = 3.0 * np.sin(2 * np.pi * 100.12 * TIME)
    found = fourier(TIME, wave, scale="amplitude", window="flattop").values.max()
    assert found == pytest.approx(3.0, rel=2e-3)


def test_the_density_of_white_noise_is_level():
    """sigma^2 over half the rate: 2 sigma^2 h."""
    noise = np.random.default_rng(11).normal(scale=4.0, size=400_000)
    found = psd(STEP * np.arange(len(noise)), noise, resolution=5.0)
    inner = found.values[2:-2]
    assert inner.mean() == pytest.approx(2 * 4.0**2 * STEP, rel=0.01)
    assert inner.std() < 0.06 * inner.mean()
    assert found.frequency[1] == pytest.approx(5.0)


def test_the_density_of_a_sine_holds_its_mean_square():
    wave = 5.0 + 3.0 * np.sin(2 * np.pi * 100.0 * TIME)
    found = psd(TIME, wave, resolution=1.0)
    assert found.values.sum() * found.frequency[1] == pytest.approx(4.5, rel=1e-3)
    near = np.abs(found.frequency - 100.0) < 3.0
    assert found.values[near].sum() > 0.999 * found.values.sum()


def test_the_cumulative_rms_ends_at_the_standard_deviation():
    noise = np.random.default_rng(12).normal(scale=4.0, size=100_000)
    found = cumulative_rms(STEP * np.arange(len(noise)), 9.0 + noise, resolution=2.0)
    assert (np.diff(found.values) >= 0.0).all()
    assert found.values[-1] == pytest.approx(4.0, rel=0.01)
    half = np.interp(250.0, found.frequency, found.values)
    assert half == pytest.approx(4.0 / np.sqrt(2.0), rel=0.02)


def test_the_root_mean_square_is_that_over_time():
    """Also at steps that are not equal."""
    time = np.concatenate([np.linspace(0, 1, 4001), np.linspace(1, 2, 1001)[1:]])
    assert rms(time, np.sin(2 * np.pi * time)) == pytest.approx(1 / np.sqrt(2), rel=1e-5)
    assert rms(np.array([0.0]), np.array([-3.0])) == 3.0


def test_third_octaves_are_those_of_the_standard():
    center, lower, upper = band_edges(80.0, 1300.0, 3)
    assert center[-1] == pytest.approx(1000.0, rel=1e-12)
    np.testing.assert_allclose(upper[:-1], lower[1:], rtol=1e-12)
    np.testing.assert_allclose(center[:2], [100.0, 125.89254], rtol=1e-7)
    np.testing.assert_allclose([lower[-1], upper[-1]], [891.2509, 1122.018], rtol=1e-6)
    octaves, low, high = band_edges(40.0, 1500.0, 1)
    np.testing.assert_allclose(octaves, [63.09573, 125.8925, 251.1886, 501.1872, 1000], rtol=1e-6)
    assert high[-1] / low[-1] == pytest.approx(10**0.3, rel=1e-12)
    even, *_ = band_edges(880.0, 1400.0, 6)
    np.testing.assert_allclose(even[0], 1000.0 * 10 ** (0.3 * -1 / 12), rtol=1e-12)


def test_bands_share_out_the_mean_square():
    """Of noise all that lies between the outermost edges, of a sine all in its band."""
    found = octave_bands(TIME, NOISE, 3)
    assert found.upper[-1] <= 500.0
    assert found.upper[0] - found.lower[0] >= 0.25
    whole = fourier(TIME, NOISE, scale="rms")
    inside = (whole.frequency > found.lower[0]) & (whole.frequency < found.upper[-1])
    total = (whole.values[inside] ** 2).sum()
    assert (found.values**2).sum() == pytest.approx(total, rel=3e-3)
    sine = octave_bands(TIME, 2.0 * np.sin(2 * np.pi * 100.0 * TIME), 3)
    band = int(np.abs(sine.center - 100.0).argmin())
    assert sine.values[band] == pytest.approx(np.sqrt(2.0), rel=1e-6)
    assert np.delete(sine.values, band).max() < 1e-6


@pytest.mark.parametrize(
    ("run", "message"),
    [
        (lambda: fourier(TIME, NOISE, scale="power"), "expected a scale of transient, amplitude"),
        (lambda: fourier(TIME, NOISE, window="kaiser"), "expected a window of rectangular, hann"),
        (lambda: psd(TIME, NOISE, resolution=0.1), "resolution: expected 0.25 to 333.3 Hz of a"),
        (lambda: psd(TIME, NOISE, resolution=-1.0), "resolution: expected"),
        (lambda: octave_bands(TIME, NOISE, 5), r"bands of 1/b octave with b of 1, 2, 3, 6"),
        (lambda: octave_bands(TIME[:5], NOISE[:5], 1), "expected a series with a whole band"),
    ],
)
def test_what_cannot_be_is_refused(run, message):
    with pytest.raises(SeriesError, match=message):
        run()
