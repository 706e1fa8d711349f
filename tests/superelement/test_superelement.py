"""What the parts of a superelement refuse, how rows are counted, and which kernel is handed out."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.superelement import (
    GeneralizedAlpha,
    Interface,
    Modes,
    Recovery,
    SuperelementError,
    sample_kernel,
    von_mises,
)


def refused(message):
    return pytest.raises(SuperelementError, match=message)


@pytest.mark.parametrize("name", ["", "hub.rim", "hub/rim", "two\nlines", "nul\0"])
def test_interface_names_are_one_line_without_separators(name):
    with refused("interface name: expected one line without '/' and '.', found"):
        Interface(name, [0, 0, 0])


def test_an_interface_stands_at_one_finite_point():
    with refused(r"interface 'tip': X: expected shape \(3,\), found \(2,\)"):
        Interface("tip", [0, 0])
    with refused(r"interface 'tip': X: expected finite numbers, found inf at index \(2,\)"):
        Interface("tip", [0, 0, np.inf])
    with refused(r"interface 'tip': X: expected numbers of shape \(3,\), found others"):
        Interface("tip", [0, [1], 0])
    with refused(r"interface 'tip': X: expected shape \(3,\), found \(\)"):
        Interface("tip", None)


@pytest.mark.parametrize(
    ("omega", "zeta", "phi", "message"),
    [
        (
            [1.0, 0.0],
            [0, 0],
            np.ones((3, 2)),
            "modes: omega: expected positive frequencies, found 0.0 rad/s",
        ),
        ([1.0, 2.0], [0, -1], np.ones((3, 2)), "modes: zeta: expected ratios >= 0, found -1.0"),
        ([1.0, 2.0], [0], np.ones((3, 2)), r"modes: zeta: expected shape \(2,\), found \(1,\)"),
        (
            [1.0, 2.0],
            [0, 0],
            np.ones((3, 1)),
            r"modes: phi: expected shape \(n_c, 2\), found \(3, 1\)",
        ),
        ([[1.0]], [0], np.ones((3, 1)), r"modes: omega: expected shape \(m,\), found \(1, 1\)"),
    ],
)
def test_modes_that_contradict_themselves_are_refused(omega, zeta, phi, message):
    with refused(message):
        Modes(omega, zeta, phi)


def test_frequencies_are_in_hertz():
    modes = Modes([2 * np.pi, 20 * np.pi], [0, 0], np.ones((3, 2)))
    np.testing.assert_allclose(modes.frequencies, [1.0, 10.0], rtol=1e-15)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"points": np.zeros((4, 2))},
            r"recovery: points: expected shape \(p, 3\), found \(4, 2\)",
        ),
        (
            {"phi": np.zeros((3, 3, 2))},
            r"recovery: phi: expected shape \(4, 3, m\), found \(3, 3, 2\)",
        ),
        (
            {"stress": np.zeros((4, 5, 2))},
            r"recovery: stress: expected shape \(4, 6, 2\), found \(4, 5, 2\)",
        ),
        ({"cells": [[0, 4]]}, "recovery: cells: expected point indices from -1 to 3, found 0 to 4"),
        (
            {"cells": [[0, -2]]},
            "recovery: cells: expected point indices from -1 to 3, found -2 to 0",
        ),
        (
            {"cells": [[0.0, 1.0]]},
            r"recovery: cells: expected integers of shape \(n, k\), found float64 \(1, 2\)",
        ),
        (
            {"cells": [0, 1]},
            r"recovery: cells: expected integers of shape \(n, k\), found int64 \(2,\)",
        ),
        (
            {"nodes": [1, 2]},
            r"recovery: nodes: expected integers of shape \(4\), found int64 \(2,\)",
        ),
    ],
)
def test_a_surface_that_contradicts_itself_is_refused(change, message):
    fields = {
        "points": np.zeros((4, 3)),
        "cells": [[0, 1, 2, -1]],
        "phi": np.zeros((4, 3, 2)),
        "stress": None,
    }
    with refused(message):
        Recovery(**fields | change)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"name": ""}, "name: expected one line of text, found ''"),
        ({"mass": 0.0}, "mass: expected a positive number, found 0.0"),
        ({"mass": float("nan")}, "mass: expected a positive number, found nan"),
        ({"J_rot": np.eye(2)}, r"J_rot: expected shape \(3, 3\), found \(2, 2\)"),
        (
            {"J_rot": np.diag([1.0, 2.0, 0.0])},
            r"J_rot: expected positive principal inertias, found \[0\.0, 1\.0, 2\.0\]",
        ),
        ({"J_rot": [[1, 1, 0], [0, 1, 0], [0, 0, 1]]}, "J_rot: expected a symmetric matrix"),
        ({"center": [0.0]}, r"center: expected shape \(3,\), found \(1,\)"),
        (
            {"interfaces": (Interface("a", [0, 0, 0]),)},
            r"kernel: g: expected 6 rows, .*\['a'\], found 9",
        ),
        (
            {"modes": Modes([1.0], [0.0], np.ones((8, 1)))},
            r"modes: phi: expected 9 rows, .* found 8",
        ),
        ({"modes": None}, "recovery: phi: expected 0 columns, one per mode, found 4"),
        ({"compliance": np.eye(8)}, r"compliance: expected shape \(9, 9\), found \(8, 8\)"),
        (
            {"accelerance": np.triu(np.ones((9, 9)))},
            r"accelerance: expected a symmetric matrix, found entries \(0, 1\)",
        ),
    ],
)
def test_a_body_that_contradicts_itself_is_refused(change, message, make_element):
    with refused(message):
        replace(make_element(), **change)


def test_two_interfaces_of_one_name_are_refused(make_element):
    element = make_element(rotations=(True, True))
    with refused(r"interfaces: expected different names, found \['face 0', 'face 0'\]"):
        replace(element, interfaces=(element.interfaces[0],) * 2)


def test_rows_follow_the_interfaces_in_their_order(make_element):
    element = make_element(rotations=(True, False, True))
    rows = [element.rows(interface.name) for interface in element.interfaces]
    assert rows == [slice(0, 6), slice(6, 9), slice(9, 15)]
    assert element.n_c == 15
    assert element.interface("face 1") is element.interfaces[1]


def test_an_unknown_interface_names_the_known_ones(make_element):
    with refused("body 0: no interface 'tip'; it has: face 0, face 1"):
        make_element().rows("tip")


def test_arrays_cannot_be_changed_and_do_not_follow_their_source():
    source = np.ones((3, 2))
    modes = Modes([1.0, 2.0], [0, 0], source)
    source[:] = 7.0
    assert (modes.phi == 1.0).all()
    with pytest.raises(ValueError, match="read-only"):
        modes.phi[0, 0] = 2.0


# The kernel for a step, a scheme and a number of steps


@pytest.mark.parametrize("steps", [1, 7])
def test_the_stored_kernel_is_handed_out_where_it_fits(steps, make_element):
    element = make_element()
    assert element.kernel_for(1e-4 * (1 + 1e-15), GeneralizedAlpha(0.8), steps) is element.kernel


@pytest.mark.parametrize(
    ("h", "rho_inf", "steps"), [(5e-5, 0.8, 7), (1e-4, 0.9, 7), (1e-4, 0.8, 8)]
)
def test_another_kernel_comes_from_the_modes_and_keeps_their_error(h, rho_inf, steps, make_element):
    element = make_element()
    kernel = element.kernel_for(h, GeneralizedAlpha(rho_inf), steps)
    expected = sample_kernel(element.modes, h, GeneralizedAlpha(rho_inf), steps)
    assert (kernel.h, kernel.scheme.rho_inf, kernel.steps) == (h, rho_inf, steps)
    assert kernel.error == element.kernel.error
    np.testing.assert_array_equal(kernel.g, expected.g)
    np.testing.assert_array_equal(kernel.g_initial, expected.g_initial)


def test_a_longer_kernel_continues_the_stored_one(make_element):
    element = make_element()
    longer = element.kernel_for(1e-4, GeneralizedAlpha(0.8), 20)
    np.testing.assert_allclose(
        longer.g[:8], element.kernel.g, rtol=0, atol=1e-15 * np.abs(element.kernel.g).max()
    )


@pytest.mark.parametrize(
    ("h", "rho_inf", "steps"), [(5e-5, 0.8, 7), (1e-4, 0.9, 7), (1e-4, 0.8, 8)]
)
def test_without_modes_another_kernel_is_refused(h, rho_inf, steps, make_element):
    element = replace(make_element(), modes=None, recovery=None)
    message = (
        "body 0: no modes, so the kernel is fixed: h = 0.0001 s, rho_inf = 0.8, 7 steps; "
        f"asked for h = {h} s, rho_inf = {rho_inf}, {steps} steps"
    )
    with refused(message):
        element.kernel_for(h, GeneralizedAlpha(rho_inf), steps)
    assert element.kernel_for(1e-4, GeneralizedAlpha(0.8), 7) is element.kernel


def test_von_mises_stress_of_tension_shear_and_pressure():
    """|sigma|, sqrt(3) |tau| in any plane, none under pressure, and that of turned axes."""
    tension, pressure = [-3.0, 0, 0, 0, 0, 0], [2.0, 2.0, 2.0, 0, 0, 0]
    shears = np.eye(6)[3:] * 2.0
    np.testing.assert_allclose(
        von_mises(np.array([tension, pressure, *shears])), [3, 0, *[2 * 3**0.5] * 3], atol=1e-15
    )
    # shear is tension and compression across each other, at 45 degrees
    assert von_mises(np.array([2.0, -2.0, 0, 0, 0, 0])) == pytest.approx(2 * 3**0.5, rel=1e-15)


def test_fields_are_sums_over_modes(make_element):
    recovery = make_element().recovery
    eta = np.random.default_rng(0).normal(size=(2, 3, recovery.phi.shape[2]))
    u, sigma = recovery.displacement(eta), recovery.stresses(eta)
    np.testing.assert_allclose(u, np.einsum("pim,abm->abpi", recovery.phi, eta), rtol=0, atol=1e-14)
    np.testing.assert_allclose(
        sigma, np.einsum("pim,abm->abpi", recovery.stress, eta), rtol=0, atol=1e-14
    )
    with pytest.raises(SuperelementError, match="recovery: no stress modes"):
        replace(recovery, stress=None).stresses(eta)
