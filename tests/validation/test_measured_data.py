"""Real measurements, of the wheel of vibrationtesting on PyPI, which is fetched at each run.

Their license is not stated: they are read here, and never kept. mckiddat: receptances of three
sensors by one hit at the first of them, of a part that is held. case1, case2: one response each,
with its coherence, in a noise that leaves little of it.
"""

import io

import numpy as np
import pytest
import scipy.io
from duhamel import preprocess
from duhamel.preprocess import MeasurementError
from duhamel.preprocess.identification.identify import identify
from duhamel.preprocess.identification.responses import Measurement
from duhamel.preprocess.measured.part_test import read_part_test

from .fetched_wheel import fetched_wheel

pytestmark = pytest.mark.validation

REQUIREMENT = (
    "vibrationtesting==0.24 "
    "--hash=sha256:670dcf5286bac7b67ec0fa181864c1efc8625147442cfaf49bfe161678ae2f89"
)
"""exact file, so that nothing else is ever read as data"""


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    """Reads the arrays of a name in the wheel."""
    with fetched_wheel(tmp_path_factory.mktemp("wheel"), REQUIREMENT) as wheel:

        def arrays(name):
            file = io.BytesIO(wheel.read(f"vibrationtesting/data/{name}.mat"))
            return scipy.io.loadmat(file)

        yield arrays


def resonance(f, receptance, low, high):
    """That of the largest response between two frequencies, of three lines around it.

    Near a mode 1 / |R|^2 is quadratic in f^2, which is least at f_0^2 (1 - 2 zeta^2).
    """
    within = np.flatnonzero((f > low) & (f < high))
    peak = within[np.abs(receptance[within]).argmax()]
    lines = slice(peak - 1, peak + 2)
    # About the peak: the squares of three neighbors differ by little.
    x = f[lines] ** 2 - f[peak] ** 2
    a, b, _ = np.polyfit(x, 1.0 / np.abs(receptance[lines]) ** 2, 2)
    return np.sqrt(f[peak] ** 2 - 0.5 * b / a)


def test_measured_receptances_give_the_modes_of_their_peaks(read):
    found = read("mckiddat")
    f, receptance = found["Freq"].ravel().astype(float), found["Recep"].astype(complex)
    s = 2j * np.pi * f
    # It is held, so that there is no rigid motion to take away.
    own = np.eye(3)
    H = (s[:, None] ** 2 * receptance)[:, :, None]
    fit = identify(Measurement(s, H, own, own[:1], np.zeros((3, 6)), np.eye(6))).fit
    assert fit.misfit < 0.02
    # One hit cannot tell spurious modes from true ones: those of the peaks are far above these.
    heights = np.linalg.norm(fit.shapes, axis=0) * np.abs(fit.shapes[0]) / (2.0 * fit.zeta)
    first, *further = np.argsort(-heights)
    highest = np.sort([first, *further[:2]])
    assert heights[further[2]] < 0.1 * heights[first]
    expected = [
        resonance(f, receptance[:, 0], *between)
        for between in ((0.05, 0.15), (0.15, 0.25), (0.25, 0.39))
    ]
    np.testing.assert_allclose(fit.frequencies[highest], expected, rtol=1e-3)
    np.testing.assert_allclose(fit.frequencies[highest], [0.1029, 0.1962, 0.3247], rtol=1e-3)
    np.testing.assert_allclose(fit.zeta[highest], [0.0027, 0.0032, 0.0078], rtol=0.05)


BODY = """
name = "part"
measured.frf = "part.npz"
measured.channels = "channels.csv"
measured.hits = "hits.csv"
measured.band = [5, 1600]
measured.rigid = {mass = 1.0, center = [0, 0, 0], inertia = [1, 1, 1]}
interfaces.tip = {at = [0, 0, 0], channels = ["1"], hits = ["11"], rotations = false}
impulse = {step = 1e-4, steps = 10}
"""


def written(folder, arrays, low):
    """A body of one channel and one hit, with the lines of a file from a frequency [Hz] on."""
    names = {"f": "Freq_domain", "H": "Hf_chan_2", "coherence": "Hf_coh_chan_2"}
    values = {key: arrays[name].ravel() for key, name in names.items()}
    used = values["f"] >= low
    paired = {key: values[key][used, None, None] for key in ("H", "coherence")}
    np.savez(folder / "part.npz", f=values["f"][used], quantity="accelerance", **paired)
    for table, label in (("channels", "1"), ("hits", "11")):
        (folder / f"{table}.csv").write_text(f"label, x, y, z, axis\n{label}, 0, 0, 0, z\n")
    (folder / "part.toml").write_text(BODY)
    return preprocess.read_body(folder / "part.toml")


@pytest.mark.parametrize("name", ["case1", "case2"])
def test_a_response_that_is_mostly_noise_is_refused(name, read, tmp_path):
    body = written(tmp_path, read(name), 20.0)
    said = r"part\.npz: coherence: expected a median of 0\.5 or more in the band, found 0\.31"
    with pytest.raises(MeasurementError, match=said):
        read_part_test(body)


def test_an_analyzer_with_coherences_above_one_is_refused(read, tmp_path):
    body = written(tmp_path, read("case1"), 0.0)
    with pytest.raises(MeasurementError, match=r"from 0 to 1, found 1\.25 at 0 Hz"):
        read_part_test(body)
