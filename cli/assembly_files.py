"""The texts of body files, and of a first model file, of the solids of a CAD file."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..cad import Feature, Solid
from ..cad.quality import TETRAHEDRON_VOLUME
from ..robots.document import comment, inline, table_head, tidy
from .assembly_pairs import LARGE_COORDINATE, JointPair, is_boss, round_features

ASSUMED_STEEL = {"E": 210e9, "nu": 0.3, "rho": 7850.0}
END_TIME, TIME_STEP = 1e-2, 1e-5
"""Of the simulation [s] and of the impulse responses, until the user gives better ones."""
FURTHER_TABLES = (
    "# To uncomment: stresses in films and reports.",
    "# [recovery]",
    "# stress = true",
    "# To uncomment: damping, without which the part rings on.",
    "# [damping]",
    "# loss_factor = 0.01    # of the material, and of joints within the part",
    "# band = [50, 5000]     # [Hz] in which it is constant",
)
"""of a body file"""
USUAL_ELEMENTS = 4000
"""Number of elements that a size is chosen for: some ten seconds of work on a part."""
MAX_INTERFACES = 4
"""Interfaces that are given; further ones stand as comments, for each one costs time."""
MAX_COMMENTED = 40


@dataclass(frozen=True)
class NamedSolid:
    """A solid by its label in the CAD file, under the name of its body and of its files."""

    name: str
    label: str
    solid: Solid


def interface_name(feature: Feature) -> str:
    return f"{feature.kind}_{feature.number}"


def body_file(part: NamedSolid, mesh: dict[str, object], pairs: Sequence[JointPair]) -> str:
    """A body file: what the mesh is made of, a material to look at, interfaces, a step.

    mesh: keys of the mesh; where interfaces are paired, the frames of both are at the same point.
    """
    places = {
        feature: pair.at
        for pair in pairs
        for label, feature in zip(pair.labels, pair.features, strict=True)
        if label == part.label
    }
    features = part.solid.features
    # Paired ones first: they are most likely to be joints.
    candidates = [*places, *(f for f in round_features(features) if f not in places)]
    given = candidates[:MAX_INTERFACES] or [max(features, key=lambda feature: feature.area)]
    lines = [
        comment(f"Solid {part.label!r}, in the axes of its CAD file, in meters."),
        comment("Look at every number. `duhamel preprocess FILE --dry-run` draws the part."),
        *_keys({"name": part.name, **mesh}),
        "",
        "[material]    # steel is assumed: CAD files say no material",
        *_keys(ASSUMED_STEEL),
    ]
    for feature in given:
        boss = [comment("a boss: the outside of a hole")] if is_boss(feature, features) else []
        lines += ["", *boss, table_head("interfaces", interface_name(feature)), feature.key]
        lines += _keys({"at": places[feature]}) if feature in places else []
    lines += ["", "[impulse]", *_keys({"step": TIME_STEP}), "", *FURTHER_TABLES]
    rest = [f for f in features if f not in given and f.kind != "curved"]
    if rest:
        lines += ["", comment("Further interfaces, to uncomment: each one costs time.")]
    for feature in rest[:MAX_COMMENTED]:
        remark = "  # a boss: the outside of a hole" if is_boss(feature, features) else ""
        lines += [f"# {table_head('interfaces', interface_name(feature))}{remark}"]
        lines += [f"# {feature.key}"]
    return "\n".join(lines) + "\n"


def model_file(parts: Sequence[NamedSolid], source: str, pairs: Sequence[JointPair]) -> str:
    """A model of all bodies where they are in the CAD file, and possible joints as comments."""
    names = {part.label: part.name for part in parts}
    lines = [
        comment(f"The solids of {source}. First make their superelements:"),
        *(comment(f"    duhamel preprocess {part.name}.toml") for part in parts),
        comment("Without joints all bodies are free. Joints, loads and motions are to be added."),
        comment("A position is that of the center of mass, here of the solid alone. If you add"),
        comment("[masses] to a body file, take the center from `duhamel info`."),
        "",
        "[simulation]",
        *_keys({"t_end": END_TIME, "step": TIME_STEP}),
    ]
    for part in parts:
        center = tidy(np.array(part.solid.center), LARGE_COORDINATE)
        lines += ["", table_head("bodies", part.name)]
        lines += _keys({"superelement": f"{part.name}.h5", "position": center})
    if pairs:
        lines += ["", comment("Holes and shafts in one line, where a joint may be:")]
    for number, pair in enumerate(pairs, 1):
        lines += [comment(line) for line in _joint(number, pair, names)]
    return "\n".join(lines) + "\n"


def _joint(number: int, pair: JointPair, names: dict[str, str]) -> Iterator[str]:
    between = [
        f"{names[label]}.{interface_name(feature)}"
        for label, feature in zip(pair.labels, pair.features, strict=True)
    ]
    yield "[[joints]]"
    values = {"name": f"joint_{number}", "type": "revolute", "between": between}
    yield from _keys({**values, "axis": pair.features[0].axis})


def _keys(values: Mapping[str, object]) -> list[str]:
    return [f"{key} = {inline(value)}" for key, value in values.items()]


def usual_size(solid: Solid) -> float:
    """A size of elements [m] that makes about `USUAL_ELEMENTS` of them, to two digits."""
    size = (solid.volume / (USUAL_ELEMENTS * TETRAHEDRON_VOLUME)) ** (1.0 / 3.0)
    return float(f"{size:.2g}")
