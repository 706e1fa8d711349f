"""Contacts of surfaces against Hertz, bar theory, and statics."""

import warnings

import duhamel as du
import numpy as np
import pytest
import skfem
from duhamel.solver import (
    Contact,
    Fixed,
    FlexibleBody,
    Frame,
    Hertz,
    Model,
    RigidBody,
    Settings,
    Start,
    simulate,
)
from duhamel.solver.couplings.surface_contacts import SurfaceContact
from scipy.spatial.transform import Rotation

from ..solver.pressing import Motion
from ..surface_bodies import RADIUS, ball, bar, dome

E, NU, RHO = 210e9, 0.3, 7800.0
pytestmark = pytest.mark.validation

PLANE = {"shape": "plane", "axis": [0.0, 0.0, 1.0]}


def quietly(part, **impulse):
    with warnings.catch_warnings():
        # of the few elements in a wave: these meshes are fine where they touch
        warnings.simplefilter("ignore", du.preprocess.PlausibilityWarning)
        return part.superelement(**impulse)


# Statics: steps so long that no mode moves


def cube(n, width, low, nu=NU):
    """A block 8 mm high with n x n facets on the face that is low or high, held at the other."""
    across, half = np.linspace(-0.5 * width, 0.5 * width, n + 1), 0.004
    mesh = skfem.MeshHex.init_tensor(across, across, np.linspace(-half, half, 5))
    part = du.Part(mesh, du.Material(E=E, nu=nu, rho=RHO))
    part.surface("face", du.plane(z=-half if low else half))
    part.interface("back", du.plane(z=half if low else -half))
    return quietly(part, step=1e-6, band=4e5)


def pressed(upper, lower, slave, depth=1e-6):
    """Two blocks whose backs are held so that they overlap by a depth, at rest."""
    keys = ["upper.face", "lower.face"] if slave == "upper" else ["lower.face", "upper.face"]
    model = Model(
        {
            "upper": FlexibleBody(upper, Start([0.0, 0.0, 0.004 - depth])),
            "lower": FlexibleBody(lower, Start([0.0, 0.0, -0.004])),
        },
        joints=[Fixed("ground", f"{name}.back") for name in ("upper", "lower")],
        surface_contacts=[SurfaceContact("press", keys)],
        settings=Settings(t_end=0.1, step=1e-2, rho_inf=0.0),
    )
    motion = Motion(model)
    assert motion.step(4)
    return motion


@pytest.mark.parametrize("slave", ["upper", "lower"])
def test_uniform_pressure_passes_between_meshes_that_do_not_match(slave):
    """6 x 6 facets on 5 x 5, and the same in every step."""
    motion = pressed(cube(6, 0.008, True, 0.0), cube(5, 0.008, False, 0.0), slave)
    pressure = E * 1e-6 / 0.016
    assert motion.forces[-1] == pytest.approx(pressure * 0.008**2, rel=4e-4)
    np.testing.assert_allclose(motion.forces[2:], motion.forces[-1], rtol=1e-7)
    off = motion.state.surfaces.force / motion.work.surfaces.area / pressure - 1.0
    assert np.sqrt(np.mean(off**2)) < 6e-3
    assert np.abs(off).max() < 1.2e-2


def test_a_surface_that_its_target_covers_in_part_is_as_stiff_as_the_other_way_round():
    """A block of 8 mm on one of 5 mm, off the edges of its facets."""
    large, small = cube(6, 0.008, True), cube(5, 0.005, False)
    both = [pressed(large, small, slave).forces[-1] for slave in ("upper", "lower")]
    assert both[0] == pytest.approx(both[1], rel=2e-3)


def test_static_hertz_pressure():
    """A dome on a plane: the largest pressure, and all within 0.85 of the radius of contact."""
    part = dome(1e-4, 7, 6, 8e-4)
    part.interface("back", du.plane(z=0.008))
    element = quietly(part, step=5e-7, band=4e5)
    place = -element.surfaces.patches[0].X[:, 2].min() - 2.0e-5
    model = Model(
        {"dome": FlexibleBody(element, Start([0.0, 0.0, place]))},
        joints=[Fixed("ground", "dome.back")],
        surface_contacts=[SurfaceContact("floor", ["dome.dome", "ground"], **PLANE)],
        settings=Settings(t_end=0.1, step=1e-2, rho_inf=0.0),
    )
    motion = Motion(model)
    assert motion.step(4)
    force, stiffness = motion.forces[-1], E / (1.0 - NU**2)
    radius = (0.75 * force * RADIUS / stiffness) ** (1.0 / 3.0)
    peak = 1.5 * force / (np.pi * radius**2)
    patch = element.surfaces.patches[0]
    r = np.hypot(*patch.X[patch.corner_nodes, :2].T)
    pressure = motion.state.surfaces.force / np.where(
        motion.work.surfaces.area > 0.0, motion.work.surfaces.area, np.inf
    )
    assert 4.0 < radius / 1e-4 < 6.5
    assert pressure[r.argmin()] / peak == pytest.approx(1.0, abs=0.015)
    inner = r < 0.85 * radius
    off = pressure[inner] / peak - np.sqrt(1.0 - (r[inner] / radius) ** 2)
    assert np.sqrt(np.mean(off**2)) < 0.02  # of 8 mm, not a half-space


# Impacts


def hertz(speed, mass, stiffness, radius):
    """The largest force of a ball that meets a plane."""
    k = 4.0 / 3.0 * stiffness * np.sqrt(radius)
    return k * (5.0 * mass * speed**2 / (4.0 * k)) ** 0.6


def struck(element, surface, speed, step, steps, gap=1e-7, contacts=None, others=None, **start):
    patch = element.surface(surface)
    place = [0.0, 0.0, -patch.X[:, 2].min() + gap]
    body = FlexibleBody(
        element, Start(**{"position": place, "velocity": [0.0, 0.0, -speed], **start})
    )
    contact = SurfaceContact("blow", [f"body.{surface}", "ground"], **PLANE)
    model = Model(
        {"body": body, **(others or {})},
        surface_contacts=contacts or [contact],
        settings=Settings(t_end=steps * step, step=step, rho_inf=0.9),
    )
    motion = Motion(model)
    assert motion.step(steps)
    return motion


@pytest.fixture(scope="module")
def coarse_ball():
    return quietly(ball(0.03, 3, 2, 2.2, 0.12), step=5e-7, band=2.7e5)


def test_impact_of_a_ball(coarse_ball):
    """Within 5 % of Hertz on the coarse mesh, and of second order in the step."""
    T = 6.4e-5
    runs = {
        step: struck(coarse_ball, "cap", 1.0, step, round(T / step))
        for step in (4e-7, 2e-7, 1e-7, 5e-8)
    }
    fine = runs[5e-8]
    peak = max(fine.forces)
    exact = hertz(1.0, coarse_ball.mass, E / (1.0 - NU**2), RADIUS)
    assert peak == pytest.approx(exact, rel=0.05)
    errors = []
    for step, run in runs.items():
        assert run.closings == 1
        assert run.gain < 1e-4
        rebound = run.state.bodies.v[0, 2]
        assert run.impulse == pytest.approx(coarse_ball.mass * (1.0 + rebound), rel=1e-9)
        stride = round(step / 5e-8)
        off = np.array(run.forces) - np.array(fine.forces)[::stride]
        errors.append(np.sqrt(np.mean(off**2)) / peak)
    assert errors[0] / errors[1] > 3.2
    assert errors[1] / errors[2] > 3.2


def test_an_impact_by_a_surface_is_that_of_a_ball_with_hertz_law():
    """A fine mesh beside a ball that is a shape with Hertz's law, for a half-space.

    The contact is 4 % as wide as the ball, whose finite size makes it stiffer by about as much.
    """
    element = quietly(ball(0.014, 5, 8, 1.6, 0.075), step=1e-7, band=2.7e5)
    meshed = struck(element, "cap", 1.0, 1e-7, 640)
    contact = Contact(
        "blow",
        ["ground.wall", "body"],
        "plane",
        ball=RADIUS,
        axis=[0.0, 0.0, 1.0],
        hertz=Hertz([1e6 * E, E], [NU, NU]),
    )
    rigid = Model(
        {
            "body": RigidBody(
                element.mass,
                [0.4 * element.mass * RADIUS**2] * 3,
                start=Start([0.0, 0.0, RADIUS + 1e-7], velocity=[0.0, 0.0, -1.0]),
            )
        },
        contacts=[contact],
        ground_frames={"wall": Frame((0.0, 0.0, 0.0))},
        settings=Settings(t_end=6.4e-5, step=1e-7, rho_inf=0.9),
    )
    expected = simulate(rigid, force=True).contact("blow").force[:, 0]
    found, peak = np.array(meshed.forces), expected.max()
    assert peak == pytest.approx(hertz(1.0, element.mass, E / (1.0 - NU**2), RADIUS), rel=1e-3)
    assert found.max() == pytest.approx(peak, rel=0.03)
    assert (found > 0.0).sum() == pytest.approx((expected > 0.0).sum(), rel=0.02)
    assert np.sqrt(np.mean((found - expected) ** 2)) < 0.03 * peak


def test_two_domes_that_are_turned_meet_as_one_meets_a_mirror():
    element = quietly(dome(1e-4, 6, 6, 7e-4), step=5e-7, band=4e5)
    h, steps, gap = 5e-7, 100, 2e-7
    wall = struck(element, "dome", 0.5, h, steps, gap)
    height = -element.surfaces.patches[0].X[:, 2].min() + gap
    turned = Rotation.from_rotvec([0.0, 0.0, np.pi / 6]) * Rotation.from_rotvec([np.pi, 0.0, 0.0])
    start = Start([0.0, 0.0, -height], turned.as_rotvec(), velocity=[0.0, 0.0, 0.5])
    pair = struck(
        element,
        "dome",
        0.5,
        h,
        steps,
        gap,
        [SurfaceContact("blow", ["body.dome", "other.dome"])],
        {"other": FlexibleBody(element, start)},
    )
    assert max(pair.forces) / max(wall.forces) == pytest.approx(0.9965, abs=0.005)
    momentum = element.mass * pair.state.bodies.v[:, :3].sum(axis=0)
    np.testing.assert_allclose(momentum, 0.0, atol=1e-14)
    assert abs(pair.gain) < 1e-3


@pytest.fixture(scope="module")
def rod():
    return quietly(bar(), step=4.8e-7, band=3.5e5)


def test_a_bar_on_a_wall(rod):
    """rho c A v for 2 L / c of its waves."""
    c = np.sqrt(E / RHO)
    h = 0.0025 / c
    steps = round(0.36 / c / h)
    motion = struck(rod, "end", 1.0, h, steps, gap=0.5 * h)
    force = np.array(motion.forces) / (RHO * c * 0.0075**2)
    assert motion.closings == 1
    first = int((force > 0.0).argmax())
    plateau = force[first + 30 : first + 90]
    assert plateau.mean() == pytest.approx(1.0, abs=2e-3)
    assert np.sqrt(np.mean((plateau - plateau.mean()) ** 2)) < 0.02
    assert force.max() < 1.6
    assert motion.impulse == pytest.approx(2.0 * rod.mass, rel=0.02)
    assert motion.state.bodies.v[0, 2] == pytest.approx(0.972, abs=0.01)
    assert abs(motion.gain) < 3e-3


def test_a_bar_that_bounces_for_long_gains_no_energy(rod):
    c = np.sqrt(E / RHO)
    h = 0.0025 / c
    patch = rod.surface("end")
    fall = 2.0 / (6.0 * 0.15 / c)  # six lengths of waves between impacts at first
    model = Model(
        {
            "body": FlexibleBody(
                rod, Start([0.0, 0.0, -patch.X[:, 2].min() + 1e-7], velocity=[0.0, 0.0, -1.0])
            )
        },
        gravity=[0.0, 0.0, -fall],
        surface_contacts=[SurfaceContact("floor", ["body.end", "ground"], **PLANE)],
        settings=Settings(t_end=1.0, step=h, rho_inf=0.9),
    )
    motion = Motion(model)
    weight = rod.mass * fall
    start = motion.energies[0] + weight * motion.state.bodies.x[0, 2]
    most, steps = 0.0, 0
    while motion.closings < 100 and steps < 40000:
        assert motion.step()
        steps += 1
        most = max(most, motion.energies[-1] + weight * motion.state.bodies.x[0, 2])
    rest = weight * (-patch.X[:, 2].min())
    assert (most - rest) / (start - rest) - 1.0 < 0.03
    assert motion.closings >= 30
