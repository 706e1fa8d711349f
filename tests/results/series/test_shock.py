"""Shock response spectra against closed forms, Smallwood's coefficients and other integrators."""

import numpy as np
import pytest
from duhamel.results import SeriesError
from duhamel.results.series import octave_frequencies, shock_spectrum
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

PEAK, DURATION = 490.3325, 6e-3
"""50 g [m/s^2], 6 ms"""
STEP = 2e-5
TIME = STEP * np.arange(3001)
"""a multiple of the pulse"""
PULSES = {
    "half-sine": lambda t: np.sin(np.pi * t / DURATION),
    "rectangle": lambda t: np.ones_like(t),
    "sawtooth": lambda t: t / DURATION,
}


def pulse(shape, time=TIME):
    inside = time <= DURATION * (1.0 + 1e-12)
    return np.where(inside, PEAK * PULSES[shape](np.minimum(time, DURATION)), 0.0)


def at(shape, cycles, **options):
    """Values over the peak for natural frequencies of so many cycles in a pulse."""
    frequencies = np.asarray(cycles) / DURATION
    return shock_spectrum(TIME, pulse(shape), frequencies, **options).values / PEAK


def test_the_base_of_a_half_sine_gives_165_hundredths_of_it():
    """Q = 10: 1.65 at f T = 0.8; without damping 1.77, as in the tables of Harris."""
    cycles = np.linspace(0.5, 1.2, 71)
    damped, undamped = at("half-sine", cycles, q=10), at("half-sine", cycles, q=np.inf)
    assert damped.max() == pytest.approx(1.65, abs=5e-3)
    assert undamped.max() == pytest.approx(1.768, abs=5e-4)
    assert 0.75 <= cycles[undamped.argmax()] <= 0.85
    assert 0.78 <= cycles[damped.argmax()] <= 0.86


def test_the_half_sine_without_damping_in_closed_form():
    """f T = c: after the pulse 4 c cos(pi c) / (1 - 4 c^2); within it, for 1/2 < c < 3/2,
    2 c sin(2 pi / (2 c + 1)) / (2 c - 1).
    """
    cycles = np.array([0.6, 0.8, 1.0, 1.4])
    within = at("half-sine", cycles, q=np.inf, span="primary")
    expected = 2 * cycles / (2 * cycles - 1) * np.sin(2 * np.pi / (2 * cycles + 1))
    np.testing.assert_allclose(within, expected, rtol=2e-3)
    cycles = np.array([0.1, 0.3, 0.7, 2.0])
    after = at("half-sine", cycles, q=np.inf, span="residual")
    expected = np.abs(4 * cycles * np.cos(np.pi * cycles) / (1 - 4 * cycles**2))
    np.testing.assert_allclose(after, expected, rtol=1e-4)


def test_a_rectangle_doubles_itself():
    """|2 sin(pi f T)| after the pulse, 2 within it from f T = 1/2 on."""
    cycles = np.array([0.05, 0.2, 0.5, 0.8, 3.0])
    overall = at("rectangle", cycles, q=np.inf)
    expected = np.where(cycles < 0.5, 2 * np.sin(np.pi * cycles), 2.0)
    # the series falls to zero within a step, half a step longer than the pulse
    np.testing.assert_allclose(overall, expected, rtol=0.5 * STEP / DURATION * np.pi)


def test_what_rings_after_a_terminal_sawtooth():
    """sqrt((1 - sin(2a) / a + sin(a)^2 / a^2)) with a = pi f T, undamped: the transform of it."""
    cycles = np.array([0.2, 0.6, 1.0, 1.7, 2.3])
    a = np.pi * cycles
    transform = np.sqrt(1.0 - np.sin(2 * a) / a + (np.sin(a) / a) ** 2)
    found = at("sawtooth", cycles, q=np.inf, span="residual")
    # it falls to zero within a step
    np.testing.assert_allclose(found, transform, rtol=np.pi * cycles.max() * STEP / DURATION)


def test_soft_oscillators_have_the_change_of_velocity():
    """And stiff ones the acceleration itself."""
    change = 2.0 / np.pi * PEAK * DURATION
    soft = shock_spectrum(
        TIME, pulse("half-sine"), [0.01, 0.1, 1.0], q=np.inf, response="pseudo-velocity"
    )
    np.testing.assert_allclose(soft.values, change, rtol=1e-4)
    stiff = shock_spectrum(TIME, pulse("half-sine"), [2500.0, 5000.0], q=10)
    np.testing.assert_allclose(stiff.values, PEAK, rtol=6e-3)


@pytest.mark.parametrize("response", ["absolute", "static", "pseudo-velocity", "displacement"])
@pytest.mark.parametrize("frequency", [40.0, 300.0, 2500.0])
def test_each_response_as_another_integrator_has_it(response, frequency):
    """Of the line between samples, by solve_ivp with its dense output."""
    rng = np.random.default_rng(7)
    step, n, Q = 4e-5, 120, 8.0
    time = step * np.arange(n)
    base = np.cumsum(rng.normal(size=n))
    omega = 2 * np.pi * frequency
    length = time[-1] + 2.0 / frequency

    def rates(t, state):
        z, rate = state
        return rate, -np.interp(t, time, base, right=0.0) - omega / Q * rate - omega**2 * z

    def piece(start, end, state):
        return solve_ivp(
            rates, (start, end), state, method="DOP853", rtol=1e-10, atol=1e-16, dense_output=True
        )

    within = solve_ivp(
        rates,
        (0.0, time[-1]),
        [0, 0],
        method="DOP853",
        rtol=1e-9,
        atol=1e-16,
        max_step=step,
        dense_output=True,
    )
    after = piece(time[-1] * (1 + 1e-12), length, within.y[:, -1])
    z, rate = np.hstack(
        [
            within.sol(np.linspace(0.0, time[-1], 20000)),
            after.sol(np.linspace(*after.t[[0, -1]], 20000)),
        ]
    )
    expected = {
        "absolute": -omega / Q * rate - omega**2 * z,
        "static": -(omega**2) * z,
        "pseudo-velocity": -omega * z,
        "displacement": -z,
    }[response]
    for extreme, value in (("positive", expected.max()), ("negative", expected.min())):
        found = shock_spectrum(
            time, base, [frequency], q=Q, response=response, extreme=extreme
        ).values[0]
        assert found == pytest.approx(value, rel=1.5e-3)
        assert abs(found) <= abs(value) * (1 + 1e-6)


def test_the_primary_response_is_that_of_smallwoods_filter():
    """b_0 = 1 - E sin(K) / K and so on, Smallwood (1981), at the samples."""
    rng = np.random.default_rng(3)
    base = np.concatenate([[0.0], rng.normal(size=400)])
    step, frequency, Q = 1e-4, 100.0, 10.0
    zeta, omega = 0.5 / Q, 2 * np.pi * frequency
    E, K = np.exp(-zeta * omega * step), omega * np.sqrt(1 - zeta**2) * step
    C, S = E * np.cos(K), E * np.sin(K)
    b = [1 - S / K, 2 * (S / K - C), E**2 - S / K]
    response = lfilter(b, [1, -2 * C, E**2], base)
    found = shock_spectrum(
        step * np.arange(len(base)), base, [frequency], q=Q, extreme="positive", span="primary"
    )
    assert response.max() <= found.values[0] * (1 + 1e-12)
    assert found.values[0] == pytest.approx(
        response.max(), rel=0.5 * (np.pi * frequency * step) ** 2
    )


def test_responses_are_found_between_the_samples():
    """At a tenth of the rate the samples of a response miss up to 5 % of its peaks."""
    frequency = 0.1 / STEP
    shifted = [
        shock_spectrum(TIME, pulse("half-sine", TIME - shift), [frequency], q=50).values[0]
        for shift in STEP * np.array([0.0, 0.25, 0.5, 0.75])
    ]
    np.testing.assert_allclose(shifted, shifted[0], rtol=2e-3)


def test_a_turn_of_sign_turns_the_spectra_of_each_sign():
    base = pulse("half-sine")
    for span in ("primary", "residual", "overall"):
        options = {"frequencies": [50.0, 200.0], "span": span}
        high = shock_spectrum(TIME, base, extreme="positive", **options).values
        low = shock_spectrum(TIME, -base, extreme="negative", **options).values
        np.testing.assert_allclose(low, -high, rtol=1e-12)
    both = shock_spectrum(TIME, -base, [50.0, 200.0]).values
    np.testing.assert_allclose(both, -low, rtol=1e-12)


def test_columns_are_spectra_of_their_own():
    base = np.stack([pulse("half-sine"), 2 * pulse("rectangle")], axis=1)
    both = shock_spectrum(TIME, base, [80.0, 400.0]).values
    alone = [shock_spectrum(TIME, column, [80.0, 400.0]).values for column in base.T]
    np.testing.assert_array_equal(both, np.stack(alone, axis=1))


def test_long_records_at_low_frequencies_keep_their_digits():
    """omega h = 6e-6 over a million steps, where direct forms of second order lose theirs."""
    step = 1e-6
    time = step * np.arange(400_001)
    base = np.where(time < 0.1, 1.0, 0.0)
    found = shock_spectrum(time, base, [1.0], q=np.inf, response="pseudo-velocity").values[0]
    assert found == pytest.approx(2 * np.sin(np.pi * 0.1) / (2 * np.pi), rel=2e-5)


def test_frequencies_of_twelve_in_an_octave():
    found = octave_frequencies(500.0, 2000.0)
    assert len(found) == 25
    np.testing.assert_allclose(found[[0, 12, 24]], [500.0, 1000.0, 2000.0], rtol=1e-14)


def test_by_default_they_end_at_a_tenth_of_the_rate():
    found = shock_spectrum(TIME, pulse("half-sine")).frequency
    assert found[0] >= 5.0
    assert 5000.0 * 2 ** (-1 / 12) < found[-1] <= 5000.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"frequencies": [5001.0]}, r"5001 Hz: expected frequencies up to 5000 Hz, a tenth of the"),
        ({"frequencies": [0.0]}, "expected frequencies .* above zero"),
        ({"frequencies": []}, "expected frequencies .* above zero"),
        ({"q": 0.5}, "q: expected a quality factor above 0.5, found 0.5"),
        ({"q": np.nan}, "q: expected a quality factor"),
        ({"response": "velocity"}, "response: expected one of absolute, static, .* 'velocity'"),
        ({"span": "late"}, "span: expected one of"),
    ],
)
def test_what_cannot_be_is_refused(options, message):
    with pytest.raises(SeriesError, match=message):
        shock_spectrum(TIME, pulse("half-sine"), **options)


def test_what_rings_without_damping_rings_on():
    """The residual response does not depend on how long the record goes on at rest."""
    options = {"frequencies": [30.0, 150.0, 900.0], "q": np.inf, "span": "residual"}
    short = TIME[TIME < 1.5 * DURATION]
    for extreme in ("positive", "negative"):
        whole = shock_spectrum(TIME, pulse("half-sine"), extreme=extreme, **options)
        ended = shock_spectrum(short, pulse("half-sine", short), extreme=extreme, **options)
        np.testing.assert_allclose(ended.values, whole.values, rtol=1e-9)
