"""Profiles, noise, recorded and composed signals: values, derivatives, integrals, areas."""

import math
import re
from itertools import pairwise

import numpy as np
import pytest
from duhamel.solver import (
    Chirp,
    Constant,
    Delayed,
    Function,
    HalfSine,
    Harmonic,
    Haversine,
    Impulse,
    Input,
    LogarithmicChirp,
    ModelError,
    Noise,
    Polynomial,
    PrescribedRotation,
    Product,
    Pulse,
    Recorded,
    RecordedSpline,
    Sawtooth,
    ShapedNoise,
    SmoothFunction,
    SmoothStep,
    Spline,
    Steps,
    Sum,
    Table,
    Trapezoid,
    Window,
)
from duhamel.solver.signals.attitude import Attitude
from duhamel.solver.signals.quadrature import Integrals, is_closed
from duhamel.solver.signals.signal import breaks_of, derivatives_of, is_smooth, values_of
from scipy.integrate import quad

H = 0.01
T = H * np.arange(201)
SMOOTH_STEP = SmoothStep((-1.0, 3.0), (0.2, 1.1))
SWEEP = LogarithmicChirp(2.0, (1.5, 9.0), (0.1, 1.3), 0.4)
WINDOW = Window((0.13, 1.62), 0.4, 0.5)
TURNED = np.linalg.qr(np.arange(9.0).reshape(3, 3) ** 2 + np.eye(3))[0]
SMOOTH = {
    "smooth step": SMOOTH_STEP,
    "haversine": Haversine((2.0, 0.5), (0.2, 1.1)),
    "window": WINDOW,
    "chirp": Chirp(2.0, (8.0, 1.0), (0.1, 1.3), 0.4),
    "logarithmic chirp": SWEEP,
    "steady logarithmic chirp": LogarithmicChirp(2.0, (4.0, 4.0), (0.1, 1.3)),
    "noise": Noise(0.3, (1.0, 9.0), 4.0, 3),
    "shaped noise": ShapedNoise(((1.0, 0.1), (3.0, 0.9), (9.0, 0.01)), 4.0),
    "slow harmonic": Harmonic(2.0, 1e-3, 0.7, 0.1),
    "constant harmonic": Harmonic(2.0, 0.0, 0.7),
    "sum": Sum((SMOOTH_STEP, Harmonic(0.3, 2.0), Constant(1.0))),
    "product": Product((SWEEP, WINDOW, Polynomial((1.0, 2.0)))),
    "delayed": Delayed(0.33, Product((SWEEP, WINDOW))),
    "earlier": Delayed(-0.25, SMOOTH_STEP),
}
CORNERED = {
    "half sine": HalfSine(3.0, 0.31, 0.237),
    "trapezoid": Trapezoid(3.0, 0.7, 0.1, 0.25, 0.237),
    "rectangle": Trapezoid(3.0, 0.7, 0.0, 0.0, 0.237),
    "sawtooth": Sawtooth(3.0, 0.31, 0.237),
    "from before the start": HalfSine(3.0, 0.31, -0.1),
    "table": Table((0.1, 0.5, 0.9), (1.0, -2.0, 0.5)),
    "steps": Steps((0.1, 0.5, 0.9), (1.0, -2.0, 0.5)),
    "pulse": Pulse(2.0, 0.3, 0.8),
    "spline": Spline((0.1, 0.3, 0.5), (1.0, 3.0, 2.0)),
    "cut": Product((Harmonic(1.0, 3.0), Pulse(2.0, 0.3037, 0.8))),
    "later": Delayed(0.1234, Sum((HalfSine(3.0, 0.31), Pulse(2.0, -0.05, 0.33)))),
    "a function": Function(lambda t: np.cos(3.0 * t) ** 3),
}
ALL = SMOOTH | CORNERED


def by(signals):
    return pytest.mark.parametrize("signal", signals.values(), ids=signals.keys())


def inside(signal, d):
    """Times away from breaks."""
    t = np.linspace(0.0171, 1.9, 53)
    near = [np.abs(t - time) < 3 * d for time in breaks_of(signal)]
    return t[~np.any(near, axis=0)] if near else t


@by(SMOOTH)
def test_derivatives_are_those_of_the_values(signal):
    d = 3e-4
    t = inside(signal, d)
    values = {k: signal.values_at(t + k * d) for k in (-2, -1, 0, 1, 2)}
    first = (8 * (values[1] - values[-1]) - (values[2] - values[-2])) / (12 * d)
    second = 16 * (values[1] + values[-1]) - (values[2] + values[-2]) - 30 * values[0]
    found = np.array([signal.derivatives(time) for time in t.tolist()]).T
    np.testing.assert_allclose(found[0], first, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(found[1], second / (12 * d * d), rtol=1e-5, atol=1e-4)


@by(SMOOTH)
def test_smooth_signals_have_no_jumps_of_value_or_rate(signal):
    assert is_smooth(signal)
    for time in breaks_of(signal):
        before, after = (
            np.array([signal(time + d), signal.derivatives(time + d)[0]]) for d in (-1e-9, 1e-9)
        )
        np.testing.assert_allclose(before, after, atol=1e-5)


@by(ALL)
def test_integrals_are_those_of_the_values(signal):
    """Against adaptive quadrature between the breaks, by another code."""
    times = np.array([0.05, 0.33, 0.78, 1.9])
    once, twice = Integrals(signal)(times)
    for k, end in enumerate(times):
        cuts = [0.0, *sorted(b for b in breaks_of(signal) if 0.0 < b < end), end]
        rounds = {"epsabs": 1e-13, "epsrel": 1e-13, "limit": 200}
        expected = [
            sum(quad(f, a, b, **rounds)[0] for a, b in pairwise(cuts))
            for f in (signal, lambda s, end=end: (end - s) * signal(s))
        ]
        assert (once[k], twice[k]) == pytest.approx(expected, rel=1e-11, abs=1e-12)


@by(ALL)
def test_values_of_many_times_are_those_of_each(signal):
    if hasattr(signal, "values_at"):
        times = T.reshape(3, 67)
        one_by_one = [[signal(t) for t in row] for row in times.tolist()]
        np.testing.assert_allclose(signal.values_at(times), one_by_one, rtol=1e-13, atol=1e-15)


@by(ALL)
@pytest.mark.parametrize("chunk", [1, 7])
def test_samples_and_integrals_do_not_depend_on_how_they_are_asked_for(signal, chunk):
    parts = [signal.samples(T[i : i + chunk], H) for i in range(0, len(T), chunk)]
    np.testing.assert_array_equal(np.concatenate(parts), signal.samples(T, H))
    integrals = Integrals(signal)
    parts = [integrals(T[i : i + chunk])[1] for i in range(0, len(T), chunk)]
    np.testing.assert_array_equal(np.concatenate(parts), Integrals(signal)(T)[1])


DRIVES = SMOOTH | {
    "a turning axis by a vector": Attitude((SWEEP, SMOOTH_STEP, WINDOW), "vector").axis(1, TURNED)[
        2
    ],
    "a turning axis by angles": Attitude((SWEEP, SMOOTH_STEP, WINDOW), "angles").axis(0, TURNED)[1],
    "a function of arrays": SmoothFunction(np.sin, np.cos, lambda t: -np.sin(t), vectorized=True),
    "a function of numbers": SmoothFunction(math.sin, math.cos, lambda t: -math.sin(t)),
}


@by(DRIVES)
def test_values_and_derivatives_of_drives_do_not_depend_on_how_they_are_asked_for(signal):
    """To the bit, so that a run that is continued, in other blocks of steps, is the same; and they
    are those of one time."""
    found = np.array([values_of(signal, T), *derivatives_of(signal, T)])
    for chunk in (1, 7):
        blocks = [T[i : i + chunk] for i in range(0, len(T), chunk)]
        parts = [np.array([values_of(signal, t), *derivatives_of(signal, t)]) for t in blocks]
        np.testing.assert_array_equal(np.concatenate(parts, axis=1), found)
    one_by_one = np.array([[signal(t), *signal.derivatives(t)] for t in T.tolist()]).T
    np.testing.assert_allclose(found, one_by_one, rtol=1e-12, atol=1e-12)


def test_a_function_of_arrays_that_does_not_return_one_is_an_error():
    with pytest.raises(ModelError, match=r"expected 201 values at 201 times, got an array of sha"):
        Function(np.max, vectorized=True).samples(T, H)


def area(samples, h):
    return h * (samples.sum() - 0.5 * (samples[0] + samples[-1]))


@pytest.mark.parametrize("start", [0.0, 0.05, 0.0537, 0.0571])
@pytest.mark.parametrize("duration", [2e-4, 3.3e-3, 0.02, 0.031, 0.53])
def test_the_area_of_a_pulse_is_exact_however_short(start, duration):
    """Of many steps, some, one, or a part of one: of h = 0.01."""
    swept = Product((Chirp(1.0, (1.0, 40.0), (0.0, 2.0), 1.0), HalfSine(3.0, duration, start)))
    for signal, expected in (
        (HalfSine(3.0, duration, start), 6.0 / np.pi * duration),
        (Sawtooth(3.0, duration, start), 1.5 * duration),
        (Trapezoid(3.0, duration, 0.2 * duration, 0.0, start), 2.7 * duration),
        (Window((start, start + duration), 0.4 * duration, 0.5 * duration), 0.55 * duration),
        (SmoothStep((0.0, 2.0), (start, start + duration)), 2.0 * (2.0 - start - 0.5 * duration)),
        (swept, Integrals(swept)(np.array([2.0]))[0][0]),
        (Delayed(0.011, HalfSine(3.0, duration, start)), 6.0 / np.pi * duration),
    ):
        assert area(signal.samples(T, H), H) == pytest.approx(expected, rel=1e-9)


def test_profiles_begin_and_end_where_they_say():
    step = SmoothStep((-1.0, 3.0), (0.2, 1.1))
    assert [step(t) for t in (0.0, 0.2, 0.65, 1.1, 9.0)] == pytest.approx([-1, -1, 1, 3, 3])
    assert step.derivatives(0.65)[0] == pytest.approx(4.0 * 15.0 / 8.0 / 0.9)
    assert Haversine((0.0, 1.0), (0.0, 1.0))(1.0 / 3.0) == pytest.approx(0.25)
    assert [HalfSine(2.0, 1.0)(t) for t in (-0.1, 0.5, 1.0)] == [0.0, 2.0, 0.0]
    assert [Sawtooth(2.0, 1.0, 1.0)(t) for t in (1.0, 1.5, 1.999, 2.0)] == pytest.approx(
        [0.0, 1.0, 1.998, 0.0]
    )
    pulse = Trapezoid(2.0, 1.0, 0.2, 0.4)
    assert [pulse(t) for t in (0.1, 0.2, 0.6, 0.8, 1.0)] == pytest.approx([1.0, 2.0, 2.0, 1.0, 0.0])
    assert Trapezoid(2.0, 1.0, 0.0, 0.4).jumps == (0.0,)


@pytest.mark.parametrize("kind", [Chirp, LogarithmicChirp])
def test_the_frequency_of_a_chirp_goes_from_one_to_the_other(kind):
    sweep = kind(1.0, (2.0, 50.0), (0.0, 1.0))
    middle = {Chirp: 26.0, LogarithmicChirp: 10.0}[kind]
    for t, frequency in ((-0.3, 2.0), (0.0, 2.0), (0.5, middle), (1.0, 50.0), (1.7, 50.0)):
        value, (rate, _) = sweep(t), sweep.derivatives(t)
        assert rate**2 == pytest.approx((2 * np.pi * frequency) ** 2 * (1.0 - value**2), abs=1e-8)


def test_noise_has_the_density_that_was_asked_for():
    """Its mean square is the integral of the density, and so in every part of the band."""
    period, n = 8.0, 4096
    t = period * np.arange(n) / n
    flat = Noise(0.3, (5.3, 40.0), period, 7)
    corners = ((10.0, 0.02), (20.0, 0.3), (40.0, 0.15), (80.0, 0.01))
    shaped = ShapedNoise(corners, period, 7)
    f = np.linspace(10.0, 80.0, 200_001)
    log_density = np.interp(np.log(f), *np.log(np.array(corners)).T)
    expected = np.trapezoid(np.exp(log_density), f)
    for noise, square in ((flat, 0.3 * 34.7), (shaped, expected)):
        assert np.mean(noise.values_at(t) ** 2) == pytest.approx(square, rel=1e-8)
        assert noise.rms == pytest.approx(np.sqrt(square), rel=1e-8)
    lines = 2.0 * np.abs(np.fft.rfft(shaped.values_at(t)) / n) ** 2 * period
    at = np.fft.rfftfreq(n, period / n)
    inner = (at > 11) & (at < 79) & (np.abs(at - 20.0) > 0.2) & (np.abs(at - 40.0) > 0.2)
    density = np.exp(np.interp(np.log(at[inner]), *np.log(np.array(corners)).T))
    np.testing.assert_allclose(lines[inner], density, rtol=1e-3)
    np.testing.assert_allclose(flat.values_at(t + period), flat.values_at(t), atol=1e-11)


def test_noise_of_a_seed_is_the_same_for_ever_and_of_another_different():
    noise = Noise(0.3, (5.0, 40.0), 8.0, 7)
    other = Noise(0.3, (5.0, 40.0), 8.0, 8)
    bits = np.random.PCG64(7).random_raw(281)
    # lines at k / 8 Hz, k = 40..320, the first and the last in half
    k = np.arange(40, 321)
    amplitudes = np.sqrt(2 * 0.3 / 8.0 * np.where((k == 40) | (k == 320), 0.5, 1.0))
    waves = amplitudes * np.cos(2 * np.pi * (k / 8.0 * 0.77 + (bits >> np.uint64(11)) / 2.0**53))
    assert noise(0.77) == pytest.approx(waves.sum(), rel=1e-10)
    assert abs(noise(0.77) - other(0.77)) > 0.01


CSV = """\ufeff# shaker, run 7
t [ms], ax, "a, y"
0, 1.0, -1
10, 2.0, 0.5
25, -1e0, 3

40, 0.5, 2
"""


@pytest.fixture
def sheet(tmp_path):
    def write(text):
        path = tmp_path / "shaker.csv"
        path.write_text(text, encoding="utf-8")
        return str(path)

    return write


def test_a_column_of_a_file_is_read_with_its_units_and_its_shift(sheet):
    path = sheet(CSV)
    record = Recorded(path, "ax", 9.81, time_scale=1e-3, shift=0.1)
    table = Table((0.1, 0.11, 0.125, 0.14), 9.81 * np.array([1.0, 2.0, -1.0, 0.5]))
    t = np.linspace(0.0, 0.2, 41)
    np.testing.assert_allclose(record.samples(t, H), table.samples(t, H), rtol=1e-14)
    assert not is_smooth(record)
    spline = RecordedSpline(path, 3, 9.81, "t [ms]", 1e-3, 0.1)
    like = Spline((0.1, 0.11, 0.125, 0.14), 9.81 * np.array([-1.0, 0.5, 3.0, 2.0]))
    np.testing.assert_allclose(spline.samples(t, H), like.samples(t, H), rtol=1e-13)
    assert spline.derivatives(0.117) == pytest.approx(like.derivatives(0.117))
    np.testing.assert_allclose(Integrals(record)(t), Integrals(table)(t), rtol=1e-13)
    assert is_closed(record)
    assert record.end == pytest.approx(0.14)


@pytest.mark.parametrize(
    "text",
    [
        "0;1\n0,025;1,5\n0,05;2\n",
        "t,a,\n0,1.5,,\n0.1,2.5,,\n",
        "0;1,5\n0,1;2,5\n",
        "t;a\n0;1,5\n0,1;2,5\n",
        "0\t1.5\n0.1\t2.5\n",
        "0 1.5\n .1   2.5 \n",
    ],
)
def test_separators_and_decimal_commas(sheet, text):
    assert Recorded(sheet(text), 2)(0.05) == pytest.approx(2.0)


def test_a_file_that_has_changed_is_read_anew(sheet):
    assert Recorded(sheet("0,1\n1,2\n"), 2)(0.5) == 1.5
    assert Recorded(sheet("0,1\n1,20\n"), 2)(0.5) == 10.5


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        (CSV, "az", "no column 'az'; there are: 't [ms]', 'ax', 'a, y'"),
        (CSV, 4, "no column 4; there are 3, from 1 on"),
        (CSV, 1, "time and column are both 1"),
        ("t,a\n0,1\n1,x\n", "a", "line 3, column 'a': expected a number, found 'x'"),
        ("t,a\n0,1\n\n1\n", "a", "line 4, column 'a': expected a number, found nothing"),
        ("t,a\n0,1\n1,nan\n", "a", "line 3, column 'a': expected a number, found 'nan'"),
        ("t,a\n0,1\n0,2\n", "a", "line 3, column 1: times must increase, found 0 after 0"),
        ("t,a\n0,1\n", "a", "expected two or more rows, found 1"),
        ("t,a,a\n0,1,1\n1,1,1\n", "a", "more than one column is named 'a'"),
        ("t,a\n0,5,1,5\n1,0,2,5\n", "a", "line 2: expected 2 columns, as in the first"),
        ("t;a\n0.5;1,234\n1.5;2\n", "a", "line 2, column 1: expected a number, found '0.5'"),
        ("nan,nan\n0,1\n1,2\n", 2, "line 1, column 1: expected a number, found 'nan'"),
        ("# nothing\n", 2, "expected rows of numbers, found none"),
    ],
)
def test_errors_of_a_file_name_line_and_column(sheet, text, column, message):
    path = sheet(text)
    with pytest.raises(ModelError, match=re.escape(path) + ".*" + re.escape(message)):
        Recorded(path, column)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(ModelError, match=r"nowhere\.csv: not a readable file"):
        Recorded(str(tmp_path / "nowhere.csv"), 2)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: SmoothStep((0, 1), (1, 1)), r"over: expected two times, start and end"),
        (lambda: SmoothStep((0, np.nan), (0, 1)), r"values: expected two numbers, from and to"),
        (lambda: SmoothStep({0, 1}, (0, 1)), r"values: expected two numbers, from and to"),
        (lambda: Sum((Harmonic,)), "signals: expected a list of signals"),
        (lambda: HalfSine(1.0, 0.0), "duration: expected a positive number"),
        (lambda: Trapezoid(1.0, 1.0, 0.6, 0.5), "must last as long as its rise and fall"),
        (lambda: Window((0, 1), 0.6, 0.5), "must last as long as its rise and fall"),
        (lambda: Chirp(1.0, (0, 5), (0, 1)), "two positive frequencies"),
        (lambda: Noise(1.0, (5, 2), 1.0), r"increasing frequencies, got \[5.0, 2.0\]"),
        (lambda: Noise(1.0, (5, 5.5), 1.0), "expected 1 to 100000 lines.*got 0.5"),
        (lambda: Noise(1.0, (5, 9), 1.0, -1), "seed: expected an integer of at least 0, got -1"),
        (lambda: ShapedNoise(((5, 1), (4, 1)), 1.0), "spectrum: expected two or more pairs"),
        (lambda: Sum(()), "signals: expected a list of signals"),
        (lambda: Sum((1.0, Constant(2.0))), "signals: expected a list of signals"),
        (lambda: Sum((Input("a"), Constant(1.0))), "an input cannot be part of a sum"),
        (
            lambda: Product((Impulse(1.0, 0.0), Constant(1.0))),
            "an impulse cannot be part of a product",
        ),
        (lambda: Delayed(1.0, Sum((Impulse(1.0, 0.0),))), "an impulse cannot be part of a delay"),
        (
            lambda: PrescribedRotation("m", "a", [0, 0, 1], Product((HalfSine(1, 1),))),
            "angle: expected a smooth signal .*, got product",
        ),
    ],
)
def test_what_is_no_such_signal_is_refused(make, message):
    with pytest.raises(ModelError, match=message):
        make()
