"""Sampled kernels against plain time stepping, transfer functions, statics and passivity."""

from itertools import pairwise

import numpy as np
import pytest
from duhamel.superelement import GeneralizedAlpha, Kernel, Modes, SuperelementError, sample_kernel

RHO_INF = (0.0, 0.5, 0.9, 1.0)


def convolve(kernel: Kernel, p: np.ndarray) -> np.ndarray:
    """u_n = g_initial[n] p_0 + sum_{j=1..n} g[n-j] p_j, as defined; p (n + 1, n_c)."""
    u = np.zeros_like(p)
    for n in range(len(p)):
        u[n] = kernel.g_initial[n] @ p[0] + np.einsum(
            "jab, jb -> a", kernel.g[:n][::-1], p[1 : n + 1]
        )
    return u


def march(M, C, K, loads, h, scheme):
    """Chung and Hulbert's form: loads and internal forces averaged over the step.   loads (n + 1,
    n_u) -> u alike
    """
    alpha_m, alpha_f, beta, gamma = scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma
    u, v, a = np.zeros_like(loads[0]), np.zeros_like(loads[0]), np.linalg.solve(M, loads[0])
    S = (1 - alpha_m) * M + (1 - alpha_f) * (gamma * h * C + beta * h**2 * K)
    path = [u]
    for before, after in pairwise(loads):
        u_star, v_star = u + h * v + h**2 * (0.5 - beta) * a, v + h * (1 - gamma) * a
        load = (1 - alpha_f) * (after - C @ v_star - K @ u_star) + alpha_f * (
            before - C @ v - K @ u
        )
        a = np.linalg.solve(S, load - alpha_m * M @ a)
        u, v = u_star + beta * h**2 * a, v_star + gamma * h * a
        path.append(u)
    return np.array(path)


def transfer(kernel: Kernel, z: complex) -> np.ndarray:
    """G(z) = sum_k g_k z^-k, over the lags that the kernel holds."""
    return np.tensordot(z ** -np.arange(len(kernel.g)), kernel.g, axes=1)


def symbols(scheme: GeneralizedAlpha, h: float, z: complex) -> tuple[complex, complex]:
    """z-transforms per unit displacement: acceleration sigma(z), velocity."""
    alpha_m, alpha_f, beta, gamma = scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma
    F = ((1 - alpha_f) * z + alpha_f) / ((1 - alpha_m) * z + alpha_m)
    Q = h**2 * (beta * z**2 + (0.5 + gamma - 2 * beta) * z + (0.5 + beta - gamma)) / (z - 1) ** 2
    V = h * (gamma * z + 1 - gamma) / (z - 1)
    return 1 / (Q * F), V / Q


@pytest.fixture
def decaying() -> Modes:
    """Damped so well that 6000 steps of 0.1 ms see the end of every response, three above the
    Nyquist frequency.
    """
    rng = np.random.default_rng(5)
    omega = np.array([300.0, 900.0, 2500.0, 9e3, 4e4, 2e5, 1e6])
    return Modes(
        omega, np.array([0.3, 0.1, 0.05, 0.02, 0.05, 0.05, 0.1]), rng.normal(size=(4, len(omega)))
    )


@pytest.mark.parametrize("rho_inf", RHO_INF)
def test_convolution_equals_time_stepping_of_the_full_system(rho_inf):
    rng = np.random.default_rng(1)
    n_u, steps, h, scheme = 8, 300, 1e-3, GeneralizedAlpha(rho_inf)
    half, shape = rng.normal(size=(2, n_u, n_u))
    M = half @ half.T + n_u * np.eye(n_u)
    # K and C from chosen frequencies and ratios, in modes orthonormal in M
    phi = np.linalg.solve(np.linalg.cholesky(M).T, np.linalg.qr(shape)[0])
    omega, zeta = np.geomspace(200.0, 5e3, n_u), rng.uniform(0.0, 0.05, n_u)
    K, C = (M @ phi * weights @ phi.T @ M for weights in (omega**2, 2 * zeta * omega))
    P = np.eye(n_u)[[0, 3, 5]]
    p = rng.normal(size=(steps + 1, 3))

    found = convolve(sample_kernel(Modes(omega, zeta, P @ phi), h, scheme, steps), p)

    expected = march(M, C, K, p @ P, h, scheme) @ P.T
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("rho_inf", RHO_INF)
def test_the_z_transform_is_the_transfer_function_at_the_symbol_of_the_scheme(rho_inf, decaying):
    """G(z) = H(sigma(z)), sigma for s^2; with damping the scheme has a symbol of its own for s."""
    h, scheme = 1e-4, GeneralizedAlpha(rho_inf)
    for zeta in (decaying.zeta, 0.0 * decaying.zeta):
        modes = Modes(decaying.omega, zeta, decaying.phi)
        kernel = sample_kernel(modes, h, scheme, 400)
        for z in 1.2 * np.exp(1j * np.array([0.0, 0.1, 0.7, 1.5, 3.0])):
            sigma, velocity = symbols(scheme, h, z)
            H = (
                modes.phi
                / (sigma + 2 * zeta * modes.omega * velocity + modes.omega**2)
                @ modes.phi.T
            )
            np.testing.assert_allclose(transfer(kernel, z), H, rtol=0, atol=1e-12 * np.abs(H).max())


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9])
def test_the_sum_of_a_decayed_kernel_is_the_static_compliance(rho_inf, decaying):
    kernel = sample_kernel(decaying, 1e-4, GeneralizedAlpha(rho_inf), 6000)
    compliance = decaying.phi / decaying.omega**2 @ decaying.phi.T
    np.testing.assert_allclose(
        kernel.g.sum(axis=0), compliance, rtol=0, atol=1e-12 * np.abs(compliance).max()
    )


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9])
def test_no_load_draws_energy_from_a_kernel(rho_inf, decaying):
    """The work per cycle of a load p is -pi Im(p* G p), so -Im G(e^{i theta}) has no negative
    eigenvalue on (0, pi).
    """
    kernel = sample_kernel(decaying, 1e-4, GeneralizedAlpha(rho_inf), 6000)
    G = np.fft.rfft(kernel.g, axis=0)
    absorbed = np.linalg.eigvalsh(-G.imag).min(axis=1)
    assert absorbed.min() >= -1e-13 * np.abs(G).max()
    # The check has teeth: the mean of two neighboring loads delays by half a step and creates
    # energy.
    z = np.exp(2j * np.pi * np.arange(len(G)) / len(kernel.g))
    delayed = G * ((1 + 1 / z) / 2)[:, None, None]
    assert np.linalg.eigvalsh(-delayed.imag).min() < -1e-3 * np.abs(G).max()


@pytest.mark.parametrize("rho_inf", RHO_INF)
def test_second_order_on_an_oscillator_loaded_from_the_start(rho_inf):
    """u'' + 2 zeta omega u' + omega^2 u = cos(nu t) from rest, against the closed form."""
    omega, zeta, nu, end = 40.0, 0.05, 25.0, 0.5
    amplitude = 1 / (omega**2 - nu**2 + 2j * zeta * omega * nu)
    root = -zeta * omega + 1j * omega * np.sqrt(1 - zeta**2)

    def exact(t):
        # Re(c e^{root t}) carries minus the state in which the steady motion starts.
        start, rate = -amplitude.real, (amplitude * 1j * nu).real * -1
        c = start - 1j * (rate - root.real * start) / root.imag
        return (c * np.exp(root * t) + amplitude * np.exp(1j * nu * t)).real

    def error(steps):
        t = np.linspace(0, end, steps + 1)
        kernel = sample_kernel(
            Modes([omega], [zeta], [[1.0]]), end / steps, GeneralizedAlpha(rho_inf), steps
        )
        return np.abs(convolve(kernel, np.cos(nu * t)[:, None])[:, 0] - exact(t)).max()

    errors = np.array([error(steps) for steps in (250, 500, 1000)])
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 2.0, atol=0.1)


def test_lag_zero_is_the_instantaneous_compliance(decaying):
    """g[0] = beta h^2 phi S^-1 phi^T and g_initial[0] = 0."""
    h, scheme = 1e-4, GeneralizedAlpha(0.9)
    kernel = sample_kernel(decaying, h, scheme, 1)
    S = (1 - scheme.alpha_m) / (1 - scheme.alpha_f) + scheme.beta * h**2 * decaying.omega**2
    S = S + scheme.gamma * h * 2 * decaying.zeta * decaying.omega
    expected = scheme.beta * h**2 * (decaying.phi / S) @ decaying.phi.T
    np.testing.assert_allclose(kernel.g[0], expected, rtol=0, atol=1e-15 * np.abs(expected).max())
    assert not kernel.g_initial[0].any()


def test_every_sample_is_symmetric_to_the_last_bit(decaying):
    kernel = sample_kernel(decaying, 1e-4, GeneralizedAlpha(0.9), 50)
    np.testing.assert_array_equal(kernel.g, kernel.g.transpose(0, 2, 1))
    np.testing.assert_array_equal(kernel.g_initial, kernel.g_initial.transpose(0, 2, 1))


def test_steps_and_length(decaying):
    kernel = sample_kernel(decaying, 1e-4, GeneralizedAlpha(0.9), 50)
    assert (kernel.steps, len(kernel.g), kernel.n_c) == (50, 51, 4)
    assert kernel.length == pytest.approx(5e-3, rel=1e-15)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"h": 0.0}, "kernel: h: expected a positive number, found 0.0"),
        ({"h": float("inf")}, "kernel: h: expected a positive number, found inf"),
        ({"error": -1e-3}, "kernel: error: expected a number >= 0, found -0.001"),
        ({"g": np.zeros((3, 2))}, r"kernel: g: expected shape \(n_k, n_c, n_c\), found \(3, 2\)"),
        (
            {"g": np.zeros((3, 2, 1))},
            r"expected two or more square matrices, found shape \(3, 2, 1\)",
        ),
        (
            {"g": np.zeros((1, 2, 2))},
            r"expected two or more square matrices, found shape \(1, 2, 2\)",
        ),
        (
            {"g_initial": np.zeros((2, 2, 2))},
            r"kernel: g_initial: expected shape \(3, 2, 2\), found \(2, 2, 2\)",
        ),
        (
            {"g": np.full((3, 2, 2), np.nan)},
            r"kernel: g: expected finite numbers, found nan at index \(0, 0, 0\)",
        ),
        (
            {"g": [[[1, 0], [1e-6, 1]]] * 3},
            r"kernel: g: expected a symmetric matrix, found entries \(0, 1\) and \(1, 0\)",
        ),
        (
            {"g": np.zeros((3, 2, 2)) * 1j},
            r"kernel: g: expected real numbers .* found complex ones",
        ),
    ],
)
def test_a_kernel_that_contradicts_itself_is_refused(change, message):
    fields = {
        "h": 1e-4,
        "scheme": GeneralizedAlpha(),
        "g": np.zeros((3, 2, 2)),
        "g_initial": np.zeros((3, 2, 2)),
    }
    with pytest.raises(SuperelementError, match=message):
        Kernel(**fields | change)


def test_symmetry_is_measured_on_the_scale_of_the_two_rows():
    """A rotation row may be a million times larger than a translation row: each entry has its own
    measure.
    """
    scale = np.outer([1e-9, 1e-3], [1e-9, 1e-3])
    symmetric = np.ones((3, 2, 2)) * scale
    skewed = symmetric.copy()
    skewed[1, 0, 1] *= 1 + 1e-7
    Kernel(1e-4, GeneralizedAlpha(), symmetric, symmetric)
    with pytest.raises(
        SuperelementError, match=r"differ by 1\.000e-19, where the diagonal allows 1\.000e-20"
    ):
        Kernel(1e-4, GeneralizedAlpha(), skewed, symmetric)


@pytest.mark.parametrize(
    ("h", "steps", "message"),
    [(-1e-4, 10, "kernel: h: .* found -0.0001"), (1e-4, 0, "kernel: steps: .* found 0")],
)
def test_sampling_refuses_an_empty_range(decaying, h, steps, message):
    with pytest.raises(SuperelementError, match=message):
        sample_kernel(decaying, h, GeneralizedAlpha(), steps)


@pytest.mark.parametrize("n_c", [1, 6, 18])
def test_a_lag_does_not_depend_on_how_many_follow(n_c):
    """To the bit, as a restart of a run with a longer end needs it."""
    rng = np.random.default_rng(6)
    modes = Modes(np.geomspace(1e2, 1e5, 40), np.zeros(40), rng.normal(size=(n_c, 40)))
    whole = sample_kernel(modes, 1e-4, GeneralizedAlpha(0.9), 200)
    for steps in (1, 3, 14, 63, 64, 130):
        part = sample_kernel(modes, 1e-4, GeneralizedAlpha(0.9), steps)
        np.testing.assert_array_equal(part.g, whole.g[: steps + 1])
        np.testing.assert_array_equal(part.g_initial, whole.g_initial[: steps + 1])
