"""Contacts of surfaces as arrays: their patches, the flexibility of their bodies, their islands."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ..arrays import Array, as_index, as_rows, starts
from ..couplings.surface_contacts import SurfaceContact
from ..errors import ModelError
from ..history.layout import Stepping
from ..history.packing import packed
from ..history.shares import Shares, shares_of, static_rest
from ..model.model import Model
from ..step.records.elastic import Elastic
from ..step.records.surfaces import Patches, SurfaceBodies, SurfaceContacts, Surfaces
from .numbering import NumberedFrames, carrier_name
from .patches import Patch, lay_out_facets, lay_out_patches

DEPTH_BEYOND = 0.5
"""depth behind a patch, over its radius, at which a point is not below it but beyond it"""
LEAST_SURFACE_FLEXIBILITY = 1e-6
"""scaled flexibility of the nodes of surfaces with interfaces held, of which forces are found"""
LEAST_FLEXIBILITY = 1e-12
"""scaled flexibility of a motion of interfaces, relative to the largest, that counts as none"""


@dataclass(frozen=True, eq=False)
class SurfaceLayout:
    """The surfaces in contact of a model, as far as they do not depend on the step."""

    contacts: tuple[SurfaceContact, ...]
    owners: list[str]
    """flexible bodies with surfaces in contact"""
    patches: list[Patch]
    """each surface once, those of a body together, then rigid ones"""
    patch: list[int]
    """patch of each contact that has the rows"""
    target: list[int]
    """patch that it meets, -1: a shape"""
    frame: list[int]
    """frame that carries a rigid target, -1: the target is flexible"""
    islands: list[list[int]]
    """contacts by island"""
    island_bodies: list[list[int]]
    """bodies by island"""


def plan_surfaces(model: Model, frames: NumberedFrames) -> SurfaceLayout:
    """The surfaces in contact, body by body, and the islands that are solved for together."""
    contacts = model.surface_contacts
    numbers = {name: b for b, name in enumerate(model.bodies)}
    owners = [name for name in model.flexible_bodies if name in model.bodies_with_pressed_surfaces]
    keys = flexible_surfaces(model)
    patches = [
        Patch(
            f"{body}.{surface}",
            numbers[body],
            owners.index(body),
            model.flexible_bodies[body].superelement.surface(surface),
            smooth,
        )
        for body, surface, smooth in keys
    ]
    patch, target, frame = [], [], []
    for contact in contacts:
        own, *others = _keys(contact)
        patch.append(keys.index(own))
        # A flexible target moves with its own nodes, a rigid one with a frame.
        number = -1 if others else frames.number(carrier_name(contact))
        frame.append(number)
        if contact.facets is not None:
            body = int(frames.arrays.body[number])
            smooth = contact.geometry == "smooth"
            # Behind the flexible ones, whose numbers are their places in `keys`.
            patches.append(Patch(contact.name, body, -1, contact.rigid_surface, smooth))
        rigid = len(patches) - 1 if contact.facets is not None else -1
        target.append(keys.index(others[0]) if others else rigid)
    islands = _islands(contacts)
    bodies = []
    for members in islands:
        flexible = {numbers[name] for c in members for name in contacts[c].flexible_bodies}
        carriers = {int(frames.arrays.body[frame[c]]) for c in members if frame[c] >= 0}
        # What is fixed in space has no coordinates.
        bodies.append(sorted((flexible | carriers) - {-1}))
    return SurfaceLayout(contacts, owners, patches, patch, target, frame, islands, bodies)


def flexible_surfaces(model: Model) -> list[tuple[str, str, bool]]:
    """Body, surface, and whether it is a smooth target, of the flexible surfaces in contact.

    Body by body, for the compliance of a body has the nodes of all of its surfaces.
    """
    found = dict.fromkeys(key for contact in model.surface_contacts for key in _keys(contact))
    return [key for name in model.flexible_bodies for key in found if key[0] == name]


def _keys(contact: SurfaceContact) -> list[tuple[str, str, bool]]:
    """Body, surface, and whether it is a smooth target, of the flexible surfaces of a contact."""
    keys = [(contact.body, contact.surface, False)]
    if contact.meets_surface:
        keys.append((*contact.target, contact.geometry == "smooth"))
    return keys


def _islands(contacts: Sequence[SurfaceContact]) -> list[list[int]]:
    """Contacts that share flexible bodies, directly or by others, together."""
    islands: list[tuple[set[str], list[int]]] = []
    for c, contact in enumerate(contacts):
        bodies, members = set(contact.flexible_bodies), [c]
        apart = []
        # A contact may join islands that were apart before.
        for own, others in islands:
            if own & bodies:
                bodies, members = bodies | own, others + members
            else:
                apart.append((own, others))
        islands = [*apart, (bodies, members)]
    return [sorted(members) for _, members in islands]


def lay_out_surfaces(
    model: Model,
    layout: SurfaceLayout,
    frames: NumberedFrames,
    elastic: Elastic,
    stepping: Stepping,
) -> Surfaces:
    """All arrays of the contacts of surfaces, in steps of a size."""
    if not layout.contacts:
        return _without_contacts(len(elastic.modes.stiffness), len(model.pattern_loads))
    patches = lay_out_patches(layout.patches)
    return Surfaces(
        patches=patches,
        facets=lay_out_facets(layout.patches),
        bodies=_lay_out_bodies(model, layout, elastic, stepping),
        contacts=_lay_out_contacts(layout, frames, elastic, patches),
    )


@lru_cache(maxsize=64)
def _without_contacts(n_modes: int, n_pattern_loads: int) -> Surfaces:
    """The arrays of models without contacts of surfaces, which share them."""
    dims = {dim for _, one in Surfaces.array_fields() for dim in one.dims}
    # Ranges of nothing have one end.
    none = {dim: int(dim.endswith("_1")) for dim in dims if isinstance(dim, str)}
    surfaces = Surfaces.allocate(none | {"n_m": n_modes, "n_t": n_pattern_loads})
    surfaces.bodies.spread_start[:] = -1
    return surfaces


def _lay_out_bodies(
    model: Model, layout: SurfaceLayout, elastic: Elastic, stepping: Stepping
) -> SurfaceBodies:
    flexible = list(model.flexible_bodies)
    numbers = [flexible.index(name) for name in layout.owners]
    own = [[p for p in layout.patches if p.owner == s] for s in range(len(layout.owners))]
    # Many bodies may be of one superelement, whose compliance is large: alike ones share it.
    made: dict[tuple[Any, ...], _Motion] = {}
    motions = []
    for name, patches, e in zip(layout.owners, own, numbers, strict=True):
        active = elastic.active[elastic.active_range[e] : elastic.active_range[e + 1]]
        surfaces = [patch.surface.name for patch in patches]
        element = id(model.flexible_bodies[name].superelement)
        key = (element, *surfaces, *(active - elastic.dof[e]).tolist())
        if key not in made:
            made[key] = _motion(model, name, patches, e, elastic, stepping)
        motions.append(made[key])
    owners = [id(motion) for motion in motions]
    spread = _spread_loads(model, layout, motions)
    spread_start = starts(0 if own is None else len(own) for own in spread)[:-1]
    spread_start[[own is None for own in spread]] = -1
    n_m = len(elastic.modes.stiffness)
    source, share = np.zeros(n_m, dtype=np.int64), np.zeros(n_m)
    for motion, e in zip(motions, numbers, strict=True):
        split = slice(int(elastic.modes.range[e]), int(elastic.modes.range[e + 1]))
        source[split], share[split] = motion.shares.source, motion.shares.factor
    phi, phi_start = packed([motion.phi for motion in motions], owners)
    T, T_start = packed([motion.T for motion in motions], owners)
    G, G_start = packed([motion.G for motion in motions], owners)
    A, A_start = packed([motion.A for motion in motions], owners)
    bodies = elastic.body[numbers].tolist()
    return SurfaceBodies(
        flexible=as_index(numbers),
        island=as_index(
            [next(m for m, own in enumerate(layout.island_bodies) if b in own) for b in bodies]
        ),
        node=starts(sum(patch.surface.n for patch in patches) for patches in own),
        phi=phi,
        phi_start=phi_start,
        T=T,
        T_start=T_start,
        G=G,
        G_start=G_start,
        A=A,
        A_start=A_start,
        slope=starts(motion.A.size // max(motion.A.shape[1], 1) for motion in motions),
        reach=np.array([motion.reach for motion in motions], dtype=np.float64),
        second_reach=np.array(
            [_largest_length(np.linalg.norm(motion.A, axis=(1, 2))) for motion in motions],
            dtype=np.float64,
        ),
        source_range=starts(motion.n_modes for motion in motions),
        recorded=starts(motion.n_recorded for motion in motions),
        source=as_index(source),
        share=share,
        spread=np.concatenate([np.empty(0), *(own for own in spread if own is not None)]),
        spread_start=as_index(spread_start),
        spread_reach=np.array(
            [0.0 if own is None else _largest_length(own) for own in spread], dtype=np.float64
        ),
    )


def _spread_loads(
    model: Model, layout: SurfaceLayout, motions: Sequence["_Motion"]
) -> list[Array | None]:
    """Displacements of nodes by each load pattern; None on bodies without surfaces in contact."""
    found: list[Array | None] = []
    for load in model.pattern_loads:
        if load.body not in layout.owners:
            found.append(None)
            continue
        patterns = model.flexible_bodies[load.body].superelement.patterns
        names = [pattern.name for pattern in patterns]
        found.append(motions[layout.owners.index(load.body)].B[:, names.index(load.pattern)])
    return found


def _largest_length(u: Array) -> float:
    """The length of the longest of the vectors (3 n,) of n nodes."""
    return float(np.linalg.norm(u.reshape(-1, 3), axis=1).max(initial=0.0))


@dataclass(frozen=True, eq=False)
class _Motion:
    """How the nodes of a body move: see `SurfaceBodies`."""

    phi: Array
    T: Array
    G: Array
    B: Array
    A: Array
    reach: float
    shares: Shares
    n_modes: int
    n_recorded: int


def _motion(
    model: Model, name: str, patches: Sequence[Patch], e: int, elastic: Elastic, stepping: Stepping
) -> _Motion:
    element, second = model.flexible_bodies[name].superelement, model.flexible_bodies[name].rotation
    surfaces, modes = element.surfaces, element.modes
    assert surfaces is not None
    assert modes is not None
    rows = [surfaces.rows(patch.surface.name) for patch in patches]
    dofs = np.concatenate([np.arange(own.start, own.stop) for own in rows])
    shapes = surfaces.phi[dofs]
    # What no mode of the file has follows the forces at once; with losses it has modes too.
    residual = surfaces.H[np.ix_(dofs, dofs)] - (shapes / modes.omega**2) @ shapes.T
    rest = static_rest(element)[dofs]
    if rest.shape[1]:
        shapes, residual = np.hstack([shapes, rest]), np.zeros_like(residual)
    # By the shortest step: long steps between contacts go on with the same modes.
    shares = shares_of(model.flexible_bodies[name], stepping.shortest)
    phi = shares.shapes(shapes)
    own = slice(int(elastic.modes.range[e]), int(elastic.modes.range[e + 1]))
    h, beta = stepping.h, stepping.scheme.beta
    per_mode = beta * h * h / elastic.modes.step_stiffness[own]
    n_c, m = int(elastic.dof[e + 1] - elastic.dof[e]), phi.shape[1]
    start = int(elastic.modes.phi_start[e])
    phi_J = elastic.modes.phi[start : start + n_c * m].reshape(n_c, m)
    active = elastic.active[elastic.active_range[e] : elastic.active_range[e + 1]]
    phi_P = phi_J[element.n_c : element.n_c + len(element.patterns)]
    phi_J = phi_J[active - elastic.dof[e]]
    # Active dofs are unknowns of Newton's method: G is what is left while they are held.
    G_CJ, G_JJ = (phi * per_mode) @ phi_J.T, (phi_J * per_mode) @ phi_J.T
    T = G_CJ @ _inverse(G_JJ)
    G = (phi * per_mode) @ phi.T + residual - T @ G_CJ.T
    if len(active):
        _check_free(name, patches, G)
    B = (phi * per_mode) @ phi_P.T - T @ ((phi_J * per_mode) @ phi_P.T)
    # |u|^2 <= sum phi^2 / stiffness times sum stiffness eta^2, which is twice the energy.
    squares = ((phi / np.sqrt(elastic.modes.stiffness[own])) ** 2).sum(axis=1)
    reach = float(np.sqrt(2.0 * squares.reshape(-1, 3).sum(axis=1).max()))
    # Symmetric to the last bit: the loop reads rows of G as columns.
    A = np.empty((0, 0, 0))
    if second is not None:
        if second.A_surface is None:
            raise ModelError(
                f"body {name!r}: its surfaces are in contact, and superelement {element.name!r} "
                "has no terms of second order of them: preprocess it again, or give the body "
                "second_order = 'off'"
            )
        A = second.A_surface[dofs]
    return _Motion(
        shapes, T, 0.5 * (G + G.T), B, A, reach, shares, shapes.shape[1], len(modes.omega)
    )


def _check_free(name: str, patches: Sequence[Patch], G: Array) -> None:
    """`ModelError` where nodes of surfaces cannot move against the interfaces of their body."""
    # Surfaces may share nodes, which then move as one.
    nodes = np.concatenate([patch.surface.nodes for patch in patches])
    rows = (3 * np.unique(nodes, return_index=True)[1][:, None] + np.arange(3)).ravel()
    own = G[np.ix_(rows, rows)]
    # Scaled, for nodes in the middle of a fine mesh are far softer than those at a coarse rim.
    scale = 1.0 / np.sqrt(np.diag(own))
    try:
        np.linalg.cholesky(
            scale[:, None] * own * scale - LEAST_SURFACE_FLEXIBILITY * np.eye(len(own))
        )
    except np.linalg.LinAlgError:
        raise ModelError(
            f"body {name!r}: its surfaces are in contact, and all nodes of an interface lie on "
            "them that joints, springs or loads act on, or that [rotation] loaded has: expected "
            "nodes elsewhere"
        ) from None


def _inverse(G: Array) -> Array:
    """The inverse of a flexibility (n, n); of motions that no mode has, that of the others."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(G), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(scale[:, None] * G * scale)
    kept = values > LEAST_FLEXIBILITY * values.max(initial=0.0)
    # Motions of interfaces that no load brings about need no image.
    factor = scale[:, None] * vectors[:, kept] / np.sqrt(values[kept])
    inverse: Array = factor @ factor.T
    return inverse


def _lay_out_contacts(
    layout: SurfaceLayout, frames: NumberedFrames, elastic: Elastic, patches: Patches
) -> SurfaceContacts:
    contacts, patch = layout.contacts, layout.patch
    shapes = [contact.shape_in(frames.poses, carrier_name(contact)) for contact in contacts]
    widths = [[_coordinates(b, elastic) for b in bodies] for bodies in layout.island_bodies]
    totals = [sum(width) for width in widths]
    # Of all bodies of an island, for the tangent of contacts couples each with each.
    coordinate = np.full((len(contacts), 2), -1)
    for members, bodies, width in zip(layout.islands, layout.island_bodies, widths, strict=True):
        first = dict(zip(bodies, starts(width).tolist(), strict=False))
        for c in members:
            coordinate[c, 0] = first[layout.patches[patch[c]].body]
            f, t = layout.frame[c], layout.target[c]
            other = int(frames.arrays.body[f]) if f >= 0 else layout.patches[t].body
            coordinate[c, 1] = first.get(other, -1)
    supports = np.diff(patches.support_range[patches.row])
    kinds = [1 if contact.friction is None else 3 for contact in contacts]
    rows = [len(layout.patches[p].corners) for p in patch]
    slips = starts((kind - 1) * n for kind, n in zip(kinds, rows, strict=True)) + sum(rows)
    others = _places_of_others(layout)
    nodes = np.diff(patches.node)
    places = [
        0 if kind == 1 else int(nodes[p]) + (int(nodes[t]) if t >= 0 else 0)
        for kind, p, t in zip(kinds, patch, layout.target, strict=True)
    ]
    return SurfaceContacts(
        patch=as_index(patch),
        target=as_index(layout.target),
        frame=as_index(layout.frame),
        shape=as_index([shape.number for shape in shapes]),
        # Inside a hollow shape gaps and normals have the other sign.
        side=np.array([-1.0 if contact.hollow else 1.0 for contact in contacts]),
        axis=as_rows([shape.axis for shape in shapes]),
        across=as_rows([shape.across for shape in shapes]),
        first=starts(len(shape.parameters) for shape in shapes),
        parameters=np.array([x for shape in shapes for x in shape.parameters], dtype=np.float64),
        size=np.array(
            [
                contact.size if t < 0 else DEPTH_BEYOND * layout.patches[t].radius
                for contact, t in zip(contacts, layout.target, strict=True)
            ],
            dtype=np.float64,
        ),
        # The default depends on the motion, which only the loop knows.
        margin=np.array(
            [np.nan if c.margin is None else c.margin for c in contacts], dtype=np.float64
        ),
        # A compliance: without a layer it is zero, and no case of its own.
        layer=np.array(
            [0.0 if c.layer is None else 1.0 / c.layer for c in contacts], dtype=np.float64
        ),
        row=starts(rows),
        slip_row=as_index(
            [-1 if kind == 1 else i for kind, i in zip(kinds, slips[:-1].tolist(), strict=True)]
        ),
        friction=as_rows([_friction(contact) for contact in contacts]),
        start=starts(places)[:-1].copy(),
        support=starts((supports[patch] * np.array(kinds, dtype=np.int64)).tolist()),
        other=starts([n for own in others for n in own] + _of_slips(others, kinds)),
        island_range=starts(map(len, layout.islands)),
        island=as_index([c for members in layout.islands for c in members]),
        coordinate=as_index(coordinate).reshape(-1, 2),
        body_range=starts(map(len, layout.island_bodies)),
        body=as_index([b for bodies in layout.island_bodies for b in bodies]),
        body_coordinate=as_index([i for width in widths for i in starts(width)[:-1]]),
        body_width=as_index([n for width in widths for n in width]),
        coordinates=as_index(totals),
        stiffness_start=starts(n * n for n in totals)[:-1].copy(),
        block_range=starts(len(bodies) ** 2 for bodies in layout.island_bodies),
    )


def _friction(contact: SurfaceContact) -> list[float]:
    """Static and sliding coefficient, and the speed of slip at which the one becomes the other."""
    mu = contact.friction
    return [0.0, 0.0, 1.0] if mu is None else [mu.static, mu.sliding, mu.speed]


def _of_slips(others: Sequence[Sequence[int]], kinds: Sequence[int]) -> list[int]:
    """The same numbers once more for each slip, contact by contact."""
    return [n for own, kind in zip(others, kinds, strict=True) for n in list(own) * (kind - 1)]


def _places_of_others(layout: SurfaceLayout) -> list[list[int]]:
    """The most nodes of the target that each row of each contact can meet."""
    numbers = []
    for p, t in zip(layout.patch, layout.target, strict=True):
        patch = layout.patches[p]
        points = [len(around) * len(patch.rule.weights) for around in patch.around]
        if t < 0:
            numbers.append([0] * len(points))
        else:
            target = layout.patches[t]
            # Each point is above one facet, but facets share nodes.
            numbers.append([min(n * target.rule.n_nodes, target.surface.n) for n in points])
    return numbers


def _coordinates(body: int, elastic: Elastic) -> int:
    e = int(elastic.of_body[body])
    return 6 if e < 0 else 6 + int(elastic.active_range[e + 1] - elastic.active_range[e])
