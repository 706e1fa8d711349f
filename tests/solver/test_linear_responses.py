"""Frequency responses, static coefficients and state space, against closed forms and runs."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.results import QuantityError
from duhamel.solver import (
    JOINTS,
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Function,
    Harmonic,
    Input,
    MaxwellLaw,
    Model,
    ModelError,
    PatternLoad,
    PrescribedDisplacement,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    SteadyRotation,
    linearize,
    simulate,
    start,
)
from duhamel.superelement import Modes, sample_kernel
from scipy.signal import StateSpace, lsim

from .models import model_of
from .test_linear_modes import CLAMP, held, make_line, oscillator

FREQUENCIES = np.array([0.3, 2.0, 17.0])


@pytest.fixture(scope="module")
def line(tmp_path_factory):
    folder = tmp_path_factory.mktemp("line")
    return make_line(folder, 1.0, 8, damping={"modal": 0.03})


def test_an_oscillator():
    linear = linearize(oscillator(damping=3.0))
    outputs = ["position:body:x", "velocity:body:x", "acceleration:body:x", "force:s:x"]
    found = linear.frf(["force:body:x"], outputs, FREQUENCIES)
    s = 2j * np.pi * FREQUENCIES
    G = 1.0 / (2.0 * s**2 + 3.0 * s + 50.0)
    expected = np.stack([G, s * G, s**2 * G, -(3.0 * s + 50.0) * G], axis=1)
    np.testing.assert_allclose(found.values[:, :, 0], expected, rtol=1e-9)
    assert found.units == ("m", "m/s", "m/s²", "N")
    assert found.input_units == ("N",)


def test_a_maxwell_chain_has_its_dynamic_stiffness():
    tau, k_1 = [0.2, 0.01], [70.0, 30.0]
    linear = linearize(oscillator(MaxwellLaw(tau, k_1)))
    found = linear.frf(["force:body:x"], ["position:body:x"], FREQUENCIES).values[:, 0, 0]
    s = 2j * np.pi * FREQUENCIES
    k = 50.0 + sum(k_i * s * t / (1.0 + s * t) for k_i, t in zip(k_1, tau, strict=True))
    np.testing.assert_allclose(found, 1.0 / (2.0 * s**2 + k), rtol=1e-9)
    model = linear.state_space(["force:body:x"], ["position:body:x"])
    assert model.A.shape == (4, 4)
    np.testing.assert_allclose(transfer(model, s)[:, 0, 0], found, rtol=1e-8)


def transfer(model, s):
    """G(s) (n, n_out, n_in)"""
    unit = np.eye(len(model.A))
    return np.array([model.C @ np.linalg.solve(z * unit - model.A, model.B) + model.D for z in s])


def test_a_drive_shakes_what_stands_on_its_base():
    """Transmissibility (c s + k) / (m s^2 + c s + k), by a motion of the base."""
    bodies = {
        "base": RigidBody(5.0, [1.0] * 3),
        "mass": RigidBody(2.0, [0.1] * 3, start=Start([1.0, 0, 0])),
    }
    base = Prismatic("ground", "base", [1, 0, 0], name="table", distance=Constant(0.0))
    slide = Prismatic("base", "mass", [1, 0, 0], name="slide")
    zeros = [0.0] * 5
    spring = Spring(
        "s", "bushing", ("base", "mass"), stiffness=[50.0, *zeros], damping=[3.0, *zeros]
    )
    model = model_of(bodies, (base, slide), springs=(spring,), step=1e-3)
    outputs = ["acceleration:mass:x", "acceleration:base:x", "force:table:x"]
    found = linearize(model).frf(["drive:table"], outputs, FREQUENCIES).values[..., 0]
    s = 2j * np.pi * FREQUENCIES
    passed = (3.0 * s + 50.0) / (2.0 * s**2 + 3.0 * s + 50.0)
    np.testing.assert_allclose(found[:, 0] / found[:, 1], passed, rtol=1e-9)
    np.testing.assert_allclose(found[:, 1], s**2, rtol=1e-9)
    np.testing.assert_allclose(found[:, 2], 5.0 * s**2 + 2.0 * s**2 * passed, rtol=1e-8)
    with pytest.raises(ModelError, match="drive:table: a drive cannot be an input"):
        linearize(model).state_space(["drive:table"], outputs)


def test_an_input_moves_all_that_follows_it():
    gas = Input("gas")
    loads = (
        Force("body", [2.0, 0, 0], gas),
        Force("body", [1.0, 0, 0], gas),
    )
    linear = linearize(replace(oscillator(damping=3.0), loads=loads))
    inputs = ["gas", "load:1", "force:body:x"]
    found = linear.frf(inputs, ["position:body:x"], FREQUENCIES).values[:, 0]
    np.testing.assert_allclose(found[:, 0], 3.0 * found[:, 2], rtol=1e-12)
    np.testing.assert_allclose(found[:, 1], 2.0 * found[:, 2], rtol=1e-12)


def test_static_coefficients_of_a_clamped_beam(line):
    linear = linearize(held(line, CLAMP))
    outputs = ["position:beam.tip:y", "elastic_rotation:beam.tip:z", "moment:clamp:z"]
    found = linear.static(["force:beam.tip:y", "torque:beam.tip:z"], outputs).values[0].real
    EI = 30.0
    np.testing.assert_allclose(found[0], [1.0 / (3.0 * EI), 1.0 / (2.0 * EI)], rtol=1e-7)
    np.testing.assert_allclose(np.abs(found[2]), [1.0, 1.0], rtol=1e-7)


def test_static_coefficients_are_differences_of_equilibria(line):
    """Of a loaded mechanism: a beam on a hinge hangs on a rope."""

    def model(force):
        start_of_beam = Start(-line.interface("root").X)
        hinge = Revolute("ground", "beam.root", [0, 0, 1], name="hinge")
        rope = Spring("rope", "point", ("ground.top", "beam.tip"), stiffness=300.0, rest=0.9)
        load = Force("beam.tip", [0.3, 1.0, 0.0], Constant(force))
        return model_of(
            {"beam": FlexibleBody(line, start_of_beam)},
            (hinge,),
            springs=(rope,),
            loads=(load,),
            ground_frames={"top": Frame([0.9, 1.0, 0])},
            gravity=[0, -9.81, 0],
            step=1e-3,
            start="equilibrium",
        )

    near = [start(model(1.0 + d)).frame("beam.tip").position[0] for d in (-1e-3, 1e-3)]
    linear = linearize(model(1.0))
    found = linear.static(["load:1"], ["position:beam.tip"]).values[0, :, 0].real
    np.testing.assert_allclose(found, (near[1] - near[0]) / 2e-3, rtol=1e-5, atol=1e-9)


def test_bodies_may_be_springs_or_rigid(line):
    linear = linearize(held(line, Revolute("ground", "beam.root", [0, 0, 1], name="pin")))
    asked = ["force:beam.tip:y"], ["position:beam.tip:y"]
    low, high = 0.5, 40.0
    dynamic, static, rigid = (
        linear.frf(*asked, [low, high], bodies).values[:, 0, 0]
        for bodies in ("dynamic", "static", "rigid")
    )
    inertia = 0.4 / 3.0
    expected = -1.0 / (inertia * (2.0 * np.pi * np.array([low, high])) ** 2)
    np.testing.assert_allclose(rigid, expected, rtol=1e-2)
    assert abs(dynamic[0] / static[0] - 1.0) < 1e-4
    assert abs(dynamic[1] / static[1] - 1.0) > 0.05


@pytest.mark.parametrize("joint", ["fixed", "revolute"])
def test_state_space_has_the_same_responses(line, joint):
    axis = () if joint == "fixed" else ([0, 0, 1],)
    joint = JOINTS[joint]("ground", "beam.root", *axis, name="j")
    linear = linearize(held(line, joint))
    inputs = ["force:beam.tip:y", "torque:beam.tip:x"]
    outputs = ["position:beam.tip", "acceleration:beam.tip:y", "force:j:y", "angle:beam.root:z"]
    s = 2j * np.pi * np.array([0.7, 30.0, 400.0])
    found = linear.state_space(inputs, outputs)
    expected = linear.frf(inputs, outputs, s.imag / (2.0 * np.pi)).values
    scale = np.abs(expected).max(axis=(0, 2), keepdims=True)
    scale = np.where(scale > 1e-12, scale, 1.0)
    assert found.outputs == tuple(linear.frf(inputs, outputs, [1.0]).outputs)
    np.testing.assert_allclose(transfer(found, s) / scale, expected / scale, atol=1e-6)
    few = linear.state_space(inputs, ["position:beam.tip"], modes=8)
    assert len(few.A) <= 18
    np.testing.assert_allclose(
        transfer(few, s[:2]) / scale[:, :3], expected[:2, :3] / scale[:, :3], atol=1e-4
    )


def test_state_space_gives_the_run_under_small_loads(line):
    def push(t):
        return 1e-3 * np.sin(40.0 * t) * np.exp(-5.0 * t)

    load = Force("beam.tip", [0, 1.0, 0.5], Function(push))
    model = held(line, CLAMP, loads=(load,))
    model = model.with_settings(t_end=0.2, step=2.5e-5, rho_inf=0.9)
    run = simulate(model)
    found = linearize(model).state_space(["load:1"], ["position:beam.tip:y"], modes=20)
    system = StateSpace(found.A, found.B, found.C, found.D)
    t = run.time
    _, y, _ = lsim(system, push(t), t)
    deflection = run.frame("beam.tip").position[:, 1]
    assert np.abs(deflection - y).max() < 2e-6 * np.abs(y).max()


def test_the_response_to_an_impulse_is_that_of_a_run(random_element):
    """Its transform, at the frequencies that the scheme has in place of the true ones."""
    element = random_element(5, (True, False), omega=(100.0, 600.0))
    element = replace(element, modes=replace(element.modes, zeta=np.full(8, 0.5)))
    joint = Fixed("ground", "body.i0", name="clamp")
    h, n = 1e-3, 6000

    def blow(t):
        return 1e-4 if abs(t - 10 * h) < 0.5 * h else 0.0

    load = Force("body.i1", [1.0, 0.5, 0.2], Function(blow))
    body = FlexibleBody(element, Start(-element.interface("i0").X))
    settings = Settings(t_end=n * h, step=h, rho_inf=0.9)
    model = Model({"body": body}, (joint,), (load,), settings=settings)
    u = simulate(model).frame("body.i1").u[:, 0]
    linear = linearize(model)
    response = linear.state_space(["load:1"], ["elastic_displacement:body.i1:x"])
    for frequency in (5.0, 21.0, 60.0):
        d = np.exp(-2j * np.pi * frequency * h)
        found = (u * d ** (np.arange(len(u)) - 10)).sum() / 1e-4
        sigma, chi = element.kernel.scheme.symbols(h, np.array([d]))
        s = np.sqrt(sigma[0])
        s = s if s.imag > 0.0 else -s
        expected = transfer(response, [s])[0, 0, 0]
        assert abs(chi[0] - s) < 1e-2 * abs(s)
        assert abs(found / expected - 1.0) < 5e-3


def test_a_body_known_by_its_kernel_has_the_response_of_its_modes(random_element, measured):
    element = random_element(7, (True, False), omega=(100.0, 900.0))
    form = Modes(element.modes.omega, np.full(8, 0.05), element.modes.phi)
    h = 2e-4
    kernel = sample_kernel(form, h, element.kernel.scheme, 9000)
    element = replace(element, modes=form, kernel=kernel)
    joint = Fixed("ground", "body.i0", name="clamp")
    asked = ["force:body.i1:y"], ["position:body.i1", "moment:clamp"], [0.0, 3.0, 40.0, 90.0]

    def response(element):
        body = FlexibleBody(element, Start(-element.interface("i0").X))
        settings = Settings(t_end=0.5, step=h, rho_inf=0.9)
        return linearize(Model({"body": body}, (joint,), settings=settings)).frf(*asked).values

    by_modes, by_kernel = response(element), response(measured(element))
    scale = np.abs(by_modes).max(axis=(0, 2), keepdims=True)
    np.testing.assert_allclose(by_kernel / scale, by_modes / scale, atol=2e-3)


def test_a_kernel_that_has_not_decayed_has_no_transfer_function(random_element, measured):
    element = measured(random_element(7, (True, False)))
    body = FlexibleBody(element, Start(-element.interface("i0").X))
    settings = Settings(t_end=0.1, step=1e-3, rho_inf=0.9)
    linear = linearize(Model({"body": body}, settings=settings))
    with pytest.raises(ModelError, match="superelement 'random 7' has no modes"):
        linear.frf(["force:body.i1:y"], ["position:body.i1:y"], [10.0])


def test_a_response_in_steady_rotation_turns_with_the_mechanism():
    """A mass on springs in a turning frame: k - m (s^2 + 2 s spin~ + spin~^2)."""
    spin, k, m = 12.0, 2e4, 2.0
    bodies = {"hub": RigidBody(1.0, [0.1] * 3), "mass": RigidBody(m, [0.1] * 3)}
    springs = Spring("s", "bushing", ("hub", "mass"), stiffness=[k, k, k, 50.0, 50.0, 50.0])
    axle = Revolute("ground", "hub", [0, 0, 1], name="axle")
    model = model_of(bodies, (axle,), springs=(springs,), step=1e-3)
    linear = linearize(model, SteadyRotation([0, 0, spin]))
    outputs = ["position:mass:x", "position:mass:y", "velocity:mass:x", "acceleration:mass:y"]
    found = linear.frf(["force:mass:x"], outputs, [7.0]).values[0, :, 0]
    s = 2j * np.pi * 7.0
    turn = np.array([[s, -spin], [spin, s]])  # d/dt in turning axes
    x = np.linalg.solve(m * turn @ turn + k * np.eye(2), [1.0, 0.0])
    expected = [*x, (turn @ x)[0], (turn @ turn @ x)[1]]
    np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_the_drive_of_a_motion_and_the_forces_of_joints(line):
    hold = PrescribedDisplacement("hold", "beam.tip", [0, 1, 0], Harmonic(0.0, 1.0))
    model = held(line, CLAMP, motions=(hold,))
    found = linearize(model).static(["drive:hold"], ["force:clamp:y", "position:beam.tip:y"])
    np.testing.assert_allclose(found.values[0, :, 0].real, [-3.0 * 30.0, 1.0], rtol=1e-7)


def test_an_open_contact_is_not_there_and_a_closed_one_has_its_stiffness():
    from duhamel.solver import Contact, Impact

    ball = RigidBody(1.0, [0.1] * 3, start=Start([0, 0, 0.1]))
    plane = Contact(
        "floor",
        ("ground.floor", "ball"),
        shape="plane",
        ball=0.1,
        axis=[0, 0, 1],
        impact=Impact(stiffness=1e6, exponent=1.5),
    )
    guide = Prismatic("ground", "ball", [0, 0, 1], name="guide")
    model = model_of(
        {"ball": ball},
        (guide,),
        contacts=(plane,),
        ground_frames={"floor": Frame()},
        gravity=[0, 0, -9.81],
        step=1e-4,
        start="equilibrium",
    )
    depth = (9.81 / 1e6) ** (2.0 / 3.0)
    omega = np.sqrt(1.5 * 1e6 * np.sqrt(depth))
    found = linearize(model).modes()
    assert found.frequencies[0] == pytest.approx(omega / (2.0 * np.pi), rel=1e-6)
    above = replace(
        model, gravity=[0, 0, 0], bodies={"ball": replace(ball, start=Start([0, 0, 1]))}
    )
    assert linearize(above).modes().rigid == 1


def test_inputs_and_outputs_that_there_are_not(line):
    linear = linearize(held(line, CLAMP))
    outputs = ["position:beam.tip:y"]
    for name, message in {
        "gas": "gas: no such input; there are: none, and force:FRAME",
        "load:1": "load:1: expected load:1 to load:0",
        "drive:clamp": "drive:clamp: no scalar drive of 'clamp'; there are: none",
        "force:beam.tip": "force:beam.tip: expected force:BODY|FRAME:x|y|z",
        "force:bean.tip:x": "force:bean.tip:x: no body or frame 'bean.tip'",
    }.items():
        with pytest.raises(ModelError, match=message.replace("|", r"\|")):
            linear.frf([name], outputs, FREQUENCIES)
    with pytest.raises(QuantityError, match="no quantity 'place'"):
        linear.frf(["force:beam.tip:x"], ["place:beam.tip"], FREQUENCIES)
    with pytest.raises(ModelError, match="frequencies: expected numbers >= 0"):
        linear.frf(["force:beam.tip:x"], outputs, [-1.0])


def test_free_motions_have_no_static_response(line):
    with pytest.raises(ModelError, match="no finite response at 0 Hz: an undamped"):
        linearize(held(line)).static(["force:beam.tip:x"], ["position:beam.tip:x"])


def test_a_pattern_of_loads_and_sensors_inside_the_body(tmp_path):
    """q L^4 / (8 EI) at the tip and q L^2 / 2 in the clamp, of a beam under a uniform load."""
    element = make_line(
        tmp_path,
        1.0,
        8,
        loads={"wind": {"force_per_length": [0.0, 1.0, 0.0]}},
        sensors={
            "end": {"point": [1.0, 0.0, 0.0]},
            "gauge": {"point": [0.001, 0.01, 0.0], "direction": [1, 0, 0]},
        },
    )
    loads = (
        PatternLoad("beam", "wind", Constant(0.0)),
        Force("beam.tip", [0, 1.0, 0], Constant(0.0)),
    )
    linear = linearize(held(element, CLAMP, loads=loads))
    inputs = ["load:1", "load:2", "force:beam.tip:y"]
    outputs = ["position:beam.tip:y", "moment:clamp:z", "sensor_displacement:beam.end:y"]
    found = linear.static(inputs, [*outputs, "strain:beam.gauge"]).values[0].real
    np.testing.assert_allclose(found[0], [1.0 / 240.0, 1.0 / 90.0, 1.0 / 90.0], rtol=1e-6)
    np.testing.assert_allclose(np.abs(found[1]), [0.5, 1.0, 1.0], rtol=1e-6)
    np.testing.assert_allclose(found[3, 1], -0.01 * 0.999 / 30.0, rtol=1e-4)
    frequency = 7.0
    outputs = ["acceleration:beam.tip:y", "sensor_acceleration:beam.end:y"]
    both = linear.frf(["load:1"], outputs, [frequency]).values[0, :, 0]
    np.testing.assert_allclose(both[0], both[1], rtol=1e-6)
    state_space = linear.state_space(["load:1"], outputs)
    s = 2j * np.pi * frequency
    np.testing.assert_allclose(transfer(state_space, [s])[0, :, 0], both, rtol=1e-5)
