"""The validity of a run: what it has passed at most, against the limits of the method.

Values count every step, recorded or not. Up to `good` of its criterion a value costs about one per
cent of what it bears on; beyond `limit` it is warned of. Sources of the limits: docs/validity.md.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

SHOWN = 10
"""warnings of one criterion that are written out"""


@dataclass(frozen=True)
class Criterion:
    """A measure of validity.

    name: as in files; quantity: the same in words, of the `owner`, unless a check is of another
    kind; good, limit: see above; least: values may not be below the limit instead of above; advice:
    what to do beyond it.
    """

    name: str
    owner: str
    quantity: str
    unit: str
    good: float
    limit: float
    advice: str
    least: bool = False

    def verdict(self, value: float) -> str:
        """ "good", "fair", "poor" beyond the limit; "unknown" for what is no number."""
        if math.isnan(value):
            return "unknown"
        sign = -1.0 if self.least else 1.0
        if sign * value <= sign * self.good:
            return "good"
        return "fair" if sign * value <= sign * self.limit else "poor"

    def measured(self, value: float) -> str:
        """A value with its unit."""
        return f"{value:.3g} {self.unit}".rstrip()


_DIVIDE = "divide the body into several superelements"
MEND_DEFORMATION = f"{_DIVIDE}, or look at loads and units"
"""what to do where a body deforms beyond linear elasticity"""
CRITERIA = {
    criterion.name: criterion
    for criterion in (
        Criterion(
            "elastic_rotation",
            "interface",
            "elastic rotation",
            "rad",
            0.1,
            0.3,
            f"elasticity is linear: {MEND_DEFORMATION}",
        ),
        Criterion(
            "elastic_displacement",
            "interface",
            "elastic displacement over the size of its body",
            "",
            0.015,
            0.045,
            f"elasticity is linear: {MEND_DEFORMATION}",
        ),
        Criterion(
            "second_order_rotation",
            "interface",
            "elastic rotation, of second order",
            "rad",
            0.2,
            0.4,
            f"elasticity is of second order: {MEND_DEFORMATION}",
        ),
        Criterion(
            "second_order_displacement",
            "interface",
            "elastic displacement, of second order, over the size of its body",
            "",
            0.03,
            0.06,
            f"elasticity is of second order: {MEND_DEFORMATION}",
        ),
        Criterion(
            "spin",
            "body",
            "spin over the first elastic frequency",
            "",
            0.03,
            0.1,
            "there is no stiffening by rotation: let it have terms of second order, by [rotation] "
            "of its body file, which needs its mesh for that",
        ),
        Criterion(
            "spin_turn",
            "body",
            "turn in a step",
            "rad",
            0.12,
            0.15,
            "its motion may become unstable: take a smaller step or rho_inf",
        ),
        Criterion(
            "inertia_taken",
            "body",
            "part of a moment of inertia that elastic motion takes",
            "",
            0.5,
            0.9,
            f"nothing resists its turning where all is taken: {_DIVIDE}",
        ),
        Criterion(
            "joint_turn",
            "jointed body",
            "turn about a distant axis in a step over what joints bear, 0.7 (1 - rho_inf) rad",
            "",
            0.8,
            1.0,
            "forces of its joints may alternate and grow: take a smaller step or rho_inf",
        ),
        Criterion(
            "steps_per_period",
            "body",
            "steps in a period of its fastest vibration",
            "",
            20.0,
            8.0,
            "its period is wrong by several per cent: take a smaller step",
            least=True,
        ),
        Criterion(
            "kernel_error",
            "body",
            "error of impulse responses",
            "",
            0.01,
            0.05,
            "ask for a smaller error or more modes in the body file, or for a longer memory",
        ),
        Criterion(
            "kernel_band",
            "body",
            "fastest vibration over the band of the superelement",
            "",
            0.8,
            1.0,
            "make the superelement for a smaller step, a wider band or more modes",
        ),
        Criterion(
            "energy_balance",
            "model",
            "error of the energy balance over the energy that moves",
            "",
            1e-3,
            1e-2,
            "take a smaller step",
        ),
        Criterion(
            "created_energy",
            "spring",
            "energy created by its force law over the energy that moves",
            "",
            1e-3,
            1e-2,
            "the step is too large for so stiff a law: take a smaller step",
        ),
        Criterion(
            "contact_steps",
            "contact",
            "steps of the shortest, from closing to opening",
            "",
            40.0,
            20.0,
            "peak forces need 20 for 1 %: take a smaller step",
            least=True,
        ),
        Criterion(
            "contact_depth",
            "contact",
            "penetration over the radius of the ball",
            "",
            0.3,
            1.0,
            "its center is beyond the surface: take a stiffer contact, a smaller step or a larger "
            "ball",
        ),
        Criterion(
            "hertz_radius",
            "contact",
            "radius of the patch over that of the ball",
            "",
            0.17,
            1.0 / 3.0,
            "the law of Hertz is that of small patches: give a table, `law`",
        ),
        Criterion(
            "numerical_dissipation",
            "model",
            "energy that time stepping took from vibration over the energy that moves",
            "",
            1e-2,
            1e-1,
            "take a smaller step, or rho_inf nearer to 1",
        ),
        Criterion(
            "joint_opening",
            "joint",
            "opening, in rad or over the size of the model",
            "",
            1e-8,
            1e-6,
            "take a smaller tolerance or more iterations",
        ),
        Criterion(
            "motor_steps",
            "motor",
            "steps in a period of its servo, of the fastest pole at the start",
            "",
            20.0,
            8.0,
            "the servo is too fast for the step: take a smaller step, or smaller gains",
            least=True,
        ),
        Criterion(
            "missed_turn",
            "angle",
            "difference from what the rate foretold",
            "rad",
            0.25 * math.pi,
            0.5 * math.pi,
            "its full turns may be miscounted: take a smaller step",
        ),
    )
}


class UsedStep(NamedTuple):
    """The step that a criterion is about: its key in [simulation], and its size [s]."""

    key: str
    size: float


class Check(NamedTuple):
    """The value of a criterion for one owner: a body, "BODY.FRAME", ...; "" is the whole model.

    kind: what the owner is, where it is not what the criterion says; step: of criteria that count
    steps, where it is known.
    """

    criterion: Criterion
    owner: str
    value: float
    kind: str = ""
    step: UsedStep | None = None

    @classmethod
    def of(cls, name: str, value: float) -> "Check":
        """A check by its name in files, CRITERION:OWNER or CRITERION:KIND/OWNER."""
        criterion, _, owner = name.partition(":")
        kind, _, owner = owner.rpartition("/")
        return cls(CRITERIA[criterion], owner, value, kind)

    @property
    def verdict(self) -> str:
        return self.criterion.verdict(self.value)

    @property
    def warning(self) -> str:
        """One line that names the owner, the value, the limit, and what to do."""
        criterion = self.criterion
        kind = self.kind or criterion.owner
        who = f"{kind} {self.owner!r}" if self.owner else f"the {kind}"
        side = "less" if criterion.least else "more"
        return (
            f"{who}: {criterion.quantity}: {criterion.measured(self.value)}, {side} than "
            f"{criterion.measured(criterion.limit)}: {criterion.advice}{self._remedy()}"
        )

    def _remedy(self) -> str:
        """The key to change and its value, where the steps are too few."""
        if self.step is None or not 0.0 < self.value < math.inf:
            return ""
        (key, size), enough = self.step, self.criterion.good
        return f": {key} = {_rounded_down(size * self.value / enough)} s (now {size:.3g} s)"

    def with_step(self, step: float, contact_step: float) -> "Check":
        """The same of a run with these steps [s], if it counts steps."""
        if not self.criterion.least:
            return self
        in_contact = self.criterion.name == "contact_steps" and contact_step < step
        size = contact_step if self.criterion.name == "contact_steps" else step
        return self._replace(step=UsedStep("contact_step" if in_contact else "step", size))

    def distance(self) -> float:
        """An order of checks of one criterion: the larger, the worse; what is unknown is best."""
        if math.isnan(self.value):
            return -math.inf
        return -self.value if self.criterion.least else self.value


@dataclass(frozen=True)
class Validity:
    """How far a run can be trusted: `print(results.validity)` shows the worst of each criterion."""

    checks: tuple[Check, ...]

    def values(self, criterion: str) -> dict[str, float]:
        """The values of a criterion by owner."""
        return {c.owner: c.value for c in self.checks if c.criterion.name == criterion}

    @property
    def worst(self) -> tuple[Check, ...]:
        """The worst check of each criterion that applies."""
        groups = [[c for c in self.checks if c.criterion is wanted] for wanted in CRITERIA.values()]
        return tuple(max(group, key=Check.distance) for group in groups if group)

    @property
    def warnings(self) -> tuple[str, ...]:
        """A line for each check beyond its limit, the worst first."""
        return tuple(check.warning for check in self._poor())

    def brief(self) -> Iterator[str]:
        """The warnings, at most some for each criterion."""
        poor = list(self._poor())
        for criterion in CRITERIA.values():
            lines = [check.warning for check in poor if check.criterion is criterion]
            yield from lines[:SHOWN]
            if len(lines) > SHOWN:
                yield f"and {len(lines) - SHOWN} more: {criterion.quantity}"

    def __str__(self) -> str:
        rows: list[tuple[str, ...]] = [("", "worst", "of", "good", "limit", "")]
        rows += [_row(check) for check in self.worst]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ("  ".join(map(str.ljust, row, widths)) for row in rows)
        return "\n".join(line.rstrip() for line in lines)

    def _poor(self) -> Sequence[Check]:
        order = list(CRITERIA)
        poor = [check for check in self.checks if check.verdict == "poor"]
        return sorted(poor, key=lambda c: (order.index(c.criterion.name), -c.distance()))


def _rounded_down(value: float) -> str:
    """Two digits of a positive number, no more than it."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return f"{math.floor(value / unit + 1e-9) * unit:.2g}"


def _row(check: Check) -> tuple[str, ...]:
    criterion, verdict = check.criterion, check.verdict
    value = verdict if verdict == "unknown" else criterion.measured(check.value)
    limits = (f"{criterion.good:.3g}", f"{criterion.limit:.3g}")
    note = verdict if verdict in ("fair", "poor") else ""
    return (f"{criterion.quantity}", value, check.owner or criterion.owner, *limits, note)
