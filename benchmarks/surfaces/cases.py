"""Parts that hit a plane or one another by their surfaces."""

from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import duhamel as du
import meshio
import numpy as np
import skfem
from numpy.typing import NDArray
from surface_bodies import STEEL, dome, graded

ROOT = Path(__file__).parents[2]
Array = NDArray[np.float64]

PLASTIC = du.Material(E=2.4e9, nu=0.35, rho=1100.0)
SPEED = 1.0
"""of the impacts [m/s]"""
GAP = 1e-6
"""at the start [m]"""
FINE, CONTACT = 8e-6, 10
"""of the flanks of teeth where they meet: size of facets [m], how many there are to each side"""


@dataclass(frozen=True)
class Case:
    """Parts with one surface each, of which the first moves along a way, and the runs.

    It meets a plane across its way, or the second part, which is at rest.
    """

    name: str
    parts: tuple[du.Part, ...]
    surface: str
    band: float
    layer: float
    """[N/m^3]"""
    t_end: float
    steps: tuple[float, ...]
    """of the superelements [s], the shortest first"""
    way: tuple[float, float, float] = (0.0, 0.0, -1.0)


def cases() -> Iterator[Case]:
    yield Case(
        "domed block",
        (dome(8e-5, 7, 6, 5.6e-4),),
        "dome",
        band=4e5,
        layer=3e15,
        t_end=2.6e-5,
        steps=(2.5e-7, 1e-6),
    )
    across, along = np.linspace(-0.005, 0.005, 9), np.linspace(0.0, 0.15, 121)
    rod = du.Part(skfem.MeshHex.init_tensor(across, across, along), STEEL, name="rod")
    rod.surface("end", du.plane(z=0.0))
    size, speed = along[1], float(np.sqrt(STEEL.E / STEEL.rho))
    step = size / speed
    yield Case(
        "flat-ended rod",
        (rod,),
        "end",
        band=3.5e5,
        layer=STEEL.rho * speed / (3.0 * step),
        t_end=9e-5,
        steps=(step,),
    )
    mesh = script("housing").housing(fine=7.7e-4, coarse=2e-3)
    housing = du.Part(mesh, PLASTIC, name="housing")
    housing.surface("soles", du.box([0.0, 0.0, -0.007], [0.1, 0.07, -0.005]))
    yield Case(
        "housing", (housing,), "soles", band=2e4, layer=1e13, t_end=1e-3, steps=(2.5e-6, 5e-6)
    )
    teeth, way = gear_teeth()
    yield Case(
        "gear teeth",
        teeth,
        "flank",
        band=4e5,
        layer=3e14,
        t_end=4e-5,
        steps=(1.25e-7, 2.5e-7),
        way=way,
    )


def gear_teeth() -> tuple[tuple[du.Part, du.Part], tuple[float, float, float]]:
    """A tooth of each of two gears in mesh, `GAP` apart on the line of action, and its direction.

    The upper flank of a tooth on the line of centers meets the next tooth of the other gear, a
    quarter of the base pitch from the pitch point.
    """
    gear = script("spur_gear")
    angle, pitch = gear.PRESSURE_ANGLE, 2.0 * np.pi / gear.TEETH
    way = np.array([np.sin(angle), np.cos(angle)])
    place = np.array([gear.PITCH, 0.0]) + 0.25 * pitch * gear.BASE * way
    center = np.array([gear.CENTERS, 0.0])
    radii = np.linalg.norm([place, place - center], axis=1)
    # Half the backlash is between these flanks; the second tooth comes up to the gap.
    shift = center - (0.5 * gear.BACKLASH - GAP) * way
    parts = (
        tooth(gear, radii[0], 0.0, np.zeros(2), 8),
        tooth(gear, radii[1], np.pi - 0.5 * pitch, shift, 7),
    )
    return parts, (float(way[0]), float(way[1]), 0.0)


def tooth(gear: ModuleType, radius: float, turn: float, shift: Array, layers: int) -> du.Part:
    """A tooth on its part of the rim, turned about z and then shifted (2,).

    Finer at a radius of the flank at positive angles.
    """
    below = radius - graded(FINE, CONTACT, 1.5, radius - gear.ROOT)[:0:-1]
    above = radius + graded(FINE, CONTACT, 1.5, gear.TIP - radius)
    r = np.concatenate([np.linspace(gear.BORE, gear.ROOT, 7)[:-1], below, above])[:, None]
    half = gear.half_angle(np.maximum(r, gear.ROOT))
    s = 1.0 - graded(1.5 * FINE, CONTACT, 1.5, 2.0 * gear.MODULE)[::-1] / gear.MODULE
    grid = gear.polar(*np.broadcast_arrays(r, half * s)).reshape(-1, 2)
    numbers = np.arange(len(grid)).reshape(len(r), len(s))
    corners = [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]
    quads = np.stack(corners, axis=2).reshape(-1, 4)
    # Above the root.
    side = numbers[np.searchsorted(r[:, 0], gear.ROOT) :, -1]
    edges = np.column_stack([side[:-1], side[1:]])
    c, s = np.cos(turn), np.sin(turn)
    flat = grid @ np.array([[c, s], [-s, c]]) + shift
    heights = np.linspace(-0.5 * gear.WIDTH, 0.5 * gear.WIDTH, layers + 1)
    n = len(flat)
    solid = np.concatenate([np.column_stack([flat, np.full(n, z)]) for z in heights])
    levels = n * np.arange(layers)[:, None, None]
    bricks = (levels + np.hstack([quads, quads + n])).reshape(-1, 8)
    sides = (levels + np.column_stack([edges, edges[:, ::-1] + n])).reshape(-1, 4)
    mesh = meshio.Mesh(
        solid,
        [("hexahedron", bricks), ("quad", sides)],
        cell_sets={"flank": [np.empty(0, dtype=np.int64), np.arange(len(sides))]},
    )
    part = du.Part(mesh, STEEL, name="tooth")
    part.surface("flank", du.group("flank"))
    return part


def script(folder: str) -> ModuleType:
    """The script that makes the mesh of an example."""
    path = ROOT / "meshes" / folder / "make_mesh.py"
    spec = spec_from_file_location(folder, path)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
