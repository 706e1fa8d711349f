"""What results say of contacts of surfaces: totals, events, nodes, and how scripts ask for them."""

import duhamel as du
import numpy as np
import pytest
from duhamel import solver
from duhamel.cli.run_report import report
from duhamel.preprocess import PlausibilityWarning, assemble
from duhamel.preprocess.responses.static import static_solver
from duhamel.preprocess.sources.reading import read_source
from duhamel.results import ExportError, RecoveryError, ResultsError, peaks, write_csv
from duhamel.results.exports.loads import load_set
from duhamel.solver import ModelError, OutputRequest, ValidityWarning
from duhamel.superelement import von_mises

from ..surface_bodies import dome

STEP, SPEED = 2.5e-7, 1.0
NODES = OutputRequest(nodes=True)


@pytest.fixture(scope="module")
def element():
    # Its mesh is coarse for the band, which is no matter here.
    with pytest.warns(PlausibilityWarning, match="nodes in the shortest wave"):
        return dome(2e-4, 3, 3, 5e-4).superelement(step=STEP, band=4e5)


def lowest(element):
    return float(element.surface("dome").X[:, 2].min())


def drop(element, tilt=0.0, height=2e-5, speed=SPEED, gravity=0.0, **keys):
    """A dome that falls on the ground with its rounded end down."""
    m = du.Mechanism(gravity=[0.0, 0.0, -gravity])
    body = m.add(
        element,
        name="dome",
        position=[0.0, 0.0, height - lowest(element)],
        rotation=[0.0, tilt, 0.0],
        velocity=[0.0, 0.0, -speed],
    )
    keys = {"shape": "plane", "axis": "z", **keys}
    m.add(du.contacts.surface(body["dome"], m.ground, **keys), name="floor")
    return m


@pytest.fixture(scope="module")
def tilted(element):
    return drop(element, tilt=0.02).simulate(1e-4, STEP, record=NODES)


def test_a_surface_that_never_closed_is_told_once_whatever_is_recorded(element, tilted):
    far = drop(element, height=1e-3).simulate(20 * STEP, STEP)
    assert far.results.never_closed == ["floor"]
    # It closes within the first row and the last, which are all that there is.
    seldom = drop(element, tilt=0.02).simulate(1e-4, STEP, record=OutputRequest(every=400))
    assert not seldom["floor"].closed_rows.any()
    assert seldom.results.never_closed == tilted.results.never_closed == []


def test_the_impulse_of_a_contact_is_the_change_of_momentum(tilted, element):
    motion = tilted["floor"]
    gained = element.mass * (tilted["dome"].v[-1, 2] + SPEED)
    np.testing.assert_allclose(motion.impulse[-1], gained, rtol=1e-6)
    np.testing.assert_allclose(STEP * motion.force[:, 2].sum(), gained, rtol=1e-6)
    assert np.abs(motion.force[:, :2]).max() < 1e-9 * motion.force[:, 2].max()
    np.testing.assert_allclose(motion.normal_force, motion.force[:, 2], rtol=1e-12)


def test_force_and_center_of_pressure_make_the_moment(tilted):
    motion, x = tilted["floor"], tilted["dome"].x
    closed = motion.closed_rows > 0
    arm = motion.center_of_pressure[closed] - x[closed]
    moment = np.cross(arm, motion.force[closed])
    scale = np.abs(motion.moment).max()
    assert scale > 1e-3 * motion.force.max() * 0.01
    np.testing.assert_allclose(motion.moment[closed], moment, rtol=0.0, atol=1e-9 * scale)
    assert np.isnan(motion.center_of_pressure[~closed]).all()
    # On the plane z = 0, within its mesh.
    assert np.abs(motion.center_of_pressure[closed, 2]).max() < 1e-9


def test_the_moment_is_the_rate_of_angular_momentum(tilted):
    motion, x = tilted["floor"], tilted["dome"].x
    about_origin = motion.moment + np.cross(x, motion.force)
    L = tilted.results.momentum.angular
    np.testing.assert_allclose(STEP * about_origin.sum(axis=0)[1], (L[-1] - L[0])[1], rtol=1e-2)


def test_totals_are_those_of_the_rows(tilted, element):
    motion, surface = tilted["floor"], element.surface("dome")
    assert (
        motion.pressure.shape == motion.gaps.shape == (len(tilted.time), len(surface.corner_nodes))
    )
    assert motion.displacement.shape == (len(tilted.time), surface.n, 3)
    closed = motion.pressure > 0.0
    assert closed.any()
    np.testing.assert_array_equal(closed.sum(axis=1), motion.closed_rows)
    np.testing.assert_array_equal(closed.any(axis=1), motion.state)
    np.testing.assert_array_equal(motion.pressure.max(axis=1), motion.largest_pressure)
    known = ~np.isnan(motion.gap)
    np.testing.assert_array_equal(np.nanmin(motion.gaps[known], axis=1), motion.gap[known])
    assert np.nanmin(motion.gaps) > -1e-12
    pressed = closed.sum(axis=1) == 1
    force = (motion.pressure.max(axis=1) * motion.area)[pressed]
    np.testing.assert_allclose(force, motion.normal_force[pressed], rtol=1e-12)


def test_closed_rows_lie_on_the_plane_by_their_displacement(element):
    """x + R (X + u) of the pole, which alone is first closed, is on the ground."""
    run = drop(element).simulate(4e-5, STEP, record=NODES)
    motion, surface = run["floor"], element.surface("dome")
    pole = int(np.argmin(surface.X[:, 2]))
    row = int(np.flatnonzero(surface.corner_nodes == pole)[0])
    z = run["dome"].x[:, 2] + surface.X[pole, 2] + motion.displacement[:, pole, 2]
    closed = motion.pressure[:, row] > 0.0
    np.testing.assert_allclose(np.diff(z)[closed[1:] & closed[:-1]], 0.0, atol=2e-7)
    assert np.abs(motion.displacement[closed, pole, 2]).max() > 1e-6


def test_an_impact_is_an_event(tilted):
    motion, h = tilted["floor"], STEP
    (event,) = zip(*(getattr(motion.events, n) for n in ("start", "end", "steps")), strict=True)
    closed = np.flatnonzero(motion.closed_rows)
    np.testing.assert_allclose(event, (h * (closed[0] - 1), h * closed[-1], len(closed)))
    assert motion.events.peak[0] == np.linalg.norm(motion.force, axis=1).max()
    np.testing.assert_allclose(motion.events.impulse[0], motion.impulse[-1], rtol=1e-14)
    assert motion.events.impacts == 1
    assert motion.events.whole.all()
    np.testing.assert_allclose(motion.events.closing_speed, SPEED, rtol=1e-3)
    x, v = tilted["dome"].x, tilted["dome"].angular_velocity
    arm = motion.center_of_pressure[closed[-1]] - x[closed[-1]]
    parting = tilted["dome"].v[-1, 2] + np.cross(v[-1], arm)[2]
    np.testing.assert_allclose(motion.events.opening_speed, parting, rtol=1e-3)
    assert np.isnan(motion.events.dissipated).all()
    assert tilted.validity.values("surface_steps")["floor"] == event[2]


def test_what_lies_on_the_ground_at_the_start_was_closed_before(element):
    run = drop(element, height=0.0, speed=0.0, gravity=1e5).simulate(2e-6, STEP)
    events = run["floor"].events
    assert events.start[0] == 0.0
    assert events.closing_speed[0] == 0.0
    assert events.impacts == 0


def test_too_few_steps_in_contact_are_a_warning(element):
    with pytest.warns(ValidityWarning, match="contact of surfaces"):
        run = drop(element).simulate(1e-4, 4e-6)
    assert run.validity.values("surface_steps")["floor"] < 8


def test_a_layer_is_pressed_together(element):
    layer = 1e15
    run = drop(element, layer=layer).simulate(5e-5, STEP, record=NODES)
    motion = run["floor"]
    closed = motion.pressure > 0.0
    np.testing.assert_allclose(
        motion.gaps[closed], -motion.pressure[closed] / layer, rtol=1e-6, atol=1e-12
    )


def test_the_second_body_gets_the_opposite_force(element):
    m = du.Mechanism()
    place = 1e-5 - lowest(element)
    a = m.add(element, name="a", position=[0, 0, place], velocity=[0, 0, -1.0])
    b = m.add(element, name="b", position=[0, 0, -place], rotation=[np.pi, 0, 0])
    m.add(du.contacts.surface(a["dome"], b["dome"]), name="both")
    run = m.simulate(6e-5, STEP)
    motion = run["both"]
    assert motion.closed_rows.max() > 0
    impulse = STEP * motion.force[:, 2].sum()
    np.testing.assert_allclose(element.mass * (run["a"].v[-1, 2] + 1.0), impulse, rtol=1e-6)
    np.testing.assert_allclose(element.mass * run["b"].v[-1, 2], -impulse, rtol=1e-6)
    np.testing.assert_allclose(motion.events.closing_speed[0], 1.0, rtol=1e-6)


def test_nodes_are_recorded_on_request_alone(element, tmp_path):
    run = drop(element).simulate(5e-6, STEP, output=tmp_path / "out.h5")
    with pytest.raises(ResultsError, match=r"pressure of rows and nodes was not recorded: write "):
        _ = run["floor"].pressure
    assert run["floor"].force.shape == (21, 3)


def test_a_contact_of_surfaces_is_recorded_by_its_name(element):
    request = OutputRequest(quantities=("surface_contacts/floor",), nodes=True)
    results = drop(element).simulate(5e-6, STEP, record=request).results
    assert results.recorded == ("surface_contacts/floor",)
    assert results.contact("floor").gaps.shape[0] == len(results.time)
    request = OutputRequest(quantities=("energy",), nodes=True)
    results = drop(element).simulate(5e-6, STEP, record=request).results
    assert results.recorded == ("energy",)
    assert "floor" in results.events


def test_files_have_the_same_as_memory(element, tilted, tmp_path):
    path = tmp_path / "out.h5"
    drop(element, tilt=0.02).simulate(1e-4, STEP, record=NODES, output=path)
    read = du.Run.read(path)
    for name, array in vars(tilted["floor"]).items():
        if name != "events":
            np.testing.assert_array_equal(getattr(read["floor"], name), array, err_msg=name)
    np.testing.assert_array_equal(read["floor"].events.peak, tilted["floor"].events.peak)


def test_plots_peaks_tables_and_the_line_of_a_run_know_it(tilted, tmp_path):
    results = tilted.results
    names = {peak.quantity for peak in peaks(results)}
    assert {"normal_force:floor", "largest_pressure:floor", "force:floor:z"} <= names
    panels = du.view.overview_quantities(results)
    assert ["normal_force:floor"] in panels
    (line,) = (line for line in report(results) if "nodes closed" in line)
    assert f"up to {tilted['floor'].closed_rows.max()} nodes closed" in line
    paths = {path.name for path in write_csv(results, tmp_path)}
    assert paths >= {"surface_contacts.csv", "events.csv"}


def test_a_check_says_what_touches_what(element):
    m = drop(element)
    wall = m.ground.frame("wall", [-0.01, 0.0, 0.0])
    m.add(du.contacts.surface("dome.dome", wall, shape="plane", axis="x"), name="wall")
    lines = m.check(1e-5, STEP).contacts
    rows = len(element.surface("dome").corner_nodes)
    assert lines[0] == (
        "contact 'floor': surface 'dome' of 'dome' on a plane on 'ground'; "
        f"{rows} nodes may close; gap at the start 2e-05 m"
    )
    size = 2 * 8 * (2 * rows) ** 2 / 1e6
    assert lines[2] == (
        f"contacts solved together: floor, wall; up to {2 * rows} unknown forces, {size:.3g} MB "
        "for their compliance"
    )


def test_a_script_writes_a_model_file_that_reads_back(element, tmp_path):
    m = drop(element)
    assert m["floor"].surfaces == ("dome.dome", "ground")
    m.write(tmp_path / "m.toml")
    again = du.Mechanism.read(tmp_path / "m.toml")
    assert again["floor"].shape == "plane"
    assert again["floor"].surfaces == ("dome.dome", "ground")
    (contact,) = solver.read_model(tmp_path / "m.toml").surface_contacts
    assert contact.name == "floor"


def test_an_unknown_surface_lists_those_of_the_body(element):
    body = drop(element)["dome"]
    assert body.surfaces == ("dome",)
    with pytest.raises(ModelError, match="no frame 'tip' on 'dome'; it has: dome"):
        _ = body["tip"]


@pytest.fixture(scope="module")
def part():
    """A dome with stresses and the interface `back` at its upper end."""
    part = dome(2e-4, 3, 3, 5e-4)
    part.interface("back", du.plane(z=0.008))
    part.recover(stress=True)
    return part


@pytest.fixture(scope="module")
def recovered(part):
    with pytest.warns(PlausibilityWarning, match="nodes in the shortest wave"):
        return part.superelement(step=STEP, band=4e5)


def test_fields_need_the_modes_of_a_run_where_contacts_press(recovered):
    """The modes of a body do not follow from the loads on its interfaces alone."""
    results = drop(recovered).simulate(5e-6, STEP).results
    assert results.pressed_surfaces == (("dome", "dome", "floor"),)
    with pytest.raises(RecoveryError, match=r"of its \d+ modes, found 0 .*\[output\] modes = true"):
        results.von_mises("dome", 0.0)
    assert results.outline_source("dome") == "interfaces"
    assert "surfaces are in contact" in results.outline_remark("dome")
    with pytest.raises(ExportError, match="its surfaces are in contact"):
        load_set(results, "dome", "worst")


@pytest.mark.parametrize("every", [1, 7])
def test_modes_of_a_run_have_the_motion_of_interfaces_and_fields(recovered, every):
    request = OutputRequest(every=every, modes=True)
    results = drop(recovered, height=1e-6).simulate(1e-5, STEP, record=request).results
    eta = results.body("dome").modal_coordinate * np.sqrt(recovered.mass)
    u = results.frame("dome.back").u
    assert results.contact("floor").normal_force.max() > 0.0
    assert eta.shape == (len(results.time), len(recovered.modes.omega))
    np.testing.assert_allclose(
        eta @ recovered.modes.phi[:6].T, u, rtol=1e-9, atol=1e-12 * np.abs(u).max()
    )
    t = results.time[[1, -1]]
    stress = np.einsum("pcm,tm->tpc", recovered.recovery.stress, eta)
    rest, force = recovered.recovery.rest, results.body("dome").surface_load
    stress += np.einsum("pcf,tf->tpc", rest.stress, force.reshape(len(eta), -1))
    stress = von_mises(stress)
    np.testing.assert_allclose(results.von_mises("dome", t), stress[[1, -1]], rtol=1e-9)
    assert results.outline_source("dome") == "recovery"
    largest = results.field_extremes("dome", "von_mises")
    assert largest.largest == pytest.approx(stress.max())


def test_stresses_under_a_contact_are_those_of_the_mesh(part, recovered):
    """A dome at rest on the ground: the mesh alone, with the same forces, is bent as it is."""
    m = drop(recovered, height=0.0, speed=0.0, gravity=1e5)
    record = OutputRequest(nodes=True, modes=True)
    results = m.simulate(2 * STEP, STEP, start="equilibrium", record=record).results
    body = part.body(step=STEP, band=4e5)
    structure = assemble(body)
    surface, force = recovered.surface("dome"), results.body("dome").surface_load[-1]
    assert force[:, 2].sum() == pytest.approx(1e5 * recovered.mass, rel=1e-6)
    # Gravity accelerates all of it alike, as the forces of the contact do.
    u = static_solver(structure)(structure.relieve(structure.surfaces.rows.T @ force.ravel()))
    points = read_source(body).field_points(True)
    expected = (points.stress_rows(structure.T) @ u).reshape(-1, 6)
    found = results.stress("dome", results.time[-1])
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-4 * np.abs(expected).max())
    modes = results.body("dome").modal_coordinate[-1] * np.sqrt(recovered.mass)
    error = np.abs(recovered.recovery.stresses(modes) - expected).max()
    assert error > 0.3 * np.abs(expected).max()  # which modes alone do not have
    # The nodes of the surface are points of the recovery.
    apart = np.linalg.norm(recovered.recovery.points[:, None] - surface.X, axis=2)
    moved = results.displacement("dome", results.time[-1])[apart.argmin(axis=0)]
    of_run = results.contact("floor").displacement[-1]
    np.testing.assert_allclose(moved, of_run, rtol=0.0, atol=1e-5 * np.abs(of_run).max())


def test_energy_of_rows_that_close_and_open_is_counted(element):
    """The balance is of second order in the step, though rows close in the middle of steps."""
    balances, changes = [], []
    for h in (4.0 * STEP, 2.0 * STEP):
        run = drop(element).simulate(6e-5, h)
        energy = run.results.energy
        balances.append(np.abs(energy.balance).max() / energy.kinetic[0])
        changes.append(run.validity.values("set_changes")[""])
    assert balances[0] < 1e-3
    assert balances[1] < 0.5 * balances[0]
    # What the balance would have missed, of first order.
    assert changes[0] > 5.0 * balances[0]


def test_the_energy_of_a_layer_is_stored(element):
    run = drop(element, layer=1e14).simulate(6e-5, STEP)
    energy = run.results.energy
    assert np.abs(energy.balance).max() < 1e-4 * energy.kinetic[0]


def test_results_know_the_shapes_that_surfaces_meet(element):
    """In space where the ground carries them, in the axes of their frame where a body does."""
    m = drop(element)
    turned = m.ground.frame("turned", [0.1, 0.2, -0.3], rotation=[0.0, 0.5 * np.pi, 0.0])
    m.add(du.contacts.surface("dome.dome", turned, shape="plane", axis="z"), name="wall")
    cart = m.add(
        du.RigidBody(1.0, [1.0, 1.0, 1.0]), name="cart", position=[0, 0, -1], rotation=[0, 1, 0]
    )
    m.add(
        du.contacts.surface("dome.dome", cart, shape="cylinder", axis="y", radius=0.3), name="roll"
    )
    results = m.simulate(STEP, STEP).results
    found = {one.name: one for one in results.couplings}
    assert {one.group for one in found.values()} == {"surface_contacts"}
    assert found["floor"].between == ("ground.(floor)", "dome")
    assert found["wall"].between == ("ground.turned", "dome")
    for name in ("floor", "wall"):
        np.testing.assert_allclose(found[name].axis, [0.0, 0.0, 1.0], atol=1e-15)
        assert abs(found[name].shape.across[2]) < 1e-12
    np.testing.assert_allclose(found["roll"].axis, [0.0, 1.0, 0.0], atol=1e-15)
    assert found["roll"].shape.radius == 0.3
    np.testing.assert_array_equal(results.ground_frames["(floor)"], np.zeros(3))
    np.testing.assert_array_equal(results.ground_frames["turned"], [0.1, 0.2, -0.3])


def test_outlines_show_pressures(recovered):
    results = (
        drop(recovered, height=1e-6).simulate(1e-5, STEP, record=OutputRequest(nodes=True)).results
    )
    pressure = results.contact("floor").pressure
    step = int(pressure.max(axis=1).argmax())
    shown = results.outline_field("dome", results.time[step], "pressure")
    assert shown.max() == pytest.approx(pressure[step].max())
    rows = recovered.surface("dome")
    points = results.outline("dome").points
    for X, P in zip(rows.X[rows.corner_nodes], pressure[step], strict=True):
        nearest = np.linalg.norm(points - X, axis=1).argmin()
        assert shown[nearest] == pytest.approx(P, rel=1e-12, abs=1e-9 * shown.max())
    # Away from the surface there is none.
    assert np.count_nonzero(shown) <= rows.n
    between = 0.5 * (results.time[step] + results.time[step - 1])
    mean = 0.5 * (pressure[step] + pressure[step - 1]).max()
    assert results.outline_field("dome", between, "pressure").max() == pytest.approx(mean)


def test_bodies_without_pressures_say_what_is_missing(recovered):
    results = drop(recovered).simulate(5e-6, STEP).results
    with pytest.raises(RecoveryError, match=r"'dome': no pressures: .*\[output\] nodes = true"):
        results.outline_field("dome", 0.0, "pressure")
