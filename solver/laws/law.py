"""Force laws: classes with the fields that users give and a compiled function.

The law of one coordinate gives, at the deformation c (the coordinate less its value at rest) and
the rate dc/dt, the force that resists, its derivatives and the energy that it stores. Each file of
this folder holds laws; to add one is to add a class:

    @force_law("stiffening")                                # its key in model files
    class StiffeningLaw(ForceLaw):
        stiffening: float                                   # [N/m^3]

        def parameters(self) -> Sequence[float]:
            return [self.stiffening]

        @staticmethod
        def evaluate(
            parameters: Array, memory: Array, h: float, c: float, rate: float
        ) -> Evaluation:
            k = parameters[0]
            return k * c**3, 3.0 * k * c**2, 0.0, 0.25 * k * c**4

A law with a past has a `memory`: `memories` are its numbers before the start, `remember` sets them
to those at the end of a step. `evaluate` sees those of the last step, which ended a time h before;
at the start h is infinite: all has been at rest for ever. A law that yields has `permanent` too,
the deformation that remains without a force, which results show.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, ClassVar, TypeVar, dataclass_transform

from ..arrays import Array
from ..compiler.marks import compiled
from ..schema.entry import Entry, FieldSpec, entry
from ..schema.forms import Family, Members

Evaluation = tuple[float, float, float, float]
"""force, its derivatives by c and by dc/dt, and stored energy (0 where the force vanishes)"""

FORCE_LAWS = Family("force law")
NO_LAW = -1
"""number of a law that is none"""


class ForceLaw(Entry):
    """A law of one coordinate: force, slopes and energy by deformation and rate.

    To add a law of your own, write a class as the head of solver/laws/law.py shows, or use
    `UserLaw` from Python alone.

    Examples
    --------
    >>> from duhamel.solver import DamperLaw
    >>> isinstance(DamperLaw(1.0, 1.0), ForceLaw)
    True
    """

    number: ClassVar[int] = NO_LAW
    """the number of the law in compiled code"""
    addresses: ClassVar[int] = 0
    """how many of the first parameters are addresses, which are others in every process"""

    def parameters(self) -> Sequence[float]:
        """The numbers that `evaluate` reads."""
        raise NotImplementedError

    def memories(self) -> Sequence[float]:
        """The numbers that the law remembers, before the start."""
        return []

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        """The law, compiled: no allocation, no exceptions, no negative indices."""
        raise NotImplementedError

    @staticmethod
    def remember(parameters: Array, memory: Array, h: float, c: float, rate: float) -> None:
        """Bring the memory to the end of a step, compiled as `evaluate` is."""

    @staticmethod
    def permanent(parameters: Array, memory: Array, c: float) -> float:
        """The deformation that has become permanent, compiled as `evaluate` is; most have none."""
        return 0.0


LAW_KINDS: list[type[ForceLaw]] = []
"""all laws by number"""
AnyLawType = TypeVar("AnyLawType", bound=type[ForceLaw])


def law_number(law: AnyLawType) -> AnyLawType:
    """Register the compiled functions of a law."""
    law.number = len(LAW_KINDS)
    compiled(law.evaluate)
    compiled(law.remember)
    compiled(law.permanent)
    LAW_KINDS.append(law)
    return law


@dataclass_transform(frozen_default=True, eq_default=True)
def force_law(key: str) -> Callable[[AnyLawType], AnyLawType]:
    """Register a law: its class as an entry of model files by a key, and its compiled function."""

    def register(kind: AnyLawType) -> AnyLawType:
        law: Any = FORCE_LAWS.in_files(key)(entry(eq=True)(kind))
        return law_number(law)  # type: ignore[no-any-return]

    return register


Laws = ForceLaw | tuple[ForceLaw, ...]
"""of one coordinate; forces of several add up"""


def laws_of(laws: Laws | None) -> tuple[ForceLaw, ...]:
    if laws is None:
        return ()
    return (laws,) if isinstance(laws, ForceLaw) else laws


def _laws(value: Any) -> Any:
    if isinstance(value, ForceLaw):
        return value
    if isinstance(value, Mapping):
        return {str(name): _some(laws) for name, laws in value.items()}
    return _some(value)


def _some(value: Any) -> Laws:
    if isinstance(value, ForceLaw):
        return value
    laws = tuple(value)
    if not laws or not all(isinstance(law, ForceLaw) for law in laws):
        raise TypeError
    return laws


AnyLaws = Annotated[
    Laws | Mapping[str, Laws],
    Members(FORCE_LAWS),
    FieldSpec("a force law such as TabulatedLaw, or several, or a table of them by axis", _laws),
]
"""laws of one coordinate, or of several by their names"""
