"""The examples of motors, which check their own numbers."""

import numpy as np
import pytest


@pytest.mark.validation
def test_robot_arm(example, tmp_path):
    found = example("robot_arm").main(tmp_path)
    assert {path.name for path in tmp_path.glob("*.png")} == {"robot-arm.png"}
    settled = [move.settled for move in found.moves.values()]
    np.testing.assert_allclose(settled, [4.67, 3.12, 1.57], atol=0.02)
    assert found.soft.settled == pytest.approx(1.02, abs=0.02)
    assert max(np.abs(move.torques).max() for move in found.moves.values()) < 200.0
