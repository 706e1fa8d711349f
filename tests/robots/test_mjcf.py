"""Robots in MJCF fall and are driven as MuJoCo has them."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.robots import ImportOptions, RobotError, import_robot
from duhamel.solver import Constant, Simulator, read_model, simulate

from .references import DATA, model_of, rates, rates_by_mujoco

mujoco = pytest.importorskip("mujoco")

STATE = {"shoulder": 0.4, "elbow": -0.3, "slide": 0.02}
T_END = 0.3
STEPS = 4000


def written(folder, body, after=""):
    path = folder / "robot.xml"
    path.write_text(f"<mujoco><worldbody>{body}</worldbody>{after}</mujoco>", encoding="utf-8")
    return path


PENDULUM = (
    '<body name="bob" pos="0 0 1"><joint name="pin" axis="0 1 0" {}/>'
    '<geom type="sphere" size="0.1" pos="0.5 0 0" mass="2"/></body>'
)


def test_a_robot_falls_as_in_mujoco_with_errors_of_second_order(tmp_path):
    """Position and velocity servos hold it back, whose controls are zero there."""
    exact = rates_by_mujoco(DATA / "arm.xml", STATE, T_END)
    errors = []
    for step in (1e-3, 5e-4):
        model = model_of("arm.xml", tmp_path, state=STATE, t_end=T_END, step=step)
        motors = [
            replace(motor, reference=Constant(0.0)) if motor.name == "shoulder servo" else motor
            for motor in model.motors
        ]
        found = rates(replace(model, motors=motors, stops=()))
        assert found.keys() == exact.keys()
        errors.append(max(abs(found[name] - exact[name]) for name in exact))
    assert max(map(abs, exact.values())) > 0.5
    assert errors[0] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)


def test_actuators_are_motors_with_inputs(tmp_path):
    model = model_of("arm.xml", tmp_path)
    servo, rate, push, spring = model.motors
    assert (servo.joint, servo.stiffness, servo.damping, servo.limit) == (
        *("shoulder", 40.0, 3.0),
        (-30.0, 30.0),
    )
    assert (rate.joint, rate.damping, rate.reference_rate.name) == ("elbow", 4.5, "elbow rate")
    assert (push.joint, push.force.name, push.limit) == ("slide", "push", (-8.0, 8.0))
    assert (spring.reference, spring.stiffness) == (Constant(0.03), 60.0)


def test_a_force_by_an_input_is_that_of_the_actuator(tmp_path):
    """The input is the force, four times the control of the motor."""
    model = replace(model_of("arm.xml", tmp_path, t_end=0.1, step=2e-4), stops=())
    motors = {motor.name: motor for motor in model.motors}
    motors["shoulder servo"] = replace(motors["shoulder servo"], reference=Constant(0.3))
    motors["push"] = replace(motors["push"], force=Constant(4.0 * 1.5))
    motors["elbow rate"] = replace(motors["elbow rate"], reference_rate=Constant(0.8 / 1.5))
    found = rates(replace(model, motors=tuple(motors.values())))
    compiled = mujoco.MjModel.from_xml_path(str(DATA / "arm.xml"))
    compiled.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    compiled.opt.timestep = 0.1 / STEPS
    data = mujoco.MjData(compiled)
    data.ctrl[:] = [0.3, 0.8, 1.5]
    for _ in range(STEPS):
        mujoco.mj_step(compiled, data)
    exact = {compiled.joint(j).name: data.qvel[j] for j in range(3)}
    assert found == pytest.approx(exact, rel=1e-4)


def test_an_armature_is_a_rotor_behind_a_gear(tmp_path):
    """On the ground the rotor has the energy of the armature, so the pendulum is MuJoCo's."""
    path = written(tmp_path, PENDULUM.format('armature="0.4"'))
    exact = rates_by_mujoco(path, {}, T_END)
    model = model_of(path, tmp_path, t_end=T_END, step=2e-4)
    assert set(model.bodies) == {"bob", "pin rotor"}
    found = rates(model)
    assert found["pin"] == pytest.approx(exact["pin"], rel=1e-5)
    assert found["pin shaft"] == pytest.approx(100.0 * found["pin"], rel=1e-10)
    slower = rates_by_mujoco(written(tmp_path, PENDULUM.format("")), {}, T_END)
    assert abs(slower["pin"] / exact["pin"]) > 1.1


def test_an_armature_of_a_slide_is_a_mass_that_moves_with_it(tmp_path):
    slide = '<joint name="s" type="slide" axis="0 0 1" armature="3"/><geom size="0.1" mass="2"/>'
    model = model_of(written(tmp_path, f"<body>{slide}</body>"), tmp_path, t_end=0.1)
    assert rates(model)["s"] == pytest.approx(-9.81 * 2.0 / 5.0 * 0.1, rel=1e-4)


def test_joints_that_an_equality_couples_are_a_mimic(tmp_path):
    two = PENDULUM.format("") + PENDULUM.replace("bob", "second").replace("pin", "other").format("")
    equality = '<equality><joint joint1="other" joint2="pin" polycoef="0.1 -2 0 0 0"/></equality>'
    model = model_of(written(tmp_path, two, equality), tmp_path, t_end=0.05)
    results = simulate(model)
    np.testing.assert_allclose(
        results.joint("other").angle, 0.1 - 2.0 * results.joint("pin").angle, atol=1e-12
    )


def test_limits_friction_and_damping_of_joints(tmp_path):
    given = 'range="-1 2" damping="0.5" frictionloss="0.2"'
    path = written(tmp_path, PENDULUM.format(given))
    model = model_of(path, tmp_path)
    (pin,), (stop,) = model.joints, model.stops
    assert (pin.friction.viscous, pin.friction.torque) == (0.5, 0.2)
    assert stop.range == pytest.approx(tuple(np.radians([-1.0, 2.0])))


def test_a_ball_joint_is_spherical_and_a_free_one_is_none(tmp_path):
    body = '<body name="{0}" pos="0 0 1"><{1}/><geom size="0.1" pos="0.3 0 0" mass="1"/></body>'
    text = body.format("ball", 'joint name="b" type="ball" damping="1"')
    text += body.format("stone", "freejoint")
    done = import_robot(written(tmp_path, text), tmp_path / "robot.toml")
    model = read_model(done.path)
    assert [joint.type for joint in model.joints] == ["spherical"]
    assert set(model.bodies) == {"ball", "stone"}
    assert "joint 'b': damping of a spherical joint" in done.remarks
    assert any("link 'stone' is free" in remark for remark in done.remarks)


def test_what_is_not_taken_is_told_by_name(tmp_path):
    body = PENDULUM.format("").replace("<geom", '<site name="s"/><geom')
    text = """
      <actuator><general name="valve" joint="pin" dyntype="filter" dynprm="1"/>
        <position name="servo" joint="pin" kp="5" ctrlrange="-1 1"/></actuator>
      <sensor><jointpos joint="pin"/></sensor>
      <tendon><fixed name="t"><joint joint="pin" coef="1"/></fixed></tendon>
      <equality><connect name="lock" body1="bob" anchor="0 0 0"/></equality>
      <keyframe><key qpos="0"/></keyframe>
    """
    done = import_robot(written(tmp_path, body, text), tmp_path / "robot.toml")
    assert set(done.remarks) == {
        "actuator 'valve': neither motor, position nor velocity of a joint",
        "actuator 'servo': limits of the reference, -1 to 1",
        "equality 'lock' of kind connect",
        *("sensors", "tendons", "keyframes"),
        "contacts of geometries: give [[contacts]] where parts touch",
    }


def test_two_joints_on_a_body_are_refused_by_name(tmp_path):
    text = (
        '<body name="hip"><joint name="x" axis="1 0 0"/><joint name="y"/><geom size="0.1"/></body>'
    )
    with pytest.raises(RobotError, match="body 'hip': expected one joint, found 'x', 'y'"):
        import_robot(written(tmp_path, text), tmp_path / "robot.toml")


def test_what_mujoco_refuses_is_an_error_in_its_words(tmp_path):
    with pytest.raises(RobotError, match=r"robot\.xml: .*unrecognized attribute"):
        import_robot(written(tmp_path, '<body nme="a"/>'), tmp_path / "robot.toml")


def test_without_mujoco_the_error_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "mujoco", None)
    with pytest.raises(RobotError, match=r"pip install 'duhamel\[robots\]'"):
        import_robot(DATA / "arm.xml", tmp_path / "robot.toml")


def test_gravity_is_that_of_the_file(tmp_path):
    path = written(tmp_path, PENDULUM.format(""), '<option gravity="0 -3.7 0"/>')
    assert model_of(path, tmp_path).gravity.tolist() == [0.0, -3.7, 0.0]


def test_inputs_are_taken_step_by_step(tmp_path):
    import_robot(DATA / "arm.xml", tmp_path / "robot.toml", ImportOptions(t_end=0.01))
    model = read_model(tmp_path / "robot.toml")
    simulator = Simulator(model, ["joints/slide/distance"])
    assert set(simulator.inputs) == {"shoulder servo", "elbow rate", "push"}
