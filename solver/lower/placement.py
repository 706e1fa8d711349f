"""Starting poses of the bodies of a model: by position and rotation, or by one frame on another."""

from collections.abc import Mapping

import numpy as np

from ..couplings.coupling import GROUND
from ..couplings.rows import Pose
from ..errors import ModelError
from ..model.bodies import Frame
from ..model.model import Model
from ..step.rotations import rotation_matrix


def place_bodies(model: Model) -> dict[str, Pose]:
    """The starting pose of every body, and of the ground."""
    poses = {GROUND: Pose(np.zeros(3), np.eye(3))}
    waiting = dict(model.bodies)
    while waiting:
        # Bodies wait until that on which they are placed has its pose; a circle never gets one.
        ready = [name for name in waiting if _support(model, name) in (None, *poses)]
        if not ready:
            raise ModelError(
                f"bodies {', '.join(waiting)}: they are placed on one another in a cycle"
            )
        for name in ready:
            poses[name] = _pose(model, name, poses)
            del waiting[name]
    return poses


def frame_pose(model: Model, poses: Mapping[str, Pose], reference: str) -> Pose:
    """The starting pose of "BODY.FRAME", or of the origin frame "BODY"."""
    body, _, frame = reference.partition(".")
    return poses[body].carry(model.frames_of(body)[frame]) if frame else poses[body]


def _support(model: Model, name: str) -> str | None:
    place = model.bodies[name].start.place
    return None if place is None else place.on.partition(".")[0]


def _pose(model: Model, name: str, poses: Mapping[str, Pose]) -> Pose:
    start = model.bodies[name].start
    if start.place is None:
        return Pose(start.position, rotation_matrix(start.rotation))
    frame = model.bodies[name].frames[start.place.frame] if start.place.frame else Frame()
    target = frame_pose(model, poses, start.place.on)
    # Frame on frame: R R_frame = R_target.
    R = target.R @ rotation_matrix(frame.rotation).T
    return Pose(target.x - R @ frame.position, R)
