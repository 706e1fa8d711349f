"""A mass at the tip of a beam, in its superelement and as a body on a fixed joint: one motion where
it is small.

The two differ in what the method neglects, terms of second order in the displacements: in the
superelement the mass is seen at its place in the undeformed body, on the joint where it is.
"""

import numpy as np
import pytest
from duhamel.preprocess.body.body import PointMass
from duhamel.solver import (
    Cylindrical,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Impulse,
    Model,
    Place,
    Pulse,
    RigidBody,
    Settings,
    Start,
    Torque,
    simulate,
)

from .conftest import make_beam

MASS, INERTIA = 0.0021, [1e-8, 2e-8, 3e-8]


@pytest.fixture(scope="module")
def heavy_beam():
    return make_beam(masses={"tip": PointMass(mass=MASS, inertia=INERTIA, interface="tip")})


def tip_path(element, lumped, size):
    """Displacement of the tip over 0.25 s (n, 3) [m] under `size` times the loads of Case 5 of the
    paper.
    """
    bodies = {
        "hub": RigidBody(0.01, [0.00119, 0.00119, 0.00238], {"rim": Frame([0.05, 0, 0])}),
        "beam": FlexibleBody(element, Start(place=Place("root", "hub.rim"))),
    }
    joints = [
        Cylindrical("ground", "hub", [0, 0, 1], name="axis"),
        Fixed("hub.rim", "beam.root", name="clamp"),
    ]
    tip = "beam.tip"
    if not lumped:
        tip = "ball.center"
        bodies["ball"] = RigidBody(MASS, INERTIA, {"center": Frame()}, Start(position=[0.55, 0, 0]))
        joints.append(Fixed("beam.tip", "ball.center", name="weld"))
    loads = (
        Torque("hub", [0, 0, 1.8 * size], Pulse(1.0, 0.0, 0.1)),
        Force("hub", [0, 0, 2.5 * size], Pulse(1.0, 0.0, 0.1)),
        Force(tip, [size, -size, size], Impulse(0.02, 0.15)),
    )
    results = simulate(
        Model(bodies, tuple(joints), loads, settings=Settings(t_end=0.25, step=2e-4, rho_inf=0.7))
    )
    position = results.frame(tip).position
    return position - position[0]


def test_lumped_and_on_a_joint(beam, heavy_beam):
    difference = []
    for size in (1e-1, 1e-2, 1e-3, 1e-4):
        lumped, jointed = (
            tip_path(heavy_beam.element, True, size),
            tip_path(beam.element, False, size),
        )
        difference.append(np.abs(lumped - jointed)[:, 1:].max(axis=0))
    # Across the beam the difference is quadratic in the motion, down to the rounding of positions
    # of 0.55 m.
    orders = np.log10(np.array(difference[:-1]) / difference[1:])
    assert (orders > 1.9).all()
    assert np.max(difference[-1]) < 3e-14
