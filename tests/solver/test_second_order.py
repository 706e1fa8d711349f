"""Terms of second order: inertia, foreshortening and stiffening of bodies that turn fast."""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Harmonic,
    Joint,
    Load,
    Model,
    RigidBody,
    Settings,
    Spring,
    Start,
)

from .test_tangents import Point, assert_newton_matrix, symmetric

AXIS = np.array([1.0, 2.0, 2.0]) / 3.0


@pytest.fixture(scope="module")
def bodies(random_element):
    """Two bodies with terms of second order, whose first interfaces meet, and a rigid one."""

    def body(seed, r):
        element = random_element(seed, (True, False), second_order=r)
        return FlexibleBody(element, Start(-element.interface("i0").X))

    return {"a": body(5, 3), "b": body(6, 4), "c": RigidBody(1.5, [1.0, 2.0, 1.5])}


def test_the_newton_matrix(bodies):
    """Entry by entry, with a bushing, a hinge that is driven, and loads that follow."""
    bushing = Spring(
        "bush",
        "bushing",
        ("a.i0", "b.i0"),
        stiffness=symmetric(1, 50.0),
        damping=symmetric(2, 0.5),
    )
    model = Model(
        bodies,
        (Joint("hinge", "revolute", ("ground", "a.i0"), AXIS, angle=Harmonic(0.8, 1.0, 0.5)),),
        (Load("force", "b.i1", [1.0, 2.0, -1.0], Constant(1.0), follower=True),),
        (bushing,),
        settings=Settings(t_end=1.0, step=1e-2, rho_inf=0.8),
    )
    point = Point.of(model, seed=11)
    rng = np.random.default_rng(12)
    work, interfaces = point.work, point.state.interfaces
    work.interfaces.u_predicted[:] = interfaces.u + rng.uniform(-1e-3, 1e-3, len(interfaces.u))
    work.interfaces.rate_predicted[:] = rng.uniform(-1.0, 1.0, len(interfaces.u))
    point.evaluated()
    assert_newton_matrix(point)
