"""A modal test of a bracket, as a program for modal analysis would write it; of a model, not real.

    python meshes/bracket/make_test.py

The tested bracket is unlike that of bracket.toml: its aluminium is 5 % softer, and it is 2 % higher
and thicker. Twelve sensors on its outside measure in all three directions; shapes have 3 % of
noise. Writes test_channels.csv and test_modes.csv.
"""

from pathlib import Path

import numpy as np
from duhamel import preprocess
from duhamel.preprocess.body.material import Material
from duhamel.preprocess.body.sensors import SensorPoint
from duhamel.preprocess.mesh.reading import read_mesh

FOLDER = Path(__file__).parent
SOFTER, HIGHER = 0.95, 1.02
PLACES = (
    *((x, y, 0) for x in (-60, 0, 60) for y in (-40, 40)),
    *((x, y, z) for x in (-25, 25) for y, z in ((-17, 30), (17, 30), (0, 67))),
)
"""of the sensors, next to them the nodes that they are on [mm]"""
LAST, NOISE, SEED = 9000.0, 0.03, 1
"""highest frequency [Hz]; of shapes, by their rms"""


def main() -> None:
    body = preprocess.read_body(FOLDER / "bracket.toml")
    mesh = read_mesh(FOLDER / "bracket.msh", 1e-3)
    nearest = [np.linalg.norm(1e3 * mesh.points - p, axis=1).argmin() for p in PLACES]
    chosen = mesh.points[nearest].copy()
    mesh.points[:, 2] *= HIGHER
    stretched = [(x, y, HIGHER * z) for x, y, z in chosen]
    assert body.material is not None
    tested = body.model_copy(
        update={
            "mesh": mesh,
            "material": Material(E=SOFTER * body.material.E, nu=0.33, rho=body.material.rho),
            "sensors": {f"p{k + 1}": SensorPoint(point=p) for k, p in enumerate(stretched)},
        }
    )
    element = preprocess.build(tested)
    f = element.modes.omega / (2.0 * np.pi)
    modes = np.argsort(f)[: int((f < LAST).sum())]
    shapes = element.channels.phi[:, modes].T
    rng = np.random.default_rng(SEED)
    rms = np.sqrt((shapes**2).mean(axis=1, keepdims=True))
    shapes = shapes + NOISE * rms * rng.standard_normal(shapes.shape)
    damping = 0.002 + 0.008 * rng.random(len(modes))
    write(chosen, f[modes], damping, shapes)


def write(points, frequency, damping, shapes) -> None:
    channels = ["label, x, y, z, axis"]
    names = []
    for k, point in enumerate(points):
        for axis in "xyz":
            channels.append(f"p{k + 1}, " + ", ".join(f"{c:.6g}" for c in point) + f", {axis}")
            names.append(f"p{k + 1}:{axis}")
    (FOLDER / "test_channels.csv").write_text("\n".join(channels) + "\n")
    rows = [", ".join(["frequency", "damping", *names])]
    for values in zip(frequency, damping, shapes, strict=True):
        rows.append(", ".join(f"{v:.5g}" for v in np.hstack(values)))
    (FOLDER / "test_modes.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
