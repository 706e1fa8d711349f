"""Bodies from files that other programs wrote: those of `codes`, whose README says which."""

import lzma
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from duhamel.preprocess import Body, MatrixError, MeshWarning, assemble, build
from scipy.linalg import eigh

from ..conftest import IMPULSE

CODES = Path(__file__).parent / "codes"
STEEL = {"E": 210e9, "nu": 0.3, "rho": 7850.0}


def frequencies(structure: Any) -> Any:
    """Of the free body [Hz], those of rigid motion first."""
    values = eigh(structure.K.toarray(), structure.M.toarray(), eigvals_only=True)
    return np.sqrt(np.abs(values)) / (2.0 * np.pi)


def body(interfaces: dict[str, Any], **source: Any) -> Body:
    return Body.model_validate(
        {"name": "part", "interfaces": interfaces, "impulse": IMPULSE, **source}
    )


@pytest.fixture
def calculix(tmp_path) -> dict[str, Path]:
    folder = CODES / "calculix"
    for name in ("bar.sti", "bar.mas"):
        (tmp_path / name).write_bytes(lzma.decompress((folder / f"{name}.xz").read_bytes()))
    return {
        "stiffness": tmp_path / "bar.sti",
        "mass": tmp_path / "bar.mas",
        "dofs": folder / "bar.dof",
        "nodes": folder / "bar.inp",
    }


ENDS = {"root": {"node": [0, 0, 0]}, "tip": {"node": [0.12, 0.04, 0.03]}}


def test_calculix_has_the_frequencies_of_the_same_elements_here(calculix):
    """Quadratic hexahedra with the same points of integration, 14 digits in the file."""
    found = assemble(body(ENDS, matrices=calculix))
    with pytest.warns(MeshWarning, match="materials STEEL"):
        own = assemble(body(ENDS, mesh=calculix["nodes"], material=STEEL))
    assert frequencies(found)[6:] == pytest.approx(frequencies(own)[6:], rel=1e-10)
    assert found.rigid.mass == pytest.approx(7850.0 * 0.12 * 0.04 * 0.03, rel=1e-12)


def test_groups_of_the_mesh_beside_name_interfaces(calculix):
    tip = build(body({"tip": {"group": "TIP"}}, matrices=calculix)).interfaces[0]
    assert tip.rotations
    assert tip.X == pytest.approx([0.06, 0.0, 0.0], abs=1e-12)


def held(text: str) -> str:
    """Rows without those of one node, as of a model with boundary conditions."""
    return "\n".join(line for line in text.split() if not line.startswith("680."))


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda files: files.pop("dofs"), r"bar.sti: expected the node .* of its rows, found none"),
        (lambda files: files.pop("mass"), r"matrices.mass: expected a file, for bar.sti holds one"),
        (
            lambda files: files.update(dofs=written(files, "680.1\n680.x\n")),
            r"spoiled.dof: expected 'label.dof', found '680.x'",
        ),
        (
            lambda files: files.update(dofs=written(files, held(files["dofs"].read_text()))),
            r"spoiled.dof: expected a row for each of the 96 of bar.sti, found 93",
        ),
    ],
)
def test_mistakes_with_files_of_calculix(calculix, spoil, message):
    spoil(calculix)
    with pytest.raises(MatrixError, match=message):
        assemble(body(ENDS, matrices=calculix))


def written(files: dict[str, Path], text: str) -> Path:
    path = files["stiffness"].with_name("spoiled.dof")
    path.write_text(text)
    return path
