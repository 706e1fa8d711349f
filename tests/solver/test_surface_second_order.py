"""Contacts of surfaces of bodies with terms of second order: blades that rub, columns that bend."""

from dataclasses import replace
from functools import cache

import duhamel as du
import numpy as np
import pytest
import skfem
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    HalfSine,
    Model,
    ModelError,
    Place,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    Start,
    SteadyRotation,
    simulate,
)
from duhamel.solver.checkpoint.carried import Snapshot, carried
from duhamel.solver.couplings.surface_contacts import SurfaceContact
from duhamel.solver.history.shares import shares_of
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from .pressing import STEEL, Motion, quietly

LENGTH, WIDTH, THICKNESS = 0.1, 0.01, 0.002


@cache
def blade():
    """A blade along x from its `root`, with a `face` to push it and the surface `end`."""
    half = 0.5 * np.array([WIDTH, THICKNESS])
    lines = np.linspace(0.0, LENGTH, 21), *(np.linspace(-x, x, 3) for x in half)
    mesh = skfem.MeshHex2.from_mesh(skfem.MeshHex.init_tensor(*lines))
    part = du.Part(mesh, STEEL, name="blade")
    part.interface("root", du.plane(x=0.0))
    part.interface("face", du.box([0.039, -0.006, 0.0009], [0.061, 0.006, 0.0011]))
    part.interface("tip", du.plane(x=LENGTH))
    part.surface("end", du.plane(x=LENGTH))
    part.rotation(loaded=["root"])
    return quietly(part, step=2e-7, band=6e4)


def test_the_mean_of_nodes_moves_as_the_interface_on_them():
    """Of displacements, for means of nodes add nothing of second order of their own."""
    element = blade()
    rows, surface = element.rows("tip"), element.surface("end")
    weights, *_ = np.linalg.lstsq(
        element.surfaces.phi[::3].T, element.modes.phi[rows.start], rcond=None
    )
    assert weights.sum() == pytest.approx(1.0, rel=1e-9)
    of_nodes = element.rotation.A_surface.reshape(surface.n, 3, *element.rotation.T.shape[:1] * 2)
    mean = np.einsum("k,kxij->xij", weights, of_nodes)
    of_interface = element.rotation.A_interface[rows][:3]
    np.testing.assert_allclose(mean, of_interface, atol=1e-7 * np.abs(of_interface).max())


# Columns


def column(force, element, second_order="full"):
    """A blade between a head that weighs `force` and a wall that its end lies on."""
    mass = 10.0
    head = RigidBody(mass, [1.0] * 3)
    body = FlexibleBody(element, Start(place=Place("root", "head")), second_order=second_order)
    settings = {"t_end": 0.02, "step": 4e-6, "rho_inf": 0.9, "start": "equilibrium"}
    gravity = [force / (mass + element.mass), 0.0, 0.0]
    return Model(
        {"head": head, "blade": body},
        joints=[
            Prismatic("ground", "head", [1.0, 0.0, 0.0], name="guide"),
            Fixed("head", "blade.root", name="clamp"),
        ],
        loads=[Force("blade.face", [0.0, 0.0, 1.0], HalfSine(1.0, 4e-4))],
        surface_contacts=[
            SurfaceContact(
                "foot", ["blade.end", "ground.wall"], shape="plane", axis=[-1.0, 0.0, 0.0]
            )
        ],
        ground_frames={"wall": Frame([LENGTH, 0.0, 0.0])},
        gravity=gravity,
        settings=Settings(**settings),
    )


def lowest_frequency(results):
    """Of the push from the side."""
    late = results.time > 1e-3
    z = results.frame("blade.face").position[late, 2]
    spectrum = np.abs(np.fft.rfft((z - z.mean()) * np.hanning(len(z)), n=2**20))
    frequencies = np.fft.rfftfreq(2**20, results.time[1] - results.time[0])
    near = (frequencies > 60.0) & (frequencies < 700.0)
    return frequencies[near][spectrum[near].argmax()]


def frequency_of_column(force):
    """Of Euler's column, clamped, whose other end slides across and does not turn, under a force:
    w = A cosh ax + B sinh ax + C cos bx + D sin bx with w = w' = 0 and w' = w''' = 0 at the ends.
    """
    EI = STEEL.E * WIDTH * THICKNESS**3 / 12.0

    def determinant(f):
        inertia = STEEL.rho * WIDTH * THICKNESS * (2.0 * np.pi * f) ** 2
        root = np.hypot(0.5 * force / EI, np.sqrt(inertia / EI))
        a, b = np.sqrt(root - 0.5 * force / EI), np.sqrt(root + 0.5 * force / EI)
        sinh, cosh, sin, cos = (
            g(x * LENGTH)
            for g, x in zip((np.sinh, np.cosh, np.sin, np.cos), (a, a, b, b), strict=True)
        )
        rows = [
            [1.0, 0.0, 1.0, 0.0],
            [0.0, a, 0.0, b],
            [a * sinh, a * cosh, -b * sin, b * cos],
            [a**3 * sinh, a**3 * cosh, b**3 * sin, -(b**3) * cos],
        ]
        return np.linalg.det(rows / np.abs(rows).max(axis=1)[:, None])

    return brentq(determinant, 100.0, 280.0)


def test_a_column_on_its_end_softens_as_eulers():
    """At 43 % of the buckling load pi^2 EI / L^2; without A of the nodes the end would not know."""
    element, force = blade(), 600.0
    exact = frequency_of_column(force)
    with_nodes = lowest_frequency(simulate(column(force, element)))
    rotation = replace(element.rotation, A_surface=0.0 * element.rotation.A_surface)
    without = lowest_frequency(simulate(column(force, replace(element, rotation=rotation))))
    assert with_nodes == pytest.approx(exact, rel=0.012)
    assert without > 1.035 * exact


# Blades


def rubbing(spin=300.0, step=1e-6, steps=4000, driven=True, friction=None):
    """A blade on a hub that runs into a casing 10 um too narrow where it is nearest."""
    drive = {"angular_velocity": Constant(spin)} if driven else {}
    shaft = Revolute("ground", "hub", [0.0, 0.0, 1.0], name="shaft", **drive)
    hub = RigidBody(1.0, [1e-3] * 3, {"rim": Frame([0.05, 0.0, 0.0])})
    away = 6e-5 * np.array([np.cos(0.6), np.sin(0.6), 0.0])
    casing = SurfaceContact(
        "casing",
        ["blade.end", "ground.casing"],
        shape="cylinder",
        axis=[0.0, 0.0, 1.0],
        radius=0.15013,
        hollow=True,
        friction=friction,
    )
    return Model(
        {"hub": hub, "blade": FlexibleBody(blade(), Start(place=Place("root", "hub.rim")))},
        joints=[
            shaft,
            Fixed("hub.rim", "blade.root", name="clamp"),
        ],
        surface_contacts=[casing],
        ground_frames={"casing": Frame(-away)},
        settings=Settings(
            t_end=steps * step,
            step=step,
            rho_inf=0.9,
            start="equilibrium",
            steady_rotation=SteadyRotation([0.0, 0.0, spin], [0.0] * 3),
        ),
    )


def force_of(results, every=1):
    return results.surface_contact("casing").normal_force[::every]


def test_a_blade_that_rubs_converges_with_the_square_of_the_step():
    runs = [simulate(rubbing(step=h, steps=round(4e-3 / h))) for h in (2e-6, 1e-6, 5e-7)]
    forces = [force_of(run, every) for run, every in zip(runs, (1, 2, 4), strict=True)]
    errors = [np.linalg.norm(force - forces[2]) for force in forces[:2]]
    assert forces[2].max() > 40.0
    assert errors[1] < 0.01 * np.linalg.norm(forces[2])
    # A second difference against the finest run leaves 5 of 16 parts, not 1 of 4.
    assert errors[0] / errors[1] > 2.5
    assert max(runs[1].validity.values("energy_balance").values()) < 1e-8


def test_friction_takes_its_share_of_the_speed_of_the_tip():
    results = simulate(rubbing(friction=0.05))
    taken = 0.05 * results.surface_contact("casing").impulse[-1] * 300.0 * 0.15
    assert taken > 0.1
    assert results.energy.dissipated[-1] == pytest.approx(taken, rel=2e-3)
    assert max(results.validity.values("energy_balance").values()) < 1e-5


def test_coordinates_whose_rates_have_inertia_have_no_static_part():
    """Coriolis forces by it would feed on themselves: the blade of examples/blade_rub.toml flew
    apart after its first rub.
    """
    body = FlexibleBody(blade())
    second, modes = body.rotation, body.rotation.complete(blade().modes)
    shares = shares_of(body, 1e-6)
    q = shares.of(modes, second).phi[-second.r :]
    dynamic = [*range(second.n_low), *range(second.n_stiff, second.r)]
    assert second.n_soft > 0
    assert (q[np.ix_(dynamic, shares.quasi_static)] == 0.0).all()
    assert (q[second.n_low : second.n_stiff, shares.quasi_static] != 0.0).any()
    # The lowest modes move as a whole, so that their coordinates are what they were.
    np.testing.assert_array_equal((q[: second.n_low] ** 2).sum(axis=1), 1.0)


def test_a_rub_goes_on_from_any_step_to_the_bit():
    motion, again = (Motion(rubbing(driven=False, friction=0.05)) for _ in range(2))
    assert motion.step(1500)
    assert motion.forces[-1] > 0.0
    kept = Snapshot.of(1500, carried(state=motion.state, work=motion.work))
    assert motion.step(50)
    kept.put_back(carried(state=again.state, work=again.work))
    assert again.step(50)
    assert again.forces[1:] == motion.forces[1501:]
    np.testing.assert_array_equal(again.state.bodies.x, motion.state.bodies.x)


# Flights


def tumbling(shift=(0.0, 0.0, 0.0), turn=None, step=1e-6, **settings):
    """A blade that meets the floor with its end, and turns, 1 m/s."""
    turn = turn or Rotation.identity()
    upright = Rotation.from_rotvec([0.0, 0.5 * np.pi, 0.0])
    start = Start(
        position=shift + turn.apply([0.0, 0.0, 0.5 * LENGTH + 2e-5]),
        rotation=(turn * upright).as_rotvec(),
        velocity=turn.apply([0.3, 0.0, -1.0]),
        angular_velocity=upright.inv().apply([3.0, 100.0, 20.0]),
    )
    floor = SurfaceContact(
        "floor",
        ["blade.end", "ground.floor"],
        shape="plane",
        axis=turn.apply([0.0, 0.0, 1.0]),
        friction=0.1,
    )
    return Model(
        {"blade": FlexibleBody(blade(), start)},
        surface_contacts=[floor],
        ground_frames={"floor": Frame(shift)},
        settings=Settings(t_end=6e-4, step=step, rho_inf=0.9, **settings),
    )


def test_a_blade_that_meets_the_floor_does_so_anywhere():
    """Turned to rounding, and 1 km away to that of places, 1e-13 m in 1e-6 m of compression."""
    here = simulate(tumbling()).surface_contact("floor").normal_force
    assert here.max() > 1000.0
    turn, far = Rotation.from_rotvec([0.7, -1.1, 0.5]), np.array([600.0, -700.0, 400.0])
    for place, tolerance in (({"turn": turn}, 1e-9), ({"turn": turn, "shift": far}, 1e-5)):
        there = simulate(tumbling(**place)).surface_contact("floor").normal_force
        np.testing.assert_allclose(there, here, atol=tolerance * here.max())


def test_long_steps_in_flight_change_nothing_in_a_contact():
    short = simulate(tumbling()).surface_contact("floor").normal_force
    both = simulate(tumbling(step=1e-5, contact_step=1e-6)).surface_contact("floor").normal_force
    assert both.max() == pytest.approx(short.max(), rel=1e-9)


# Messages


def test_a_superelement_without_terms_of_its_surfaces_is_refused():
    element = blade()
    old = replace(element, rotation=replace(element.rotation, A_surface=None))
    with pytest.raises(ModelError, match="no terms of second order of them: preprocess it again"):
        Motion(column(100.0, old))
    assert Motion(column(100.0, old, second_order="off")).step()


def test_an_interface_on_the_nodes_of_a_surface_alone_is_refused():
    model = column(100.0, blade())
    on_tip = replace(model, loads=[Force("blade.tip", [0.0, 0.0, 1.0], HalfSine(1.0, 4e-4))])
    with pytest.raises(ModelError, match=r"body 'blade': .* all nodes of an interface lie on them"):
        Motion(on_tip)
