"""Loads on frames, one class for each kind, and patterns of loads on flexible bodies."""

from dataclasses import field, replace
from typing import TYPE_CHECKING, Any, ClassVar

from ...inputs.errors import did_you_mean
from ...superelement import Pattern, Superelement
from ..errors import ModelError
from ..schema.entry import Entry, entry
from ..schema.forms import ByType, Kinds, kinds_of
from ..schema.values import AxisOrVector, BodyName, FrameName, NotNegative
from ..signals.curves import Constant
from ..signals.signal import AnySignal
from ..step import loads as compiled

LOADS = Kinds()
"""the classes of loads, by their types in model files"""


@entry()
class Load(Entry, metaclass=ByType):
    """A load on a frame: the base of `Force`, `Torque` and `Drag`, which have examples.

    For a new kind of load see docs/extending.md; for an example, `Force`.

    Parameters
    ----------
    on : str
        "BODY.FRAME", or "BODY" for its center of mass.
    """

    label = "load ({type}) on {on!r}"
    group: ClassVar[str] = "loads"
    kind: ClassVar[Any]
    """the class that computes it"""

    on: FrameName

    if TYPE_CHECKING:  # a field of every load

        @property
        def signal(self) -> AnySignal: ...

    @classmethod
    def of_type(cls, type: str, on: str, *given: Any, **keys: Any) -> "Load":
        """The load of a type that model files know."""
        # Asked at each call, for users may have declared kinds of their own since.
        kinds = kinds_of(cls)
        if type not in kinds:
            known = ", ".join(map(repr, kinds))
            raise ModelError(
                f"load ({type}) on {on!r}: type: expected {known}, got {type!r}"
                f"{did_you_mean(type, kinds)}"
            )
        made: Load = kinds[type](on, *given, **keys)
        return made

    @property
    def type(self) -> str:
        return self.tag

    @property
    def unit(self) -> str:
        """The unit of its signal."""
        return ""

    @property
    def parameters(self) -> tuple[float, ...]:
        """The numbers that its kind reads at each step."""
        return ()

    def unloaded(self) -> "Load":
        """This load without the part that acts at rest, for linear analyses at rest."""
        return self


@entry()
class DirectedLoad(Load):
    """signal(t) times a direction, whose length counts.

    direction (3,): in space, or in the axes of the frame when the load follows it.
    """

    direction: AxisOrVector
    signal: AnySignal
    follower: bool = False

    @property
    def unit(self) -> str:
        return "N m" if self.kind.moment else "N"

    @property
    def parameters(self) -> tuple[float, ...]:
        # Compiled code reads numbers alone: whether it follows the frame is one of them.
        x, y, z = self.direction.tolist()
        return x, y, z, float(self.follower)

    def unloaded(self) -> Load:
        return replace(self, signal=Constant(0.0))


@LOADS.in_files("force")
@entry()
class Force(DirectedLoad):
    """A force at the origin of a frame: signal(t) times `direction`, whose length counts.

    Parameters
    ----------
    on : str
        "BODY.FRAME", or "BODY" for its center of mass.
    direction : (3,)
        In space, or in the axes of the frame if it is a follower.
    signal : signal [N]
    follower : bool

    Examples
    --------
    >>> from duhamel.solver import HalfSine
    >>> Force("beam.tip", [0.0, 1.0, 0.0], HalfSine(200.0, duration=1e-3)).follower
    False
    """

    kind: ClassVar[Any] = compiled.Force


@LOADS.in_files("torque")
@entry()
class Torque(DirectedLoad):
    """A torque on a frame: signal(t) times `direction`, whose length counts.

    Parameters
    ----------
    on : str
        "BODY.FRAME", or "BODY" for its center of mass.
    direction : (3,)
        In space, or in the axes of the frame if it is a follower.
    signal : signal [N m]
    follower : bool

    Examples
    --------
    >>> from duhamel.solver import Constant
    >>> Torque("hub", [0.0, 0.0, 1.0], Constant(5.0)).on
    'hub'
    """

    kind: ClassVar[Any] = compiled.Torque


@LOADS.in_files("drag")
@entry()
class Drag(Load):
    """A force against the velocity v of a frame in space, as of air or water at rest.

        f = -signal(t) (linear + quadratic |v|) v

    Parameters
    ----------
    on : str
        "BODY.FRAME", or "BODY" for its center of mass.
    quadratic : float [N s^2/m^2]
        Of a body in a flow 1/2 density area coefficient.
    linear : float [N s/m]
    signal : signal
        A factor, by default 1.

    Examples
    --------
    >>> Drag("sail", quadratic=0.6).linear
    0.0
    """

    kind: ClassVar[Any] = compiled.Drag

    quadratic: NotNegative = 0.0
    linear: NotNegative = 0.0
    signal: AnySignal = field(default_factory=lambda: Constant(1.0))

    def validate(self) -> None:
        if self.quadratic == 0.0 and self.linear == 0.0:
            raise self.error("expected quadratic or linear greater than 0, found neither")

    @property
    def parameters(self) -> tuple[float, ...]:
        return self.quadratic, self.linear


@LOADS.in_files("pattern")
@entry()
class PatternLoad(Entry):
    """A load pattern of a flexible body: signal(t) times the loads of its body file.

    The loads turn with the body.

    Parameters
    ----------
    body : str
    pattern : str
        That of [loads.NAME] in its body file.
    signal : signal

    Examples
    --------
    >>> from duhamel.solver import Constant
    >>> PatternLoad("wing", "lift", Constant(1.0)).pattern
    'lift'
    """

    label = "load (pattern) on {body!r}"
    group: ClassVar[str] = "loads"

    body: BodyName
    pattern: str
    signal: AnySignal

    @property
    def unit(self) -> str:
        return ""

    def unloaded(self) -> "PatternLoad":
        return replace(self, signal=Constant(0.0))

    @property
    def owner_of_pattern(self) -> str:
        """The pattern with its body, as BODY.PATTERN."""
        return f"{self.body}.{self.pattern}"

    def pattern_of(self, element: Superelement) -> Pattern:
        """The pattern among those of a superelement; `ModelError` where it has none of the name."""
        for pattern in element.patterns:
            if pattern.name == self.pattern:
                return pattern
        known = ", ".join(pattern.name for pattern in element.patterns) or "none"
        raise self.error(f"pattern: no load pattern {self.pattern!r}; there are: {known}")


AnyLoad = Load | PatternLoad
