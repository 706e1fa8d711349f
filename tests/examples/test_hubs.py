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


def test_sampled_hubs_have_the_momentum_of_their_torque(example, tmp_path):
    """The inertia that is derived is that of examples/hubs.toml: phi = 4 of a rim of 0.05 m."""
    example("rotating_beam").ensure_superelement()
    text = (EXAMPLES / "sampled_hubs.toml").read_text().replace("samples = 32", "samples = 3")
    study_file = tmp_path / "sampled_hubs.toml"
    study_file.write_text(text.replace("case1.toml", str(EXAMPLES / "case1.toml")))
    rows = sweep(read_study(study_file, tmp_path / "cases"), workers=0)
    for row in rows:
        phi, a, C = (row.case.parameters[name] for name in ("phi", "a", "C"))
        hub = row.case.document["bodies"]["hub"]
        I_T = 0.00475475 * (0.25 / 12 + (a + 0.25) ** 2) / (0.25 / 12 + 0.3**2)
        assert hub["inertia"][2] == pytest.approx(phi * I_T, rel=1e-12)
        assert hub["frames"]["rim"]["position"] == [a, 0, 0]
        assert row.numbers["momentum"] == pytest.approx(0.05 * C, rel=2e-6)
