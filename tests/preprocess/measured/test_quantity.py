"""Files of a quantity other than the one that they are said to be."""

import numpy as np
import pytest
from duhamel.preprocess import MeasurementError
from duhamel.preprocess.measured.frequency_data import POWERS_OF_S, FrequencyData
from duhamel.preprocess.measured.quantity import require_quantity

from .hammer_bench import ALL, Errors, measure, replace

KINDS = ("accelerance", "mobility", "receptance")
NOISE = replace(ALL, noise=0.05, floor=5e-3, seed=2)


def read_as(bench, said, true, low=20.0):
    """What a file of one quantity is if read as another."""
    used = np.flatnonzero(bench.f >= low)
    s = (2j * np.pi * bench.f[used])[:, None, None]
    H = bench.H[used] * s ** (POWERS_OF_S[said] - POWERS_OF_S[true])
    return FrequencyData(bench.f[used], H, quantity=said)


@pytest.mark.parametrize("errors", [Errors(), ALL, NOISE, replace(ALL, damping=0.3)])
@pytest.mark.parametrize("said", KINDS)
@pytest.mark.parametrize("true", KINDS)
def test_a_quantity_is_known_by_the_mass_line(errors, said, true):
    data = read_as(measure(errors), said, true)
    if said == true:
        require_quantity("angle.npz", data)
        return
    wanted = f"^angle.npz: measured.quantity: expected {true}, .* to 40 Hz, found {said}$"
    with pytest.raises(MeasurementError, match=wanted):
        require_quantity("angle.npz", data)


@pytest.mark.parametrize("said", ["mobility", "receptance"])
def test_lines_at_0_hz_or_without_numbers_do_not_hide_it(said):
    data = read_as(measure(ALL), said, "accelerance")
    f, H = np.r_[0.0, 1.0, 2.0, data.f], np.concatenate([0.0 * data.H[:3], data.H])
    with pytest.raises(MeasurementError, match=f"expected accelerance, .* found {said}"):
        require_quantity("angle.npz", FrequencyData(f, H, quantity=said))


@pytest.mark.parametrize("low", [20.0, 100.0, 140.0, 190.0])
@pytest.mark.parametrize("cords", [0.0, 12.0, 30.0])
def test_neither_cords_nor_resonances_make_another_quantity(low, cords):
    for errors in (ALL, NOISE, replace(ALL, damping=0.3)):
        bench = measure(replace(errors, cords=cords))
        require_quantity("angle.npz", read_as(bench, "accelerance", "accelerance", low))
