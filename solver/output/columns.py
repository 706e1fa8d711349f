"""The output of the time loop, and where in it the entries of results stand."""

from collections.abc import Iterable, Iterator
from difflib import get_close_matches
from itertools import pairwise

import numpy as np

from ...results.schema import (
    OWNERS,
    QUANTITIES,
    Axis,
    Contents,
    SuperelementFile,
    attributes_of,
    lay_out,
)
from ..arrays import Array
from ..errors import ModelError
from ..lower.lower import CompiledModel
from ..model.model import GROUND
from ..step.system import Output


def make_output(compiled: CompiledModel, n: int) -> Output:
    """Room for n steps."""
    system = compiled.system
    n_b, n_f = len(system.bodies.mass), len(system.frames.body)
    n_rows, n_j, n_o = (
        len(system.couplings.rows.kind),
        len(compiled.coupling_names),
        len(compiled.observers),
    )
    return Output(
        x=np.zeros((n, n_b, 3)),
        R=np.zeros((n, n_b, 4)),
        v=np.zeros((n, n_b, 6)),
        v_dot=np.zeros((n, n_b, 6)),
        frame_position=np.zeros((n, n_f, 3)),
        frame_rotation=np.zeros((n, n_f, 4)),
        frame_u=np.zeros((n, n_f, 6)),
        frame_force=np.zeros((n, n_f, 6)),
        frame_velocity=np.zeros((n, n_f, 6)),
        frame_acceleration=np.zeros((n, n_f, 6)),
        multipliers=np.zeros((n, n_rows)),
        coordinates=np.zeros((n, n_rows)),
        observed=np.zeros((n, n_o)),
        observed_rates=np.zeros((n, n_o)),
        coupling_wrench=np.zeros((n, n_j, 6)),
        energy=np.zeros((n, 7)),
        momentum=np.zeros((n, 6)),
        iterations=np.zeros(n, dtype=np.int64),
        residual=np.zeros(n),
    )


def requested(compiled: CompiledModel) -> Contents:
    """What the model asks to be recorded; `ModelError` for a quantity that there is not."""
    request, axes = compiled.model.output, axes_of(compiled)
    owned = [f"{group}/{name}" for group, key in OWNERS.items() for name in axes[key].names]
    request.check([*owned, "energy", "momentum", "solver"])
    files = {
        name: SuperelementFile.of(body.source) if body.source else SuperelementFile("")
        for name, body in compiled.model.flexible_bodies.items()
    }
    return lay_out(axes, files, request.selects, _unknown(compiled))


def axes_of(compiled: CompiledModel) -> dict[str, Axis]:
    """The entries of all dimensions, with where they stand in the output."""
    model = compiled.model
    springs = {spring.name for spring in model.springs}
    couplings = list(enumerate(compiled.coupling_names))
    owners = {
        "body": list(enumerate(compiled.body_names)),
        "frame": [(f, name) for f, name in enumerate(compiled.frame_names) if _on_body(name)],
        "joint": [(j, name) for j, name in couplings if name not in springs],
        "spring": [(j, name) for j, name in couplings if name in springs],
    }
    axes = {key: _axis(entries) for key, entries in owners.items()}
    lengths = compiled.measures_lengths.tolist()
    ranges = list(pairwise(compiled.system.couplings.range.tolist()))
    for key, ragged in (("joint", "joint_constraint"), ("spring", "spring_component")):
        entries = [
            (row, f"{name}.{row - ranges[j][0] + 1}")
            for j, name in owners[key]
            for row in range(*ranges[j])
        ]
        axes[ragged] = _axis(entries, [not lengths[row] for row, _ in entries])
    names = [f"{joint}.{coordinate}" for joint, coordinate in compiled.observers]
    angular = ["angle" in coordinate for _, coordinate in compiled.observers]
    axes["joint_coordinate"] = _axis(list(enumerate(names)), angular)
    return axes


def _on_body(frame: str) -> bool:
    """Whether it is a frame of a body, not a body itself or a frame fixed in space."""
    return "." in frame and not frame.startswith(f"{GROUND}.")


def _axis(entries: list[tuple[int, str]], angular: Iterable[bool] = ()) -> Axis:
    return Axis(
        tuple(name for _, name in entries), tuple(angular), tuple(row for row, _ in entries)
    )


def views(compiled: CompiledModel, names: Iterable[str], output: Output) -> list[Array]:
    """Views (n,) of the output of one step by name, as "joints/pivot/angle"; `ModelError` for a
    name that there is not.
    """
    axes, known = axes_of(compiled), available(compiled)
    found: list[Array] = []
    for name in names:
        if name not in known:
            near = get_close_matches(name, known, n=3)
            meant = f"; did you mean {' or '.join(map(repr, near))}?" if near else ""
            raise ModelError(f"outputs: no {name!r}{meant}")
        found += [view.reshape(-1) for view in _views(axes, name, output)]
    return found


def available(compiled: CompiledModel) -> dict[str, None]:
    """The names of all outputs of a step."""
    axes = axes_of(compiled)
    names = [quantity.key for quantity in QUANTITIES if quantity.field and not quantity.owned]
    for group, dimension in OWNERS.items():
        for owner in axes[dimension].names:
            attributes = [name for name, _, _ in attributes_of(axes, group, owner)]
            names += [f"{group}/{owner}/{attribute}" for attribute in attributes]
    return dict.fromkeys(name for name in names if name not in _unknown(compiled))


def _views(axes: dict[str, Axis], name: str, output: Output) -> Iterator[Array]:
    """The parts of an output."""
    key, _, attribute = name.rpartition("/")
    group, _, owner = key.partition("/")
    if group in OWNERS:
        for found, quantity, entries in attributes_of(axes, group, owner):
            if found == attribute:
                rows = axes[quantity.dimensions[1]].rows[entries]
                if isinstance(rows, tuple):
                    rows = slice(rows[0], rows[-1] + 1) if rows else slice(0)
                yield getattr(output, quantity.field)[:1, rows][(..., *quantity.part)]
    for quantity in QUANTITIES:
        if quantity.key == name and not quantity.owned:
            yield getattr(output, quantity.field)[:1][(..., *quantity.part)]


def _unknown(compiled: CompiledModel) -> tuple[str, ...]:
    """The optional quantities that a model does not have."""
    return () if compiled.all_modal else ("energy/modal",)
