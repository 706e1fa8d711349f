"""The rows of joints as arrays, seen from the frames at the start."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .compiled import Array, as_index, as_rows
from .errors import ModelError
from .joints import Joint
from .placement import Pose
from .signals import Motion
from .system import Joints

ASSEMBLY_TOLERANCE = 1e-9
"""largest opening of a joint at the start, relative to the size of the model"""


class _Row(NamedTuple):
    rotation: bool
    a: Array
    a_turned: Array = np.zeros(3)
    b: Array = np.zeros(3)
    drive: int = -1


def lay_out_joints(
    joints: Sequence[Joint], sides: Sequence[tuple[str, str]], frame_names: list[str], frame_poses: list[Pose]
) -> tuple[Joints, list[Motion]]:
    """The rows of all joints, whose `sides` are frames by name, and the signals of their drives.

    Axes are those of the joint at the start, seen from either frame.
    """
    rows: list[_Row] = []
    first = [0]
    drives: list[Motion] = []
    frames = [[frame_names.index(side) for side in pair] for pair in sides]
    for joint, (A, B) in zip(joints, frames, strict=True):
        in_a = frame_poses[A].R.T @ joint.basis()
        in_b = frame_poses[B].R.T @ joint.basis()
        rows += [_Row(False, in_a[:, k]) for k in joint.kind.translations]
        rows += [_Row(True, in_a[:, i], b=in_b[:, j]) for i, j in joint.kind.rotations]
        if joint.distance is not None:
            rows.append(_Row(False, in_a[:, 2], drive=len(drives)))
            drives.append(joint.distance)
        if joint.angle is not None:
            s = joint.angle(0.0)
            e2 = np.cos(s) * in_b[:, 1] - np.sin(s) * in_b[:, 0]
            rows.append(_Row(True, in_a[:, 0], in_a[:, 1], e2, len(drives)))
            drives.append(joint.angle)
        first.append(len(rows))
        _check_assembled(joint, frame_poses[A], frame_poses[B])
    laid_out = Joints(
        frame_a=as_index([A for A, _ in frames]),
        frame_b=as_index([B for _, B in frames]),
        row=as_index(first),
        rotation=as_index([row.rotation for row in rows]),
        a=as_rows([row.a for row in rows]),
        a_turned=as_rows([row.a_turned for row in rows]),
        b=as_rows([row.b for row in rows]),
        drive=as_index([row.drive for row in rows]),
    )
    return laid_out, drives


def _check_assembled(joint: Joint, A: Pose, B: Pose) -> None:
    """The frames of a joint must meet at the start, but for the directions in which it slides."""
    gap = joint.basis().T @ (B.x - A.x)
    opening = [gap[k] for k in joint.kind.translations]
    if joint.distance is not None:
        opening.append(gap[2] - joint.distance(0.0))
    size = max(1e-3, float(np.abs([A.x, B.x]).max()))
    worst = max(map(abs, opening), default=0.0)
    if worst > ASSEMBLY_TOLERANCE * size:
        raise ModelError(
            f"joint {joint.name!r}: open by {worst:.6g} m at the start: {joint.between[0]} is at {A.x.tolist()}, "
            f"{joint.between[1]} at {B.x.tolist()}"
            + (f", the distance starts at {joint.distance(0.0):.6g}" if joint.distance is not None else "")
        )
