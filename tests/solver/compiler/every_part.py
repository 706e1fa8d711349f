"""A model with every kind of part, and what 30 steps of it leave behind.

python every_part.py results.npz
"""

import sys
from typing import Any

import numpy as np
from duhamel.solver import (
    JOINTS,
    BoucWenLaw,
    Constant,
    Coupler,
    DamperLaw,
    ElastoplasticLaw,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    IwanLaw,
    MaxwellLaw,
    Model,
    Motor,
    OneSidedLaw,
    Polynomial,
    PrescribedDisplacement,
    PrescribedRotation,
    Pulse,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    TabulatedDamperLaw,
    TabulatedLaw,
    Torque,
    UserLaw,
)
from duhamel.solver.arrays import Array
from duhamel.solver.laws.law import Evaluation
from duhamel.solver.lower.allocation import make_output
from duhamel.solver.simulation import signals
from duhamel.solver.start.initial import initialize
from duhamel.solver.step.loop import advance
from duhamel.solver.step.record import record
from duhamel.solver.step.system import Output, Run
from duhamel.superelement import (
    Chain,
    GeneralizedAlpha,
    Interface,
    Modes,
    Superelement,
    sample_kernel,
)

H, STEPS = 1e-3, 30
AXIS, SECOND = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([2.0, -2.0, 1.0]) / 3.0
EVERY_JOINT: dict[str, dict[str, Any]] = {
    "fixed": {},
    "spherical": {},
    "revolute": {"axis": AXIS},
    "universal": {"axis": AXIS, "second_axis": SECOND},
    "cylindrical": {"axis": AXIS},
    "prismatic": {"axis": AXIS},
    "planar": {"axis": AXIS},
    "rod": {},
    "screw": {"axis": AXIS, "lead": 0.3},
    "constant_velocity": {"axis": AXIS},
    "point_on_line": {"axis": AXIS},
    "point_on_plane": {"axis": AXIS},
    "rolling_disc": {"axis": AXIS, "second_axis": SECOND, "radius": 0.1},
    "driven revolute": {"axis": AXIS, "angle": Harmonic(0.2, 20.0)},
    "driven prismatic": {"axis": AXIS, "distance": Polynomial((0.0, 0.0, 4.0))},
    "driven cylindrical": {
        "axis": AXIS,
        "angle": Polynomial((0.0, 0.0, 9.0)),
        "distance": Harmonic(0.01, 10.0),
    },
    "driven universal": {"axis": AXIS, "second_axis": SECOND, "second_angle": Harmonic(0.2, 9.0)},
    "driven spherical": {
        "rotation_vector": (Harmonic(0.1, 9.0), Harmonic(0.2, 8.0), Polynomial((0.0, 1.0)))
    },
}


def cubic(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
    k, d = parameters[0], parameters[1]
    return k * c**3 + d * rate, 3.0 * k * c**2, d, 0.25 * k * c**4


def creep(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
    """A spring whose point of rest follows it."""
    k, given = parameters[0], 1.0 / (1.0 + h / parameters[1])
    force = given * (memory[1] + k * (c - memory[0]))
    return force, given * k, 0.0, 0.5 * force**2 / k


def remember_creep(parameters: Array, memory: Array, h: float, c: float, rate: float) -> None:
    given = 1.0 / (1.0 + h / parameters[1])
    memory[1] = given * (memory[1] + parameters[0] * (c - memory[0]))
    memory[0] = c


SPRINGS: dict[str, dict[str, Any]] = {
    "point": {
        "stiffness": 3000.0,
        "damping": 2.0,
        "law": (
            TabulatedLaw((-0.1, 0.0, 0.2), (-9.0, 0.0, 4.0)),
            OneSidedLaw(0.01, 5e3, 1.5),
            UserLaw(cubic, [40.0, 0.3]),
            UserLaw(creep, [50.0, 0.02], [0.0, 0.0], remember_creep),
        ),
    },
    "torsion": {
        "axis": AXIS,
        "stiffness": 50.0,
        "damping": 0.4,
        "rest": [0.2],
        "law": TabulatedLaw((-1.0, 0.0, 1.0), (-3.0, 0.0, 8.0)),
    },
    "bushing": {
        "axis": AXIS,
        "stiffness": [900.0] * 3 + [70.0] * 3,
        "damping": [3.0] * 6,
        "law": {
            "x": BoucWenLaw(0.01, 500.0, 0.1, 1.5, 0.7),
            "y": MaxwellLaw((0.01, 0.1), (50.0, 70.0)),
            "z": (ElastoplasticLaw(2.0, 400.0, 0.1, 0.5), IwanLaw(3.0, 500.0)),
            "rx": DamperLaw(0.1, 0.3),
            "rz": TabulatedDamperLaw((0.0, 1.0, 3.0), (0.0, 0.2, 0.3)),
        },
    },
}


def element(seed: int, by_modes: bool) -> Superelement:
    """A body of random numbers with a six-dof and a three-dof interface."""
    rng = np.random.default_rng(seed)
    interfaces = tuple(
        Interface(f"i{k}", rng.normal(size=3), rotations)
        for k, rotations in enumerate((True, False))
    )
    form = Modes(
        np.sort(rng.uniform(50.0, 2000.0, 8)),
        rng.uniform(0, 0.05, 8),
        rng.normal(size=(9, 8)),
        chain=Chain([0.001, 0.01], [0.02, 0.03]) if by_modes else None,
    )
    return Superelement(
        name=f"random {seed}",
        mass=1.5,
        J_rot=np.diag([1.0, 2.0, 1.5]),
        center=np.zeros(3),
        interfaces=interfaces,
        kernel=sample_kernel(form, H, GeneralizedAlpha(0.8), 200),
        modes=form if by_modes else None,
        compliance=form.phi / form.omega**2 @ form.phi.T,
        accelerance=form.phi @ form.phi.T,
    )


def make_model() -> Model:
    rng = np.random.default_rng(1)
    bodies: dict[str, Any] = {}

    def add_body(name: str) -> str:
        X = rng.normal(size=3)
        frames = {"i0": Frame(X, rng.uniform(-1, 1, 3)), "i1": Frame(rng.normal(size=3))}
        bodies[name] = RigidBody(1.5, [1.0, 2.0, 1.5], frames, Start(-X))
        return name

    joints = []
    for name, given in EVERY_JOINT.items():
        body = add_body(name.replace(" ", "_"))
        support = {"rod": "ground.post", "rolling_disc": "ground.floor"}.get(name, "ground")
        joints.append(
            JOINTS[name.removeprefix("driven ")](support, f"{body}.i0", name=name, **given)
        )
    springs = []
    for name, given in SPRINGS.items():
        body = add_body(f"on_{name}")
        springs.append(Spring(name, name, ("revolute.i1", f"{body}.i1"), **given))
    for name, by_modes in (("modal", True), ("convolved", False)):
        shape = element(len(bodies), by_modes)
        bodies[name] = FlexibleBody(shape, Start(-shape.interface("i0").X))
        joints.append(Revolute("ground", f"{name}.i0", AXIS, name=f"hinge of {name}"))
        springs.append(
            Spring(f"end of {name}", "point", ("ground.post", f"{name}.i1"), stiffness=50.0)
        )
    displaced, turned = add_body("displaced"), add_body("turned")
    return Model(
        bodies,
        tuple(joints),
        springs=tuple(springs),
        motors=(
            Motor("servo", "revolute", "angle", Constant(2.0), stiffness=30.0, integral=9.0),
            Motor("weak", "prismatic", "distance", damping=5.0, limit=(-1.0, 2.0), speed=3.0),
        ),
        couplers=(Coupler("stage", "gear", ("cylindrical.angle", "planar.angle"), teeth=[17, 31]),),
        motions=(
            PrescribedDisplacement("shift", f"{displaced}.i1", AXIS, Harmonic(0.1, 10.0)),
            PrescribedRotation("turn", f"{turned}.i1", AXIS, Polynomial((0.0, 0.0, 5.0))),
        ),
        loads=(
            Force("modal.i1", [1.0, -2.0, 0.5], Constant(20.0)),
            Force("convolved.i1", [1.0, 2.0, 0.5], Pulse(9.0, 0.0, 0.01), follower=True),
            Torque("spherical", [1.0, 0.0, 2.0], Harmonic(7.0, 30.0)),
            Torque("modal.i0", [1.0, 1.0, 2.0], Constant(2.0), follower=True),
        ),
        settings=Settings(t_end=STEPS * H, step=H, rho_inf=0.8),
        gravity=[0.0, 0.0, -9.81],
        ground_frames={"post": Frame([0.3, 0.2, 0.1]), "floor": Frame(-0.1 * AXIS)},
    )


def run() -> Output:
    initial = initialize(make_model())
    output = make_output(initial.lowered, STEPS + 1)
    run = Run(system=initial.lowered.system, state=initial.state, work=initial.work, output=output)
    record(run, 0)
    taken, _ = advance(run, signals(initial.lowered, 1, np.arange(1, STEPS + 1)))
    assert taken == STEPS
    return output


if __name__ == "__main__":
    output = run()
    np.savez(sys.argv[1], **{name: getattr(output, name) for name in output.layout})
