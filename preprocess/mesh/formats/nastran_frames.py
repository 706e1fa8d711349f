"""Coordinate systems in which Nastran's grid points are given."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ....superelement.validation import Array
from ...errors import MeshError
from .nastran_deck import Card

MIN_RADIUS = 1e-9
"""Distance from the third axis of a coordinate system over that from its origin, which is zero."""


@dataclass(frozen=True)
class Frame:
    """A coordinate system in basic coordinates: origin (3,), and axes (3, 3) as rows.

    kind: the last letter of the card: R, C or S.
    """

    kind: str
    origin: Array
    axes: Array

    def to_basic(self, points: Array) -> Array:
        """Basic coordinates (n, 3) of points in rectangular (R), cylindrical (C) or spherical (S)
        ones.

        Angles are in degrees: r, theta, z of a cylinder; r, theta from the third axis, phi of a
        sphere.
        """
        a, b, c = points.T
        b_angle, c_angle = np.deg2rad(b), np.deg2rad(c)
        if self.kind == "C":
            local = np.stack([a * np.cos(b_angle), a * np.sin(b_angle), c], axis=1)
        elif self.kind == "S":
            across = a * np.sin(b_angle)
            local = np.stack(
                [across * np.cos(c_angle), across * np.sin(c_angle), a * np.cos(b_angle)], axis=1
            )
        else:
            local = points
        return np.asarray(self.origin + local @ self.axes)

    def axes_at(self, points: Array) -> Array:
        """The axes (n, 3, 3) as rows, of displacements of points (n, 3), both in basic coordinates.

        Those of r, theta, z, or of r, theta, phi, at each point. `MeshError` for a point on the
        third axis, where there are none.
        """
        axes = np.broadcast_to(self.axes, (len(points), 3, 3)).copy()
        if self.kind == "R":
            return axes
        arms = points - self.origin
        third = axes[:, 2]
        outward = arms - np.sum(arms * third, axis=1)[:, None] * third
        length = np.linalg.norm(outward, axis=1)
        if (length <= MIN_RADIUS * np.linalg.norm(arms, axis=1).max(initial=0.0)).any():
            raise MeshError(
                "expected points off the third axis of the coordinate system of their "
                f"displacements, found {points[length.argmin()].tolist()} on it"
            )
        outward /= length[:, None]
        around = np.cross(third, outward)
        if self.kind == "C":
            return np.stack([outward, around, third], axis=1)
        radial = arms / np.linalg.norm(arms, axis=1)[:, None]
        return np.stack([radial, np.cross(around, radial), around], axis=1)


def frame_of(number: int, cards: Mapping[int, Card], inside: tuple[int, ...] = ()) -> Frame:
    """The coordinate system of a number from the cards CORD2R, CORD2C and CORD2S; 0 is the basic
    one.

    Three points in the system that the card refers to: the origin, one on the third axis, one in
    the plane of the first and third.
    """
    if number == 0:
        return Frame("R", np.zeros(3), np.eye(3))
    if number not in cards:
        raise MeshError(
            f"coordinate system {number}: expected a card CORD2R, CORD2C or CORD2S, found none"
        )
    card = cards[number]
    if number in inside:
        raise MeshError(f"{card.location}: coordinate system {number} refers to itself")
    points = np.array([card.number(field) for field in range(4, 13)]).reshape(3, 3)
    origin, on_third, in_plane = frame_of(card.integer(3, 0), cards, (*inside, number)).to_basic(
        points
    )
    third, across = on_third - origin, np.cross(on_third - origin, in_plane - origin)
    if not across.any():
        raise MeshError(
            f"{card.location}: {card.name}: expected three points that are not on a line"
        )
    third, second = third / np.linalg.norm(third), across / np.linalg.norm(across)
    return Frame(card.name[-1], origin, np.array([np.cross(second, third), second, third]))
