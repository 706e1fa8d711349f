"""Models that are exported: small ones, each with an input named `u`."""

import duhamel as du
import numpy as np
import skfem

STEEL = du.Material(E=210e9, nu=0.3, rho=7800.0)


def settings(t_end, step, **more):
    return du.solver.Settings(t_end=t_end, step=step, **more)


def beam(length=0.5, rotates=False):
    points = np.linspace([0.0, 0.0, 0.0], [length, 0.0, 0.0], 5)
    material = du.Material(E=70e9, nu=0.3, rho=2700.0)
    part = du.Beam(points, section=du.Section.rectangle(material, width=0.008, height=0.008))
    part.damping(modal=0.02)
    if rotates:
        part.rotation(modes=2)
    part.interface("root", points[0])
    part.interface("tip", points[-1])
    return part.superelement(step=1e-4, duration=0.03)


def rod(**more):
    """A flexible rod on a pivot, with a load that steps beside the input."""
    m = du.Mechanism(gravity=[0.0, -9.81, 0.0])
    arm = m.add(beam(), name="arm")
    m.add(du.joints.Revolute(m.ground, arm["root"], axis="z", name="pivot"))
    m.add(du.loads.Torque(arm["root"], [0, 0, 1], du.signals.Input("u", 0.1)))
    m.add(du.loads.Force(arm["tip"], [0, 1, 0], du.signals.Steps([0.0, 0.0123], [1.0, -2.0])))
    return m.model(settings(0.08, 1e-4, **more))


def rotor(**more):
    """A rod with terms of second order, which turns fast about one end."""
    m = du.Mechanism()
    spin = [0.0, 0.0, 100.0]
    arm = m.add(beam(rotates=True), name="arm", velocity=[0.0, 25.0, 0.0], angular_velocity=spin)
    m.add(du.joints.Revolute(m.ground, arm["root"], axis="z", name="pivot"))
    m.add(du.loads.Torque(arm["root"], [0, 0, 1], du.signals.Input("u", 0.1)))
    return m.model(settings(0.08, 1e-4, **more))


def block(height=1e-5, speed=0.2, **more):
    """An elastic block that falls on a plane with its lower surface, and slides with friction."""
    m = du.Mechanism(gravity=[0.0, 0.0, -9.81])
    side = np.linspace(-0.004, 0.004, 6)
    part = du.Part(skfem.MeshHex.init_tensor(side, side, side + 0.004), STEEL, name="block")
    part.damping(modal=0.02)
    part.surface("foot", du.plane(z=0.0))
    part.interface("top", du.plane(z=0.008))
    body = m.add(
        part.superelement(step=1e-6, duration=1e-4, band=2.5e5),
        name="block",
        position=[0.0, 0.0, 0.004 + height],
        velocity=[0.1, 0.0, -speed],
    )
    m.add(
        du.contacts.surface(
            body["foot"],
            m.ground.frame("floor", [0.0, 0.0, 0.0]),
            shape="plane",
            axis="z",
            friction=0.2,
            name="floor",
        )
    )
    m.add(du.loads.Force(body["top"], [1.0, 0.0, 0.3], du.signals.Input("u")))
    return m.model(settings(6e-4, 1e-6, **more))


def servo(**more):
    """A pendulum with a servo, friction in its bearing, a spring and a stop."""
    m = du.Mechanism(gravity=[0.0, -9.81, 0.0])
    body = du.RigidBody(1.0, [0.01, 0.01, 0.01], {"hub": [-0.2, 0.0, 0.0]})
    crank = m.add(body, name="crank", position=[0.2, 0.0, 0.0])
    friction = du.joints.JointFriction(du.joints.Stribeck(0.2, 0.1, 0.1), radius=0.01, preload=20.0)
    pivot = m.add(
        du.joints.Revolute(m.ground, crank["hub"], axis="z", name="pivot", friction=friction)
    )
    gains = {"stiffness": 40.0, "damping": 1.0, "integral": 5.0, "limit": 6.0, "tracking_time": 0.3}
    m.add(du.motors.servo(pivot, "angle", du.signals.Input("u"), **gains, name="elbow servo"))
    m.add(du.springs.torsion(m.ground, crank, "z", stiffness=3.0, damping=0.01, name="return"))
    m.add(du.stops.stop(pivot, "angle", (-0.2, 0.3), stiffness=2e3, restitution=0.5, name="end"))
    return m.model(settings(1.0, 5e-4, **more))


def box(height=5e-3, **more):
    """A box that falls on a plane with friction, pulled by the input."""
    m = du.Mechanism(gravity=[0.0, 0.0, -9.81])
    corners = [(0.05, 0.05), (0.05, -0.05), (-0.05, 0.05), (-0.05, -0.05)]
    frames = {f"corner {k}": [x, y, -0.05] for k, (x, y) in enumerate(corners)}
    solid = du.RigidBody(1.0, [2e-3, 2e-3, 2e-3], frames)
    body = m.add(solid, name="box", position=[0.0, 0.0, 0.05 + height])
    floor = m.ground.frame("floor", [0.0, 0.0, 0.0])
    for k, corner in enumerate(frames):
        m.add(
            du.contacts.plane(
                floor,
                body[corner],
                "z",
                stiffness=2e5,
                restitution=0.4,
                friction=0.3,
                tangential_stiffness=2e5,
                name=f"floor {k}",
            )
        )
    m.add(du.loads.Force(body, [1.0, 0.2, 0.3], du.signals.Input("u")))
    return m.model(settings(0.3, 1e-4, **more))


def linkage(**more):
    """A flat loop of four hinges, with a flexible coupler: three constraints are redundant."""
    m = du.Mechanism(gravity=[0.0, -9.81, 0.0])
    bar = du.RigidBody(0.5, [1e-3, 1e-3, 1e-3], {"pin": [0.0, 0.1, 0.0], "foot": [0.0, -0.1, 0.0]})
    crank = m.add(bar, name="crank", position=[0.0, 0.1, 0.0])
    rocker = m.add(bar, name="rocker", position=[0.5, 0.1, 0.0])
    coupler = m.add(beam(), name="coupler", place={"root": crank["pin"]})
    pins = [
        ("O", m.ground, crank["foot"]),
        ("A", crank["pin"], coupler["root"]),
        ("B", coupler["tip"], rocker["pin"]),
        ("C", m.ground, rocker["foot"]),
    ]
    for name, first, second in pins:
        m.add(du.joints.Revolute(first, second, axis="z", name=name))
    m.add(du.loads.Torque(crank, [0, 0, 1], du.signals.Input("u")))
    return m.model(settings(0.2, 2e-4, redundant="remove", **more))


def plastic(**more):
    """A wheel on a hinge that yields and a bolted joint, with a stop that it dents."""
    m = du.Mechanism()
    wheel = m.add(du.RigidBody(1.0, [0.01, 0.01, 0.01]), name="wheel")
    axle = m.add(du.joints.Revolute(m.ground, wheel, axis="z", name="axle"))
    laws = [du.laws.ElastoplasticLaw(0.1, 2.0, 0.1, 0.5), du.laws.IwanLaw(0.1, 2.0)]
    m.add(du.springs.torsion(m.ground, wheel, "z", law=laws), name="hinge")
    dented = {"stiffness": 20.0, "yield_force": 0.2, "post_yield": 0.5}
    m.add(du.stops.stop(axle, "angle", (-0.05, 0.1), **dented), name="stop")
    m.add(du.loads.Torque(wheel, [0, 0, 1], du.signals.Input("u")))
    return m.model(settings(1.0, 1e-3, **more))


MACHINES = {
    "rod": (rod, {}),
    "direct": (rod, {"history": "direct"}),
    "rotor": (rotor, {}),
    "block": (block, {}),
    "corrections": (rod, {"fixed_iterations": 2}),
    "servo": (servo, {}),
    "box": (box, {}),
    "linkage": (linkage, {}),
    "plastic": (plastic, {}),
}
"""by name: what makes a model, and its settings"""
TWO_SIZES = {
    "servo": (servo, {"contact_step": 5e-5}),
    "box": (box, {"contact_step": 2e-5}),
    "block": (block, {"contact_step": 2.5e-7, "height": 6e-3, "speed": 10.0}),
}
"""those with steps of two sizes"""


def values(model, n):
    """Inputs of n steps, which swing."""
    scale = {"box": 3.0}.get(next(iter(model.bodies)), 0.5)
    return scale * np.sin(2.0 * np.pi * np.arange(n) / 160.0) + 0.1
