"""The cost of derivatives by dual numbers and by differences, over that of a run.

python benchmarks/derivatives.py
python benchmarks/derivatives.py arm

"arm": a rigid arm on a hinge alone, beside MuJoCo and Drake where they are installed, as
`beside_robotics.py` installs them.

Seconds of the processor, the least of some rounds: a machine with other work on it gives the same
ratios. Case 1 has nothing that switches; the ball bounces, and is differentiated at six values.
"""

import sys
import time
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from duhamel import preprocess, superelement
from duhamel.solver import (
    Constant,
    Contact,
    Frame,
    Impact,
    Model,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    Torque,
    read_model,
    simulate,
)
from duhamel.solver.derivatives.run import recorded_rows, run_with_derivatives
from duhamel.solver.derivatives.seeds import Seeds, start_of
from duhamel.solver.lower.allocation import make_output
from duhamel.solver.step.loop import advance
from duhamel.solver.step.record import record
from duhamel.solver.step.system import Run
from duhamel.study import sensitivities
from numpy.typing import NDArray

Array = NDArray[np.float64]
Derived = tuple[Callable[[], Array], Callable[[], object]]
"""what gives the angle at the end and its derivatives, and what makes a run"""
ROOT = Path(__file__).parents[1]
ROUNDS = 3
COUNTS = (1, 4)
NO_SEEDS = Seeds({part: {} for part in ("system", "state", "work", "inputs")}, 0)
CASE_1 = (
    *("loads.0.signal.values.0", "loads.0.signal.values.2", "bodies.hub.frames.rim.position.0"),
    "loads.0.signal.times.1",
)
BALL = (
    *("contacts.floor.stiffness", "bodies.ball.mass", "bodies.ball.position.2"),
    "simulation.gravity.2",
)


def seconds(function: Callable[[], object]) -> float:
    """The least time of some calls, after one that compiles what is needed."""
    function()
    taken = []
    for _ in range(ROUNDS):
        begin = time.process_time()
        function()
        taken.append(time.process_time() - begin)
    return min(taken)


def case_1(folder: Path) -> Model:
    element = preprocess.build(preprocess.read_body(ROOT / "meshes/beam/beam.toml"))
    superelement.write(folder / "beam.h5", element)
    text = (ROOT / "examples/case1.toml").read_text()
    (folder / "case1.toml").write_text(text.replace("../meshes/beam/beam.h5", "beam.h5"))
    return read_model(folder / "case1.toml")


def bouncing() -> Model:
    floor = Contact(
        "floor",
        ["ground.floor", "ball"],
        "plane",
        ball=0.0,
        axis=[0, 0, 1],
        impact=Impact(stiffness=1e5, restitution=1.0),
    )
    ball = RigidBody(1.0, [0.1] * 3, start=Start(position=[0.0, 0.0, 0.01]))
    return Model(
        {"ball": ball},
        contacts=[floor],
        ground_frames={"floor": Frame([0, 0, 0])},
        gravity=(0, 0, -9.81),
        settings=Settings(t_end=0.2, step=4e-5),
    )


def loop_ratio(model: Model, k: int) -> float:
    """The time loop with k derivatives, its rows recorded, over that without."""

    def taken(derivatives: int) -> float:
        start = start_of(model, recorded_rows)
        initial = start.initial
        output = make_output(start.lowered, start.lowered.n_steps + 2)
        system = start.lowered.system
        run = Run(system=system, state=initial.state, work=initial.work, output=output)
        begin = time.process_time()
        if derivatives:
            run_with_derivatives(start, [NO_SEEDS] * derivatives, ())
        else:
            record(run, 0)
            advance(run, start.inputs)
        return time.process_time() - begin

    least = [min(taken(n) for _ in range(1 + ROUNDS)) for n in (k, 0)]
    return least[0] / least[1]


def report(name: str, model: Model, parameters: Sequence[str], outputs: Sequence[str]) -> None:
    run = seconds(lambda: simulate(model))
    print(f"{name}: a run takes {run:.3f} s")
    loops = ", ".join(f"{k}: {loop_ratio(model, k):.1f}" for k in (1, 4, 8))
    print(f"    the loop with derivatives, over that without: {loops}")
    for method in ("dual", "differences"):
        ratios = [
            seconds(lambda: sensitivities(model, parameters[:n], outputs, method=method)) / run  # noqa: B023
            for n in COUNTS
        ]
        shown = ", ".join(f"{n}: {ratio:.1f}" for n, ratio in zip(COUNTS, ratios, strict=True))
        print(f"    {method}, runs for parameters {shown}")


ARM = {"mass": 1.2, "torque": 2.0, "damping": 0.3}
CENTER, MOMENT, GRAVITY, ARM_END, ARM_STEP = 0.4, 0.05, 9.80665, 1.0, 1e-3
"""of the arm, which begins at rest and level: [m], [kg m^2] about its center, [m/s^2], [s], [s]"""


def exact_arm() -> tuple[float, Array]:
    """The angle at the end and its derivatives, by the equation of motion and its variation."""
    from scipy.integrate import solve_ivp

    m, torque, c = ARM.values()
    J, weight = MOMENT + m * CENTER**2, m * GRAVITY * CENTER

    def rates(_: float, y: Array) -> list[float]:
        q, v = y[:2]
        a = (torque - c * v - weight * np.cos(q)) / J
        by_p = (-(CENTER**2) * a - GRAVITY * CENTER * np.cos(q), 1.0, -v)
        along = ((weight * np.sin(q) * y[2 + i] - c * y[5 + i] + by_p[i]) / J for i in range(3))
        return [v, a, *y[5:], *along]

    end = solve_ivp(rates, (0.0, ARM_END), np.zeros(8), "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    return float(end[0]), end[2:5]


def duhamel_arm(method: str) -> Derived:
    def make(mass: float, torque: float, damping: float) -> Model:
        frames = {"root": Frame([-CENTER, 0, 0])}
        start = Start(position=[CENTER, 0, 0])
        body = RigidBody(mass, [1e-3, MOMENT, MOMENT], frames, start=start)
        between = ("ground", "arm.root")
        return Model(
            {"arm": body},
            joints=[Revolute(*between, [0, 0, 1], name="hinge")],
            springs=[Spring("damper", "torsion", between, [0, 0, 1], damping=damping)],
            loads=[Torque("arm", [0, 0, 1], Constant(torque))],
            gravity=(0, -GRAVITY, 0),
            settings=Settings(t_end=ARM_END, step=ARM_STEP),
        )

    def derivatives() -> Array:
        found = sensitivities(make, ARM, ["final angle:arm:z"], method=method)
        return np.array([*found.value, *found.derivative[0]])

    return derivatives, lambda: simulate(make(**ARM))


def mujoco_arm(integrator: str) -> Derived:
    """By differences of runs: its own derivatives are those of a step by state and control.

    "implicit": the one by the torque is `mjd_transitionFD`, which RK4 does not have, chained over
    all steps.
    """
    import mujoco

    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="{ARM_STEP}" integrator="{integrator}"
        gravity="0 -{GRAVITY} 0"/>
        <worldbody><body><joint name="hinge" axis="0 0 1"/><inertial pos="{CENTER} 0 0" mass="1"
        diaginertia="1e-3 {MOMENT} {MOMENT}"/></body></worldbody>
        <actuator><motor joint="hinge"/></actuator></mujoco>"""
    )
    data, steps = mujoco.MjData(model), round(ARM_END / ARM_STEP)

    def run(mass: float, torque: float, damping: float, chained: bool = False) -> float:
        mujoco.mj_resetData(model, data)
        model.body_mass[1], model.dof_damping[0] = mass, damping
        data.ctrl[0] = torque
        A, B, along = np.zeros((2, 2)), np.zeros((2, 1)), np.zeros((2, 1))
        for _ in range(steps):
            if chained:
                mujoco.mjd_transitionFD(model, data, 1e-6, True, A, B, None, None)
                along = A @ along + B
            mujoco.mj_step(model, data)
        return float(along[0, 0] if chained else data.qpos[0])

    def derivatives() -> Array:
        slopes = []
        for name, value in ARM.items():
            width = 1e-4 * value
            ends = (run(**{**ARM, name: value + side * width}) for side in (1, -1))
            slopes.append((next(ends) - next(ends)) / (2.0 * width))
        if integrator == "implicit":
            slopes[1] = run(**ARM, chained=True)
        return np.array([run(**ARM), *slopes])

    return derivatives, lambda: run(**ARM)


def drake_arm() -> Derived:
    """With `AutoDiffXd` as the scalar of a plant in continuous time."""
    from pydrake.autodiffutils import AutoDiffXd, InitializeAutoDiff
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import (
        RevoluteJoint,
        RotationalInertia,
        RotationalInertia_,
        SpatialInertia,
        SpatialInertia_,
    )
    from pydrake.systems.analysis import (
        ApplySimulatorConfig,
        Simulator,
        Simulator_,
        SimulatorConfig,
    )

    config = SimulatorConfig(
        integration_scheme="runge_kutta3", max_step_size=ARM_STEP, use_error_control=False
    )
    plain = MultibodyPlant(0.0)
    plain.mutable_gravity_field().set_gravity_vector([0.0, -GRAVITY, 0.0])
    moments = [1e-3, MOMENT, MOMENT]
    inertia = SpatialInertia.MakeFromCentralInertia(
        1.0, [CENTER, 0.0, 0.0], RotationalInertia(*moments)
    )
    body = plain.AddRigidBody("arm", inertia)
    hinge = plain.AddJoint(
        RevoluteJoint("hinge", plain.world_frame(), body.body_frame(), [0.0, 0.0, 1.0])
    )
    plain.AddJointActuator("motor", hinge)
    plain.Finalize()
    dual = plain.ToAutoDiffXd()

    def end(plant: Any, values: Any, scalar: Any, parts: tuple[Any, ...]) -> Any:
        rotational, spatial, simulator_of = parts
        simulator = simulator_of(plant)
        context = simulator.get_mutable_context()
        mass, torque, damping = values
        center = np.array([scalar(CENTER), scalar(0.0), scalar(0.0)])
        own = rotational(*(scalar(one) for one in moments))
        plant.GetBodyByName("arm").SetSpatialInertiaInBodyFrame(
            context, spatial.MakeFromCentralInertia(mass, center, own)
        )
        plant.GetJointByName("hinge").SetDamping(context, damping)
        plant.get_actuation_input_port().FixValue(context, np.array([torque]))
        ApplySimulatorConfig(config, simulator)
        simulator.AdvanceTo(ARM_END)
        return plant.GetPositions(context)[0]

    def derivatives() -> Array:
        values = InitializeAutoDiff(np.array(list(ARM.values()))).ravel()
        kinds = (RotationalInertia_, SpatialInertia_, Simulator_)
        found = end(dual, values, AutoDiffXd, tuple(kind[AutoDiffXd] for kind in kinds))
        return np.array([found.value(), *found.derivatives()])

    parts = (RotationalInertia, SpatialInertia, Simulator)
    return derivatives, lambda: end(plain, list(ARM.values()), float, parts)


def report_arm() -> None:
    """How far derivatives are off the exact ones, and how many runs of its own each takes."""
    angle, exact = exact_arm()
    print(f"arm: angle {angle:.12g}, by {', '.join(ARM)}: {exact}")
    programs: dict[str, Callable[[], Derived]] = {
        "dual": lambda: duhamel_arm("dual"),
        "differences": lambda: duhamel_arm("differences"),
        "MuJoCo, RK4": lambda: mujoco_arm("RK4"),
        "MuJoCo, implicit": lambda: mujoco_arm("implicit"),
        "Drake": drake_arm,
    }
    for name, make in programs.items():
        package = {"M": "mujoco", "D": "pydrake"}.get(name[0], "duhamel")
        if not find_spec(package):
            print(f"    {name}: is not installed")
            continue
        derivatives, run = make()
        value, *slopes = derivatives()
        misses = ", ".join(f"{one:.1e}" for one in np.abs(slopes / exact - 1.0))
        ratio = seconds(derivatives) / seconds(run)
        print(
            f"    {name}: angle off by {abs(value - angle):.1e}, derivatives by {misses};", end=""
        )
        print(f" takes {ratio:.1f} runs")


def main() -> None:
    report_arm()
    if sys.argv[1:] == ["arm"]:
        return
    with TemporaryDirectory() as folder:
        outputs = ["final angle:hub:z", "max |displacement:beam.tip:hub.rim:y|"]
        report("Case 1", case_1(Path(folder)), CASE_1, outputs)
    report("ball", bouncing(), BALL, ["final position:ball:z", "max event:floor:peak"])


if __name__ == "__main__":
    main()
