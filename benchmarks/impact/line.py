"""Impacts of superelements along a line: their modes in a loop of their own, without the solver.

Small motions, one point of contact. It shows what the modes of a superelement make of an impact,
and is a second opinion on the solver's contacts.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from duhamel.superelement import GeneralizedAlpha, Superelement

from .bodies import MOVING
from .exact import Array, History, contact_force


@dataclass(frozen=True, eq=False)
class Side:
    """A body as the contact feels it: modes omega (m,) [rad/s], rigid ones with 0, and shapes.

    touch (m,): the displacement of the point of contact; held (k, m): displacements that supports
    keep at zero; speed [m/s] along the line, with which it moves at the start.
    """

    omega: Array
    touch: Array
    held: Array = field(default_factory=lambda: np.zeros((0, 0)))
    speed: float = 0.0

    @classmethod
    def particle(cls, mass: float, speed: float) -> "Side":
        return cls(np.zeros(1), np.array([mass**-0.5]), np.zeros((0, 1)), speed)

    @classmethod
    def wall(cls) -> "Side":
        return cls(np.zeros(0), np.zeros(0))

    @classmethod
    def body(
        cls,
        element: Superelement,
        axis: Array,
        touch: str,
        held: tuple[str, ...] = (),
        speed: float = 0.0,
    ) -> "Side":
        """A superelement, touched and held by supports at interfaces, along `axis` (3,)."""
        modes = element.modes
        assert modes is not None
        rows = {
            name: np.concatenate(
                [_rigid(element, name, axis), axis @ modes.phi[element.rows(name)][:3]]
            )
            for name in (touch, *held)
        }
        omega = np.concatenate([np.zeros(6), modes.omega])
        fixed = np.array([rows[name] for name in held]).reshape(len(held), len(omega))
        return cls(omega, rows[touch], fixed, speed)

    def first(self, count: int) -> "Side":
        """Of its elastic modes only the first that move the point of contact."""
        moving = np.abs(self.touch) > MOVING * np.abs(self.touch).max()
        elastic = (self.omega > 0.0) & moving
        kept = np.flatnonzero((self.omega == 0.0) | (elastic & (np.cumsum(elastic) <= count)))
        return replace(
            self, omega=self.omega[kept], touch=self.touch[kept], held=self.held[:, kept]
        )

    def rates(self) -> Array:
        """Modal velocities (m,) of the body that moves as a whole: of its rigid modes alone."""
        rigid = np.where(self.omega == 0.0, self.touch, 0.0)
        share = rigid @ rigid
        return rigid * (self.speed / share) if share else rigid


def _rigid(element: Superelement, name: str, axis: Array) -> Array:
    """Displacements (6,) of an interface along `axis` by the rigid modes, mass-normalized."""
    inertias, axes = np.linalg.eigh(element.J_rot)
    turning = np.cross(axes.T, element.interface(name).X) @ axis
    return np.concatenate([axis / np.sqrt(element.mass), turning / np.sqrt(inertias)])


class _Stepped:
    """The modes of a side between two steps of generalized-alpha, without damping."""

    def __init__(self, side: Side, h: float, scheme: GeneralizedAlpha) -> None:
        self._h, self._scheme, self._stiffness = h, scheme, side.omega**2
        self._divisor = scheme.inertia_ratio + scheme.beta * h * h * self._stiffness
        self._rows = np.vstack([side.touch, *side.held])
        self._rigid = np.where(side.omega == 0.0, side.touch, 0.0)
        self.eta = np.zeros_like(side.omega)
        self.rate = side.rates()
        self._a, self._acceleration = np.zeros_like(self.eta), np.zeros_like(self.eta)
        G = scheme.beta * h * h * (self._rows / self._divisor) @ self._rows.T
        self._supports = np.linalg.solve(G[1:, 1:], np.eye(len(G) - 1))
        self._G = G
        self.compliance = float(G[0, 0] - G[0, 1:] @ self._supports @ G[1:, 0])
        """of the point of contact [m/N], at once, with the supports held"""

    def coast(self) -> float:
        """The displacement [m] of the point of contact at the end of the step without its force."""
        h, s = self._h, self._scheme
        self.eta = self.eta + h * self.rate + h * h * (0.5 - s.beta) * self._a
        self.rate = self.rate + h * (1.0 - s.gamma) * self._a
        self._carried = (s.alpha_m * self._a - s.alpha_f * self._acceleration) / (1.0 - s.alpha_f)
        self._a = -(self._stiffness * self.eta + self._carried) / self._divisor
        free = self._rows @ (self.eta + s.beta * h * h * self._a)
        self._free = free
        return float(free[0] - self._G[0, 1:] @ self._supports @ free[1:])

    def push(self, force: float) -> None:
        """Ends the step with a force [N] on the point of contact."""
        h, s = self._h, self._scheme
        supports = -self._supports @ (self._free[1:] + self._G[1:, 0] * force)
        self._a = self._a + (np.concatenate([[force], supports]) @ self._rows) / self._divisor
        self._acceleration = s.inertia_ratio * self._a + self._carried
        self.eta = self.eta + s.beta * h * h * self._a
        self.rate = self.rate + s.gamma * h * self._a

    @property
    def velocity(self) -> float:
        """[m/s] of the rigid motion at the point of contact"""
        return float(self._rigid @ self.rate)


@dataclass(frozen=True, eq=False)
class Collision(History):
    """The history of the striker, and the velocity of the struck body [m/s]."""

    struck: Array


def collide(
    striker: Side,
    struck: Side,
    K: float,
    exponent: float,
    t_end: float,
    h: float,
    rho_inf: float = 0.9,
) -> Collision:
    """Two bodies that touch at the start, F = K d^exponent at the end of each step h [s].

    Velocities are those of the rigid motions at the point of contact.
    """
    sides = [_Stepped(side, h, GeneralizedAlpha(rho_inf)) for side in (striker, struck)]
    compliance = sides[0].compliance + sides[1].compliance
    rows = [(0.0, *(side.velocity for side in sides))]
    for _ in range(round(t_end / h)):
        penetration = sides[0].coast() - sides[1].coast()
        force = contact_force(penetration, compliance, K, exponent)
        sides[0].push(-force)
        sides[1].push(force)
        rows.append((force, *(side.velocity for side in sides)))
    forces, first, second = np.array(rows, dtype=np.float64).T
    time: Array = h * np.arange(len(rows), dtype=np.float64)
    return Collision(time, forces, first, second)
