"""Three evaluators of one convolution: modes that carry the history, the sum over all past loads,
blocks by FFT.
"""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Cylindrical,
    Fixed,
    FlexibleBody,
    Force,
    Harmonic,
    Impulse,
    Model,
    ModelError,
    OutputRequest,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Spherical,
    Start,
    Torque,
    simulate,
)
from duhamel.solver.history import dyadic
from duhamel.superelement import StepWarning, sample_kernel

STEPS = 200


def tangle(first, second, third, **settings):
    """Three flexible bodies with different interfaces and a rigid one, joined, loaded from t = 0
    on.
    """
    place = Start(position=[0.0, 0.0, 0.0])
    bodies = {
        "a": FlexibleBody(first, Start(angular_velocity=[0.5, -1.0, 2.0])),
        "block": RigidBody(1.5, [1.0, 2.0, 1.5], {}, place),
        "b": FlexibleBody(
            second, Start(position=first.interface("i0").X - second.interface("i1").X)
        ),
        "c": FlexibleBody(third, Start(position=first.interface("i1").X - third.interface("i0").X)),
    }
    return Model(
        bodies=bodies,
        joints=(
            Revolute("a.i0", "b.i1", [0.3, 0.5, 1.0], name="ab"),
            Spherical("a.i1", "c.i0", name="ac"),
            Cylindrical(
                "block", "c.i2", third.interface("i2").X + bodies["c"].start.position, name="weld"
            ),
        ),
        loads=(
            Force("b.i0", [1.0, -2.0, 0.5], Constant(3.0)),
            Torque("a.i0", [0.2, 0.0, 1.0], Harmonic(2.0, 40.0, 1.0), follower=True),
            Force("c.i1", [0.0, 1.0, 0.0], Harmonic(5.0, 13.0, 1.0)),
        ),
        gravity=[0.0, 0.0, -9.81],
        settings=Settings(t_end=STEPS * 1e-3, step=1e-3, rho_inf=0.9, tolerance=1e-13, **settings),
    )


def damped(element):
    """The same modes, faster and with a fifth of critical damping."""
    modes = replace(
        element.modes,
        omega=element.modes.omega + 500.0,
        zeta=np.full(len(element.modes.omega), 0.2),
    )
    kernel = sample_kernel(modes, element.kernel.h, element.kernel.scheme, STEPS)
    return replace(element, modes=modes, kernel=kernel, compliance=modes.compliance)


def state(results):
    """Positions and elastic displacements over time. (Multipliers follow from them, over h^2.)"""
    return (
        np.hstack([results.body(name).x for name in "abc"]),
        np.hstack([results.frame(f"{name}.i{k}").u for name in "abc" for k in (0, 1)]),
    )


@pytest.fixture(scope="module")
def elements(random_element):
    return (
        random_element(1, (True, False)),
        random_element(2, (False, True), modes=5),
        random_element(3, (False, False, True), modes=12),
    )


@pytest.mark.parametrize("rule", ["consistent", "paper"])
def test_recursion_and_direct_sum_agree(elements, measured, rule):
    recursive = state(simulate(tangle(*elements, rule=rule, history="recursive")))
    for direct in (
        simulate(tangle(*elements, rule=rule, history="direct")),
        simulate(tangle(*(measured(element) for element in elements), rule=rule)),
        simulate(tangle(elements[0], measured(elements[1]), elements[2], rule=rule)),
    ):
        for found, expected in zip(state(direct), recursive, strict=True):
            assert np.abs(found - expected).max() < 1e-10 * np.abs(expected).max()


@pytest.mark.parametrize("block", [8, 64, 128])
@pytest.mark.parametrize("rule", ["consistent", "paper"])
def test_blocks_and_direct_sum_agree(elements, monkeypatch, rule, block):
    """Fast path against slow path: over 25, 3 and 1 blocks."""
    direct = state(simulate(tangle(*elements, rule=rule, history="direct")))
    monkeypatch.setattr(dyadic, "DIRECT_STEPS", block)
    for found, expected in zip(
        state(simulate(tangle(*elements, rule=rule, history="fft"))), direct, strict=True
    ):
        assert np.abs(found - expected).max() < 1e-10 * np.abs(expected).max()


@pytest.mark.parametrize("history", ["direct", "fft"])
def test_memory_let_go_changes_nothing(elements, monkeypatch, history):
    """Kernels of 60 lags in windows of 128 steps, which 200 steps outrun, against a window that
    holds them all.
    """
    monkeypatch.setattr(dyadic, "DIRECT_STEPS", 8)
    model = tangle(*(damped(element) for element in elements), history=history, kernel_length=0.06)
    short = state(simulate(model))
    monkeypatch.setattr(dyadic, "DIRECT_STEPS", 256)
    for found, expected in zip(short, state(simulate(model)), strict=True):
        assert np.abs(found - expected).max() < 1e-10 * np.abs(expected).max()


def test_a_memory_that_is_long_enough_gives_the_motion(elements):
    """Against modes, which forget nothing: the error falls with the decay of the slowest mode, and
    is stated.
    """
    given = [damped(element) for element in elements]
    expected = state(simulate(tangle(*given, history="recursive")))
    for memory in (0.06, 0.12):
        results = simulate(tangle(*given, history="direct", kernel_length=memory))
        stated = results.solver["truncation"]
        assert stated < 4.0 * np.exp(-0.75 * 100.0 * memory)
        for found, exact in zip(state(results), expected, strict=True):
            assert np.abs(found - exact).max() < stated * np.abs(exact).max()


def test_a_memory_too_short_is_refused(elements):
    with pytest.raises(
        ModelError, match=r"superelement 'random 1': memory: .* not decayed in 0\.02 s"
    ):
        simulate(tangle(*elements, history="direct", kernel_length=0.02))


def test_loads_at_rest_are_felt_beyond_any_memory(elements, monkeypatch):
    """A preload stays still though its beginning is out of the window."""
    monkeypatch.setattr(dyadic, "DIRECT_STEPS", 8)
    model = Model(
        bodies={"a": FlexibleBody(damped(elements[0]))},
        joints=(Fixed("ground", "a.i0", name="root"),),
        loads=(Force("a.i1", [0.0, 1.0, 0.0], Constant(2.0)),),
        settings=Settings(
            t_end=STEPS * 1e-3,
            step=1e-3,
            rho_inf=0.9,
            start="equilibrium",
            history="fft",
            kernel_length=0.06,
            tolerance=1e-13,
        ),
    )
    u = simulate(model).frame("a.i1").u
    assert np.abs(u - u[0]).max() < 1e-15  # m, the rounding of positions of about a meter


def test_the_rules_differ(elements):
    (_, consistent), (_, paper) = (
        state(simulate(tangle(*elements, rule=rule))) for rule in ("consistent", "paper")
    )
    assert np.abs(consistent - paper).max() > 1e-3 * np.abs(consistent).max()


def test_a_body_without_modes_cannot_be_recursive(elements, measured):
    model = tangle(*(measured(element) for element in elements), history="recursive")
    with pytest.raises(
        ModelError, match=r"body 'a': history 'recursive' needs modes, and .*'random 1' has none"
    ):
        simulate(model)


@pytest.mark.parametrize("history", ["recursive", "direct"])
def test_a_step_finer_than_the_modes_hold_for_is_told_once(history, random_element):
    """Two bodies of one superelement, at rest."""
    element = random_element(0, (True,))
    element = replace(element, modes=replace(element.modes, h_min=1e-3))
    bodies = {name: FlexibleBody(element, Start(position=[0.0, 0.0, 0.0])) for name in ("a", "b")}
    model = Model(
        bodies=bodies, settings=Settings(t_end=1e-3, step=5e-4, rho_inf=0.9, history=history)
    )
    with pytest.warns(
        StepWarning, match=r"modes for steps down to 0\.001 s.* asked for steps of 0\.0005 s"
    ) as told:
        simulate(model)
    assert len(told) == 1


def test_modes_that_have_died_out_come_to_rest(beam):
    """Denormal numbers, on which arithmetic is slow, are not what a long run ends with."""
    blow = Force("beam.tip", [1.0, 1.0, 1.0], Impulse(1e-4, at=0.0))
    model = Model(
        {"beam": FlexibleBody(beam.element)},
        loads=[blow],
        settings=Settings(t_end=1.0, step=1e-4, rho_inf=0.5, output=OutputRequest(every=10_000)),
    )
    simulator = Simulator(model, outputs=[])
    for _ in range(2000):
        simulator.step([])
    state = simulator.save().snapshot.arrays
    for name in ("eta", "rate", "acceleration", "a"):
        amplitudes = np.abs(state[f"state/modes/{name}"])
        assert amplitudes.max() > 1e-20
        assert (amplitudes == 0.0).any()
        assert amplitudes[amplitudes > 0.0].min() > 1e-200
