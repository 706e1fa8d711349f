"""Modes of assembled models at rest, against closed forms, finite elements and the time domain."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from duhamel.preprocess import Body, build
from duhamel.solver import (
    BoucWenLaw,
    Coupler,
    DamperLaw,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    JointFriction,
    MaxwellLaw,
    Model,
    ModelError,
    Motor,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    TabulatedLaw,
    linearize,
    simulate,
)
from duhamel.solver.linear import modes as modes_module
from duhamel.solver.linear import subspace
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from .models import model_of

Z = [0.0, 0.0, 1.0]
SECTION = {
    "EA": 2e6,
    "EI_y": 20.0,
    "EI_z": 30.0,
    "GJ": 8.0,
    "mass_per_length": 0.4,
    "polar_inertia_per_length": 1e-3,
}


def make_line(folder, length, elements, **settings):
    """A beam along x from root to tip."""
    import meshio

    points = np.zeros((elements + 1, 3))
    points[:, 0] = np.linspace(0.0, length, elements + 1)
    lines = np.column_stack([np.arange(elements), np.arange(1, elements + 1)])
    tags = {tag: [np.ones(elements, dtype=int)] for tag in ("gmsh:physical", "gmsh:geometrical")}
    path = folder / f"line-{length}-{elements}.msh"
    meshio.Mesh(points, [("line", lines)], cell_data=tags).write(
        path, file_format="gmsh22", binary=False
    )
    body = {
        "name": "line",
        "mesh": str(path),
        "section": SECTION,
        "interfaces": {"root": {"node": [0, 0, 0]}, "tip": {"node": [length, 0, 0]}},
        "impulse": {"step": 1e-3, "steps": 1, "method": "modal"},
        **settings,
    }
    return build(Body.model_validate(body))


@pytest.fixture(scope="module")
def line(tmp_path_factory):
    return make_line(tmp_path_factory.mktemp("line"), 1.0, 8)


def held(element, *joints, **model):
    """A beam whose root is at the origin, along x."""
    start = Start(-element.interface("root").X)
    return model_of({"beam": FlexibleBody(element, start)}, joints, step=1e-3, **model)


CLAMP = Fixed("ground", "beam.root", name="clamp")


def bending(element, roots, length, EI):
    return roots**2 / length**2 * np.sqrt(EI / SECTION["mass_per_length"]) / (2.0 * np.pi)


def test_a_free_beam_has_six_free_motions_and_its_own_frequencies(line):
    found = linearize(held(line)).modes()
    assert found.rigid == 6
    np.testing.assert_allclose(found.frequencies[6:46], np.sort(line.modes.frequencies)[:40], 1e-9)


def test_a_clamped_beam_by_the_formula(line):
    found = linearize(held(line, CLAMP)).modes(6)
    roots = np.array([1.8751040687, 4.6940911330])
    for EI in (SECTION["EI_y"], SECTION["EI_z"]):
        for expected in bending(line, roots, 1.0, EI):
            assert np.abs(found.frequencies / expected - 1.0).min() < 1e-4


def test_a_pinned_beam_by_the_formula(line):
    """In the plane of the pins; it is free to turn about them."""
    found = linearize(held(line, Revolute("ground", "beam.root", Z, name="pin"))).modes(8)
    assert found.rigid == 1
    expected = bending(line, np.array([3.9266023120]), 1.0, SECTION["EI_z"])
    assert np.abs(found.frequencies / expected - 1.0).min() < 2e-4


def test_two_beams_clamped_together_are_the_long_one(tmp_path):
    short, long = make_line(tmp_path, 0.5, 4), make_line(tmp_path, 1.0, 8)
    whole = linearize(held(long, CLAMP)).modes()
    bodies = {
        "beam": FlexibleBody(short, Start(-short.interface("root").X)),
        "other": FlexibleBody(short, Start([0.5, 0, 0] - short.interface("root").X)),
    }
    joints = (CLAMP, Fixed("beam.tip", "other.root", name="weld"))
    parts = linearize(model_of(bodies, joints, step=1e-3)).modes()
    assert len(parts) == len(whole) == 48
    np.testing.assert_allclose(parts.frequencies, whole.frequencies, rtol=1e-8)


def test_the_modes_of_a_jointed_beam_are_those_of_its_finite_elements(beam):
    """All of them, up to 2e5 Hz: the sum over the modes of the free body loses none."""
    structure = beam.structure
    K, M = structure.K.toarray(), structure.M.toarray()
    root = structure.interfaces[0]
    P = structure.P_C.toarray()[: root.n_dofs]
    _, _, V = np.linalg.svd(P)
    free = V[root.n_dofs :].T
    expected = np.sqrt(eigh(free.T @ K @ free, free.T @ M @ free, eigvals_only=True))
    joint = Fixed("ground", "beam.root", name="clamp")
    found = linearize(held(beam.element, joint)).modes()
    np.testing.assert_allclose(2.0 * np.pi * found.frequencies, expected, rtol=1e-7)


def pendulum(angle=0.0, gravity=-9.81):
    body = RigidBody(2.0, [0.01, 0.02, 0.03], {"p": Frame([0, 0.5, 0])}, Start([0, -0.5, 0]))
    hinge = Revolute("ground", "body.p", Z, name="hinge")
    return model_of({"body": body}, (hinge,), gravity=[0, gravity, 0], step=1e-3)


def test_a_pendulum():
    found = linearize(pendulum()).modes()
    omega = np.sqrt(2.0 * 9.81 * 0.5 / (0.03 + 2.0 * 0.25))
    np.testing.assert_allclose(found.values, [1j * omega], rtol=1e-12, atol=1e-12)


def test_a_pendulum_upside_down_falls():
    found = linearize(pendulum(gravity=9.81)).modes()
    rate = np.sqrt(2.0 * 9.81 * 0.5 / (0.03 + 2.0 * 0.25))
    np.testing.assert_allclose(np.sort(found.values.real), [-rate, rate], rtol=1e-12)
    assert found.unstable.tolist() == (found.values.real > 0.0).tolist()
    assert found.ratios[found.unstable] == pytest.approx([-1.0])


def test_a_double_pendulum_of_point_masses():
    """Of equal masses and lengths: omega^2 = (2 -+ sqrt 2) g / l."""
    small = [1e-12] * 3
    bodies = {
        "a": RigidBody(1.0, small, {"p": Frame([0, 1, 0])}, Start([0, -1, 0])),
        "b": RigidBody(1.0, small, {"p": Frame([0, 1, 0])}, Start([0, -2, 0])),
    }
    joints = (
        Revolute("ground", "a.p", Z, name="one"),
        Revolute("a", "b.p", Z, name="two"),
    )
    found = linearize(model_of(bodies, joints, gravity=[0, -9.81, 0], step=1e-3)).modes()
    expected = np.sqrt((2.0 + np.array([-1, 1]) * np.sqrt(2.0)) * 9.81)
    np.testing.assert_allclose(found.values.imag, expected, rtol=1e-9)


def test_a_slow_pendulum_on_a_stiff_beam_is_not_lost_in_rounding(line):
    """Its frequency is 1e-6 of the highest; a bar of the same mass is the reference."""
    hinge = Revolute("ground", "beam.root", [0, 1, 0], name="hinge")
    found = linearize(held(line, hinge, gravity=[0.01, 0, 0])).modes(1)
    assert found.frequencies[0] == pytest.approx(np.sqrt(1.5 * 0.01) / (2.0 * np.pi), rel=1e-5)


def test_frequencies_are_the_same_a_kilometer_away_and_turned(line):
    bodies = {
        "beam": FlexibleBody(line, Start(-line.interface("root").X)),
        "mass": RigidBody(0.3, [0.01, 0.02, 0.02], start=Start([1, 0, 0])),
    }
    spring = {"stiffness": [2e3, 2e3, 4e3, 5.0, 5.0, 7.0]}
    turn = Rotation.from_rotvec([0.3, -1.1, 0.7])
    shift = np.array([1000.0, -300.0, 50.0])

    def model(R, x):
        moved = {
            name: replace(
                body,
                start=Start(R.apply(body.start.position) + x, R.as_rotvec()),
            )
            for name, body in bodies.items()
        }
        joints = (Fixed("ground.at", "beam.root", name="clamp"),)
        axis = R.apply([1, 0, 0])
        springs = (Spring("s", "bushing", ("beam.tip", "mass"), axis, **spring),)
        ground = {"at": Frame(x, R.as_rotvec())}
        return model_of(moved, joints, springs=springs, ground_frames=ground, step=1e-3)

    here = linearize(model(Rotation.identity(), np.zeros(3))).modes(12)
    there = linearize(model(turn, shift)).modes(12)
    np.testing.assert_allclose(there.frequencies, here.frequencies, rtol=1e-8)


def test_gravity_stiffens_a_hanging_chain_and_softens_a_standing_one(line):
    """By the forces in the joint alone: the beam itself has no terms of second order here."""
    swing = [
        linearize(held(line, Revolute("ground", "beam.root", Z, name="h"), gravity=[g, 0, 0]))
        .modes(1)
        .values[0]
        for g in (9.81, -9.81)
    ]
    assert swing[0].imag == pytest.approx(np.sqrt(1.5 * 9.81), rel=2e-3)
    assert abs(swing[1].real) == pytest.approx(np.sqrt(1.5 * 9.81), rel=2e-3)


def oscillator(law=None, **spring):
    body = RigidBody(2.0, [0.1, 0.1, 0.1], start=Start([1.0, 0, 0]))
    slide = Prismatic("ground", "body", [1, 0, 0], name="slide")
    laws = {} if law is None else {"law": {"x": law}}
    k = [spring.get("stiffness", 50.0), 0, 0, 0, 0, 0]
    d = [spring.get("damping", 0.0), 0, 0, 0, 0, 0]
    bushing = Spring("s", "bushing", ("ground", "body"), stiffness=k, damping=d, **laws)
    return model_of({"body": body}, (slide,), springs=(bushing,), step=1e-3)


@pytest.mark.parametrize("damping", [3.0, 60.0])
def test_a_damped_oscillator(damping):
    found = linearize(oscillator(damping=damping)).modes()
    expected = np.roots([2.0, damping, 50.0])
    expected = expected[expected.imag >= 0.0]
    expected = expected[np.argsort(np.abs(expected))]
    np.testing.assert_allclose(found.values, expected, rtol=1e-10)


def test_a_mass_on_a_damper_alone_moves_freely_and_comes_to_rest():
    found = linearize(oscillator(stiffness=0.0, damping=3.0)).modes()
    assert found.rigid == 1
    np.testing.assert_allclose(found.values, [0.0, -1.5], atol=1e-9)


def test_a_maxwell_chain_has_states_of_its_own():
    tau, k_1, k, m = 0.2, 70.0, 50.0, 2.0
    found = linearize(oscillator(MaxwellLaw([tau], [k_1]))).modes()
    expected = np.roots([m * tau, m, (k + k_1) * tau, k])
    expected = expected[expected.imag >= 0.0]
    np.testing.assert_allclose(np.sort(found.values), np.sort(expected), rtol=1e-10)


def test_a_law_counts_with_its_slope_where_the_spring_is_loaded():
    """A mass hangs on a rope: the distance is long, the cross stiffness is force over length."""
    body = RigidBody(2.0, [0.1, 0.1, 0.1], start=Start([0, -1.0, 0]))
    rope = Spring("s", "point", ("ground.top", "body"), stiffness=500.0, rest=1.0)
    model = model_of(
        {"body": body},
        springs=(rope,),
        gravity=[0, -9.81, 0],
        ground_frames={"top": Frame([0, 0, 0])},
        step=1e-3,
    )
    found = linearize(model).modes()
    length = 1.0 + 2.0 * 9.81 / 500.0
    assert found.rigid == 3
    swing = np.sqrt(9.81 / length)
    np.testing.assert_allclose(found.values[3:].imag, [swing, swing, np.sqrt(250.0)], rtol=1e-7)


def test_decay_and_frequency_are_those_of_a_run(random_element):
    element = random_element(3, (True, False), omega=(50.0, 400.0))
    joint = Fixed("ground", "body.i0", name="clamp")
    start = Start(-element.interface("i0").X)
    kick = Force("body.i1", [1e-3, 2e-3, 0.0], _short_pulse())
    model = Model(
        {"body": FlexibleBody(element, start)},
        (joint,),
        (kick,),
        settings=Settings(t_end=1.0, step=2e-4, rho_inf=0.9),
    )
    linear = linearize(model)
    slowest = linear.modes()
    k = int(np.argmin(-slowest.values.real))
    run = simulate(model)
    signal, t = run.frame("body.i1").u[2500:, 0], run.time[2500:]
    modes = slowest.values[slowest.values.imag > 0.0]
    basis = np.exp(np.outer(t - t[0], np.concatenate([modes, modes.conj()])))
    fit, *_ = np.linalg.lstsq(basis, signal.astype(complex), rcond=None)
    left = signal - basis @ fit
    assert np.abs(left).max() < 1e-3 * np.abs(signal).max()
    assert k >= 0


def _short_pulse():
    from duhamel.solver import Pulse

    return Pulse(1.0, 0.0, 5e-3)


def test_few_modes_of_a_large_model_are_those_of_all(tmp_path, monkeypatch):
    """Also where many coincide: of shafts that are alike, in both planes, and free to turn."""
    shaft = make_line(tmp_path, 1.0, 9, section={**SECTION, "EI_z": SECTION["EI_y"]})
    bodies = {
        f"shaft{k}": FlexibleBody(shaft, Start([0, k, 0] - shaft.interface("root").X))
        for k in range(5)
    }
    joints = [Revolute("ground", f"{name}.root", [1, 0, 0], name=name) for name in bodies]
    linear = linearize(model_of(bodies, tuple(joints), step=1e-3))
    all_modes = linear.modes()
    monkeypatch.setattr(modes_module, "MAX_DENSE_STATES", 10)  # which leaves iteration
    few = linear.modes(20)
    assert few.rigid == all_modes.rigid == 5
    np.testing.assert_allclose(few.frequencies, all_modes.frequencies[:20], rtol=1e-8)
    with pytest.raises(ModelError, match="states: expected at most 10"):
        linear.modes()


def test_iteration_finds_more_modes_that_coincide_than_a_block_has_vectors():
    omega = np.concatenate([np.full(20, 1.0), np.geomspace(2.0, 1e3, 280)])
    rotation = np.kron(np.diag(omega), [[0.0, 1.0], [-1.0, 0.0]])
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=rotation.shape))
    inverse = np.linalg.inv(turn @ rotation @ turn.T - 0.03 * np.eye(len(rotation)))
    space = subspace.slowest(lambda x: inverse @ x, 600, 0.03, 22, 500)
    found = np.sort(space.values[space.found & (space.values.imag > 0.0)].imag)
    np.testing.assert_allclose(found[:22], omega[:22], rtol=1e-8)


def test_shapes_satisfy_the_joints(line):
    linear = linearize(held(line, Revolute("ground", "beam.root", Z, name="hinge")))
    found = linear.modes(6)
    motion = linear.motion(found.y)
    at = motion.names.index("beam.root")
    both = np.hstack([motion.translations, motion.rotations])
    held_fast = both[at, [0, 1, 2, 3, 4]]
    assert (np.abs(held_fast) < 1e-9 * np.abs(both).max(axis=(0, 1))).all()


def test_what_cannot_be_linearized_is_refused_by_name(line, measured):
    hinge = Revolute(
        "ground", "beam.root", Z, name="hinge", friction=JointFriction(0.1, radius=0.01)
    )
    with pytest.raises(ModelError, match="joint 'hinge': friction sticks or slips"):
        linearize(held(line, hinge))
    with pytest.raises(ModelError, match="spring 's': BoucWenLaw depends on its past"):
        linearize(oscillator(BoucWenLaw(1.0, 1.0, 1.0)))
    linear = linearize(held(measured(line), CLAMP))
    with pytest.raises(ModelError, match="superelement 'line' has a kernel but no modes"):
        linear.modes()


def test_a_damper_law_has_its_slope_at_rest():
    found = linearize(oscillator(DamperLaw(4.0, 4.0))).modes()
    expected = np.roots([2.0, 4.0, 50.0])
    np.testing.assert_allclose(found.values, expected[expected.imag > 0.0], rtol=1e-9)


def test_a_law_with_a_kink_at_rest_is_refused():
    message = "spring 's': the slope of DamperLaw jumps at rest, from 4 to 1"
    with pytest.raises(ModelError, match=message):
        linearize(oscillator(DamperLaw(4.0, 1.0)))
    with pytest.raises(ModelError, match="the slope of TabulatedLaw jumps at rest, from 3 to 8"):
        linearize(oscillator(TabulatedLaw((-1.0, 0.0, 1.0), (-3.0, 0.0, 8.0))))


@pytest.fixture(scope="module")
def lossy(tmp_path_factory):
    damping = {"loss_factor": 0.02, "band": [5.0, 3000.0]}
    return make_line(tmp_path_factory.mktemp("lossy"), 1.0, 8, damping=damping)


def test_a_material_gives_every_mode_half_its_loss_factor(lossy):
    """Whatever holds the beam, in the band; the modes are found without those of the chain."""
    for joints in ((), (CLAMP,), (Revolute("ground", "beam.root", Z, name="pin"),)):
        found = linearize(held(lossy, *joints)).modes(14)
        inside = (found.frequencies > 10.0) & (found.frequencies < 2000.0)
        assert inside.sum() >= 5
        np.testing.assert_allclose(found.ratios[inside], 0.01, rtol=0.04)


@pytest.mark.parametrize("loss_factor", [0.02, 0.1])
def test_a_free_beam_that_loses_energy_has_the_complex_frequencies_of_its_own_modes(
    tmp_path, loss_factor
):
    """omega^2 c(s) + s^2 = 0, found without a division by zero where the body resonates."""
    damping = {"loss_factor": loss_factor, "band": [10.0, 4000.0]}
    element = make_line(tmp_path, 1.0, 8, damping=damping)
    chain, omega = element.modes.chain, np.sort(element.modes.omega)[:20]
    with warnings.catch_warnings(action="error"):
        found = linearize(held(element)).modes(26)
    assert found.rigid == 6
    s = found.values[6:]
    c = 1.0 + (np.multiply.outer(s, chain.tau) / (1 + np.multiply.outer(s, chain.tau))) @ (
        chain.amplitude
    )
    np.testing.assert_allclose(-(s**2) / c, omega**2, rtol=1e-9)


def test_a_chain_in_state_space_is_that_of_the_responses(lossy):
    linear = linearize(held(lossy, CLAMP))
    asked = ["force:beam.tip:y"], ["position:beam.tip:y", "velocity:beam.tip:y"]
    found = linear.state_space(*asked)
    frequencies = np.array([1.0, 17.0, 300.0])
    expected = linear.frf(*asked, frequencies).values
    for k, frequency in enumerate(frequencies):
        away = 2j * np.pi * frequency * np.eye(len(found.A)) - found.A
        G = found.C @ np.linalg.solve(away, found.B) + found.D
        np.testing.assert_allclose(G, expected[k], rtol=1e-5)


def test_a_servo_on_a_joint():
    """J s^2 + d s + k + I / s on a rigid arm, and the response to what the motor gives."""
    J, k, d, integral = 0.53, 40.0, 2.0, 25.0
    arm = pendulum(gravity=0.0)
    motor = Motor("servo", "hinge", "angle", stiffness=k, damping=d, integral=integral)
    linear = linearize(replace(arm, motors=(motor,)))
    expected = np.roots([J, d, k, integral])
    expected = expected[expected.imag >= 0.0]
    found = linear.modes()
    np.testing.assert_allclose(np.sort(found.values), np.sort(expected), rtol=1e-9)
    s = 2j * np.pi * 1.3
    given = linear.frf(["motor:servo", "torque:body:z"], ["angle:body:z"], [0.0, 1.3]).values
    G = s / (J * s**3 + d * s**2 + k * s + integral)
    np.testing.assert_allclose(given[1, 0], [G, G], rtol=1e-9)
    np.testing.assert_allclose(given[0, 0], [0.0, 0.0], atol=1e-12)


def test_a_gear_carries_the_inertia_of_its_wheel_over():
    """J_1 + (z_1 / z_2)^2 J_2 on a torsion spring of the first wheel."""
    J_1, J_2, k = 0.02, 0.3, 8.0
    bodies = {
        "a": RigidBody(1.0, [J_1] * 3),
        "b": RigidBody(1.0, [J_2] * 3, start=Start([0.5, 0, 0])),
    }
    joints = (
        Revolute("ground", "a", Z, name="first"),
        Revolute("ground", "b", Z, name="second"),
    )
    spring = Spring("s", "torsion", ("ground", "a"), Z, stiffness=k)
    gear = Coupler("gear", "gear", ["first", "second"], teeth=[20, 50])
    model = model_of(bodies, joints, springs=(spring,), couplers=(gear,), step=1e-3)
    found = linearize(model).modes()
    omega = np.sqrt(k / (J_1 + (20 / 50) ** 2 * J_2))
    np.testing.assert_allclose(found.values, [1j * omega], rtol=1e-10, atol=1e-10)
