"""What a body of shells must have: one make, materials of its plies, a solver that takes them."""

from collections.abc import Mapping
from typing import Protocol

from ...inputs import quoted
from .impulse import Impulse
from .material import Material, Section
from .shell import Shell


class ShellKeys(Protocol):
    """The keys of a body file that shells have to do with."""

    shell: Shell | None
    shells: dict[str, Shell]
    section: Section | None
    sections: dict[str, Section]
    material: Material | None
    materials: dict[str, Material]
    impulse: Impulse

    @property
    def order(self) -> int: ...

    @property
    def shells_by_key(self) -> Mapping[str, Shell]: ...


def check_shells(body: ShellKeys) -> None:
    """ValueError for what shells do not go with, and for materials that are not there."""
    shells = body.shells_by_key
    if not shells:
        return
    if body.shell is not None and body.shells:
        raise ValueError("expected one of shell and shells, found both")
    if body.section is not None or body.sections:
        raise ValueError(
            f"{next(iter(shells))}: expected material or materials, found a section of lines"
        )
    if body.order != 1:
        raise ValueError("order: expected 1 of shells, found 2, which is for solids")
    if body.impulse.solver == "iterative":
        raise ValueError(
            "impulse.solver: expected auto or factor of shells, found iterative, which does "
            "not converge on them"
        )
    for key, shell in shells.items():
        for ply in shell.layers:
            _check_material(body, key, shell, ply.material)


def _check_material(body: ShellKeys, key: str, shell: Shell, name: str | None) -> None:
    """ValueError unless the material of a shell is there, and has the axes that it needs."""
    if name is None and body.material is None:
        raise ValueError(
            f"{key}: expected material, one of {', '.join(body.materials)}, found none"
        )
    if name is not None and name not in body.materials:
        known = ", ".join(body.materials) or "none, but [material] for all shells"
        raise ValueError(f"{key}: no material {quoted(name)}; there are: {known}")
    found = body.material if name is None else body.materials[name]
    if found is not None and found.axes is not None:
        raise ValueError(
            f"{key}: axes of a material are those of solids: give the shell an orientation"
        )
    if found is not None and not found.isotropic and shell.orientation is None:
        raise ValueError(f"{key}.orientation: missing, for its material is orthotropic")
