"""The energy of flexible bodies: what they store, and what damping and time stepping take."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Force,
    Harmonic,
    Steps,
    Torque,
    simulate,
)
from duhamel.superelement import GeneralizedAlpha, Interface, Modes, Superelement, sample_kernel

from .models import model_of


def turned(on, signal):
    return (Torque(on, [0, 0, 1], signal),)


def test_without_numerical_dissipation_modes_store_what_loads_put_in(beam):
    """At rho_inf = 1 the mean of the loads over a step times the displacement is what the modes
    take up, but for the rounding of 5000 sums. A free beam: joints need some dissipation.
    """
    torque = turned("beam.root", Steps((0.0, 0.05, 0.15, 0.2), (1.0, 0.0, -1.0, 0.0)))
    bodies = {"beam": FlexibleBody(beam.element)}
    energy = simulate(model_of(bodies, loads=torque, t_end=0.3, rho_inf=1.0)).energy
    assert np.abs(energy.numerical).max() < 1e-13 * energy.elastic.max()


def test_numerical_dissipation_is_of_order_two(beam, hub_and_beam):
    """The modes hold less than the loads have put in, for smooth loads."""
    model, missing = hub_and_beam(beam, 0.5, loads=turned("hub", Harmonic(1.0, 5.0)), t_end=0.3), []
    for h in (6e-5, 1.2e-4, 2.4e-4):
        energy = simulate(model.with_settings(step=h, rho_inf=0.9)).energy
        missing.append(energy.numerical.max())
    assert missing[0] < 1e-8 * energy.elastic.max()
    assert np.log2(missing[1:]) - np.log2(missing[:-1]) == pytest.approx([2.0, 2.0], abs=0.1)


def damped(zeta, omega=100.0):
    modes = Modes(np.array([omega]), np.array([zeta]), np.array([[1.0], [0.0], [0.0]]))
    return Superelement(
        name="damped",
        mass=1.0,
        J_rot=np.eye(3),
        center=np.zeros(3),
        interfaces=(Interface("point", np.zeros(3), False),),
        kernel=sample_kernel(modes, 1e-3, GeneralizedAlpha(0.9), 3),
        modes=modes,
        compliance=modes.compliance,
        accelerance=modes.accelerance,
    )


def held(zeta, **settings):
    """Under a constant force of 3 N from t = 0 on, until all vibration has gone."""
    loads = (Force("body.point", [1, 0, 0], Constant(3.0)),)
    model = model_of({"body": FlexibleBody(damped(zeta))}, loads=loads, t_end=2.0, **settings)
    return simulate(model).energy


@pytest.mark.parametrize("rho_inf", [0.5, 0.9, 1.0])
@pytest.mark.parametrize("zeta", [0.1, 0.5, 1.5])
def test_modal_damping_takes_half_of_what_a_sudden_load_puts_in(zeta, rho_inf):
    """F^2 / k, of which half is stored in the end: exact. It counts as dissipated, not elastic."""
    energy, half = held(zeta, step=1e-4, rho_inf=rho_inf), 0.5 * 3.0**2 / 100.0**2
    assert energy.elastic[-1] == pytest.approx(half, rel=1e-6)
    assert energy.dissipated[-1] == pytest.approx(half, rel=2e-3)
    assert np.all(np.diff(energy.dissipated) >= 0.0)


def test_the_dissipation_of_modes_converges_to_the_exact_one():
    """Of an oscillator at rest under a sudden load, while it swings: by order two."""
    zeta, omega = 0.05, 100.0
    damped_omega, errors = omega * np.sqrt(1.0 - zeta**2), []
    for h in (2e-3, 1e-3, 5e-4):
        model = model_of(
            {"body": FlexibleBody(damped(zeta))},
            loads=(Force("body.point", [1, 0, 0], Constant(1.0)),),
            t_end=0.1,
            step=h,
            rho_inf=0.9,
        )
        results = simulate(model)
        t = np.linspace(0.0, 0.1, 200_001)
        rate = np.exp(-zeta * omega * t) * np.sin(damped_omega * t) / damped_omega
        power = 2.0 * zeta * omega * rate**2
        exact = float(np.trapezoid(power, t))
        errors.append(abs(results.energy.dissipated[-1] - exact) / exact)
    assert errors[-1] < 1e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.3)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("rho_inf", [0.5, 0.9, 1.0])
def test_balances_of_damped_bodies_close_to_rounding(rho_inf):
    """A free body: what the load does is stored, moves, was damped, or lost in the scheme."""
    energy = held(0.2, step=1e-3, rho_inf=rho_inf)
    closed = energy.kinetic + energy.elastic + energy.dissipated + energy.numerical - energy.work
    np.testing.assert_allclose(energy.balance, closed - closed[0], rtol=0, atol=1e-14)
    # of the rigid motion alone, whose work is its kinetic energy, exactly at rho_inf = 1
    error = np.abs(energy.balance).max() / energy.work.max()
    assert error < (1e-13 if rho_inf == 1.0 else 1e-2)
    lost = np.abs(energy.numerical).max() / energy.elastic.max()
    assert lost < 1e-13 if rho_inf == 1.0 else lost > 1e-6


def test_a_body_without_modes_keeps_what_damping_took_in_its_elastic_energy(coarse_beam, measured):
    """Only the work of its loads is known; together with modes the sums agree."""
    loads = turned("beam.root", Constant(1e-3))
    sums = []
    for element in (coarse_beam.element, measured(coarse_beam.element)):
        model = model_of({"beam": FlexibleBody(element)}, loads=loads, t_end=0.06)
        energy = simulate(replace(model)).energy
        sums.append(energy.elastic + energy.dissipated + energy.numerical)
    np.testing.assert_allclose(sums[0], sums[1], rtol=0, atol=1e-9 * sums[0].max())
    assert np.all(energy.numerical == 0.0)
    assert np.all(energy.dissipated == 0.0)
