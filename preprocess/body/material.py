"""Sections of beams and materials of solids."""

from typing import Annotated, Any

import numpy as np
from pydantic import Discriminator, Field, NonNegativeFloat, PositiveFloat, Tag

from ...inputs import Table, Vector, rule
from ...superelement.validation import Array
from .damping import LossFactor


class Section(Table):
    """The cross-section of a beam in local axes: x along the beam, y and z across.

    EA [N], EI_y and EI_z (bending about y and z) and GJ [N m^2]; mass_per_length [kg/m];
    polar_inertia_per_length rho I_p [kg m], the inertia about the beam's axis. GA_y and GA_z [N]:
    shear stiffnesses along y and z, shape factor included; with either, bending in that direction
    is Timoshenko's. rotary_inertia_y and _z: rho I_y and rho I_z [kg m]; 0 unless given for
    Euler-Bernoulli bending, and mass_per_length EI / EA (the value of a homogeneous section) for
    Timoshenko bending. orientation: a vector that with the beam's axis spans the plane of local x
    and y, in mesh axes; unless given, local y is horizontal (e_z cross x), or e_y where the beam is
    vertical. loss_factor: its own, in the band of [damping].
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
    loss_factor: LossFactor | None = None

    @classmethod
    def rectangle(cls, material: "Material", width: float, height: float, **more: Any) -> "Section":
        """A full rectangle of an isotropic material: `width` along local y, `height` along z.

        GJ by Saint-Venant's series; shear factors 10 (1 + nu) / (12 + 11 nu) (Cowper 1966).
        more: other fields, as orientation.
        """
        b, a = sorted((width, height))
        # Terms fall with the fifth power: thirty of them leave less than 1e-8.
        n = np.arange(1.0, 60.0, 2.0)
        # tanh never overflows, where the usual sinh / cosh does for slender sections.
        series = np.sum(np.tanh(n * np.pi * a / (2.0 * b)) / n**5)
        torsion = a * b**3 / 3.0 * (1.0 - 192.0 / np.pi**5 * b / a * series)
        factor = 10.0 * (1.0 + material.poisson) / (12.0 + 11.0 * material.poisson)
        I_y, I_z = width * height**3 / 12.0, height * width**3 / 12.0
        return cls._of(material, width * height, I_y, I_z, float(torsion), factor, more)

    @classmethod
    def circle(
        cls, material: "Material", radius: float, inner: float = 0.0, **more: Any
    ) -> "Section":
        """A full circle of an isotropic material, or a tube with an inner radius.

        Shear factors 6 (1 + nu) (1 + m^2)^2 / ((7 + 6 nu) (1 + m^2)^2 + (20 + 12 nu) m^2) with
        m = inner / radius (Cowper 1966). more: other fields.
        """
        if not 0.0 <= inner < radius:
            raise ValueError(f"inner: expected less than the radius, {radius}, found {inner}")
        nu, m = material.poisson, (inner / radius) ** 2
        factor = 6.0 * (1.0 + nu) * (1.0 + m) ** 2
        factor /= (7.0 + 6.0 * nu) * (1.0 + m) ** 2 + (20.0 + 12.0 * nu) * m
        area, inertia = np.pi * (radius**2 - inner**2), np.pi / 4.0 * (radius**4 - inner**4)
        return cls._of(material, area, inertia, inertia, 2.0 * inertia, factor, more)

    @classmethod
    def _of(
        cls,
        material: "Material",
        area: float,
        I_y: float,
        I_z: float,
        torsion: float,
        factor: float,
        more: dict[str, Any],
    ) -> "Section":
        """A Timoshenko section of one isotropic material, from its moments of area."""
        E, G, rho = material.young, material.shear, material.rho
        of_shape = {
            "EA": E * area,
            "EI_y": E * I_y,
            "EI_z": E * I_z,
            "GJ": G * torsion,
            "GA_y": factor * G * area,
            "GA_z": factor * G * area,
            "mass_per_length": rho * area,
            "polar_inertia_per_length": rho * (I_y + I_z),
        }
        given: dict[str, Any] = {key: float(value) for key, value in of_shape.items()}
        return cls(**given, **more)

    @property
    def density(self) -> float:
        """Mass per length [kg/m]."""
        return self.mass_per_length

    def shortest_wave(self, frequency: float) -> float:
        """The length [m] of a bending wave at a frequency [Hz], 2 pi (EI / (m omega^2))^(1/4)."""
        EI, omega = min(self.EI_y, self.EI_z), 2.0 * np.pi * frequency
        return float(2.0 * np.pi * (EI / (self.mass_per_length * omega**2)) ** 0.25)


Three = tuple[PositiveFloat, PositiveFloat, PositiveFloat]


def _tag(value: Any) -> str:
    return "(number)" if isinstance(value, int | float | str) else "(three)"


Moduli = Annotated[
    Annotated[PositiveFloat, Tag("(number)")] | Annotated[Three, Tag("(three)")],
    Discriminator(_tag),
]
Ratio = Annotated[float, Field(gt=-1.0, lt=0.5)]
Ratios = Annotated[
    Annotated[Ratio, Tag("(number)")] | Annotated[Vector, Tag("(three)")], Discriminator(_tag)
]

STRESS_ORDER = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
"""The order of stresses and of strains, xx, yy, zz, yz, xz, xy; shear strains are engineering's,
twice the tensor's.
"""


def _bulk_over_shear(nu: float) -> float:
    """Bulk modulus over shear modulus of an isotropic material."""
    return 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))


NEARLY_INCOMPRESSIBLE = _bulk_over_shear(0.45)
"""Bulk modulus over shear modulus above which a material is called so."""
LARGEST_RATIO = 0.4999
"""Largest Poisson's ratio, up to which the elements were compared with references."""
_PLACE = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])


class Material(Table):
    """A linear elastic material: isotropic, or orthotropic with three values where one would do.

    E: Young's modulus [Pa], or E1, E2, E3; nu: Poisson's ratio, or nu12, nu13, nu23, of which nu_ij
    is the contraction along j over the stretch along i under stress along i; G [Pa]: the shear
    modulus, or G12, G13, G23, that of an isotropic material unless given; rho: density [kg/m^3].
    axes: two vectors in mesh axes, direction 1 and one that with it spans the plane of directions 1
    and 2; directions 1, 2, 3 are the mesh axes unless given. loss_factor: its own, in the band of
    [damping].
    """

    E: Moduli
    nu: Ratios
    G: Moduli | None = None
    rho: PositiveFloat
    axes: tuple[Vector, Vector] | None = None
    loss_factor: LossFactor | None = None

    @rule
    def _shear_given(self) -> None:
        if self.G is None and (isinstance(self.E, tuple) or isinstance(self.nu, tuple)):
            raise ValueError(
                "G: missing; only a material with one E and one nu is isotropic and does without"
            )

    @rule
    def _axes_span_a_plane(self) -> None:
        if self.axes is not None:
            one, two = (
                # A zero axis stays zero, and then spans no plane.
                np.array(axis) / max(np.linalg.norm(axis), np.finfo(float).tiny)
                for axis in self.axes
            )
            if np.linalg.norm(np.cross(one, two)) < 1e-6:
                raise ValueError(
                    f"axes: expected two vectors that span a plane, found {list(self.axes)}"
                )

    @rule
    def _stores_energy(self) -> None:
        with np.errstate(divide="ignore"):
            stiffness = np.sort(1.0 / np.linalg.eigvalsh(self._compliance))
        # The ratio bounds what rounding would do to the inverse of the compliance.
        if not (stiffness[0] > 0.0 and stiffness[-1] < 1e12 * stiffness[0]):
            raise ValueError(
                "expected E, nu and G of a positive definite elasticity matrix, found "
                f"eigenvalues of {', '.join(f'{value:.4g}' for value in stiffness)} Pa; "
                "nu_ij^2 must be less than E_i / E_j"
            )

    @rule
    def _changes_its_volume(self) -> None:
        rounding = 1.0 + 1e-9
        if self._relative_bulk_modulus > rounding * _bulk_over_shear(LARGEST_RATIO):
            raise ValueError(
                f"nu: expected at most {LARGEST_RATIO}, found {self.nu}: solids that keep their "
                f"volume are not supported; use {LARGEST_RATIO}, or the measured bulk modulus"
            )

    @property
    def young(self) -> float:
        """E of an isotropic material [Pa]; ValueError for others."""
        return self._isotropic(self.E)

    @property
    def poisson(self) -> float:
        """nu of an isotropic material; ValueError for others."""
        return self._isotropic(self.nu)

    @property
    def shear(self) -> float:
        """G of an isotropic material [Pa]; ValueError for others."""
        return self.young / (2.0 * (1.0 + self.poisson))

    def _isotropic(self, value: Any) -> float:
        if self.G is not None or not isinstance(value, int | float):
            raise ValueError("expected an isotropic material, of E and nu alone")
        return float(value)

    @property
    def elasticity(self) -> Array:
        """C (6, 6) [Pa] in mesh axes, in the order of `STRESS_ORDER`: stresses = C strains."""
        i, j = np.array(STRESS_ORDER).T
        return np.asarray(self.elasticity_tensor[i[:, None], j[:, None], i, j])

    @property
    def elasticity_tensor(self) -> Array:
        """C (3, 3, 3, 3) [Pa] in mesh axes: sigma_ij = C_ijkl epsilon_kl."""
        C = np.linalg.inv(self._compliance)[_PLACE[:, :, None, None], _PLACE]
        R = self._directions
        return np.asarray(np.einsum("ia,jb,kc,ld,ijkl->abcd", R, R, R, R, C, optimize=True))

    @property
    def plane_stress(self) -> Array:
        """(3, 3) [Pa]: stresses 11, 22, 12 in the axes of the material from strains 11, 22, 2 12.

        Where there is no stress along direction 3, as in shells.
        """
        in_plane = np.ix_((0, 1, 5), (0, 1, 5))
        return np.asarray(np.linalg.inv(self._compliance[in_plane]))

    @property
    def transverse_shear(self) -> Array:
        """(2, 2) [Pa]: shear stresses 13, 23 from shear strains, in the axes of the material."""
        return np.diag(1.0 / np.diag(self._compliance)[[4, 3]])

    @property
    def isotropic(self) -> bool:
        """Whether it has one E, one nu and no G."""
        return self.G is None

    @property
    def nearly_incompressible(self) -> bool:
        """The bulk modulus is far above the shear moduli: nu > 0.45 of an isotropic material."""
        return self._relative_bulk_modulus > NEARLY_INCOMPRESSIBLE

    @property
    def _relative_bulk_modulus(self) -> float:
        """Bulk modulus over the mean of the shear moduli."""
        C = self.elasticity
        return float(C[:3, :3].sum() / 9.0 / C.diagonal()[3:].mean())

    @property
    def density(self) -> float:
        """Mass per volume [kg/m^3]."""
        return self.rho

    def shortest_wave(self, frequency: float) -> float:
        """The length [m] of a shear wave at a frequency [Hz], sqrt(G / rho) / f."""
        shear = self.elasticity.diagonal()[3:].min()
        return float(np.sqrt(shear / self.rho) / frequency)

    @property
    def _compliance(self) -> Array:
        """S (6, 6) [1/Pa] in the axes of the material: strains from stresses."""
        E, nu = np.broadcast_to(self.E, 3), np.broadcast_to(self.nu, 3)
        # One E and one nu: the validator has refused all else without G.
        G = np.broadcast_to(self.E / (2.0 * (1.0 + self.nu)) if self.G is None else self.G, 3)  # type: ignore[operator]
        S = np.diag(1.0 / np.concatenate([E, G[::-1]]))
        for value, i, j in zip(nu, (0, 0, 1), (1, 2, 2), strict=True):
            S[i, j] = S[j, i] = -value / E[i]
        return S

    @property
    def _directions(self) -> Array:
        """Directions 1, 2, 3 as rows (3, 3)."""
        if self.axes is None:
            return np.eye(3)
        one, third = np.array(self.axes[0]), np.cross(*self.axes)
        rows = np.array([one, np.cross(third, one), third])
        return np.asarray(rows / np.linalg.norm(rows, axis=1)[:, None])
