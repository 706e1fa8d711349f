"""Fields from recorded loads: at the interfaces they are what the run itself recorded."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Harmonic,
    Joint,
    Load,
    Model,
    RecoveryError,
    Results,
    Start,
    SteadyRotation,
    simulate,
)
from duhamel.superelement import Recovery, write

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
    """A hub that turns under a torque; the tip of its beam is pushed in space and twisted, from the start on."""
    model = hub_and_beam(beam, 0.5, pivot="spherical", spin=(0.0, 3.0, 20.0), t_end=0.05, step=2e-4, **settings)
    loads = (
        Load("torque", "hub", [0.3, 0.0, 1.0], Constant(1.0)),
        Load("force", "beam.tip", [0.0, 0.5, 1.0], Constant(1.0)),
        Load("torque", "beam.tip", [0.1, 0.05, -0.1], Constant(1.0), follower=True),
    )
    element = watched(model.bodies["beam"].superelement)
    bodies = {**model.bodies, "beam": replace(model.bodies["beam"], superelement=element)}
    return replace(model, bodies=bodies, loads=loads)


@RULES
@HISTORIES
def test_the_field_at_the_interfaces_is_what_the_run_recorded(coarse_beam, hub_and_beam, rule, history):
    assert_recorded(simulate(spun(coarse_beam, hub_and_beam, rule=rule, history=history)))


@RULES
@HISTORIES
def test_the_same_from_equilibrium(coarse_beam, rule, history):
    """A cantilever under gravity and a tip force that begins to oscillate about what it was in equilibrium."""
    model = Model(
        bodies={"beam": FlexibleBody(watched(coarse_beam.element), Start(position=[0.25, 0, 0]))},
        joints=[Joint("clamp", "fixed", ("ground", "beam.root"))],
        loads=[Load("force", "beam.tip", [0.3, 1, -1], Harmonic(1.0, 30.0, offset=1.0))],
        gravity=[0, 0, -9.81],
        t_end=0.05,
        step=2e-4,
        start="equilibrium",
        rule=rule,
        history=history,
    )
    assert_recorded(simulate(model))


def test_the_same_from_a_steady_rotation(coarse_beam):
    """The root is on the axis, and the tip is pushed from the start on."""
    spin = 30.0
    model = Model(
        bodies={"beam": FlexibleBody(watched(coarse_beam.element), Start(position=[0.25, 0, 0]))},
        joints=[Joint("pivot", "revolute", ("ground", "beam.root"), axis=[0, 0, 1])],
        loads=[Load("force", "beam.tip", [0, 0, 1], Harmonic(0.5, 30.0, offset=0.5), follower=True)],
        t_end=0.05,
        step=2e-4,
        start="equilibrium",
        steady_rotation=SteadyRotation([0, 0, spin]),
    )
    assert_recorded(simulate(model))


@pytest.fixture(scope="module")
def spinning(coarse_beam, hub_and_beam):
    return simulate(spun(coarse_beam, hub_and_beam))


def test_positions_in_space_are_those_of_the_frames(spinning):
    expected = np.stack([spinning.frame(f"beam.{name}").position for name in INTERFACES], axis=1)
    np.testing.assert_allclose(spinning.position("beam", spinning.time), expected, rtol=0, atol=1e-13)


def test_fields_are_linear_between_steps(spinning):
    t = spinning.time[[100, 101]]
    before, after = spinning.displacement("beam", t)
    between = spinning.displacement("beam", 0.25 * t[0] + 0.75 * t[1])
    np.testing.assert_allclose(between, 0.25 * before + 0.75 * after, rtol=0, atol=1e-12 * np.abs(after).max())


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
    with pytest.raises(RecoveryError, match=r"body 'beam': superelement .* holds no recovery.* table \[recovery\]"):
        results.displacement("beam", 0.0)
    with pytest.raises(RecoveryError, match="the run has no flexible body 'hub'"):
        results.displacement("hub", 0.0)
    bare = watched(coarse_beam.element)
    bare = replace(bare, recovery=replace(bare.recovery, stress=None))
    with_shape = replace(model, bodies={**model.bodies, "beam": replace(model.bodies["beam"], superelement=bare)})
    with pytest.raises(RecoveryError, match="body 'beam': recovery: no stress modes"):
        simulate(with_shape).stress("beam", 0.0)


def test_results_that_are_read_find_their_superelement(coarse_beam, hub_and_beam, tmp_path):
    model, path = spun(coarse_beam, hub_and_beam), tmp_path / "beam.h5"
    element = model.bodies["beam"].superelement
    write(path, element)
    body = replace(model.bodies["beam"], source=str(path))
    of_file = replace(model, bodies={**model.bodies, "beam": body}, t_end=0.002)
    expected = simulate(of_file, tmp_path / "out.h5").displacement("beam", 0.002)
    assert np.abs(expected).max() > 0.0

    def again(**given):
        return Results.read(tmp_path / "out.h5", **given).displacement("beam", 0.002)

    np.testing.assert_array_equal(again(), expected)
    write(path, replace(element, name="another"))
    with pytest.raises(
        RecoveryError, match=r"body 'beam': .*beam.h5 has changed since the run: expected SHA-256 \w{64}"
    ):
        again()
    path.unlink()
    with pytest.raises(RecoveryError, match=r"beam.h5, the file of its superelement, is gone: give it to Results.read"):
        again()
    np.testing.assert_array_equal(again(superelements={"beam": element}), expected)

    simulate(replace(model, t_end=0.002), tmp_path / "out.h5")
    with pytest.raises(RecoveryError, match="body 'beam': the run read no file for its superelement"):
        again()
