"""What a user chooses of an import beside the file of the robot."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

# [s]: some 60 steps in a bounce off a stop of `STOP_FREQUENCY`.
DEFAULT_STEP = 5e-4
# [rad/s] of a stop with the largest inertia behind it, where nobody says how stiff it is.
STOP_FREQUENCY = 100.0
# Of stops, of which robots say nothing: rubber, not steel.
STOP_RESTITUTION = 0.2


@dataclass(frozen=True)
class FlexibleLink:
    """A superelement in place of a link, drawn in the axes of the link.

    Parameters
    ----------
    file : Path
    interfaces : mapping of str
        The interface of each joint of the link, by the name of the joint.

    Examples
    --------
    >>> FlexibleLink(Path("fore.h5"), {"elbow": "root", "wrist": "tip"}).interfaces["wrist"]
    'tip'
    """

    file: Path
    interfaces: Mapping[str, str]


@dataclass(frozen=True)
class ImportOptions:
    """How a robot becomes a model.

    Parameters
    ----------
    base : {"fixed", "free"}
        Whether the root link stands on the ground, or is a free body.
    servo : (2,), optional [N m/rad, N m s/rad]
        Stiffness and damping of a servo at each joint that mimics none; of slides in N/m and N s/m.
    servos : mapping of (2,)
        The same at single joints, where they differ.
    flexible : mapping of FlexibleLink
        By link.
    state : mapping of float [rad, m]
        Coordinates at the start, by joint; others start at 0.
    stop_stiffness : float, optional [N m/rad, N/m]
        Of all stops.
    packages : sequence of Path
        Folders in which package://NAME is looked for, before those around the file.
    t_end, step : float [s]
    gear_ratio : float
        Of the rotors by which armatures of MJCF are modeled.

    Examples
    --------
    >>> ImportOptions(servo=(500.0, 20.0)).base
    'fixed'
    """

    base: Literal["fixed", "free"] = "fixed"
    servo: tuple[float, float] | None = None
    servos: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    flexible: Mapping[str, FlexibleLink] = field(default_factory=dict)
    state: Mapping[str, float] = field(default_factory=dict)
    stop_stiffness: float | None = None
    packages: Sequence[Path] = ()
    t_end: float = 1.0
    step: float = DEFAULT_STEP
    gear_ratio: float = 100.0

    def __post_init__(self) -> None:
        """`ValueError` for numbers that no model takes."""
        positive = {
            "stop_stiffness": self.stop_stiffness,
            "t_end": self.t_end,
            "step": self.step,
            "gear_ratio": self.gear_ratio,
        }
        for key, value in positive.items():
            if value is not None and not 0.0 < value < math.inf:
                raise ValueError(f"{key}: expected a positive number, got {value:g}")
        everywhere = {} if self.servo is None else {"servo": self.servo}
        for key, gains in {**everywhere, **_keyed("servo_of", self.servos)}.items():
            if not all(0.0 <= gain < math.inf for gain in gains):
                raise ValueError(f"{key}: expected two gains of at least 0, got {gains}")
            if not any(gains):
                raise ValueError(f"{key}: expected a gain above 0, got two zeros")
        for joint, value in self.state.items():
            if not math.isfinite(value):
                raise ValueError(f"state: {joint}: expected a number, got {value:g}")


def _keyed(key: str, by_joint: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    return {f"{key}: {joint}": gains for joint, gains in by_joint.items()}
