"""Standard Input Data of a superelement: `duhamel export SUPERELEMENT --to sid`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from ..failures import one_line
from .export import superelement_format

if TYPE_CHECKING:
    from ...superelement import Superelement

FILE_ENDING = ".SID_FEM"
DEFAULT_MODES = 20
# What the file and the command say of a superelement that does not know its second order.
FIRST_ORDER_ONLY = (
    "no [rotation] in the superelement: constant J, no Oe, Gr, Ge, and no stiffening, for a body "
    "that turns slowly"
)


@superelement_format(
    "sid",
    (FILE_ENDING,),
    "Standard Input Data of a superelement (SID), for multibody codes with floating frames",
    takes=("modes",),
    keeps=("[rotation]",),
)
def sid(e: "Superelement", folder: Path, stem: str, modes: int | None) -> Sequence[Path]:
    from ...results.exports.folder import exported
    from ...superelement.sid import standard_input_data
    from ...superelement.sid_file import write_sid

    data = standard_input_data(e, DEFAULT_MODES if modes is None else modes)
    remark = "m, kg, s, N, rad, axes and origin of the mesh"
    if e.rotation is None:
        remark = f"{remark}; {FIRST_ORDER_ONLY}"
        typer.echo(one_line(FIRST_ORDER_ONLY))
    elif not e.rotation.stiffens:
        typer.echo(one_line("the superelement does not know its stress: no stiffening by loads"))
    elif e.rotation.cubic is not None:
        typer.echo(one_line("left out: the strain energy of [rotation] level 2"))
    with exported(folder) as export, export.file(f"{stem}{FILE_ENDING}") as path:
        write_sid(data, remark, path)
    return export.paths
