"""The validity of a run: what it has passed at most, against the limits of its criteria.

Values count every step, recorded or not.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from .criteria import CRITERIA, Criterion

# Of one criterion: a model of hundreds of bodies would hide the others.
MAX_SHOWN_WARNINGS = 10


class UsedStep(NamedTuple):
    """The step that a criterion is about: its key in [simulation], and its size [s].

    whole: the step of which `contact_step` must be a whole fraction; 0 for `step` itself; finest:
    the step down to which the superelements hold [s].
    """

    key: str
    size: float
    whole: float = 0.0
    finest: float = 0.0


class Check(NamedTuple):
    """The value of a criterion for one owner: a body, "BODY.FRAME", ...; "" is the whole model.

    kind: what the owner is, where it is not what the criterion says; step: of criteria that count
    steps, where it is known; cause: why the limit is passed, and what to do, where it is known.
    """

    criterion: Criterion
    owner: str
    value: float
    kind: str = ""
    step: UsedStep | None = None
    cause: str = ""

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
        return (
            f"{who}: {criterion.quantity}: {criterion.measured(self.value)} "
            f"(limit {criterion.bound(criterion.limit)}): "
            f"{self.cause}{criterion.advice}{self._remedy()}"
        )

    @property
    def sentence(self) -> str:
        """The value, its owner and the recommended range."""
        return f"{self._value} (recommended {self.criterion.bound(self.criterion.good)})"

    @property
    def beyond(self) -> str:
        """The value, its owner and the limit."""
        return f"{self._value} (limit {self.criterion.bound(self.criterion.limit)})"

    @property
    def _value(self) -> str:
        owner = f" of {self.owner}" if self.owner else ""
        return f"{self.criterion.quantity}{owner}: {self.criterion.measured(self.value)}"

    def _remedy(self) -> str:
        """The key to change and its value, where the steps are too few."""
        if self.step is None or not 0.0 < self.value < math.inf:
            return ""
        most = self.step.size * self.value / self.criterion.good
        key, size, whole, finest = self.step
        advised = _fraction(whole, most) if whole else _rounded_down(most)
        anew = ", for which superelements are made anew, by step or band in [impulse]"
        return f": {key} = {advised} s (now {size:.3g} s){anew if most < finest else ''}"

    def with_step(self, step: float, contact_step: float, finest: float = 0.0) -> "Check":
        """The same of a run with these steps [s], if it counts steps."""
        if not self.criterion.least:
            return self
        if self.criterion.name in ("contact_steps", "surface_steps") and contact_step < step:
            return self._replace(step=UsedStep("contact_step", contact_step, step, finest))
        return self._replace(step=UsedStep("step", step, finest=finest))

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
            yield from lines[:MAX_SHOWN_WARNINGS]
            if len(lines) > MAX_SHOWN_WARNINGS:
                yield f"and {len(lines) - MAX_SHOWN_WARNINGS} more: {criterion.quantity}"

    @property
    def summary(self) -> str:
        """One or two sentences: whether limits are respected, and what is not as recommended."""
        if not any(check.verdict != "unknown" for check in self.checks):
            return "No validity criterion was evaluated."
        if n := len(self._poor()):
            return f"{n} value{'s exceed their limits' if n > 1 else ' exceeds its limit'}."
        fair = [check.sentence for check in self.worst if check.verdict == "fair"]
        if not fair:
            return "All validity limits respected, all values in their recommended ranges."
        some = "One value is" if len(fair) == 1 else f"{len(fair)} values are"
        return (
            f"All validity limits respected. {some} outside the recommended range: "
            f"{'; '.join(fair)}."
        )

    def __str__(self) -> str:
        rows: list[tuple[str, ...]] = [("", "value", "where", "recommended", "limit", "")]
        rows += [_row(check) for check in self.worst]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ("  ".join(map(str.ljust, row, widths)) for row in rows)
        return "\n".join([*(line.rstrip() for line in lines), self.summary])

    def _poor(self) -> Sequence[Check]:
        order = list(CRITERIA)
        poor = [check for check in self.checks if check.verdict == "poor"]
        return sorted(poor, key=lambda c: (order.index(c.criterion.name), -c.distance()))


def _rounded_down(value: float) -> str:
    """Two digits of a positive number, no more than it."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return f"{math.floor(value / unit + 1e-9) * unit:.2g}"


def _fraction(whole: float, most: float) -> str:
    """A whole fraction of a step, no more than `most`: the largest of four digits, if one is near.

    Among fewer than twice the parts; else the largest of all, to the digits that a model needs.
    """
    least = max(2, math.ceil(whole / most - 1e-9))
    for parts in range(least, 2 * least):
        short = f"{whole / parts:.4g}"
        if math.isclose(float(short) * parts, whole, rel_tol=1e-12):
            return short
    return f"{whole / least:.12g}"


def _row(check: Check) -> tuple[str, ...]:
    criterion, verdict = check.criterion, check.verdict
    value = verdict if verdict == "unknown" else criterion.measured(check.value)
    limits = (criterion.bound(criterion.good), criterion.bound(criterion.limit))
    note = verdict if verdict in ("fair", "poor") else ""
    return (criterion.quantity, value, check.owner or criterion.owner, *limits, note)
