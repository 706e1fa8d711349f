"""Modes from frequency responses: of parts whose modes are given, and of their derivatives."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.preprocess.identification.identify import REST_PLACES, identify
from duhamel.preprocess.identification.loading import FreeModes, without_masses
from duhamel.preprocess.identification.refinement import _equations, _measured, _moved, refined_fit
from duhamel.preprocess.identification.responses import Measurement, ModalFit, resonances
from duhamel.preprocess.identification.shapes import passive_rest, shape_of
from scipy.linalg import eigh

F = np.arange(20.0, 1000.0, 2.0)
FREQUENCIES = np.array([90.0, 210.0, 222.0, 480.0, 730.0, 905.0])
ZETA = np.array([0.004, 0.01, 0.02, 0.006, 0.008, 0.005])
N_O, N_I, Q = 9, 8, 5


def geometry(rng):
    """Sensors and hits that see all coordinates, which move rigidly about a center."""
    return rng.standard_normal((N_O, Q)), rng.standard_normal((N_I, Q)), rng.standard_normal((Q, 6))


def make(modes=6, noise=0.0, window=0.0, seed=0):
    """A measurement of given modes, and these."""
    rng = np.random.default_rng(seed)
    outputs, inputs, rigid = geometry(rng)
    omega, zeta = 2.0 * np.pi * FREQUENCIES[:modes], ZETA[:modes]
    shapes = rng.standard_normal((Q, modes))
    s, M = 2j * np.pi * F + window, np.diag([2.0, 2.0, 2.0, 0.3, 0.4, 0.5])
    U = outputs @ rigid @ np.linalg.solve(M, (inputs @ rigid).T)
    h = resonances(s, omega, zeta)
    H = U + np.einsum("am,km,bm->kab", outputs @ shapes, h, inputs @ shapes)
    noises = rng.standard_normal((2, *H.shape)) / np.sqrt(2.0)
    H = H * (1.0 + noise * (noises[0] + 1j * noises[1]))
    fit = ModalFit(
        omega, zeta, shapes, np.array(REST_PLACES) * s.imag.max(), (np.zeros((Q, 0)),) * 2
    )
    return Measurement(s, H, outputs, inputs, rigid, M), fit


@pytest.mark.parametrize("window", [0.0, 9.0])
def test_exact_responses_give_their_modes(window):
    measured, true = make(window=window)
    found = identify(measured).fit
    assert found.misfit < 1e-7
    np.testing.assert_allclose(found.omega[:6], true.omega, rtol=1e-8)
    np.testing.assert_allclose(found.zeta[:6], true.zeta, rtol=1e-6)
    signs = np.sign(np.sum(found.shapes[:, :6] * true.shapes, axis=0))
    np.testing.assert_allclose(signs * found.shapes[:, :6], true.shapes, rtol=0.0, atol=1e-6)


def test_noise_changes_modes_by_less_than_itself():
    measured, true = make(noise=0.05)
    found = identify(measured).fit
    assert len(found.omega) == 6
    assert 0.04 < found.misfit < 0.055
    np.testing.assert_allclose(found.omega, true.omega, rtol=2e-4)
    np.testing.assert_allclose(found.zeta, true.zeta, rtol=0.03)


def test_a_window_that_is_not_told_is_damping():
    measured, true = make(window=9.0)
    found = identify(replace(measured, s=1j * measured.s.imag)).fit
    nearest = np.abs(found.omega[:, None] - true.omega).argmin(axis=0)
    np.testing.assert_allclose(found.zeta[nearest], true.zeta + 9.0 / true.omega, rtol=0.1)


def test_a_mode_that_the_poles_lack_is_added():
    measured, true = make()
    poles = np.column_stack([true.omega, true.zeta])
    found = identify(measured, np.delete(poles, 3, axis=0))
    np.testing.assert_allclose(found.added, [480.0], rtol=0.02)
    np.testing.assert_allclose(found.fit.omega, true.omega, rtol=1e-8)


def test_a_pole_that_no_mode_has_is_dropped():
    measured, true = make(noise=0.01)
    poles = np.column_stack([true.omega, true.zeta])
    found = identify(measured, np.vstack([poles, [2.0 * np.pi * 600.0, 0.003]]))
    np.testing.assert_allclose(found.dropped[:, 0], [600.0])
    np.testing.assert_allclose(found.fit.omega, true.omega, rtol=1e-4)


def test_shapes_of_one_sign_are_those_of_their_residue():
    rng = np.random.default_rng(1)
    measured, _ = make()
    psi = rng.standard_normal(Q)
    R = np.outer(measured.outputs @ psi, measured.inputs @ psi)
    shape = shape_of(R, measured)
    np.testing.assert_allclose(shape.psi * np.sign(shape.psi @ psi), psi, rtol=1e-9)
    assert (shape.defect < 1e-9, shape.sign > 0.999999) == (True, True)
    # A negative driving point is no mode, whatever its form.
    assert shape_of(-R, measured).sign < -0.999999
    assert shape_of(-R, measured).defect > 0.99


def test_a_rest_is_passive():
    rng = np.random.default_rng(2)
    measured, _ = make()
    L = rng.standard_normal((Q, 2))
    found, negative = passive_rest(measured.outputs @ L @ L.T @ measured.inputs.T, measured)
    np.testing.assert_allclose(found @ found.T, L @ L.T, atol=1e-9)
    assert negative < 1e-9
    indefinite = L @ np.diag([1.0, -0.3]) @ L.T
    found, negative = passive_rest(measured.outputs @ indefinite @ measured.inputs.T, measured)
    assert found.shape[1] == 1
    assert negative > 0.05


def test_slopes_of_the_misfit_are_differences():
    measured, true = make(noise=0.1)
    rng = np.random.default_rng(3)
    rest = tuple(0.1 * rng.standard_normal((Q, n)) for n in (2, 1))
    fit = replace(true, shapes=1.05 * true.shapes, zeta=1.1 * true.zeta, rest=rest)
    _, slope = _equations(*_measured(fit, measured), measured)

    def half_square(step):
        return 0.5 * (_moved(fit, step).misfits(measured) ** 2).sum()

    for k in rng.choice(len(slope), 12, replace=False):
        step = np.zeros(len(slope))
        step[k] = 1e-6
        difference = (half_square(step) - half_square(-step)) / 2e-6
        assert -slope[k] == pytest.approx(difference, rel=1e-6, abs=1e-5 * np.abs(slope).max())


def test_refinement_finds_the_least_misfit():
    measured, true = make()
    start = replace(true, omega=1.001 * true.omega, zeta=1.3 * true.zeta, shapes=0.9 * true.shapes)
    found = refined_fit(start, measured)
    assert found.misfit < 1e-7
    np.testing.assert_allclose(found.omega, true.omega, rtol=1e-9)


def test_masses_that_are_taken_away_were_never_there():
    """A free chain of masses in space, measured with further masses on some of its places."""
    rng = np.random.default_rng(4)
    points = rng.standard_normal((5, 3))
    rigid = np.vstack([np.hstack([np.eye(3), -skew(X)]) for X in points])
    own, mounted = rng.uniform(1.0, 2.0, 5), np.array([0.0, 0.3, 0.0, 0.3, 0.0])
    free = np.eye(15) - rigid @ np.linalg.pinv(rigid)
    stiffness = free @ np.diag(rng.uniform(1e4, 1e6, 15)) @ free

    def modes_with(masses):
        squares, shapes = eigh(stiffness, np.diag(np.repeat(masses, 3)))
        return FreeModes(np.sqrt(squares[6:]), np.full(9, 0.01), shapes[:, 6:])

    loaded, bare = modes_with(own + mounted), modes_with(own)
    M = rigid.T @ np.diag(np.repeat(own + mounted, 3)) @ rigid
    found = without_masses(loaded, rigid, M, np.eye(15)[np.repeat(mounted, 3) > 0.0], 0.3)
    np.testing.assert_allclose(found.omega, bare.omega, rtol=1e-9)
    signs = np.sign(np.sum(found.shapes * bare.shapes, axis=0))
    np.testing.assert_allclose(signs * found.shapes, bare.shapes, atol=1e-8)
    with pytest.raises(ValueError, match="no mass would be left"):
        without_masses(loaded, rigid, M, np.eye(15), 100.0)


def skew(r):
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])


def test_fits_are_reciprocal_and_passive():
    measured, _ = make(noise=0.3, seed=5)
    fit = identify(measured).fit
    assert (fit.zeta > 0.0).all()
    square = replace(measured, inputs=measured.outputs, H=np.zeros((len(F), N_O, N_O), complex))
    Y = fit.responses(square) / measured.s[:, None, None]
    np.testing.assert_allclose(Y, Y.transpose(0, 2, 1), atol=1e-12 * np.abs(Y).max())
    # The real part of the mobility is what it dissipates.
    assert np.linalg.eigvalsh(Y.real).min() > -1e-12 * np.abs(Y).max()


def test_twelve_modes_of_exact_responses_are_found_again():
    rng = np.random.default_rng(8)
    outputs, inputs, rigid = geometry(rng)
    omega = 2.0 * np.pi * np.array([60, 95, 140, 150, 230, 310, 400, 415, 520, 640, 780, 930.0])
    zeta, shapes = rng.uniform(0.003, 0.015, 12), rng.standard_normal((Q, 12))
    s, M = 2j * np.pi * np.arange(10.0, 1000.0, 1.0), np.diag([2.0, 2.0, 2.0, 0.3, 0.4, 0.5])
    U = outputs @ rigid @ np.linalg.solve(M, (inputs @ rigid).T)
    h = resonances(s, omega, zeta)
    H = U + np.einsum("am,km,bm->kab", outputs @ shapes, h, inputs @ shapes)
    found = identify(Measurement(s, H, outputs, inputs, rigid, M)).fit
    assert found.misfit < 1e-6
    np.testing.assert_allclose(found.omega, omega, rtol=1e-6)
    np.testing.assert_allclose(found.zeta, zeta, rtol=1e-6)
