"""Linear analysis in steady rotation: whirl, gyroscopic and centrifugal terms, Campbell."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    ModelError,
    Motor,
    Polynomial,
    PrescribedDisplacement,
    PrescribedRotation,
    Revolute,
    RigidBody,
    Spherical,
    Spring,
    Start,
    SteadyRotation,
    campbell,
    linearize,
)
from duhamel.solver.linear.modes import FirstOrder

from .models import model_of
from .test_linear_modes import make_line

X = np.array([1.0, 0.0, 0.0])
MASS, POLAR, DIAMETRAL = 3.0, 0.05, 0.03
STIFFNESS, ARM, DAMPING = 5e4, 0.09, 20.0
TILTING = STIFFNESS * ARM**2


def rotor(uneven=1.0, damping=0.0, **model):
    """A rigid disk between two bearings that stand in space, springs alike all round."""
    half = [0.5 * STIFFNESS, 0.5 * STIFFNESS, 0.5 * STIFFNESS * uneven, 0.0, 0.0, 0.0]
    ends = {"left": Frame([-ARM, 0, 0]), "right": Frame([ARM, 0, 0])}
    disk = RigidBody(MASS, [POLAR, DIAMETRAL, DIAMETRAL], ends)
    bearings = tuple(
        Spring(
            name,
            "bushing",
            (f"ground.{name}", f"disk.{name}"),
            stiffness=half,
            damping=[0.5 * damping] * 3 + [0.0] * 3,
        )
        for name in ends
    )
    settings = {"start": "equilibrium", "steady_rotation": SteadyRotation(X)} | model
    return model_of({"disk": disk}, springs=bearings, ground_frames=ends, step=1e-3, **settings)


def whirls(spin):
    """In space, along the spin positive: translation, and tilting with its gyroscopic moment."""
    bounce = np.sqrt(STIFFNESS / MASS)
    tilt = np.roots([DIAMETRAL, -POLAR * spin, -TILTING])
    return np.concatenate([[bounce, -bounce], tilt])


@pytest.mark.parametrize("spin", [10.0, 150.0, 900.0])
def test_an_overhung_disk_whirls_by_the_formula(spin):
    found = linearize(rotor(), SteadyRotation(spin * X)).modes()
    seen = np.abs(whirls(spin) - spin)
    expected = np.sort(np.concatenate([seen, [np.sqrt(STIFFNESS / MASS)]]))
    assert found.rigid == 1
    np.testing.assert_allclose(found.values[1:].imag, expected, rtol=1e-9)
    np.testing.assert_allclose(found.values.real, 0.0, atol=1e-7)


def test_damping_that_stands_in_space_is_the_same_at_every_speed():
    """In axes of the rotor it moves positions with rates: lambda = lambda_0 -+ i spin."""
    still = np.roots([MASS, DAMPING, STIFFNESS])[0]
    for spin in (50.0, 400.0):
        found = linearize(rotor(damping=DAMPING), SteadyRotation(spin * X)).modes()
        for way in (-1.0, 1.0):
            expected = complex(still.real, abs(abs(still.imag) + way * spin))
            assert np.abs(found.values - expected).min() < 1e-7 * abs(expected)


def test_damping_that_turns_with_the_shaft_makes_it_whirl_above_its_critical_speed():
    """A massless shaft that is damped inside carries a disk: unstable from there on."""
    k, c, m = 2e4, 15.0, 2.0
    bodies = {
        "hub": RigidBody(1.0, [0.1, 0.1, 0.1]),
        "disk": RigidBody(m, [0.1, 0.06, 0.06]),
    }
    shaft = Spring(
        "shaft",
        "bushing",
        ("hub", "disk"),
        stiffness=[k, k, k, 1e5, 1e5, 1e5],
        damping=[c, c, c, 0, 0, 0],
    )
    joint = Revolute("ground", "hub", X, name="axle")
    settings = {"start": "equilibrium", "steady_rotation": SteadyRotation(X)}
    model = model_of(bodies, (joint,), springs=(shaft,), step=1e-3, **settings)
    critical = np.sqrt(k / m)
    assert not linearize(model, SteadyRotation(0.97 * critical * X)).modes().unstable.any()
    above = linearize(model, SteadyRotation(1.5 * critical * X)).modes()
    # w'' + c/m (w' - i spin w) + k/m w = 0 in space
    expected = np.roots([1.0, c / m, k / m - 1j * c / m * 1.5 * critical])
    growth = expected.real.max()
    assert above.values.real.max() == pytest.approx(growth, rel=1e-8)


def test_a_free_body_that_spins_nutates():
    """Euler: about its axis of symmetry with spin (J_3 - J_1) / J_1."""
    body = RigidBody(2.0, [0.05, 0.03, 0.03])
    model = model_of({"body": body}, step=1e-3)
    found = linearize(model, SteadyRotation(70.0 * X)).modes()
    nutation = 70.0 * (0.05 - 0.03) / 0.03
    assert np.abs(found.values - 1j * nutation).min() < 1e-7 * nutation
    assert not found.unstable.any()


def test_a_free_body_about_its_middle_axis_tumbles():
    J = np.array([0.04, 0.03, 0.06])
    model = model_of({"body": RigidBody(2.0, J)}, step=1e-3)
    found = linearize(model, SteadyRotation(70.0 * X)).modes()
    growth = 70.0 * np.sqrt((J[0] - J[1]) * (J[2] - J[0]) / (J[1] * J[2]))
    assert found.values.real.max() == pytest.approx(growth, rel=1e-8)


def test_a_whirling_pendulum():
    """A point mass on a rod that turns with its hinge: lag omega_0 = spin sqrt(hub / rod)."""
    hub, rod, spin = 0.3, 0.8, 40.0
    tiny = [1e-10] * 3
    bodies = {
        "hub": RigidBody(1.0, [0.1] * 3, {"rim": Frame([hub, 0, 0])}),
        "stone": RigidBody(1.0, tiny, {"p": Frame([-rod, 0, 0])}, Start([hub + rod, 0, 0])),
    }
    axis = [0.0, 0.0, 1.0]
    joints = (
        Revolute("ground", "hub", axis, name="axle"),
        Revolute("hub.rim", "stone.p", axis, name="hinge"),
    )
    held = replace(joints[0], angle=Polynomial((0.0, spin)))
    settings = {"start": "equilibrium", "steady_rotation": SteadyRotation(spin * np.array(axis))}
    model = model_of(bodies, (held, joints[1]), step=1e-3, **settings)
    found = linearize(model).modes()
    np.testing.assert_allclose(found.values, [1j * spin * np.sqrt(hub / rod)], rtol=1e-8)


@pytest.fixture(scope="module")
def column(tmp_path_factory):
    rotation = {"modes": 6, "soft": 4, "loaded": ["root", "tip"]}
    return make_line(tmp_path_factory.mktemp("column"), 1.0, 8, rotation=rotation)


def test_a_column_loses_its_frequency_towards_the_load_of_euler(column):
    """Pinned at both ends: f^2 = f_0^2 (1 - P / P_E)."""
    euler = np.pi**2 * 30.0
    hinge = Revolute("ground", "beam.root", [0, 0, 1], name="root")

    def frequency(share):
        load = Force("beam.tip", [-share * euler, 0, 0], Constant(1.0))
        start = Start(-column.interface("root").X)
        model = model_of(
            {"beam": FlexibleBody(column, start)},
            (hinge,),
            loads=(load,),
            motions=(_hold("y", [0, 1, 0]), _hold("z", [0, 0, 1])),
            step=1e-3,
            start="equilibrium",
        )
        return linearize(model).modes(1).frequencies[0]

    squares = np.array([frequency(share) for share in (0.0, 0.3, 0.6, 0.9)]) ** 2
    np.testing.assert_allclose(squares[1:] / squares[0], [0.7, 0.4, 0.1], atol=3e-3)


def _hold(name, direction):
    """Keeps the tip from moving across."""
    return PrescribedDisplacement(name, "beam.tip", direction, Constant(0.0))


def test_the_equations_with_second_order_are_those_of_a_lagrangian(column, with_second_order):
    """M and K symmetric, C skew, in steady rotation, with loads and any terms of second order."""
    element = with_second_order(column)
    hinge = Fixed("hub", "beam.root", name="root")
    bodies = {
        "hub": RigidBody(1.0, [0.1] * 3),
        "beam": FlexibleBody(element, Start(-element.interface("root").X)),
    }
    axle = Revolute("ground", "hub", [0, 0, 1], name="axle")
    force = Force("beam.tip", [5.0, 1.0, 2.0], Constant(1.0), follower=False)
    model = model_of(bodies, (axle, hinge), step=1e-3)
    for spin, loads in ((0.0, (force,)), (25.0, ())):
        rotation = SteadyRotation([0, 0, spin]) if spin else None
        joints = (axle if spin else Fixed("ground", "hub", name="axle"), hinge)
        settings = replace(model.settings, start="equilibrium")
        linear = linearize(replace(model, joints=joints, loads=loads, settings=settings), rotation)
        form = FirstOrder(linear.equations)
        K, C, M = reduced(form)
        assert np.abs(M - M.T).max() < 1e-9 * np.abs(M).max()
        assert np.abs(C + C.T).max() < 1e-9 * max(np.abs(C).max(), 1.0)
        assert np.abs(K - K.T).max() < 1e-8 * np.abs(K).max()


def reduced(form):
    """K, C, M on the coordinates that constraints leave free, without the modes' own stiffness."""
    t, E = form.equations.tangent, form.embed
    found = []
    for matrix in (t.K, t.C, t.M):
        rigid = matrix[t.sizes.rigid] @ E
        elastic = -form.phi.T @ matrix[t.sizes.active] @ E
        found.append(form.basis.T @ np.vstack([rigid, elastic]) @ form.basis)
    found[2] = found[2] + form.basis[t.sizes.n_r :].T @ form.basis[t.sizes.n_r :]
    return found


def test_lines_of_a_campbell_diagram_are_in_space():
    spins = np.linspace(0.0, 300.0, 7)
    diagram = campbell(rotor(), spins, modes=6)
    forward, backward = (
        sorted((line for line in diagram.lines if line.whirl == whirl), key=_first)
        for whirl in ("forward", "backward")
    )
    expected = np.array([np.sort(np.abs(whirls(spin))) for spin in spins]) / (2.0 * np.pi)
    found = np.array([line.frequencies for line in (*forward, *backward)]).T
    np.testing.assert_allclose(np.sort(found, axis=1), expected, rtol=1e-6)


def _first(line):
    return line.frequencies[0]


def test_critical_speeds_are_where_the_first_order_meets_a_line():
    diagram = campbell(rotor(), np.linspace(0.0, 300.0, 13), modes=6)
    crossings = [(diagram.lines[found.line].whirl, found.spin) for found in diagram.crossings(1.0)]
    bounce = np.sqrt(STIFFNESS / MASS)
    # a forward tilt at the speed of the spin would need J_d > J_p
    tilt = np.sqrt(TILTING / (DIAMETRAL + POLAR))
    expected = {("forward", bounce), ("backward", bounce), ("backward", tilt), ("none", bounce)}
    assert {whirl for whirl, _ in crossings} == {whirl for whirl, _ in expected}
    for whirl, spin in expected:
        assert min(abs(s / spin - 1.0) for w, s in crossings if w == whirl) < 1e-4


def test_torsion_is_no_whirl():
    """Two disks on bearings that a torsion spring joins: its frequency is the same at every spin.

    They twist against each other at sqrt(k (1 / J_a + 1 / J_b)), while both whirl by the formula.
    """
    twisted = 40.0
    one = rotor()
    bodies = {"disk": one.bodies["disk"], "other": one.bodies["disk"]}
    bearings = [
        replace(spring, name=f"{name}-{spring.name}", between=(spring.between[0], end))
        for name in bodies
        for spring in one.springs
        for end in [f"{name}.{spring.name}"]
    ]
    twist = Spring("twist", "torsion", ("disk", "other"), X, stiffness=twisted)
    model = replace(one, bodies=bodies, springs=(*bearings, twist))
    spins = np.array([0.0, 20.0, 150.0])
    diagram = campbell(model, spins, modes=11)
    lines = {whirl: [x for x in diagram.lines if x.whirl == whirl] for whirl in WHIRLS}
    assert [len(lines[whirl]) for whirl in WHIRLS] == [4, 4, 1 + 2]  # two move along the axis
    axial = np.sqrt(STIFFNESS / MASS)
    none = np.sort([np.sqrt(2.0 * twisted / POLAR), axial, axial]) / (2.0 * np.pi)
    for n, spin in enumerate(spins):
        found = np.sort([line.frequencies[n] for line in lines["none"]])
        np.testing.assert_allclose(found, none, rtol=1e-6)
        for whirl, sign in (("forward", 1.0), ("backward", -1.0)):
            omega = np.repeat(np.sort(sign * whirls(spin)[sign * whirls(spin) > 0.0]), 2)
            found = [line.frequencies[n] for line in lines[whirl]]
            np.testing.assert_allclose(np.sort(found), omega / (2.0 * np.pi), rtol=1e-6)


WHIRLS = "forward", "backward", "none"
ROSS = {
    0.0: {"both": [43.1145, 84.2932, 276.7222], "none": [185.5806]},
    500.0: {
        "backward": [42.1491, 82.8669, 247.2860],
        "forward": [44.0296, 85.7456, 304.9027],
        "none": [185.5806],
    },
    1000.0: {
        "backward": [41.1371, 81.4771, 219.0581],
        "forward": [44.8924, 87.2131, 329.4017],
        "none": [185.5806],
    },
}
"""frequencies [Hz] by spin [rad/s]"""
CRITICAL = [
    ("backward", 267.687),
    ("forward", 274.089),
    ("backward", 520.308),
    ("forward", 539.481),
    ("none", 1166.037),
    ("backward", 1283.309),
]
"""Where lines meet the spin [rad/s]. Both by ROSS 2.3.0 (ross-rotordynamics; Timbo et al., Journal
of Open Source Software 5 (2020) 2120), `Rotor.run_modal` and `Rotor.run_critical_speed`, of the
model in `two_disks`: 24 elements without shear, torsion and motion along the axis included."""


@pytest.fixture(scope="module")
def two_disks(tmp_path_factory):
    """A steel shaft of 1.2 m and 40 mm, a disk between its bearings and one that overhangs."""
    length, d, E, rho = 1.2, 0.04, 2.1e11, 7850.0
    A, I_A = np.pi * d**2 / 4.0, np.pi * d**4 / 64.0
    disks = {"mid": (12.0, [0.11, 0.06, 0.06]), "end": (4.0, [0.022, 0.012, 0.012])}
    places = {"left": 0.0, "mid": 0.4, "right": 0.9, "end": 1.2}
    shaft = make_line(
        tmp_path_factory.mktemp("shaft"),
        length,
        24,
        section={
            "EA": E * A,
            "EI_y": E * I_A,
            "EI_z": E * I_A,
            "GJ": E / 2.6 * 2.0 * I_A,
            "mass_per_length": rho * A,
            "rotary_inertia_y": rho * I_A,
            "rotary_inertia_z": rho * I_A,
            "polar_inertia_per_length": 2.0 * rho * I_A,
        },
        interfaces={name: {"node": [x, 0, 0]} for name, x in places.items()},
        masses={n: {"interface": n, "mass": m, "inertia": J} for n, (m, J) in disks.items()},
        rotation={"modes": 12, "soft": 8},
    )
    bearings = tuple(
        Spring(
            name, "bushing", (f"ground.{name}", f"shaft.{name}"), stiffness=[0, 2e7, 2e7, 0, 0, 0]
        )
        for name in ("left", "right")
    )
    return model_of(
        {"shaft": FlexibleBody(shaft, Start(-shaft.interface("left").X))},
        springs=bearings,
        ground_frames={name: Frame([places[name], 0, 0]) for name in ("left", "right")},
        step=1e-5,
        start="equilibrium",
        steady_rotation=SteadyRotation(X),
    )


def test_whirl_and_torsion_are_those_of_a_rotor_dynamics_code(two_disks):
    diagram = campbell(two_disks, list(ROSS), modes=7)
    for n, expected in enumerate(ROSS.values()):
        for whirl in WHIRLS:
            lines = [line.frequencies[n] for line in diagram.lines if line.whirl == whirl]
            values = expected.get(whirl, expected.get("both"))
            np.testing.assert_allclose(lines, values, rtol=2e-4, err_msg=f"{whirl} {n}")


def test_critical_speeds_are_those_of_a_rotor_dynamics_code(two_disks):
    diagram = campbell(two_disks, np.linspace(0.0, 1300.0, 14), modes=7)
    found = [(diagram.lines[c.line].whirl, c.spin) for c in diagram.crossings(1.0)]
    assert [whirl for whirl, _ in found] == [whirl for whirl, _ in CRITICAL]
    speeds = [spin for _, spin in found]
    np.testing.assert_allclose(speeds, [spin for _, spin in CRITICAL], rtol=3e-4)


@pytest.mark.parametrize("turned_by", ["angle", "angular_velocity", "motion", "servo"])
def test_a_drive_that_turns_a_shaft_follows_the_spin(turned_by):
    """Whatever its speed in the model, and held by it the shaft whirls as without."""
    free = rotor(t_end=1.0)
    hub = RigidBody(1.0, [0.1] * 3)
    axle = Revolute("ground", "hub", X, name="axle")
    shaft = Spring("shaft", "torsion", ("hub", "disk"), X, stiffness=30.0)
    changes = {}
    if turned_by == "motion":
        turn = PrescribedRotation("turn", "hub", X, Polynomial((0.0, 500.0)))
        changes["motions"] = (turn,)
    elif turned_by == "servo":
        servo = Motor("servo", "axle", "angle", damping=1e6, reference_rate=Constant(500.0))
        changes["motors"] = (servo,)
    else:
        signal = {"angle": Polynomial((0.0, 500.0)), "angular_velocity": Constant(500.0)}
        axle = replace(axle, **{turned_by: signal[turned_by]})
    ball = Spherical("ground", "hub", name="ball")
    joints = (ball if turned_by == "motion" else axle,)
    bodies = {**free.bodies, "hub": hub}
    springs = (*free.springs, shaft)
    model = replace(free, bodies=bodies, joints=joints, springs=springs, **changes)
    diagram = campbell(model, [0.0, 70.0, 150.0], modes=6)
    for n, spin in enumerate(diagram.spins):
        found = [line.frequencies[n] for line in diagram.lines if line.whirl != "none"]
        expected = np.sort(np.abs(whirls(spin))) / (2.0 * np.pi)
        np.testing.assert_allclose(np.sort(found)[: len(expected)], expected, rtol=1e-6)
        none = [line.frequencies[n] for line in diagram.lines if line.whirl == "none"]
        assert np.abs(np.array(none) - np.sqrt(30.0 / POLAR) / (2.0 * np.pi)).min() < 1e-3


def test_a_drive_that_holds_a_shaft_refuses_the_spin():
    held = Revolute("ground", "disk", X, name="axle", angle=Constant(0.0))
    with pytest.raises(ModelError, match=r"joint 'axle': start = 'equilibrium': a steady rotation"):
        campbell(model_of(rotor().bodies, (held,), **STEADY), [10.0, 70.0])


STEADY = {"step": 1e-3, "start": "equilibrium", "steady_rotation": SteadyRotation(X)}


def test_a_rotation_whose_equations_are_not_constant_is_refused():
    message = r"steady rotation of \[50.0, 0.0, 0.0\] rad/s: "
    spinning = SteadyRotation(50.0 * X)
    with pytest.raises(ModelError, match=message + "its stiffness, damping or constraints change"):
        linearize(rotor(uneven=2.0), spinning)
    with pytest.raises(ModelError, match=r"a steady rotation of .* deforms it"):
        linearize(rotor(gravity=[0, 0, -9.81]), spinning)
    axle = Revolute("ground", "disk", X, name="axle")
    heavy = RigidBody(MASS, [POLAR, DIAMETRAL, DIAMETRAL])
    model = model_of({"disk": heavy}, (axle,), gravity=[0, 0, -9.81], step=1e-3)
    linearize(model, spinning)  # the joint carries the weight
    linearize(rotor(gravity=[-9.81, 0, 0]), spinning)


@pytest.mark.parametrize("turned", [0.25 * np.pi, -0.25 * np.pi])
def test_lines_of_unequal_planes_begin_at_rest_where_they_go_on(turned):
    """Springs that turn with the hub: the softer plane is forward, the stiffer one backward.

    At rest a dashpot across both planes alone decides which way the disk moves round, by little.
    """
    bodies = {
        "hub": RigidBody(1.0, [0.01] * 3, {"seat": Frame(), "oblique": Frame([0] * 3, turned * X)}),
        "disk": RigidBody(MASS, [POLAR, DIAMETRAL, DIAMETRAL], {"center": Frame()}),
    }
    ends = [("hub.seat", "disk.center"), ("hub.oblique", "disk.center")]
    shaft = Spring("shaft", "bushing", ends[0], stiffness=[1e7, 5e4, 8e4, 1e6, 1e6, 1e6])
    oblique = {"stiffness": [1e-9] * 6, "damping": [0.0, 1e-3, 0.0, 0.0, 0.0, 0.0]}
    dashpot = Spring("dashpot", "bushing", ends[1], **oblique)
    model = model_of(
        bodies,
        (Revolute("ground", "hub.seat", X, name="bearing"),),
        springs=(shaft, dashpot),
        start="equilibrium",
        steady_rotation=SteadyRotation(X),
        step=1e-3,
    )
    spins = np.array([0.0, 10.0, 20.0, 30.0])
    soft, stiff = np.array([5e4, 8e4]) / MASS
    squares = [
        np.roots([1.0, -(soft + stiff + 2.0 * w**2), (soft - w**2) * (stiff - w**2)]) for w in spins
    ]
    slow, fast = np.sqrt(np.sort(squares, axis=1)).T
    diagram = campbell(model, spins, modes=2)
    assert [line.whirl for line in diagram.lines] == ["forward", "backward"]
    expected = np.array([slow + spins, fast - spins]) / (2.0 * np.pi)
    found = [line.frequencies for line in diagram.lines]
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_a_campbell_diagram_needs_an_axis():
    model = rotor(start="given", steady_rotation=None)
    with pytest.raises(ModelError, match="simulation: a Campbell diagram needs the axis"):
        campbell(model, [0.0, 10.0])
    with pytest.raises(ModelError, match="spins: expected numbers >= 0 that increase"):
        campbell(rotor(), [10.0, 5.0])
