"""A flexible body beside the bad files."""

from pathlib import Path

import numpy as np
import pytest
from duhamel.superelement import (
    Channels,
    GeneralizedAlpha,
    Interface,
    Modes,
    Pattern,
    Superelement,
    Surface,
    Surfaces,
    read,
    sample_kernel,
    write,
)


def make_element(m: int = 12) -> Superelement:
    """A body of two interfaces, with as many modes as these have dofs, and a surface of a facet."""
    rng = np.random.default_rng(0)
    modes = Modes(100.0 * np.arange(1, m + 1), [0.01] * m, rng.normal(size=(12, m)))
    X = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.1, 0.1, 0.0], [0.0, 0.1, 0.0]])
    up = np.tile([0.0, 0.0, 1.0], (4, 1))
    flank = Surface("flank", np.arange(4), X, np.array([[0, 1, 2, 3]]), "quad", up, area=0.01)
    phi = rng.normal(size=(12, m))
    H = phi / modes.omega**2 @ phi.T + 1e-6 * np.eye(12)
    return Superelement(
        name="beam",
        mass=1.5,
        J_rot=np.diag([1.0, 2.0, 1.5]),
        center=np.zeros(3),
        interfaces=(Interface("root", [-0.25, 0, 0]), Interface("tip", [0.25, 0, 0])),
        kernel=sample_kernel(modes, 1e-3, GeneralizedAlpha(0.8), 40),
        modes=modes,
        compliance=modes.phi / modes.omega**2 @ modes.phi.T,
        accelerance=modes.phi @ modes.phi.T,
        channels=Channels((Pattern("wind", [1, 0, 0], [0, 0, 0]),), (), [[0.1] * m]),
        surfaces=Surfaces((flank,), phi, H),
    )


@pytest.fixture(scope="session")
def beam_image(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("beam") / "beam.h5"
    write(path, make_element())
    return path.read_bytes()


@pytest.fixture(scope="session")
def beam_element() -> Superelement:
    return make_element()


@pytest.fixture
def beam_read_once(
    beam_image: bytes, beam_element: Superelement, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Models find the beam read already: to read it takes longer than all else of a bad model."""

    def read_or_known(path: Path, recovery: bool = True) -> Superelement:
        known = path.is_file() and path.read_bytes() == beam_image
        return beam_element if known else read(path, recovery)

    monkeypatch.setattr("duhamel.solver.model.file.read", read_or_known)


@pytest.fixture
def beam_file(beam_image: bytes, tmp_path: Path) -> Path:
    """A superelement with two interfaces, alone in a folder."""
    path = tmp_path / "beam.h5"
    path.write_bytes(beam_image)
    return path
