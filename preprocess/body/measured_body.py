"""The body file of a part that is known from a frequency response test alone."""

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field, NonNegativeFloat, PositiveFloat

from ...inputs import FORM_OF_NAMES, Table, Vector, expected, is_name, quoted, rule
from ...superelement import sha256
from ...superelement.validation import Array
from .impulse import Impulse
from .named_body import NamedBody
from .values import FilePath, InertiaTensor

MeasuredQuantity = Literal["accelerance", "mobility", "receptance", "impulse"]


BY_RESPONSES: Literal["frf"] = "frf"
BEYOND_BAND = 1.12
"""of the upper end of the band: the flank of a mode just above it is in it"""
LINES_OVER_SUSPENSION = 5.0
"""lowest line over the highest frequency on the cords: there these change responses by 4 %"""


class RigidPart(Table):
    """The mass [kg] of the part, its center [m] and its inertia about that [kg m^2].

    In the axes of the channels; of the part alone, without what was mounted on it. inertia:
    principal values along these axes, or a 3x3 matrix. from: "frf" takes them from the responses
    below the first resonance, where mass may be given too, and scales the inertia; the path of a
    superelement (.h5) takes them from that.
    """

    model_config = ConfigDict(populate_by_name=True)

    mass: PositiveFloat | None = None
    center: Vector | None = None
    inertia: InertiaTensor | None = None
    source: Annotated[
        Literal["frf"] | FilePath | None, expected('"frf" or the path of a superelement')
    ] = Field(default=None, alias="from")

    @rule
    def _from_one_source(self) -> None:
        own = self.given("mass", "center", "inertia")
        if self.source is None:
            if missing := [key for key in ("mass", "center", "inertia") if key not in own]:
                raise ValueError(f"expected mass, center and inertia, or from, no {missing[0]}")
            return
        allowed = {"mass"} if self.source == BY_RESPONSES else set()
        if others := sorted(set(own) - allowed):
            raise ValueError(
                f"from: expected to be alone, for {self.source} has all of them, found "
                f"{', '.join(others)} too"
            )

    @rule
    def _of_a_body(self) -> None:
        if self.inertia is None:
            return
        J = np.array(self.inertia)
        if not np.array_equal(J, J.T) or not is_inertia(J):
            raise ValueError(
                "inertia: expected three positive principal moments, none of them larger than the "
                f"sum of the others, found {J.tolist()}"
            )

    @property
    def files(self) -> tuple[Path, ...]:
        return (self.source,) if isinstance(self.source, Path) else ()

    def relative_to(self, folder: Path) -> "RigidPart":
        source = folder / self.source if isinstance(self.source, Path) else self.source
        return self.model_copy(update={"source": source})


def is_inertia(J: Array) -> bool:
    """Whether a body can have this symmetric tensor."""
    first, second, third = np.linalg.eigvalsh(J)
    return bool(first > 0.0 and first + second >= third)


class FrequencyTest(Table):
    """A test of a free part: its frequency responses, and where it was hit and measured.

    frf: responses, by UFF58 (.uff, .unv), NumPy (.npz), HDF5 (.h5) or MATLAB (.mat); quantity: what
    they are per force where the file does not say, or "impulse" for responses over time. channels
    and hits: tables (.csv) of places and directions [m]. band [Hz]: the lines that are used. window
    [1/s]: the rate of an exponential window on force and response. sensor_mass [kg]: of each
    sensor, all of which stayed mounted; it is taken away. suspension [Hz]: the highest of the six
    frequencies of the part on its cords; lines below five times that are not used. poles:
    frequencies [Hz] and damping ratios of another program, in place of the search; they are
    refined. accept: the largest misfit of the fit.
    """

    frf: FilePath
    quantity: MeasuredQuantity | None = None
    channels: FilePath
    hits: FilePath
    band: Annotated[tuple[PositiveFloat, PositiveFloat], expected("two frequencies [Hz]")]
    window: NonNegativeFloat = 0.0
    sensor_mass: NonNegativeFloat = 0.0
    suspension: PositiveFloat | None = None
    poles: (
        Annotated[
            tuple[tuple[PositiveFloat, PositiveFloat], ...],
            Field(min_length=1),
            expected("pairs of a frequency [Hz] and a damping ratio"),
        ]
        | None
    ) = None
    accept: Annotated[float, Field(gt=0.0, le=1.0), expected("a number above 0 and up to 1")] = 0.3
    rigid: RigidPart

    @rule
    def _upwards(self) -> None:
        if not self.band[0] < self.band[1]:
            raise ValueError(f"band: expected the lower frequency first, found {list(self.band)}")

    @rule
    def _poles_of_the_band(self) -> None:
        low, high = self.band[0], BEYOND_BAND * self.band[1]
        for frequency, zeta in self.poles or ():
            if not (low < frequency < high and zeta < 1.0):
                raise ValueError(
                    f"poles: expected frequencies from {low:g} to {high:g} Hz and damping ratios "
                    f"below 1, found [{frequency:g}, {zeta:g}]"
                )

    @property
    def lowest(self) -> float:
        """The frequency [Hz] from which on lines are used."""
        return max(self.band[0], LINES_OVER_SUSPENSION * (self.suspension or 0.0))

    @property
    def files(self) -> tuple[Path, ...]:
        return self.frf, self.channels, self.hits, *self.rigid.files

    def relative_to(self, folder: Path) -> "FrequencyTest":
        paths = {key: folder / getattr(self, key) for key in ("frf", "channels", "hits")}
        return self.model_copy(update={**paths, "rigid": self.rigid.relative_to(folder)})


class VirtualPoint(Table):
    """An interface at a place, which moves as the channels around it say and is loaded by hits.

    channels and hits: their labels. rotations: whether it turns too, for which it takes channels at
    three places and hits that turn it about all axes.
    """

    at: Vector
    channels: Annotated[tuple[str, ...], Field(min_length=1)]
    hits: Annotated[tuple[str, ...], Field(min_length=1)]
    rotations: bool = True


class MeasuredBody(NamedBody):
    """A body file without a mesh: a frequency response test, interfaces, and impulse responses.

    Raises
    ------
    pydantic.ValidationError
        A ValueError that names each key, what was expected and what was found.

    Examples
    --------
    >>> rigid = {"mass": 2.2, "center": [0.1, 0.0, 0.0], "inertia": [0.006, 0.026, 0.023]}
    >>> tables = {"channels": "channels.csv", "hits": "hits.csv"}
    >>> foot = {"at": [0.3, 0.0, 0.0], "channels": ["1"], "hits": ["11"], "rotations": False}
    >>> angle = MeasuredBody(
    ...     name="angle",
    ...     measured={"frf": "angle.uff", **tables, "band": [20.0, 5e3], "rigid": rigid},
    ...     interfaces={"foot": foot},
    ...     impulse={"step": 1e-5, "steps": 100},
    ... )
    >>> [path.name for path in angle.files]
    ['angle.uff', 'channels.csv', 'hits.csv']
    """

    measured: FrequencyTest
    interfaces: Annotated[dict[str, VirtualPoint], Field(min_length=1)]
    impulse: Impulse

    @rule
    def _own_names(self) -> None:
        for name in self.interfaces:
            if not is_name(name):
                raise ValueError(
                    f"interfaces: expected a name of {FORM_OF_NAMES}, found {quoted(name)}"
                )

    @rule
    def _modes_of_the_test(self) -> None:
        if others := sorted(self.impulse.model_fields_set - {"step", "steps", "rho_inf"}):
            raise ValueError(
                f"impulse: expected step, steps and rho_inf, for modes and band are those of the "
                f"test, found {', '.join(others)}"
            )

    @rule
    def _each_once(self) -> None:
        for key in ("channels", "hits"):
            labels = [x for point in self.interfaces.values() for x in getattr(point, key)]
            if twice := next((x for x in labels if labels.count(x) > 1), None):
                raise ValueError(
                    f"interfaces: expected each of {key} at one of them, found "
                    f"{quoted(twice)} twice"
                )

    @property
    def files(self) -> tuple[Path, ...]:
        return self.measured.files

    @property
    def digests(self) -> str:
        return ", ".join(map(sha256, self.files))

    def relative_to(self, folder: Path) -> "MeasuredBody":
        """A copy whose relative paths start from a folder."""
        return self.model_copy(update={"measured": self.measured.relative_to(folder)})

    def _values(self) -> dict[str, Any]:
        paths: dict[str, Any] = {"frf": True, "channels": True, "hits": True}
        if self.measured.rigid.files:
            paths["rigid"] = {"source": True}
        return self.model_dump(exclude={"measured": paths})
