"""A mechanism seen from elsewhere moves as it does from here: turned, a kilometer away, with its
parts in another order, in other units.
"""

import numpy as np
from duhamel.solver import simulate
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ..transformed import Units, reordered, rescaled, turned
from .bounds import apart, bounds_apart
from .mechanisms import between, directions, mechanisms, run, vectors

UNTURNED = Rotation.identity()


def assert_within(found, limits):
    assert (np.array(found) <= [limits.position, limits.velocity, limits.force]).all(), (
        f"position, velocity, force: {found}; expected at most {limits}"
    )


@given(mechanisms(), directions(), between(0.1, 3.1), vectors(0.5))
def test_a_turned_mechanism_moves_turned(model, axis, angle, shift):
    """With gravity and loads; what is given in the axes of a frame goes along."""
    Q = Rotation.from_rotvec(angle * axis)
    here, there = run(model), simulate(turned(model, Q, shift))
    assert_within(apart(here, there, model, Q, shift), bounds_apart(model, here))


@given(mechanisms(), directions())
def test_a_kilometer_away_a_mechanism_moves_as_here(model, direction):
    """To the rounding of coordinates of a kilometer."""
    shift = 1000.0 * direction
    here, there = run(model), simulate(turned(model, UNTURNED, shift))
    assert_within(apart(here, there, model, shift=shift), bounds_apart(model, here, reach=1000.0))


@given(mechanisms(), st.randoms(use_true_random=False))
def test_the_order_of_parts_does_not_matter(model, order):
    here, there = run(model), simulate(reordered(model, order))
    assert_within(apart(here, there, model), bounds_apart(model, here))


@st.composite
def units(draw):
    """From millimeters to kilometers, grams to tonnes, milliseconds to minutes."""
    return Units(
        *(10.0 ** draw(st.integers(-3, 3)) for _ in range(2)), 10.0 ** draw(st.integers(-3, 2))
    )


@given(mechanisms(), units())
def test_units_do_not_matter(model, units):
    here, there = run(model), simulate(rescaled(model, units))
    assert_within(apart(here, there, model, units=units), bounds_apart(model, here))
