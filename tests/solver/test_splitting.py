"""One superelement, or several of the same mesh welded together: the same to first order in the displacements.

Second-order terms differ: each floating frame turns with its own piece, as one of them could not.
"""

import numpy as np
import pytest
from duhamel.solver import FlexibleBody, Harmonic, Joint, Load, Model, Start, simulate

from .frameworks import framework

ORIGIN, MIDDLE, END = (0.0, 0.0, 0.0), (0.25, 0.0, 0.0), (0.5, 0.0, 0.0)
LEFT, RIGHT = (0.25, -0.2, 0.0), (0.25, 0.2, 0.1)
PIECES = {
    "bar": {"stem": (ORIGIN, MIDDLE), "end": (MIDDLE, END)},
    "fork": {"stem": (ORIGIN, MIDDLE), "end": (MIDDLE, END), "left": (MIDDLE, LEFT), "right": (MIDDLE, RIGHT)},
}


def placed(element):
    """Where the mesh is."""
    return FlexibleBody(element, Start(element.center))


def whole(shape, folder):
    ends = PIECES[shape]
    interfaces = {"root": ORIGIN} | {name: q for name, (_, q) in ends.items() if name != "stem"}
    element = framework(folder, list(ends.values()), interfaces, step=2e-4)
    return {"whole": placed(element)}, [Joint("wall", "fixed", ("ground", "whole.root"))]


def split(shape, folder):
    bodies = {
        name: placed(framework(folder, [(p, q)], {"near": p, "far": q}, step=2e-4))
        for name, (p, q) in PIECES[shape].items()
    }
    joints = [Joint("wall", "fixed", ("ground", "stem.near"))]
    joints += [Joint(f"weld {name}", "fixed", ("stem.far", f"{name}.near")) for name in bodies if name != "stem"]
    return bodies, joints


def tips(made, force, frames):
    """Displacements of the far ends under a swinging force at the first of them."""
    bodies, joints = made
    load = Load("force", frames[0], [0.2, 1.0, 0.7], Harmonic(force, 12.0))
    results = simulate(Model(bodies, joints, [load], t_end=0.1, rho_inf=0.9))
    positions = [results.frame(name).position for name in frames]
    return np.hstack([position - position[0] for position in positions])


@pytest.mark.parametrize("shape", PIECES)
def test_a_body_in_pieces_moves_as_a_whole_in_small_motion(shape, tmp_path):
    """Their difference falls with the square of the force, so to nothing in the linear limit."""
    ends = [name for name in PIECES[shape] if name != "stem"]
    apart = []
    for force in (0.4, 0.04, 0.004):
        expected = tips(whole(shape, tmp_path), force, [f"whole.{name}" for name in ends])
        found = tips(split(shape, tmp_path), force, [f"{name}.far" for name in ends])
        apart.append(np.abs(found - expected).max())
    np.testing.assert_allclose(np.array(apart[:-1]) / apart[1:], 100.0, rtol=0.1)
