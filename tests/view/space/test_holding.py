"""By which frames bodies are held, and what deforms as it is seen from there."""

from types import SimpleNamespace

import numpy as np
from duhamel.results import Connection
from duhamel.view.space.holding import Hold, holding_frames
from duhamel.view.space.tracks import Track


def held(*joints, bearings=()):
    couplings = [Connection(f"{a}-{b}", "joints", kind, (a, b)) for a, kind, b in joints]
    couplings += [Connection(f"{a}-{b}", "bearings", "bearing", (a, b)) for a, b in bearings]
    return holding_frames(SimpleNamespace(couplings=couplings))


def test_a_connecting_rod_is_held_by_both_its_pins():
    found = held(
        ("ground", "revolute", "crank"),
        ("crank.pin", "cylindrical", "rod.big_end"),
        ("rod.small_end", "spherical", "piston"),
        ("ground", "prismatic", "piston"),
    )
    assert found["rod"] == ("rod.big_end", "rod.small_end")


def test_what_hangs_on_a_body_does_not_hold_it():
    found = held(("ground", "revolute", "arm.root"), ("arm.tip", "fixed", "tool"))
    assert found == {"arm": ("arm.root",), "tool": ("tool",)}


def test_a_clamp_holds_alone():
    found = held(("ground", "fixed", "beam.root"), ("ground", "spherical", "beam.tip"))
    assert found["beam"] == ("beam.root",)


def test_a_rotor_is_held_by_its_bearings_and_by_the_coupling_that_turns_it():
    found = held(
        ("ground", "revolute", "motor"),
        ("motor", "universal", "rotor.left"),
        ("ground", "prismatic", "pedestal"),
        bearings=[("pedestal", "rotor.left"), ("ground.right", "rotor.right")],
    )
    assert found["rotor"] == ("rotor.left", "rotor.right")


def frame(X, u):
    k = len(u)
    still = np.tile([1.0, 0.0, 0.0, 0.0], (k, 1))
    return Track(np.tile(X, (k, 1)) + u[:, :3], still, "rod", u)


def test_seen_from_its_pins_a_rod_that_turned_and_stretched_has_only_stretched():
    places = np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]])
    moved, turned = np.array([1e-3, 2e-3, 3e-3]), np.array([0, 2e-3, -1e-3])
    stretched = 2e-4 * places
    u = np.hstack([moved + np.cross(turned, places) + stretched, np.full((2, 3), 0.3)])
    body = Track(np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0, 0.0]]), "rod")
    hold = Hold(body, [frame(X, row[None]) for X, row in zip(places, u, strict=True)])
    seen = hold.seen(u[None, :, :3], places, slice(None))
    np.testing.assert_allclose(seen[0], stretched, atol=1e-15)
