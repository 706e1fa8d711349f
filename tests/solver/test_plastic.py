"""Laws that keep a permanent deformation, each against its closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Contact,
    ElastoplasticLaw,
    Frame,
    Harmonic,
    Hertz,
    Impact,
    IwanLaw,
    Model,
    ModelError,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    Stop,
    Torque,
    check_law,
    read_model,
    simulate,
    write_model,
)
from duhamel.solver.laws.plastic_contact import PlasticContactLaw
from scipy.optimize import brentq

from .test_laws import Path
from .test_restart import assert_same

E, NU, YIELD, RADIUS, MASS = 210e9, 0.3, 1.5e9, 0.01, 0.03
STEEL = Hertz([E, E], [NU, NU], yield_pressure=YIELD)
MODULUS = 0.5 * E / (1.0 - NU**2)
YIELD_SPEED = (
    (0.5 * math.pi / MODULUS) ** 2
    * math.sqrt(8.0 * math.pi * RADIUS**3 / (15.0 * MASS))
    * YIELD**2.5
)
"""Thornton 1997, eq. 30"""


def thornton(speed):
    """Restitution by speed, Thornton 1997, eq. 40."""
    r = min(YIELD_SPEED / speed, 1.0)
    share = r / (r + 2.0 * math.sqrt(1.2 - 0.2 * r * r))
    return math.sqrt(1.2 * math.sqrt(3.0) * (1.0 - r * r / 6.0)) * share**0.25


def struck(speed, steps=200, hertz=STEEL, gap=1e-9, t_end=3.0, gravity=0.0, **impact):
    """A ball of steel that meets a plane; steps in the time of Hertz's contact."""
    stiffness = 4.0 / 3.0 * MODULUS * math.sqrt(RADIUS)
    time = 2.94 * (MASS / stiffness) ** 0.4 * speed**-0.2
    given = {"ball": RADIUS, "hertz": hertz} if hertz else {"ball": RADIUS}
    floor = Contact(
        "floor",
        ["ground.floor", "ball"],
        "plane",
        axis=[0, 0, 1],
        impact=Impact(**impact),
        **given,
    )
    start = Start([0.0, 0.0, RADIUS + gap], velocity=[0.0, 0.0, -speed])
    return Model(
        {"ball": RigidBody(MASS, [1e-6] * 3, start=start)},
        contacts=[floor],
        ground_frames={"floor": Frame()},
        gravity=[0.0, 0.0, gravity],
        settings=Settings(t_end=t_end * time, step=time / steps),
    )


@pytest.mark.parametrize("ratio", [0.7, 1.5, 10.0, 500.0])
def test_restitution_falls_with_speed_as_thornton_has_it(ratio):
    """With second order; the dissipated energy is (1 - e^2) times that of the ball."""
    speed, errors = ratio * YIELD_SPEED, []
    for steps in (40, 640):
        results = simulate(struck(speed, steps))
        found = results.contact("floor").events.restitution[0]
        errors.append(abs(found / thornton(speed) - 1.0))
    assert errors[0] < 5e-3
    assert math.log(errors[0] / errors[1]) / math.log(16.0) > 1.6
    lost = results.energy.dissipated[-1] / (0.5 * MASS * speed**2)
    assert lost == pytest.approx(1.0 - found**2, abs=1e-6)
    assert (results.contact("floor").dent[-1] > 0.0) == (ratio > 1.0)


def test_restitution_falls_with_the_fourth_root_of_a_high_speed():
    """1.185 (speed of yield / speed)^(1/4), Thornton 1997, eq. 42."""
    found = simulate(struck(500.0 * YIELD_SPEED, 400)).contact("floor").events.restitution[0]
    assert found == pytest.approx(1.185 * 500.0**-0.25, rel=1e-3)


def test_the_yield_force_is_where_the_hertz_pressure_is_the_yield_pressure():
    """pi^3 R^2 p^3 / (6 E*^2) of a ball on a plane (Johnson 1985, eq. 4.24)."""
    law = struck(1.0).couplings[0].law()
    exact = math.pi**3 * RADIUS**2 * YIELD**3 / (6.0 * MODULUS**2)
    assert law.yield_force == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("spot", ["same", "new"])
def test_a_second_impact_in_the_same_dent_is_elastic(spot):
    model = struck(0.5, 50, gap=1e-6, t_end=900.0, gravity=-20.0, spot=spot)
    results = simulate(model)
    contact = results.contact("floor")
    events = contact.events
    e = events.restitution[:2]
    assert len(events) >= 2
    assert e[0] == pytest.approx(thornton(events.closing_speed[0]), rel=1e-3)
    expected = 1.0 if spot == "same" else thornton(events.closing_speed[1])
    assert e[1] == pytest.approx(expected, rel=2e-3)
    # The gap is that to the dent; the ball rises from it at once.
    if spot == "same":
        assert contact.dent[-1] > 0.0
        height = results.body("ball").x[:, 2] - RADIUS
        after = results.time > events.end[0]
        np.testing.assert_allclose(
            contact.gap[after], height[after] + contact.dent[after], atol=1e-15
        )


PLASTIC = PlasticContactLaw((-0.2, 0.1), 800.0, 1.5, 4.0)
LINEAR = PlasticContactLaw((-0.2, 0.1), 800.0, 1.0, 4.0, 0.3)


@pytest.mark.parametrize("law", [PLASTIC, LINEAR])
def test_the_slopes_of_a_contact_that_yields_on_both_sides(law):
    check_law(law, [0.0, 0.101, 0.11, 0.14, -0.19, -0.204, -0.3])


@pytest.mark.parametrize("law", [PLASTIC, LINEAR])
def test_a_dent_unloads_from_the_force_that_made_it_with_the_elastic_slope(law):
    path, deepest = Path(law), 0.06
    top = path.step(0.1 + deepest)[3]
    dent = law.permanent(path.parameters, path.memory, 0.1)
    assert top > 4.0
    force, slope, _, _ = path.at(0.1 + deepest - 1e-12, 0.0)
    assert force == pytest.approx(top, rel=1e-9)
    assert slope == pytest.approx(law.exponent * 800.0 * deepest ** (law.exponent - 1.0))
    assert path.at(0.1 + dent * (1.0 - 1e-9), 0.0)[0] == 0.0
    assert path.at(0.1 + dent * (1.0 + 1e-6), 0.0)[0] > 0.0
    assert law.permanent(path.parameters, path.memory, -0.2) == 0.0


def test_a_stop_that_yields_lets_go_what_it_has_stored():
    """Linear up to yield, then with 0.2 of the slope: what is lost follows by areas."""
    K, F, speed, post = 1e4, 50.0, 3.0, 0.2
    energy, elastic = 0.5 * speed**2, 0.5 * F**2 / K
    beyond = (math.sqrt(F**2 + 2.0 * post * K * (energy - elastic)) - F) / (post * K)
    top = F + post * K * beyond
    expected = math.sqrt(0.5 * top**2 / K / energy)
    stop = Stop(
        "stop",
        "rail",
        "distance",
        (-math.inf, 0.01),
        Impact(stiffness=K, yield_force=F, post_yield=post),
    )
    model = Model(
        {"block": RigidBody(1.0, [1.0] * 3, start=Start(velocity=[speed, 0, 0]))},
        [Prismatic("ground", "block", [1, 0, 0], name="rail")],
        stops=[stop],
        settings=Settings(t_end=0.06, step=2e-5),
    )
    results = simulate(model)
    found = results.stop("stop")
    assert found.events.restitution[0] == pytest.approx(expected, rel=1e-5)
    assert found.dent[-1] == pytest.approx(F / K + beyond - top / K, rel=1e-5)


def hinge(law, omega=0.0, h=1e-3, t_end=1.0, loads=(), **more):
    """A flywheel of 2 kg m^2 on a torsion spring."""
    start = Start(angular_velocity=[0.0, 0.0, omega])
    return Model(
        {"wheel": RigidBody(1.0, [2.0] * 3, start=start)},
        [Revolute("ground", "wheel", [0, 0, 1], name="axle")],
        loads,
        [Spring("hinge", "torsion", ["ground", "wheel"], [0, 0, 1], law=law)],
        settings=Settings(t_end=t_end, step=h, **more),
    )


def test_the_residual_rotation_of_a_plastic_hinge_after_a_blow():
    """J omega^2 / 2 = M^2 / (2 k) + M p: what is not stored at the end of the way bends it."""
    law, omega = ElastoplasticLaw(40.0, stiffness=8e3), 5.0
    exact, errors = (0.5 * 2.0 * omega**2 - 0.5 * 40.0**2 / 8e3) / 40.0, []
    for h in (8e-3, 1e-3):
        results = simulate(hinge(law, omega, h, rho_inf=0.9))
        errors.append(abs(results.spring("hinge").permanent[-1, 0] - exact))
    assert errors[1] < 1e-4
    assert math.log(errors[0] / errors[1]) / math.log(8.0) > 1.6
    angle = results.joint("axle").angle[-300:]
    assert np.mean([angle.min(), angle.max()]) == pytest.approx(exact, abs=1e-3)
    assert results.energy.dissipated[-1] == pytest.approx(40.0 * exact, rel=1e-3)


def test_hardening_moves_or_widens_the_elastic_range():
    """Reverse yield after loading to c: 2 F lower where the range moves, -f where it grows."""
    for isotropic, reverse in ((0.0, 14.0 - 20.0), (1.0, -14.0), (0.25, 14.0 - 22.0)):
        law = ElastoplasticLaw(10.0, 100.0, post_yield=0.2, isotropic=isotropic)
        path = Path(law)
        # 10 at 0.1, and 0.2 of the slope for 0.2 more
        force = path.step(0.3)[3]
        assert force == pytest.approx(14.0)
        at_yield = 0.3 - (force - reverse) / 100.0
        assert path.step(at_yield)[3] == pytest.approx(reverse)
        assert path.step(at_yield - 0.1)[3] == pytest.approx(reverse - 2.0)


BOLT = IwanLaw(slip_force=4e3, stiffness=1.5e7, chi=-0.4, beta=0.6, elements=200)


def lost_in_a_cycle(law, amplitude):
    """The area of the loop between -amplitude and amplitude, after it was first loaded."""
    path, lost = Path(law), 0.0
    path.step(amplitude)
    before = path.at(amplitude, 0.0)[3]
    for end in (-amplitude, amplitude):
        for c in np.linspace(path.c, end, 40)[1:]:
            lost += path.step(float(c))[0]
    return lost - (path.at(amplitude, 0.0)[3] - before)


def test_the_loss_of_a_bolted_joint_is_a_power_of_the_amplitude():
    """4 R u^(chi + 3) / ((chi + 2) (chi + 3)) in micro-slip (Segalman 2005, eq. 22)."""
    last, chi = BOLT.macro_slip, BOLT.chi
    R = BOLT.stiffness * (chi + 1.0) / (1.0 + BOLT.beta) / last ** (chi + 1.0)
    for share in (0.01, 0.1, 0.9):
        u = share * last
        exact = 4.0 * R * u ** (chi + 3.0) / ((chi + 2.0) * (chi + 3.0))
        assert lost_in_a_cycle(BOLT, u) == pytest.approx(exact, rel=5e-3)


def test_the_error_of_a_bolted_joint_is_of_second_order_in_its_elements():
    last, chi, errors = BOLT.macro_slip, BOLT.chi, []
    R = BOLT.stiffness * (chi + 1.0) / (1.0 + BOLT.beta) / last ** (chi + 1.0)
    exact = 4.0 * R * last ** (chi + 3.0) / ((chi + 2.0) * (chi + 3.0))
    for n in (20, 40, 80):
        errors.append(abs(lost_in_a_cycle(replace(BOLT, elements=n), last) / exact - 1.0))
    assert 1.8 < np.log2(errors[0] / errors[2]) / 2.0 < 2.2


def test_a_bolted_joint_obeys_masing_and_slips_at_its_force():
    virgin, path, last = Path(BOLT), Path(BOLT), BOLT.macro_slip
    assert virgin.at(1e-6 * last)[0] == pytest.approx(BOLT.stiffness * 1e-6 * last, rel=1e-4)
    for share in (1.0, 3.0):
        assert virgin.at(share * last)[0] == pytest.approx(4e3, rel=1e-12)
    top = path.step(0.7 * last)[3]
    for back in (0.2, 0.8, 1.4):
        unloading = top - 2.0 * virgin.at(0.5 * back * last)[0]
        assert path.at((0.7 - back) * last)[0] == pytest.approx(unloading, rel=1e-9)


def test_what_is_permanent_of_a_bolted_joint_is_where_it_comes_to_rest():
    path, last = Path(BOLT), BOLT.macro_slip
    path.step(5.0 * last)
    permanent = BOLT.permanent(path.parameters, path.memory, path.c)
    rest = brentq(lambda c: path.at(c)[0], 0.0, 5.0 * last)
    assert rest > 3.0 * last
    assert permanent == pytest.approx(rest, rel=0.05)
    path.step(rest)
    assert BOLT.permanent(path.parameters, path.memory, rest) == pytest.approx(rest, rel=1e-9)


def test_a_run_with_permanent_deformations_goes_on_to_the_bit(tmp_path):
    laws = (ElastoplasticLaw(5.0, 900.0, 0.1, 0.5), IwanLaw(6.0, 900.0))
    driven = [Torque("wheel", [0, 0, 1], Harmonic(40.0, 3.0))]
    model = hinge(laws, loads=driven, t_end=0.6)
    stop = Stop(
        "stop",
        "axle",
        "angle",
        (-0.05, 0.1),
        Impact(stiffness=2e3, yield_force=3.0, post_yield=0.5),
    )
    model = replace(model, stops=[stop])
    simulate(model, output=tmp_path / "whole.h5")
    for number, end in enumerate((0.173, 0.35, 0.6)):
        part = model.with_settings(t_end=end, checkpoint=1e3)
        results = simulate(part, output=tmp_path / "parts.h5", resume=number > 0)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")
    assert abs(results.spring("hinge").permanent[-1, 0]) > 1e-3
    assert results.stop("stop").dent.max() > 1e-3
    assert results.energy.imbalance()[1] < 1e-5


def test_contacts_that_yield_survive_a_file(tmp_path):
    balls = [
        struck(1.0),
        struck(
            1.0,
            hertz=None,
            stiffness=1e7,
            exponent=1.2,
            yield_force=50.0,
            post_yield=0.5,
            spot="new",
        ),
    ]
    for model in balls:
        write_model(tmp_path / "model.toml", model)
        read, given = read_model(tmp_path / "model.toml").contacts[0], model.contacts[0]
        assert (read.hertz, read.impact) == (given.hertz, given.impact)


REFUSED = {
    "restitution: expected none with yield_force": {"yield_force": 1.0, "restitution": 0.5},
    "damping: expected none with yield_force": {"yield_force": 1.0, "damping": 0.5},
    "yield_force: expected with post_yield below 1, or an exponent above 1": {"yield_force": 1.0},
    "post_yield: expected with yield_force": {"post_yield": 0.5},
    "spot: expected with yield_force": {"spot": "new"},
    "post_yield: expected a number above 0": {"yield_force": 1.0, "post_yield": 0.0},
    "spot: expected 'same' or 'new'": {"yield_force": 1.0, "spot": "other"},
}


@pytest.mark.parametrize("message", REFUSED)
def test_a_contact_that_yields_with_other_losses_is_refused(message):
    with pytest.raises(ModelError, match=message):
        Impact(stiffness=1.0, **REFUSED[message])


def test_hertz_that_yields_takes_neither_patches_nor_restitution():
    with pytest.raises(ModelError, match="restitution: expected none with yield_pressure"):
        struck(1.0, restitution=0.5)
    with pytest.raises(ModelError, match="spot: expected with yield_pressure"):
        struck(1.0, hertz=Hertz([E, E], [NU, NU]), spot="new")
    with pytest.raises(ModelError, match="yield_force: expected with stiffness"):
        Impact(yield_force=1.0)
    with pytest.raises(ModelError, match="yield_pressure: expected a positive number"):
        Hertz([E, E], [NU, NU], yield_pressure=-1.0)
    for given in ({"chi": -0.9999999999999999}, {"beta": -0.1}, {"elements": 1}):
        with pytest.raises(ModelError, match=f"{next(iter(given))}: expected a number"):
            IwanLaw(1.0, 1.0, **given)
    with pytest.raises(ModelError, match="post_yield: expected a number from 0 to less than 1"):
        ElastoplasticLaw(1.0, 1.0, post_yield=1.0)
