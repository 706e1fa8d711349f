"""Bodies of the solver's tests: the paper's beam and its hub, and superelements of random
numbers.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import permutations
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from duhamel.preprocess import Structure, assemble, build, read_body
from duhamel.preprocess.body.body import Damping
from duhamel.solver import (
    JOINTS,
    Fixed,
    FlexibleBody,
    Frame,
    Model,
    Place,
    RigidBody,
    Start,
)
from duhamel.solver.step import rotations
from duhamel.superelement import GeneralizedAlpha, Interface, Modes, Superelement, sample_kernel
from duhamel.superelement import Rotation as SecondOrder

from .models import model_of

BEAM = Path(__file__).parents[2] / "meshes" / "beam" / "beam.toml"
BEAM_INERTIA = 4.75475e-3
"""of the paper's beam about the axis of its hub [kg m^2]"""


@dataclass(frozen=True, eq=False)
class Beam:
    """A finite element beam and its superelement."""

    structure: Structure
    element: Superelement


def make_beam(**changes: Any) -> Beam:
    body = read_body(BEAM).model_copy(update=changes)
    return Beam(assemble(body), build(body))


def line_mesh(path: Path, elements: int) -> Path:
    """A bar of 0.5 m along x, its last point named tip."""
    points = np.zeros((elements + 1, 3))
    points[:, 0] = np.linspace(0.0, 0.5, elements + 1)
    lines = np.stack([np.arange(elements), np.arange(1, elements + 1)], axis=1)
    tags = [np.array([1]), np.full(elements, 2)]
    meshio.Mesh(
        points,
        [("vertex", np.array([[elements]])), ("line", lines)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"tip": np.array([1, 0]), "bar": np.array([2, 1])},
    ).write(path, file_format="gmsh22", binary=False)
    return path


@pytest.fixture(scope="session")
def beam() -> Beam:
    """The beam of the paper: 10 elements, 60 elastic modes, no damping."""
    return make_beam()


@pytest.fixture(scope="session")
def coarse_beam(tmp_path_factory: pytest.TempPathFactory) -> Beam:
    """Three elements, with two per cent of damping."""
    mesh = line_mesh(tmp_path_factory.mktemp("coarse") / "coarse.msh", 3)
    return make_beam(mesh=mesh, damping=Damping.model_validate({"modal": 0.02}))


@pytest.fixture(scope="session")
def coarse(tmp_path_factory: pytest.TempPathFactory) -> Superelement:
    """Three elements, without damping."""
    return make_beam(mesh=line_mesh(tmp_path_factory.mktemp("coarse") / "coarse.msh", 3)).element


@pytest.fixture(scope="session")
def hub_and_beam() -> Callable[..., Model]:
    """The paper's rotating beam: a hub of phi times the inertia of the beam, on a pivot, carries it
    on its rim.
    """

    def make(
        beam: Beam,
        phi: float,
        pivot: str = "revolute",
        spin: Any = (0.0, 0.0, 0.0),
        **settings: Any,
    ) -> Model:
        axis = [[0, 0, 1]] if pivot == "revolute" else []
        omega = np.asarray(spin, dtype=float)
        J = phi * BEAM_INERTIA
        hub = RigidBody(
            0.01, [0.6 * J, 0.7 * J, J], {"rim": Frame([0.05, 0, 0])}, Start(angular_velocity=omega)
        )
        center = np.array([0.05, 0, 0]) - beam.element.interface("root").X
        start = Start(
            place=Place("root", "hub.rim"), velocity=np.cross(omega, center), angular_velocity=omega
        )
        return model_of(
            bodies={"hub": hub, "beam": FlexibleBody(beam.element, start)},
            joints=(
                JOINTS[pivot]("ground", "hub", *axis, name="pivot"),
                Fixed("hub.rim", "beam.root", name="clamp"),
            ),
            **settings,
        )

    return make


@pytest.fixture(scope="session")
def random_element() -> Callable[..., Superelement]:
    """A superelement of random numbers; `rotations` says of each interface whether it has them."""

    def make(
        seed: int,
        rotations: tuple[bool, ...],
        modes: int = 8,
        steps: int = 200,
        omega: tuple[float, float] = (50.0, 5000.0),
        second_order: int = 0,
    ) -> Superelement:
        rng = np.random.default_rng(seed)
        interfaces = tuple(
            Interface(f"i{k}", rng.normal(size=3), given) for k, given in enumerate(rotations)
        )
        n_c = sum(interface.n_dofs for interface in interfaces)
        form = Modes(
            np.sort(rng.uniform(*omega, modes)),
            rng.uniform(0, 0.05, modes),
            rng.normal(size=(n_c, modes)),
        )
        second_moments = np.cov(rng.normal(size=(3, 9)))
        return Superelement(
            name=f"random {seed}",
            mass=rng.uniform(0.5, 2.0),
            J_rot=np.trace(second_moments) * np.eye(3) - second_moments,
            center=np.zeros(3),
            interfaces=interfaces,
            kernel=sample_kernel(form, 1e-3, GeneralizedAlpha(0.9), steps),
            modes=form,
            compliance=form.phi / form.omega**2 @ form.phi.T,
            accelerance=form.phi @ form.phi.T,
            rotation=random_second_order(rng, n_c, modes, second_order) if second_order else None,
        )

    return make


def random_second_order(rng: np.random.Generator, n_c: int, modes: int, r: int) -> SecondOrder:
    """Terms of second order of random numbers, with a strain energy beyond the quadratic one."""
    quartic = rng.normal(size=(r, r, r, r))
    cubic = rng.normal(size=(r, r, r))
    return SecondOrder(
        phi_inertia=0.2 * rng.normal(size=(6, modes)),
        T=np.linalg.qr(rng.normal(size=(modes, r)))[0].T,
        A_interface=symmetrized(rng.normal(size=(n_c, r, r)), (1, 2)),
        A_inertia=0.1 * symmetrized(rng.normal(size=(6, r, r)), (1, 2)),
        gyroscopic=rng.normal(size=(3, r, r)),
        kappa=np.ones(r),
        n_low=r,
        cubic=symmetrized(cubic, (0, 1, 2)),
        quartic=symmetrized(quartic, (0, 1, 2, 3)),
    )


@pytest.fixture(scope="session")
def with_second_order() -> Callable[..., Superelement]:
    """A superelement with terms of second order of the size that its body could have."""

    def make(element: Superelement, r: int = 3, seed: int = 1) -> Superelement:
        assert element.modes is not None
        second = random_second_order(
            np.random.default_rng(seed), element.n_c, len(element.modes.omega), r
        )
        mass, size = element.mass, element.size
        thin = np.sqrt(np.linalg.eigvalsh(element.J_rot)[0] / mass) / size
        return replace(
            element,
            rotation=replace(
                second,
                T=np.linalg.qr(second.T.T)[0].T,
                phi_inertia=np.sqrt(mass) * size * thin * second.phi_inertia,
                A_inertia=thin**2 * second.A_inertia,
                gyroscopic=thin * second.gyroscopic,
                A_interface=10.0 * second.A_interface / (mass * size),
                A_surface=_random_nodes(element, r, seed),
                cubic=None,
                quartic=None,
            ),
        )

    return make


def _random_nodes(element: Superelement, r: int, seed: int) -> np.ndarray | None:
    """A of the nodes of surfaces, of the size that it could have."""
    if element.surfaces is None:
        return None
    A = np.random.default_rng(seed).standard_normal((3 * element.surfaces.n, r, r))
    return 10.0 * symmetrized(A, (1, 2)) / (element.mass * element.size)


def symmetrized(A: np.ndarray, axes: tuple[int, ...]) -> np.ndarray:
    """The mean over all orders of some axes."""
    orders = list(permutations(axes))
    fixed = tuple(range(axes[0]))
    return np.mean([A.transpose(*fixed, *order) for order in orders], axis=0)


@pytest.fixture(scope="session")
def measured() -> Callable[[Superelement], Superelement]:
    """The same body known by its kernel alone."""
    return lambda element: replace(element, modes=None)


def rotation(psi: Any) -> np.ndarray:
    """exp(skew(psi)), (3, 3)"""
    R = np.empty((3, 3))
    rotations.exponential(np.asarray(psi, dtype=float), R)
    return R
