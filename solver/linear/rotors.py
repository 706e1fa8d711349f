"""Rotors in axes fixed in space: linear equations with bearings that are unlike all round.

In axes that turn with the rotor its own equations x' = A x are constant, but those of anisotropic
bearings change with the angle psi. A rotor that is alike all round its axis has a turning T(psi) =
exp(psi J / Omega) of its coordinates that leaves it as it is. In space x_s = T x has

    x_s' = (A(0) + J) x_s

which is constant. J is Omega x for positions, rotations and rates of bodies; for the modes of a
flexible body it follows from those of its interfaces on the axis, in pairs of one frequency. Omega
is that of each body: supports that stand have J = 0 and may be of any shape. That
T(psi) A(psi) T(-psi) = A(0) is checked at another angle. Source: docs/theory.md, Rotors.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from ...files.blas import one_blas_thread
from ..arrays import Array
from ..couplings.bearings import Bearing
from ..couplings.coupling import GROUND
from ..couplings.joint import basis_about
from ..errors import ModelError, about
from ..lower.placement import frame_pose, place_bodies
from ..model.model import Model
from ..model.settings import SteadyRotation
from ..model.speed_ratios import speed_ratios
from .blocks import diagonal_blocks
from .equations import Equations, equations_of
from .flexibility import ModalBody
from .linearize import LinearModel
from .modes import FirstOrder, LinearModes, States, modes_of
from .pose import Pose, pose_of
from .steady import PROBE_TURN, turned
from .tangent import skew

# relative, of modes in two planes that are one pair
PAIR_TOLERANCE = 1e-5
# of the size of the model, from the axis, of interfaces that turn in place
OFF_AXIS_TOLERANCE = 1e-6
# of the largest shape of a mode on the axis, below which a mode leaves the axis where it is
MIN_SHAPE = 1e-6
# of the cosine of the angle between the axes of a bearing and of the rotor
MAX_MISALIGNMENT = 1e-9
# of synchronous equations, beyond which damping is nothing but rounding
MAX_CONDITION = 1e12
# relative, of responses before and after a turn
MAX_DIFFERENCE_BY_TURN = 1e-5
NOT_ALIKE_ALL_ROUND = (
    "it is not alike all round the axis: expected axisymmetric bodies where they turn, with such "
    "joints and loads, and unequal bearings on supports that stand; `floquet` takes other rotors"
)


class InSpace(FirstOrder):
    """(A + J - sigma)^-1 on coordinates that the constraints leave free."""

    def __init__(self, equations: Equations, sigma: float | None = None) -> None:
        super().__init__(equations)
        if sigma is not None:
            self.sigma, self.factors = sigma, equations.factorized(sigma)
        self.turning = turning_of(self)
        J = self.coordinates @ self.turning @ self.basis
        self.J: Array = diagonal_blocks([J, J, np.zeros((self.n_e, self.n_e))])

    @cached_property
    def turning_with(self) -> Array:
        """(A - sigma)^-1 (n, n), in axes that turn."""
        columns: Array = self.joined(super().solve(*self.split(np.eye(self.n))))
        return columns

    @cached_property
    def _factor(self) -> Any:
        from scipy.linalg import lu_factor

        return lu_factor(np.eye(self.n) + self.turning_with @ self.J)

    def solve(self, y: Any, v: Any, e: Any) -> States:
        """(A + J - sigma)^-1 of a state."""
        from scipy.linalg import lu_solve

        turning = self.joined(super().solve(y, v, e))
        y_j, v_j, e_j = self.split(self.J @ lu_solve(self._factor, turning))
        return super().solve(y - y_j, v - v_j, e - e_j)

    def at(self, sigma: complex) -> "FirstOrder":
        raise NotImplementedError  # chains alone need it, which are refused

    def synchronous(self, forced: Any, ratio: float) -> Any:
        """States (n, k) under forces that turn with a shaft; forced: as by `FirstOrder.forced`.

        (i Omega - J - A)^-1 b, with the states f = (sigma - A)^-1 b that are given. ratio: the
        speed Omega of the shaft over that of the rotation.
        """
        s = 1j * ratio * self.equations.pose.speed - self.sigma
        matrix = np.eye(self.n) - self.turning_with @ (s * np.eye(self.n) - self.J)
        if np.linalg.cond(matrix) > MAX_CONDITION:
            raise ModelError(
                f"rotor at {self.equations.pose.speed:.6g} rad/s: it resonates there without "
                "damping: give its bearings some, or take another spin"
            )
        return np.linalg.solve(matrix, forced)


def turning_of(form: FirstOrder) -> Array:
    """J (n_y, n_y): what turning with the rotor adds to rates of rigid coordinates and modes."""
    pose = form.equations.pose
    blocks = []
    for velocity in pose.state.bodies.v:
        blocks += [skew(velocity[3:]), skew(velocity[3:])]
    return np.asarray(
        diagonal_blocks([*blocks, *(_turning_modes(pose, e, b) for e, b in enumerate(form.bodies))])
    )


def _turning_modes(pose: Pose, e: int, body: ModalBody) -> Array:
    """J (m, m) of the modes of a flexible body, antisymmetric."""
    elastic, frames, work = pose.system.elastic, pose.system.frames, pose.work
    b, size = int(elastic.body[e]), float(pose.system.bodies.size)
    omega = pose.state.bodies.v[b, 3:]
    if pose.ratios[b] == 0.0:
        return np.zeros((body.m, body.m))
    shapes, turned_shapes = [], []
    for f in np.flatnonzero(frames.dof >= 0).tolist():
        arm = work.frames.r[f] - pose.center
        off = np.linalg.norm(np.cross(arm, pose.angular_velocity)) / pose.speed
        if frames.body[f] != b or off > OFF_AXIS_TOLERANCE * size:
            continue
        first = int(frames.dof[f] - elastic.dof[e])
        for start, scale in ((first, 1.0), (first + 3, size)):
            if start == first or frames.rotations[f]:
                shape = scale * body.phi[start : start + 3]
                shapes.append(shape)
                turned_shapes.append(skew(omega) @ shape)
    J = np.zeros((body.m, body.m))
    if not shapes:
        return J
    phi, turned_phi = np.vstack(shapes), np.vstack(turned_shapes)
    least = MIN_SHAPE * float(np.abs(phi).max(initial=0.0))
    for pair in _pairs(np.sqrt(body.stiffness)):
        own = phi[:, pair]
        if np.abs(own).max(initial=0.0) <= least:
            continue
        X = np.linalg.lstsq(own, turned_phi[:, pair], rcond=MIN_SHAPE)[0]
        J[np.ix_(pair, pair)] = 0.5 * (X - X.T)
    return J


def _pairs(frequencies: Array) -> list[list[int]]:
    """Numbers of modes, those of one frequency together."""
    groups: list[list[int]] = []
    order = np.argsort(frequencies, kind="stable").tolist()
    for k, before in zip(order, [None, *order], strict=False):
        if before is not None and (
            frequencies[k] - frequencies[before] <= PAIR_TOLERANCE * frequencies[k]
        ):
            groups[-1].append(k)
        else:
            groups.append([k])
    return groups


def check_alike_all_round(form: InSpace) -> None:
    """ModelError unless the equations in space are the same at another angle of the rotor."""
    from scipy.linalg import expm

    pose = form.equations.pose
    with turned(form.equations) as equations:
        if equations is None:
            raise _uneven(pose, "its forces change with the angle")
        other = InSpace(equations, form.sigma)
        after = other.turning_with
    T = expm(PROBE_TURN / pose.speed * form.turning)
    T = form.coordinates @ T @ form.basis
    T = np.asarray(diagonal_blocks([T, T, np.eye(form.n_e)]))
    # Bases of constraints differ by the turn: all is compared in those of the first angle.
    change = form.coordinates @ other.basis
    change = np.asarray(diagonal_blocks([change, change, np.eye(form.n_e)]))
    before, after = form.turning_with, T @ change @ after @ change.T @ T.T
    if np.abs(after - before).max() > MAX_DIFFERENCE_BY_TURN * np.abs(before).max():
        raise _uneven(pose, NOT_ALIKE_ALL_ROUND)


def _uneven(pose: Pose, why: str) -> ModelError:
    return ModelError(f"rotor at {pose.speed:.6g} rad/s: {why}")


@dataclass(frozen=True, eq=False)
class RotorModel(LinearModel):
    """The linear equations of a rotor on bearings, in axes fixed in space, made by `rotor_at`."""

    in_space: ClassVar[bool] = True

    @cached_property
    def equations(self) -> Equations:
        with one_blas_thread():
            return equations_of(pose_of(self.model, self.rotation))

    @cached_property
    def first_order(self) -> InSpace:
        if self.equations.is_chained:
            raise ModelError(
                "a material has a chain of Maxwell elements, which rotors in axes fixed in space "
                "do not support: give its damping by modes"
            )
        with one_blas_thread():
            form = InSpace(self.equations)
            check_alike_all_round(form)
        return form

    def modes(self, n: int | None = None) -> LinearModes:
        with about(self.model.path), one_blas_thread():
            return modes_of(self.first_order, n)


def rotor_at(model: Model, spin: float) -> RotorModel:
    """The linear equations of a rotor at a spin, in axes fixed in space.

    Gravity across the axis does not count: coefficients of bearings are those of the loaded
    bearing. Bodies that carry supports of bearings stand, others turn with the rotor, and shafts at
    other speeds are named in `SteadyRotation.speed_ratios`.

    Parameters
    ----------
    model : Model
    spin : float [rad/s]
        Above zero, about the axis of the steady rotation, or that of the first bearing.

    Returns
    -------
    RotorModel

    Raises
    ------
    ModelError
        For a rotor that is not alike all round its axis, a body of which it is unclear whether it
        turns, a spin beyond the table of a bearing, and what `linearize` refuses.

    Examples
    --------
    A disk of 10 kg between bearings that are twice as stiff one way as the other:

    >>> from duhamel.solver import Bearing, Frame, Model, RigidBody
    >>> disk = RigidBody(10.0, [0.1, 0.1, 0.2])
    >>> film = Bearing("film", ["ground.hub", "disk"], [0.0, 0.0, 1.0], [1e5, 2e5])
    >>> model = Model({"disk": disk}, bearings=[film], ground_frames={"hub": Frame()})
    >>> modes = rotor_at(model, 300.0).modes()
    >>> modes.frequencies[modes.rigid:modes.rigid + 2].round(3).tolist()
    [15.915, 22.508]
    """
    with about(model.path):
        linear = RotorModel(*prepared_rotor(model, spin))
        _ = linear.first_order
    return linear


def prepared_rotor(model: Model, spin: float) -> tuple[Model, SteadyRotation]:
    """The model without what rotors do not take, and its rotation, for linear equations."""
    if not 0.0 < spin < np.inf:
        raise ModelError(f"rotor: expected a spin above 0 rad/s, got {spin:g}")
    axes = rotor_axes(model)
    ratios = speed_ratios(model, model.settings.steady_rotation)
    if not any(ratios.values()):
        raise ModelError("rotor: no body turns: expected a speed ratio other than 0")
    speeds = {GROUND: 0.0, **ratios}
    for bearing in model.bearings:
        along = float(bearing.axis @ axes.axis)
        if abs(abs(along) - 1.0) > MAX_MISALIGNMENT:
            raise bearing.error(
                f"axis: expected that of the rotor, {axes.axis.tolist()}, "
                f"got {bearing.axis.tolist()}"
            )
        support, shaft = (speeds[side.partition(".")[0]] for side in bearing.between)
        bearing.coefficients((shaft - support) * spin * float(np.sign(along)))
    gravity = (model.gravity @ axes.axis) * axes.axis
    model = replace(model.without_surfaces(), gravity=gravity)
    if model.settings.step is None and not model.flexible_bodies:
        # No step is taken, but rigid bodies alone propose none.
        model = model.with_settings(step=0.5 * model.settings.t_end)
    return model, SteadyRotation(spin * axes.axis, axes.center, ratios)


@dataclass(frozen=True, eq=False)
class RotorAxes:
    """The axis (3,) of a rotor, a point (3,) [m] on it, and e_1, e_2 across it, fixed in space."""

    axis: Array
    center: Array
    first: Array

    @property
    def across(self) -> Array:
        """e_1 and e_2 (2, 3), which with the axis are right-handed."""
        return np.array([self.first, np.cross(self.axis, self.first)])


def rotor_axes(model: Model) -> RotorAxes:
    """Those of the steady rotation of the settings, or of the first bearing; e_1 is the bearing's.

    ModelError for a model that has neither.
    """
    found = _axes_of_bearings(model)
    rotation = model.settings.steady_rotation
    if rotation is not None and np.any(rotation.angular_velocity):
        velocity = np.array(rotation.angular_velocity)
        axis = velocity / np.linalg.norm(velocity)
        first = basis_about(axis, np.eye(3))[:, 0] if found is None else found.first
        return RotorAxes(axis, np.array(rotation.center), first)
    if found is None:
        raise ModelError(
            "simulation: expected the axis and the center of a steady_rotation, or a bearing"
        )
    return found


def _axes_of_bearings(model: Model) -> RotorAxes | None:
    """Those of the first bearing to a frame of the ground, or else to one of a body, as placed."""
    # A frame of the ground is where it is; bodies may be moved to close their joints.
    bearing = min(model.bearings, key=_is_off_the_ground, default=None)
    if bearing is None:
        return None
    support, shaft = bearing.between
    # The bare ground has no place: there the bearing is where the shaft is.
    is_bare = support == GROUND
    pose = frame_pose(model, place_bodies(model), shaft if is_bare else support)
    first = bearing.basis(np.eye(3) if is_bare else pose.R)[:, 0]
    return RotorAxes(np.array(bearing.axis), pose.x, first)


def _is_off_the_ground(bearing: Bearing) -> bool:
    """Whether it stands on no frame of the ground."""
    return not bearing.between[0].startswith(f"{GROUND}.")
