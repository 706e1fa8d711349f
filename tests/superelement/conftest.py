"""Superelements made by hand: random numbers in every field, consistent with each other."""

from collections.abc import Callable

import numpy as np
import pytest
from duhamel.superelement import (
    GeneralizedAlpha,
    Interface,
    Modes,
    Provenance,
    Recovery,
    Superelement,
    sample_kernel,
)

MakeElement = Callable[..., Superelement]


@pytest.fixture
def make_modes() -> Callable[..., Modes]:
    def make(seed: int, n_c: int, m: int) -> Modes:
        rng = np.random.default_rng(seed)
        return Modes(
            np.sort(rng.uniform(50.0, 5000.0, m)),
            rng.uniform(0.0, 0.1, m),
            rng.normal(size=(n_c, m)),
        )

    return make


@pytest.fixture
def make_element(make_modes: Callable[..., Modes]) -> MakeElement:
    def make(
        seed: int = 0, *, rotations: tuple[bool, ...] = (True, False), m: int = 4
    ) -> Superelement:
        rng = np.random.default_rng(seed)
        interfaces = tuple(
            Interface(f"face {k}", rng.normal(size=3), r) for k, r in enumerate(rotations)
        )
        modes = make_modes(seed, sum(interface.n_dofs for interface in interfaces), m)
        second_moments = np.cov(rng.normal(size=(3, 9)))
        points = rng.normal(size=(5, 3))
        # as a file keeps them, in single precision
        phi, stress = (rng.normal(size=(5, k, m)).astype(np.float32).astype(float) for k in (3, 6))
        return Superelement(
            name=f"body {seed}",
            mass=rng.uniform(0.1, 10.0),
            J_rot=np.trace(second_moments) * np.eye(3) - second_moments,
            center=rng.normal(size=3),
            interfaces=interfaces,
            kernel=sample_kernel(modes, 1e-4, GeneralizedAlpha(0.8), 7, error=1e-9),
            modes=modes,
            compliance=modes.phi / modes.omega**2 @ modes.phi.T,
            accelerance=modes.phi @ modes.phi.T,
            recovery=Recovery(points, [[0, 1, 2, -1], [1, 2, 3, 4]], phi, stress),
            provenance=Provenance(
                body='name = "Träger"\n',
                mesh="beam.msh",
                mesh_sha256="0f" * 32,
                method="modal",
                tolerance=1e-8,
                versions={"numpy": "2.4.6", "duhamel": "0.1.0"},
                timings={"modes": 0.1, "assembly": 0.3},
            ),
        )

    return make
