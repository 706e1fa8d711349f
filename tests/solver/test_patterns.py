"""Load patterns: equal to the unreduced model under the same loads, and to closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.preprocess.body.body import Damping, Impulse
from duhamel.solver import (
    Constant,
    Contact,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Function,
    Harmonic,
    Impact,
    Input,
    Model,
    ModelError,
    PatternLoad,
    RigidBody,
    Settings,
    Simulator,
    Start,
    StartFrom,
    Steps,
    Torque,
    read_model,
    simulate,
    write_model,
)
from duhamel.solver.start.initial import initialize
from duhamel.superelement import read, write
from scipy.spatial.transform import Rotation

from .spread import SENSORS, SpreadReference, channelled_beam, with_pattern_of
from .test_tangents import Point, difference, in_space, linearize
from .transformed import turned

H = 2e-4
EI, MASS_PER_LENGTH, L = 5.5, 0.0858, 0.5
GUST = Function(lambda t: 2.0 + np.sin(90.0 * t))


@pytest.fixture(scope="module")
def windy(tmp_path_factory):
    """With two per cent of damping."""
    damping = Damping.model_validate({"modal": 0.02})
    return channelled_beam(tmp_path_factory.mktemp("windy"), damping=damping)


def cantilever(element, load=1.0, **settings):
    """Clamped at the origin, under a load along its length from t = 0 on."""
    signal = Constant(load) if isinstance(load, float) else load
    return Model(
        {"beam": FlexibleBody(element)},
        [Fixed("ground", "beam.root", name="clamp")],
        [PatternLoad("beam", "wind", signal)],
        settings=Settings(**{"t_end": 0.02, "step": H, **settings}),
    )


@pytest.mark.parametrize("rho_inf", [0.9, 0.5])
def test_a_beam_in_the_wind_moves_like_its_unreduced_model(windy, hub_and_beam, rho_inf):
    """On a spherical pivot, spinning, under gravity, with damping and a force on its tip."""
    torque = Torque("hub", [0, 0, 0.2], Steps((0.0, 0.05), (1.0, -1.0)))
    tip = Force("beam.tip", [0.3, 0.0, 1.0], Constant(0.5))
    gravity, spin = np.array([0, -3.0, -9.81]), (1.0, 2.0, 5.0)
    settings = {"t_end": 500 * H, "step": H, "rho_inf": rho_inf, "gravity": gravity}
    loads = (torque, PatternLoad("beam", "wind", GUST), tip)
    model = hub_and_beam(windy, 0.5, "spherical", spin, loads=loads, **settings)
    hub = model.bodies["hub"]
    rim = hub.frames["rim"].position
    reference = SpreadReference(
        windy.structure,
        hub.inertia,
        hub.mass,
        rim,
        H,
        rho_inf,
        revolute=False,
        gravity=gravity,
        zeta=0.02,
    )
    results = simulate(model)
    t = results.time
    on_tip = np.outer(tip.signal.samples(t, H), tip.direction)
    amplitude = GUST.samples(t, H)
    R, u, v, _ = reference.run(
        torque.signal.samples(t, H) * 0.2, np.column_stack([on_tip, amplitude]), spin=spin
    )
    found_u = np.hstack([results.frame("beam.root").u, results.frame("beam.tip").u])
    turn = Rotation.from_quat(results.body("hub").R, scalar_first=True)
    errors = [
        (turn * Rotation.from_matrix(R).inv()).magnitude().max(),
        np.abs(found_u - u).max() / np.abs(u).max(),
        np.abs(results.body("hub").v[:, 3:] - v[:, 3:6]).max() / np.abs(v[:, 3:6]).max(),
        np.abs(results.body("beam").v[:, :3] - v[:, 6:9]).max() / np.abs(v[:, 6:9]).max(),
    ]
    assert max(errors) < 1e-10, errors
    assert results.pattern("beam.wind").load == pytest.approx(amplitude)


@pytest.mark.parametrize("rule", ["consistent", "paper"])
@pytest.mark.parametrize("history", ["recursive", "direct", "fft"])
def test_a_pattern_that_is_a_force_on_an_interface_moves_the_body_as_that(coarse, history, rule):
    """Along the beam, where neither the lever of the force changes nor its direction."""
    along = np.array([1.0, 0.0, 0.0])
    body = FlexibleBody(with_pattern_of(coarse, "tip", along), Start(rotation=[0.3, -0.2, 0.5]))
    signal = Steps((0.0, 0.01), (1.0, -0.5))
    settings = Settings(t_end=0.03, step=1e-4, history=history, rule=rule)
    model = Model({"beam": body}, settings=settings)
    found, expected = (
        simulate(replace(model, loads=[load]))
        for load in (
            PatternLoad("beam", "same", signal),
            Force("beam.tip", along, signal, follower=True),
        )
    )
    for name in ("root", "tip"):
        a, b = found.frame(f"beam.{name}").u, expected.frame(f"beam.{name}").u
        assert np.abs(a - b)[:, 0].max() < 1e-12 * np.abs(b).max()
        # a force of 1 N that is turned there and back is off by 1e-16 N, in bending too
        assert np.abs(a - b).max() < 1e-16 * L**2 / EI
    np.testing.assert_allclose(found.body("beam").x, expected.body("beam").x, rtol=0, atol=1e-13)
    np.testing.assert_allclose(
        found.pattern("beam.same").displacement, expected.frame("beam.tip").u[:, 0], atol=1e-15
    )
    for energy in ("work", "elastic", "numerical"):
        a, b = getattr(found.energy, energy), getattr(expected.energy, energy)
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-11 * np.abs(expected.energy.work).max())


@pytest.mark.parametrize("history", ["direct", "fft"])
def test_a_body_known_by_its_kernel_alone_moves_as_one_with_modes(tmp_path, history):
    damping = Damping.model_validate({"rayleigh": {"stiffness": 1e-5, "mass": 2.0}})
    impulse = Impulse(step=H, steps=110, rho_inf=0.9, method="march")
    body = channelled_beam(tmp_path, damping=damping, impulse=impulse)
    write(tmp_path / "marched.h5", body.element)
    element = read(tmp_path / "marched.h5")
    assert element.modes is None
    expected = simulate(cantilever(channelled_beam(tmp_path, damping=damping).element, GUST))
    found = simulate(cantilever(element, GUST, history=history))
    for name in ("end", "gauge", "middle"):
        a, b = found.sensor(f"beam.{name}").value, expected.sensor(f"beam.{name}").value
        assert np.abs(a - b).max() < 1e-9 * np.abs(b).max()


@pytest.mark.parametrize("start", ["given", "equilibrium"])
def test_the_deflection_of_a_cantilever_under_a_line_load(tmp_path, start):
    """q L^4 / 8 EI, and twice that, a little more with higher modes, where the load is sudden."""
    q = 1e-3
    load = {"wind": {"force_per_length": [0.0, 1.0, 0.0]}}
    element = channelled_beam(tmp_path, 10, load).element
    period = 2 * np.pi / 1.8751**2 * np.sqrt(MASS_PER_LENGTH * L**4 / EI)
    run = simulate(cantilever(element, q, t_end=period, step=period / 400, start=start))
    static = q * L**4 / (8 * EI)
    tip = run.frame("beam.tip").position[:, 1] - 0.0
    if start == "equilibrium":
        np.testing.assert_allclose(tip, static, rtol=1e-6)
        # the moment, of which elements know the part that is linear in them
        strain = -0.003 * q * L**2 / (2 * EI)
        np.testing.assert_allclose(run.sensor("beam.gauge").value[:, 0], strain, rtol=2e-3)
    else:
        # undamped, by the sum of the modes of a uniform beam: 2.03
        assert 1.90 < tip.max() / static < 2.05


def test_the_tangent_of_a_pattern(windy):
    body = FlexibleBody(windy.element, Start(rotation=[0.2, 0.4, -0.3]))
    loads = [PatternLoad("beam", "wind", Constant(1.0)), PatternLoad("beam", "pull", Constant(1.0))]
    point = Point.of(Model({"beam": body}, loads=loads, settings=Settings(t_end=1.0, step=1e-2)), 2)

    def moved(z):
        # forces in space: the tangent is that of the wrench on the body
        return point.moved(z)

    K, _ = difference(moved, point.n_q)
    point.evaluated()
    linearize(point.system, point.state, point.work)
    n = point.n_q
    tangent = in_space(point.system, point.state, point.work.matrix.S)[:n, :n]
    np.testing.assert_allclose(tangent, K, rtol=0, atol=1e-9 * np.abs(K).max())


def test_what_balances_itself_does_work_on_the_elastic_body_alone(windy):
    """So the balance of energies is one of rounding, whatever the step."""
    names = [pattern.name for pattern in windy.element.patterns]
    channels = windy.element.channels
    balanced = tuple(
        replace(pattern, force=np.zeros(3), moment=np.zeros(3)) for pattern in channels.patterns
    )
    element = replace(windy.element, channels=replace(channels, patterns=balanced))
    load = PatternLoad("beam", names[0], Harmonic(30.0, 70.0))
    settings = Settings(t_end=0.1, step=5e-4, rho_inf=0.8)
    energy = simulate(
        Model({"beam": FlexibleBody(element)}, loads=[load], settings=settings)
    ).energy
    assert np.abs(energy.balance).max() < 1e-13 * np.abs(energy.elastic).max()
    assert energy.dissipated[-1] > 0.0


def test_the_balance_of_energies_under_a_pattern_is_of_second_order(windy):
    def balance(step):
        model = cantilever(windy.element, GUST, step=step, t_end=0.04)
        free = replace(model, joints=[], gravity=np.array([0.0, 0.0, -9.81]))
        return np.abs(simulate(free).energy.balance).max()

    errors = [balance(step) for step in (4e-4, 2e-4, 1e-4)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert ((orders > 1.7) & (orders < 2.4)).all(), (errors, orders)


def test_a_model_a_kilometer_away_and_turned_moves_the_same(windy):
    Q, shift = Rotation.from_rotvec([1.1, -2.0, 0.7]), np.array([800.0, -600.0, 100.0])
    model = cantilever(windy.element, GUST)
    wall = {"wall": Frame([0.1, 0.0, 0.2], [0.3, -0.2, 0.1])}
    place = Start([0.1, 0.0, 0.2], [0.3, -0.2, 0.1])
    X = windy.element.interface("root").X.copy()
    turn = Rotation.from_rotvec([0.3, -0.2, 0.1])
    body = FlexibleBody(windy.element, replace(place, position=place.position - turn.apply(X)))
    joint = Fixed("ground.wall", "beam.root", name="clamp")
    model = replace(model, bodies={"beam": body}, joints=[joint], ground_frames=wall)

    def moved():
        given = replace(model, loads=[])
        return replace(turned(given, Q, shift), loads=model.loads)

    here, there = simulate(model), simulate(moved())
    for name in SENSORS:
        a, b = here.sensor(f"beam.{name}"), there.sensor(f"beam.{name}")
        assert np.abs(a.value - b.value).max() < 1e-8 * np.abs(a.value).max()


@pytest.mark.parametrize("history", ["recursive", "direct", "fft"])
def test_a_simulator_takes_the_amplitude_of_a_pattern_as_an_input(windy, history):
    model = cantilever(windy.element, GUST, history=history)
    expected = simulate(model)
    steered = replace(model, loads=[PatternLoad("beam", "wind", Input("wind", GUST(0.0)))])
    outputs = ["sensors/beam.gauge/value", "patterns/beam.wind/load"]
    simulator = Simulator(steered, outputs)
    # as runs sample it: the mean over the hat function of a step
    amplitudes = expected.pattern("beam.wind").load
    found = [simulator.step([amplitude]).copy() for amplitude in amplitudes[1:]]
    np.testing.assert_allclose(
        np.array(found)[:, 0], expected.sensor("beam.gauge").value[1:, 0], rtol=1e-9, atol=1e-16
    )
    np.testing.assert_allclose(np.array(found)[:, 1], amplitudes[1:])


@pytest.mark.parametrize("history", ["recursive", "direct"])
def test_a_run_goes_on_from_a_state_under_a_pattern(windy, tmp_path, history):
    write(tmp_path / "beam.h5", windy.element)
    signal = Harmonic(2.0, 40.0, 0.3)
    model = cantilever(windy.element, signal, history=history, checkpoint=0.01)
    body = FlexibleBody(read(tmp_path / "beam.h5"), source=str(tmp_path / "beam.h5"))
    model = replace(model, bodies={"beam": body})
    path = tmp_path / "first.h5"
    simulate(model.with_settings(t_end=0.01), output=path)
    whole = simulate(model)
    rest = simulate(model.with_settings(start=StartFrom(str(path)), checkpoint=None))
    n = len(rest.time)
    for name in SENSORS:
        a, b = whole.sensor(f"beam.{name}").value[-n:], rest.sensor(f"beam.{name}").value
        assert np.abs(a - b).max() < 1e-10 * np.abs(a).max()


@pytest.mark.parametrize("history", ["recursive", "fft"])
def test_a_run_that_is_resumed_is_the_same_to_the_bit(windy, tmp_path, history):
    model = cantilever(windy.element, Harmonic(2.0, 40.0), history=history, checkpoint=0.01)
    path = tmp_path / "parts.h5"
    simulate(model.with_settings(t_end=0.01), output=path)
    parts, whole = simulate(model, output=path, resume=True), simulate(model)
    for name in SENSORS:
        np.testing.assert_array_equal(*(r.sensor(f"beam.{name}").value for r in (parts, whole)))
    np.testing.assert_array_equal(parts.energy.balance, whole.energy.balance)


def test_short_steps_in_contact_and_long_ones_in_flight(windy):
    """A ball hits the tip of a beam in the wind: as with short steps alone."""
    ball = RigidBody(0.01, [1e-7] * 3, start=Start([0.5, 0.0, 0.02], velocity=[0.0, 0.0, -0.5]))
    model = cantilever(windy.element, GUST, t_end=0.03, step=1e-5)
    touch = Contact(
        "touch",
        ["beam.tip", "ball"],
        "plane",
        ball=0.005,
        axis=[0, 0, 1],
        impact=Impact(restitution=0.8, stiffness=1e5, exponent=1.5),
    )
    model = replace(model, bodies={**model.bodies, "ball": ball}, contacts=[touch])
    short = simulate(model)
    both = simulate(model.with_settings(step=1e-4, contact_step=1e-5))
    assert len(both.time) < 0.5 * len(short.time)
    at = np.searchsorted(short.time, both.time - 1e-9)
    a, b = short.sensor("beam.gauge").value[at, 0], both.sensor("beam.gauge").value[:, 0]
    assert np.abs(a - b).max() < 0.02 * np.abs(a).max()


def test_a_body_with_terms_of_second_order_feels_small_patterns_alike(windy, with_second_order):
    bent = with_second_order(windy.element)
    runs = [
        simulate(cantilever(element, 1e-6, history="recursive", start=start))
        for start in ("given", "equilibrium")
        for element in (windy.element, bent)
    ]
    for plain, second in zip(runs[::2], runs[1::2], strict=True):
        for name in SENSORS:
            a, b = plain.sensor(f"beam.{name}").value, second.sensor(f"beam.{name}").value
            assert np.abs(a - b).max() < 1e-4 * np.abs(a).max()


def test_a_model_with_patterns_is_written_and_read(windy, tmp_path):
    write(tmp_path / "beam.h5", windy.element)
    body = FlexibleBody(windy.element, source=str(tmp_path / "beam.h5"))
    tip = Force("beam.tip", [0, 0, 1], Constant(1.0))
    model = replace(cantilever(windy.element), bodies={"beam": body})
    model = replace(model, loads=[*model.loads, tip])
    write_model(tmp_path / "model.toml", model)
    again = read_model(tmp_path / "model.toml")
    assert [type(load) for load in again.loads] == [PatternLoad, Force]
    first = again.loads[0]
    assert (first.body, first.pattern, first.signal) == ("beam", "wind", Constant(1.0))


def test_messages_of_patterns(windy):
    model = cantilever(windy.element)
    with pytest.raises(
        ModelError, match=r"load \(pattern\) on 'beam': .* no load pattern 'w'; there"
    ):
        replace(model, loads=[PatternLoad("beam", "w", Constant(1.0))])
    with pytest.raises(ModelError, match="no flexible body 'hub'; there are: beam"):
        replace(model, loads=[PatternLoad("hub", "wind", Constant(1.0))])


def test_loads_on_frames_may_stand_before_and_behind_patterns(windy):
    tip = Force("beam.tip", [0, 1e-3, 0], Constant(1.0))
    model = cantilever(windy.element)
    runs = [
        simulate(replace(model, loads=loads))
        for loads in ([tip, *model.loads], [*model.loads, tip])
    ]
    np.testing.assert_array_equal(*(run.frame("beam.tip").u for run in runs))


def test_a_pattern_accelerates_at_once(windy):
    """The start of a free body: resultant over mass, and the accelerance of sensors and pattern."""
    load = PatternLoad("beam", "wind", Constant(2.0))
    settings = Settings(t_end=H, step=H)
    initial = initialize(
        Model({"beam": FlexibleBody(windy.element)}, loads=[load], settings=settings)
    )
    element = windy.element
    force = 2.0 * element.patterns[0].force
    np.testing.assert_allclose(initial.state.bodies.v_dot[0, :3], force / element.mass, rtol=1e-12)
    expected = 2.0 * element.complete_accelerance[:, element.n_c]
    found = initial.state.interfaces.acceleration
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
