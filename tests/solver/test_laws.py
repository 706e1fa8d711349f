"""Force laws by themselves: derivatives, energies, memory; each against its equation."""

import numpy as np
import pytest
from duhamel.solver import (
    BoucWenLaw,
    DamperLaw,
    MaxwellLaw,
    ModelError,
    OneSidedLaw,
    TabulatedDamperLaw,
    UserLaw,
    check_law,
)
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from .laws import LAWS, cubic

H = 0.01
GRID = 0.05
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
laws = pytest.mark.parametrize("name", LAWS)


class Path:
    """A law that is led through deformations, linear over steps of H."""

    def __init__(self, law):
        self.law = law
        self.parameters = np.array(law.parameters(), float)
        self.memory = np.array(law.memories(), float)
        self.c = 0.0
        self.law.remember(self.parameters, self.memory, np.inf, 0.0, 0.0)

    def at(self, c, h=H, rate=None):
        rate = (c - self.c) / H if rate is None else rate
        return self.law.evaluate(self.parameters, self.memory, h, c, rate)

    def step(self, c):
        """The work of the force over a step, the energies before and after it, and the force."""
        change, before = c - self.c, self.at(self.c, 0.0, 0.0)[3]
        work = sum(
            0.5 * weight * self.at(self.c + 0.5 * (1 + x) * change, 0.5 * (1 + x) * H)[0] * change
            for x, weight in zip(NODES, WEIGHTS, strict=True)
        )
        # the rate is that of the step also within it
        force, _, _, energy = self.at(c)
        self.law.remember(self.parameters, self.memory, H, c, change / H)
        self.c = c
        return work, before, energy, force


def paths(largest=0.6):
    return st.lists(
        st.integers(-100, 100).map(lambda n: largest * n / 100.0), min_size=1, max_size=8
    )


@laws
@given(ends=paths())
def test_a_law_never_gives_back_more_than_it_has_taken(name, ends):
    """Work of each part of a path less the change of the stored energy: zero or more."""
    path = Path(LAWS[name])
    for end in ends:
        # parts end at the kinks of the laws, or quadrature is not exact
        first, last = round(path.c / GRID), round(end / GRID)
        for k in range(first, last, 1 if last > first else -1):
            work, before, after, _ = path.step(GRID * (k + (1 if last > first else -1)))
            assert after >= 0.0
            assert work - (after - before) >= -1e-6 * (abs(work) + after + before)


@laws
@given(ends=paths(), last=st.floats(-0.5, 0.5), rate=st.floats(-2.0, 2.0))
def test_the_derivatives_of_a_law_by_differences(name, ends, last, rate):
    """After any past, but at its kinks, where slopes to the left and right differ."""
    path = Path(LAWS[name])
    for c in ends:
        path.step(c)
    for k, e in ((1, 1e-6), (2, 1e-6)):
        sides = [(last + s * (k == 1), rate + s * (k == 2)) for s in (-e, 0.0, e)]
        found = [path.at(c, H, r) for c, r in sides]
        left, right = np.diff([value[0] for value in found]) / e
        steepest = max(abs(value[k]) for value in found)
        if abs(left - right) < 1e-3 * steepest + 1e-9:
            assert found[1][k] == pytest.approx(0.5 * (left + right), rel=1e-4, abs=1e-7)


@laws
@given(ends=paths(), rate=st.floats(-2.0, 2.0))
def test_a_law_that_has_remembered_says_the_same_again(name, ends, rate):
    path = Path(LAWS[name])
    for c in ends:
        expected = path.at(c, H, rate)
        path.law.remember(path.parameters, path.memory, H, c, rate)
        path.c = c
        force, _, _, energy = path.at(c, 0.0, rate)
        assert force == pytest.approx(expected[0], rel=1e-13, abs=1e-14)
        assert energy == pytest.approx(expected[3], rel=1e-13, abs=1e-14)


@laws
def test_a_law_at_rest_has_no_force_at_no_deformation(name):
    law = LAWS[name]
    force, _, _, energy = Path(law).at(0.0, np.inf, 0.0)
    preload = 30.0 * 0.05 if name == "cable" else 0.0
    assert (force, energy) == (preload, 0.5 * preload * 0.05)


def test_a_stop_and_a_cable():
    stop = Path(OneSidedLaw(0.1, 50.0, 1.5))
    assert stop.at(0.3)[0] == stop.at(-0.1)[0] == 0.0
    assert stop.at(-0.5)[0] == pytest.approx(-50.0 * 0.4**1.5)
    assert stop.at(-0.5)[3] == pytest.approx(50.0 * 0.4**2.5 / 2.5)
    cable = Path(OneSidedLaw(0.1, 50.0, side="extension"))
    assert cable.at(-0.3)[0] == 0.0
    assert cable.at(0.3)[0] == pytest.approx(10.0)


def test_dampers():
    damper = Path(DamperLaw(compression=2.0, rebound=5.0))
    assert [damper.at(0.1, rate=rate)[0] for rate in (-3.0, 0.0, 3.0)] == [-6.0, 0.0, 15.0]
    curve = Path(TabulatedDamperLaw((-1.0, 0.0, 1.0, 3.0), (-4.0, 0.0, 3.0, 4.0)))
    forces = [curve.at(0.1, rate=rate)[0] for rate in (-2.0, -0.5, 0.5, 2.0, 5.0)]
    np.testing.assert_allclose(forces, [-8.0, -2.0, 1.5, 3.5, 5.0])


def bouc_wen_rate(law, sign):
    """dz/dx in one direction, x = c / D, in the form of the literature."""
    gamma = 1.0 - law.beta

    def rate(_, z):
        return 1.0 - abs(z) ** law.exponent * (gamma + law.beta * np.sign(sign * z))

    return rate


def exact_z(law, z, change):
    """z after a change of c / D: an integrator of high order, stopped where z changes its sign."""
    sign, left = np.sign(change), abs(change)
    rate = bouc_wen_rate(law, sign)

    def crossing(_, z):
        return z[0]

    crossing.terminal, crossing.direction = True, sign
    while left > 0.0:
        events = crossing if sign * z < 0.0 else None
        options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14, "events": events}
        options["max_step"] = 0.05  # beyond |z| = 1 the powers overflow
        found = solve_ivp(lambda t, y: sign * rate(t, y), (0.0, left), [z], **options)
        z, left = float(found.y[0, -1]), left - found.t[-1]
        z = 0.0 if found.status == 1 else z
    return z


@pytest.mark.parametrize(("n", "limit"), [(1.0, 1e-11), (1.5, 1e-6), (2.0, 1e-8), (10.0, 1e-7)])
@pytest.mark.parametrize("beta", [0.5, 0.8, 1.5])
def test_hysteresis_follows_its_differential_equation(n, limit, beta):
    """In few large steps as well as in small ones, over reversals."""
    law = BoucWenLaw(0.02, 500.0, 0.1, n, beta)
    for parts in (1, 7):
        path, z, last = Path(law), 0.0, 0.0
        for end in (0.03, -0.01, 0.05, -0.06, -0.05, -0.08, 0.001):
            for c in np.linspace(last, end, parts + 1)[1:]:
                z = exact_z(law, z, float(c - path.c) / 0.02)
                force = path.step(float(c))[3]
                assert force == pytest.approx(50.0 * c + 450.0 * 0.02 * z, abs=10.0 * limit)
            last = end


def test_the_area_of_a_closed_loop():
    """n = 1, beta = gamma: from z = -w to w, z = 1 - exp(-x) in loading, x = c / D; unloading is
    elastic. The area of the loop is the integral of z over both halves.
    """
    D, k, w = 0.02, 500.0, 0.9
    law, loading = BoucWenLaw(D, k), -np.log(1.0 - w)
    path = Path(law)
    path.step(D * loading)
    lost, stored = 0.0, path.at(path.c, 0.0)[3]
    for end in (D * loading - D * (w + loading), D * loading):
        for c in np.linspace(path.c, end, 41)[1:]:
            lost += path.step(float(c))[0]
    assert path.at(path.c, 0.0)[3] == pytest.approx(stored, rel=1e-10)
    # half a cycle: elastic from w to 0, then the integral of 1 - exp(-x) up to `loading`
    half = loading - w - 0.5 * w**2
    assert lost == pytest.approx(2.0 * k * D**2 * half, rel=1e-6)


@pytest.mark.parametrize("far", [50.0, 1e9, 1e300])
def test_a_saturated_hysteresis_is_plastic(far):
    path = Path(BoucWenLaw(0.02, 500.0, 0.0, exponent=2.0))
    force = path.step(far)[3]
    assert force == pytest.approx(500.0 * 0.02, rel=1e-14)
    assert path.at(far, 0.0)[0] == force


@pytest.mark.parametrize("omega", [2.0, 20.0, 200.0])
def test_the_dynamic_stiffness_of_a_maxwell_chain(omega):
    """sum k_i i omega tau_i / (1 + i omega tau_i), of a sine in 100 and 200 steps a period: order
    two, for what is exact is a piecewise linear path.
    """
    tau, k = np.array([0.02, 0.5]), np.array([5.0, 7.0])
    stiffness = (k * 1j * omega * tau / (1.0 + 1j * omega * tau)).sum()
    law, errors = MaxwellLaw(tau, k), []
    for n in (100, 200):
        parameters, memory = np.array(law.parameters()), np.array(law.memories())
        h, periods = 2.0 * np.pi / omega / n, 3 + int(4.0 * omega * tau.max())
        t = h * np.arange(1, n * periods + 1)
        forces = []
        for c in np.sin(omega * t).tolist():
            forces.append(law.evaluate(parameters, memory, h, c, 0.0)[0])
            law.remember(parameters, memory, h, c, 0.0)
        found = 2.0 / n * np.sum(np.array(forces[-n:]) * np.exp(-1j * omega * t[-n:])) * 1j
        errors.append(abs(found - stiffness) / abs(stiffness))
    assert errors[1] < 1e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_a_maxwell_chain_relaxes_exactly():
    """k_i tau_i / T (1 - exp(-T / tau_i)) exp(-t / tau_i) after a ramp over T, in any steps."""
    tau, k, T = np.array([0.02, 0.5]), np.array([5.0, 7.0]), 0.1
    path = Path(MaxwellLaw(tau, k))
    for _ in range(10):
        path.step(path.c + 0.01)
    after = k * tau / T * (1.0 - np.exp(-T / tau))
    assert path.at(0.1, 0.0)[0] == pytest.approx(0.1 * after.sum(), rel=1e-13)
    for h in (1e-9, 0.3, 1e6, np.inf):
        expected = (0.1 * after * np.exp(-h / tau)).sum()
        assert path.at(0.1, h)[0] == pytest.approx(expected, rel=1e-12, abs=1e-15)


REFUSED = {
    "a stop without stiffness": (lambda: OneSidedLaw(0.1, 0.0), "stiffness: expected a positive"),
    "a stop with a soft exponent": (lambda: OneSidedLaw(0.1, 1.0, 0.5), "exponent: expected a n"),
    "a stop on no side": (lambda: OneSidedLaw(0.1, 1.0, 1.0, "left"), "side: expected 'compres"),
    "a gap that is no number": (lambda: OneSidedLaw(np.nan, 1.0), "gap: expected a number of m"),
    "a damper that drives": (lambda: DamperLaw(-1.0, 1.0), "compression: expected a number of at"),
    "a curve of one point": (
        lambda: TabulatedDamperLaw((0.0,), (0.0,)),
        "a damper's curve needs two or more points",
    ),
    "a curve that goes back": (
        lambda: TabulatedDamperLaw((1.0, 0.0), (1.0, 0.0)),
        "rate: expected increasing values",
    ),
    "a curve with a force at rest": (
        lambda: TabulatedDamperLaw((-1.0, 1.0), (-1.0, 2.0)),
        "force: expected 0 at the rate 0, got 0.5",
    ),
    "a curve that drives": (
        lambda: TabulatedDamperLaw((0.0, 1.0, 2.0, 3.0), (0.0, 1.0, -1.0, 2.0)),
        "force: expected the sign of the rate, got -1 at 2, which creates energy",
    ),
    "a curve that falls at its end": (
        lambda: TabulatedDamperLaw((-1.0, 0.0, 1.0, 2.0), (-1.0, 0.0, 3.0, 2.0)),
        "force: must not fall beyond the last points",
    ),
    "a ratio beyond one": (lambda: BoucWenLaw(0.1, 1.0, 1.2), "post_yield: expected a number fro"),
    "a yield point at zero": (lambda: BoucWenLaw(0.0, 1.0), "yield_deformation: expected a posi"),
    "an exponent below one": (lambda: BoucWenLaw(0.1, 1.0, 0, 0.5), "exponent: expected a numbe"),
    "a loop that creates energy": (lambda: BoucWenLaw(0.1, 1.0, beta=0.4), "beta: expected a num"),
    "a time below zero": (
        lambda: MaxwellLaw((0.1, -0.2), (1.0, 1.0)),
        "relaxation_times: expected positive numbers, got [0.1, -0.2]",
    ),
    "a branch that pushes": (
        lambda: MaxwellLaw((0.1,), (-1.0,)),
        "stiffness: expected positive numbers",
    ),
    "branches without times": (
        lambda: MaxwellLaw((0.1,), (1.0, 2.0)),
        "expected as many relaxation_times as stiffness, got 1 and 2",
    ),
    "no branches": (lambda: MaxwellLaw((), ()), "relaxation_times: expected one or more numbers"),
    "a law that is no function": (lambda: UserLaw(3.0), "function: expected a Python function"),
    "a memory that is never set": (
        lambda: UserLaw(cubic, [1.0, 0.0], memory=[0.0]),
        "memory: expected memory and update together",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_law_with_bad_numbers_is_refused(name):
    make, message = REFUSED[name]
    with pytest.raises(ModelError) as caught:
        make()
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def untypable(parameters, memory, h, c, rate):
    return c + "text", 0.0, 0.0, 0.0


def two_numbers(parameters, memory, h, c, rate):
    return c, 1.0


def test_a_function_that_does_not_compile_is_one_line():
    with pytest.raises(ModelError, match=r"^function: untypable: No implementation of .*add"):
        UserLaw(untypable)
    with pytest.raises(ModelError, match="function: two_numbers: expected a function that returns"):
        UserLaw(two_numbers)
    with pytest.raises(ModelError, match="update: cubic: expected a function that returns nothing"):
        UserLaw(cubic, [1.0, 1.0], [0.0], cubic)


def false_slope(parameters, memory, h, c, rate):
    return c**3, 2.0 * c**2, 0.0, 0.25 * c**4


def false_damping(parameters, memory, h, c, rate):
    return 2.0 * rate, 0.0, 1.0, 0.0


def false_energy(parameters, memory, h, c, rate):
    return c, 1.0, 0.0, c**2


def forgetful(parameters, memory, h, c, rate):
    return c - memory[0], 1.0, 0.0, 0.0


def forget(parameters, memory, h, c, rate):
    memory[0] = c


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (UserLaw(false_slope), "derivative by c at c = 0.5, dc/dt = 0.3: got 0.5, expected 0.75"),
        (UserLaw(false_damping), "derivative by dc/dt at c = 0.5, dc/dt = 0.3: got 1, expected 2"),
        (UserLaw(false_energy), "force without rate at c = 0.5, dc/dt = 0.3: got 0.5, expected 1"),
        (UserLaw(forgetful, [], [0.0], forget), "force before it has remembered at c = 0.5"),
    ],
)
def test_what_is_wrong_with_a_law_is_told(law, message):
    with pytest.raises(ModelError) as caught:
        check_law(law, [0.5], [0.3])
    assert str(caught.value).startswith(f"UserLaw: {message}")


@laws
def test_the_laws_pass_the_check_for_users(name):
    check_law(LAWS[name], [0.31, -0.27], [0.4, -0.3])
