"""How fast the bodies of a model turn in a steady rotation, over its spin.

Without bearings all bodies turn as one. A bearing parts what turns from what stands: bodies that
hang together by other couplings turn together, with the spin where a bearing has a shaft among
them, and not at all where bearings have only supports among them. Ratios that are given go first.
"""

from collections.abc import Mapping

from ..couplings.coupling import GROUND
from ..errors import ModelError
from .model import Model
from .settings import SteadyRotation


def speed_ratios(model: Model, rotation: SteadyRotation | None) -> dict[str, float]:
    """The angular velocity of each body over that of a steady rotation, by name.

    1 turns with the rotation, 0 stands. `ModelError` for bodies that hang together, are support and
    shaft of bearings, and have no ratio given.
    """
    given = {} if rotation is None else rotation.speed_ratios
    found: dict[str, float] = {}
    for group in _groups(model):
        found |= _of_group(model, group, given)
    return {name: found[name] for name in model.bodies}


def _groups(model: Model) -> list[list[str]]:
    """Bodies that hang together, but for the ground, bearings and contacts."""
    group = {name: name for name in model.bodies}
    bearings = {bearing.name for bearing in model.bearings}
    for coupling in model.couplings:
        first, second = (side.partition(".")[0] for side in coupling.between)
        # A shaft that may rub on its casing does not turn it.
        if GROUND in (first, second) or coupling.name in bearings or coupling.opens:
            continue
        old, new = group[first], group[second]
        group = {name: new if its == old else its for name, its in group.items()}
    leaders = dict.fromkeys(group.values())
    return [[name for name in group if group[name] == leader] for leader in leaders]


def _of_group(model: Model, group: list[str], given: Mapping[str, float]) -> dict[str, float]:
    own = {name: given[name] for name in group if name in given}
    supports, shafts = (
        {name: b for b in model.bearings if (name := b.between[side].partition(".")[0]) in group}
        for side in (0, 1)
    )
    unclear = bool(supports and shafts)
    if own:
        missing = [name for name in group if name not in own]
        if len(set(own.values())) == 1:
            # One speed is that of all, but a support says nothing about the shaft that hangs in it.
            on_bearings = {*supports, *shafts} if unclear else set()
            missing = [name for name in missing if name in on_bearings]
        if missing:
            raise ModelError(
                f"steady_rotation: speed_ratios: {_listed(own)} hang together with "
                f"{_listed(missing)}: expected ratios of all of them"
            )
        return {name: own.get(name, next(iter(own.values()))) for name in group}
    if unclear:
        support, shaft = next(iter(supports.values())), next(iter(shafts.values()))
        raise ModelError(
            f"steady_rotation: {_listed(group)}: support of {support.owner} and shaft of "
            f"{shaft.owner}: expected its speed over that of the rotor in speed_ratios, as "
            f"speed_ratios = {{{next(iter(supports))} = 0}} for one that stands"
        )
    return dict.fromkeys(group, 0.0 if supports else 1.0)


def _listed(names: Mapping[str, float] | list[str]) -> str:
    return ", ".join(map(repr, names))
