"""Robots of these tests, as models and as MuJoCo computes them."""

from pathlib import Path

import pytest
from duhamel.robots import ImportOptions, import_robot
from duhamel.solver import read_model, simulate

DATA = Path(__file__).parent / "data"
STEPS_OF_REFERENCE = 4000


def model_of(robot, folder, **options):
    """The model file of a robot: a name of a file in data/, or a path."""
    path = folder / "robot.toml"
    import_robot(DATA / robot, path, ImportOptions(**options))
    return read_model(path)


def urdf_of(folder, text):
    """A file of a robot with these links and joints."""
    path = folder / "robot.urdf"
    path.write_text(f'<robot name="r">{text}</robot>', encoding="utf-8")
    return path


def link(name, mass=1.0, J=(0.1, 0.1, 0.1), origin=""):
    """A link in URDF, with principal inertias about its center of mass."""
    xx, yy, zz = J
    return (
        f'<link name="{name}"><inertial>{origin}<mass value="{mass}"/><inertia ixx="{xx}" '
        f'ixy="0" ixz="0" iyy="{yy}" iyz="0" izz="{zz}"/></inertial></link>'
    )


def joint(name, parent, child, inner="", kind="continuous", axis="0 0 1"):
    """A joint in URDF."""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<axis xyz="{axis}"/>{inner}</joint>'
    )


BASE = '<link name="base"/>'


def rates(model, **settings):
    """The rates of the joint coordinates of a model at the end of its run, by joint."""
    results = simulate(model.with_settings(**settings) if settings else model)
    coordinates = {joint.name: joint.coordinates for joint in model.joints}
    return {
        name: float(getattr(results.joint(name), f"{coordinate}_rate")[-1])
        for name, (coordinate,) in coordinates.items()
    }


def rates_by_mujoco(path, state, t_end, *, friction=False):
    """The rates of joints after t_end, by name, with Runge-Kutta's method of order 4.

    friction: keep Coulomb friction, which MuJoCo solves as a soft constraint.
    """
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(path))
    flags = mujoco.mjtDisableBit
    off = [flags.mjDSBL_CONTACT, flags.mjDSBL_LIMIT, flags.mjDSBL_EQUALITY]
    off += [] if friction else [flags.mjDSBL_FRICTIONLOSS]
    model.opt.disableflags |= sum(map(int, off))
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    model.opt.timestep = t_end / STEPS_OF_REFERENCE
    data = mujoco.MjData(model)
    for name, value in state.items():
        data.joint(name).qpos[0] = value
    for _ in range(STEPS_OF_REFERENCE):
        mujoco.mj_step(model, data)
    names = [model.joint(j).name for j in range(model.njnt)]
    return {name: float(data.joint(name).qvel[0]) for name in names}
