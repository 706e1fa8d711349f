"""A results file made by hand, of a motion known in closed form.

A disc turns about z by angle(t) = 2 pi (3 t^2 + t), more than three turns in 0.9 s, its body axes
tilted by 0.7 rad about x. A beam hangs on the frame `rim` of the disc; seen from there its tip
moves by `travel`.
"""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

TILT = Rotation.from_rotvec([0.7, 0.0, 0.0])
RIM = np.array([0.5, 0.0, 0.1])
REST = np.array([0.25, 0.02, 0.0])
TIME = np.linspace(0.0, 0.9, 181)

ANGLE = 2 * np.pi * (3 * TIME**2 + TIME)
SPEED = 2 * np.pi * (6 * TIME + 1)
ACCELERATION = np.full_like(TIME, 12 * np.pi)
TRAVEL = 2e-3 * np.stack([np.sin(9 * TIME), np.cos(7 * TIME), TIME**2], axis=1)


def quaternions(rotation: Rotation) -> np.ndarray:
    """Unit quaternions w, x, y, z, every third with the sign turned, which is the same rotation."""
    q = np.roll(rotation.as_quat(), 1, axis=1)
    q[::3] *= -1.0
    return q


@pytest.fixture
def results_file(tmp_path: Path) -> Path:
    disc = Rotation.from_rotvec(ANGLE[:, None] * [0.0, 0.0, 1.0]) * TILT
    rim = disc.apply(RIM)
    tip = rim + disc.apply(REST + TRAVEL)
    spin = TILT.inv().apply([0.0, 0.0, 1.0])
    zeros, still = np.zeros((len(TIME), 3)), np.zeros((len(TIME), 6))
    datasets = {
        "bodies/disc/x": zeros,
        "bodies/disc/R": quaternions(disc),
        "bodies/disc/v": np.hstack([zeros, SPEED[:, None] * spin]),
        "bodies/disc/v_dot": np.hstack([zeros, ACCELERATION[:, None] * spin]),
        "bodies/beam/x": 0.5 * (rim + tip),
        "bodies/beam/R": quaternions(disc),
        "bodies/beam/v": still,
        "bodies/beam/v_dot": still,
        "frames/disc.rim/position": rim,
        "frames/disc.rim/rotation": quaternions(disc),
        "frames/disc.rim/u": still,
        "frames/beam.tip/position": tip,
        "frames/beam.tip/rotation": quaternions(disc),
        "frames/beam.tip/velocity": np.hstack([TRAVEL + 7.0, TRAVEL + 8.0]),
        "frames/beam.tip/acceleration": np.hstack([TRAVEL + 9.0, TRAVEL + 10.0]),
        "frames/beam.tip/u": np.hstack([TRAVEL, 10 * TRAVEL]),
        "joints/clamp/force": TRAVEL + 1.0,
        "joints/clamp/moment": TRAVEL + 2.0,
        "joints/clamp/angle": ANGLE,
        "joints/clamp/angle_rate": SPEED,
        "springs/mount/force": TRAVEL + 3.0,
        "springs/mount/moment": TRAVEL + 4.0,
        "momentum/linear": TRAVEL + 5.0,
        "momentum/angular": TRAVEL + 6.0,
        "energy/kinetic": 30.0 * SPEED**2,
        "energy/elastic": np.full_like(TIME, 0.5),
        "energy/potential": np.zeros_like(TIME),
        "energy/work": 30.0 * SPEED**2,
        "energy/balance": 1e-7 * TIME,
        "time": TIME,
    }
    path = tmp_path / "disc-results.h5"
    with h5py.File(path, "w") as file:
        file.attrs.update(format="duhamel-results", version=1, units="SI")
        file.create_group("superelements").attrs["beam"] = "0123456789abcdef"
        file.create_group("solver").attrs["written"] = len(TIME)
        for name, data in datasets.items():
            file[name] = data
        file["joints/clamp/angle"].attrs["units"] = "rad"
        file["joints/clamp/angle_rate"].attrs["units"] = "rad/s"
    return path


@pytest.fixture
def edit(results_file: Path) -> Callable[[Callable[[h5py.File], None]], Path]:
    """Change the file, and give its path."""

    def edited(change: Callable[[h5py.File], None]) -> Path:
        with h5py.File(results_file, "a") as file:
            change(file)
        return results_file

    return edited
