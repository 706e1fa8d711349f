"""Runs of many steps: memory does not grow, joints stay closed, energy stays bounded.

Ten million steps of a machine that is driven and damped, and of one that flies; a hundred thousand
of two hundred bodies. Minutes each: `make soak`, which prints the figures.
"""

import threading
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest
from duhamel.preprocess import build, read_body
from duhamel.solver import (
    FlexibleBody,
    Frame,
    Harmonic,
    Model,
    OutputRequest,
    Revolute,
    RigidBody,
    Settings,
    Spherical,
    Start,
    Torque,
    read_model,
    simulate,
)

from ..solver.frameworks import bar

pytestmark = pytest.mark.soak

ROOT = Path(__file__).parents[2]
ROWS = 1000
MEGABYTE = 1024**2
GROWTH = 8 * MEGABYTE
"""what a run may take between its first tenth and its end: rows are written, blocks are reused"""


@contextmanager
def memory(seconds=0.2):
    """A list that the memory of this process goes to while the block runs [bytes]."""
    found, over, process = [], threading.Event(), psutil.Process()

    def watch():
        while not over.wait(seconds):
            found.append(process.memory_info().rss)

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield found
    finally:
        over.set()
        thread.join()


def long_run(model, steps, folder):
    """The results of so many steps, which must not take memory as they go on."""
    step = model.settings.step
    output = OutputRequest(every=steps // ROWS)
    settings = replace(model.settings, t_end=steps * step, output=output)
    with memory() as used:
        results = simulate(model, settings, output=folder / "soak.h5")
    early, late = used[len(used) // 10], max(used[-len(used) // 10 :])
    print(
        f"\n{steps} steps in {results.solver['seconds']:.0f} s; memory {early / MEGABYTE:.1f} MB "
        f"after a tenth, {late / MEGABYTE:.1f} MB at the end"
    )
    assert late - early < GROWTH
    return results


def opening(results, model):
    """The largest distance between the frames of joints that hold them together [m]."""
    apart = 0.0
    for joint in model.joints:
        first, second = joint.between
        if first != "ground":
            gap = results.frame(first).position - results.frame(second).position
            apart = max(apart, np.abs(gap).max())
    print(f"joints open by {apart:.1e} m at most")
    return apart


def test_ten_million_steps_of_a_damped_beam_on_a_hub(tmp_path):
    """Case 2, with a hundredth of modal damping, under a torque that goes to and fro."""
    beam = build(read_body(ROOT / "meshes" / "beam" / "beam.toml"))
    damped = replace(beam, modes=replace(beam.modes, zeta=np.full_like(beam.modes.zeta, 0.01)))
    case = read_model(ROOT / "examples" / "case2.toml")
    model = replace(
        case,
        bodies=case.bodies | {"beam": replace(case.bodies["beam"], superelement=damped)},
        loads=(Torque("hub", [0, 0, 1], Harmonic(1.0, 5.0, np.pi / 2)),),
        settings=Settings(t_end=1.0, step=6e-5),
    )
    results = long_run(model, 10_000_000, tmp_path)
    energy = results.energy
    moving = energy.kinetic + energy.elastic
    late = moving[len(moving) // 2 :].max() / moving[: len(moving) // 2].max()
    print(f"largest energy of the second half over that of the first: {late:.6f}")
    print(
        f"balance within {np.abs(energy.balance).max():.2e} J of work {np.ptp(energy.work):.2e} J"
    )
    assert late < 1.01
    assert opening(results, model) < 1e-9


def test_ten_million_steps_of_two_bodies_that_fly(tmp_path):
    """Two bars that bend, on a spherical joint, tumbling without damping or loads."""
    link = bar(tmp_path, 0.2, elements=2, stiffness=0.05)
    spins = ([3.0, 2.0, 4.0], [-1.0, 3.0, -2.0])
    model = Model(
        {
            name: FlexibleBody(link, Start([0.1 + 0.2 * k, 0, 0], angular_velocity=spins[k]))
            for k, name in enumerate("ab")
        },
        [Spherical("a.right", "b.left", name="ball")],
        settings=Settings(t_end=1.0, step=2e-4, rho_inf=0.9),
    )
    results = long_run(model, 10_000_000, tmp_path)
    energy = results.energy.kinetic + results.energy.elastic
    linear, speed = results.momentum.linear, np.abs(results.body("a").v[:, :3]).max()
    drift = np.abs(linear - linear[0]).max() / (2 * link.mass * speed)
    lowest, highest = energy.min() / energy[0], energy.max() / energy[0]
    print(f"energy over that of the start: {lowest:.6f} to {highest:.6f}")
    print(f"linear momentum moved by {drift:.1e} of mass and speed")
    assert energy.max() < 1.01 * energy[0]
    assert drift < 1e-9
    assert opening(results, model) < 1e-9


def test_a_hundred_thousand_steps_of_two_hundred_bodies(tmp_path):
    """A hanging chain of rigid and flexible links that swings, released at a small angle."""
    link, n = bar(tmp_path, 0.1, elements=2), 200
    down, tilt = np.array([0.0, 0.0, -1.0]), [0.0, np.pi / 2 - 0.02, 0.0]
    along = np.array([np.sin(0.02), 0.0, -np.cos(0.02)])
    frames = {"left": Frame([-0.05, 0, 0]), "right": Frame([0.05, 0, 0])}
    rigid = RigidBody(0.01, [1e-6, 1e-5, 1e-5], frames)
    bodies = {
        f"b{k}": replace(
            rigid if k % 2 else FlexibleBody(link), start=Start((0.1 * k + 0.05) * along, tilt)
        )
        for k in range(n)
    }
    supports = ["ground", *(f"b{k}.right" for k in range(n - 1))]
    joints = [
        Revolute(support, f"b{k}.left", [0, 1, 0], name=f"j{k}")
        for k, support in enumerate(supports)
    ]
    model = Model(
        bodies, joints, gravity=9.81 * down, settings=Settings(t_end=1.0, step=2e-4, rho_inf=0.9)
    )
    results = long_run(model, 100_000, tmp_path)
    balance = results.energy.balance
    moving = np.ptp(results.energy.potential)
    print(f"balance {balance.min():.2e} to {balance.max():.2e} J; {moving:.2e} J move")
    assert balance.max() < 1e-3 * moving
    assert opening(results, model) < 1e-9
