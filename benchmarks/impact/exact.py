"""Exact impacts of rods, of a sphere on a beam and of an arm on a stop; nothing of the package.

Rods: d'Alembert's waves, in B. de Saint-Venant, J. de mathematiques pures et appliquees 12 (1867)
237-376. Sphere on beam: S. Timoshenko, Zeitschrift fuer Mathematik und Physik 62 (1913) 198-209;
the arm by his integral equation, with the modes of a beam that is hinged at one end.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]

ROUNDING = 1e-15
"""Change of a penetration, relative to that without a force, that ends an iteration."""
ITERATIONS = 50


@dataclass(frozen=True)
class Rod:
    """A uniform rod: length [m], EA [N], mass_per_length [kg/m]."""

    length: float
    EA: float
    mass_per_length: float

    @property
    def wave_speed(self) -> float:
        """c = sqrt(EA / mass_per_length) [m/s]"""
        return float(np.sqrt(self.EA / self.mass_per_length))

    @property
    def impedance(self) -> float:
        """Z = EA / c [N s/m], force per jump of velocity."""
        return self.EA / self.wave_speed

    @property
    def mass(self) -> float:
        return self.mass_per_length * self.length

    @property
    def there_and_back(self) -> float:
        """2 L / c [s]: after it the far end is felt."""
        return 2.0 * self.length / self.wave_speed


@dataclass(frozen=True)
class RodImpact:
    """A constant force [N] for a time [s], and the mean velocities [m/s] after it."""

    force: float
    duration: float
    velocities: tuple[float, float]

    @property
    def impulse(self) -> float:
        return self.force * self.duration


def rod_on_wall(rod: Rod, speed: float) -> RodImpact:
    """Z v until the wave has been at the free end and back; then the rod leaves as it came."""
    return RodImpact(rod.impedance * speed, rod.there_and_back, (-speed, 0.0))


def rod_on_rod(striker: Rod, struck: Rod, speed: float) -> RodImpact:
    """Two rods of one impedance, the struck one at rest: Z v / 2 until the shorter feels its end.

    Then there is nothing left to part them: where the striker is the longer, they go on side by
    side without a force. ValueError for two impedances.
    """
    Z = striker.impedance
    if not np.isclose(Z, struck.impedance, rtol=1e-12, atol=0.0):
        raise ValueError(f"expected rods of one impedance, found {Z} and {struck.impedance} N s/m")
    duration = min(striker.there_and_back, struck.there_and_back)
    impulse = 0.5 * Z * speed * duration
    after = (speed - impulse / striker.mass, impulse / struck.mass)
    return RodImpact(0.5 * Z * speed, duration, after)


class PointImpact(Protocol):
    """A mass m [kg] of one motion meets modes, all at rest, at `speed` [m/s] with F = K d^(3/2)."""

    @property
    def m(self) -> float: ...
    @property
    def K(self) -> float: ...
    @property
    def speed(self) -> float: ...
    @property
    def weight(self) -> float:
        """The square of every mode at the point of contact, mass-normalized [1/kg]."""

    def frequencies(self, modes: int) -> Array: ...


@dataclass(frozen=True)
class SphereOnBeam:
    """A sphere of mass m [kg] meets the middle of a simply supported beam at `speed` [m/s].

    F = K d^(3/2); beam: length [m], EI [N m^2], mass_per_length [kg/m], of Euler and Bernoulli.
    """

    length: float
    EI: float
    mass_per_length: float
    m: float
    K: float
    speed: float

    @property
    def weight(self) -> float:
        return 2.0 / (self.mass_per_length * self.length)

    def frequencies(self, modes: int) -> Array:
        """omega (modes,) [rad/s] of the odd modes, (n pi / l)^2 sqrt(EI / mass_per_length)."""
        n = 2.0 * np.arange(modes) + 1.0
        omega: Array = (n * np.pi / self.length) ** 2 * np.sqrt(self.EI / self.mass_per_length)
        return omega


def timoshenko(case: int) -> SphereOnBeam:
    """The first two cases of his paper: steel, section 1 x 1 cm, 1 cm/s; E in kgf/cm^2.

    1: a beam of 15.35 cm and a sphere of 1 cm radius; 2: 30.7 cm and 2 cm.
    """
    E, nu, rho, side = 2.2e6 * 9.80665e4, 0.3, 7960.0, 0.01
    length, radius = {1: (0.1535, 0.01), 2: (0.307, 0.02)}[case]
    return SphereOnBeam(
        length=length,
        EI=E * side**4 / 12.0,
        mass_per_length=rho * side**2,
        m=rho * 4.0 / 3.0 * np.pi * radius**3,
        K=4.0 / 3.0 * E / (2.0 * (1.0 - nu**2)) * np.sqrt(radius),
        speed=0.01,
    )


@dataclass(frozen=True)
class ArmOnStop:
    """A beam of Euler and Bernoulli turns about a hinge at its root; its tip meets a stop.

    length [m], EI [N m^2], mass_per_length [kg/m]; speed [m/s] of the tip, F = K d^(3/2) on it.
    The rigid motion is that of a mass m, a third of the arm's, at the tip.
    """

    length: float
    EI: float
    mass_per_length: float
    K: float
    speed: float

    @property
    def m(self) -> float:
        return self.mass_per_length * self.length / 3.0

    @property
    def weight(self) -> float:
        """4 over the mass: tips of beams move by twice the root of the mean square."""
        return 4.0 / (self.mass_per_length * self.length)

    def frequencies(self, modes: int) -> Array:
        """omega (modes,) [rad/s], (x / l)^2 sqrt(EI / mass_per_length) with tan x = tanh x."""
        first, width = 1.25 * np.pi, 0.25 * np.pi
        guesses = first + np.pi * np.arange(modes)

        def hinged(x: float) -> float:
            return float(np.sin(x) - np.tanh(x) * np.cos(x))

        x = np.array([brentq(hinged, guess - width, guess + width) for guess in guesses])
        omega: Array = (x / self.length) ** 2 * np.sqrt(self.EI / self.mass_per_length)
        return omega


def steel_arm() -> ArmOnStop:
    """1 m of steel, 10 x 10 mm, at 1 rad/s; a ball of 5 mm at its tip, by Hertz, on steel."""
    E, nu, rho, side, ball = 2.1e11, 0.3, 7800.0, 0.01, 0.005
    return ArmOnStop(
        length=1.0,
        EI=E * side**4 / 12.0,
        mass_per_length=rho * side**2,
        K=4.0 / 3.0 * E / (2.0 * (1.0 - nu**2)) * np.sqrt(ball),
        speed=1.0,
    )


@dataclass(frozen=True, eq=False)
class History:
    """Force [N] and velocity of the striker [m/s] over time (n,) [s]."""

    time: Array
    force: Array
    velocity: Array

    @property
    def blows(self) -> "list[Contact]":
        return contacts(self.time, self.force)


def point_impact(impact: PointImpact, t_end: float, h: float, modes: int = 200) -> History:
    """Timoshenko's integral equation, with a force that is linear in time over each step h [s].

        d(t) = v t - (1/m) int (t - s) F(s) ds
                   - sum_n weight / omega_n int F(s) sin(omega_n (t - s)) ds,   F = K d^(3/2)

    The integrals of a step are exact, by what modes do under
    a linear force; the force at its end follows from Newton's method. The error is that of linear
    interpolation, of second order.
    """
    omega = impact.frequencies(modes)
    weight = impact.weight
    move = _Moves.of(omega, h)
    q, rate = np.zeros(modes), np.zeros(modes)
    x, v, force = 0.0, impact.speed, 0.0
    found = [(0.0, v)]
    for _ in range(round(t_end / h)):
        q_free, rate_free = move.free(q, rate, force)
        x_free, v_free = (
            x + h * v - h * h * force / (3.0 * impact.m),
            v - 0.5 * h * force / impact.m,
        )
        compliance = h * h / (6.0 * impact.m) + weight * move.end.sum()
        new = contact_force(x_free - weight * q_free.sum(), compliance, impact.K)
        q, rate = q_free + move.end * new, rate_free + move.end_rate * new
        x = x_free - h * h * new / (6.0 * impact.m)
        v = v_free - 0.5 * h * new / impact.m
        force = new
        found.append((force, v))
    forces, velocities = np.array(found, dtype=np.float64).T
    time: Array = h * np.arange(len(found), dtype=np.float64)
    return History(time, forces, velocities)


@dataclass(frozen=True, eq=False)
class _Moves:
    """A step of q'' + omega^2 q = F of many modes, F linear in time, from its values at both ends.

    q = cos q_0 + sin / omega q_0' + start F_0 + end F_1
    """

    omega: Array
    cos: Array
    sin: Array
    start: Array
    end: Array
    start_rate: Array
    end_rate: Array

    @classmethod
    def of(cls, omega: Array, h: float) -> "_Moves":
        a = omega * h
        cos, sin = np.cos(a), np.sin(a)
        # Where a is small the closed forms cancel: 1 - sin(a)/a = a^2/6 - a^4/120 + ...
        small = a < 1e-2
        lag = np.where(small, a**2 / 6.0 - a**4 / 120.0 + a**6 / 5040.0, 1.0 - sin / a)
        whole = 2.0 * np.sin(0.5 * a) ** 2
        ramp_rate = whole / a
        return cls(
            omega,
            cos,
            sin,
            start=(whole - lag) / omega**2,
            end=lag / omega**2,
            start_rate=(sin - ramp_rate) / omega,
            end_rate=ramp_rate / omega,
        )

    def free(self, q: Array, rate: Array, force: float) -> tuple[Array, Array]:
        """q and its rate at the end of the step, but for the force there."""
        return (
            self.cos * q + self.sin / self.omega * rate + self.start * force,
            -self.omega * self.sin * q + self.cos * rate + self.start_rate * force,
        )


def contact_force(free: float, compliance: float, K: float, exponent: float = 1.5) -> float:
    """F = K d^exponent with d = free - compliance F; no force where the bodies are apart.

    In d, where the equation is convex: Newton's method from above goes down to the solution.
    """
    if free <= 0.0:
        return 0.0
    d = free
    for _ in range(ITERATIONS):
        force = K * d**exponent
        change = (d + compliance * force - free) / (1.0 + exponent * compliance * force / d)
        d -= change
        if abs(change) <= ROUNDING * free:
            break
    return float(K * d**exponent)


@dataclass(frozen=True)
class Contact:
    """A time of contact: start and end [s], peak [N], impulse [N s]."""

    start: float
    end: float
    peak: float
    impulse: float


def contacts(time: Array, force: Array) -> list[Contact]:
    """The times at which a force acts, each from the step before it to the one after it."""
    acts = np.concatenate([[False], force > 0.0, [False]])
    edges = np.flatnonzero(np.diff(acts.astype(int)))
    found = []
    for first, after in zip(edges[::2], edges[1::2], strict=True):
        low, high = max(first - 1, 0), min(after, len(time) - 1)
        part = slice(low, high + 1)
        impulse = float(np.trapezoid(force[part], time[part]))
        found.append(
            Contact(float(time[low]), float(time[high]), float(force[part].max()), impulse)
        )
    return found
