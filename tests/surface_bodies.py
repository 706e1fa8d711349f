"""Bodies with surfaces for tests of contact: `python tests/surface_bodies.py FOLDER [NAME ...]`."""

import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path

import duhamel as du
import numpy as np
import skfem
from duhamel import superelement

STEEL = du.Material(E=210e9, nu=0.3, rho=7800.0)
RADIUS = 0.01


def graded(fine: float, count: int, growth: float, end: float) -> np.ndarray:
    """0 to `end` in `count` fine steps, then in growing ones."""
    x = list(fine * np.arange(count + 1))
    step = growth * fine
    while x[-1] + 1.4 * step < end:
        x.append(x[-1] + step)
        step *= growth
    return np.array([*x, end])


def ball(fine: float, count: int, depth: int, growth: float, cap: float) -> du.Part:
    """A ball of 10 mm of hexahedra, finer about its south pole, with the surface `cap` there.

    fine: the size of elements at the pole over the radius; count, depth: how many of them there
    are, across and into the ball; cap: the radius of the surface over that of the ball.
    """
    half = graded(fine, count, growth, 1.0)
    across = np.concatenate([-half[:0:-1], half])
    along = -1.0 + graded(0.75 * fine, depth, growth, 2.0)
    cube = skfem.MeshHex.init_tensor(across, across, along)
    x, y, z = cube.p**2
    stretch = [np.sqrt(1.0 - a / 2.0 - b / 2.0 + a * b / 3.0) for a, b in ((y, z), (x, z), (x, y))]
    part = du.Part(skfem.MeshHex(RADIUS * cube.p * stretch, cube.t), STEEL, name="ball")
    part.surface("cap", du.sphere([0.0, 0.0, -RADIUS], cap * RADIUS))
    return part


def bar() -> du.Part:
    """A bar of 3 x 3 x 60 hexahedra, 7.5 mm thick and 150 mm long, with the surface `end`."""
    across = np.linspace(-0.00375, 0.00375, 4)
    mesh = skfem.MeshHex.init_tensor(across, across, np.linspace(0.0, 0.15, 61))
    part = du.Part(mesh, STEEL, name="bar")
    part.surface("end", du.plane(z=0.0))
    return part


def dome(fine: float, count: int, depth: int, pad: float) -> du.Part:
    """A block of 8 mm whose lower end is a paraboloid of 10 mm, with the surface `dome` there."""
    half = graded(fine, count, 1.6, 0.004)
    across = np.concatenate([-half[:0:-1], half])
    block = skfem.MeshHex.init_tensor(across, across, graded(fine, depth, 1.5, 0.008))
    x, y, z = block.p
    lift = np.minimum(x**2 + y**2, (4.0 * pad) ** 2) / (2.0 * RADIUS) * (1.0 - z / 0.008)
    part = du.Part(skfem.MeshHex(np.array([x, y, z + lift]), block.t), STEEL, name="dome")
    rim = pad**2 / (2.0 * RADIUS)
    part.surface("dome", du.sphere([0.0, 0.0, rim], 1.001 * np.hypot(pad, rim)))
    return part


def ball_coarse() -> du.Superelement:
    return ball(0.03, 3, 2, 2.2, 0.12).superelement(step=5e-7, band=3e5)


def ball_fine() -> du.Superelement:
    return ball(0.014, 5, 8, 1.6, 0.075).superelement(step=5e-7, band=2.7e5)


def bar_end() -> du.Superelement:
    return bar().superelement(step=4.8e-7, band=3.5e5)


def dome_coarse() -> du.Superelement:
    return dome(2e-4, 3, 3, 5e-4).superelement(step=5e-7, band=4e5)


BODIES: dict[str, Callable[[], du.Superelement]] = {
    "ball-coarse": ball_coarse,
    "ball": ball_fine,
    "bar": bar_end,
    "dome-coarse": dome_coarse,
}


def main(folder: Path, names: list[str]) -> None:
    for name in names or BODIES:
        start = time.process_time()
        element = BODIES[name]()
        superelement.write(element, folder / f"{name}.h5")
        assert element.surfaces is not None
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        print(
            f"{name}: {element.surfaces.patches}, {len(element.modes.omega)} modes, "
            f"{time.process_time() - start:.1f} s, {memory:.2f} GB"
        )


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
