"""Kernels that are faded out and cut off, against the sums that they are to keep and the motions
that they change.
"""

import numpy as np
import pytest
from duhamel.solver.history.truncation import truncate, truncation_error
from duhamel.superelement import GeneralizedAlpha, Kernel, Modes, SuperelementError, sample_kernel

SCHEME = GeneralizedAlpha(0.9)
H = 1e-3
MODES = Modes(
    np.array([300.0, 700.0]), np.array([0.1, 0.05]), np.array([[1.0, 0.5], [-0.4, 2.0], [0.2, 0.1]])
)


def kernel_of(modes: Modes, steps: int) -> Kernel:
    return sample_kernel(modes, H, SCHEME, steps)


def test_the_static_compliance_is_kept():
    cut = truncate(kernel_of(MODES, 400), 101, MODES.compliance)
    assert len(cut.g) == 101
    np.testing.assert_allclose(
        cut.g.sum(axis=0), MODES.compliance, rtol=0.0, atol=1e-14 * MODES.compliance.max()
    )
    np.testing.assert_allclose(cut.g[-1], 0.0, atol=1e-3 * np.abs(cut.g).max())


def test_three_quarters_stay_as_they_were():
    """But for what returns the static compliance, which is small where the kernel has decayed, and
    none at lag 0.
    """
    whole = kernel_of(MODES, 400)
    cut = truncate(whole, 201, MODES.compliance)
    np.testing.assert_array_equal(cut.g[0], whole.g[0])
    np.testing.assert_allclose(
        cut.g[:150], whole.g[:150], rtol=0.0, atol=1e-4 * np.abs(whole.g).max()
    )
    np.testing.assert_array_equal(cut.g_initial[:150], whole.g_initial[:150])


@pytest.mark.parametrize("lags", [41, 81, 161])
def test_no_load_does_more_than_the_stated_error(lags):
    """The worst load of magnitude one has the signs of g - g'; the statement exceeds it by less
    than three times.
    """
    whole = kernel_of(MODES, 2000)
    cut = truncate(whole, lags, MODES.compliance)
    difference = whole.g.copy()
    difference[:lags] -= cut.g
    scale = np.sqrt(np.diag(MODES.compliance))
    worst = (np.abs(difference).sum(axis=0) / np.outer(scale, scale)).max()
    stated = truncation_error(kernel_of(MODES, lags - 1), cut, MODES, MODES.compliance)
    assert worst < stated < 3.0 * worst
    assert truncation_error(whole, cut, MODES, MODES.compliance) == pytest.approx(worst, rel=1e-6)


def test_without_modes_the_tail_is_that_of_the_decay_so_far():
    """Exact for an exponential."""
    g = np.exp(-0.05 * np.arange(101))[:, None, None]
    whole = Kernel(H, SCHEME, g, g)
    compliance = np.array([[1.0 / (1.0 - np.exp(-0.05))]])
    cut = truncate(whole, 101, compliance)
    tail = (
        truncation_error(whole, cut, None, compliance) - np.abs(g - cut.g).sum() / compliance[0, 0]
    )
    # 101 lags have quarters of 25, of which the last ends one lag before the end
    assert tail * compliance[0, 0] == pytest.approx(
        np.exp(-0.05 * 100) / (1.0 - np.exp(-0.05)), rel=1e-12
    )


def test_what_does_not_decay_cannot_be_cut_off():
    undamped = Modes(MODES.omega, np.zeros(2), MODES.phi)
    whole = kernel_of(undamped, 400)
    cut = truncate(whole, 201, undamped.compliance)
    assert truncation_error(whole, cut, undamped, undamped.compliance) == np.inf


@pytest.mark.parametrize("lags", [7, 402])
def test_as_many_lags_as_there_are(lags):
    with pytest.raises(
        SuperelementError, match=f"kernel: expected 8 to 401 lags to keep, found {lags}"
    ):
        truncate(kernel_of(MODES, 400), lags, MODES.compliance)
