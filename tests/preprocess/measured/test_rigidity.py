"""Interfaces that bend: up to where they move as virtual points do."""

import numpy as np
import pytest
from duhamel.preprocess.identification.responses import Measurement
from duhamel.preprocess.measured.rigidity import (
    LARGEST_BENDING,
    doubts_of_rigidity,
    rigid_up_to,
)

F = np.arange(10.0, 4000.0, 2.0)
OWN = {"foot": slice(0, 6), "top": slice(6, 12)}


def bending(of, scale, place=0.0, seed=0):
    """Two interfaces of nine channels and nine hits, of which one bends by (f / scale)^2."""
    rng = np.random.default_rng(seed)
    outputs, inputs = np.zeros((18, 12)), np.zeros((18, 12))
    for k in (0, 1):
        block = slice(9 * k, 9 * k + 9), slice(6 * k, 6 * k + 6)
        outputs[block], inputs[block] = rng.standard_normal((2, 9, 6))
    motion = rng.standard_normal((12, 12))
    H = np.repeat((outputs @ motion @ inputs.T)[None], len(F), axis=0).astype(complex)
    if of:
        own, others = (outputs, inputs) if of == "channels" else (inputs, outputs)
        part = H[:, :9] if of == "channels" else H.transpose(0, 2, 1)[:, :9]
        # What no motion of the interface explains, by loads that the others know.
        null = np.linalg.svd(own[:9, :6].T)[2][6:].T
        shape = null @ rng.standard_normal((3, 12)) @ others.T
        shape *= np.linalg.norm(part[0]) / np.linalg.norm(shape)
        part += (F / scale)[:, None, None] ** 2 * shape
    H = H * (1.0 + place * rng.standard_normal(H.shape[1:]))
    return Measurement(2j * np.pi * F, H, outputs, inputs, np.zeros((12, 6)), np.eye(6))


@pytest.mark.parametrize("of", ["channels", "hits"])
def test_an_interface_is_rigid_up_to_where_its_bending_says(of):
    measured = bending(of, 3000.0)
    share = LARGEST_BENDING
    expected = 3000.0 * (share / np.sqrt(1.0 - share**2)) ** 0.5
    limits = rigid_up_to(measured, OWN)
    assert limits["foot"] == pytest.approx(expected, rel=0.02)
    (said,) = doubts_of_rigidity(measured, OWN)
    assert f"foot is no rigid piece above {limits['foot']:.0f} Hz: 20 % of what its {of}" in said
    assert limits["top"] == np.inf


def test_errors_of_places_are_no_bending():
    measured = bending("", 1.0, place=0.1)
    assert set(rigid_up_to(measured, OWN).values()) == {np.inf}
    # Errors that are as large at the lowest lines are those of wires or tables.
    assert not list(doubts_of_rigidity(bending("", 1.0, place=1.0), OWN))
    assert set(rigid_up_to(bending("", 1.0, place=1.0), OWN).values()) == {0.0}
