"""The bicycle and Bennett's linkage in Exudyn."""

from typing import Any

import numpy as np
from exudyn.itemInterface import (
    MarkerBodyRigid,
    ObjectGround,
    ObjectJointGeneric,
    ObjectJointRollingDisc,
    SensorBody,
)
from exudyn.rigidBodyUtilities import RigidBodyInertia
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from .published import GRAVITY, TOLERANCE
from .run import Run
from .system import System

Array = NDArray[np.float64]
HINGE = [1, 1, 1, 1, 1, 0]


class Mechanism:
    """Rigid bodies by name, placed and moving at the start, and joints between points in space."""

    def __init__(self, step: float) -> None:
        self.system = System(step, TOLERANCE)
        self._items = self.system.items
        self._places = {"ground": (self._items.AddObject(ObjectGround()), np.zeros(3), np.eye(3))}

    def add(
        self, name: str, mass: float, J: Any, at: Array, axes: Array, v: Array, omega: Array
    ) -> None:
        """J (3,) or (3, 3) in body axes; omega in space."""
        tensor = np.diag(J) if np.ndim(J) == 1 else np.array(J)
        body = self._items.CreateRigidBody(
            referencePosition=list(at),
            referenceRotationMatrix=axes,
            initialVelocity=list(v),
            initialAngularVelocity=list(omega),
            inertia=RigidBodyInertia(mass, tensor),
            gravity=[0.0, 0.0, -GRAVITY],
            returnDict=True,
        )
        self._places[name] = (body["bodyNumber"], np.asarray(at), axes)

    def _marker(self, name: str, point: Array) -> int:
        body, at, axes = self._places[name]
        place = list(axes.T @ (np.asarray(point) - at))
        marker: int = self._items.AddMarker(MarkerBodyRigid(bodyNumber=body, localPosition=place))
        return marker

    def hinge(
        self, one: str, other: str, point: Array, axis: Any, constrained: list[int] = HINGE
    ) -> None:
        turn = Rotation.align_vectors([axis], [[0.0, 0.0, 1.0]])[0].as_matrix()
        self._items.AddObject(
            ObjectJointGeneric(
                markerNumbers=[self._marker(name, point) for name in (one, other)],
                constrainedAxes=constrained,
                rotationMarker0=self._places[one][2].T @ turn,
                rotationMarker1=self._places[other][2].T @ turn,
            )
        )

    def roll(self, wheel: str, radius: float) -> None:
        """On the plane z = 0, about the y axis of its body."""
        center = self._places[wheel][1]
        self._items.AddObject(
            ObjectJointRollingDisc(
                markerNumbers=[self._marker("ground", np.zeros(3)), self._marker(wheel, center)],
                discRadius=radius,
                discAxis=[0.0, 1.0, 0.0],
            )
        )

    def run(self, name: str, point: Any, t_end: float) -> Run:
        """The tip is a point of a body, in its axes from its center."""
        body = self._places[name][0]
        self.system.watch(SensorBody, bodyNumber=body, localPosition=list(point))
        self._items.Assemble()
        self.system.march(t_end)
        return self.system.run()


def bicycle(model: Any, speed: float, lean_rate: float, step: float, t_end: float) -> Run:
    """The model is the script of the benchmark; the tip is a point 1 m to the left of the frame."""
    rear_at, front_at = [0.0, 0.0, model.REAR_RADIUS], [model.BASE, 0.0, model.FRONT_RADIUS]
    m, lean = Mechanism(step), np.array([lean_rate, 0.0, 0.0])
    for name, (mass, J), at, spin in (
        ("frame", model.FRAME, model.FRAME_AT, 0.0),
        ("handle", model.HANDLE, model.HANDLE_AT, 0.0),
        ("rear", model.REAR, rear_at, speed / model.REAR_RADIUS),
        ("front", model.FRONT, front_at, speed / model.FRONT_RADIUS),
    ):
        v = np.array([speed, 0.0, 0.0]) + np.cross(lean, at)
        m.add(name, mass, J, np.array(at), np.eye(3), v, lean + np.array([0.0, spin, 0.0]))
    m.hinge("frame", "rear", rear_at, [0.0, 1.0, 0.0])
    m.hinge("handle", "front", front_at, [0.0, 1.0, 0.0])
    head, tilt = [model.BASE + model.TRAIL, 0.0, 0.0], model.TILT
    m.hinge("frame", "handle", head, [np.sin(tilt), 0.0, -np.cos(tilt)])
    m.roll("rear", model.REAR_RADIUS)
    m.roll("front", model.FRONT_RADIUS)
    return m.run("frame", [0.0, 1.0, 0.0], t_end)


def bennett(model: Any, step: float, t_end: float) -> Run:
    """The model is the script of the benchmark; the tip is the end of the first bar."""
    m = Mechanism(step)
    # With Exudyn's default of 25 Newton's method fails in one step of five seconds.
    m.system.settings.timeIntegration.newton.maxIterations = 50
    places, rates = model.place(model.START), model.rates_at(model.START) * model.SPEED
    for k, ((length, _), (origin, axes)) in enumerate(zip(model.LINKS, places, strict=True)):
        center = origin + axes @ [length / 2, 0.0, 0.0]
        mass, J = model.MASS_PER_LENGTH * length, model.inertia(length)
        m.add(f"bar{k}", mass, J, center, axes, rates[k, 3:], rates[k, :3])
    (_, first), (second_at, second), (third_at, third) = places
    m.hinge("ground", "bar0", np.zeros(3), first[:, 2])
    m.hinge("bar0", "bar1", second_at, second[:, 2])
    m.hinge("bar1", "bar2", third_at, third[:, 2])
    # The other three of this hinge are redundant.
    last = np.array([-model.B, 0.0, 0.0])
    m.hinge(
        "ground", "bar2", last, [0.0, np.sin(model.BETA), np.cos(model.BETA)], [1, 1, 0, 0, 0, 0]
    )
    return m.run("bar0", [model.A / 2, 0.0, 0.0], t_end)
