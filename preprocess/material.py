"""What a body is made of: sections of beams, materials of solids."""

from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from ..inputs import Table, Vector


class Section(Table):
    """The cross-section of a beam, in its own axes: x along the beam, y and z across.

    EA [N], EI_y and EI_z (bending about y and z) and GJ [N m^2]; mass_per_length [kg/m];
    polar_inertia_per_length rho I_p [kg m], the inertia about the beam's axis.
    GA_y and GA_z [N]: shear stiffnesses along y and z, shape factor included; with either, bending in that direction is
    Timoshenko's. rotary_inertia_y and _z: rho I_y and rho I_z [kg m]; 0 unless given for Euler-Bernoulli bending, and
    mass_per_length EI / EA (the value of a homogeneous section) for Timoshenko bending.
    orientation: a vector that with the beam's axis spans the plane of local x and y, in mesh axes; unless given, local
    y is horizontal (e_z cross x), or e_y where the beam is vertical.
    """

    EA: PositiveFloat
    EI_y: PositiveFloat
    EI_z: PositiveFloat
    GJ: PositiveFloat
    mass_per_length: PositiveFloat
    polar_inertia_per_length: PositiveFloat
    GA_y: PositiveFloat | None = None
    GA_z: PositiveFloat | None = None
    rotary_inertia_y: NonNegativeFloat | None = None
    rotary_inertia_z: NonNegativeFloat | None = None
    orientation: Vector | None = None


class Material(Table):
    """A linear, isotropic material: Young's modulus E [Pa], Poisson's ratio nu, density rho [kg/m^3]."""

    E: PositiveFloat
    nu: Annotated[float, Field(gt=-1.0, lt=0.5)]
    rho: PositiveFloat
