"""A model that MuJoCo has compiled, with the names of its bodies and joints."""

from collections import Counter
from pathlib import Path
from typing import Any


class CompiledModel:
    """A compiled model of MuJoCo, and what of it is left out.

    mujoco: the module; model: its `MjModel`, of which the stubs know no arrays.
    """

    def __init__(self, path: Path, mujoco: Any, model: Any) -> None:
        self.path, self.mujoco, self.model = path, mujoco, model
        self.left_out: Counter[str] = Counter()

    def leave_out(self, what: str, n: int = 1) -> None:
        if n:
            self.left_out[what] += n

    def body(self, i: int) -> str:
        return str(self.model.body(i).name) or f"body {i}"

    def joint(self, j: int) -> str:
        return str(self.model.joint(j).name) or f"{self.body(int(self.model.jnt_bodyid[j]))} joint"
