"""The rotor of Friswell et al. (2010), example 5.9.1: a shaft, two disks, bearings at its ends."""

import duhamel as du
import numpy as np


def steel_shaft():
    """1.5 m of steel of 50 mm, with the shear factor of ROSS."""
    E, G, rho, d = 211e9, 81.2e9, 7810.0, 0.05
    A, J, shear = np.pi * d**2 / 4.0, np.pi * d**4 / 64.0, 0.8863063567628116
    section = du.Section(
        EA=E * A, EI_y=E * J, EI_z=E * J, GJ=2.0 * G * J, GA_y=shear * G * A, GA_z=shear * G * A,
        mass_per_length=rho * A, rotary_inertia_y=rho * J, rotary_inertia_z=rho * J,
        polar_inertia_per_length=2.0 * rho * J,
    )  # fmt: skip
    part = du.Beam([[x, 0.0, 0.0] for x in np.linspace(0.0, 1.5, 7)], section=section)
    for name, x in {"left": 0.0, "one": 0.5, "two": 1.0, "right": 1.5}.items():
        part.interface(name, [x, 0.0, 0.0])
    part.rotation(modes=8, soft=8)
    return part.superelement(step=1e-4)


def two_disks(shaft, stiffness, damping, pedestals=None):
    """pedestals: by bearing, mass, stiffness and damping along e_1, e_2 of rigid supports."""
    m = du.Mechanism()
    left, right = m.ground.frame("left"), m.ground.frame("right", [1.5, 0.0, 0.0])
    rotor = m.add(shaft, name="shaft", place={"left": left}, second_order="full")
    for name, diameter in {"one": 0.28, "two": 0.35}.items():
        rho, d, width = 7810.0, 0.05, 0.07
        mass = rho * width * np.pi / 4.0 * (diameter**2 - d**2)
        polar = mass / 8.0 * (diameter**2 + d**2)
        inertia = [polar, *[0.5 * polar + mass * width**2 / 12.0] * 2]
        disk = m.add(du.RigidBody(mass, inertia), name=name, place={"": rotor[name]})
        m.add(du.joints.Fixed(rotor[name], disk))
    for name, support in {"left": left, "right": right}.items():
        if pedestals:
            support = pedestal(m, name, support, *pedestals[name])
        m.add(du.springs.bearing(support, rotor[name], "x", stiffness=stiffness, damping=damping,
                                 second_axis="y", name=name))  # fmt: skip
    return m


def pedestal(m, name, ground, mass, stiffness, damping):
    """A block on springs, whose rotations and motion along the shaft nothing of the rotor moves."""
    block = m.add(du.RigidBody(mass, [1.0, 2.0, 3.0]), name=f"pedestal {name}", place={"": ground})
    rest = {"axis": "x", "second_axis": "y", "name": f"mount {name}"}
    stiffness, damping = [*stiffness, *[1e6] * 4], [*damping, *[0.0] * 4]
    m.add(du.springs.bushing(ground, block, stiffness=stiffness, damping=damping, **rest))
    return block
