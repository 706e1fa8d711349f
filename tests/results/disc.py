"""A results file made by hand, of a motion known in closed form.

A disc turns about z by angle(t) = 2 pi (3 t^2 + t), more than three turns in 0.9 s, its body axes
tilted by 0.7 rad about x. A beam hangs on the frame `rim` of the disc; seen from there its tip
moves by `travel`.
"""

from pathlib import Path

import h5py
import numpy as np
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


def write_disc(path: Path) -> Path:
    """The file by h5py alone, without the writer under test."""
    disc = Rotation.from_rotvec(ANGLE[:, None] * [0.0, 0.0, 1.0]) * TILT
    rim = disc.apply(RIM)
    tip = rim + disc.apply(REST + TRAVEL)
    spin = TILT.inv().apply([0.0, 0.0, 1.0])
    turn, zeros = quaternions(disc), np.zeros((len(TIME), 3))
    variables = {
        "body_position": [0.5 * (rim + tip), zeros],
        "body_rotation": [turn, turn],
        "body_velocity": [zeros, zeros],
        "body_angular_velocity": [zeros, SPEED[:, None] * spin],
        "body_acceleration": [zeros, zeros],
        "body_angular_acceleration": [zeros, ACCELERATION[:, None] * spin],
        "frame_position": [tip, rim],
        "frame_rotation": [turn, turn],
        "frame_velocity": [TRAVEL + 7.0, zeros],
        "frame_angular_velocity": [TRAVEL + 8.0, zeros],
        "frame_acceleration": [TRAVEL + 9.0, zeros],
        "frame_angular_acceleration": [TRAVEL + 10.0, zeros],
        "frame_elastic_displacement": [TRAVEL, zeros],
        "frame_elastic_rotation": [10 * TRAVEL, zeros],
        "frame_force": [zeros, zeros],
        "frame_moment": [zeros, zeros],
        "joint_force": [TRAVEL + 1.0],
        "joint_moment": [TRAVEL + 2.0],
        "joint_position": [ANGLE],
        "joint_rate": [SPEED],
        "spring_force": [TRAVEL + 3.0],
        "spring_moment": [TRAVEL + 4.0],
    }
    names = {
        "body": ["beam", "disc"],
        "frame": ["beam.tip", "disc.rim"],
        "joint": ["clamp"],
        "joint_coordinate": ["clamp.angle"],
        "joint_position_units": ["rad"],
        "joint_rate_units": ["rad s-1"],
        "spring": ["mount"],
        "axis": ["x", "y", "z"],
        "quaternion": ["w", "x", "y", "z"],
        "flexible_body": ["beam"],
        "superelement_file": ["/nowhere/beam.h5"],
        "superelement_sha256": ["0123456789abcdef"],
    }
    whole = {
        "time": TIME,
        "linear_momentum": TRAVEL + 5.0,
        "angular_momentum": TRAVEL + 6.0,
        "kinetic_energy": 30.0 * SPEED**2,
        "elastic_energy": np.full_like(TIME, 0.5),
        "spring_energy": np.zeros_like(TIME),
        "potential_energy": np.zeros_like(TIME),
        "external_work": 30.0 * SPEED**2,
        "dissipated_energy": np.zeros_like(TIME),
        "numerical_dissipation": np.zeros_like(TIME),
        "energy_balance": 1e-7 * TIME,
    }
    with h5py.File(path, "w") as file:
        file.attrs.update(format="duhamel-results", version=3, model="")
        file.create_group("solver").attrs.update(written=len(TIME), run="by hand")
        for name, data in whole.items():
            file[name] = data
        for name, parts in variables.items():
            file[name] = np.stack(parts, axis=1)
        for name, entries in names.items():
            file[name] = np.array(entries, dtype=object)
    return path
