"""Mechanisms that close upon themselves: linkages of rigid and flexible members."""

from dataclasses import MISSING, fields

import numpy as np
from duhamel.solver import (
    JOINTS,
    FlexibleBody,
    Frame,
    Prismatic,
    Revolute,
    RigidBody,
    Spherical,
    Start,
    Universal,
)

from .frameworks import bar
from .models import model_of

CRANK, COUPLER, ROCKER, BASE = 0.1, 0.3, 0.25, 0.3
ANGLE = 1.0
"""of the crank at the start"""
X, Z = np.eye(3)[[0, 2]]


def pins(angle):
    """B and C of the rigid four-bar A B C D, A at the origin, D at (BASE, 0): two circles meet in
    C.
    """
    B, D = CRANK * np.array([np.cos(angle), np.sin(angle), 0.0]), BASE * X
    distance = np.linalg.norm(D - B)
    along = (D - B) / distance
    foot = (COUPLER**2 - ROCKER**2 + distance**2) / (2 * distance)
    return B, B + foot * along + np.sqrt(COUPLER**2 - foot**2) * np.cross(Z, along)


def between(p, q):
    """Position and rotation of a bar along its own x axis, from p to q."""
    axis = np.cross(X, (q - p) / np.linalg.norm(q - p))
    turn = np.arctan2(np.linalg.norm(axis), X @ (q - p) / np.linalg.norm(q - p))
    return {"position": 0.5 * (p + q), "rotation": turn * axis / np.linalg.norm(axis)}


def crank(angle=0.0):
    frames = {"pin": Frame([-CRANK / 2, 0, 0]), "end": Frame([CRANK / 2, 0, 0])}
    start = Start(0.5 * CRANK * np.array([np.cos(angle), np.sin(angle), 0.0]), [0, 0, angle])
    return RigidBody(0.02, [1e-5, 2e-5, 2e-5], frames, start)


def four_bar(folder, stiffness=0.05, drive=None, **settings):
    """A rigid crank; a coupler and a rocker so soft that they bend by a thousandth of
    their length.
    """
    B, C = pins(ANGLE)
    return model_of(
        bodies={
            "crank": crank(ANGLE),
            "rod": FlexibleBody(bar(folder, COUPLER, stiffness=stiffness), Start(**between(B, C))),
            "rocker": FlexibleBody(
                bar(folder, ROCKER, stiffness=stiffness), Start(**between(C, BASE * X))
            ),
        },
        joints=(
            Revolute("ground.A", "crank.pin", Z, name="A", angle=drive),
            Revolute("crank.end", "rod.left", Z, name="B"),
            Revolute("rod.right", "rocker.left", Z, name="C"),
            Revolute("rocker.right", "ground.D", Z, name="D"),
        ),
        ground_frames={"A": Frame(), "D": Frame(BASE * X)},
        **settings,
    )


def slider_crank(folder, **settings):
    B = crank(ANGLE).start.position * 2
    P = (B[0] + np.sqrt(COUPLER**2 - B[1] ** 2)) * X
    return model_of(
        bodies={
            "crank": crank(ANGLE),
            "rod": FlexibleBody(bar(folder, COUPLER, stiffness=0.05), Start(**between(B, P))),
            "piston": RigidBody(0.03, [1e-5, 1e-5, 1e-5], {"eye": Frame()}, Start(P)),
        },
        joints=(
            Revolute("ground", "crank.pin", Z, name="A"),
            Revolute("crank.end", "rod.left", Z, name="B"),
            Revolute("rod.right", "piston.eye", Z, name="C"),
            Prismatic("ground", "piston", X, name="D"),
        ),
        **settings,
    )


def spatial_four_bar(folder, **settings):
    """Crank and rocker about skew axes, a flexible rod on a spherical and a universal joint, bent
    and twisted.
    """
    B, C, D = CRANK * X, np.array([0.25, 0.2, 0.15]), np.array([0.25, 0.2, -0.1])
    rod = FlexibleBody(
        bar(folder, float(np.linalg.norm(C - B)), stiffness=0.05), Start(**between(B, C))
    )
    frames = {"pin": Frame([0, 0, -0.125]), "end": Frame([0, 0, 0.125])}
    return model_of(
        bodies={
            "crank": crank(),
            "rod": rod,
            "rocker": RigidBody(0.05, [2e-4, 2e-4, 1e-5], frames, Start(0.5 * (C + D))),
        },
        joints=(
            Revolute("ground", "crank.pin", Z, name="A"),
            Spherical("crank.end", "rod.left", name="B"),
            Universal("rod.right", "rocker.end", np.cross(C - B, X), X, name="C"),
            Revolute("rocker.pin", "ground", X, name="D"),
        ),
        **settings,
    )


def n_axes(kind):
    """How many axes a type of joint needs: none, `axis`, or `second_axis` too."""
    needed = {field.name for field in fields(JOINTS[kind]) if field.default is MISSING}
    return len(needed & {"axis", "second_axis"})
