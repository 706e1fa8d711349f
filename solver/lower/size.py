"""The size of a model: the one length against which angles are weighed."""

from collections.abc import Mapping

import numpy as np

from ..arrays import Array
from ..couplings.rows import Pose
from ..model.model import Model
from .numbering import NumberedFrames


def model_size(model: Model, poses: Mapping[str, Pose], frames: NumberedFrames) -> float:
    """The largest extent, lever or radius of gyration [m]: positive, independent of space.

    Extent: twice the largest distance from the mean of the centers of bodies and the frames that
    act, at the start; lever: from a center to a frame of its body; radius of gyration:
    sqrt(J_max / m). None depends on the origin or the axes of space.
    """
    acting = list(frames.poses.values())[: frames.arrays.n_acting]
    points = np.array([*(poses[name].x for name in model.bodies), *(pose.x for pose in acting)])
    gyration = [
        np.sqrt(np.linalg.eigvalsh(body.inertia)[-1] / body.mass) for body in model.bodies.values()
    ]
    extent = 2.0 * float(_distances(points - points.mean(axis=0)).max())
    return max(extent, float(_distances(frames.arrays.X).max(initial=0.0)), float(max(gyration)))


def _distances(points: Array) -> Array:
    distances: Array = np.linalg.norm(points, axis=1)
    return distances
