"""The elastic energy from the work of interface loads and from the modes themselves."""

import numpy as np
import pytest
from duhamel.solver import FlexibleBody, Harmonic, Load, Steps, simulate

from .models import model_of


def energies(model):
    """The elastic energy of a beam: from the work, and from the modes (n,) [J]."""
    energy = simulate(model).energy
    return energy.elastic, energy.modal


def turned(on, signal):
    return (Load("torque", on, [0, 0, 1], signal),)


def test_without_numerical_dissipation_both_are_one(beam):
    """At rho_inf = 1 the mean of the loads over a step times the displacement is what the modes
    take up, but for the rounding of 5000 sums. A free beam: joints need some dissipation.
    """
    torque = turned("beam.root", Steps((0.0, 0.05, 0.15, 0.2), (1.0, 0.0, -1.0, 0.0)))
    bodies = {"beam": FlexibleBody(beam.element)}
    elastic, modal = energies(model_of(bodies, loads=torque, t_end=0.3, rho_inf=1.0))
    np.testing.assert_allclose(modal, elastic, rtol=0, atol=1e-13 * elastic.max())


def test_numerical_dissipation_is_what_they_differ_by(beam, hub_and_beam):
    """The modes hold less than the loads have put in; for smooth loads both agree by order two."""
    model, missing = hub_and_beam(beam, 0.5, loads=turned("hub", Harmonic(1.0, 5.0)), t_end=0.3), []
    for h in (6e-5, 1.2e-4, 2.4e-4):
        elastic, modal = energies(model.with_settings(step=h, rho_inf=0.9))
        missing.append((elastic - modal).max())
    assert missing[0] < 1e-8 * elastic.max()
    assert np.log2(missing[1:]) - np.log2(missing[:-1]) == pytest.approx([2.0, 2.0], abs=0.1)
