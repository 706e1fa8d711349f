"""Springs with force laws: motion, balances, files, restarts."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    LOADS,
    BoucWenLaw,
    Constant,
    DamperLaw,
    Force,
    Frame,
    Harmonic,
    MaxwellLaw,
    Model,
    ModelError,
    OneSidedLaw,
    Prismatic,
    RigidBody,
    Settings,
    Spring,
    Start,
    StartFrom,
    StateError,
    TabulatedDamperLaw,
    TabulatedLaw,
    UserLaw,
    check,
    read_model,
    simulate,
    write_model,
)
from scipy.integrate import solve_ivp

from .laws import LAWS, branch, cubic, remember_branch
from .test_restart import assert_same

MASS = 2.0
POST = {"ground_frames": {"post": Frame()}}


def block(*springs, force=None, h=1e-3, t_end=2.0, v=0.0, **settings):
    """A mass on a rail, 1 m from a post, on springs whose deformation is its way."""
    loads = [] if force is None else [Force("block", [1, 0, 0], force)]
    start = Start(position=[1.0, 0, 0], velocity=[v, 0, 0])
    return Model(
        {"block": RigidBody(MASS, [0.1] * 3, start=start)},
        [Prismatic("ground", "block", [1, 0, 0], name="rail")],
        loads,
        springs,
        settings=Settings(**{"t_end": t_end, "step": h, "rho_inf": 0.9} | settings),
        **POST,
    )


def coil(law, **given):
    return Spring("coil", "point", ("ground.post", "block"), law=law, **given)


def way(results):
    return results.body("block").x[:, 0] - 1.0


FORCE = Harmonic(8.0, 1.5, 0.7)


def bouc_wen(law):
    """State (z,): its rate, and the force."""

    def rate(c, v, z):
        direction = law.beta * np.sign(v * z) + 1.0 - law.beta
        return v / law.yield_deformation * (1.0 - abs(z) ** law.exponent * direction)

    def force(c, v, z):
        k, D = law.stiffness, law.yield_deformation
        return law.post_yield * k * c + (1.0 - law.post_yield) * k * D * z

    return rate, force


def maxwell(law):
    (tau,), (k,) = law.relaxation_times, law.stiffness
    return lambda c, v, f: k * v - f / tau, lambda c, v, f: f


def without_state(force):
    return lambda c, v, s: 0.0, lambda c, v, s: force(c, v)


ROUND, SHARP = BoucWenLaw(0.05, 60.0, 0.2), BoucWenLaw(0.03, 90.0, 0.1, exponent=2.0, beta=0.7)
CHAIN = MaxwellLaw([0.2], [70.0])
EXACT = {
    "Bouc-Wen": (ROUND, bouc_wen(ROUND)),
    "Bouc-Wen, sharp": (SHARP, bouc_wen(SHARP)),
    "Maxwell": (CHAIN, maxwell(CHAIN)),
    "damper": (
        DamperLaw(1.0, 6.0),
        without_state(lambda c, v: v * (6.0 if v > 0 else 1.0)),
    ),
    "curve": (
        TabulatedDamperLaw((-0.2, 0.0, 0.1, 0.3), (-2.0, 0.0, 3.0, 4.0)),
        without_state(
            lambda c, v: np.interp(v, (-2.0, 0.0, 0.1, 0.3, 2.3), (-20.0, 0.0, 3.0, 4.0, 14.0))
        ),
    ),
    "stop": (
        OneSidedLaw(0.05, 4000.0, 1.5),
        without_state(lambda c, v: -4000.0 * max(-c - 0.05, 0.0) ** 1.5),
    ),
    "user": (UserLaw(cubic, [900.0, 1.0]), without_state(lambda c, v: 900.0 * c**3 + v)),
}


@pytest.mark.parametrize("name", EXACT)
def test_a_forced_oscillator_against_an_integrator_of_high_order(name):
    """Order two, with kinks anywhere between steps; what dampers and hysteresis take is counted."""
    law, (rate, force) = EXACT[name]
    k = 30.0

    def derivatives(t, y):
        c, v, s, _ = y
        f = force(c, v, s)
        return [v, (FORCE(t) - k * c - f) / MASS, rate(c, v, s), FORCE(t) * v]

    t = np.linspace(0.0, 2.0, 501)
    options = {"t_eval": t, "rtol": 1e-10, "atol": 1e-12, "max_step": 1e-3}
    exact = solve_ivp(derivatives, (0.0, 2.0), [0.0] * 4, **options).y
    errors, balances = [], []
    for h in (4e-3, 2e-3, 1e-3):
        results = simulate(block(coil(law, stiffness=k), force=FORCE, h=h))
        errors.append(np.abs(way(results)[:: round(4e-3 / h)] - exact[0]).max())
        balances.append(np.abs(results.energy.balance).max())
    assert np.ptp(exact[0]) > 0.1
    assert np.log2(errors[0] / errors[-1]) / 2 > 1.8, errors
    assert np.log2(balances[0] / balances[-1]) / 2 > 1.8, balances
    lost = results.energy.dissipated
    kinetic = 0.5 * MASS * exact[1, -1] ** 2
    expected = exact[3, -1] - kinetic - results.energy.springs[-1]
    assert lost[-1] == pytest.approx(expected, rel=1e-3, abs=2e-4)
    if name != "stop":
        assert lost[-1] > 0.1
    assert np.diff(lost).min() > -1e-5 * max(lost[-1], exact[3].max())


def test_several_laws_of_a_spring_add_up():
    laws = [LAWS["table"], LAWS["Maxwell"], OneSidedLaw(0.02, 300.0), LAWS["Bouc-Wen"]]
    together = block(coil(laws), force=FORCE)
    names = [f"part {k}" for k in range(len(laws))]
    apart = [replace(coil(law), name=name) for name, law in zip(names, laws, strict=True)]
    expected = simulate(block(*apart, force=FORCE))
    results = simulate(together)
    np.testing.assert_allclose(way(results), way(expected), rtol=0, atol=1e-13)
    np.testing.assert_allclose(results.energy.springs, expected.energy.springs, rtol=0, atol=1e-12)
    sums = np.sum([expected.spring(name).force for name in names], axis=0)
    np.testing.assert_allclose(results.spring("coil").force, sums, rtol=0, atol=1e-9)


AXES = ("x", "y", "z", "rx", "ry", "rz")


@pytest.mark.parametrize("axis", AXES)
def test_a_bushing_with_a_law_on_an_axis(axis):
    """The other axes are held; a point or torsion spring with this law does the same."""
    k = AXES.index(axis)
    along = np.eye(3)[k % 3]
    kind = "prismatic" if k < 3 else "revolute"
    law = [LAWS["Bouc-Wen"], LAWS["damper"]]
    load = LOADS["force" if k < 3 else "torque"]("block", along, Harmonic(1.0, 2.0))
    far = "torsion" if k >= 3 else "point"
    frames = {"near": Frame(), "far": Frame(-along)}

    def run(spring):
        return simulate(
            Model(
                {"block": RigidBody(0.5, [0.1] * 3)},
                [JOINTS[kind]("ground", "block", along, name="guide")],
                [load],
                [spring],
                ground_frames=frames,
                settings=Settings(t_end=0.5, step=1e-3),
            )
        ).spring("s")

    mount = run(Spring("s", "bushing", ("ground.near", "block"), law={axis: law}))
    ends = ("ground.far", "block")
    given = {"axis": along} if far == "torsion" else {}
    single = run(Spring("s", far, ends, law=law, **given))
    c = single.coordinates["coordinates"][:, 0] - (1.0 if far == "point" else 0.0)
    assert np.ptp(c) > 1e-2
    turned = np.arcsin(mount.coordinates["coordinates"][:, k]) if k >= 3 else None
    found = mount.coordinates["coordinates"][:, k] if turned is None else turned
    # the coordinate of the bushing is a sine
    np.testing.assert_allclose(found, c, rtol=0, atol=1e-9 if k < 3 else 2e-3 * np.abs(c).max())


def test_laws_survive_a_file(tmp_path):
    """One, several, and those of a bushing by axis."""
    written = {name: law for name, law in LAWS.items() if not isinstance(law, UserLaw)}
    springs = [replace(coil(law), name=name) for name, law in written.items()]
    springs += [
        replace(coil((LAWS["stop"], LAWS["Maxwell"])), name="both"),
        Spring(
            "mount",
            "bushing",
            ("ground.post", "block"),
            law={"x": LAWS["table"], "rz": (LAWS["Bouc-Wen"], LAWS["damper curve"])},
        ),
    ]
    path = tmp_path / "model.toml"
    write_model(path, block(*springs))
    for read, spring in zip(read_model(path).springs, springs, strict=True):
        assert read.law == spring.law, spring.name


FILES = {
    "law = {gap = 1, stiffness = -1}": "law: stiffness: expected a positive number",
    "law = {gapp = 1, stiffness = 1}": "did you mean 'gap'",
    "law = {yield_deformation = nan, stiffness = 1}": "law: yield_deformation: expected a positive",
    "law = {yield_deformation = 1, stiffness = 1, post_yield = 2}": "law: post_yield: expected a n",
    "law = {relaxation_times = [-1], stiffness = [1]}": "law: relaxation_times: expected positive",
    "law = {rate = [0, 1], force = [0, -1]}": "law: force: expected the sign of the rate",
    "law = [{gap = 1, stiffness = 1}, {gap = 1}]": "law: stiffness",
    "law = []": "law: expected a force law",
    "law = 3": "law: expected a table with one of the keys",
    "law = {x = {gap = 1, stiffness = 1}}": "law: a point spring has one coordinate",
}


@pytest.mark.parametrize("text", FILES)
def test_a_bad_law_in_a_file_is_one_line(text, tmp_path):
    path = tmp_path / "model.toml"
    write_model(path, block(coil(None)))
    path.write_text(path.read_text() + f"{text}\n")
    with pytest.raises(ModelError) as caught:
        read_model(path)
    assert "\n" not in str(caught.value)
    assert (
        f"spring 'coil': {FILES[text].split(':')[0]}" in str(caught.value) or "did" in FILES[text]
    )
    assert FILES[text] in str(caught.value)


def test_axes_that_a_bushing_has_not_are_refused():
    law = LAWS["stop"]
    ends = ("ground.post", "block")
    with pytest.raises(ModelError, match="law: a bushing takes laws by axis: x, y, z, rx, ry, rz"):
        Spring("s", "bushing", ends, law=law)
    with pytest.raises(ModelError, match="law: expected axes x, y, z, rx, ry, rz, got w"):
        Spring("s", "bushing", ends, law={"w": law})
    with pytest.raises(ModelError, match="law: expected a force law such as TabulatedLaw"):
        Spring("s", "bushing", ends, law={"x": 3.0})


def pulled(law):
    """A block in equilibrium under a constant force."""
    return block(coil(law), force=Constant(5.0), start="equilibrium", t_end=0.02)


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (OneSidedLaw(-2.0, 4.0, 2.0, side="extension"), np.sqrt(5.0 / 4.0) - 2.0),
        (UserLaw(cubic, [40.0, 3.0]), 0.5),
        # n = 1: z = 1 - exp(-c / D)
        (BoucWenLaw(0.1, 100.0), 0.1 * np.log(2.0)),
        ((LAWS["Maxwell"], TabulatedLaw((0, 1), (0, 50))), 0.1),
    ],
    ids=["one-sided", "user", "Bouc-Wen", "Maxwell"],
)
def test_equilibrium_on_a_nonlinear_law(law, expected):
    """From the virgin state, with all branches relaxed; it stays there."""
    results = simulate(pulled(law))
    np.testing.assert_allclose(way(results), expected, rtol=0, atol=1e-10)
    assert np.abs(results.energy.balance).max() < 1e-10


@pytest.mark.parametrize(
    ("law", "stiffness"),
    [
        (OneSidedLaw(-0.5, 40.0, 2.0), 40.0),
        (LAWS["Maxwell"], 0.0),
        (LAWS["damper"], 0.0),
        (BoucWenLaw(0.1, 70.0, 0.1), 70.0),
        ((TabulatedLaw((-1, 1), (-30, 30)), UserLaw(cubic, [5.0, 1.0])), 30.0),
    ],
    ids=["one-sided", "Maxwell", "damper", "Bouc-Wen", "several"],
)
def test_the_frequency_of_a_mass_on_a_law(law, stiffness):
    """The slope at the start: of branches that have relaxed, of hysteresis that has not yielded."""
    found = check(block(coil(law, stiffness=50.0))).frequencies
    np.testing.assert_allclose(found, np.sqrt((50.0 + stiffness) / MASS) / (2.0 * np.pi))


def test_the_frequencies_about_a_yielded_equilibrium_are_those_of_small_motions():
    found = check(pulled(BoucWenLaw(0.1, 100.0))).frequencies
    np.testing.assert_allclose(found, np.sqrt(100.0 / MASS) / (2.0 * np.pi))


REMEMBERED = (LAWS["Bouc-Wen, slim"], MaxwellLaw((0.3, 0.01), (9.0, 5.0)))


@pytest.mark.parametrize("ends", [(0.05, 0.4), (0.123, 0.4), (0.1, 0.101, 0.3, 0.4)])
def test_a_run_goes_on_to_the_bit_in_the_middle_of_a_hysteresis(ends, tmp_path):
    laws = (*REMEMBERED, UserLaw(branch, [5.0, 0.02], [0.0, 0.0], remember_branch))
    model = block(coil(laws), force=Harmonic(30.0, 3.0), t_end=0.4)
    with pytest.raises(ModelError, match="a UserLaw cannot be written"):
        write_model(tmp_path / "model.toml", model)
    simulate(model, output=tmp_path / "whole.h5")
    for number, end in enumerate(ends):
        part = model.with_settings(t_end=end, checkpoint=1e3)
        results = simulate(part, output=tmp_path / "parts.h5", resume=number > 0)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")
    assert results.energy.dissipated[-1] > 0.1


def test_a_model_that_starts_from_another_run_takes_the_memory_over(tmp_path):
    """As one run does, but for where its work is counted from."""
    model = block(coil(REMEMBERED), force=Harmonic(30.0, 3.0), t_end=0.4)
    whole = simulate(model)
    simulate(model.with_settings(t_end=0.15, checkpoint=1e3), output=tmp_path / "first.h5")
    results = simulate(model.with_settings(start=StartFrom(str(tmp_path / "first.h5"))))
    np.testing.assert_allclose(way(results), way(whole)[150:], rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        results.energy.springs, whole.energy.springs[150:], rtol=0, atol=1e-12
    )


def softer(parameters, memory, h, c, rate):
    k, d = parameters[0], parameters[1]
    return 0.5 * k * c**3 + d * rate, 1.5 * k * c**2, d, 0.125 * k * c**4


def scaled(factor):
    def law(parameters, memory, h, c, rate):
        return factor * c, factor, 0.0, 0.5 * factor * c * c

    return UserLaw(law)


@pytest.mark.parametrize(
    ("first", "second", "key"),
    [
        (UserLaw(cubic, [40.0, 3.0]), UserLaw(softer, [40.0, 3.0]), "function"),
        (UserLaw(cubic, [40.0, 3.0]), UserLaw(cubic, [40.0, 3.5]), "numbers"),
        (scaled(10.0), scaled(11.0), "function"),
    ],
)
def test_another_law_of_the_user_is_refused_by_name(first, second, key, tmp_path):
    path = tmp_path / "out.h5"
    simulate(block(coil(first), v=1.0, t_end=0.1, checkpoint=1e3), output=path)
    longer = {"v": 1.0, "t_end": 0.2, "checkpoint": 1e3}
    with pytest.raises(StateError, match=rf"springs\.coil\.law\.{key}: was .*, is "):
        simulate(block(coil(second), **longer), output=path, resume=True)
    simulate(block(coil(first), **longer), output=path, resume=True)


def test_a_law_of_the_user_is_as_good_as_one_of_the_house():
    chain = MaxwellLaw([0.02], [5.0])
    user = UserLaw(branch, [5.0, 0.02], [0.0, 0.0], remember_branch)
    expected = simulate(block(coil(chain, stiffness=9.0), v=1.0, h=5e-3))
    found = simulate(block(coil(user, stiffness=9.0), v=1.0, h=5e-3))
    np.testing.assert_allclose(way(found), way(expected), rtol=0, atol=1e-13)
    np.testing.assert_allclose(
        found.energy.dissipated, expected.energy.dissipated, rtol=0, atol=1e-13
    )
