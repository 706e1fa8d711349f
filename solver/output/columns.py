"""Which datasets a results file has, and where in the output of the time loop each of them comes
from.
"""

from typing import Any, NamedTuple

from ..lower.lower import LoweredModel
from ..model.model import GROUND
from ..step.system import Output


class Column(NamedTuple):
    """A dataset: its units, and the field of the output that holds it, with what to take of each
    row.
    """

    units: str
    field: str
    part: tuple[int | slice, ...] = ()

    def rows(self, output: Output, n: int) -> Any:
        return getattr(output, self.field)[(slice(n), *self.part)]


def requested_columns(lowered: LoweredModel) -> dict[str, Column]:
    """The datasets that the model asks for; `ModelError` for a quantity that there is not."""
    request, columns = lowered.model.settings.output, lay_out_columns(lowered)
    request.check([group_of(name) for name in columns])
    return {name: column for name, column in columns.items() if request.selects(group_of(name))}


def group_of(name: str) -> str:
    """The group of a dataset."""
    return name.rpartition("/")[0]


def lay_out_columns(lowered: LoweredModel) -> dict[str, Column]:
    """All datasets by name, in the order of the file, but for those that are derived of others:
    time and balances.
    """
    columns: dict[str, Column] = {}
    for b, name in enumerate(lowered.body_names):
        columns |= {
            f"bodies/{name}/x": Column("m", "x", (b,)),
            f"bodies/{name}/R": Column("1", "R", (b,)),
            f"bodies/{name}/v": Column("m/s, rad/s", "v", (b,)),
            f"bodies/{name}/v_dot": Column("m/s^2, rad/s^2", "v_dot", (b,)),
        }
    for f, name in enumerate(lowered.frame_names):
        if "." not in name or name.startswith(f"{GROUND}."):
            continue
        columns |= {
            f"frames/{name}/position": Column("m", "frame_position", (f,)),
            f"frames/{name}/rotation": Column("1", "frame_rotation", (f,)),
            f"frames/{name}/velocity": Column("m/s, rad/s", "frame_velocity", (f,)),
            f"frames/{name}/acceleration": Column("m/s^2, rad/s^2", "frame_acceleration", (f,)),
            f"frames/{name}/u": Column("m, rad", "frame_u", (f,)),
            f"frames/{name}/force": Column("N, N m", "frame_force", (f,)),
        }
    columns |= _coupling_columns(lowered)
    for i, name in enumerate(("kinetic", "elastic", "springs", "potential", "work")):
        columns[f"energy/{name}"] = Column("J", "energy", (i,))
    if lowered.all_modal:
        columns["energy/modal"] = Column("J", "energy", (6,))
    columns["momentum/linear"] = Column("kg m/s", "momentum", (slice(0, 3),))
    columns["momentum/angular"] = Column("kg m^2/s", "momentum", (slice(3, 6),))
    columns["solver/iterations"] = Column("1", "iterations")
    columns["solver/residual"] = Column("1", "residual")
    return columns


def _coupling_columns(lowered: LoweredModel) -> dict[str, Column]:
    columns: dict[str, Column] = {}
    first = lowered.system.couplings.range.tolist()
    groups = {spring.name: "springs" for spring in lowered.model.springs}
    for j, name in enumerate(lowered.coupling_names):
        rows = slice(first[j], first[j + 1])
        group = groups.get(name, "joints")
        columns |= {
            f"{group}/{name}/multipliers": Column("N, N m", "multipliers", (rows,)),
            f"{group}/{name}/force": Column("N", "coupling_wrench", (j, slice(0, 3))),
            f"{group}/{name}/moment": Column("N m", "coupling_wrench", (j, slice(3, 6))),
        }
        if group == "springs":
            columns[f"{group}/{name}/coordinates"] = Column("m, rad", "coordinates", (rows,))
    for i, (joint, coordinate) in enumerate(lowered.observers):
        units = "rad" if "angle" in coordinate else "m"
        columns[f"joints/{joint}/{coordinate}"] = Column(units, "observed", (i,))
        columns[f"joints/{joint}/{coordinate}_rate"] = Column(f"{units}/s", "observed_rates", (i,))
    return columns
