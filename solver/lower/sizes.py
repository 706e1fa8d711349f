"""The dimensions of what moves in a run, from those of its system."""

from ..history.dyadic import Window
from ..step.system import System
from .surface_sizes import sizes_of_surfaces

# contacts that can end before the time loop hands them over, and one more of each
EVENT_CAPACITY = 256


def sizes_of(system: System, n_steps: int) -> dict[str, int]:
    """The dimensions of `State`, `Workspace` and `Output` by name (step/system.py)."""
    pattern, elastic = system.pattern, system.elastic
    # Rows of a body's block below its six rigid ones are those of its active dofs.
    owner = pattern.body[pattern.force_block[:, 0]]
    n_touching = len(system.couplings.contact) + len(system.surfaces.contacts.patch)
    force_rows = pattern.force_block[:, 3] * (pattern.size[owner] - 6)
    return {
        "n_b": len(system.bodies.mass),
        "n_f": len(system.frames.body),
        "n_j": len(system.couplings.range) - 1,
        "n_i": len(system.couplings.rows.kind),
        "n_terms": len(system.couplings.terms.row),
        "n_o": len(system.observers.kind),
        "n_h": int(system.couplings.laws.memory[-1]),
        "n_k": len(system.couplings.contact),
        "n_r": len(system.couplings.friction.first),
        "n_motors": len(system.couplings.laws.motors.row),
        "n_motor_signals": 3 * len(system.couplings.laws.motors.row),
        "n_touching": n_touching,
        "n_v": EVENT_CAPACITY + n_touching if n_touching else 0,
        "n_l": len(system.loads.frame),
        "n_t": len(system.patterns.body),
        "n_y": len(system.loads.frame) + len(system.patterns.body),
        "n_z": len(system.sensors.dof),
        "n_g": len(elastic.pattern_dof),
        "n_d": len(system.couplings.driven),
        "n_e": len(elastic.body),
        "n_axial": len(elastic.axial.body),
        "n_free": len(system.bodies.free),
        "n_u": int(elastic.dof[-1]),
        "n_a": len(elastic.active),
        "n_m": len(elastic.modes.stiffness),
        "n_x": len(elastic.modes.chains.amplitude),
        "n_s": int(elastic.second.r.sum()),
        "n_3q": 3 * int(elastic.second.r.max(initial=0)),
        "n_slopes": int(elastic.second.row[-1]),
        "n_p": Window(elastic).capacity(n_steps) if elastic.kernels.lags.any() else 0,
        "n_numbers": pattern.n_numbers,
        "n_unknowns": int(pattern.first[-1]),
        "n_force_rows": int(force_rows.max()),
        **sizes_of_surfaces(system.surfaces),
    }
