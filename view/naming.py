"""Curves by names as a person writes them: "hub, angular velocity about z".

What the curves of a panel share is its title, and the rest their names in the legend. An axis that
stands without its kind is a letter alone.
"""

from collections.abc import Sequence

from ..results import Results
from ..results.quantities import ENERGY_LABELS, KINDS_BY_NAME, words
from ..results.transforms import Series
from .curve import Curve

# Of which two make a way in space.
PLACE_KINDS = {"position", "displacement", "elastic displacement"}
# A curve of which nothing was made, beside those of which something was.
UNFILTERED_LABEL = "unfiltered"
# What is named BODY.NAME.
ROLES_OF_BODIES = ("FRAME", "INTERFACE", "SENSOR", "PATTERN")
# Quantities whose second name says what they are, as "hinge, angle".
NAMED_QUANTITIES = ("coordinate", "fmu_input")


def kind(found: Series) -> str:
    """ "angular velocity", "rate of angle", "torque"."""
    if found.kind not in NAMED_QUANTITIES:
        return words(found.kind, found.unit)
    name = found.names[1]
    if name.endswith("_rate"):
        return f"rate of {name.removesuffix('_rate').replace('_', ' ')}"
    return name.replace("_", " ")


def owner(results: Results, found: Series) -> str:
    """ "hub", "beam tip seen from hub rim"."""
    if found.kind in NAMED_QUANTITIES:
        return found.names[0]
    roles = KINDS_BY_NAME[found.kind].names
    names = [
        name.replace(".", " ", 1)
        if name not in results.bodies and set(role.split("|")) & set(ROLES_OF_BODIES)
        else name
        for role, name in zip(roles, found.names, strict=True)
    ]
    return " seen from ".join(names)


def unit(found: Series) -> str:
    """The unit, of a strain that of a length per length."""
    if found.kind == "strain":
        return {"1": "m/m", "(1)²/Hz": "1/Hz", "1 s": "s"}.get(found.unit, found.unit)
    return found.unit


def in_full(curve: Curve) -> str:
    """ "hub, angular velocity about z"."""
    title, _ = title_and_labels([curve])
    return title


def title_and_labels(curves: Sequence[Curve]) -> tuple[str, list[str]]:
    """Find what all curves share, and what tells each from the others ("" if nothing does).

    Parameters
    ----------
    curves : sequence of Curve

    Returns
    -------
    title : str
    labels : list of str

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> x, y = (view.Curve(("velocity", "hub", axis), "m/s", np.ones(3)) for axis in "xy")
    >>> view.title_and_labels([x, y])
    ('hub, velocity', ['x', 'y'])
    """
    rows = [[curve.run, *curve.words[:3], *_parts(curve.words[3:])] for curve in curves]
    longest = max(map(len, rows))
    rows = [[*row, *[""] * (longest - len(row))] for row in rows]
    shared = [len(set(column)) == 1 for column in zip(*rows, strict=True)]
    shared[_AXIS] &= shared[_KIND]
    title = _joined(rows[0], shared, curves[0].along)
    own = [not is_shared for is_shared in shared]
    labels = [_joined(row, own, curve.along) for row, curve in zip(rows, curves, strict=True)]
    if any(labels):
        labels = [label or UNFILTERED_LABEL for label in labels]
    return title, labels


def _parts(treatments: Sequence[str]) -> list[str]:
    """ "shock response spectrum" and "Q = 10" apart, for one may be shared without the other."""
    return [part for treatment in treatments for part in treatment.split(", ")]


_RUN, _KIND, _OWNER, _AXIS = range(4)


def _joined(row: Sequence[str], chosen: Sequence[bool], along: str) -> str:
    """The chosen words of a row of run, kind, owner, axis and treatments."""
    words = [word if is_chosen else "" for word, is_chosen in zip(row, chosen, strict=True)]
    run, kind, owner, axis, *treatment = words
    if kind == "energy" and owner:
        kind, owner = ENERGY_LABELS.get(owner, f"{owner} energy"), ""
    elif row[_KIND] == "energy":
        owner = owner.replace("_", " ")
    phrase = " ".join(word for word in (kind, along if kind and axis else "", axis) if word)
    line = ", ".join(word for word in (owner, phrase, *treatment) if word)
    return f"{line} ({run})" if line and run else line or run
