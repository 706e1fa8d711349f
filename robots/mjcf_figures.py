"""Geometries of MJCF as figures of links."""

import numpy as np

from ..superelement import figures
from .compiled_model import CompiledModel
from .description import Geometry, Visual
from .poses import Pose, at, by_quaternion

# Geometries of this group and beyond are those of collisions, which MuJoCo does not draw either.
HIDDEN_GROUP = 3


def visuals_of(mjcf: CompiledModel, body: int) -> tuple[Visual, ...]:
    """The figures of the geometries of a body that are drawn."""
    m = mjcf.model
    first, n = int(m.body_geomadr[body]), int(m.body_geomnum[body])
    return tuple(
        visual
        for g in range(first, first + n)
        if m.geom_group[g] < HIDDEN_GROUP
        for visual in _visuals(mjcf, g)
    )


def _visuals(mjcf: CompiledModel, g: int) -> list[Visual]:
    m, types = mjcf.model, mjcf.mujoco.mjtGeom
    pose = Pose(by_quaternion(np.roll(m.geom_quat[g], -1)), np.array(m.geom_pos[g]))
    kind, size = int(m.geom_type[g]), np.array(m.geom_size[g])
    if kind == types.mjGEOM_SPHERE:
        return [Visual(pose, Geometry("sphere", size[:1]))]
    if kind == types.mjGEOM_BOX:
        return [Visual(pose, Geometry("box", 2.0 * size))]
    if kind in (types.mjGEOM_CYLINDER, types.mjGEOM_CAPSULE):
        # Sizes are halves along an axis.
        radius, half = size[:2].tolist()
        parts = [Visual(pose, Geometry("cylinder", np.array([radius, 2.0 * half])))]
        if kind == types.mjGEOM_CAPSULE:
            ball = Geometry("sphere", size[:1])
            parts += [Visual(pose @ at((0.0, 0.0, z)), ball) for z in (-half, half)]
        return parts
    if kind == types.mjGEOM_ELLIPSOID:
        round_one = figures.sphere(1.0)
        facets = round_one.points, round_one.triangles
        return [Visual(pose, Geometry("mesh", size, facets=facets))]
    if kind == types.mjGEOM_MESH:
        return [Visual(pose, _mesh(mjcf, int(m.geom_dataid[g])))]
    name = types(kind).name.removeprefix("mjGEOM_").lower()
    mjcf.leave_out(f"the figure of a {name} of body {mjcf.body(int(m.geom_bodyid[g]))!r}")
    return []


def _mesh(mjcf: CompiledModel, number: int) -> Geometry:
    m = mjcf.model
    points = slice(
        int(m.mesh_vertadr[number]), int(m.mesh_vertadr[number] + m.mesh_vertnum[number])
    )
    faces = slice(int(m.mesh_faceadr[number]), int(m.mesh_faceadr[number] + m.mesh_facenum[number]))
    facets = np.array(m.mesh_vert[points], float), np.array(m.mesh_face[faces], np.int64)
    return Geometry("mesh", np.ones(3), facets=facets)
