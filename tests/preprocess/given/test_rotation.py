"""Fast rotation of bodies from matrices: what they know of it is that of the mesh."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.cli import app
from duhamel.preprocess import BodyError, assemble, build, doubts_of_body
from duhamel.superelement import check, read, write
from pydantic import ValidationError
from typer.testing import CliRunner

from ..blocks import box_mesh
from ..conftest import straight
from ..rotation.steady import Steady, Support
from .matrix_writers import market_symmetric
from .test_matrices import export, given

L, SIDE = 1.0, 0.1
IMPULSE = {"step": 1e-5, "steps": 4}
ENDS = {"root": {"group": "root"}, "tip": {"group": "tip"}}
MODES = {"modes": 6, "soft": 0}


def faces(model):
    """The nodes of both ends of a bar along x, each carrying an averaged frame."""
    x = model.points[:, 0]
    return {
        name: {"nodes": model.labels[np.isclose(x, place)].tolist()}
        for name, place in (("root", 0.0), ("tip", x.max()))
    }


@pytest.fixture
def bar(solid_body, tmp_path):
    """A square bar from its mesh, and from its matrices, with the frames of these on its ends."""
    mesh = box_mesh("hexahedron20", (L, SIDE, SIDE), (8, 1, 1))
    model = export(assemble(solid_body(mesh, interfaces={"tip": {"node": [L, SIDE, SIDE]}})))
    model.write(tmp_path)

    def make(source, rotation=MODES, **changes):
        changes = {"rotation": rotation, "impulse": IMPULSE, **changes}
        if source == "mesh":
            return solid_body(mesh, **changes)
        return given(model.write(tmp_path), **{"interfaces": faces(model), **changes})

    return make


def of_points(model_or_mesh_tip):
    return {"root": {"node": [0, 0, 0]}, "tip": {"node": model_or_mesh_tip}}


POINTS = of_points([L, SIDE, SIDE])


def test_inertia_and_gyroscopic_terms_are_those_of_the_mesh(bar):
    """All that is not of stress: in the same lowest modes, but for their signs and pairs."""
    mesh, found = (build(bar(source, interfaces=POINTS)) for source in ("mesh", "matrices"))
    rotation = found.rotation
    assert (rotation.n_low, rotation.n_soft, len(rotation.kappa)) == (6, 0, 0)
    assert not rotation.A_interface.any()
    assert rotation.gyroscopic.any()
    load = mesh.rotation.phi_inertia
    expected = load / mesh.modes.omega**2 @ load.T
    load = rotation.phi_inertia
    compliance = load / found.modes.omega**2 @ load.T
    np.testing.assert_allclose(compliance, expected, atol=1e-9 * expected.max(), rtol=0)
