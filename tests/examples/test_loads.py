"""The examples of distributed loads."""

import numpy as np


def test_a_plate_under_a_pressure_wave(example, tmp_path):
    found = example("pressure_pulse").main(tmp_path)  # which checks its numbers
    assert {path.name for path in tmp_path.glob("*.png")} == {"pressure-pulse.png"}
    assert np.abs(found.deflection - found.expected)[found.time < 3e-3].max() < 0.04 * 6.1e-4
