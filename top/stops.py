"""Stops: limits of joint coordinates, with play."""

from duhamel.solver.couplings.impact import ForceTable, Impact
from duhamel.solver.couplings.stops import Stop
from duhamel.solver.schema.values import Named


def stop(
    joint: str | Named,
    coordinate: str,
    limits: tuple[float, float],
    *,
    stiffness: float | None = None,
    exponent: float | None = None,
    law: ForceTable | None = None,
    restitution: float = 1.0,
    damping: float = 0.0,
    yield_force: float | None = None,
    post_yield: float | None = None,
    name: str = "",
) -> Stop:
    """Limits of a joint coordinate, with the force of a contact beyond them.

    Parameters
    ----------
    joint
        The joint, or its name.
    coordinate : str
        "angle", "distance", ...
    limits : (2,) [rad, m]
        Its free play, of which one end may be infinite.
    stiffness, exponent
        The force is `stiffness d^exponent` of the penetration d.
    law : ForceTable
        Instead of these a table of forces.
    restitution : float
        Speed after an impact over that before it.
    damping : float [s/rad, s/m]
        Instead of it: the force is multiplied by `1 + damping d'`.
    yield_force : float [N m, N]
        Beyond it the stop deforms for good, with `post_yield` times the slope at yield.
    name : str
    """
    impact = Impact(
        stiffness=stiffness,
        exponent=exponent,
        law=law,
        restitution=restitution,
        damping=damping,
        yield_force=yield_force,
        post_yield=post_yield,
    )
    return Stop(name, joint, coordinate, limits, impact)


__all__ = ["ForceTable", "stop"]
