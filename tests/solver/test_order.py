"""The order of the two convolution rules, and the size of their errors (docs/theory.md, Impulse
responses).
"""

import numpy as np
import pytest
from duhamel.solver import (
    Function,
    Torque,
    simulate,
)

STEPS = np.array([4e-4, 2e-4, 1e-4, 5e-5])
T_END = 0.1


def torque(t):
    return np.sin(np.pi * t / 0.05) ** 2 if t < 0.05 else 0.0


def hub_angle(beam, hub_and_beam, h, rho_inf, rule):
    """The angle of the hub at multiples of the longest step."""
    model = hub_and_beam(
        beam,
        0.5,
        loads=(Torque("hub", [0, 0, 1], Function(torque)),),
        t_end=T_END,
        step=h,
        rho_inf=rho_inf,
        rule=rule,
    )
    R = simulate(model).body("hub").R[:: round(STEPS[0] / h)]
    return 2.0 * np.arctan2(R[:, 3], R[:, 0])


@pytest.fixture(scope="module")
def exact(beam, hub_and_beam):
    """Of error 2e-8: a hundredth of the smallest that is measured."""
    return hub_angle(beam, hub_and_beam, 5e-6, 0.9, "consistent")


@pytest.mark.parametrize(
    ("rule", "rho_inf", "order", "largest", "smallest"),
    [
        ("consistent", 0.9, (1.9, 2.1), 1.29e-4, 2.02e-6),
        ("consistent", 0.5, (1.9, 2.1), 1.91e-4, 2.99e-6),
        ("paper", 0.9, (0.85, 1.1), 5.08e-3, 7.06e-4),
        ("paper", 0.5, (0.85, 1.1), 5.09e-3, 7.06e-4),
    ],
)
def test_the_order_of_a_rule(beam, hub_and_beam, exact, rule, rho_inf, order, largest, smallest):
    angles = [hub_angle(beam, hub_and_beam, h, rho_inf, rule) for h in STEPS]
    errors = np.array([np.abs(angle - exact).max() for angle in angles]) / np.abs(exact).max()
    orders = np.log2(errors[:-1] / errors[1:])
    assert (orders > order[0]).all(), orders
    assert (orders < order[1]).all(), orders
    np.testing.assert_allclose(errors[[0, -1]], [largest, smallest], rtol=0.03)
