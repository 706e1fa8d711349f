"""Bodies of a run in space: outlines, how they move, what connects them."""

from dataclasses import replace

import h5netcdf
import h5py
import numpy as np
import pytest
from duhamel.preprocess import build, read_body
from duhamel.preprocess.body.body import RecoveredFields
from duhamel.solver import (
    Box,
    Constant,
    Contact,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Impact,
    Model,
    OutputRequest,
    PrescribedDisplacement,
    RecoveryError,
    Results,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    StartFrom,
    Surface,
    read_model,
    simulate,
    write_model,
)
from duhamel.solver.model.rigid_outline import box_of_inertia
from duhamel.superelement import figures

from .conftest import BEAM
from .test_recovery import BAR

TRIANGLE = """solid part
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid part
"""


@pytest.fixture(scope="module")
def recovered():
    """The paper's beam with a recovery."""
    return build(read_body(BEAM).model_copy(update={"recovery": RecoveredFields()}))


def cantilever(element, at=(0.0, 0.0, 0.0), **settings):
    """A beam that is held at its root, far from the origin if asked for, and pushed at its tip."""
    root = element.interface("root").X
    return Model(
        bodies={"beam": FlexibleBody(element, Start(position=np.array(at) - root))},
        joints=[Fixed("ground", "beam.root", name="clamp")],
        loads=[Force("beam.tip", [0.1, 1.0, 0.5], Constant(1.0))],
        settings=Settings(t_end=0.02, step=2e-4, **settings),
    )


def sections(outline, points):
    """The middle of each section of a beam (nodes, 3)."""
    return np.array([points[outline.node == node].mean(axis=0) for node in np.unique(outline.node)])


@pytest.fixture(scope="module")
def bent(recovered):
    return simulate(cantilever(recovered))


def test_the_sections_of_a_bent_beam_follow_its_nodes(bent):
    assert bent.outline_source("beam") == "recovery"
    outline, u = bent.outline("beam"), bent.outline_displacement("beam", 0.02)
    nodes = bent.displacement("beam", 0.02)
    np.testing.assert_allclose(sections(outline, u), nodes, atol=1e-12 * np.abs(nodes).max())


def test_the_section_at_the_tip_moves_and_turns_as_the_interface(bent):
    outline, u = bent.outline("beam"), bent.outline_displacement("beam", 0.02)
    tip, X = bent.frame("beam.tip"), bent.superelement("beam").interface("tip").X
    there = np.abs(outline.anchors - X).max(axis=1) < 1e-9
    arms = outline.points[there] - X
    expected = tip.u[-1, :3] + np.cross(tip.u[-1, 3:], arms)
    np.testing.assert_allclose(u[there], expected, atol=1e-7 * np.abs(tip.u[-1]).max())


def test_positions_and_speeds_are_those_of_the_frames(bent):
    outline, frame = bent.outline("beam"), bent.frame("beam.tip")
    X = bent.superelement("beam").interface("tip").X
    there = np.abs(outline.anchors - X).max(axis=1) < 1e-9
    times = bent.time[[0, 50, -1]]
    points = bent.outline_position("beam", times)[:, there].mean(axis=1)
    np.testing.assert_allclose(points, frame.position[[0, 50, -1]], atol=1e-12)
    speed = bent.outline_field("beam", times, "velocity")[1, there].mean()
    assert speed == pytest.approx(np.linalg.norm(frame.velocity[50, :3]), rel=0.01)


def test_without_a_recovery_it_is_blended_between_the_interfaces(recovered, bent):
    plain = simulate(cantilever(replace(recovered, recovery=None)))
    assert plain.outline_source("beam") == "interfaces"
    times = plain.time[::20]
    by_modes = bent.outline_displacement("beam", times)
    blended = plain.outline_displacement("beam", times)
    assert np.abs(blended - by_modes).max() < 0.15 * np.abs(by_modes).max()
    with pytest.raises(RecoveryError, match="holds no recovery"):
        plain.outline_field("beam", 0.0, "von_mises")


def test_a_run_of_which_steps_are_missing_is_blended(recovered):
    sparse = simulate(cantilever(recovered, output=OutputRequest(10)))
    assert sparse.outline_source("beam") == "interfaces"
    assert sparse.outline_displacement("beam", sparse.time).shape == (11, 132, 3)


def test_a_body_whose_interfaces_were_not_recorded_does_not_deform(recovered):
    request = OutputRequest(1, ("bodies",))
    results = simulate(cantilever(replace(recovered, recovery=None), output=request))
    assert results.outline_source("beam") == "rigid"
    assert not results.outline_displacement("beam", 0.02).any()


def test_far_from_the_origin_a_body_looks_the_same(recovered):
    element = replace(recovered, recovery=None)
    here, far = (simulate(cantilever(element, at)) for at in ((0.0, 0.0, 0.0), (1e3, -1e3, 2e3)))
    u, same = (run.outline_displacement("beam", 0.02) for run in (here, far))
    assert np.abs(same - u).max() < 1e-6 * np.abs(u).max()


def test_one_time_is_one_of_several(bent):
    several = bent.outline_position("beam", [0.0, 0.0101], 3.0)
    np.testing.assert_allclose(bent.outline_position("beam", 0.0101, 3.0), several[1], atol=1e-15)


def test_magnification_is_that_of_the_deformation_alone(bent):
    rest, once, twice = (bent.outline_position("beam", 0.02, scale) for scale in (0.0, 1.0, 2.0))
    np.testing.assert_allclose(twice - rest, 2.0 * (once - rest), atol=1e-14)
    away = np.linalg.norm(rest - bent.body("beam").x[-1], axis=1)
    at_rest = np.linalg.norm(bent.outline("beam").points, axis=1)
    np.testing.assert_allclose(away, at_rest, rtol=1e-12)


def test_stresses_are_at_the_points_of_the_outline():
    body = read_body(BAR).model_copy(update={"recovery": RecoveredFields(stress=True)})
    element = build(body)
    results = simulate(cantilever(element))
    stress = results.outline_field("beam", 0.02, "von_mises")
    assert stress.shape == (len(results.outline("beam").points),)
    np.testing.assert_array_equal(stress, results.von_mises("beam", 0.02))


def test_the_default_box_has_the_inertia_of_its_body():
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    inertia = turn @ np.diag([0.2, 0.3, 0.4]) @ turn.T
    outline = box_of_inertia(2.0, inertia)
    # A uniform box: its corners have three times the second moments of its volume.
    second = 2.0 / 3.0 * outline.points.T @ outline.points / 8.0
    np.testing.assert_allclose(np.trace(second) * np.eye(3) - second, inertia, atol=1e-14)
    assert outline.volume > 0.0


def falling(**bodies):
    return Model(bodies, settings=Settings(t_end=0.01, step=1e-3))


def test_a_box_of_a_mass_that_plays_no_part_is_no_larger_than_its_frames_say():
    frames = {"rim": Frame([0.05, 0, 0])}
    hub = RigidBody(0.01, [0.5, 0.5, 0.9], frames)
    extent = np.ptp(simulate(falling(hub=hub)).outline("hub").points, axis=0)
    assert extent.max() == pytest.approx(0.2)


@pytest.fixture
def part(tmp_path):
    path = tmp_path / "parts" / "part.stl"
    path.parent.mkdir()
    path.write_text(TRIANGLE)
    return path


def test_the_facets_of_a_file_are_in_the_results(part, tmp_path):
    body = RigidBody(1.0, [1, 1, 1], shape=Surface(part, 1e-3, [0, 0, 2]))
    path = tmp_path / "run.h5"
    simulate(falling(body=body), output=path)
    part.unlink()
    outline = Results.read(path).outline("body")
    np.testing.assert_allclose(outline.points, [[0, 0, 2], [1e-3, 0, 2], [0, 1e-3, 2]])
    assert len(outline.triangles) == 1


def test_a_shape_is_written_to_a_model_file_by_its_relative_path(part, tmp_path):
    model = falling(
        a=RigidBody(1.0, [1, 1, 1], shape=Surface(part, 1e-3)),
        b=RigidBody(1.0, [1, 1, 1], shape=Box([1, 2, 3], [0, 0, 1])),
    )
    write_model(tmp_path / "model.toml", model)
    assert 'stl = "parts/part.stl"' in (tmp_path / "model.toml").read_text()
    again = read_model(tmp_path / "model.toml").bodies
    for name in "ab":
        points = model.bodies[name].shape.outline.points
        np.testing.assert_array_equal(again[name].shape.outline.points, points)


@pytest.fixture(scope="module")
def mechanism(recovered, tmp_path_factory):
    """A model with connections of every group, its results in memory and in a file."""
    frames = {"f": Frame([0.1, 0, 0], [0, 0, np.pi / 2])}
    hub = RigidBody(1.0, [1, 1, 1], frames, shape=Box([0.1, 0.2, 0.3]))
    ball = RigidBody(1.0, [1, 1, 1], start=Start(position=[0, 0, 5]))
    beam = FlexibleBody(replace(recovered, recovery=None), Start(position=[0.35, 0, 0]))
    model = Model(
        {"hub": hub, "beam": beam, "twin": replace(beam, start=Start([0, 9, 0])), "ball": ball},
        [
            Revolute("ground.post", "hub", [0, 0, 1], name="pivot"),
            Fixed("hub.f", "beam.root", name="clamp"),
        ],
        springs=[Spring("coil", "torsion", ("hub.f", "ball"), [1, 0, 0], 1.0)],
        contacts=[
            Contact("touch", ("ground", "ball"), "plane", 0.1, axis=[0, 0, 1], impact=Impact(1e3))
        ],
        motions=[PrescribedDisplacement("lift", "ball", [0, 0, 2], Constant(0.0))],
        ground_frames={"post": Frame([1.0, 2.0, 3.0])},
        settings=Settings(t_end=0.002, step=2e-4, assemble=True),
    )
    path = tmp_path_factory.mktemp("space") / "run.h5"
    simulate(model, output=path)
    return simulate(model), Results.read(path), path


def test_connections_have_frames_types_and_axes(mechanism):
    for results in mechanism[:2]:
        found = {one.name: one for one in results.couplings}
        assert {name: (one.group, one.type, one.between) for name, one in found.items()} == {
            "pivot": ("joints", "revolute", ("ground.post", "hub")),
            "clamp": ("joints", "fixed", ("hub.f", "beam.root")),
            "lift": ("motions", "displacement", ("ground", "ball")),
            "coil": ("springs", "torsion", ("hub.f", "ball")),
            "touch": ("contacts", "plane", ("ground", "ball")),
        }
        assert found["clamp"].axis is None
        for name, axis in (("pivot", [0, 0, 1]), ("coil", [0, -1, 0]), ("lift", [0, 0, 1])):
            np.testing.assert_allclose(found[name].axis, axis, atol=1e-15)


def test_the_ground_frames_are_there(mechanism):
    for results in mechanism[:2]:
        np.testing.assert_array_equal(results.ground_frames["post"], [1.0, 2.0, 3.0])


def test_memory_and_file_have_the_same_outlines(mechanism):
    memory, file, _ = mechanism
    for body in memory.bodies:
        ours, theirs = memory.outline(body), file.outline(body)
        np.testing.assert_array_equal(ours.points, theirs.points)
        np.testing.assert_array_equal(ours.cells, theirs.cells[:, : ours.cells.shape[1]])
        assert (ours.node is None) == (theirs.node is None)


def test_bodies_of_one_superelement_share_an_outline(mechanism):
    assert mechanism[1].outline("beam") is mechanism[1].outline("twin")


def test_other_tools_read_the_group(mechanism):
    with h5netcdf.File(mechanism[2], "r") as file:
        space = file["space"]
        assert space["points"].dimensions == ("point", "axis")
        assert [name.decode() for name in space["body"][:]] == ["hub", "beam", "twin", "ball"]


def test_of_earlier_files_bodies_have_outlines_too(mechanism, recovered, tmp_path):
    old = tmp_path / "old.h5"
    old.write_bytes(mechanism[2].read_bytes())
    with h5py.File(old, "a") as file:
        del file["space"]
        file.attrs["version"] = 6
    results = Results.read(old)
    assert results.couplings == ()
    assert results.ground_frames == {}
    for body in ("hub", "ball"):
        assert results.outline(body).volume > 0.0
    lines = results.outline("beam")
    np.testing.assert_allclose(lines.points[1:, 0], [-0.25, 0.25], atol=1e-9)
    assert results.outline_source("beam") == "interfaces"
    given = Results.read(old, {"beam": recovered})
    assert given.outline_source("beam") == "recovery"
    assert given.outline("beam") is recovered.outline


def test_figures_are_where_a_body_has_them():
    cylinder = figures.cylinder(0.1, 1.0, np.array([1.0, 0, 0]), [0, 0, 2])
    np.testing.assert_allclose(cylinder.points.mean(axis=0), [0, 0, 2], atol=1e-12)
    np.testing.assert_allclose(np.ptp(cylinder.points, axis=0), [1.0, 0.2, 0.2], atol=1e-12)


def test_a_run_that_goes_on_keeps_its_outlines_whatever_shapes_are_now(recovered, tmp_path):
    path, model = tmp_path / "run.h5", cantilever(recovered, checkpoint={"every": 100})
    ball = RigidBody(1.0, [1, 1, 1], start=Start(position=[0, 0, 5]))
    model = replace(model, bodies={**model.bodies, "ball": replace(ball, shape=Box([1, 1, 1]))})
    simulate(model.with_settings(t_end=0.01), output=path)
    changed = replace(model, bodies={**model.bodies, "ball": replace(ball, shape=Box([2, 2, 2]))})
    results = simulate(changed, output=path, resume=True)
    assert results.time[-1] == pytest.approx(0.02)
    assert results.outline("ball").volume == pytest.approx(1.0)
    assert results.outline("beam").n_facets == 140


def test_a_run_that_starts_from_another_is_blended(recovered, tmp_path):
    model = cantilever(recovered, checkpoint={"every": 100})
    simulate(model, output=tmp_path / "first.h5")
    first = StartFrom(str(tmp_path / "first.h5"))
    later = model.with_settings(start=first, checkpoint=None, t_end=0.03)
    results = simulate(later)
    assert results.outline_source("beam") == "interfaces"
    assert results.outline_displacement("beam", results.time[0]).any()


def test_a_body_of_which_an_interface_was_not_recorded_has_no_displacements(recovered):
    output = OutputRequest(quantities=["bodies", "frames/beam.tip"])
    some = simulate(cantilever(recovered, output=output))
    assert some.outline_source("beam") == "rigid"
    assert some.outline_remark("beam").endswith("the run recorded 1 of its 2 interfaces")
    with pytest.raises(RecoveryError, match="no displacements: the run recorded 1 of its 2"):
        some.outline_field("beam", 0.0, "displacement")
