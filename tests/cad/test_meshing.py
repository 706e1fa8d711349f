"""Meshes are sound or refused: elements that fold over, flat ones, volumes hard to fill."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("gmsh")

import gmsh
from duhamel.cad import CadError, CadGeometry, meshing
from duhamel.cad.quality import Quality
from duhamel.preprocess import mesh_of
from duhamel.preprocess.plausibility import doubts_of_mesh

from .parts import session

CORNERS = np.array([[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]], dtype=float)
EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (2, 3), (1, 3)]  # in gmsh's order


@pytest.mark.parametrize(("height", "folds"), [(2.0, False), (8.0, True)])
def test_a_curved_element_that_folds_over_is_refused(height: float, folds: bool) -> None:
    """The middle of the edge along x is pushed up through the element."""
    middles = np.array([CORNERS[[i, j]].mean(axis=0) for i, j in EDGES])
    middles[0] += [0.0, 0.0, height]
    with session():
        volume = gmsh.model.addDiscreteEntity(3)
        points = np.vstack([CORNERS, middles])
        gmsh.model.mesh.addNodes(3, volume, range(1, 11), points.ravel())
        gmsh.model.mesh.addElementsByType(volume, meshing.TEN_NODE_TYPE, [1], range(1, 11))
        elements, jacobians = meshing._jacobians()
        if not folds:
            assert jacobians.min() > 0.0
            meshing._check_folded(elements, jacobians, 1e-3)
            return
        with pytest.raises(
            CadError, match=r"1 of 1 curved elements fold over, .* near \[0\.0025, 0\.0025, 0\.0025"
        ):
            meshing._check_folded(elements, jacobians, 1e-3)


@pytest.mark.parametrize(("middle", "expected"), [(5.0, 1.0), (6.0, 0.6 / 1.4)])
def test_the_jacobian_is_the_smallest_over_the_largest_one(middle: float, expected: float) -> None:
    """Whatever its shape: x,r = 4 m - 10 + r (20 - 4 m) along the edge, m its middle."""
    assert _jacobians_of(CORNERS, middle) == pytest.approx(expected)
    # Two corners exchanged: nowhere positive.
    assert _jacobians_of(CORNERS[[1, 0, 2, 3]], middle) < 0.0


def _jacobians_of(corners: Any, middle: float) -> float:
    middles = np.array([corners[[i, j]].mean(axis=0) for i, j in EDGES])
    middles[0, 0] = middle
    with session():
        volume = gmsh.model.addDiscreteEntity(3)
        gmsh.model.mesh.addNodes(3, volume, range(1, 11), np.vstack([corners, middles]).ravel())
        gmsh.model.mesh.addElementsByType(volume, meshing.TEN_NODE_TYPE, [1], range(1, 11))
        return float(meshing._jacobians()[1][0])


def test_a_volume_that_one_algorithm_gives_up_is_filled_by_another(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    generate, tried = gmsh.model.mesh.generate, []

    def fail_first(dimension: int) -> None:
        tried.append(gmsh.option.getNumber("Mesh.Algorithm3D"))
        if len(tried) == 1:
            raise Exception("HXT 3D mesh failed")
        generate(dimension)

    with session():
        solid = gmsh.model.occ.addBox(0, 0, 0, 20, 10, 10)
        gmsh.model.occ.synchronize()
        monkeypatch.setattr(gmsh.model.mesh, "generate", fail_first)
        quality = meshing.mesh(solid, 10.0, {}, 1e-3)
        elements, _ = gmsh.model.mesh.getElementsByType(meshing.TEN_NODE_TYPE)
        volumes = gmsh.model.mesh.getElementQualities(elements, "volume")
    assert tried == [10, 1]
    assert quality.elements == len(elements) > 0
    assert sum(volumes) == pytest.approx(2000.0, rel=1e-12)


@pytest.mark.parametrize(("shape", "doubts"), [(0.049, 1), (0.051, 0)])
def test_flat_tetrahedra_are_told(shape: float, doubts: int) -> None:
    given: Any = (CORNERS, [[0, 1, 2, 3]])
    quality = Quality(elements=1, worst_shape=shape, mean_shape=0.7, worst_jacobian=1.0)
    mesh = replace(mesh_of(given), geometry=CadGeometry("part", 1.0 / 6.0, (), {}, quality, "4.15"))
    assert len(list(doubts_of_mesh(mesh))) == doubts
