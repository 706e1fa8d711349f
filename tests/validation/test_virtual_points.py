"""Virtual points beside those of pyFBS, whose one file for them is fetched from PyPI at each run.

The rest of it takes programs with windows, of which none is loaded here.
"""

import types

import numpy as np
import pytest
from duhamel.preprocess.body.measured_body import VirtualPoint
from duhamel.preprocess.measured.channels import ChannelTable
from duhamel.preprocess.measured.coordinates import coordinates_of
from duhamel.preprocess.measured.hits import HitTable

from .fetched_wheel import fetched_wheel

pytestmark = pytest.mark.validation

pandas = pytest.importorskip("pandas")
REQUIREMENT = (
    "pyFBS==1.0.7 --hash=sha256:2d3eb7f47208e0dbec2ab1489acdab674fb0dc67df20b1d7d5f35570e7a294c7"
)
"""exact file, so that nothing else is ever run"""
PLACES = {"a": np.array([0.1, -0.2, 0.3]), "b": np.array([-0.4, 0.2, 0.1])}
SENSORS, CHANNELS, HITS = 3, 9, 10
"""at each point"""


@pytest.fixture(scope="module")
def vpt(tmp_path_factory):
    """The class of pyFBS."""
    with fetched_wheel(tmp_path_factory.mktemp("wheel"), REQUIREMENT) as wheel:
        source = wheel.read("pyfbs/interface/vpt.py").decode()
    # Coherences, of another module, are not asked for.
    found = types.ModuleType("vpt")
    exec(source.replace("from ..utility import coh_frf", ""), vars(found))
    return found.VPT


def unit(rng, n):
    e = rng.standard_normal((n, 3))
    return e / np.linalg.norm(e, axis=1)[:, None]


def frame(names, points, directions, group):
    columns = dict.fromkeys(["Quantity"], ["Acceleration"] * len(names))
    columns |= {"Name": names, "Description": names, "Grouping": group}
    for k in range(3):
        columns |= {f"Position_{k + 1}": points[:, k], f"Direction_{k + 1}": directions[:, k]}
    return pandas.DataFrame(columns)


def virtual(names):
    at = np.repeat(list(PLACES.values()), 6, axis=0)
    zeros = np.zeros((len(at), 3))
    return frame(names * len(PLACES), at, zeros, np.repeat(np.arange(1, len(PLACES) + 1), 6))


def test_transformations_are_those_of_pyfbs(vpt):
    rng = np.random.default_rng(5)
    group = np.repeat([1, 2], CHANNELS)
    labels = tuple(f"{k // SENSORS}" for k in range(2 * CHANNELS))
    X = np.repeat(0.1 * rng.standard_normal((2 * CHANNELS // SENSORS, 3)), SENSORS, axis=0)
    channels = ChannelTable(labels, labels, X, unit(rng, 2 * CHANNELS))
    struck = tuple(f"h{k}" for k in range(2 * HITS))
    hits = HitTable(struck, 0.1 * rng.standard_normal((2 * HITS, 3)), unit(rng, 2 * HITS))
    points = {
        name: VirtualPoint(
            at=tuple(at),
            channels=tuple(dict.fromkeys(labels[k * CHANNELS : (k + 1) * CHANNELS])),
            hits=struck[k * HITS : (k + 1) * HITS],
        )
        for k, (name, at) in enumerate(PLACES.items())
    }
    own = coordinates_of(points, channels, hits, np.zeros(3))
    theirs = vpt(
        frame(labels, channels.points, channels.directions, group),
        frame(struck, hits.points, hits.directions, np.repeat([1, 2], HITS)),
        virtual(["ux", "uy", "uz", "rx", "ry", "rz"]),
        virtual(["fx", "fy", "fz", "mx", "my", "mz"]),
    )
    for found, expected in (
        (np.linalg.pinv(own.outputs), theirs.tu),
        (np.linalg.pinv(own.inputs).T, theirs.tf),
    ):
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
