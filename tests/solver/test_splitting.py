"""One superelement, or several of the same mesh welded together: the same to first order in the
displacements.

Terms of second order differ: each piece has a floating frame of its own, which turns with it.
"""

import numpy as np
import pytest
from duhamel.solver import (
    Fixed,
    FlexibleBody,
    Force,
    Harmonic,
    Model,
    Settings,
    Start,
    simulate,
)

from .frameworks import framework

ROOT, FORK, TIP = (0.0, 0.0, 0.0), (0.25, 0.0, 0.0), (0.5, 0.0, 0.0)
LEFT, RIGHT = (0.25, -0.2, 0.0), (0.25, 0.2, 0.1)
BARS = {
    "bar": [(ROOT, FORK), (FORK, TIP)],
    "fork": [(ROOT, FORK), (FORK, TIP), (FORK, LEFT), (FORK, RIGHT)],
    "ring": [(ROOT, LEFT), (LEFT, TIP), (TIP, RIGHT), (RIGHT, ROOT)],
}


def placed(element):
    """The path of the mesh."""
    return FlexibleBody(element, Start(element.center))


def whole(bars, folder):
    """One body, clamped at the root; its frames by the points where bars end."""
    points = list(dict.fromkeys(point for ends in bars for point in ends))
    element = framework(folder, bars, {f"p{k}": point for k, point in enumerate(points)})
    frames = {point: f"body.p{k}" for k, point in enumerate(points)}
    return {"body": placed(element)}, [Fixed("ground", frames[ROOT], name="wall")], frames


def pieces(bars, folder):
    """A body for each bar, welded to the first that ends where it does."""
    bodies, frames = {}, {}
    joints = [Fixed("ground", "bar0.near", name="wall")]
    for k, (near, far) in enumerate(bars):
        bodies[f"bar{k}"] = placed(framework(folder, [(near, far)], {"near": near, "far": far}))
        for point, frame in ((near, f"bar{k}.near"), (far, f"bar{k}.far")):
            if point in frames:
                joints.append(Fixed(frames[point], frame, name=f"weld{len(joints)}"))
            else:
                frames[point] = frame
    return bodies, joints, frames


def swing(assembly, force):
    """Displacements of all points under a harmonic force at the tip."""
    bodies, joints, frames = assembly
    load = Force(frames[TIP], [0.2, 1.0, 0.7], Harmonic(force, 12.0))
    results = simulate(Model(bodies, joints, [load], settings=Settings(t_end=0.1)))
    positions = [results.frame(frame).position for frame in frames.values()]
    return np.hstack([position - position[0] for position in positions])


@pytest.mark.parametrize("shape", BARS)
def test_a_body_in_pieces_moves_as_a_whole_in_small_motion(shape, tmp_path):
    """Their difference falls with the square of the force, so to nothing in the linear limit, in
    loops too.
    """
    one, several = whole(BARS[shape], tmp_path), pieces(BARS[shape], tmp_path)
    moved, apart = [], []
    for force in (0.4, 0.04, 0.004):
        expected = swing(one, force)
        moved.append(np.abs(expected).max())
        apart.append(np.abs(swing(several, force) - expected).max())
    np.testing.assert_allclose(np.array(moved[:-1]) / moved[1:], 10.0, rtol=0.01)
    np.testing.assert_allclose(np.array(apart[:-1]) / apart[1:], 100.0, rtol=0.1)
    assert apart[-1] < 1e-4 * moved[-1]
