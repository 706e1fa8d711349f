"""Bodies under load in equilibrium stay where they are, to rounding: nothing rings at t = 0."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Force,
    Frame,
    Model,
    Revolute,
    Settings,
    Spring,
    Start,
    simulate,
)

from .frameworks import bar
from .linkages import ANGLE, X, Z, four_bar, pins

STEPS = 1000


def on_springs(folder):
    """A beam on a bushing that is pressed at the start, pulled by a stretched spring."""
    beam = bar(folder, 0.5, steps=STEPS)
    pressed = [-1e-3, 2e-3, 1e-3, 1e-3, -2e-3, 1e-3]
    stiffness = [1e4, 1e4, 1e4, 10.0, 10.0, 10.0]
    return Model(
        bodies={"beam": FlexibleBody(beam, Start(-beam.interface("left").X))},
        springs=(
            Spring(
                "bush", "bushing", ("ground", "beam.left"), X, stiffness=stiffness, rest=pressed
            ),
            Spring(
                "coil",
                "point",
                ("ground.hook", "beam.right"),
                stiffness=40.0,
                damping=0.1,
                rest=0.1,
            ),
        ),
        ground_frames={"hook": Frame([0.6, 0.1, 0.3])},
    )


def between_walls(folder):
    """Two beams on hinges, with both ends held: they sag, and pull at each other and at
    the walls.
    """
    beam = bar(folder, 0.3, stiffness=0.05, steps=STEPS)
    y = [0.0, 1.0, 0.0]
    return Model(
        bodies={
            "a": FlexibleBody(beam, Start([0.15, 0, 0])),
            "b": FlexibleBody(beam, Start([0.45, 0, 0])),
        },
        joints=(
            Revolute("ground", "a.left", y, name="A"),
            Revolute("a.right", "b.left", y, name="B"),
            Revolute("b.right", "ground", y, name="C"),
        ),
    )


def wound_four_bar(folder):
    """A torsion spring on the crank and a constant force on the rocker bend a four-bar against each
    other.
    """
    C = pins(ANGLE)[1]
    return four_bar(
        folder,
        springs=(
            Spring("coil", "torsion", ("ground.A", "crank.pin"), Z, stiffness=0.3, rest=[0.2]),
        ),
        loads=(Force("rocker.left", np.cross(Z, C), Constant(1.0)),),
    )


@pytest.mark.parametrize(
    ("history", "rule"),
    [("recursive", "consistent"), ("direct", "consistent"), ("recursive", "paper")],
)
@pytest.mark.parametrize("make", [on_springs, between_walls, wound_four_bar])
def test_a_preload_stays_still(make, history, rule, tmp_path):
    """Over 1000 steps, to 1e-12 of the size of the model, although the bodies are bent.

    Eq. (55), which creates energy, makes even rounding grow: over 300 steps.
    """
    steps = 300 if rule == "paper" else STEPS
    model = replace(make(tmp_path), gravity=[0.0, 0.0, -9.81])
    settings = Settings(
        t_end=steps * 2e-4, step=2e-4, rho_inf=0.9, start="equilibrium", history=history, rule=rule
    )
    results = simulate(model, settings)
    frames = [
        results.frame(f"{name}.{end}")
        for name in model.flexible_bodies
        for end in ("left", "right")
    ]
    assert len(results.time) == steps + 1
    assert min(np.abs(frame.u).max() for frame in frames) > 1e-3
    size = max(float(np.abs(frame.position).max()) for frame in frames)
    moved = max(float(np.abs(frame.position - frame.position[0]).max()) for frame in frames)
    assert moved < 1e-12 * size
    for energy in (results.energy.elastic, results.energy.springs):
        np.testing.assert_allclose(energy, energy[0], rtol=0, atol=1e-12)
