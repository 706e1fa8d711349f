"""Bearings on supports that move, and shafts at several speeds, beside closed forms, ROSS and runs.

The references of ROSS are those of ross-rotordynamics 2.3.0: the rotor of test_rotors.py whose
bearings are linked (`n_link`) to point masses on bearings of their own.
"""

from dataclasses import replace

import duhamel as du
import numpy as np
import pytest
from duhamel.solver import (
    Bearing,
    Contact,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    HalfSine,
    Impact,
    Model,
    ModelError,
    RigidBody,
    Settings,
    Spring,
    Start,
    SteadyRotation,
    campbell,
    floquet,
    linearize,
    read_model,
    rotor_at,
    simulate,
    stability_map,
    unbalance_response,
    write_model,
)
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from .two_disks import steel_shaft, two_disks

MASS, DIAMETRAL, POLAR = 10.0, 0.1, 0.2
K, C = np.array([[1e5, 2e4], [-2e4, 2e5]]), np.array([[60.0, 5.0], [0.0, 90.0]])
LEFT, RIGHT = -0.2, 0.3
BLOCK, MOUNT, MOUNT_DAMPING = 4.0, np.array([3e5, 1e6]), np.array([20.0, 10.0])
SPEED = 4000.0 * np.pi / 30.0
PEDESTALS = {
    "left": (12.0, [5e6, 3e6], [200.0, 150.0]),
    "right": (20.0, [4e6, 2e6], [100.0, 300.0]),
}
ROSS = {
    "unequal, damped": (
        *([1e6, 8e5], 100.0),
        [-0.189444 + 76.509641j, -0.136876 + 82.922049j, -2.085104 + 207.63252j,
         -2.054357 + 260.704906j, -7.444124 + 357.285855j, -2.950842 + 464.480401j],
    ),
    "cross-coupled": (
        *([[1e6, 5e5], [-5e5, 1e6]], 2e3),
        [4.300869 + 83.399943j, -7.091593 + 83.963833j, -32.548842 + 245.882371j,
         -10.047433 + 259.057756j, -25.104861 + 371.857832j, -11.312967 + 468.819531j],
    ),
}  # fmt: skip
"""stiffness and damping of the bearings, and eigenvalues at 4000 turns per minute"""
LOG_DECREMENTS = [0.01555767, 0.0103714, 0.0630975, 0.04951155]
"""of the first modes of the first case, `log_dec` of ROSS"""
ORBITS = {
    90.0: {
        "shaft.left": [-2.31041651e-05 - 4.09825854e-07j, -2.52109627e-07 + 1.24563403e-05j],
        "two": [-6.56462675e-05 - 1.29165255e-06j, -5.91659343e-07 + 3.70418256e-05j],
        "pedestal left": [-3.91387460e-06 - 8.67535281e-08j, -6.83932733e-08 + 2.69102899e-06j],
        "pedestal right": [-6.77716686e-06 - 1.32250112e-07j, -3.66519637e-08 + 7.31021156e-06j],
    },
    300.0: {
        "shaft.left": [-8.27093469e-05 - 3.16049772e-06j, -3.73602552e-06 + 5.66881025e-05j],
        "two": [1.84168717e-05 + 1.61775002e-06j, 1.49250245e-06 - 4.63865832e-06j],
        "pedestal left": [-1.68069238e-05 - 8.39259142e-07j, -1.26450959e-06 + 1.66666320e-05j],
        "pedestal right": [2.08129911e-05 + 1.32974835e-06j, -1.52524399e-06 - 3.81692155e-05j],
    },
}
"""of 1 g m at the first disk, by spin: y and z"""


def on_pedestals(turn=None, at=(0.0, 0.0, 0.0), inertia=(DIAMETRAL, DIAMETRAL, POLAR), **bearing):
    """A disk in two bearings on blocks that are unlike all round; turn, at: of all in space."""
    R, at = Rotation.from_rotvec([0.0, 0.0, 0.0] if turn is None else turn), np.array(at)
    ends = {"left": [0.0, 0.0, LEFT], "right": [0.0, 0.0, RIGHT]}
    axes = {"axis": R.apply([0.0, 0.0, 1.0]), "second_axis": R.apply([1.0, 0.0, 0.0])}
    frames = {name: Frame(x) for name, x in ends.items()}
    bodies = {"disk": RigidBody(MASS, inertia, frames, start=Start(at, R.as_rotvec()))}
    films, mounts = [], []
    for name, x in ends.items():
        start = Start(at + R.apply(x), R.as_rotvec())
        bodies[f"block {name}"] = RigidBody(BLOCK, [0.1, 0.2, 0.3], start=start)
        films.append(Bearing(name, [f"block {name}", f"disk.{name}"],
                             **({"stiffness": K, "damping": C} | axes | bearing)))  # fmt: skip
        stiffness, damping = [*MOUNT, *[1e6] * 4], [*MOUNT_DAMPING, *[0.0] * 4]
        mounts.append(Spring(f"mount {name}", "bushing", [f"ground.{name}", f"block {name}"],
                             stiffness=stiffness, damping=damping, **axes))  # fmt: skip
    ground = {name: Frame(at + R.apply(x), R.as_rotvec()) for name, x in ends.items()}
    return Model(bodies, bearings=films, springs=mounts, ground_frames=ground)


def equations(spin):
    """M, C + G and K in x = (y, z, rotations about both; y, z of both blocks)."""
    stiffness, damping = np.zeros((2, 8, 8))
    for k, place in enumerate((LEFT, RIGHT)):
        B = np.zeros((2, 8))
        B[:, :4] = [[1.0, 0.0, 0.0, place], [0.0, 1.0, -place, 0.0]]
        own = slice(4 + 2 * k, 6 + 2 * k)
        B[:, own] = -np.eye(2)
        stiffness += B.T @ K @ B
        damping += B.T @ C @ B
        stiffness[own, own] += np.diag(MOUNT)
        damping[own, own] += np.diag(MOUNT_DAMPING)
    damping[2, 3] += POLAR * spin
    damping[3, 2] -= POLAR * spin
    return np.diag([MASS, MASS, DIAMETRAL, DIAMETRAL, *[BLOCK] * 4]), damping, stiffness


def eigenvalues(M, D, S):
    n, inverse = len(M), np.linalg.inv(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ S, -inverse @ D]])
    values = np.linalg.eigvals(A)
    return values[values.imag > 0.0]


def assert_among(values, expected, rtol):
    for value in expected:
        assert np.abs(values - value).min() < rtol * abs(value), value


@pytest.mark.parametrize(
    ("turn", "at"),
    [
        (None, [0.0, 0.0, 0.0]),
        ([0.3, -1.0, 0.7], [0.0, 0.0, 0.0]),
        ([-0.5 * np.pi, 0.0, 0.0], [1e3, 0.0, -400.0]),  # about y, a kilometer away
    ],
)
@pytest.mark.parametrize("spin", [1e-3, 300.0])
def test_modes_of_a_rigid_rotor_on_unequal_pedestals(spin, turn, at):
    values = rotor_at(on_pedestals(turn, at), spin).modes().values
    assert_among(values, eigenvalues(*equations(spin)), 1e-7)


def test_unbalance_of_a_rigid_rotor_on_pedestals_in_closed_form():
    u, spins = 1e-3 * np.exp(0.4j), [60.0, 141.0, 400.0]
    response = unbalance_response(on_pedestals([0.3, -1.0, 0.7]), {"disk.right": u}, spins)
    for spin, moved in zip(spins, response.motion, strict=True):
        M, D, S = equations(spin)
        force = u * spin**2 * np.array([1.0, -1j, RIGHT * 1j, RIGHT, 0.0, 0.0, 0.0, 0.0])
        x = np.linalg.solve(S + 1j * spin * D - spin**2 * M, force)
        for name, k in {"disk": 0, "block left": 4, "block right": 6}.items():
            expected = x[k : k + 2]
            error = np.abs(moved[response.names.index(name)] - expected).max()
            assert error < 1e-7 * np.abs(expected).max()


def test_multipliers_of_a_rotor_that_is_alike_all_round_are_those_of_its_modes():
    spin = 300.0
    modes, found = rotor_at(on_pedestals(), spin).modes(), floquet(on_pedestals(), spin)
    for rate in modes.values[modes.rigid :].real:
        assert np.abs(found.growth - rate).min() < 1e-6


def over_a_turn(inertia, spin):
    """Multipliers by integration, the tilt of the disk in body axes, that of blocks none."""
    J1, J2, J3 = inertia

    def rate(t, x):
        x = x.reshape(16, 16)
        place, tilt, blocks = x[:2], x[2:4], x[4:8]
        velocity, turning, speeds = x[8:10], x[10:12], x[12:]
        c, s = np.cos(spin * t), np.sin(spin * t)
        R = np.array([[c, -s], [s, c]])
        carried = turning + spin * np.array([-tilt[1], tilt[0]])
        push, moment, blown = np.zeros((2, 16)), np.zeros((2, 16)), np.zeros((4, 16))
        for k, z in enumerate((LEFT, RIGHT)):
            lever, own = z * np.array([[0.0, 1.0], [-1.0, 0.0]]), slice(2 * k, 2 * k + 2)
            force = -K @ (place + lever @ R @ tilt - blocks[own])
            force -= C @ (velocity + lever @ R @ carried - speeds[own])
            push += force
            moment += (lever @ R).T @ force
            held = MOUNT[:, None] * blocks[own] + MOUNT_DAMPING[:, None] * speeds[own]
            blown[own] = -force - held
        cross, by = spin * (J1 + J2 - J3), spin**2
        turn = np.array([
            (moment[0] + cross * turning[1] - by * (J3 - J2) * tilt[0]) / J1,
            (moment[1] - cross * turning[0] - by * (J3 - J1) * tilt[1]) / J2,
        ])  # fmt: skip
        return np.vstack([velocity, turning, speeds, push / MASS, turn, blown / BLOCK]).ravel()

    end = solve_ivp(rate, (0.0, 2.0 * np.pi / spin), np.eye(16).ravel(), "DOP853",
                    rtol=1e-9, atol=1e-11)  # fmt: skip
    return np.linalg.eigvals(end.y[:, -1].reshape(16, 16))


def test_floquet_multipliers_where_both_sides_are_unlike_all_round():
    inertia, spin = (0.1, 0.19, 0.2), 150.0
    model = on_pedestals(inertia=inertia)
    with pytest.raises(ModelError, match="it is not alike all round the axis"):
        rotor_at(model, spin)
    expected, found = over_a_turn(inertia, spin), floquet(model, spin).multipliers
    for value in expected:
        assert np.abs(found - value).min() < 1e-6 * np.abs(expected).max()


def test_pedestals_shake_but_do_not_whirl():
    """Without cross coupling and damping: modes of blocks alone, in y and z, have no whirl."""
    model = on_pedestals(stiffness=[1e2, 2e2], damping=0.0)
    lines = campbell(model, [0.0, 100.0, 200.0], 12).lines
    at_mounts = np.sqrt(MOUNT / BLOCK) / (2.0 * np.pi)
    for frequency in at_mounts:
        near = [line for line in lines if abs(line.frequencies[1] / frequency - 1.0) < 5e-3]
        assert len(near) >= 2  # of both blocks
        assert {line.whirl for line in near} == {"none"}
    assert {"forward", "backward"} < {line.whirl for line in lines}


@pytest.fixture(scope="module")
def shaft():
    return steel_shaft()


@pytest.mark.parametrize("case", ROSS)
def test_modes_on_pedestals_are_those_of_ross(shaft, case):
    stiffness, damping, expected = ROSS[case]
    model = two_disks(shaft, stiffness, damping, PEDESTALS).model()
    values = rotor_at(model, SPEED).modes(16).values
    assert_among(values, expected[:4], 4e-7)
    assert_among(values, expected[4:], 2e-6)
    if case == "unequal, damped":
        for value, expected_log in zip(expected, LOG_DECREMENTS, strict=False):
            found = values[np.abs(values - value).argmin()]
            assert -2.0 * np.pi * found.real / found.imag == pytest.approx(expected_log, rel=2e-6)


def test_unbalance_on_pedestals_is_that_of_ross(shaft):
    m = two_disks(shaft, [1e6, 8e5], 100.0, PEDESTALS)
    response = m.unbalance({"shaft.one": 1e-3}, list(ORBITS))
    for moved, expected in zip(response.motion, ORBITS.values(), strict=True):
        for name, orbit in expected.items():
            error = np.abs(moved[response.names.index(name)] - orbit).max()
            assert error < 1e-6 * np.abs(orbit).max()


def test_a_ring_down_on_pedestals_has_the_frequencies_and_the_decay_of_the_modes(shaft):
    """From a steady rotation in which the pedestals stand; fitted by ESPRIT."""
    m = two_disks(shaft, [1e6, 8e5], 2e3, PEDESTALS)
    m.add(du.loads.Force(m["shaft"]["one"], "z", du.signals.HalfSine(2000.0, 2e-3, start=1e-3)))
    rotation = SteadyRotation([SPEED, 0.0, 0.0])
    run = m.simulate(0.4, step=1e-4, rho_inf=0.95, start="equilibrium", steady_rotation=rotation)
    assert np.abs(run["pedestal left"].angular_velocity).max() < 1e-6 * SPEED
    points = ("shaft.left", "shaft.one", "shaft.two", "pedestal left", "pedestal right")
    y = np.hstack([run[name].position[60::10, 1:] for name in points])
    blocks = np.array([y[k : k + 20].ravel() for k in range(len(y) - 20)]).T
    space = np.linalg.svd(blocks, full_matrices=False)[0][:, :24]
    shift = np.linalg.lstsq(space[: -y.shape[1]], space[y.shape[1] :], rcond=None)[0]
    fitted = np.log(np.linalg.eigvals(shift)) / 1e-3
    model = two_disks(shaft, [1e6, 8e5], 2e3, PEDESTALS).model()
    modes = rotor_at(model, SPEED).modes(16)
    # 223 and 289 rad/s are the pedestals along the shaft, which the push leaves at rest.
    slowest = [v for v in modes.values if v.imag > 0.0 and min(abs(v - s) for s in
               (np.sqrt(1e6 / 12.0) * 1j, np.sqrt(1e6 / 20.0) * 1j)) > 1e-3][:4]  # fmt: skip
    assert_among(fitted, slowest, 1e-3)


@pytest.fixture(scope="module")
def frame():
    """A beam of unequal section along y."""
    section = du.Section(EA=1.6e8, EI_y=6e3, EI_z=2e4, GJ=8e3, mass_per_length=6.0,
                         polar_inertia_per_length=1e-3, orientation=[1.0, 0.0, 0.0])  # fmt: skip
    part = du.Beam([[0.0, y, 0.0] for y in np.linspace(-0.3, 0.0, 7)], section=section)
    part.interface("foot", [0.0, -0.3, 0.0])
    part.interface("seat", [0.0, 0.0, 0.0])
    return part.superelement(step=1e-5)


def test_a_flexible_pedestal_bends_as_it_does_at_rest(frame):
    """A disk in one bearing at its center has the same modes at all spins; none whirl."""
    disk = RigidBody(50.0, [0.1, 0.1, 0.2])
    pedestal = FlexibleBody(frame, Start(-frame.interface("seat").X))
    film = Bearing("film", ["pedestal.seat", "disk"], [0.0, 0.0, 1.0], 1e6)
    foot = Frame([0.0, -0.3, 0.0])
    model = Model({"disk": disk, "pedestal": pedestal}, bearings=[film],
                  joints=[Fixed("ground.foot", "pedestal.foot")], ground_frames={"foot": foot},
                  settings=Settings(t_end=1.0, step=1e-5))  # fmt: skip
    still = linearize(model).modes(8).frequencies
    spinning = rotor_at(model, 100.0).modes(8)
    found = spinning.frequencies[spinning.frequencies > 0.0]
    for frequency in still[still > 0.0][:2]:
        assert np.abs(found - frequency).min() < 1e-6 * frequency
    # The bending of the pedestal makes it softer than 1e6 N/m alone.
    assert still[still > 0.0][0] < 0.9 * np.sqrt(1e6 / 50.0) / (2.0 * np.pi)


def squeezed(ratios):
    """ground - damper - carrier - bearing - disk; the carrier is the shaft of the damper."""
    ends = {"hub": Frame([0.0, 0.0, 0.0])}
    damper = Bearing("damper", ["ground.hub", "carrier"], [0.0, 0.0, 1.0], [2e5, 3e5], 400.0)
    ball = Bearing("ball", ["carrier", "disk"], [0.0, 0.0, 1.0], [4e6, 5e6], 10.0)
    bodies = {
        "carrier": RigidBody(1.5, [0.01, 0.02, 0.03]),
        "disk": RigidBody(MASS, [DIAMETRAL, DIAMETRAL, POLAR]),
    }
    rotation = SteadyRotation([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], ratios)
    settings = Settings(t_end=1.0, step=1e-3, start="equilibrium", steady_rotation=rotation)
    return Model(bodies, bearings=[damper, ball], ground_frames=ends, settings=settings)


def test_a_carrier_between_a_damper_and_a_bearing_stands_where_it_is_told_to():
    with pytest.raises(ModelError, match=r"'carrier': support of bearing 'ball' and shaft of "
                       r"bearing 'damper': expected its speed .* in speed_ratios"):  # fmt: skip
        rotor_at(squeezed({}), 200.0)
    values = rotor_at(squeezed({"carrier": 0.0}), 200.0).modes().values
    M = np.diag([1.5, MASS])
    for outer, inner in ((2e5, 4e6), (3e5, 5e6)):
        S = np.array([[outer + inner, -inner], [-inner, inner]])
        D = np.array([[400.0 + 10.0, -10.0], [-10.0, 10.0]])
        assert_among(values, eigenvalues(M, D, S), 1e-7)


INNER, OUTER, RATIO, CROSS = (10.0, 0.1, 0.2), (6.0, 0.2, 0.25), -1.3, 3e4


def two_shafts(ratio=RATIO, between=((1e5, CROSS), (-CROSS, 1e5))):
    """Coaxial disks, one in a bearing to the ground at both ends, the other in it and to it."""
    frames = {"a": Frame([0.0, 0.0, LEFT]), "b": Frame([0.0, 0.0, RIGHT])}
    inner, outer = (RigidBody(m, [d, d, polar], frames) for m, d, polar in (INNER, OUTER))
    axis = [0.0, 0.0, 1.0]
    films = [
        Bearing("inner", ["ground.a", "inner.a"], axis, [3e5, 4e5], 50.0),
        Bearing("outer", ["ground.a", "outer.a"], axis, [5e5, 2e5], 30.0),
        Bearing("far", ["ground.b", "outer.b"], axis, [2e5, 2e5], 20.0),
        Bearing("between", ["outer.b", "inner.b"], axis, between, 25.0),
    ]
    rotation = SteadyRotation(axis, speed_ratios={"inner": 1.0, "outer": ratio})
    settings = Settings(t_end=1.0, step=1e-3, start="equilibrium", steady_rotation=rotation)
    return Model({"inner": inner, "outer": outer}, bearings=films, ground_frames=frames,
                 settings=settings)  # fmt: skip


def equations_of_two_shafts(spin):
    S, D, G = np.zeros((3, 8, 8))
    a, b = (np.array([[1.0, 0.0, 0.0, z], [0.0, 1.0, -z, 0.0]]) for z in (LEFT, RIGHT))
    none = np.zeros((2, 4))
    for B, k, c in (
        (np.hstack([a, none]), np.diag([3e5, 4e5]), 50.0),
        (np.hstack([none, a]), np.diag([5e5, 2e5]), 30.0),
        (np.hstack([none, b]), 2e5 * np.eye(2), 20.0),
        (np.hstack([b, -b]), np.array([[1e5, CROSS], [-CROSS, 1e5]]), 25.0),
    ):
        S += B.T @ k @ B
        D += c * B.T @ B
    for k, polar in ((2, INNER[2]), (6, RATIO * OUTER[2])):
        G[k, k + 1], G[k + 1, k] = polar * spin, -polar * spin
    # What damps between shafts that turn resists motion in axes of the outer one, which turns.
    turning = RATIO * spin * np.array([[0.0, -1.0], [1.0, 0.0]])
    B = np.hstack([b, -b])
    S -= 25.0 * B.T @ turning @ B
    masses = [*[INNER[0]] * 2, *[INNER[1]] * 2, *[OUTER[0]] * 2, *[OUTER[1]] * 2]
    return np.diag(masses), D + G, S


@pytest.mark.parametrize("spin", [30.0, 300.0])
def test_two_shafts_that_turn_against_each_other(spin):
    values = rotor_at(two_shafts(), spin).modes().values
    assert_among(values, eigenvalues(*equations_of_two_shafts(spin)), 1e-7)


def test_unbalance_of_the_shaft_that_turns_the_other_way_round():
    spin, u = 200.0, 1e-3
    response = unbalance_response(two_shafts(), {"outer.b": u}, [spin])
    M, D, S = equations_of_two_shafts(spin)
    s = 1j * RATIO * spin
    force = np.zeros(8, complex)
    force[4:] = -(s**2) * u * np.array([1.0, -1j, RIGHT * 1j, RIGHT])
    expected = np.linalg.solve(S + s * D + s * s * M, force)
    for name, k in {"inner": 0, "outer": 4}.items():
        moved = response.motion[0, response.names.index(name)]
        np.testing.assert_allclose(moved, expected[k : k + 2], rtol=1e-6)


def test_what_shafts_at_two_speeds_refuse():
    with pytest.raises(ModelError, match="it is not alike all round the axis"):
        rotor_at(two_shafts(between=((1e5, 0.0), (0.0, 2e5))), 100.0)
    with pytest.raises(ModelError, match=r"'outer' turns -1\.3 times as fast .* whole numbers"):
        floquet(two_shafts(), 100.0)
    with pytest.raises(ModelError, match=r"outer\.b and inner\.b turn at different speeds"):
        unbalance_response(two_shafts(), {"outer.b": 1.0, "inner.b": 1.0}, [50.0])
    with pytest.raises(ModelError, match="block left: expected a frame of a shaft, which turns"):
        unbalance_response(on_pedestals(), {"block left": 1.0}, [50.0])
    with pytest.raises(ModelError, match="speed_ratios: no body 'hub'; there are: carrier, disk"):
        squeezed({"hub": 0.0})


def test_multipliers_of_shafts_that_turn_against_each_other_alike():
    model, spin = two_shafts(ratio=-1.0), 150.0
    modes, found = rotor_at(model, spin).modes(), floquet(model, spin)
    for rate in modes.values[modes.rigid :].real:
        assert np.abs(found.growth - rate).min() < 1e-6


def test_a_table_between_shafts_is_read_at_the_difference_of_their_speeds():
    """inner - outer: 2.3 times the spin."""
    rows = [[1e5, s, -s, 1e5] for s in (0.0, 4e4)]
    model = two_shafts()
    table = Bearing("between", ["outer.b", "inner.b"], [0.0, 0.0, 1.0], rows,
                    [[25.0, 0.0, 0.0, 25.0]] * 2, speeds=[0.0, 230.0])  # fmt: skip
    model = replace(model, bearings=[*model.bearings[:3], table])
    expected = rotor_at(two_shafts(between=((1e5, 2e4), (-2e4, 1e5))), 50.0).modes().values
    assert_among(rotor_at(model, 50.0).modes().values, expected[expected != 0.0], 1e-9)
    with pytest.raises(ModelError, match=r"234\.6 rad/s is beyond its table, from 0 to 230"):
        rotor_at(model, 102.0)


def test_bodies_that_hang_together_at_several_speeds_all_need_one():
    link = [Spring("link", "torsion", ["inner", "outer"], [0.0, 0.0, 1.0], damping=0.1),
            Spring("coupling", "torsion", ["outer", "third"], [0.0, 0.0, 1.0], 1.0)]  # fmt: skip
    model = two_shafts()
    bodies = {**model.bodies, "third": RigidBody(1.0, [0.1, 0.1, 0.1])}
    with pytest.raises(ModelError, match="'inner', 'outer' hang together with 'third': expected"):
        rotor_at(replace(model, bodies=bodies, springs=link), 100.0)


def test_a_shaft_that_a_spring_holds_to_its_support_does_not_stand_with_it():
    model = on_pedestals()
    thrust = Spring("thrust", "bushing", ["block left", "disk.left"], axis=[0.0, 0.0, 1.0],
                    stiffness=[0.0, 0.0, 1e5, 0.0, 0.0, 0.0])  # fmt: skip
    model = replace(model, springs=[*model.springs, thrust])
    with pytest.raises(ModelError, match="support of bearing 'left' and shaft of bearing 'right'"):
        rotor_at(model, 300.0)
    # At rest nothing turns, and nothing is unclear.
    assert len(linearize(model.with_settings(step=1e-3)).modes())
    for ratios in ({"block left": 0.0}, {"disk": 1.0}, {"block left": 0.0, "disk": 1.0}):
        rotation = SteadyRotation([0.0, 0.0, 1.0], speed_ratios=ratios)
        told = model.with_settings(start="equilibrium", steady_rotation=rotation)
        if len(ratios) == 1:
            with pytest.raises(ModelError, match=r"hang together with .*: expected ratios of all"):
                rotor_at(told, 300.0)
    assert_among(rotor_at(told, 300.0).modes().values, eigenvalues(*equations(300.0)), 1e-7)


def test_a_rotor_of_which_nothing_turns_is_refused():
    with pytest.raises(ModelError, match="rotor: no body turns"):
        rotor_at(squeezed({"carrier": 0.0, "disk": 0.0}), 100.0)


def test_cross_coupling_on_a_soft_pedestal_grows_from_a_lower_threshold():
    """The block shares the motion, and the film works on less of it."""
    film = {"speeds": [0.0, 800.0], "damping": [[120.0, 0.0, 0.0, 120.0]] * 2}
    film["stiffness"] = [[1e5, 50.0 * s, -50.0 * s, 1e5] for s in (0.0, 800.0)]
    spins = [100.0, 300.0, 700.0]
    model = on_pedestals(**film)
    (threshold,) = stability_map(model, spins, 24).thresholds
    for spin, grows in ((0.999 * threshold, False), (1.001 * threshold, True)):
        M, D, S = equations(spin)
        cross = 50.0 * spin * np.array([[0.0, 1.0], [-1.0, 0.0]])
        S, D = S.copy(), D.copy()
        for k, place in enumerate((LEFT, RIGHT)):
            B = np.zeros((2, 8))
            B[:, :4] = [[1.0, 0.0, 0.0, place], [0.0, 1.0, -place, 0.0]]
            B[:, 4 + 2 * k : 6 + 2 * k] = -np.eye(2)
            S += B.T @ (np.diag([1e5, 1e5]) + cross - K) @ B
            D += B.T @ (120.0 * np.eye(2) - C) @ B
        assert (eigenvalues(M, D, S).real.max() > 0.0) == grows


def test_speed_ratios_read_back_as_they_were_written(tmp_path):
    write_model(two_shafts(), tmp_path / "model.toml")
    again = read_model(tmp_path / "model.toml").settings.steady_rotation
    assert again.speed_ratios == {"inner": 1.0, "outer": RATIO}


def test_a_run_starts_with_pedestals_that_stand():
    model = on_pedestals()
    push = Force("disk", [1.0, 0.0, 0.0], HalfSine(500.0, 2e-3, start=1e-3))
    rotation = SteadyRotation([0.0, 0.0, 300.0])
    model = replace(model, loads=[push]).with_settings(
        t_end=0.02, step=1e-4, start="equilibrium", steady_rotation=rotation
    )
    run = simulate(model)
    assert run.body("disk").v[0, 5] == pytest.approx(300.0)
    assert np.abs(run.body("block left").v[0]).max() == 0.0
    assert np.abs(run.body("block left").x[-1] - run.body("block left").x[0]).max() > 0.0


def test_a_casing_on_which_the_shaft_may_rub_stands():
    model = on_pedestals()
    block = replace(model.bodies["block left"], frames={"wall": Frame([-0.06, 0.0, 0.0])})
    model = replace(model, bodies={**model.bodies, "block left": block})
    rub = Contact("rub", ["block left.wall", "disk.left"], "plane", axis=[1.0, 0.0, 0.0],
                  ball=0.05, impact=Impact(stiffness=1e6, restitution=0.8))  # fmt: skip
    values = rotor_at(replace(model, contacts=[rub]), 300.0).modes().values
    np.testing.assert_allclose(values, rotor_at(model, 300.0).modes().values, rtol=1e-9, atol=1e-6)
