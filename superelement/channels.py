"""Channels: the responses of load patterns and sensors, beside those of the interfaces."""

from dataclasses import dataclass, replace

import numpy as np

from ..files.arrays import Array
from .kernel import Kernel
from .modes import Modes
from .pattern import Pattern
from .sensor import Sensor
from .validation import SuperelementError, check_symmetric, checked


@dataclass(frozen=True, eq=False)
class Channels:
    """The responses of load patterns and sensors.

    There is a row for each pattern, then come the rows of each sensor.

        y = phi eta,     eta'' + 2 zeta omega eta' + omega^2 eta = phi_C^T p + phi_patterns^T s

    The y of a pattern is the displacement that its amplitude s does work on, int t . u dA; that of
    a sensor is its reading. Neither includes rigid motion.

    Parameters
    ----------
    patterns : tuple of Pattern
    sensors : tuple of Sensor
    phi : (n, m), optional
        Modes at the channels. A body without modes has the next three instead, of interfaces and
        channels together.
    kernel : Kernel, optional
    compliance, accelerance : (n_c + n, n_c + n), optional

    Raises
    ------
    SuperelementError
        For equal names, and matrices of wrong shape or without symmetry.

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel.superelement import Pattern, Sensor
    >>> wind = Pattern("wind", force=np.array([0.0, 5.0, 0.0]), moment=np.zeros(3))
    >>> gauge = Sensor("gauge", "stress", X=np.array([0.2, 0.0, 0.0]))
    >>> channels = Channels((wind,), (gauge,), phi=np.zeros((7, 2)))
    >>> channels.n, channels.pattern_row("wind"), channels.rows_of_sensors()
    (7, 0, {'gauge': slice(1, 7, None)})
    """

    patterns: tuple[Pattern, ...]
    sensors: tuple[Sensor, ...]
    phi: Array | None = None
    kernel: Kernel | None = None
    compliance: Array | None = None
    accelerance: Array | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "patterns", tuple(self.patterns))
        object.__setattr__(self, "sensors", tuple(self.sensors))
        for kind, entries in (("patterns", self.patterns), ("sensors", self.sensors)):
            names = [entry.name for entry in entries]
            if len(set(names)) != len(names):
                raise SuperelementError(f"{kind}: expected different names, found {names}")
        # Frozen dataclasses can replace what was given only in this way, here by checked arrays.
        if self.phi is not None:
            object.__setattr__(self, "phi", checked("channels: phi", self.phi, (self.n, "m")))
        for name in ("compliance", "accelerance"):
            if (matrix := getattr(self, name)) is not None:
                matrix = checked(f"channels: {name}", matrix, ("n", "n"))
                check_symmetric(f"channels: {name}", matrix)
                object.__setattr__(self, name, matrix)

    @property
    def n(self) -> int:
        """The number of rows."""
        return len(self.patterns) + sum(len(sensor.channels) for sensor in self.sensors)

    def pattern_row(self, name: str) -> int:
        """The row of a pattern; `SuperelementError` where there is none of this name."""
        names = [pattern.name for pattern in self.patterns]
        if name not in names:
            raise SuperelementError(
                f"no load pattern {name!r}; there are: {', '.join(names) or 'none'}"
            )
        return names.index(name)

    def rows_of_sensors(self) -> dict[str, slice]:
        """The rows of each sensor, by name."""
        rows, first = {}, len(self.patterns)
        for sensor in self.sensors:
            rows[sensor.name] = slice(first, first + len(sensor.channels))
            first += len(sensor.channels)
        return rows

    def check_sizes(self, n_c: int, modes: Modes | None) -> None:
        """Raise `SuperelementError` unless the arrays fit n_c interface dofs and some modes."""
        if modes is not None:
            found = None if self.phi is None else self.phi.shape[1]
            if found != len(modes.omega):
                raise SuperelementError(
                    f"channels: phi: expected {len(modes.omega)} columns, one per mode, "
                    f"found {found}"
                )
            return
        n = n_c + self.n
        kernel = 0 if self.kernel is None else self.kernel.n_c
        matrices = [0 if A is None else len(A) for A in (self.compliance, self.accelerance)]
        if {kernel, *matrices} != {n}:
            raise SuperelementError(
                f"channels: of a body without modes expected a kernel, compliance and accelerance "
                f"of {n} rows, found {kernel}, {matrices[0]} and {matrices[1]}"
            )

    def complete(self, modes: Modes) -> Modes:
        """Modes at interfaces and channels: phi (n_c + n, m)."""
        assert self.phi is not None
        return replace(modes, phi=np.vstack([modes.phi, self.phi]))
