"""Fields from recorded loads: at the interfaces they are what the run itself recorded."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
from duhamel.preprocess import Body, assemble, build, read_body
from duhamel.preprocess.assembly.rigid import project
from duhamel.preprocess.body.body import NonlinearCoordinates, RecoveredFields
from duhamel.preprocess.body.material import Material
from duhamel.preprocess.recovery import recover
from duhamel.preprocess.sources.reading import read_source
from duhamel.results import peaks
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Harmonic,
    Model,
    RecoveryError,
    Results,
    Revolute,
    Settings,
    Spherical,
    Start,
    SteadyRotation,
    Torque,
    simulate,
)
from duhamel.superelement import Recovery, read, write
from scipy.linalg import lu_factor, lu_solve
from scipy.spatial.transform import Rotation

BAR = Path(__file__).parents[2] / "meshes" / "bar" / "solid.toml"

INTERFACES = ("root", "tip")
RULES = pytest.mark.parametrize("rule", ["consistent", "paper"])
HISTORIES = pytest.mark.parametrize("history", ["recursive", "direct"])


def watched(element):
    """The same body with its interfaces for points, and as "stress" their rotations twice over."""
    X = [interface.X for interface in element.interfaces]
    phi = element.modes.phi.reshape(len(X), -1, len(element.modes.omega))
    stress = np.concatenate([phi[:, 3:], phi[:, 3:]], axis=1)
    return replace(element, recovery=Recovery(X, [[0, 1]], phi[:, :3], stress))


def recorded(results, body, rows):
    return np.stack([results.frame(f"{body}.{name}").u[:, rows] for name in INTERFACES], axis=1)


def assert_recorded(results, body="beam"):
    """Displacements and, as stresses, rotations of the interfaces at every step."""
    for field, rows in ((results.displacement, slice(0, 3)), (results.stress, slice(3, 6))):
        expected = recorded(results, body, rows)
        found = field(body, results.time)[:, :, :3]
        assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


def spun(beam, hub_and_beam, **settings):
    """A hub that turns under a torque; the tip of its beam is pushed in space and twisted, from the
    start on.
    """
    model = hub_and_beam(
        beam, 0.5, pivot="spherical", spin=(0.0, 3.0, 20.0), t_end=0.05, step=2e-4, **settings
    )
    loads = (
        Torque("hub", [0.3, 0.0, 1.0], Constant(1.0)),
        Force("beam.tip", [0.0, 0.5, 1.0], Constant(1.0)),
        Torque("beam.tip", [0.1, 0.05, -0.1], Constant(1.0), follower=True),
    )
    element = watched(model.bodies["beam"].superelement)
    bodies = {**model.bodies, "beam": replace(model.bodies["beam"], superelement=element)}
    return replace(model, bodies=bodies, loads=loads)


@RULES
@HISTORIES
def test_the_field_at_the_interfaces_is_what_the_run_recorded(
    coarse_beam, hub_and_beam, rule, history
):
    assert_recorded(simulate(spun(coarse_beam, hub_and_beam, rule=rule, history=history)))


@pytest.mark.parametrize("rows", [slice(None), slice(37, 190)])
@pytest.mark.parametrize("name", ["displacement", "von_mises"])
@pytest.mark.parametrize("kept", [0, 1 << 20])
def test_extremes_of_a_field_are_those_of_all_its_values(
    coarse_beam, hub_and_beam, monkeypatch, name, rows, kept
):
    monkeypatch.setattr("duhamel.results.recovery.MAX_KEPT_MODAL_BYTES", kept)
    results = simulate(spun(coarse_beam, hub_and_beam))
    every = results.displacement("beam", results.time)
    over_time = np.linalg.norm(every, axis=-1).max(axis=1)
    if name == "von_mises":
        over_time = results.von_mises("beam", results.time).max(axis=1)
    found, shown = results.field_extremes("beam", name, rows), over_time[rows]
    assert found.largest == pytest.approx(shown.max(), rel=1e-12)
    assert found.smallest == pytest.approx(shown.min(), rel=1e-12)
    assert over_time[found.at_largest] == pytest.approx(found.largest, rel=1e-12)
    assert over_time[found.at_smallest] == pytest.approx(found.smallest, rel=1e-12)
    assert results.field_extremes("beam", name, rows) is found


def test_the_place_of_a_peak_is_told_as_the_mesh_has_it(coarse_beam, hub_and_beam):
    model = spun(coarse_beam, hub_and_beam)
    element = model.bodies["beam"].superelement
    recovery = replace(element.recovery, nodes=[7, 401])
    element = replace(element, recovery=recovery, center=[10.0, 20.0, 30.0], outline=None)
    bodies = {**model.bodies, "beam": replace(model.bodies["beam"], superelement=element)}
    results = simulate(replace(model, bodies=bodies))
    (peak,) = peaks(results, ["von_mises:beam"])
    point = results.von_mises("beam", peak.at_largest).argmax()
    assert peak.place.node == recovery.nodes[point]
    np.testing.assert_allclose(peak.place.position, recovery.points[point] + element.center)
    assert not results.place("hub", 0).in_mesh


@RULES
@HISTORIES
def test_the_same_from_equilibrium(coarse_beam, rule, history):
    """A cantilever under gravity and a tip force that begins to oscillate about what it was in
    equilibrium.
    """
    model = Model(
        bodies={"beam": FlexibleBody(watched(coarse_beam.element), Start(position=[0.25, 0, 0]))},
        joints=[Fixed("ground", "beam.root", name="clamp")],
        loads=[Force("beam.tip", [0.3, 1, -1], Harmonic(1.0, 30.0, offset=1.0))],
        gravity=[0, 0, -9.81],
        settings=Settings(t_end=0.05, step=2e-4, start="equilibrium", rule=rule, history=history),
    )
    assert_recorded(simulate(model))


def test_the_same_from_a_steady_rotation(coarse_beam):
    """The root is on the axis, and the tip is pushed from the start on."""
    spin = 30.0
    model = Model(
        bodies={"beam": FlexibleBody(watched(coarse_beam.element), Start(position=[0.25, 0, 0]))},
        joints=[Revolute("ground", "beam.root", [0, 0, 1], name="pivot")],
        loads=[Force("beam.tip", [0, 0, 1], Harmonic(0.5, 30.0, offset=0.5), follower=True)],
        settings=Settings(
            t_end=0.05, step=2e-4, start="equilibrium", steady_rotation=SteadyRotation([0, 0, spin])
        ),
    )
    assert_recorded(simulate(model))


@pytest.fixture(scope="module")
def spinning(coarse_beam, hub_and_beam):
    return simulate(spun(coarse_beam, hub_and_beam))


def test_positions_in_space_are_those_of_the_frames(spinning):
    expected = np.stack([spinning.frame(f"beam.{name}").position for name in INTERFACES], axis=1)
    np.testing.assert_allclose(
        spinning.position("beam", spinning.time), expected, rtol=0, atol=1e-13
    )


def test_fields_are_linear_between_steps(spinning):
    t = spinning.time[[100, 101]]
    before, after = spinning.displacement("beam", t)
    between = spinning.displacement("beam", 0.25 * t[0] + 0.75 * t[1])
    np.testing.assert_allclose(
        between, 0.25 * before + 0.75 * after, rtol=0, atol=1e-12 * np.abs(after).max()
    )


def test_the_shapes_of_fields(spinning):
    assert spinning.displacement("beam", 0.01).shape == (2, 3)
    assert spinning.stress("beam", [0.01, 0.02, 0.02]).shape == (3, 2, 6)
    assert spinning.von_mises("beam", np.zeros(1)).shape == (1, 2)
    assert spinning.position("beam", 0.0).shape == (2, 3)


@pytest.mark.parametrize("t", [-1e-9, 0.0501])
def test_a_time_outside_the_run(spinning, t):
    with pytest.raises(RecoveryError, match=r"is outside the run, 0 to 0.05 s"):
        spinning.displacement("beam", t)


def test_a_body_without_recovery(coarse, hub_and_beam, coarse_beam):
    model = hub_and_beam(coarse_beam, 0.5, t_end=1e-3)
    results = simulate(model)
    with pytest.raises(
        RecoveryError, match=r"body 'beam': superelement .* holds no recovery.* table \[recovery\]"
    ):
        results.displacement("beam", 0.0)
    with pytest.raises(RecoveryError, match="the run has no flexible body 'hub'"):
        results.displacement("hub", 0.0)
    bare = watched(coarse_beam.element)
    bare = replace(bare, recovery=replace(bare.recovery, stress=None))
    with_shape = replace(
        model, bodies={**model.bodies, "beam": replace(model.bodies["beam"], superelement=bare)}
    )
    with pytest.raises(RecoveryError, match="body 'beam': recovery: no stress modes"):
        simulate(with_shape).stress("beam", 0.0)


def test_results_that_are_read_find_their_superelement(coarse_beam, hub_and_beam, tmp_path):
    model, path = spun(coarse_beam, hub_and_beam), tmp_path / "beam.h5"
    element = model.bodies["beam"].superelement
    write(path, element)
    # As models are read from files: without the recovery, which is read when fields are asked for,
    # in single precision.
    body = replace(model.bodies["beam"], superelement=read(path, recovery=False), source=str(path))
    of_file = replace(model, bodies={**model.bodies, "beam": body}).with_settings(t_end=0.002)
    expected = simulate(of_file, output=tmp_path / "out.h5").displacement("beam", 0.002)
    precise = simulate(model.with_settings(t_end=0.002)).displacement("beam", 0.002)
    np.testing.assert_allclose(expected, precise, rtol=0, atol=1e-7 * np.abs(precise).max())
    whole = read(path)

    def again(**given):
        return Results.read(tmp_path / "out.h5", **given).displacement("beam", 0.002)

    np.testing.assert_array_equal(again(), expected)
    write(path, replace(element, name="another"))
    with pytest.raises(
        RecoveryError,
        match=r"body 'beam': .*beam.h5 has changed since the run: expected SHA-256 \w{64}",
    ):
        again()
    path.unlink()
    with pytest.raises(
        RecoveryError,
        match=r"beam.h5, the file of its superelement, is gone: give it to Results.read",
    ):
        again()
    np.testing.assert_array_equal(again(superelements={"beam": whole}), expected)

    with h5py.File(tmp_path / "out.h5", "a") as file:
        del file["solver"].attrs["start"]
    with pytest.raises(
        RecoveryError, match=r"out\.h5: group solver has no attribute start, which fields need"
    ):
        again(superelements={"beam": whole})

    simulate(model.with_settings(t_end=0.002), output=tmp_path / "out.h5")
    with pytest.raises(
        RecoveryError, match="body 'beam': the run read no file for its superelement"
    ):
        again()


STEEL = Material(E=2.1e11, nu=0.3, rho=7800.0)


def solid(path, divisions, size, material=STEEL, method="modal", tolerance=1e-6, **changes):
    """A bar of 8-node hexahedra along x with frames on its end faces; it stores its surface and the
    stresses there.
    """
    n = np.array(divisions) + 1
    points = np.stack(
        np.meshgrid(*(np.linspace(0, s, k) for s, k in zip(size, n, strict=True)), indexing="ij"),
        -1,
    )
    number = np.arange(n.prod()).reshape(n)
    lower, upper = slice(None, -1), slice(1, None)
    corners = [(lower, lower), (upper, lower), (upper, upper), (lower, upper)]
    cells = [number[x, y, z].ravel() for z in (lower, upper) for x, y in corners]
    meshio.Mesh(points.reshape(-1, 3), [("hexahedron", np.stack(cells, axis=1))]).write(path)
    ends = {"root": [0.0, 0.0, 0.0], "tip": [size[0], 0.0, 0.0]}
    body = Body(
        name="bar",
        mesh=path,
        material=material,
        interfaces={
            name: {"plane": {"point": point, "normal": [1, 0, 0]}} for name, point in ends.items()
        },
        impulse={"step": 2e-5, "steps": 100, "method": method, "tolerance": tolerance},
        recovery={"stress": True},
        **changes,
    )
    return body, assemble(body), build(body)


def unreduced(structure, p, h, rho_inf):
    """u (n, n_u) of M u'' + K u = P^T P_C^T p in all unknowns: generalized-alpha as Chung and
    Hulbert wrote it.
    """
    M, K, F = structure.M.toarray(), structure.K.toarray(), structure.loads
    alpha_m, alpha_f = (2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1)
    gamma, beta = 0.5 - alpha_m + alpha_f, 0.25 * (1 - alpha_m + alpha_f) ** 2
    S = lu_factor((1 - alpha_m) * M + (1 - alpha_f) * beta * h**2 * K)
    u, v, a = np.zeros(len(M)), np.zeros(len(M)), np.linalg.solve(M, F @ p[0])
    path = [u]
    for before, after in pairwise(p):
        u_star, v_star = u + h * v + h**2 * (0.5 - beta) * a, v + h * (1 - gamma) * a
        load = F @ ((1 - alpha_f) * after + alpha_f * before) - K @ (
            (1 - alpha_f) * u_star + alpha_f * u
        )
        a = lu_solve(S, load - alpha_m * M @ a)
        u, v = u_star + beta * h**2 * a, v_star + gamma * h * a
        path.append(u)
    return np.array(path)


def wrenches(results, body):
    """Interface loads in body axes (n, 12): scipy's rotations, and T(w) from its power series."""
    turn = Rotation.from_quat(np.roll(results.body(body).R, -1, axis=1))
    parts = []
    for frame in (results.frame(f"{body}.{name}") for name in INTERFACES):
        moment = term = turn.apply(frame.force[:, 3:], inverse=True)
        for k in range(2, 12):
            term = -np.cross(frame.u[:, 3:], term) / k
            moment = moment + term
        parts += [turn.apply(frame.force[:, :3], inverse=True), moment]
    return np.hstack(parts)


def largest_errors(results, body, structure, steps):
    """Of displacements and of stresses at some steps, over the largest there are."""
    p = wrenches(results, "bar")
    u = unreduced(structure, p, 2e-5, 0.9)[steps].T
    u = project(u, structure.U, structure.M)  # where nothing holds rounding back
    full = recover(body, read_source(body), structure, lambda rows: rows @ u)
    fields = (
        (results.displacement("bar", results.time[steps]), full.phi),
        (results.stress("bar", results.time[steps]), full.stress),
    )
    return [
        np.abs(found - np.moveaxis(expected, -1, 0)).max() / np.abs(expected).max()
        for found, expected in fields
    ]


def test_fields_are_those_of_the_unreduced_model(tmp_path):
    """A solid on a spherical joint turns, and its tip is pushed from the start on: every point at
    several times.
    """
    body, structure, element = solid(tmp_path / "bar.vtu", (6, 2, 2), (0.3, 0.03, 0.02))
    model = Model(
        bodies={
            "bar": FlexibleBody(
                element, Start(position=[0.15, 0, 0], angular_velocity=[5.0, 0, 30.0])
            )
        },
        joints=[Spherical("ground", "bar.root", name="pivot")],
        loads=[
            Force("bar.tip", [100.0, 200.0, 300.0], Constant(1.0)),
            Torque("bar.tip", [20.0, 5.0, 10.0], Constant(1.0), follower=True),
        ],
        settings=Settings(t_end=0.006),
    )
    errors = largest_errors(simulate(model), body, structure, [0, 1, 40, 151, 300])
    assert max(errors) < 1e-11


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_fields_of_krylov_modes_are_right_to_the_tolerance(tmp_path, tolerance):
    """The same under a load within the band of the kernel, which grows as 1 - cos at 1 kHz."""
    body, structure, element = solid(
        tmp_path / "bar.vtu", (6, 2, 2), (0.3, 0.03, 0.02), method="krylov", tolerance=tolerance
    )
    signal = Harmonic(0.5, 1000.0, phase=-0.5 * np.pi, offset=0.5)
    model = Model(
        bodies={"bar": FlexibleBody(element, Start(position=[0.15, 0, 0]))},
        joints=[Spherical("ground", "bar.root", name="pivot")],
        loads=[
            Force("bar.tip", [100.0, 200.0, 300.0], signal),
            Torque("bar.tip", [20.0, 5.0, 10.0], signal, follower=True),
        ],
        settings=Settings(t_end=0.006),
    )
    errors = largest_errors(simulate(model), body, structure, [0, 1, 40, 151, 300])
    assert max(errors) < tolerance


def test_a_bar_under_way_carries_the_inertia_of_what_is_beyond(tmp_path):
    """Pushed at its root a free bar accelerates, and once it rests in itself sigma_xx A = -F (1 - x
    / L).
    """
    push, size = 1000.0, (0.3, 0.03, 0.02)
    material = Material(E=2.1e11, nu=0.0, rho=7800.0)
    _, structure, element = solid(
        tmp_path / "bar.vtu", (6, 1, 1), size, material, damping={"modal": 0.3}
    )
    model = Model(
        bodies={"bar": FlexibleBody(element)},
        loads=[Force("bar.root", [push, 0, 0], Constant(1.0))],
        settings=Settings(t_end=0.02),
    )
    stress = simulate(model).stress("bar", 0.02)
    x = (element.recovery.points + structure.rigid.center)[:, 0]
    expected = np.zeros_like(stress)
    expected[:, 0] = -push * (1.0 - x / 0.3) / (0.03 * 0.02)
    # at the ends stands the mean of the element there
    inner = (x > 1e-9) & (x < 0.3 - 1e-9)
    np.testing.assert_allclose(
        stress[inner], expected[inner], rtol=0, atol=1e-11 * np.abs(expected).max()
    )


def test_a_bar_that_spins_carries_its_centrifugal_load(tmp_path):
    """About its middle, sigma_xx = rho W^2 (L^2 / 4 - x^2) / 2; elements are as long as l and have
    the mean of it, of which two meet at a node.
    """
    spin, L, n, size = 500.0, 0.3, 6, (0.3, 0.03, 0.02)
    material = Material(E=2.1e11, nu=0.0, rho=7800.0)
    _, _, element = solid(
        tmp_path / "bar.vtu", (n, 1, 1), size, material, rotation=NonlinearCoordinates()
    )
    steady = {"start": "equilibrium", "steady_rotation": SteadyRotation([0, 0, spin])}
    model = Model({"bar": FlexibleBody(element)}, settings=Settings(t_end=1e-3, **steady))
    results = simulate(model)
    x = element.recovery.points[:, 0]
    inner = np.abs(x) < 0.5 * L - 1e-9
    expected = 7800.0 * spin**2 * (L**2 / 4.0 - x**2 - (L / n) ** 2 / 3.0) / 2.0
    for t in (0.0, 1e-3):
        stress = results.stress("bar", t)[:, 0]
        assert np.abs(stress - expected)[inner].max() < 1e-4 * expected.max()
    linear = replace(model.bodies["bar"], second_order="off")
    without = simulate(replace(model, bodies={"bar": linear})).stress("bar", 1e-3)
    assert np.abs(without).max() < 1e-9 * expected.max()


def test_a_cantilever_in_bending():
    """sigma_xx = -F (L - x) z / I, and nothing across but shear, in a solid that starts in
    equilibrium.
    """
    element = build(read_body(BAR).model_copy(update={"recovery": RecoveredFields(stress=True)}))
    L, width, depth = np.ptp(element.recovery.points, axis=0)
    model = Model(
        bodies={"bar": FlexibleBody(element, Start(position=[0.5 * L, 0, 0]))},
        joints=[Fixed("ground", "bar.root", name="clamp")],
        loads=[Force("bar.tip", [0, 0, 1], Constant(1.0))],
        settings=Settings(start="equilibrium", t_end=1e-3),
    )
    stress = simulate(model).stress("bar", 1e-3)
    x, _, z = element.recovery.points.T
    away = np.abs(x) < 0.3 * L
    expected = np.zeros((len(x), 4))
    expected[:, 0] = -(0.5 * L - x) * z / (width * depth**3 / 12)
    found = stress[away, :4]
    np.testing.assert_allclose(found, expected[away], rtol=0, atol=1e-5 * np.abs(expected).max())
