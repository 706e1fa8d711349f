"""Krylov impulse responses against marches and all modes: what k blocks hold, and whether the
stated error is true.
"""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess import MeshError, MethodError, assemble, build
from duhamel.preprocess.body.body import Damping
from duhamel.preprocess.responses.accuracy import solution_accuracy, unsolved_error
from duhamel.preprocess.responses.band import Band
from duhamel.preprocess.responses.basis import Basis
from duhamel.preprocess.responses.condensation import condensed
from duhamel.preprocess.responses.damping import damping_ratios
from duhamel.preprocess.responses.krylov import KrylovSpace
from duhamel.preprocess.responses.lowest import first_square
from duhamel.preprocess.responses.march import march_kernel
from duhamel.preprocess.responses.modal import elastic_shapes
from duhamel.preprocess.responses.search import Request, krylov_modes
from duhamel.preprocess.solving.gradients import NotConvergedError
from duhamel.preprocess.solving.solver import Patient, factorized, iterated
from duhamel.superelement import GeneralizedAlpha, Modes, sample_kernel

NONE = Damping()
RAYLEIGH = Damping.model_validate({"rayleigh": {"mass": 50.0, "stiffness": 1e-6}})
RATIO = Damping.model_validate({"modal": 0.01})


def structure_of(case, solid_body, beam_body, box, beam):
    """The finite element model of a case, and a step that has some tens of its modes below a
    quarter of 1/h.
    """
    nodes = {f"n{i}": {"node": [0.05 * i, 0.1 * (i % 2), 0.0]} for i in range(1, 5)}
    plate = box("hexahedron20", (0.2, 0.1, 0.005), (4, 3, 1))
    match case:
        case "beam, n_c = 12":
            return assemble(beam_body(beam(20))), 2e-5
        case "bar of hexahedra, n_c = 12":
            return assemble(solid_body(box("hexahedron27", (0.5, 0.02, 0.02), (8, 1, 1)))), 2e-5
        case "block of tetrahedra, n_c = 3":
            mesh = box("tetra10", (0.2, 0.05, 0.05), (4, 2, 2))
            return assemble(
                solid_body(mesh, interfaces={"corner": {"node": [0.2, 0.0, 0.0]}})
            ), 1e-5
        case "block of tetrahedra, n_c = 12":
            return assemble(solid_body(box("tetra10", (0.2, 0.05, 0.05), (4, 2, 1)))), 1e-5
        case "plate, n_c = 6":
            return assemble(solid_body(plate, interfaces={"root": {"group": "root"}})), 3e-5
        case "plate, n_c = 24":
            return assemble(
                solid_body(plate, interfaces=nodes | {e: {"group": e} for e in ("root", "tip")})
            ), 2e-5


CASES = [
    "beam, n_c = 12",
    "bar of hexahedra, n_c = 12",
    "block of tetrahedra, n_c = 3",
    "block of tetrahedra, n_c = 12",
    "plate, n_c = 6",
    "plate, n_c = 24",
]


@pytest.fixture(params=CASES)
def case(request, solid_body, beam_body, box, beam):
    return structure_of(request.param, solid_body, beam_body, box, beam)


@pytest.fixture
def block(solid_body, beam_body, box, beam):
    return structure_of("block of tetrahedra, n_c = 3", solid_body, beam_body, box, beam)


def half_nyquist(h, scheme):
    return Band(h, scheme, 0.25 / h)


def all_modes(structure, damping):
    modes = elastic_shapes(structure, NONE)[0]
    return Modes(modes.omega, damping_ratios(damping, modes.omega), modes.phi)


def modes_of(space, structure, blocks):
    """The modes of the first blocks of a space, without damping."""
    omega, Q = space.ritz(blocks)
    return Modes(omega, 0.0 * omega, space.basis.at(structure.P_C)[:, 6 : 6 + len(Q)] @ Q)


def difference(a, b):
    """By lags: the largest difference relative to sqrt(max |g_ii| max |g_jj|)."""
    scale = np.sqrt(np.abs(np.diagonal(b, axis1=1, axis2=2)).max(axis=0))
    return (np.abs(a - b) / np.outer(scale, scale)).max(axis=(1, 2))


def convolve(g, p):
    """u_n = sum_{j=1..n} g[n-j] p_j by FFT, for loads p (n, n_c) that begin at zero."""
    n = 2 * len(p)
    product = np.fft.rfft(g, n, axis=0) @ np.fft.rfft(p, n, axis=0)[:, :, None]
    return np.fft.irfft(product[:, :, 0], n, axis=0)[: len(p)]


# The basis


def test_a_basis_is_orthonormal_whatever_is_added(block):
    """Nearly dependent columns, of lengths 1e-9 to 1e9; earlier columns stay as they are."""
    structure, _ = block
    rng = np.random.default_rng(0)
    basis = Basis(structure, 40)
    span = rng.normal(size=(structure.n_u, 40))
    for start in range(0, 40, 7):
        W = span[:, start : start + 7]
        before = basis.V
        basis.extend((W + W[:, :1] * 1e7) * np.logspace(-9, 9, W.shape[1]))
        assert np.shares_memory(before, basis.V) == bool(start)
    V = basis.V
    assert basis.columns == V.shape[1] == 40
    np.testing.assert_allclose(V.T @ structure.M @ V, np.eye(40), rtol=0, atol=1e-13)
    W = span - V @ (V.T @ (structure.M @ span))
    assert np.abs(W).max() < 1e-7 * np.abs(span).max()
    assert basis.extend(V @ rng.normal(size=(40, 3))) == 0
    rows = structure.P_C
    np.testing.assert_allclose(
        basis.at(rows), rows @ V, rtol=1e-13, atol=1e-13 * np.abs(rows @ V).max()
    )


def test_a_space_is_orthonormal_free_of_rigid_motion_and_its_stiffness_is_that_of_the_mesh(case):
    structure, h = case
    space = KrylovSpace(structure, GeneralizedAlpha(0.9).beta_prime(h))
    for k in range(8):
        assert space.grow()
        if k in (2, 3, 7):
            omega, Q = space.ritz(space.blocks)
    V = space.basis.V[:, 6:]
    np.testing.assert_allclose(V.T @ structure.M @ V, np.eye(space.dimension), rtol=0, atol=1e-12)
    np.testing.assert_allclose(V.T @ structure.M @ structure.U, 0.0, rtol=0, atol=1e-12)
    K = (V @ Q).T @ structure.K @ (V @ Q)
    np.testing.assert_allclose(K, np.diag(omega**2), rtol=0, atol=1e-9 * omega[-1] ** 2)


@pytest.mark.parametrize("damping", [NONE, RAYLEIGH])
@pytest.mark.parametrize("rho_inf", [0.5, 0.9, 1.0])
def test_the_first_lags_are_exact(case, rho_inf, damping):
    """k blocks give k lags of what marching gives, and by far not all the others.

    Of g_initial too, except with damping in proportion to K and rho_inf < 1: the scheme then keeps
    a trace of the accelerations at t_0, M^-1 P^T P_C^T, that no block holds.
    """
    structure, h = case
    scheme, blocks = GeneralizedAlpha(rho_inf), 3
    rayleigh = damping.rayleigh
    shift = scheme.beta_prime(h)
    if rayleigh is not None:
        velocity = scheme.gamma_prime(h)
        shift = (shift + velocity * rayleigh.mass) / (1.0 + velocity * rayleigh.stiffness)
    space = KrylovSpace(structure, shift)
    for _ in range(blocks):
        space.grow()
    found = modes_of(space, structure, blocks)
    found = sample_kernel(replace(found, zeta=damping_ratios(damping, found.omega)), h, scheme, 40)
    expected = march_kernel(structure, damping, h, scheme, 40)
    for name in ("g",) if damping is RAYLEIGH and rho_inf < 1.0 else ("g", "g_initial"):
        errors = difference(getattr(found, name), getattr(expected, name))
        assert errors[:blocks].max() < 1e-9
        assert errors.max() > 1e-5


# The error


@pytest.mark.parametrize("rho_inf", [0.5, 0.9, 1.0])
def test_what_a_block_changes_bounds_what_is_left(case, rho_inf):
    """Twice the change: never below a third of the true error, and no more than what is left and
    was left before.
    """
    structure, h = case
    band = half_nyquist(h, GeneralizedAlpha(rho_inf))
    truth = all_modes(structure, NONE)
    space = KrylovSpace(structure, band.scheme.beta_prime(h))
    before, left = None, []
    while (not left or left[-1] > 1e-7) and space.grow():
        modes = modes_of(space, structure, space.blocks)
        left.append(band.error(modes, truth))
        if before is not None and 1e-7 < left[-1] < 0.1:
            estimate = 2.0 * band.error(before, modes)
            assert left[-1] / 3.0 < estimate < 3.0 * (left[-1] + left[-2])
        before = modes
    assert left[-1] <= 1e-7


@pytest.mark.parametrize("damping", [NONE, RAYLEIGH, RATIO])
@pytest.mark.parametrize("rho_inf", [0.5, 1.0])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_the_stated_error_is_kept_and_true(case, rho_inf, damping, tolerance):
    structure, h = case
    band = half_nyquist(h, GeneralizedAlpha(rho_inf))
    told = []
    modes, _, stated = krylov_modes(Request(structure, damping, band, tolerance, watch=told.append))
    error = band.error(modes, all_modes(structure, damping))
    rounding = 1e-8
    assert error <= stated * 3.0 + rounding
    assert stated <= tolerance
    assert told[-1].split()[1] == "blocks,"


def test_no_frequency_between_those_that_are_looked_at_is_worse(block):
    """The error on forty thousand frequencies, in the terms of its definition."""
    structure, h = block
    band = half_nyquist(h, GeneralizedAlpha(1.0))
    truth = all_modes(structure, NONE)
    space = KrylovSpace(structure, band.scheme.beta_prime(h))
    for blocks in range(1, 30):
        space.grow()
        if blocks < 15 or blocks % 5:
            continue
        modes = modes_of(space, structure, blocks)
        # rho_inf = 1 is the trapezoidal rule: it takes 2 / h tan(w h / 2) to w.
        omega = np.linspace(0.0, 2.0 / h * np.tan(np.pi / 4), 40000)
        s = (1e-3 + 1j) * omega
        G, exact = (
            np.einsum(
                "am,fm,bm->fab", m.phi, 1 / (s[:, None] ** 2 + m.omega**2), m.phi, optimize=True
            )
            for m in (modes, truth)
        )
        edges = np.searchsorted(omega, 2.0 * np.pi * band.limit * np.arange(1, 9) / 8)
        largest = 0.0
        for part in [[0], *np.split(np.arange(40000), edges)]:
            scale = np.sqrt(np.abs(np.einsum("faa->fa", exact[part])).max(axis=0))
            largest = max(
                largest, (np.abs(G - exact)[part].max(axis=0) / np.outer(scale, scale)).max()
            )
        assert 0.5 * largest < band.error(modes, truth) < 2.0 * largest


def test_condensed_modes_err_by_no_more_than_they_say(case):
    """Far fewer than the space has; those of the band, and static displacements, stay."""
    structure, h = case
    band, tolerance = half_nyquist(h, GeneralizedAlpha(0.9)), 1e-5
    modes = all_modes(structure, NONE)
    few = condensed(modes, NONE, band, tolerance, True, modes.phi)
    assert len(few.modes.omega) < 0.8 * len(modes.omega)
    np.testing.assert_allclose(few.Y.T @ few.Y, np.eye(len(few.modes.omega)), rtol=0, atol=1e-12)
    assert band.error(few.modes, modes) <= few.error <= tolerance
    assert band.field_error(few.modes, modes, few.Y) <= few.error
    inside = modes.frequencies < band.limit
    np.testing.assert_array_equal(few.modes.omega[: inside.sum()], modes.omega[inside])
    np.testing.assert_allclose(
        few.modes.compliance,
        modes.compliance,
        rtol=1e-9,
        atol=1e-9 * np.abs(modes.compliance).max(),
    )


@pytest.mark.parametrize(
    ("rho_inf", "damping"), [(0.5, NONE), (0.9, RAYLEIGH), (0.9, RATIO), (1.0, NONE)]
)
def test_the_response_to_a_load_within_the_band_is_that_of_the_march(case, rho_inf, damping):
    """Bursts of sines under Gauss's bell, whose spectrum has fallen to rounding at the edge of the
    band.

    Ratios of modes, which no march knows, against all modes.
    """
    structure, h = case
    scheme, steps, tolerance = GeneralizedAlpha(rho_inf), 400, 1e-6
    band = half_nyquist(h, scheme)
    modes, _, _ = krylov_modes(Request(structure, damping, band, tolerance))
    if damping is RATIO:
        g = sample_kernel(all_modes(structure, damping), h, scheme, steps).g
    else:
        g = march_kernel(structure, damping, h, scheme, steps).g
    assert response_error(modes, g, band, steps) < tolerance


def response_error(modes, g, band, steps):
    """The largest error of the responses to bursts at each dof, next to those by the kernel g."""
    found = sample_kernel(modes, band.h, band.scheme, steps).g
    t = band.h * np.arange(steps + 1)
    width = 7.0 / (2 * np.pi * 0.3 * band.limit)
    bell = np.exp(-0.5 * ((t - 9.0 * width) / width) ** 2)
    n_c, errors = g.shape[1], []
    for fraction in (0.1, 0.4, 0.7):
        burst = bell * np.sin(2 * np.pi * fraction * band.limit * t)
        # Displacements and rotations by their own scales: what the same burst makes of each where
        # it acts.
        scale = np.array(
            [np.abs(convolve(g[:, i : i + 1, i : i + 1], burst[:, None])).max() for i in range(n_c)]
        )
        for j in range(n_c):
            p = burst[:, None] * np.eye(n_c)[j]
            missed = np.abs(convolve(found, p) - convolve(g, p)).max(axis=0)
            errors.append((missed / np.sqrt(scale * scale[j])).max())
    return max(errors)


@pytest.mark.parametrize("damping", [NONE, RAYLEIGH, RATIO])
def test_a_step_much_finer_than_the_band_takes_few_blocks_more(case, damping):
    """Those of a step that fits the band, and a few blocks for g[0]; and what they give holds for
    steps between too.
    """
    structure, h = case
    tolerance, fine, scheme = 1e-6, h / 50, GeneralizedAlpha(0.9)
    truth, blocks = all_modes(structure, damping), []
    for step in (h, fine):
        band, told = Band(step, scheme, 0.25 / h), []
        modes, _, stated = krylov_modes(
            Request(structure, damping, band, tolerance, watch=told.append)
        )
        assert band.error(modes, truth) <= stated * 3.0 + 1e-8
        blocks.append(int(told[-1].split()[0]))
    assert blocks[1] <= blocks[0] + 10
    for step in np.geomspace(fine, h, 7):
        g, exact = (sample_kernel(m, step, scheme, 1).g for m in (modes, truth))
        assert difference(g, exact)[0] < tolerance
        if step < h / 8:  # coarser ones bend the end of the band
            assert replace(band, h=step).error(modes, truth) < tolerance


def test_low_frequencies_do_not_drown_in_the_rounding_of_high_ones(beam_body, beam, section):
    """400 elements at 1 us: eigenvalues over eleven orders, and still the first frequency of a free
    beam.

    f = (beta L)^2 / (2 pi L^2) sqrt(EI / m) in both planes. Rounding of K itself leaves some 1e-8.
    """
    structure = assemble(beam_body(beam(400)))
    modes, _, stated = krylov_modes(
        Request(structure, NONE, half_nyquist(1e-6, GeneralizedAlpha(0.9)), 1e-6)
    )
    first = (
        4.730040744862704**2
        / (2 * np.pi * 0.5**2)
        * np.sqrt(section["EI_y"] / section["mass_per_length"])
    )
    np.testing.assert_allclose(modes.frequencies[:2], first, rtol=1e-7)
    assert modes.omega[-1] > 1e5 * modes.omega[0]
    # Resonances of a damping ratio of 0.1 % feel it five hundred times.
    assert 1e-6 < stated <= 1e-4


# What comes of it


def test_an_exhausted_space_gives_the_exact_kernel(beam_body, beam):
    """Three elements have 18 elastic modes, all of which the ends excite: after two blocks there is
    nothing to add.
    """
    structure = assemble(beam_body(beam(3)))
    band = half_nyquist(1e-4, GeneralizedAlpha(0.9))
    modes, _, error = krylov_modes(Request(structure, NONE, band, 1e-12))
    truth = elastic_shapes(structure, NONE)[0]
    assert error <= 1e-13
    assert len(modes.omega) == 18
    g, expected = (sample_kernel(m, 1e-4, band.scheme, 1000).g for m in (modes, truth))
    assert difference(g, expected).max() < 1e-9


def test_a_band_above_all_modes_of_a_coarse_mesh_gives_all_of_them(solid_body, box):
    """Then nothing is left beyond the band that could be condensed."""
    impulse = {"step": 1e-8, "steps": 2}
    made = {
        method: build(
            solid_body(
                box("tetra", (0.1, 0.1, 0.1), (2, 2, 1)), impulse={**impulse, "method": method}
            )
        )
        for method in ("krylov", "modal")
    }
    found, right = made["krylov"], made["modal"]
    assert found.kernel.band > right.modes.frequencies.max()
    for name in ("compliance", "accelerance"):
        expected = getattr(right, name)
        np.testing.assert_allclose(getattr(found, name), expected, atol=1e-9 * expected.max())


def test_shapes_are_the_modes_of_the_whole_mesh(block):
    """At the interfaces phi; everywhere mass-normalized, elastic, and with stiffness omega^2; by
    both methods.
    """
    structure, h = block
    krylov = krylov_modes(Request(structure, NONE, half_nyquist(h, GeneralizedAlpha(0.9)), 1e-6))[
        :2
    ]
    identity = structure.M.tocsr() * 0
    identity.setdiag(1.0)
    for modes, shapes in (krylov, elastic_shapes(structure, NONE)):
        np.testing.assert_allclose(
            shapes(structure.P_C), modes.phi, rtol=0, atol=1e-12 * np.abs(modes.phi).max()
        )
        phi = shapes(identity)
        np.testing.assert_allclose(
            phi.T @ structure.M @ phi, np.eye(len(modes.omega)), rtol=0, atol=1e-11
        )
        np.testing.assert_allclose(phi.T @ structure.M @ structure.U, 0.0, rtol=0, atol=1e-11)
        K = phi.T @ structure.K @ phi
        np.testing.assert_allclose(
            K, np.diag(modes.omega**2), rtol=0, atol=1e-9 * modes.omega[-1] ** 2
        )


def test_a_superelement_states_its_error_and_what_it_is_good_for(solid_body, box):
    impulse = {"step": 2e-5, "steps": 100, "method": "krylov", "tolerance": 1e-4}
    body = solid_body(box("hexahedron20", (0.5, 0.1, 0.1), (4, 1, 1)), impulse=impulse)
    element = build(body)
    assert (element.provenance.method, element.provenance.tolerance) == ("krylov", 1e-4)
    assert 0.0 < element.kernel.error <= 1e-4
    assert element.kernel.band == pytest.approx(12500.0)
    assert element.modes.h_min == pytest.approx(2e-5)
    wide = build(
        solid_body(box("hexahedron20", (0.5, 0.1, 0.1), (4, 1, 1)), impulse=impulse | {"band": 2e4})
    )
    assert wide.modes.h_min == pytest.approx(1.25e-5)
    narrow = build(
        solid_body(box("hexahedron20", (0.5, 0.1, 0.1), (4, 1, 1)), impulse=impulse | {"band": 2e3})
    )
    assert narrow.modes.h_min == pytest.approx(2e-5)
    assert len(narrow.modes.omega) < len(element.modes.omega) < len(wide.modes.omega)


@pytest.mark.parametrize("short_of", ["vectors", "memory"])
def test_a_tolerance_out_of_reach_says_how_far_it_came(block, monkeypatch, short_of):
    structure, h = block
    if short_of == "vectors":
        monkeypatch.setattr("duhamel.preprocess.responses.krylov.MAX_KRYLOV_VECTORS", 30)
    else:
        for place in ("available", "scratch"):
            monkeypatch.setattr(
                f"duhamel.preprocess.responses.krylov.{place}", lambda: 8 * structure.n_u * 30
            )
    message = (
        r"an error of 1e-06 up to 25000 Hz takes more than the \d\d vectors that there is time "
        r"and memory for, "
        r"found \d\.\de[+-]\d\d with \d+: raise impulse.tolerance, lower impulse.band, "
        r"or use method march"
    )
    with pytest.raises(MethodError, match=message):
        krylov_modes(Request(structure, NONE, half_nyquist(h, GeneralizedAlpha(0.9)), 1e-6))


def test_no_room_for_the_fewest_blocks_is_told(block, monkeypatch):
    structure, h = block
    n_c = structure.P_C.shape[0]
    room = 6 + 2 * n_c - 1
    monkeypatch.setattr("duhamel.preprocess.responses.krylov.MAX_KRYLOV_VECTORS", room)
    message = f"2 blocks of {n_c} vectors, the fewest, take more than the {room} vectors that there"
    with pytest.raises(MethodError, match=message):
        krylov_modes(Request(structure, NONE, half_nyquist(h, GeneralizedAlpha(0.9)), 1e-6))


def test_the_error_holds_an_inexact_first_block(block):
    """Which is solved for with the matrix of the time step, the others with that for the band."""
    structure, h = block
    scheme = GeneralizedAlpha(0.9)
    shift, lower = scheme.beta_prime(h), scheme.beta_prime(10.0 * h)
    solvers = {shift: iterated, lower: factorized}

    def mixed(structure, shift, name, accuracy, blocks):
        return solvers[shift](structure, shift, name, accuracy, blocks)

    assert KrylovSpace(structure, shift, lower, mixed, 1e-5).inexact
    assert not KrylovSpace(structure, shift, lower, factorized, 1e-5).inexact


@pytest.mark.parametrize("fields", [False, True])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-6, 1e-10, 1e-14])
def test_solutions_take_their_share_of_the_error(tolerance, fields):
    """Or say what more they take, where they cannot be so accurate."""
    left = unsolved_error(solution_accuracy(tolerance, fields), fields)
    assert left >= 0.1 * tolerance * (1.0 - 1e-12)
    if tolerance >= 1e-6:
        assert left == pytest.approx(0.1 * tolerance)


def test_a_mechanism_is_told(beam_body, beam, section):
    """A beam that may be twisted for nothing."""
    structure = assemble(beam_body(beam(4), section | {"GJ": 1e-30}))
    with pytest.raises(
        MeshError, match=r"expected six zero modes, found .*: the body is a mechanism"
    ):
        krylov_modes(Request(structure, NONE, half_nyquist(1e-4, GeneralizedAlpha(0.9)), 1e-6))


# Without a factor


@pytest.mark.parametrize(
    ("size", "divisions"), [((0.5, 0.25, 0.0025), (8, 4, 1)), ((2.0, 0.02, 0.02), (40, 2, 2))]
)
def test_thin_bodies_need_no_factor(solid_body, box, size, divisions):
    """A plate and a bar for whose low shift single precision is not enough: a higher one is."""
    impulse = {"step": 1e-5, "steps": 20, "band": 400.0, "method": "krylov", "solver": "iterative"}
    body = solid_body(box("hexahedron", size, divisions), impulse=impulse)
    structure = assemble(body)
    with pytest.raises(NotConvergedError, match="single precision"):
        iterated(structure, 0.1 * first_square(structure), "S", 1e-5)(structure.loads)
    found, truth = build(body), elastic_shapes(structure, NONE)[0]
    assert found.kernel.error <= 1e-5
    frequencies = found.modes.frequencies
    inside = frequencies[frequencies < 400.0]
    np.testing.assert_allclose(inside, truth.frequencies[: len(inside)], rtol=1e-6)
    scale = np.sqrt(np.diag(truth.compliance))
    missing = np.abs(found.compliance - truth.compliance) / np.outer(scale, scale)
    assert missing.max() <= 2.0 * found.kernel.error


@pytest.mark.parametrize("fields", [False, True])
@pytest.mark.parametrize("h", [2e-6, 1e-5, 6e-5])
def test_the_stated_error_holds_without_a_factor(solid_body, box, h, fields):
    """Solutions are only as accurate as the tolerance needs; its share is in the stated error."""
    structure = assemble(solid_body(box("tetra10", (0.3, 0.1, 0.05), (6, 2, 1))))
    tolerance = 1e-5
    band = half_nyquist(h, GeneralizedAlpha(0.9))
    exact, better = elastic_shapes(structure, NONE)
    modes, shapes, stated = krylov_modes(
        Request(structure, NONE, band, tolerance, fields, solver=iterated)
    )
    true = band.error(modes, exact)
    if fields:
        everywhere = sp.eye_array(structure.n_u, format="csr")
        turn = better(everywhere).T @ (structure.M @ shapes(everywhere))
        true = max(true, band.field_error(modes, exact, turn))
    assert 0.1 * tolerance <= stated <= tolerance
    assert true <= stated
    inside = exact.frequencies < band.limit
    np.testing.assert_allclose(modes.omega[: inside.sum()], exact.omega[inside], rtol=1e-6)
    np.testing.assert_allclose(
        modes.compliance, exact.compliance, atol=1e-6 * np.abs(exact.compliance).max()
    )


def test_a_basis_that_memory_does_not_hold_is_in_a_file(solid_body, box, monkeypatch):
    """The same vectors, in a temporary file."""
    structure = assemble(solid_body(box("tetra10", (0.3, 0.1, 0.05), (6, 2, 1))))
    spaces = [KrylovSpace(structure, GeneralizedAlpha(0.9).beta_prime(1e-5))]
    enough = 8 * structure.n_u * 50
    monkeypatch.setattr("duhamel.preprocess.responses.krylov.available", lambda: enough)
    shift = GeneralizedAlpha(0.9).beta_prime(1e-5)
    spaces.append(KrylovSpace(structure, shift, None, iterated, 1e-12))
    for space in spaces:
        while space.blocks < 6 and space.grow():
            pass
    assert [space.basis.in_file for space in spaces] == [False, True]
    assert spaces[1].room > spaces[1].basis.columns
    one, other = (space.ritz(6)[0] for space in spaces)
    np.testing.assert_allclose(one[:20], other[:20], rtol=1e-7)


# Solvers of large bodies


@pytest.mark.parametrize(("finer", "matrices"), [(1, 1), (50, 2)])
def test_the_matrix_of_the_step_is_solved_with_only_where_it_is_far_above_the_band(
    block, finer, matrices
):
    """Both ways g[0] is right: of what a load does within the step."""
    structure, h = block
    band, shifts = Band(h / finer, GeneralizedAlpha(0.9), 0.25 / h), []

    def counted(structure, shift, *others):
        shifts.append(shift)
        return factorized(structure, shift, *others)

    modes, _, stated = krylov_modes(Request(structure, NONE, band, 1e-6, solver=counted))
    assert len(shifts) == matrices
    truth = all_modes(structure, NONE)
    g, exact = (sample_kernel(m, band.h, band.scheme, 1).g for m in (modes, truth))
    assert difference(g, exact)[0] <= stated + 1e-8


@pytest.mark.parametrize(("wrong", "tolerance"), [("noise", 1e-6), ("stiffness", 1e-4)])
def test_what_quick_solutions_miss_is_corrected_and_stated(block, wrong, tolerance):
    """Displacements with noise, and those of a body that is stiffer even as a rigid one."""
    structure, h = block
    noise = 1.0 + 1e-5 * np.random.default_rng(0).standard_normal((structure.n_u, 1))
    D = sp.diags_array(noise[:, 0])
    stiffer = replace(structure, K=(D @ structure.K @ D).tocsc())
    band, truth = half_nyquist(h, GeneralizedAlpha(0.9)), all_modes(structure, NONE)

    class Rough(Patient):
        def __init__(self, structure, *others):
            exact, stiff = factorized(structure, *others), factorized(stiffer, *others)
            super().__init__(exact, lambda: exact)
            self._quick = stiff if wrong == "stiffness" else lambda b: noise * exact(noise * b)

        @property
        def quick(self):
            return self._quick

    modes, _, stated = krylov_modes(Request(structure, NONE, band, tolerance, solver=Rough))
    assert stated <= tolerance
    assert band.error(modes, truth) <= stated + 1e-8
    inside = modes.frequencies < band.limit
    np.testing.assert_allclose(
        modes.omega[inside], truth.omega[: inside.sum()], rtol=max(1e-2 * tolerance, 1e-10)
    )
