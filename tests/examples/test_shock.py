"""The shelf on a drop table, and the drop that makes the same shock."""

import numpy as np
import pytest
from duhamel.results import Results, peaks, quantities, series
from duhamel.solver import read_model, simulate

from .conftest import EXAMPLES

G = 9.80665


def test_a_drop_makes_the_half_sine_of_50_g(example):
    """It comes with sqrt(2 g h). Slow oscillators have the velocity that it feels."""
    example("base_shock").ensure_superelement()
    results = simulate(read_model(EXAMPLES / "drop.toml"))
    time, carriage = results.time, results.body("carriage")
    (event,) = results.events["pad"].start
    assert np.interp(event, time, carriage.v[:, 2]) == pytest.approx(
        -np.sqrt(2 * G * 0.0447167), rel=1e-5
    )
    felt = carriage.v_dot[:, 2] + G
    after = time > event + 6.5e-3
    came, left = carriage.v[:, 2].min(), carriage.v[after][0, 2] + G * (time[after][0] - event)
    slow = series.shock_spectrum(time, felt, [5.0], q=np.inf, response="pseudo-velocity")
    assert slow.values[0] == pytest.approx(left - came, rel=5e-3)
    spectrum = series.shock_spectrum(time, felt)
    assert spectrum.values.max() / (50 * G) == pytest.approx(1.65, abs=0.03)
    place, *_ = peaks(results, ["acceleration:*:z"], gravities=True)
    assert place.quantity == "acceleration:shelf.tip:z"
    assert place.largest == pytest.approx(106.0, abs=1.0)
    check_stress(results)


def check_stress(results):
    """At the root, as in the first mode of a cantilever: E (t / 2) 3.516 w / L^2, L = 160 mm."""
    (stress,) = peaks(results, ["von_mises:shelf"])
    direct = results.von_mises("shelf", stress.at_largest)
    assert stress.largest == pytest.approx(direct.max(), rel=1e-12)
    shelf = results.superelement("shelf")
    points = shelf.recovery.points + shelf.center  # in the mesh
    np.testing.assert_allclose(stress.place.position, points[direct.argmax()], atol=1e-12)
    front = points[:, 0].min() + 0.005
    assert stress.place.position[0] == pytest.approx(front, abs=0.011)
    seen = quantities.displacement(results, "shelf.tip", "carriage.front")[:, 2]
    assert stress.largest == pytest.approx(
        2.1e11 * 2.5e-3 * 3.516 * np.abs(seen).max() / 0.16**2, rel=0.1
    )


def test_a_shelf_on_a_drop_table(example, tmp_path):
    found, checks = example("base_shock").main(tmp_path)  # which checks spectrum, velocity and tip
    assert (tmp_path / "base-shock.png").exists()
    assert checks.cycles == pytest.approx(0.82, abs=0.05)
    assert checks.tip < 6e-3
    assert 0.7 < checks.by_spectrum < 1.0
    results = Results.read(tmp_path / "base-shock.h5")
    (peak, *_) = peaks(results, ["acceleration:shelf.tip"])
    assert peak.largest == pytest.approx(np.abs(found.tip).max(), rel=1e-3)
