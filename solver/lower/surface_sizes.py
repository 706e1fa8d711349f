"""Dimensions of the arrays of contacts of surfaces: of state, scratch and results."""

from collections.abc import Mapping

import numpy as np

from ..model.output_request import OutputRequest
from ..step.records.surfaces import Surfaces


def sizes_of_kept(surfaces: Surfaces, request: OutputRequest) -> Mapping[str, int]:
    """The dimensions of results of all rows and nodes of contacts, modes and loads."""
    nodes = np.diff(surfaces.patches.node)[surfaces.contacts.patch]
    return {
        "n_kept_rows": int(surfaces.contacts.row[-1]) * request.nodes,
        "n_kept_nodes": int(nodes.sum()) * request.nodes,
        "n_kept_modes": int(surfaces.bodies.recorded[-1]) * request.modes,
        "n_kept_loads": int(surfaces.bodies.node[-1]) * request.modes,
    }


def sizes_of_surfaces(surfaces: Surfaces) -> Mapping[str, int]:
    """The dimensions of the state and the scratch of contacts of surfaces."""
    contacts, patches, bodies = surfaces.contacts, surfaces.patches, surfaces.bodies
    with_friction = contacts.slip_row >= 0
    rows = np.diff(contacts.row) * np.where(with_friction, 3, 1)
    targets = np.where(contacts.target >= 0, np.diff(patches.node)[contacts.target], 0)
    places = (np.diff(patches.node)[contacts.patch] + targets)[with_friction]
    members = [
        contacts.island[first:last]
        for first, last in zip(
            contacts.island_range[:-1].tolist(), contacts.island_range[1:].tolist(), strict=True
        )
    ]
    return {
        "n_contacts": len(contacts.patch),
        "n_islands": len(members),
        "n_bodies": len(bodies.flexible),
        "n_nodes": len(patches.X),
        "n_facets": len(surfaces.facets.nodes),
        "n_contact_rows": int(contacts.row[-1]),
        "n_all_rows": int(rows.sum()),
        "n_start_places": int(places.sum()),
        "n_contact_supports": int(contacts.support[-1]),
        "n_others": int(contacts.other[-1]),
        "n_most_points": int(np.diff(patches.point).max(initial=0)),
        "n_most_rows": max((int(rows[own].sum()) for own in members), default=0),
        "n_most_coordinates": int(contacts.coordinates.max(initial=0)),
        "n_stiffness": int((contacts.coordinates**2).sum()),
        "n_node_slopes": int(bodies.slope[-1]),
        "n_sources": int(bodies.source_range[-1]),
        "n_most_displacements": 3 * int(np.diff(bodies.node).max(initial=0)),
    }
