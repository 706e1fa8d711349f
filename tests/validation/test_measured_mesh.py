"""A mesh that is a few per cent wrong takes frequencies and damping of a simulated hammer test.

What the table of docs/how-to/measured.md says of benchmarks/mesh_and_test.py. The same part, mesh
and test were computed once by another program, with errors of another draw: the references below.
"""

from functools import cache

import numpy as np
import pytest
from coupling import assembly
from coupling.comparison import HIGHEST_OF_TEST, of_superelement, true_blown
from coupling.hammer import ALL, hammer_test
from coupling.hybrid import mesh_alone, mesh_and_test

pytestmark = [
    pytest.mark.validation,
    pytest.mark.filterwarnings(
        "ignore:.* modes for steps down to:duhamel.superelement.StepWarning"
    ),
]

INTERFACES_BEFORE, INTERFACES_AFTER = [1.16, 0.98, 0.95], [0.015, 0.045, 0.276]
"""rms errors below 1 kHz, from 1 to 3 and from 3 to 5 kHz"""
ASSEMBLY_BEFORE, ASSEMBLY_AFTER = [1.55, 2.42, 0.88], [0.94, 1.03, 1.29]
"""[dB] in the same bands"""
BLOWN_BEFORE, BLOWN_AFTER = 0.76, 0.007
"""of displacements after a blow on the foot"""
NEAR = 0.2
"""of such a number: the draw of errors is another, the dB there count rotations too, and motions
after a blow fold at the end of a transform there"""


@cache
def plain():
    return of_superelement(mesh_alone(), HIGHEST_OF_TEST)


@cache
def updated():
    return of_superelement(mesh_and_test(hammer_test(ALL)), HIGHEST_OF_TEST)


def blown_on_the_foot(found) -> float:
    u, true = assembly.blown(found.element)[0], true_blown()[0]
    return float(np.linalg.norm(u - true) / np.linalg.norm(true))


def test_a_wrong_mesh_is_as_wrong_as_by_another_program():
    found = plain()
    assert found.frequencies == pytest.approx(0.037, abs=5e-4)
    assert found.damping == pytest.approx(0.64, abs=5e-3)
    np.testing.assert_allclose(found.interfaces, INTERFACES_BEFORE, rtol=0.01)
    np.testing.assert_allclose(found.assembly, ASSEMBLY_BEFORE, rtol=NEAR)
    assert blown_on_the_foot(found) == pytest.approx(BLOWN_BEFORE, rel=NEAR)


def test_a_mesh_with_a_test_is_as_near_to_the_part_as_by_another_program():
    found = updated()
    assert found.element.measured.matched.all()
    assert (found.element.measured.mac > 0.99).all()
    # Another draw of noise: errors of the fit are bounded, not repeated.
    assert found.frequencies < 1e-4
    assert found.damping < 1e-2
    np.testing.assert_allclose(found.interfaces, INTERFACES_AFTER, rtol=NEAR)
    np.testing.assert_allclose(found.assembly, ASSEMBLY_AFTER, rtol=NEAR)
    assert blown_on_the_foot(found) == pytest.approx(BLOWN_AFTER, rel=NEAR)


def test_modes_with_a_partner_come_nearer_and_those_beyond_hardly():
    """Below 3 kHz by a factor of twenty; above, modes without a partner are in the responses."""
    before, after = plain().interfaces, updated().interfaces
    assert (after[:2] < 0.05 * before[:2]).all()
    assert 0.1 * before[2] < after[2] < 0.5 * before[2]
