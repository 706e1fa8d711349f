"""A study of hubs and torques: two of its cases are the paper's, and all have the momentum that the
torque gives.
"""

import pytest
from duhamel.study import read_study, sweep

from .conftest import EXAMPLES


def test_hubs(example, tmp_path):
    example("rotating_beam").ensure_superelement()
    rows = sweep(read_study(EXAMPLES / "hubs.toml", tmp_path), workers=0)
    numbers = [row.numbers for row in rows]
    # The peaks of Cases 1 and 2 as docs/examples.md has them.
    for case, speed, deflection in (
        (numbers[0], 4.21405, 8.61719e-3),
        (numbers[-1], 9.52276, 28.14184e-3),
    ):
        assert case["peak_speed"] == pytest.approx(speed, abs=5e-6)
        assert case["peak_tip"] == pytest.approx(deflection, abs=5e-9)
    # 0.05 s of the torque; the largest over the steps is above it by 1e-6 in all cases.
    torques = [row.case.parameters["loads.0.signal.values"][0] for row in rows]
    assert [case["momentum"] for case in numbers] == pytest.approx(
        [0.05 * torque for torque in torques], rel=2e-6
    )
    # Twice the torque, twice the deflection, but for what grows with the square of the speed:
    # 1.5e-3 at most.
    for strong, weak in zip(numbers[::2], numbers[1::2], strict=True):
        assert strong["peak_tip"] / weak["peak_tip"] == pytest.approx(2.0, rel=2e-3)
