"""Rigid mechanisms beside MuJoCo, Drake and Pinocchio: CPU time of a step, and errors.

The pendulum (A01) and two linkages in a row (A02) of the IFToMM library, 10 s with steps of 1 ms.
The other programs use joint coordinates, in which a pendulum has no constraint. Their loops are
closed by `connect` in MuJoCo, by ball constraints in Drake, and by `constraintDynamics` in
Pinocchio, which has no time stepping of its own: RK4 in Python here. Times are those of whole runs
with all states recorded, on one thread. Needs the extra `benchmark`. Run as
`python benchmarks/beside_robotics.py [--repeats N]`.
"""

import argparse
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[1] / "examples/benchmarks"))
import four_bars
import pendulum
from peer.run import Stopwatch

Array = NDArray[np.float64]
Measure = Callable[[], tuple[float, float]]
"""gives CPU time of a step [us], and the largest distance of the tip from its place [m]"""

STEP, T_END, G = 1e-3, 10.0, 9.81
N = round(T_END / STEP)
TIME = STEP * np.arange(N + 1)
BAR = 1.0 / 12.0
"""moment of inertia of a bar of 1 kg and 1 m [kg m^2]"""
THIN = 1e-6


def measured(run: Callable[[], Array], expected: Array) -> tuple[float, float]:
    """Of a run that gives the tip (N + 1, 2), or in joint coordinates its angle (N + 1,)."""
    watch = Stopwatch()
    with watch.running():
        tip = run()
    if tip.ndim == 1:
        tip = np.stack([np.cos(tip), np.sin(tip)], axis=1)
    return 1e6 * watch.cpu / N, float(np.linalg.norm(tip - expected, axis=1).max())


# Duhamel


def duhamel_pendulum() -> Array:
    m = pendulum.mechanism()
    return m.simulate(T_END, step=STEP)["bob"].x[:, :2]


def duhamel_linkages() -> Array:
    run = four_bars.linkage(2).simulate(T_END, step=STEP)
    return run["upright0.top"].position[:, :2]


# MuJoCo

PENDULUM = """<body pos="0 0 0"><joint name="q" axis="0 0 1"/>
  <inertial pos="-1 0 0" mass="1" diaginertia="1e-9 1e-9 1e-9"/></body>"""
UPRIGHT = """<body name="upright{i}" pos="{i} 0 0"><joint name="q{i}" axis="0 0 1"/>
  <inertial pos="0 .5 0" mass="1" diaginertia="{bar} 1e-6 {bar}"/>{coupler}</body>"""
COUPLER = """<body name="coupler{i}" pos="0 1 0"><joint name="p{i}" axis="0 0 1"/>
  <inertial pos=".5 0 0" mass="1" diaginertia="1e-6 {bar} {bar}"/></body>"""
CONNECT = '<connect body1="coupler{i}" body2="upright{j}" anchor="1 0 0" {stiff}/>'


def mujoco(integrator: str, bodies: str, loops: str, start: Callable[[Any, Any], None]) -> Array:
    """The angle of the first joint, by default from its place."""
    import mujoco
    from mujoco import rollout

    xml = f"""<mujoco><option timestep="{STEP}" integrator="{integrator}" gravity="0 -{G} 0"
      tolerance="1e-12" iterations="200"/>
      <worldbody>{bodies}</worldbody><equality>{loops}</equality></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    start(model, data)
    mujoco.mj_forward(model, data)
    state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    states, _ = rollout.rollout(model, data, state, nstep=N)
    # time comes first, then positions
    return np.concatenate([state[1:2], states[0, :, 1]])


def mujoco_pendulum(integrator: str) -> Array:
    return np.pi + mujoco(integrator, PENDULUM, "", lambda model, data: None)


def mujoco_linkages(stiff: str) -> Array:
    uprights = [
        UPRIGHT.format(i=i, bar=BAR, coupler=COUPLER.format(i=i, bar=BAR) if i < 2 else "")
        for i in range(3)
    ]
    loops = "".join(CONNECT.format(i=i, j=i + 1, stiff=stiff) for i in range(2))

    def start(model: Any, data: Any) -> None:
        for i in range(3):
            data.joint(f"q{i}").qvel[0] = -1.0
            if i < 2:
                data.joint(f"p{i}").qvel[0] = 1.0

    return np.pi / 2 + mujoco("implicit", "".join(uprights), loops, start)


# Drake


def drake(build: Callable[[Any], Any], start: Callable[[Any, Any], None]) -> Array:
    """The angle of the joint that `build` returns, in a discrete plant."""
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, DiscreteContactApproximation
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, STEP)
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
    plant.mutable_gravity_field().set_gravity_vector([0.0, -G, 0.0])
    joint = build(plant)
    plant.Finalize()
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    start(plant, context)
    angles = [joint.get_angle(context)]
    simulator.Initialize()
    for k in range(1, N + 1):
        simulator.AdvanceTo(k * STEP)
        angles.append(joint.get_angle(context))
    return np.array(angles)


def drake_body(plant: Any, name: str, center: list[float], moments: list[float]) -> Any:
    from pydrake.multibody.tree import RotationalInertia, SpatialInertia

    inertia = RotationalInertia(*moments)
    return plant.AddRigidBody(name, SpatialInertia.MakeFromCentralInertia(1.0, center, inertia))


def drake_joint(plant: Any, name: str, parent: Any, at: list[float], child: Any) -> Any:
    from pydrake.math import RigidTransform
    from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint

    frame = plant.AddFrame(FixedOffsetFrame(f"{name} frame", parent, RigidTransform(at)))
    return plant.AddJoint(RevoluteJoint(name, frame, child.body_frame(), [0.0, 0.0, 1.0]))


def drake_pendulum() -> Array:
    def build(plant: Any) -> Any:
        bob = drake_body(plant, "bob", [-1.0, 0.0, 0.0], [1e-9] * 3)
        return drake_joint(plant, "q", plant.world_body(), [0.0, 0.0, 0.0], bob)

    return np.pi + drake(build, lambda plant, context: None)


def drake_linkages() -> Array:
    joints: dict[str, Any] = {}

    def build(plant: Any) -> Any:
        uprights, couplers = [], []
        for i in range(3):
            upright = drake_body(plant, f"upright{i}", [0.0, 0.5, 0.0], [BAR, THIN, BAR])
            joints[f"q{i}"] = drake_joint(plant, f"q{i}", plant.world_body(), [i, 0, 0], upright)
            uprights.append(upright)
        for i in range(2):
            coupler = drake_body(plant, f"coupler{i}", [0.5, 0.0, 0.0], [THIN, BAR, BAR])
            joints[f"p{i}"] = drake_joint(plant, f"p{i}", uprights[i], [0, 1, 0], coupler)
            couplers.append(coupler)
        for i in range(2):
            plant.AddBallConstraint(couplers[i], [1.0, 0.0, 0.0], uprights[i + 1], [0.0, 1.0, 0.0])
        return joints["q0"]

    def start(plant: Any, context: Any) -> None:
        for name, joint in joints.items():
            joint.set_angular_rate(context, -1.0 if name[0] == "q" else 1.0)

    return np.pi / 2 + drake(build, start)


# Pinocchio


def pinocchio_model(linkages: bool) -> tuple[Any, Any]:
    """The model, and its loops."""
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array([0.0, -G, 0.0])
    loops = pin.StdVec_RigidConstraintModel()

    def add(parent: int, at: list[float], name: str, center: list[float], moments: Any) -> int:
        j = model.addJoint(parent, pin.JointModelRZ(), pin.SE3(np.eye(3), np.array(at)), name)
        inertia = pin.Inertia(1.0, np.array(center), np.diag(moments))
        model.appendBodyToJoint(j, inertia, pin.SE3.Identity())
        return int(j)

    if not linkages:
        add(0, [0.0, 0.0, 0.0], "q", [-1.0, 0.0, 0.0], [1e-9] * 3)
        return model, loops
    previous = -1
    for i in range(3):
        upright = add(0, [float(i), 0.0, 0.0], f"q{i}", [0.0, 0.5, 0.0], [BAR, THIN, BAR])
        if previous >= 0:
            loop = pin.RigidConstraintModel(
                pin.ContactType.CONTACT_3D,
                model,
                previous,
                pin.SE3(np.eye(3), np.array([1.0, 0.0, 0.0])),
                upright,
                pin.SE3(np.eye(3), np.array([0.0, 1.0, 0.0])),
                pin.ReferenceFrame.LOCAL,
            )
            # Baumgarte's, critically damped over twenty steps
            gains = loop.m_baumgarte_parameters
            gains.Kp, gains.Kd = (1.0 / (20 * STEP)) ** 2, 2.0 / (20 * STEP)
            loops.append(loop)
        if i < 2:
            previous = add(upright, [0.0, 1.0, 0.0], f"p{i}", [0.5, 0.0, 0.0], [THIN, BAR, BAR])
    return model, loops


def pinocchio(linkages: bool) -> Array:
    """By the fourth-order method of Runge and Kutta."""
    import pinocchio as pin

    model, loops = pinocchio_model(linkages)
    data, none = model.createData(), np.zeros(model.nv)
    of_loops = pin.StdVec_RigidConstraintData()
    of_loops.extend([loop.createData() for loop in loops])
    if len(loops):
        pin.initConstraintDynamics(model, data, loops, of_loops)
    settings = pin.ProximalSettings(1e-12, 1e-10, 10)

    def acceleration(q: Array, v: Array) -> Array:
        if not len(loops):
            return pin.aba(model, data, q, v, none)
        return pin.constraintDynamics(model, data, q, v, none, loops, of_loops, settings)

    names = list(model.names)[1:]
    q = np.zeros(model.nq)
    v = np.array([{"q": -1.0, "p": 1.0}[name[0]] for name in names]) if linkages else none.copy()
    first, h = names.index("q0") if linkages else 0, STEP
    angles = [q[first]]
    for _ in range(N):
        a1 = acceleration(q, v).copy()
        a2 = acceleration(q + h / 2 * v, v + h / 2 * a1).copy()
        v2 = v + h / 2 * a1
        a3 = acceleration(q + h / 2 * v2, v + h / 2 * a2).copy()
        v3 = v + h / 2 * a2
        v4 = v + h * a3
        a4 = acceleration(q + h * v3, v4).copy()
        q = q + h / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        angles.append(q[first])
    return (np.pi / 2 if linkages else np.pi) + np.array(angles)


def problems() -> dict[str, dict[str, Measure]]:
    falls, turns = pendulum.exact(TIME), four_bars.reference(2, TIME)

    def of(run: Callable[..., Array], expected: Array, *given: Any) -> Measure:
        return lambda: measured(lambda: run(*given), expected)

    return {
        "pendulum": {
            "Duhamel": of(duhamel_pendulum, falls),
            "MuJoCo, Euler": of(mujoco_pendulum, falls, "Euler"),
            "MuJoCo, RK4": of(mujoco_pendulum, falls, "RK4"),
            "Drake, discrete": of(drake_pendulum, falls),
            "Pinocchio, RK4 in Python": of(pinocchio, falls, False),
        },
        "2 linkages": {
            "Duhamel": of(duhamel_linkages, turns),
            "MuJoCo, default stiffness": of(mujoco_linkages, turns, ""),
            "MuJoCo, stiffest": of(
                mujoco_linkages, turns, f'solref="{2 * STEP} 1" solimp="0.9999 0.9999 0.001"'
            ),
            "Drake, discrete": of(drake_linkages, turns),
            "Pinocchio, RK4 in Python": of(pinocchio, turns, True),
        },
    }


def is_installed(program: str) -> bool:
    """Programs that are not are left out."""
    module = {"MuJoCo": "mujoco", "Drake": "pydrake", "Pinocchio": "pinocchio"}
    name = program.partition(",")[0].partition(" ")[0]
    return name not in module or find_spec(module[name]) is not None


def main() -> None:
    parser = argparse.ArgumentParser(description="Rigid mechanisms beside robotics programs.")
    parser.add_argument("--repeats", type=int, default=3)
    repeats = parser.parse_args().repeats
    print("| problem | | CPU, us a step | error [m] |", "|---|---|---|---|", sep="\n")
    for problem, all_programs in problems().items():
        programs = {name: run for name, run in all_programs.items() if is_installed(name)}
        for measure in programs.values():
            measure()  # once without counting: first calls load and compile
        runs: dict[str, list[tuple[float, float]]] = {name: [] for name in programs}
        for _ in range(repeats):
            for name, measure in programs.items():
                runs[name].append(measure())
        for name, pairs in runs.items():
            least, most = min(pairs)[0], max(pairs)[0]
            print(
                f"| {problem} | {name} | {least:.1f} to {most:.1f} | {pairs[0][1]:.2g} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
