"""What a modal test of a part has found, and how the model of it follows."""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PositiveFloat

from ...inputs import Table, Vector, expected, rule
from .values import FilePath


class MeasuredRigid(Table):
    """Rigid-body properties of the part, by scales or from CAD.

    mass [kg]: all densities are scaled so that the model has it. inertia (3,) [kg m^2]: the
    diagonal about the center of mass, in mesh axes, in place of that of the mesh.
    """

    mass: PositiveFloat | None = None
    inertia: Vector | None = None

    @rule
    def _of_a_body(self) -> None:
        if self.inertia is None:
            return
        J = np.sort(self.inertia)
        if not J[0] > 0.0 or J[0] + J[1] < J[2]:
            raise ValueError(
                "inertia: expected three positive moments, none of them larger than the sum of "
                f"the others, found {list(self.inertia)}"
            )


class Measured(Table):
    """A modal test of the part, by which the model is updated.

    modes: a table (.csv) or arrays (.npz) of frequencies [Hz], damping ratios and shapes.
    channels: a table (.csv) of the places and directions of the shapes' columns, in mesh axes [m].
    update: "frequencies" takes frequencies and damping of the test, and shapes of the mesh.
    least_mac: the modal assurance criterion from which on a measured mode is one of the mesh.
    """

    modes: FilePath
    channels: FilePath
    update: Annotated[Literal["frequencies"], expected('"frequencies"')]
    least_mac: Annotated[float, Field(gt=0.0, le=1.0), expected("a number above 0 and up to 1")] = (
        0.8
    )
    rigid: MeasuredRigid = MeasuredRigid()

    @property
    def files(self) -> tuple[Path, ...]:
        return self.modes, self.channels

    def relative_to(self, folder: Path) -> "Measured":
        return self.model_copy(
            update={"modes": folder / self.modes, "channels": folder / self.channels}
        )
