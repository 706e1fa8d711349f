"""The subjects of validity criteria in a model: their owners, and the data about them."""

import numpy as np
from numpy.typing import NDArray

from ...superelement import Superelement
from ..arrays import Array, Index, as_index, distinct
from ..lower.lower import LoweredModel
from ..step.rows import ANGLE, GAP, TOUCH

# [kg/m^3] for bodies whose volume is not known, as of lines
STEEL_DENSITY = 8000.0
# of the duration of a contact. A peak before that needs more steps than the duration alone asks
# for.
EARLY_PEAK = 0.25

Mask = NDArray[np.bool_]


class Subjects:
    """The owners of validity criteria in a model, and the data about them."""

    def __init__(self, lowered: LoweredModel) -> None:
        self.lowered = lowered
        elements = lowered.superelements
        elastic, frames = lowered.system.elastic, lowered.system.frames
        self.bodies = [*lowered.model.flexible_bodies]
        self.tested: Mask = np.array([e.provenance.tested for e in elements], bool)
        """flexible bodies whose error is a misfit to their test"""
        self.second: Mask = elastic.second.r > 0
        """flexible bodies with terms of second order"""
        self.stiffened = self.second & np.array([_stiffens(element) for element in elements], bool)
        """those of them whose stress stiffens them"""
        self.stressed = ~self.stiffened & np.array([_has_stress(e) for e in elements], bool)
        """bodies that are not, of which stress or strain is known"""
        self.stress_by_spin = np.array(
            [_stress_by_spin(e) for e, known in zip(elements, self.stressed, strict=True) if known]
        )
        """of these, in proportion to the square of their spin"""
        self.interfaces = np.flatnonzero(frames.dof >= 0)
        of_interfaces = elastic.of_body[frames.body[self.interfaces]]
        self.curved = self.stiffened[of_interfaces]
        """interfaces of stiffened bodies"""
        self.sizes = elastic.size[of_interfaces]
        """of the bodies of the interfaces"""
        self.lengths = self._lengths()
        couplings = lowered.system.couplings
        owners = [lowered.coupling_of(row) for row in range(len(couplings.compliant))]
        self.coupling = np.array(owners, dtype=np.int64)
        """the coupling of each row"""
        self.joints = distinct(self.coupling[couplings.compliant == 0])
        driven = couplings.laws.motor >= 0
        self.bearing = _bearing(lowered)
        """the constraint rows that measure lengths, whose multipliers are forces"""
        self.bearings = distinct(self.coupling[self.bearing])
        feeds = np.array([coupling.may_feed for coupling in lowered.model.couplings], dtype=bool)
        passive = (couplings.compliant == 1) & ~driven & ~feeds[self.coupling]
        self.springs = distinct(self.coupling[passive])
        self.contacts = couplings.contact
        self.rises = _rises(lowered)
        self.hertzian, self.patches = _hertzian(lowered)
        self.balls, self.ball_radii = _balls(lowered)
        self.carried = self._carried()
        self.hinges = _hinges(lowered)
        self.jointed = distinct(frames.body[self.hinges])
        self.wheels = self._wheels()
        self.angles = np.flatnonzero(lowered.system.observers.kind == ANGLE)
        self.servos = np.array([motor.is_servo for motor in lowered.model.motors], dtype=bool)
        self.has_modes = bool(elastic.modes.range.any())

    def _lengths(self) -> Array:
        """Factors that make the rates of elastic dofs velocities of the body: 0 for no motions."""
        elastic, frames = self.lowered.system.elastic, self.lowered.system.frames
        lengths = np.ones(int(elastic.dof[-1]))
        for f, size in zip(self.interfaces, self.sizes, strict=True):
            if frames.rotations[f]:
                lengths[frames.dof[f] + 3 : frames.dof[f] + 6] = size**2
        bodies = self.lowered.model.flexible_bodies.values()
        for first, body in zip(elastic.dof.tolist(), bodies, strict=False):
            # amplitudes of patterns and readings of sensors are no motions of the body
            lengths[first + body.superelement.n_c : first + body.n_outer] = 0.0
        return lengths

    def _carried(self) -> Index:
        """The contacts whose shape an interface carries, by number."""
        rows, frames = self.lowered.system.couplings.rows, self.lowered.system.frames
        first = self.lowered.system.couplings.range[self.contacts]
        flexible = frames.dof[rows.frame_a[first]] >= 0
        return np.flatnonzero((rows.kind[first] == GAP) & flexible)

    def _wheels(self) -> Index:
        """The bodies that roll without slip, and that another joint holds."""
        couplings, body = self.lowered.system.couplings, self.lowered.system.frames.body
        hard, rows = couplings.compliant == 0, couplings.rows
        rolling: Index = body[rows.frame_b[hard & (rows.kind == TOUCH)]]
        # Most models have none, and `unique` loads masked arrays.
        if not len(rolling):
            return rolling
        ends = [
            np.stack([self.coupling[hard], body[f[hard]]], 1) for f in (rows.frame_a, rows.frame_b)
        ]
        bodies, joints = np.unique(
            np.unique(np.concatenate(ends), axis=0)[:, 1], return_counts=True
        )
        return np.intersect1d(rolling, bodies[(joints > 1) & (bodies >= 0)])

    def of_interfaces(self, mask: Mask) -> list[str]:
        return [self.lowered.frame_names[f] for f in self.interfaces[mask]]

    def of_bodies(self, mask: Mask) -> list[str]:
        return [name for name, chosen in zip(self.bodies, mask, strict=True) if chosen]

    def of_couplings(self, numbers: Index, kind: str) -> list[str]:
        """Their names, after their kind where it is another."""
        return [_called(self.lowered, j, kind) for j in numbers.tolist()]


def _called(lowered: LoweredModel, j: int, kind: str) -> str:
    """The name of a coupling, after its kind where it is of another."""
    owner, name = lowered.model.couplings[j].owner, lowered.coupling_names[j]
    own = owner.partition(" ")[0]
    return name if own == kind else f"{own}/{name}"


def _rises(lowered: LoweredModel) -> Array:
    """How much earlier than after `EARLY_PEAK` of its duration each contact has its peak, 1 if not.

    A free body that meets a wall with the restitution e has it after about e^0.9 / 2 of the
    duration.
    """
    impacts = [contact.impact for contact in lowered.model.contacts]
    impacts += [stop.impact for stop in lowered.model.stops]
    restitution = np.array([impact.restitution for impact in impacts], dtype=np.float64)
    rises: Array = np.minimum(1.0, 0.5 * restitution**0.9 / EARLY_PEAK)
    return rises


def _hertzian(lowered: LoweredModel) -> tuple[Index, Array]:
    """The contacts by the law of Hertz: their numbers, and the size of the patch of each over the
    radius along it, at a penetration of 1 m.
    """
    contacts = lowered.model.contacts
    numbers = [k for k, contact in enumerate(contacts) if contact.hertz is not None]
    patches = [contacts[k].patch_over_radius for k in numbers]
    return as_index(numbers), np.array(patches, dtype=np.float64)


def _balls(lowered: LoweredModel) -> tuple[Index, Array]:
    """The contacts of balls, not of points: their numbers and radii [m]."""
    radii = [contact.ball for contact in lowered.model.contacts]
    numbers = [k for k, radius in enumerate(radii) if radius > 0.0]
    return as_index(numbers), np.array([radii[k] for k in numbers], dtype=np.float64)


def _hinges(lowered: LoweredModel) -> Index:
    """The frames of bodies that carry constraints, by number."""
    couplings, body = lowered.system.couplings, lowered.system.frames.body
    hard = couplings.compliant == 0
    frames = distinct([couplings.rows.frame_a[hard], couplings.rows.frame_b[hard]])
    hinges: Index = frames[body[frames] >= 0]
    return hinges


def _bearing(lowered: LoweredModel) -> Index:
    """Not the sums of couplers, which are no forces between two frames."""
    couplings = lowered.system.couplings
    terms = np.diff(couplings.terms.range) > 0
    return np.flatnonzero((couplings.compliant == 0) & lowered.measures_lengths & ~terms)


def _stiffens(element: Superelement) -> bool:
    """Whether its terms of second order know what stress does."""
    return element.rotation is not None and element.rotation.stiffens


def _has_stress(element: Superelement) -> bool:
    """Whether its stress or strain is known anywhere."""
    recovered = element.recovery is not None and element.recovery.stress is not None
    return recovered or any(sensor.kind != "motion" for sensor in element.sensors)


def _stress_by_spin(element: Superelement) -> float:
    """rho r^2 [Pa s^2]"""
    outline, density, radius = element.outline, STEEL_DENSITY, 0.5 * element.size
    if outline is not None and len(outline.points):
        radius = float(np.linalg.norm(outline.points, axis=1).max())
        if volume := abs(outline.volume):
            density = element.mass / volume
    return density * radius**2
