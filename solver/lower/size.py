"""The size of a model: the one length against which angles are weighed."""

from collections.abc import Mapping

import numpy as np

from ..model.model import Model
from .numbering import NumberedFrames
from .placement import Pose


def model_size(model: Model, poses: Mapping[str, Pose], frames: NumberedFrames) -> float:
    """The largest extent, lever or radius of gyration [m]: positive, independent of the origin.

    Extent: of the centers of bodies and the frames that act, along the axes of space at the start;
    lever: from a center to a frame of its body; radius of gyration: sqrt(J_max / m).
    """
    acting = list(frames.poses.values())[: frames.arrays.n_acting]
    points = np.array([*(poses[name].x for name in model.bodies), *(pose.x for pose in acting)])
    gyration = [
        np.sqrt(np.linalg.eigvalsh(body.inertia)[-1] / body.mass) for body in model.bodies.values()
    ]
    extent = float(np.ptp(points, axis=0).max())
    return max(extent, float(np.abs(frames.arrays.X).max(initial=0.0)), float(max(gyration)))
