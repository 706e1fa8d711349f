"""Rotors on bearings in axes fixed in space, beside closed forms, ROSS and time integration.

The references of ROSS are those of ross-rotordynamics 2.3.0 for the rotor of Friswell et al.
(2010), example 5.9.1: six Timoshenko elements, two disks, bearings at the ends; rad/s and m.
"""

import duhamel as du
import numpy as np
import pytest
from duhamel.solver import (
    Bearing,
    Frame,
    Model,
    ModelError,
    RigidBody,
    Start,
    SteadyRotation,
    campbell,
    floquet,
    rotor_at,
    stability_map,
    unbalance_response,
)
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from .two_disks import steel_shaft, two_disks

MASS, DIAMETRAL, POLAR = 10.0, 0.1, 0.2
K, C = np.array([[1e5, 2e4], [-2e4, 2e5]]), np.array([[60.0, 5.0], [0.0, 90.0]])
LEFT, RIGHT = -0.2, 0.3
SPEED = 4000.0 * np.pi / 30.0
ROSS = {
    "equal": (1e6, 0.0, 1e-3, [86.658114j, 86.658114j, 274.312854j, 274.312854j]),
    "equal, spinning": (1e6, 0.0, SPEED, [85.389467j, 87.795864j, 251.784604j, 294.713331j]),
    "unequal, damped": (
        *([1e6, 8e5], 100.0, SPEED),
        [-0.184318 + 82.326426j, -0.156723 + 86.864284j, -2.527236 + 239.65209j,
         -2.639486 + 287.267342j],
    ),
    "cross-coupled": (
        *([[1e6, 5e5], [-5e5, 1e6]], 2e3, SPEED),
        [5.474998 + 89.201138j, -8.971006 + 89.591011j, -7.557607 + 293.782244j,
         -83.870508 + 286.032493j],
    ),
}  # fmt: skip
"""stiffness, damping, spin, and eigenvalues; at a spin of 0 in ROSS"""


def rigid_rotor(turn=None, inertia=(DIAMETRAL, DIAMETRAL, POLAR), **bearing):
    """A disk between two bearings; turn: of everything in space."""
    R = Rotation.from_rotvec([0.0, 0.0, 0.0] if turn is None else turn)
    ends = {"left": [0.0, 0.0, LEFT], "right": [0.0, 0.0, RIGHT]}
    start = Start(rotation=R.as_rotvec())
    disk = RigidBody(MASS, inertia, {name: Frame(x) for name, x in ends.items()}, start=start)
    axes = {"axis": R.apply([0.0, 0.0, 1.0]), "second_axis": R.apply([1.0, 0.0, 0.0])}
    films = [
        Bearing(name, [f"ground.{name}", f"disk.{name}"],
                **({"stiffness": K, "damping": C} | axes | bearing))
        for name in ends
    ]  # fmt: skip
    ground = {name: Frame(R.apply(x), R.as_rotvec()) for name, x in ends.items()}
    return Model({"disk": disk}, bearings=films, ground_frames=ground)


def equations(spin):
    """M x'' + (C + G) x' + K x = 0 in x = (y, z, rotations about both)."""
    stiffness, damping = np.zeros((2, 4, 4))
    for place in (LEFT, RIGHT):
        B = np.array([[1.0, 0.0, 0.0, place], [0.0, 1.0, -place, 0.0]])
        stiffness += B.T @ K @ B
        damping += B.T @ C @ B
    damping[2, 3] += POLAR * spin
    damping[3, 2] -= POLAR * spin
    return np.diag([MASS, MASS, DIAMETRAL, DIAMETRAL]), damping, stiffness


def eigenvalues(spin):
    M, D, S = equations(spin)
    inverse = np.linalg.inv(M)
    A = np.block([[np.zeros((4, 4)), np.eye(4)], [-inverse @ S, -inverse @ D]])
    values = np.linalg.eigvals(A)
    values = values[values.imag > 0.0]
    return values[np.argsort(np.abs(values))]


@pytest.mark.parametrize("turn", [None, [0.3, -1.0, 0.7]])
@pytest.mark.parametrize("spin", [1e-3, 300.0])
def test_modes_of_a_rigid_rotor_on_unequal_bearings(spin, turn):
    modes = rotor_at(rigid_rotor(turn), spin).modes()
    np.testing.assert_allclose(modes.values[modes.rigid :], eigenvalues(spin), rtol=1e-7)


def test_unbalance_of_a_rigid_rotor_in_closed_form():
    """An unbalance at the end, so that it moves and tilts the disk."""
    spins, u = [60.0, 141.0, 400.0], 1e-3 * np.exp(0.4j)
    response = unbalance_response(rigid_rotor([0.3, -1.0, 0.7]), {"disk.right": u}, spins)
    expected = []
    for spin in spins:
        M, D, S = equations(spin)
        force = u * spin**2 * np.array([1.0, -1j, RIGHT * 1j, RIGHT])
        expected.append(np.linalg.solve(S + 1j * spin * D - spin**2 * M, force)[:2])
    moved = response.motion[:, response.names.index("disk")]
    np.testing.assert_allclose(moved, expected, rtol=1e-7)


def hub_rotor(**film):
    """A disk in one bearing at its center, free to tilt."""
    bearing = Bearing("film", ["ground.hub", "disk"], [0.0, 0.0, 1.0], **film)
    disk = RigidBody(MASS, [DIAMETRAL, DIAMETRAL, POLAR])
    return Model({"disk": disk}, bearings=[bearing], ground_frames={"hub": Frame()})


def test_the_largest_orbit_is_found_between_the_speeds_of_a_sweep():
    """At omega / sqrt(1 - 2 zeta^2), u / (m 2 zeta sqrt(1 - zeta^2))."""
    stiffness, damping, u = 2e5, 140.0, 1e-3
    omega, zeta = np.sqrt(stiffness / MASS), 0.5 * damping / np.sqrt(stiffness * MASS)
    model = hub_rotor(stiffness=stiffness, damping=damping)
    response = unbalance_response(model, {"disk": u}, np.linspace(120.0, 160.0, 41).tolist())
    ((spin, size),) = response.peaks("disk")
    assert spin == pytest.approx(omega / np.sqrt(1.0 - 2.0 * zeta**2), rel=1e-4)
    assert size == pytest.approx(u / MASS / (2.0 * zeta * np.sqrt(1.0 - zeta**2)), rel=1e-3)


@pytest.mark.parametrize("zeta", [5e-3, 1e-6, 0.0])
def test_a_peak_between_spins_far_apart_has_its_size(zeta):
    """At 198.7 rad/s between spins 5 rad/s apart."""
    omega, u = 198.7, 1e-3
    model = hub_rotor(stiffness=MASS * omega**2, damping=2.0 * zeta * MASS * omega)
    response = unbalance_response(model, {"disk": u}, np.arange(150.0, 251.0, 5.0).tolist())
    ((spin, size),) = response.peaks("disk")
    assert spin == pytest.approx(omega / np.sqrt(1.0 - 2.0 * zeta**2), rel=1e-5)
    exact = u / MASS / (2.0 * zeta * np.sqrt(1.0 - zeta**2)) if zeta else np.inf
    assert size == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize(
    ("unbalance", "spin", "message"),
    [
        ({"disk": 1e-3}, 100.0, "100 rad/s: it resonates there without damping"),
        ({"disk": np.nan}, 90.0, "unbalance: disk: expected a number in kg m, got nan"),
        ({"ground.hub": 1.0}, 90.0, "expected a frame of a body, got 'ground.hub'"),
        ({}, 90.0, "expected at least one frame"),
    ],
)
def test_what_unbalance_refuses(unbalance, spin, message):
    with pytest.raises(ModelError, match=message):
        unbalance_response(hub_rotor(stiffness=1e5), unbalance, [spin])


def test_cross_coupling_that_grows_with_the_spin_makes_a_threshold():
    """m c'' + c_e c' + k c = alpha Omega (e_3 x c) grows above alpha Omega = c_e sqrt(k / m)."""
    alpha, damping, stiffness = 50.0, 120.0, 1e5
    model = hub_rotor(
        speeds=[0.0, 800.0],
        stiffness=[[stiffness, alpha * s, -alpha * s, stiffness] for s in (0.0, 800.0)],
        damping=[[damping, 0.0, 0.0, damping]] * 2,
    )
    found = stability_map(model, [100.0, 200.0, 300.0, 700.0])
    threshold = damping * np.sqrt(stiffness / MASS) / alpha
    assert found.thresholds.tolist() == pytest.approx([threshold], rel=1e-7)
    assert found.unstable.tolist() == [False, False, True, True]


def test_lines_go_on_where_the_sense_of_their_whirl_changes():
    """Cross coupling turns a backward mode forward; by whirl its line would jump to another."""
    film = [[1e5, s, -s, 1.4e5] for s in (0.0, 4e4)]
    model = rigid_rotor(speeds=[0.0, 400.0], stiffness=film, damping=[[80.0, 0.0, 0.0, 80.0]] * 2)
    spins = np.linspace(0.0, 400.0, 9)
    lines = campbell(model, spins.tolist(), 4).lines
    assert "mixed" in {line.whirl for line in lines}
    frequencies = np.array([line.frequencies for line in lines])
    assert np.isfinite(frequencies).all()
    assert (np.abs(np.diff(frequencies, axis=1)) < 0.16 * frequencies[:, 1:]).all()
    for spin, found in zip(spins[1:].tolist(), frequencies.T[1:], strict=True):
        modes = rotor_at(model, spin).modes()
        np.testing.assert_allclose(np.sort(found), modes.frequencies[modes.rigid :], rtol=1e-9)


def over_a_turn(inertia, spin):
    """Multipliers of a rigid rotor by integration of Euler's equations, its tilt in body axes."""
    J1, J2, J3 = inertia

    def rate(t, x):
        place, tilt, velocity, turning = x.reshape(8, 8)[:2], *np.split(x.reshape(8, 8)[2:], 3)
        c, s = np.cos(spin * t), np.sin(spin * t)
        R = np.array([[c, -s], [s, c]])
        carried = turning + spin * np.array([-tilt[1], tilt[0]])
        push, moment = np.zeros((2, 8)), np.zeros((2, 8))
        for z in (LEFT, RIGHT):
            lever = z * np.array([[0.0, 1.0], [-1.0, 0.0]])
            force = -K @ (place + lever @ R @ tilt) - C @ (velocity + lever @ R @ carried)
            push += force
            moment += (lever @ R).T @ force
        cross, by = spin * (J1 + J2 - J3), spin**2
        turn = np.array([
            (moment[0] + cross * turning[1] - by * (J3 - J2) * tilt[0]) / J1,
            (moment[1] - cross * turning[0] - by * (J3 - J1) * tilt[1]) / J2,
        ])  # fmt: skip
        return np.vstack([velocity, turning, push / MASS, turn]).ravel()

    period = 2.0 * np.pi / spin
    end = solve_ivp(rate, (0.0, period), np.eye(8).ravel(), "DOP853", rtol=1e-10, atol=1e-12)
    return np.linalg.eigvals(end.y[:, -1].reshape(8, 8))


@pytest.mark.parametrize("spin", [150.0, 400.0])
def test_floquet_multipliers_of_a_rotor_of_unequal_inertia_on_unequal_bearings(spin):
    inertia = (0.1, 0.19, 0.2)
    found = floquet(rigid_rotor(inertia=inertia), spin).multipliers
    expected = over_a_turn(inertia, spin)
    assert len(found) == 12  # four of which are those of free motions
    for value in expected:
        assert np.abs(found - value).min() < 1e-6 * np.abs(expected).max()


@pytest.mark.parametrize("zeta", [0.0, 5e-4])
@pytest.mark.parametrize("ratio", [1.0, 60.0, 200.0])
def test_floquet_multipliers_of_oscillators_that_are_faster_than_the_spin(ratio, zeta):
    omega = 200.0
    spin = omega / ratio
    model = hub_rotor(stiffness=MASS * omega**2, damping=2.0 * zeta * MASS * omega)
    found = np.abs(floquet(model, spin).multipliers)
    expected = np.exp(-2.0 * np.pi * zeta * ratio)
    assert (np.abs(found / expected - 1.0) < 1e-6).sum() >= 4
    # Free motions, which are chains of one eigenvalue, are rounded to a root.
    assert found.max() < 1.0 + 2e-6


def test_fast_modes_that_the_bearings_change_do_not_grow():
    """Steps of 512 in a turn are in resonance with modes of 256 times the spin."""
    found = floquet(hub_rotor(stiffness=[4e5, 8e5]), 0.7).multipliers
    assert np.abs(found).max() < 1.0 + 1e-7
    with pytest.raises(ModelError, match="is hardly damped and needs 355431 steps"):
        floquet(hub_rotor(stiffness=[4e5, 8e5]), 0.01)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"inertia": (0.1, 0.12, 0.2)}, "not alike all round the axis"),
        ({"turn": [0.1, 0.0, 0.0], "axis": [0.0, 0.0, 1.0]}, "axis: expected that of the rotor"),
        ({"speeds": [0.0, 40.0], "stiffness": [[1.0, 0.0, 0.0, 1.0]] * 2, "damping": 0.0},
         "bearing 'left': speeds: 50 rad/s is beyond its table, from 0 to 40"),
    ],
)  # fmt: skip
def test_what_rotors_refuse(change, message):
    model = rigid_rotor(**change)
    if "turn" in change:
        rotation = SteadyRotation(Rotation.from_rotvec(change["turn"]).apply([0.0, 0.0, 1.0]))
        model = model.with_settings(start="equilibrium", steady_rotation=rotation)
    with pytest.raises(ModelError, match=message):
        rotor_at(model, 50.0)


@pytest.mark.parametrize("spin", [0.0, -5.0, np.nan, np.inf])
def test_a_rotor_that_does_not_spin_forward_is_refused(spin):
    with pytest.raises(ModelError, match=r"rotor: expected a spin above 0 rad/s, got "):
        rotor_at(hub_rotor(stiffness=1e5), spin)
    for analysis in (stability_map, campbell):
        with pytest.raises(ModelError, match="spins: expected numbers"):
            analysis(hub_rotor(stiffness=1e5), [-5.0, 50.0])


@pytest.mark.parametrize(("spin", "row"), [(100.0, 0), (400.0, -1), (97.01, 0), (402.99, -1)])
def test_a_table_holds_up_to_a_hundredth_beyond_its_ends(spin, row):
    films = [[1e5, 2e4, -2e4, 1e5], [2e5, 3e4, -3e4, 3e5]]
    table = {"speeds": [100.0, 400.0], "stiffness": films, "damping": [[9.0, 0.0, 0.0, 8.0]] * 2}
    plain = {"stiffness": np.reshape(films[row], (2, 2)), "damping": [9.0, 8.0]}
    found, expected = (
        rotor_at(rigid_rotor(**film), spin).modes().values for film in (table, plain)
    )
    np.testing.assert_array_equal(found, expected)
    # As in runs, and since a speed in rpm may be a bit from the same one in rad/s.
    for beyond in (96.99, 403.01):
        with pytest.raises(ModelError, match="is beyond its table, from 100 to 400"):
            rotor_at(rigid_rotor(**table), beyond)


def test_a_free_rotor_nutates_at_the_ratio_of_its_inertias():
    disk = RigidBody(MASS, [DIAMETRAL, DIAMETRAL, POLAR])
    rotation = SteadyRotation([0.0, 0.0, 1.0])
    model = Model({"disk": disk}).with_settings(start="equilibrium", steady_rotation=rotation)
    values = rotor_at(model, 70.0).modes().values
    turning = values[np.abs(values) > 1e-3]
    np.testing.assert_allclose(turning, [70.0j * POLAR / DIAMETRAL], rtol=1e-9, atol=1e-6)


def test_damping_along_one_direction_alone():
    model = hub_rotor(stiffness=[1e5, 2e5], damping=[120.0, 0.0])
    values = rotor_at(model, 50.0).modes().values
    for stiffness, damping in ((1e5, 120.0), (2e5, 0.0)):
        rate = 0.5 * damping / MASS
        expected = -rate + 1j * np.sqrt(stiffness / MASS - rate**2)
        assert np.abs(values - expected).min() < 1e-7 * abs(expected)


def test_a_region_of_instability_begins_and_ends():
    """Cross coupling that rises to 200 rad/s and falls again, beyond c_e sqrt(k / m) between."""
    stiffness, damping, most = 1e5, 120.0, 2e4
    model = hub_rotor(
        speeds=[0.0, 200.0, 400.0],
        stiffness=[[stiffness, s, -s, stiffness] for s in (0.0, most, 0.0)],
        damping=[[damping, 0.0, 0.0, damping]] * 3,
    )
    found = stability_map(model, [50.0, 150.0, 250.0, 350.0])
    first = 200.0 * damping * np.sqrt(stiffness / MASS) / most
    assert found.thresholds.tolist() == pytest.approx([first, 400.0 - first], rel=1e-6)
    assert found.unstable.tolist() == [False, True, True, False]


@pytest.fixture(scope="module")
def shaft():
    return steel_shaft()


@pytest.mark.parametrize("case", ROSS)
def test_modes_of_a_rotor_with_two_disks_are_those_of_ross(shaft, case):
    stiffness, damping, spin, expected = ROSS[case]
    values = rotor_at(two_disks(shaft, stiffness, damping).model(), spin).modes(12).values
    for value in expected:
        assert np.abs(values - value).min() < 1e-6 * abs(value)


def test_unbalance_of_a_rotor_with_two_disks_is_that_of_ross(shaft):
    """1 g m at the first disk, at 90 and 300 rad/s: y and z of the second disk."""
    response = two_disks(shaft, [1e6, 8e5], 100.0).unbalance({"shaft.one": 1e-3}, [90.0, 300.0])
    expected = [
        [-1.39172101e-04 - 6.47117367e-06j, -2.08903916e-06 + 6.78015381e-05j],
        [6.67918893e-05 + 1.23704526e-05j, 7.96937761e-06 - 4.28673810e-05j],
    ]
    moved = response.motion[:, response.names.index("two")]
    np.testing.assert_allclose(moved, expected, rtol=2e-5)


def test_a_ring_down_has_the_frequencies_and_the_decay_of_the_modes(shaft):
    """Fitted to a run by its shift from sample to sample (ESPRIT), at 4000 turns per minute."""
    m = two_disks(shaft, [1e6, 8e5], 2e3)
    m.add(du.loads.Force(m["shaft"]["one"], "z", du.signals.HalfSine(2000.0, 2e-3, start=1e-3)))
    rotation = SteadyRotation([SPEED, 0.0, 0.0])
    run = m.simulate(0.4, step=1e-4, rho_inf=0.95, start="equilibrium", steady_rotation=rotation)
    points = ("shaft.left", "shaft.one", "shaft.two")
    y = np.hstack([run[name].position[60::10, 1:] for name in points])
    blocks = np.array([y[k : k + 20].ravel() for k in range(len(y) - 20)]).T
    space = np.linalg.svd(blocks, full_matrices=False)[0][:, :16]
    shift = np.linalg.lstsq(space[: -y.shape[1]], space[y.shape[1] :], rcond=None)[0]
    fitted = np.log(np.linalg.eigvals(shift)) / 1e-3
    modes = rotor_at(two_disks(shaft, [1e6, 8e5], 2e3).model(), SPEED).modes(6)
    slowest = modes.values[modes.values.imag > 0.0][:4]
    assert slowest.real.max() < -1.0
    for value in slowest:
        assert np.abs(fitted - value).min() < 5e-4 * abs(value)
