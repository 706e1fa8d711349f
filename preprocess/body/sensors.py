"""Sensors of the body file: points that are read, and never loaded."""

from ...inputs import Table, Vector, rule


class SensorPoint(Table):
    """A place in the body that is read: its motion, or with `direction` the strain of a gauge.

    point (3,) [m], within an element, or beside the axis of a beam, with whose section it
    moves. direction (3,): that of a strain gauge; length [m]: over which it takes the
    mean, at the point unless given. stress: the stresses at the point, of solids.
    """

    point: Vector
    direction: Vector | None = None
    length: float | None = None
    stress: bool = False

    @rule
    def _one_reading(self) -> None:
        if self.direction is not None and self.stress:
            raise ValueError("expected one of direction and stress, found both")
        if self.direction is not None and not any(self.direction):
            raise ValueError("direction: expected a vector that is not zero")
        if self.length is not None and self.direction is None:
            raise ValueError("length: a strain gauge needs a direction, found none")
        # Negated, so that a value that is no number is refused as well.
        if self.length is not None and not self.length > 0.0:
            raise ValueError(f"length: expected a positive number, found {self.length}")

    @property
    def kind(self) -> str:
        """The kind of the sensor in the superelement."""
        if self.stress:
            return "stress"
        return "motion" if self.direction is None else "strain"
