"""Why a model has found no equilibrium, as far as its last state tells."""

from collections.abc import Iterator

import numpy as np

from ..arrays import Array, Index, distinct
from ..lower.lower import LoweredModel
from ..step.system import State, System, Workspace
from .redundancy import count_degrees_of_freedom

# relative to all forces on a body: more than the residual of a search that has ended
MIN_NET_FORCE = 1e-6
# in the search, over the size of the model
FAR_DISPLACEMENT = 1.0
# [rad] in the search, of a body that may turn on
LARGE_TURN = 0.5


def causes(lowered: LoweredModel, state: State, work: Workspace) -> str:
    """Why a search has found no equilibrium, as sentences of a message."""
    found = next(_causes(lowered, state, work), "")
    return found or (
        "nothing may balance its loads, or they may be at a buckling load or beyond it"
    )


def _causes(lowered: LoweredModel, state: State, work: Workspace) -> Iterator[str]:
    """The causes that apply, the most certain ones first."""
    names, size = lowered.body_names, lowered.system.bodies.size
    scale = float(work.bodies.force_scale[:, 0].max())
    for group in free_groups(lowered.system):
        force = float(np.linalg.norm(work.bodies.residual[group, :3].sum(axis=0)))
        if force > MIN_NET_FORCE * scale:
            yield (
                f"no joint, spring or contact holds body {names[group[0]]!r}, on which a force of "
                f"{force:.6g} N is left: it falls freely"
            )
    if pressed := _pressed(lowered, state):
        yield (
            f"{', '.join(pressed)}: closed, but nothing comes to rest there: bodies slide, roll or "
            "tip over"
        )
    distance = np.linalg.norm(state.bodies.x - [pose.x for pose in lowered.poses], axis=1)
    farthest = int(np.argmax(distance))
    movable = count_degrees_of_freedom(lowered, state, work) > 0
    if movable and distance[farthest] > FAR_DISPLACEMENT * size:
        yield (
            f"body {names[farthest]!r} has moved {distance[farthest]:.3g} m from its place in the "
            f"model without coming to rest: its joints leave it free to, and "
            f"{_nothing(lowered, 'spring or contact stops it')}{_without_friction(lowered)}"
        )
    if touching := _touching(lowered, work):
        listed = ", ".join(touching[:3])
        yield (
            f"{listed} may open and close in turn, as stiff contacts do: place the bodies where "
            f"they touch, or take a smaller stiffness"
        )
    angle = _turned(lowered, state)
    widest = int(np.argmax(angle))
    if angle[widest] > LARGE_TURN and movable:
        yield (
            f"body {names[widest]!r} has turned by {angle[widest]:.3g} rad without coming to rest: "
            f"its joints leave it free to turn, and "
            f"{_nothing(lowered, 'spring or motor holds it')}{_without_friction(lowered)}"
        )
    elif angle[widest] > LARGE_TURN:
        yield (
            f"body {names[widest]!r} has turned by {angle[widest]:.3g} rad by elasticity alone, "
            "for its joints leave it no motion: its loads may be beyond a buckling load, or too "
            "large for linear elasticity"
        )


def _nothing(lowered: LoweredModel, stops: str) -> str:
    """What is missing at rest; in a steady rotation springs may be there, and too soft for it."""
    steady = lowered.model.settings.steady_rotation is not None
    return f"no {stops}" + (" against the centrifugal forces" if steady else "")


def _without_friction(lowered: LoweredModel) -> str:
    """That friction holds nothing here, for models that have it."""
    has_friction = bool((lowered.system.couplings.friction_of >= 0).any())
    return "; friction does not count: it acts from the first step on" if has_friction else ""


def free_groups(system: System) -> list[Index]:
    """Groups of bodies that hang together, by their numbers, without those held by the ground."""
    body, rows = system.frames.body, system.couplings.rows
    contacts, owner = system.surfaces.contacts, system.surfaces.patches.body
    met = np.where(contacts.frame >= 0, body[contacts.frame], owner[contacts.target])
    pairs = {*zip(body[rows.frame_a].tolist(), body[rows.frame_b].tolist(), strict=True)}
    pairs |= {*zip(owner[contacts.patch].tolist(), met.tolist(), strict=True)}
    group = np.arange(len(system.bodies.mass) + 1)  # the last one: of the ground, body -1
    for a, b in pairs:
        group[group == group[a]] = group[b]
    free = distinct(group[:-1][group[:-1] != group[-1]])
    return [np.flatnonzero(group[:-1] == number) for number in free]


def _touching(lowered: LoweredModel, work: Workspace) -> list[str]:
    """Contacts and stops that carry a force, or would at their penetration."""
    couplings = lowered.system.couplings
    rows = couplings.range[couplings.contact].tolist()
    closed = [lowered.owner_of(row) for row in rows if work.couplings.scale[row] > 0.0]
    return closed


def _pressed(lowered: LoweredModel, state: State) -> list[str]:
    """Contacts of surfaces that carry a force."""
    row, force = lowered.system.surfaces.contacts.row, state.surfaces.force
    return [
        contact.owner
        for c, contact in enumerate(lowered.model.surface_contacts)
        if force[row[c] : row[c + 1]].any()
    ]


def _turned(lowered: LoweredModel, state: State) -> Array:
    """Angles [rad] between the rotations of bodies and those in the model (n_b,)."""
    R = np.array([pose.R for pose in lowered.poses])
    chord = np.linalg.norm(state.bodies.R - R, axis=(1, 2)) / np.sqrt(8.0)  # sin(angle / 2)
    angles: Array = 2.0 * np.arcsin(np.minimum(chord, 1.0))
    return angles
