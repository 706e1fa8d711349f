"""Square bars of ten-node tetrahedra, the same for both codes."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from duhamel.preprocess import Body

from tests.preprocess.blocks import box_mesh


@dataclass(frozen=True)
class Bar:
    """A bar along x from the origin, with its ends, `root` and `tip`, rigid.

    length and side [m]; divisions: boxes of six tetrahedra along it and across; E [Pa], nu, rho
    [kg/m^3]; step [s].
    """

    length: float
    side: float
    divisions: tuple[int, int, int]
    material: dict[str, float]
    step: float

    @property
    def unknowns(self) -> int:
        return 3 * int(np.prod([2 * n + 1 for n in self.divisions]))

    def body(self, folder: Path) -> Body:
        """The body file's contents, with the mesh in the folder."""
        mesh = box_mesh("tetra10", (self.length, self.side, self.side), self.divisions)
        mesh.points -= (0.0, 0.5 * self.side, 0.5 * self.side)
        path = folder / f"bar-{self.unknowns}.msh"
        mesh.write(path, file_format="gmsh22", binary=True)
        return Body.model_validate(
            {
                "name": "bar",
                "mesh": path,
                "material": self.material,
                "interfaces": {name: {"group": name, "kind": "rigid"} for name in ("root", "tip")},
                "impulse": {"step": self.step, "steps": 1000, "method": "krylov"},
            }
        )
