"""Arguments of models in Python, settings apart from mechanisms, and kinds that a user adds."""

import inspect
import re
from dataclasses import dataclass, replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Cylindrical,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Joint,
    Load,
    Model,
    ModelError,
    Motor,
    PrescribedDisplacement,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Spring,
    Start,
    SteadyRotation,
    Steps,
    Torque,
    Universal,
    read_model,
    simulate,
    write_model,
)
from duhamel.solver.couplings.joint import ABOUT_E3, ANGLE_ABOUT_E3, JointWithAxis
from duhamel.solver.couplings.springs import SPRING_TYPES, SpringType
from duhamel.solver.schema.entry import Entry, entry
from duhamel.solver.signals.signal import SIGNAL_FORMS, Pointwise

Z = [0, 0, 1]
ARRAYS = {
    "position": lambda x: Frame(x).position,
    "rotation": lambda x: Start(rotation=x).rotation,
    "axis": lambda x: Revolute("a", "b", x, name="j").axis,
    "direction": lambda x: Force("a", x, Constant(1.0)).direction,
    "gravity": lambda x: Model({"a": RigidBody(1.0, [1, 1, 1])}, gravity=x).gravity,
    "center": lambda x: SteadyRotation(Z, x).center,
    "stiffness": lambda x: Spring("s", "point", ("a", "b"), stiffness=x[2]).stiffness[0],
    "motion": lambda x: PrescribedDisplacement("m", "a", x, Constant(0.0)).direction,
}


@pytest.mark.parametrize("kind", [list, tuple, np.array])
@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_may_be_given_as_lists_and_are_kept_as_copies(name, kind):
    given = kind([0, 0, 1])
    kept = ARRAYS[name](given)
    assert isinstance(kept, np.ndarray)
    assert kept.dtype == np.float64
    assert kept.tolist() in ([0.0, 0.0, 1.0], [1.0])
    assert not np.shares_memory(kept, given)


@pytest.mark.parametrize("kind", [list, tuple, np.array])
def test_limits_of_a_motor_may_be_given_as_arrays(kind):
    motor = Motor("m", "j", "angle", torque=Constant(1.0), limit=kind([-1.0, 2.0]))
    assert motor.limit == (-1.0, 2.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Model({"a": RigidBody(1.0, [1, 1, 1])}, motors=[3]), "motors: .* got 3"),
        (lambda: Force("a", Z, Harmonic), "signal: expected a signal such as Constant"),
        (lambda: FlexibleBody("beam.h5"), "superelement: .* got 'beam.h5'"),
    ],
)
def test_what_is_of_another_kind_is_refused(make, message):
    with pytest.raises(ModelError, match=message):
        make()


@pytest.mark.parametrize("kind", [list, tuple, np.array])
def test_points_of_signals_may_be_lists_and_are_kept_as_tuples(kind):
    assert Steps(kind([0, 1]), kind([2, 3])) == Steps((0.0, 1.0), (2.0, 3.0))
    assert isinstance(Steps(kind([0, 1]), kind([2, 3])).times[0], float)


def test_a_unit_vector_is_kept_to_the_last_bit():
    rng = np.random.default_rng(0)
    for axis in rng.normal(size=(1000, 3)):
        unit = Revolute("a", "b", axis, name="j").axis
        assert np.linalg.norm(unit) == pytest.approx(1.0, abs=4e-16)
        assert Revolute("a", "b", unit, name="j").axis.tolist() == unit.tolist()


def pendulum(**settings):
    bob = RigidBody(1.0, [0.1, 0.1, 0.1], {"eye": Frame([-0.5, 0, 0])})
    pin = Revolute("ground", "bob.eye", Z, name="pin")
    settings = Settings(**{"t_end": 0.02, "step": 1e-3} | settings)
    return Model({"bob": bob}, [pin], gravity=[0, -9.81, 0], settings=settings)


def test_one_mechanism_runs_with_many_settings():
    model = pendulum()
    fine = Settings(t_end=0.01, step=5e-4, rho_inf=0.7)
    results = simulate(model, fine)
    assert (results.solver["h"], results.solver["rho_inf"], len(results.time)) == (5e-4, 0.7, 21)
    np.testing.assert_array_equal(
        results.body("bob").x, simulate(replace(model, settings=fine)).body("bob").x
    )
    assert simulate(model).solver["h"] == 1e-3
    assert simulate(model.with_settings(t_end=0.005)).time[-1] == pytest.approx(0.005)
    simulator = Simulator(model, ["bodies/bob/x"], fine)
    assert simulator.step([]).tolist() == results.body("bob").x[1].tolist()


def test_settings_are_keyword_only_and_come_before_the_file():
    with pytest.raises(TypeError):
        Settings(1.0)
    kinds = {name: p.kind.name for name, p in inspect.signature(simulate).parameters.items()}
    assert kinds == {
        "model": "POSITIONAL_OR_KEYWORD",
        "settings": "POSITIONAL_OR_KEYWORD",
        "output": "KEYWORD_ONLY",
        "progress": "KEYWORD_ONLY",
        "resume": "KEYWORD_ONLY",
        "force": "KEYWORD_ONLY",
        "anyway": "KEYWORD_ONLY",
    }
    with pytest.raises(ModelError, match=re.escape("settings: expected Settings, got 'out.h5'")):
        simulate(pendulum(), "out.h5")


def test_settings_must_suit_the_mechanism():
    """A body with a velocity has no equilibrium, whichever of the two is given first."""
    model = pendulum()
    moving = replace(model.bodies["bob"], start=Start(velocity=[0, 1, 0]))
    moving = replace(model, bodies={"bob": moving})
    message = "body 'bob': velocity: start = 'equilibrium' takes no velocity"
    with pytest.raises(ModelError, match=re.escape(message)):
        simulate(moving, Settings(t_end=0.1, step=1e-3, start="equilibrium"))


def test_a_signal_of_a_users_own_is_read_and_written(tmp_path):
    """With the one declaration of its class."""
    before = dict(SIGNAL_FORMS.forms)

    @SIGNAL_FORMS.in_files("decay")
    @entry(eq=True)
    class Decay(Pointwise, Entry):
        decay: float
        amplitude: float = 1.0

        def __call__(self, t: float) -> float:
            return self.amplitude * np.exp(-self.decay * t)

    try:
        model = replace(
            pendulum(),
            loads=[Torque("bob", Z, Decay(0.1)), Torque("bob", Z, Decay(0.2, 3.0))],
        )
        write_model(tmp_path / "model.toml", model)
        again = read_model(tmp_path / "model.toml")
    finally:
        SIGNAL_FORMS.forms.clear()
        SIGNAL_FORMS.forms.update(before)
    assert [load.signal for load in again.loads] == [load.signal for load in model.loads]
    np.testing.assert_array_equal(simulate(again).body("bob").x, simulate(model).body("bob").x)


def test_joints_and_loads_are_made_by_their_types_as_well():
    """As earlier versions made them."""
    joint = Joint("pin", "revolute", ("ground", "arm"), [0, 0, 2], friction=None)
    assert type(joint) is Revolute
    assert joint.between == ("ground", "arm")
    np.testing.assert_array_equal(joint.axis, [0, 0, 1])
    assert type(Joint("j", "universal", ("a", "b"), [0, 0, 1], [1, 0, 0])) is Universal
    assert type(Load("torque", "arm", [1, 0, 0], Constant(1.0), follower=True)) is Torque
    with pytest.raises(ModelError, match=r"joint 'pin': type: expected .*'fixed'.*, got 'hinge'"):
        Joint("pin", "hinge", ("ground", "arm"))
    with pytest.raises(ModelError, match=r"load \(push\) on 'arm': type: expected .*'force'.*"):
        Load("push", "arm", [1, 0, 0], Constant(1.0))


def test_a_joint_of_a_users_own_is_a_class():
    """A pin that slides along its axis and turns about it is cylindrical by another name."""

    @entry()
    class Sleeve(JointWithAxis):
        translations = (0, 1)
        rotations = ABOUT_E3
        free_distances = {"slide": 2}  # noqa: RUF012
        free_angles = {"turn": ANGLE_ABOUT_E3}  # noqa: RUF012

    Sleeve.tag = "sleeve"
    model = pendulum()
    pin = model.joints[0]
    sleeve = Sleeve(*pin.between, pin.axis, name="pin")
    results = simulate(replace(model, joints=[sleeve]))
    expected = simulate(replace(model, joints=[Cylindrical(*pin.between, pin.axis, name="pin")]))
    found, wanted = results.joint("pin").coordinates, expected.joint("pin").coordinates
    np.testing.assert_array_equal(found["turn"], wanted["angle"])
    np.testing.assert_array_equal(found["slide"], wanted["distance"])
    assert (sleeve.unit("turn"), sleeve.unit("slide")) == ("rad", "m")


def test_a_spring_of_a_users_own_is_a_row_of_the_table(monkeypatch):
    """A spring along one axis is a bushing that is stiff along it alone."""
    monkeypatch.setitem(SPRING_TYPES, "axial", SpringType(translations=(2,), axis="needed"))
    bob = RigidBody(1.0, [0.1, 0.1, 0.1], start=Start(velocity=[0, 0, 1.0]))
    common = {"settings": Settings(t_end=0.1, step=1e-3, rho_inf=0.9)}
    axial = Spring("s", "axial", ("ground", "bob"), Z, stiffness=100.0, damping=1.0)
    alone = [0, 0, 100.0, 0, 0, 0], [0, 0, 1.0, 0, 0, 0]
    bushing = Spring("s", "bushing", ("ground", "bob"), Z, *alone)
    moved, expected = (
        simulate(Model({"bob": bob}, springs=[spring], **common)).body("bob").x
        for spring in (axial, bushing)
    )
    assert np.abs(moved[:, 2]).max() > 0.05
    np.testing.assert_allclose(moved, expected, rtol=0, atol=1e-14)


@dataclass
class Ramp:
    """A signal without any of the solver's classes: what a protocol is for."""

    slope: float

    def __call__(self, t: float) -> float:
        return self.slope * t

    def samples(self, t, h):
        return self.slope * t

    def derivatives(self, t):
        return self.slope, 0.0


def test_any_object_that_is_a_signal_drives():
    driven = replace(pendulum().joints[0], angle=Ramp(2.0))
    results = simulate(replace(pendulum(), joints=[driven]))
    np.testing.assert_allclose(
        results.joint("pin").coordinates["angle"], 2.0 * results.time, rtol=0, atol=1e-12
    )
    with pytest.raises(ModelError, match="joint 'pin': angle: a Ramp cannot be written"):
        write_model("nowhere.toml", replace(pendulum(), joints=[driven]))
    assert Harmonic(1.0, 2.0) == Harmonic(1.0, 2.0, 0.0, 0.0)
