"""Signals: their values, the areas of their samples, their derivatives, and what they do to
momentum.
"""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Force,
    Function,
    Harmonic,
    Impulse,
    Model,
    ModelError,
    Polynomial,
    Pulse,
    Revolute,
    RigidBody,
    Settings,
    SmoothFunction,
    Spline,
    Steps,
    Table,
    Torque,
    simulate,
)

H = 0.01
T = H * np.arange(201)


def area(samples):
    """By the trapezoidal rule, as the integrator sees it."""
    return H * (samples.sum() - 0.5 * (samples[0] + samples[-1]))


@pytest.mark.parametrize("at", [0.0, 0.3, 0.303, 0.3077, 0.005, 0.0099, 1.2345])
def test_the_area_under_a_step_is_exact_wherever_it_jumps(at):
    samples = Steps((at,), (2.0,)).samples(T, H)
    assert area(samples) == pytest.approx(2.0 * (T[-1] - at), rel=1e-14)
    # and its value is exact away from the jump
    far = np.abs(T - at) > H
    assert (samples[far] == 2.0 * (T[far] > at)).all()


@pytest.mark.parametrize(
    ("start", "end"), [(0.0, 0.05), (0.1, 0.1001), (0.023, 0.791), (0.0037, 0.004)]
)
def test_the_area_under_a_pulse_is_exact(start, end):
    samples = Pulse(-3.0, start, end).samples(T, H)
    assert area(samples) == pytest.approx(-3.0 * (end - start), rel=1e-12)


def test_steps_follow_one_another():
    signal = Steps((0.1, 0.5, 0.9), (1.0, -2.0, 0.5))
    assert [signal(t) for t in (0.0, 0.0999, 0.1, 0.4999, 0.5, 0.95)] == [
        0.0,
        0.0,
        1.0,
        1.0,
        -2.0,
        0.5,
    ]
    assert area(signal.samples(T, H)) == pytest.approx(0.4 - 0.8 + 0.5 * 1.1, rel=1e-13)
    # on the grid a jump is met half way, but at the start the load is there in full
    assert signal.samples(np.array([0.1]), H) == pytest.approx([0.5])
    assert Steps((0.0,), (1.0,)).samples(np.array([0.0]), H) == [1.0]


@pytest.mark.parametrize("at", [0.0, 0.5, 0.503, 0.004, 1.0])
def test_the_area_under_an_impulse_is_exact(at):
    samples = Impulse(0.2, at).samples(T, H)
    assert np.count_nonzero(samples) == 1
    assert area(samples) == pytest.approx(0.2, rel=1e-14)


@pytest.mark.parametrize("chunk", [1, 7, 50])
def test_samples_do_not_depend_on_how_they_are_asked_for(chunk):
    for signal in (
        Steps((0.0, 0.123), (1.0, -1.0)),
        Pulse(2.0, 0.07, 0.0811),
        Impulse(1.0, 0.25),
        Harmonic(1.0, 3.0),
    ):
        parts = [signal.samples(T[i : i + chunk], H) for i in range(0, len(T), chunk)]
        np.testing.assert_array_equal(np.concatenate(parts), signal.samples(T, H))


@pytest.mark.parametrize(
    "signal",
    [
        Constant(2.5),
        Harmonic(1.5, 3.0, 0.4, -0.2),
        Polynomial((1.0, -2.0, 3.0, 0.5)),
        Polynomial((4.0,)),
        Spline((0.0, 0.3, 0.5), (1.0, 3.0, 2.0)),
    ],
    ids=lambda signal: type(signal).__name__,
)
def test_derivatives_of_motions(signal):
    t, d = 0.37, 1e-3
    near, far = (np.array([signal(t - k * d), signal(t), signal(t + k * d)]) for k in (1, 2))
    first = (8 * (near[2] - near[0]) - (far[2] - far[0])) / (12 * d)
    second = (16 * (near[0] + near[2]) - (far[0] + far[2]) - 30 * near[1]) / (12 * d * d)
    assert signal.derivatives(t) == pytest.approx((first, second), rel=1e-7, abs=1e-8)


def test_values_of_signals():
    assert Table((0.0, 1.0, 3.0), (1.0, 2.0, -2.0))(2.0) == 0.0
    assert Table((0.0, 1.0), (1.0, 2.0))(-1.0) == 1.0
    assert Table((0.0, 1.0), (1.0, 2.0))(5.0) == 2.0
    assert Harmonic(2.0, 0.25, 0.0, 1.0)(1.0) == pytest.approx(3.0)
    assert Polynomial((1.0, 0.0, 2.0))(3.0) == 19.0
    assert Function(np.cos)(0.0) == 1.0
    assert Pulse(2.0, 1.0, 2.0)(1.5) == 2.0
    assert Pulse(2.0, 1.0, 2.0)(2.0) == 0.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Steps((0.0, 1.0), (1.0,)), "as many values as times, got 2 times and 1 values"),
        (lambda: Steps((), ()), "got 0 times and 0 values"),
        (
            lambda: Table((0.0, 0.0), (1.0, 2.0)),
            r"times of a signal must increase, got \[0.0, 0.0\]",
        ),
        (lambda: Pulse(1.0, 0.2, 0.1), "must end after it starts, got start = 0.2, end = 0.1"),
        (lambda: Spline((0.0,), (1.0,)), "a spline needs two or more points, got 1"),
        (lambda: Spline((0.0, 1.0), (1.0,)), "as many values as times, got 2 times and 1 values"),
        (
            lambda: Spline((0.0, 1.0, 1.0 + 4e-16), (0.0, 1e90, 0.0)),
            r"too close for its values: .* got times 1.0 and 1.0000000000000004",
        ),
        (
            lambda: Table((0.0, 1e-310), (0.0, 1.0)),
            r"too close for its values: .* got times 0.0 and 1e-310",
        ),
        (lambda: Impulse(1.0, -0.1), "must act at t >= 0, got at = -0.1"),
    ],
)
def test_errors_say_what_they_found(make, message):
    with pytest.raises(ModelError, match=message):
        make()


@pytest.mark.parametrize("rho_inf", [0.9, 0.5])
@pytest.mark.parametrize(
    ("signal", "impulse"),
    [
        (Impulse(0.2, 0.0), 0.2),
        (Impulse(0.2, 0.5), 0.2),
        (Pulse(3.0, 0.0, 0.25), 0.75),
        (Pulse(3.0, 0.1037, 0.2222), 0.3555),
        (Steps((0.0, 0.3, 0.6), (1.0, -2.0, 0.0)), -0.3),
    ],
)
def test_a_body_gains_the_momentum_of_its_loads(signal, impulse, rho_inf):
    """m v = the area under the load, to rounding, once the scheme has forgotten the jumps; and
    likewise J omega.
    """
    loads = (Force("body", [0, 0, 1], signal), Torque("body", [2, 0, 0], signal))
    model = Model(
        {"body": RigidBody(2.0, [0.5, 1.0, 1.5])},
        (),
        loads,
        settings=Settings(t_end=2.0, step=H, rho_inf=rho_inf),
    )
    v = simulate(model).body("body").v[-1]
    assert 2.0 * v[2] == pytest.approx(impulse, rel=1e-10)
    assert 0.5 * v[3] == pytest.approx(2.0 * impulse, rel=1e-10)


def test_a_smooth_function_drives_a_joint():
    """Its derivatives are those of the motion from the first step on."""
    swing = SmoothFunction(
        lambda t: 0.3 * np.sin(5.0 * t),
        lambda t: 1.5 * np.cos(5.0 * t),
        lambda t: -7.5 * np.sin(5.0 * t),
    )
    model = Model(
        bodies={"arm": RigidBody(1.0, [1.0, 1.0, 1.0])},
        joints=(Revolute("ground", "arm", [0, 0, 1], name="drive", angle=swing),),
        settings=Settings(t_end=2.0, step=1e-3),
    )
    results = simulate(model)
    coordinates = results.joint("drive").coordinates
    np.testing.assert_allclose(coordinates["angle"], 0.3 * np.sin(5.0 * results.time), atol=1e-12)
    np.testing.assert_allclose(
        coordinates["angle_rate"], 1.5 * np.cos(5.0 * results.time), atol=2e-5
    )


def swing(t):
    return 0.3 * np.sin(5.0 * t)


def test_a_spline_through_points_of_a_motion_is_near_it():
    """Of order four away from the ends; through the points, straight beyond them, and smooth
    everywhere.
    """
    t = np.linspace(0.7, 1.3, 201)
    errors = []
    for n in (21, 41):
        times = np.linspace(0.0, 2.0, n)
        spline = Spline(tuple(times), tuple(swing(times)))
        np.testing.assert_allclose(spline.samples(times, H), swing(times), rtol=0, atol=1e-15)
        errors.append(np.abs(spline.samples(t, H) - swing(t)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.2)
    for end, outwards in ((0.0, -1.0), (2.0, 1.0)):
        slope, bend = spline.derivatives(end)
        assert bend == pytest.approx(0.0, abs=1e-12)
        assert spline.derivatives(end + outwards) == pytest.approx((slope, 0.0), abs=1e-12)
        assert spline(end + outwards) == pytest.approx(spline(end) + outwards * slope, rel=1e-12)


def test_a_spline_drives_and_loads_as_the_motion_that_it_passes_through():
    """The angle of a driven joint and its rate; the momentum that a force has given."""
    times = np.linspace(0.0, 1.2, 121)
    measured = Spline(tuple(times), tuple(swing(times)))
    body = RigidBody(2.0, [1.0, 1.0, 1.0])
    driven = Model(
        bodies={"arm": body},
        joints=(Revolute("ground", "arm", [0, 0, 1], name="drive", angle=measured),),
        settings=Settings(t_end=1.0, step=1e-3),
    )
    coordinates = simulate(driven).joint("drive").coordinates
    t = 1e-3 * np.arange(1001)
    np.testing.assert_allclose(coordinates["angle"], swing(t), rtol=0, atol=1e-7)
    np.testing.assert_allclose(coordinates["angle_rate"], 1.5 * np.cos(5.0 * t), rtol=0, atol=1e-4)
    pushed = Model(
        {"arm": body},
        loads=(Force("arm", [1, 0, 0], measured),),
        settings=Settings(t_end=1.0, step=1e-3),
    )
    np.testing.assert_allclose(
        simulate(pushed).body("arm").v[:, 0],
        0.3 / 5.0 * (1.0 - np.cos(5.0 * t)) / 2.0,
        rtol=0,
        atol=1e-6,
    )
