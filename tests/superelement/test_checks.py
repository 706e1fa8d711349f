"""Superelements of numbers that no elastic body has are refused, and sound ones pass all checks."""

from dataclasses import replace

import h5py
import numpy as np
import pytest
from duhamel.superelement import (
    GeneralizedAlpha,
    Modes,
    SuperelementError,
    check,
    read,
    sample_kernel,
    write,
)
from duhamel.superelement.checks import powers_of_two, quick_checks
from duhamel.superelement.response import respond


def times(factor, *names):
    def change(file):
        for name in names:
            file[name][...] = factor * file[name][()]

    return change


def value(name, index, number):
    def change(file):
        file[name][index] = number

    return change


DAMAGE = {
    "compliance": (times(-1, "static/compliance"), "static/compliance: expected a positive"),
    "accelerance": (times(-1, "static/accelerance"), "static/accelerance: expected a positive"),
    "one negative": (
        value("static/compliance", (7, 7), -1e-6),
        "static/compliance: expected a p",
    ),
    "more compliance": (
        times(1.01, "static/compliance"),
        "static/compliance: expected what the",
    ),
    "less accelerance": (times(0.5, "static/accelerance"), "kernel/g: expected the start within"),
    "kernel turned": (times(-1, "kernel/g"), "kernel/g: expected a positive semidefinite matrix"),
    "kernel stronger": (times(10, "kernel/g"), "kernel/g: expected the start within"),
    "kernel weaker": (times(0.9, "kernel/g"), "kernel/g: expected what the modes give"),
    "kernel zero": (times(0, "kernel/g"), "kernel/g: expected what the modes give"),
    "initial turned": (times(-1, "kernel/g_initial"), "kernel/g_initial: expected what the modes"),
    "initial at once": (
        value("kernel/g_initial", (0, 0, 0), 1e-6),
        "kernel/g_initial: expected no displacement at once",
    ),
    "modes zero": (times(0, "modes/phi"), "static/compliance: expected what the modes give"),
    "modes slower": (times(0.99, "modes/omega"), "static/compliance: expected what the modes"),
    "modes damped": (times(1.5, "modes/zeta"), "kernel/g: expected what the modes give"),
    "zeta": (value("modes/zeta", 0, 1e300), "modes/zeta: expected magnitudes up to 1e.100"),
    "zeta too": (value("modes/zeta", 0, 1e7), "modes: zeta: expected ratios up to 1e.06, found"),
    "omega": (value("modes/omega", 0, 1e-200), "modes: omega: expected a number from 1e-100"),
    "mass": (value("rigid/mass", (), 1e-300), "mass: expected a number from 1e-100 to 1e.100"),
    "mass great": (value("rigid/mass", (), 1e300), "rigid/mass: expected magnitudes up to 1e.100"),
    "inertia small": (times(1e-200, "rigid/J_rot"), "J_rot: expected a number from 1e-100"),
    "inertia": (
        value("rigid/J_rot", ..., np.diag([1.0, 2.0, 3.1])),
        "rigid/J_rot: expected principal inertias of which two are no less than the third, found "
        r"1, 2 and 3.1 kg m\^2, an excess of 0.0323",
    ),
    "X": (value("interfaces/X", (0, 0), 1e200), "interfaces/X: expected magnitudes up to"),
}
FREE_OF_MODES = {
    name: DAMAGE[name]
    for name in ("compliance", "accelerance", "kernel turned", "kernel stronger", "initial at once")
}


def refused(path, change, message):
    with h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(SuperelementError, match=f"^{path}: {message}") as caught:
        read(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("change", "message"), DAMAGE.values(), ids=DAMAGE)
def test_numbers_that_no_body_has_are_refused_by_file_and_dataset(
    change, message, make_element, tmp_path
):
    write(tmp_path / "body.h5", make_element(m=12))
    refused(tmp_path / "body.h5", change, message)


@pytest.mark.parametrize(("change", "message"), FREE_OF_MODES.values(), ids=FREE_OF_MODES)
def test_numbers_that_no_body_has_are_refused_without_modes_too(
    change, message, make_element, tmp_path
):
    write(tmp_path / "body.h5", replace(make_element(m=12), modes=None, recovery=None))
    refused(tmp_path / "body.h5", change, message)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("rho_inf", [0.0, 0.8, 1.0])
def test_a_body_of_modes_passes_all_checks(seed, rho_inf, make_element):
    element = make_element(seed, rotations=((True,), (False,), (True, True, False))[seed % 3], m=9)
    kernel = element.kernel_for(3e-4, GeneralizedAlpha(rho_inf), 40)
    for body in (
        replace(element, kernel=kernel),
        replace(element, kernel=kernel, modes=None, recovery=None),
    ):
        assert [found for found in check(body) if not found.holds] == []


def test_a_rigid_body_without_interfaces_passes(make_element):
    assert all(found.holds for found in check(make_element(rotations=(), m=0)))


@pytest.mark.parametrize("rho_inf", [0.0, 0.6, 1.0])
def test_squaring_the_step_gives_what_stepping_gives(rho_inf, make_modes):
    """Two routes to the same lags, to rounding."""
    modes, h, scheme = make_modes(3, 6, 8), 3e-4, GeneralizedAlpha(rho_inf)
    lags, impulse, initial = powers_of_two(modes, h, scheme, 300)
    assert lags == [0, 1, 2, 4, 8, 16, 32, 64, 128, 256]
    stepped = np.array(list(respond(modes, h, scheme, [1.0, *[0.0] * 300])))[1:]
    np.testing.assert_allclose(impulse, stepped[lags], rtol=0, atol=1e-12 * np.abs(stepped).max())
    stepped = np.array(list(respond(modes, h, scheme, [0.0] * 300, acceleration=1.0)))
    np.testing.assert_allclose(initial, stepped[lags], rtol=0, atol=1e-12 * np.abs(stepped).max())


def failing(element):
    return [found.expected for found in check(element) if not found.holds]


def test_the_full_check_sees_a_single_lag(make_element):
    element = make_element(m=9)
    g = element.kernel.g.copy()
    g[5, 2, 2] *= 1.001
    damaged = replace(element, kernel=replace(element.kernel, g=g))
    assert all(found.holds for found in quick_checks(damaged))
    assert "at every lag what the modes give" in failing(damaged)


def test_a_kernel_with_rigid_motion_is_told_from_an_elastic_one(make_element):
    """Free flight that was left in."""
    element = make_element(m=9, rotations=(True, False))
    scheme = GeneralizedAlpha(0.8)
    kernel = element.kernel_for(1e-3, scheme, 2000)
    U = np.vstack([np.eye(3), np.zeros((3, 3)), np.eye(3)]) / np.sqrt(element.mass)
    free = sample_kernel(Modes(np.full(3, 1e-6), np.zeros(3), U), kernel.h, scheme, kernel.steps)
    drifting = replace(kernel, g=kernel.g + free.g)
    body = replace(element, kernel=drifting, modes=None, recovery=None)
    assert "no rigid motion" in failing(body)
    (share,) = (found.found for found in check(body) if found.expected == "no rigid motion")
    assert share == pytest.approx(1.0, rel=0.02)


def test_a_kernel_that_makes_energy_is_not_passive(make_element):
    """The published rule (55) delays by half a step, which takes passivity."""
    element = make_element(m=9)
    kernel = element.kernel_for(3e-4, GeneralizedAlpha(0.9), 200)
    late = kernel.g.copy()
    late[1:] = 0.5 * (kernel.g[1:] + kernel.g[:-1])
    late[0] = 0.5 * kernel.g[0]
    body = replace(element, kernel=replace(kernel, g=late), modes=None, recovery=None)
    assert "passivity, a positive real transform of the velocities" in failing(body)
