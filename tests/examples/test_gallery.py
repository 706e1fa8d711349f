"""The parts in meshes/ are what their scripts say, and the examples with them hold."""

from dataclasses import dataclass
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from duhamel import preprocess
from duhamel.preprocess.assembly.structure import assemble_on
from duhamel.preprocess.mesh.reading import read_mesh
from duhamel.preprocess.sources.reading import read_mesh_source

MESHES = Path(__file__).parents[2] / "meshes"
PARTS = {"connecting_rod": "rod", "bracket": "bracket", "blade": "blade"}
GEOMETRY = {"connecting_rod": 1e-4, "bracket": 1e-4, "blade": 2e-3}
"""how near the mesh comes to mass and inertia; the nose of the blade is the hardest to follow"""


def script(folder, name="make_mesh"):
    spec = spec_from_file_location(name, MESHES / folder / f"{name}.py")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@dataclass(frozen=True, eq=False)
class Part:
    """A body on its mesh, its mass properties, and its interfaces by name."""

    body: Any
    mesh: Any
    rigid: Any
    interfaces: Any


@pytest.fixture(scope="module")
def parts():
    return {
        part: made(preprocess.read_body(MESHES / part / f"{name}.toml"))
        for part, name in PARTS.items()
    }


def made(body):
    source = read_mesh_source(body)
    structure = assemble_on(body, source)
    return Part(body, source.mesh, structure.rigid, structure.frames)


def test_bores_are_round(parts):
    """Areas 2 pi r b and places of the holes: flat facets, eight around, would lose 2.6 % of the
    area.
    """
    rod, bracket = parts["connecting_rod"].interfaces, parts["bracket"].interfaces
    bores = [
        (rod["big_end"], 22e-3, 22e-3, (0, 0, 0)),
        (rod["small_end"], 10e-3, 22e-3, (0.15, 0, 0)),
    ]
    for n, (x, y) in enumerate(
        [(-48e-3, -28e-3), (-48e-3, 28e-3), (48e-3, -28e-3), (48e-3, 28e-3)], start=1
    ):
        bores.append((bracket[f"bolt_{n}"], 5.5e-3, 10e-3, (x, y, 5e-3)))
    for n, x in ((1, -20e-3), (2, 20e-3)):
        bores.append((bracket[f"lug_{n}"], 9e-3, 10e-3, (x, 0, 50e-3)))
    for place, radius, length, middle in bores:
        assert place.area == pytest.approx(2 * np.pi * radius * length, rel=5e-4)
        np.testing.assert_allclose(place.X, middle, rtol=0, atol=1e-6)


def test_sections_of_the_blade(parts):
    """The area of NACA's aerofoils: chord^2 t times 10 int_0^0.96 (0.2969 sqrt(s) - ... ) ds."""
    s = 0.96
    powers = np.array(
        [0.2969 * s**1.5 / 1.5, -0.1260 * s**2 / 2, -0.3516 * s**3 / 3, 0.2843 * s**4 / 4]
    )
    area = 10 * (powers.sum() - 0.1015 * s**5 / 5)
    for end, chord, t in (("root", 0.06, 0.15), ("tip", 0.035, 0.10)):
        assert parts["blade"].interfaces[end].area == pytest.approx(area * chord**2 * t, rel=5e-3)


@pytest.mark.parametrize("part", PARTS)
def test_mass_and_inertia_are_those_of_the_solid(part, parts):
    """Of the finite element mesh against the exact geometry, as OpenCASCADE integrates it."""
    gmsh = pytest.importorskip("gmsh")
    module = script(part)
    found = parts[part]
    rho, scale = found.body.material.rho, found.body.scale
    gmsh.initialize(["-v", "0"], interruptible=False)
    try:
        getattr(module, part)()
        ((_, solid),) = gmsh.model.getEntities(3)
        volume = gmsh.model.occ.getMass(3, solid)
        center = scale * np.array(gmsh.model.occ.getCenterOfMass(3, solid))
        J = rho * scale**5 * np.reshape(gmsh.model.occ.getMatrixOfInertia(3, solid), (3, 3))
    finally:
        gmsh.finalize()
    rigid = found.rigid
    assert rigid.mass == pytest.approx(rho * scale**3 * volume, rel=GEOMETRY[part])
    np.testing.assert_allclose(rigid.center, center, rtol=0, atol=GEOMETRY[part] * found.mesh.size)
    np.testing.assert_allclose(rigid.J_rot, J, rtol=0, atol=GEOMETRY[part] * np.abs(J).max())


@pytest.mark.parametrize("part", PARTS)
def test_scripts_make_the_meshes_that_are_shipped(part, parts, tmp_path):
    """With another release of Gmsh the elements are others, but about as many, and with the same
    groups.
    """
    pytest.importorskip("gmsh")
    module = script(part)
    module.write(module.SIZE, tmp_path / "part.msh")
    made, shipped = read_mesh(tmp_path / "part.msh", parts[part].body.scale), parts[part].mesh
    assert set(made.groups) == set(shipped.groups)
    assert len(made.points) == pytest.approx(len(shipped.points), rel=0.1)


def test_the_twin_of_the_beam():
    """Mass and bending stiffness of the solid bar are those of the paper's beam."""
    solid, beam = (preprocess.read_body(MESHES / f"beam/{name}.toml") for name in ("solid", "beam"))
    side = np.ptp(read_mesh(solid.mesh).points, axis=0)[1]
    assert solid.material.E * side**4 / 12 == pytest.approx(beam.section.EI_y, rel=1e-6)
    assert solid.material.rho * side**2 == pytest.approx(beam.section.mass_per_length, rel=1e-6)


@pytest.mark.validation
def test_case1_in_solids(example, tmp_path):
    script = example("swap")
    found = script.main(
        tmp_path, script.SWAPS[1]
    )  # which checks that the meshes explain the difference
    assert found.deflection < 1e-3
    assert np.abs(found.frequency_shift).max() < 1e-4


@pytest.mark.validation
def test_slider_crank(example, tmp_path):
    example("slider_crank").main(tmp_path)  # which checks forces and stresses
    assert {"slider-crank.png", "slider-crank-rod.png"} <= {
        path.name for path in tmp_path.iterdir()
    }


@pytest.mark.validation
def test_bladed_rotor(example, tmp_path):
    example("bladed_rotor").main(tmp_path)  # which checks symmetry, momentum and the blow
    assert {"bladed-rotor.png", "bladed-rotor-stress.png"} <= {
        path.name for path in tmp_path.iterdir()
    }
