"""The rotating beam of Cases 1 and 2 in Exudyn: a planar, geometrically exact reference.

The problem (paper, section 11.1): a hub of inertia I_R = phi I_T turns about a fixed vertical axis
under the torque C_0 F(t). At distance a from the axis it carries a beam, clamped, radial when
undeformed, undamped, without gravity.

    I_T = m L (L^2/12 + (a + L/2)^2)

The model shares nothing with Duhamel: absolute nodal coordinates in the plane of the motion, no
floating frame, no linearized strain. The beam is a row of `ObjectANCFCable2D`, Euler-Bernoulli
without rotary inertia, with

    axial strain |r'| - 1,    curvature (r' x r'') / |r'|^2,

so foreshortening and centrifugal stiffening are in it. The hub is a planar rigid body on a revolute
joint. The clamp holds the position and the direction of r' at the root and leaves |r'|, the axial
strain, free.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import exudyn
import numpy as np
from exudyn.itemInterface import (
    LoadTorqueVector,
    MarkerBodyPosition,
    MarkerBodyRigid,
    NodePoint2DSlope1,
    NodeRigidBody2D,
    ObjectANCFCable2D,
    ObjectGround,
    ObjectJointGeneric,
    ObjectJointRevolute2D,
    ObjectRigidBody2D,
    SensorNode,
)
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

L = 0.5  # beam length [m]
a = 0.05  # eccentricity of the clamp [m]
EA = 2.16e7  # axial stiffness [N]
EI = 5.5  # bending stiffness [N m^2]
m = 0.0858  # mass per length [kg/m]
I_T = (
    m * L * (L**2 / 12 + (a + L / 2) ** 2)
)  # inertia of the rigid beam about the hub axis [kg m^2]


@dataclass(frozen=True, eq=False)
class RotatingBeam:
    """Histories of the motion at n times, starting from rest with the beam along the x axis.

    time (n,) [s], hub_angle (n,) [rad], hub_speed (n,) [rad/s]
    tip (n, 2) [m]      tip displacement in the hub frame, R_hub^T (r_tip - r_clamp) - (L, 0),
                        eq. (96) put right
    clamp (n, 3)        what the clamp leaves open: gap in the hub frame (2) [m] and angle of the
                        root slope [rad]
    """

    time: Array
    hub_angle: Array
    hub_speed: Array
    tip: Array
    clamp: Array


@dataclass(frozen=True, eq=False)
class _Model:
    """The assembled system with the items a run needs; the container owns the system and has to
    outlive it.
    """

    container: Any
    system: Any
    torque: int
    hub_position: int
    hub_velocity: int
    root: int
    tip: int


def rotating_beam(
    phi: float,
    C0: float,
    torque_times: ArrayLike,
    torque_values: ArrayLike,
    t_end: float,
    step: float = 1e-5,
    n_elements: int = 40,
) -> RotatingBeam:
    """Motion under the torque C0 F(t) [N m], F = torque_values[i] from torque_times[i] on and 0
    before the first.

    Every jump of the torque ends one run of the integrator and starts another one from the state
    reached, with accelerations computed afresh, so that the area of the torque is exact and no step
    straddles a jump. Each run takes equal steps of at most `step` [s]. With the default step and
    mesh the histories of hub speed and tip deflection in Cases 1 and 2 lie within 5e-5 of their
    peaks from those of 80 elements and a step four times smaller.

    The integrator is Exudyn's generalized-alpha for index-3 constraints, spectral radius 0.9:
    second order, with a damping ratio of O((omega h)^3). Its multipliers need a radius below one.
    Newton stops on the increment (1e-12): the axial forces EA (|r'| - 1) carry rounding errors near
    1e-6 N, so that a residual norm would depend on the mesh.

    Raises ValueError for a torque that is not a step law, exudyn.SolverError when Newton does not
    converge.
    """
    times, values = np.asarray(torque_times, dtype=float), np.asarray(torque_values, dtype=float)
    if times.ndim != 1 or times.shape != values.shape:
        raise ValueError(
            f"torque: expected one value per time, found shapes {times.shape} and {values.shape}"
        )
    if np.any(np.diff(times) <= 0.0):
        raise ValueError(f"torque: expected increasing times, found {times}")

    model = _assemble(phi, n_elements)
    choices = settings()
    edges = np.concatenate(([0.0], times[(times > 0.0) & (times < t_end)], [t_end]))
    histories = []
    for start, end in pairwise(edges):
        F = values[times <= start][-1] if np.any(times <= start) else 0.0
        steps = int(np.ceil((end - start) / step * (1.0 - 1e-12)))
        choices.timeIntegration.startTime = start
        choices.timeIntegration.endTime = end
        choices.timeIntegration.numberOfSteps = steps
        model.system.SetLoadParameter(model.torque, "loadVector", [0.0, 0.0, C0 * F])
        model.system.SolveDynamic(choices, updateInitialValues=True)
        # Each run stores its initial state too: the end of the run before it.
        history = _history(model, np.linspace(start, end, steps + 1))
        histories.append(history if not histories else history[1:])
    return _in_hub_frame(np.vstack(histories))


def hinged_frequencies(phi: float, n_elements: int = 40, count: int = 3) -> Array:
    """The lowest `count` elastic frequencies (count,) [Hz] of the undeformed model, its hub free to
    turn.
    """
    system = _assemble(phi, n_elements).system
    frequencies, _ = system.ComputeODE2Eigenvalues(convert2Frequencies=True)
    return frequencies[1 : count + 1]  # the first is the rotation of the whole


def _assemble(phi: float, n_elements: int) -> _Model:
    container = exudyn.SystemContainer()
    system = container.AddSystem()

    # The hub turns about its own center: its mass plays no part.
    hub_node = system.AddNode(NodeRigidBody2D())
    hub = system.AddObject(ObjectRigidBody2D(mass=1.0, inertia=phi * I_T, nodeNumber=hub_node))
    ground = system.AddObject(ObjectGround())
    axis = system.AddMarker(MarkerBodyRigid(bodyNumber=hub))
    pivot = system.AddMarker(MarkerBodyPosition(bodyNumber=ground))
    system.AddObject(ObjectJointRevolute2D(markerNumbers=[pivot, axis]))

    nodes = [
        system.AddNode(NodePoint2DSlope1(referenceCoordinates=[x, 0.0, 1.0, 0.0]))
        for x in a + np.linspace(0.0, L, n_elements + 1)
    ]
    cables = [
        system.AddObject(
            ObjectANCFCable2D(
                length=L / n_elements,
                massPerLength=m,
                bendingStiffness=EI,
                axialStiffness=EA,
                nodeNumbers=[left, right],
            )
        )
        for left, right in pairwise(nodes)
    ]

    rim = system.AddMarker(MarkerBodyRigid(bodyNumber=hub, localPosition=[a, 0.0, 0.0]))
    root = system.AddMarker(MarkerBodyRigid(bodyNumber=cables[0], localPosition=[0.0, 0.0, 0.0]))
    # Two translations and the turn about z; Exudyn states the turn as orthogonal axes, exact at any
    # angle.
    system.AddObject(
        ObjectJointGeneric(markerNumbers=[rim, root], constrainedAxes=[1, 1, 0, 0, 0, 1])
    )

    def sensor(node: int, quantity: Any) -> int:
        return system.AddSensor(
            SensorNode(
                nodeNumber=node, outputVariableType=quantity, storeInternal=True, writeToFile=False
            )
        )

    quantity = exudyn.OutputVariableType
    model = _Model(
        container=container,
        system=system,
        torque=system.AddLoad(LoadTorqueVector(markerNumber=axis)),
        hub_position=sensor(hub_node, quantity.Coordinates),
        hub_velocity=sensor(hub_node, quantity.Coordinates_t),
        root=sensor(nodes[0], quantity.Coordinates),
        tip=sensor(nodes[-1], quantity.Coordinates),
    )
    system.Assemble()
    return model


def settings() -> Any:
    """Exudyn's integration and Newton's method; the caller gives time span and number of steps."""
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = 0.0  # every step
    settings.parallel.numberOfThreads = 1
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.adaptiveStep = False  # a step that fails is an error, not a smaller step
    integration.generalizedAlpha.spectralRadius = 0.9
    integration.newton.useModifiedNewton = True
    integration.newton.residualMode = 1  # norm of the increment
    integration.newton.relativeTolerance = 1e-12
    integration.newton.absoluteTolerance = 1e-12
    return settings


def _history(model: _Model, time: Array) -> Array:
    """One run as columns (n, 11): time, hub angle, hub speed, then four nodal displacements of root
    and of tip.
    """
    # Column 0 of each sensor is Exudyn's time, a running sum of steps: replaced by the grid it
    # stands for.
    hub_position, hub_velocity, root, tip = (
        np.asarray(model.system.GetSensorStoredData(sensor))[:, 1:]
        for sensor in (model.hub_position, model.hub_velocity, model.root, model.tip)
    )
    return np.column_stack((time, hub_position[:, 2], hub_velocity[:, 2], root, tip))


def _in_hub_frame(history: Array) -> RotatingBeam:
    time, angle, speed = history[:, :3].T
    root, tip = history[:, 3:7], history[:, 7:11]
    cos, sin = np.cos(angle), np.sin(angle)

    def turned_back(x: Array, y: Array) -> Array:
        return np.column_stack((cos * x + sin * y, cos * y - sin * x))

    gap = turned_back(a + root[:, 0], root[:, 1]) - (a, 0.0)
    slope = turned_back(1.0 + root[:, 2], root[:, 3])
    return RotatingBeam(
        time=time,
        hub_angle=angle,
        hub_speed=speed,
        tip=turned_back(a + L + tip[:, 0], tip[:, 1]) - (a + L, 0.0),
        clamp=np.column_stack((gap, np.arctan2(slope[:, 1], slope[:, 0]))),
    )
