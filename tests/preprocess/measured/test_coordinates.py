"""Virtual points beside their formula in the words of its source, axis by axis.

Source: M. V. van der Seijs, D. D. van den Bosch, D. J. Rixen, D. de Klerk, Mechanical Systems and
Signal Processing 75 (2016) 148-167, equations 6 and 12.
"""

import numpy as np
from duhamel.preprocess.body.measured_body import VirtualPoint
from duhamel.preprocess.measured.channels import ChannelTable
from duhamel.preprocess.measured.coordinates import coordinates_of
from duhamel.preprocess.measured.hits import HitTable


def motion_of(r, e):
    """Along e, by the rigid motion of a point at -r: three translations and three rotations."""
    x, y, z = r
    columns = np.array([[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]], dtype=float)
    return e @ columns


def unit(rng, n):
    e = rng.standard_normal((n, 3))
    return e / np.linalg.norm(e, axis=1)[:, None]


def test_virtual_points_are_those_of_their_formula():
    """Transformations of motions and loads, T_u = R_u^+ and T_f = (R_f^+)^T, of skew sensors."""
    rng = np.random.default_rng(3)
    labels = tuple(f"{k // 3}" for k in range(18))
    places = np.repeat(0.1 * rng.standard_normal((6, 3)), 3, axis=0)
    channels = ChannelTable(labels, labels, places, unit(rng, 18))
    hits = HitTable(
        tuple(f"h{k}" for k in range(20)), 0.1 * rng.standard_normal((20, 3)), unit(rng, 20)
    )
    ats = {"a": rng.standard_normal(3), "b": rng.standard_normal(3)}
    sensors, struck = (
        {"a": ("0", "1", "2"), "b": ("3", "4", "5")},
        {"a": slice(9), "b": slice(9, 20)},
    )
    points = {
        name: VirtualPoint(at=tuple(at), channels=sensors[name], hits=hits.labels[struck[name]])
        for name, at in ats.items()
    }
    found = coordinates_of(points, channels, hits, rng.standard_normal(3))
    H = rng.standard_normal((18, 20)) + 1j * rng.standard_normal((18, 20))
    expected = np.zeros((12, 12), dtype=complex)
    for k, (name, at) in enumerate(ats.items()):
        for j, (other, there) in enumerate(ats.items()):
            o = [i for i, label in enumerate(labels) if label in sensors[name]]
            R_u = np.array([motion_of(places[i] - at, channels.directions[i]) for i in o])
            R_f = np.array(
                [
                    motion_of(X - there, e)
                    for X, e in zip(
                        hits.points[struck[other]], hits.directions[struck[other]], strict=True
                    )
                ]
            )
            T_u = np.linalg.solve(R_u.T @ R_u, R_u.T)
            T_f = R_f @ np.linalg.inv(R_f.T @ R_f)
            expected[6 * k : 6 * k + 6, 6 * j : 6 * j + 6] = T_u @ H[o][:, struck[other]] @ T_f
    Y = np.linalg.pinv(found.outputs) @ H @ np.linalg.pinv(found.inputs).T
    np.testing.assert_allclose(Y, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
