"""The bracket of the benchmarks of superelements: an angle of steel, two faces as interfaces."""

from pathlib import Path
from typing import Any

LENGTH, HEIGHT, THICKNESS = 0.2, 0.12, 0.03
STEEL = {"E": 2.1e11, "nu": 0.3, "rho": 7800.0}
ENDS = {
    "plate": ((LENGTH, 0.0, 0.0), (1.0, 0.0, 0.0)),
    "wall": ((0.0, 0.0, HEIGHT), (0.0, 0.0, 1.0)),
}
STEP, STEPS = 1e-5, 5000


def body_of(mesh: Path, **impulse: Any) -> dict[str, Any]:
    """The body of a mesh: the whole kernel, n_c = 12, to the default tolerance in the default band;
    impulse: keys of that table beside these.
    """
    return {
        "name": "bracket",
        "mesh": mesh,
        "material": STEEL,
        "interfaces": {name: {"plane": {"point": p, "normal": n}} for name, (p, n) in ENDS.items()},
        "impulse": {"step": STEP, "steps": STEPS, "method": "krylov", **impulse},
    }
