"""The motion of the bodies and frames of a mechanism in its modes."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array, Index
from ..step.frames import move_frames
from .modes import FirstOrder, frames_of


@dataclass(frozen=True, eq=False)
class Motion:
    """Small motions of points: the centers of bodies, then all frames of bodies.

    points (n, 3): where they are in space [m]; translations and rotations (n, 3, k) of k motions,
    along axes of space (of the mechanism, where it turns); names (n,), bodies (n,): numbers of
    their bodies.
    """

    names: tuple[str, ...]
    bodies: Index
    points: Array
    translations: Any
    rotations: Any


def motion_of(form: FirstOrder, y: Any) -> Motion:
    """Of motions y (n_y, k), as `LinearModes.y`."""
    pose = form.equations.pose
    state, work, frames = pose.state, pose.work, pose.system.frames
    move_frames(frames, len(frames.body), state, work)
    n_b = len(state.bodies.x)
    xi, u = y[: 6 * n_b].reshape(n_b, 6, -1), frames_of(form, y)
    names, points = list(pose.lowered.body_names), [*state.bodies.x]
    owners = list(range(n_b))
    translations = list(np.einsum("bij,bjk->bik", state.bodies.R, xi[:, :3]))
    rotations = list(np.einsum("bij,bjk->bik", state.bodies.R, xi[:, 3:]))
    for f, b in enumerate(frames.body.tolist()):
        if b < 0:
            continue
        R, lever, dof = state.bodies.R[b], work.frames.lever[f], int(frames.dof[f])
        moved = xi[b, :3] - np.cross(lever, xi[b, 3:], axisb=0, axisc=0)
        turned = xi[b, 3:].copy()
        if dof >= 0:
            moved = moved + u[dof : dof + 3]
        if dof >= 0 and frames.rotations[f]:
            turned = turned + work.frames.T[f].T @ u[dof + 3 : dof + 6]
        owners.append(b)
        names.append(pose.lowered.frame_names[f])
        points.append(work.frames.r[f].copy())
        translations.append(R @ moved)
        rotations.append(R @ turned)
    return Motion(
        tuple(names),
        np.array(owners, dtype=np.int64),
        np.array(points),
        np.array(translations),
        np.array(rotations),
    )
