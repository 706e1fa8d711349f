"""The examples of impact: what closed forms, waves and other integrators make of them."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import Start, read_model, simulate
from impact.exact import point_impact, steel_arm, timoshenko
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from .conftest import EXAMPLES


@pytest.fixture(scope="module")
def run(example):
    """Results of a model in examples/."""

    def runs(name, *superelements):
        for part in superelements:
            example("colliding_rods").ensure_superelement(part)
        return simulate(read_model(EXAMPLES / f"{name}.toml"))

    return runs


def damping(restitution):
    """a (1 + e) = ln((1 + a) / (1 - e a)): the force times 1 + a d' / v_0 returns e v_0."""

    def error(a):
        return a * (1.0 + restitution) - np.log((1.0 + a) / (1.0 - restitution * a))

    return brentq(error, 0.2 * (1.0 - restitution), (1.0 - 1e-12) / restitution)


def test_rods_keep_what_the_waves_leave_them(example, tmp_path):
    found = example("colliding_rods").main(tmp_path)  # which checks force, velocities and momentum
    assert (tmp_path / "colliding-rods.png").exists()
    for (_, checks), restitution in zip(found.values(), (1.0, 0.5), strict=True):
        assert checks.restitution == pytest.approx(restitution, abs=0.01)
        assert 0.0 < checks.duration < 0.03


def test_a_blow_runs_through_two_meshes_of_a_rod(example, tmp_path):
    """Forces of the wave theory: the ram meets v A sqrt(E rho) of the shank until the wave is back
    from the crank pin, which holds against twice of that.
    """
    pytest.importorskip("gmsh")
    script = example("million")
    # which checks momentum, the speed of waves, and that the meshes agree
    rods, blows, checks = script.main(tmp_path)
    assert (tmp_path / "million.png").exists()
    coarse, fine = rods
    assert fine.unknowns > 1.5 * coarse.unknowns
    # A finer mesh is softer.
    assert (fine.frequencies < coarse.frequencies).all()
    assert fine.stretch > coarse.stretch
    assert checks.frequencies > 1e-3
    # The two meshes are told apart by nothing else: the same interfaces, modes and steps.
    assert len(fine.element.modes.omega) == pytest.approx(len(coarse.element.modes.omega), rel=0.1)
    for blow in blows:
        first = blow.contact[(blow.time > 5e-5) & (blow.time < 1.1e-4)].mean()
        assert 1.5 < blow.pin.max() / first < 2.1


def test_the_ball_on_the_beam_as_timoshenko_has_it(run):
    """His integral equation with the modes of the beam. The third of the contacts is the most
    sensitive: it meets the phase errors of two others.
    """
    results = run("ball_on_beam", "beam")
    case = timoshenko(2)
    exact = point_impact(case, 4e-3, 2e-7, modes=100)
    events, expected = results.events["blow"], exact.blows
    assert len(events) == len(expected) == 3
    np.testing.assert_allclose(events.peak, [c.peak for c in expected], rtol=4e-3)
    np.testing.assert_allclose(events.peak[:2], [c.peak for c in expected[:2]], rtol=2e-4)
    np.testing.assert_allclose(events.impulse, [c.impulse for c in expected], rtol=3e-4)
    np.testing.assert_allclose(events.start, [c.start for c in expected], rtol=0, atol=1e-6)
    np.testing.assert_allclose(events.end, [c.end for c in expected], rtol=0, atol=1e-6)
    rebound = results.body("ball").v[-1, 2] / case.speed
    assert rebound == pytest.approx(-exact.velocity[-1] / case.speed, abs=5e-4)
    assert results.iterations.max() <= 5


def test_the_arm_strikes_its_stop_as_its_modes_do(run):
    """The first contact against the modes of a hinged beam. The short ones after it depend on
    phases; what all of them gave is what the arm has turned back with.
    """
    results = run("arm_on_stop", "arm")
    events = results.events["stop"]
    arm = replace(steel_arm(), mass_per_length=0.785)
    first = point_impact(arm, 1.2e-3, 5e-7).blows[0]
    assert events.peak[0] == pytest.approx(first.peak, rel=5e-3)
    assert events.impulse[0] == pytest.approx(first.impulse, rel=1e-3)
    assert events.end[0] - events.start[0] == pytest.approx(first.end, rel=2e-3)
    about_hinge = results.momentum.angular[:, 1]
    assert about_hinge[0] - about_hinge[-1] == pytest.approx(events.impulse.sum(), rel=1e-4)
    assert len(events) > 30
    assert results.iterations.max() <= 6


def test_the_pin_knocks_as_often_and_as_hard_as_it_should(run):
    """The first impact against an integration of crank, rod and slider in the plane by scipy; of
    the rest, which is chaotic, no more than the balance and the slider near the one without play.
    """
    results = run("clearance")
    events = results.events["wrist pin"]
    time, force = first_impact(3e-4)
    touching = time[force > 0.0]
    assert events.peak[0] == pytest.approx(force.max(), rel=1e-3)
    assert events.impulse[0] == pytest.approx(np.trapezoid(force, time), rel=1e-3)
    assert events.start[0] == pytest.approx(touching[0], abs=1e-6)
    assert events.end[0] == pytest.approx(touching[-1], abs=1e-6)
    without_play = CRANK * np.cos(SPEED * results.time) + np.sqrt(
        ROD**2 - (CRANK * np.sin(SPEED * results.time)) ** 2
    )
    assert np.abs(results.body("slider").x[:, 0] - without_play).max() < 0.65e-3
    assert 30 <= len(events) <= 45
    assert np.abs(results.energy.balance).max() < 1e-4 * results.energy.kinetic.max()
    assert results.iterations.max() <= 6


CRANK, ROD, SPEED, PLAY, K = 0.05, 0.12, 523.5987755982989, 0.5e-3, 6.61e10
"""of the slider-crank [m], [m], [rad/s], [m], [N/m^1.5]"""


def first_impact(t_end):
    """Time [s] and force [N] of the pin until it leaves its bore for the first time.

    Rod about the crank pin A, which has the acceleration a: J_A phi'' = e' . (l F - m l / 2 a); the
    force F on it, at its end, and -F on the slider.
    """
    mass, inertia, slider, a = 0.21, 2.5e-4, 0.14, damping(0.9)

    def crank(t):
        turned = np.array([np.cos(SPEED * t), np.sin(SPEED * t)])
        return CRANK * turned, CRANK * SPEED * np.array([-turned[1], turned[0]])

    def apart(t, state):
        """Distance of pin and middle of the bore, its rate, its direction, and e'."""
        phi, omega, x, v = state
        along, across = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
        place, rate = crank(t)
        d = place + ROD * along - [x, 0.0]
        size = np.linalg.norm(d)
        n = d / size if size > 0.0 else d
        return size, n @ (rate + ROD * omega * across - [v, 0.0]), n, across

    def pressed(t, state, closing):
        size, rate, n, across = apart(t, state)
        if size <= PLAY:
            return 0.0, n, across
        return max(0.0, K * (size - PLAY) ** 1.5 * (1.0 + a * rate / closing)), n, across

    def rates(t, state, closing):
        F, n, across = pressed(t, state, closing)
        turning = across @ (-ROD * F * n + 0.5 * mass * ROD * SPEED**2 * crank(t)[0])
        J = inertia + mass * (0.5 * ROD) ** 2
        return [state[1], turning / J, state[3], F * n[0] / slider]

    def touch(t, state, _):
        return apart(t, state)[0] - PLAY

    touch.terminal = True
    exact = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-13}
    start = [0.0, -SPEED * CRANK / ROD, CRANK + ROD, 0.0]
    flight = solve_ivp(rates, (0.0, t_end), start, events=touch, args=(1.0,), **exact)
    begun, state = flight.t[-1], flight.y[:, -1]
    closing = apart(begun, state)[1]
    time = np.linspace(begun, t_end, 3000)
    contact = solve_ivp(rates, (begun, t_end), state, t_eval=time, args=(closing,), **exact)
    forces = [pressed(t, y, closing)[0] for t, y in zip(time, contact.y.T, strict=True)]
    return time, np.array(forces)


def test_the_teeth_knock_as_the_law_says(run):
    """The angle between the shafts by scipy, x'' = T / J_1 - M / J, J = J_1 J_2 / (J_1 + J_2),
    with the speed of each impact in its damping.
    """
    results = run("backlash")
    events = results.events["teeth"]
    first, braking = events.start < 0.05, events.start >= 0.05
    # Half of the play at T / J_1 = 1000 rad/s^2; then all of it.
    assert events.closing_speed[0] == pytest.approx(np.sqrt(2.0 * 1000.0 * 0.002), rel=1e-4)
    assert events.start[0] == pytest.approx(np.sqrt(2.0 * 0.002 / 1000.0), rel=1e-4)
    assert first.sum() >= 3
    assert braking.sum() >= 3
    closing = 2.0
    for k in range(2):
        peak, opening, lasting = blow_of_teeth(closing)
        assert events.closing_speed[k] == pytest.approx(closing, rel=5e-3)
        assert events.peak[k] == pytest.approx(peak, rel=1e-3)
        assert events.end[k] - events.start[k] == pytest.approx(lasting, rel=2e-3)
        flight = events.start[k + 1] - events.end[k]
        assert flight == pytest.approx(2.0 * opening / 1000.0, rel=6e-3)
        closing = opening
    settled = (results.time > 0.04) & (results.time < 0.0499)
    np.testing.assert_allclose(results.stop("teeth").force[settled], -8.0, rtol=1e-6)
    assert results.iterations.max() <= 6


def blow_of_teeth(closing):
    """Largest moment [N m], opening speed [rad/s] and duration [s] of a blow."""
    a, stiffness, J, pushed = damping(0.5), 1e6, 0.008, 1000.0

    def moment(d, rate):
        return max(0.0, stiffness * d * (1.0 + a * rate / closing))

    def rates(_, state):
        return [state[1], pushed - moment(*state) / J]

    def opens(t, state):
        return state[0] if t > 0.0 else 1.0

    opens.terminal, opens.direction = True, -1.0
    found = solve_ivp(
        rates, (0.0, 1e-3), [0.0, closing], events=opens, rtol=1e-10, atol=1e-14, max_step=1e-6
    )
    peak = max(moment(*state) for state in found.y.T)
    return peak, -found.y[1, -1], found.t[-1]


def test_the_box_comes_to_rest(example, tmp_path):
    found = example("tumbling_box").main(tmp_path)  # which checks rest, weight and energy
    assert (tmp_path / "tumbling-box.png").exists()
    assert min(abs(found.height - half) for half in (0.02, 0.03, 0.05)) < 1e-6
    assert found.blows > 20


def test_a_housing_falls_on_its_feet(example, tmp_path):
    """Which checks momentum, energy, and the force against that of half the step."""
    found, _ = example("housing").main(tmp_path)
    assert (tmp_path / "housing.png").exists()
    # One foot after the other, each lands at the floor but for what it yields.
    assert found.force[found.time < 0.005].max() == pytest.approx(80.5, rel=0.01)
    assert found.force.max() == pytest.approx(205.0, rel=0.01)
    assert (abs(found.heights.min(axis=0)) < 3e-4).all()
    assert (found.force[found.heights.min(axis=1) > 3e-4] < 1e-9).all()


def test_flat_rods_meet_as_the_theory_of_rods_has_it(example, tmp_path):
    """Which checks force, duration, velocities, momentum and pressures."""
    found, _ = example("flat_rods").main(tmp_path)
    assert (tmp_path / "flat-rods.png").exists()
    assert found.velocities[1, -1] == pytest.approx(2.0, rel=0.01)


def test_a_hook_snaps_behind_its_catch(example, tmp_path):
    """Which checks forces on the crest, the frequency of ringing, and the energy."""
    found, _ = example("snap_fit").main(tmp_path)
    assert (tmp_path / "snap-fit.png").exists()
    assert found.lift.max() == pytest.approx(1e-3, rel=0.02)
    assert found.force[-1] == 0.0


@pytest.mark.validation
def test_a_pendulum_hangs_in_a_socket(example, tmp_path):
    """Which checks the moment of friction, the loss of a half swing, and the energy."""
    found, _ = example("ball_socket").main(tmp_path)
    assert (tmp_path / "ball-socket.png").exists()
    assert found.angle[-1] < 0.2
    assert found.normal[0] == 0.0


def test_gears_rattle_in_their_backlash(example, tmp_path):
    """Which checks the arm of the force, the stiffness of the teeth, the backlash, the energy."""
    found, _ = example("gear_pair").main(tmp_path)
    assert (tmp_path / "gear-pair.png").exists()
    assert found.way.max() > 8e-5
    assert found.way.min() < -8e-5


def test_a_blade_rubs_on_its_casing(example, tmp_path):
    """Which checks its stretch, friction, and the force against that of half the step."""
    found, _ = example("blade_rub").main(tmp_path)
    assert (tmp_path / "blade-rub.png").exists()
    assert found.force.max() == pytest.approx(1217.0, rel=0.02)
    assert found.force[found.turns < 0.2].max() == 0.0


@pytest.mark.validation
def test_the_hammer_on_the_bracket(example, tmp_path):
    """At a tenth of the speed the force comes nearer to that of small motions: what is left at 1
    m/s is of second order, the lug turns away under the hammer.
    """
    script = example("hammer")
    script.main(tmp_path)  # which checks force and impulse
    assert {"hammer.png", "hammer-stress.png"} <= {path.name for path in tmp_path.iterdir()}
    model = read_model(EXAMPLES / "hammer.toml")
    hammer = model.bodies["hammer"]
    slow = replace(hammer, start=Start(position=[0.045003, 0.0004, 0.0623], velocity=[-0.1, 0, 0]))
    model = replace(model, bodies={**model.bodies, "hammer": slow})
    results = simulate(model)
    found, expected = script.blow(model, results).force, script.held_bracket(model, results)
    assert np.abs(found - expected).max() < 0.005 * expected.max()


def test_what_stays_after_a_blow_is_as_published(example, tmp_path):
    found = example("permanent_deformation").main(tmp_path)
    assert (tmp_path / "permanent-deformation.png").exists()
    _, restitution, exact = found["restitution"]
    np.testing.assert_allclose(restitution, exact, rtol=1e-4)
    assert restitution[-1] < 0.3
    _, angle, bent = found["hinge"]
    assert np.mean([angle[-400:].min(), angle[-400:].max()]) == pytest.approx(bent[0], rel=1e-3)
    _, lost, exact = found["bolt"]
    np.testing.assert_allclose(lost, exact, rtol=0.01)


def test_the_law_fitted_to_one_measured_restitution_follows_the_others(example):
    """Of frosted ice, e = 0.34 (v / 1 cm/s)^-0.234 (Bridges, Hatzes and Lin 1984)."""
    thornton, yields = (
        getattr(example("permanent_deformation"), n) for n in ("thornton", "yield_speed")
    )
    # The law knows the speed over that of yield alone.
    ratio = brentq(lambda ratio: thornton(ratio * yields()) - 0.34, 2.0, 1e4)
    assert ratio == pytest.approx(147.1, abs=0.1)
    for speed in (0.1, 0.3, 3.0, 5.0):
        measured = 0.34 * speed**-0.234
        assert thornton(speed * ratio * yields()) == pytest.approx(measured, rel=0.031)
