"""The law of a contact, identified from a test with noise.

    python examples/contact_law.py [FOLDER] [SEEDS]

A ball hits a floor (examples/contact_law.toml) whose stiffness, exponent and restitution are to be
found. The test is simulated with steps five times as short as the fit takes, and noise of 2 % of
its largest acceleration. The fit begins far off and tells the standard deviation of
what it found. Of many tests with other noise the truth must lie within 1.96 deviations in 95 of
100. Writes a picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import solver, view
from duhamel.study import ModelFit
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
MODEL = ROOT / "examples/contact_law.toml"
QUANTITY = "acceleration:ball:z"
FINER = 5
"""steps of the test in one of the fit"""
NOISE = 0.02
"""over the largest acceleration"""
SAMPLE = 4e-6
"""[s]"""
WITHIN = 1.96
"""standard deviations, within which 95 of 100 normal numbers lie"""
TRUTH = {"stiffness": 2e8, "exponent": 1.5, "restitution": 0.7}
PARAMETERS = {
    "stiffness": du.Parameter(
        "contacts.floor.stiffness", bounds=(1e6, 1e11), start=5e8, logarithmic=True
    ),
    "exponent": du.Parameter("contacts.floor.exponent", bounds=(1.0, 2.5), start=1.6),
    "restitution": du.Parameter("contacts.floor.restitution", bounds=(0.1, 1.0), start=0.5),
}


@dataclass(frozen=True, eq=False)
class Test:
    """time (n,) [s]; acceleration (n,) [m/s^2] without noise; sigma of the noise to come."""

    time: Array
    acceleration: Array

    @property
    def sigma(self) -> float:
        return NOISE * float(np.abs(self.acceleration).max())

    def measured(self, seed: int) -> Array:
        """With noise."""
        noise = np.random.default_rng(seed).normal(scale=self.sigma, size=len(self.time))
        return self.acceleration + noise


def main(folder: Path, seeds: int = 3) -> tuple[ModelFit, Array]:
    folder.mkdir(parents=True, exist_ok=True)
    test = simulated_test()
    fits = [fitted(test, seed) for seed in range(seeds)]
    view.save(picture(fits[0], test), folder / "contact-law.png")
    assert all(fit.converged for fit in fits)
    return fits[0], np.array([errors(fit) for fit in fits])


def simulated_test() -> Test:
    model = solver.read_model(MODEL)
    run = solver.simulate(model.with_settings(step=model.settings.step / FINER))
    time = np.arange(0.0, model.settings.t_end, SAMPLE)
    exact = run.body("ball").acceleration[:, 2]
    return Test(time, np.interp(time, run.time, exact))


def fitted(test: Test, seed: int) -> ModelFit:
    series = {QUANTITY: (test.time, test.measured(seed))}
    return du.Mechanism.read(MODEL).fit(PARAMETERS, series, sigma=test.sigma)


def errors(fit: ModelFit) -> Array:
    """Of each parameter, in standard deviations."""
    return np.array([(one.value - TRUTH[one.name]) / one.deviation for one in fit.parameters])


def picture(fit: ModelFit, test: Test) -> Figure:
    (series,), (model,) = fit.series, fit.fitted
    label = "acceleration of a ball that hits a floor"
    shown = view.SeriesFit(label, test.time, series.values, model, "m/s²", series.sigma)
    return view.draw_series_fit([shown], "A contact law from a test")


def report(fit: ModelFit, found: Array) -> None:
    for one in fit.parameters:
        print(f"{one.name:12}{one.value:12.5g} +- {one.deviation:.2g}, true {TRUTH[one.name]:g}")
    for note in fit.notes:
        print(note)
    for name, column in zip(TRUTH, found.T, strict=True):
        within = int((np.abs(column) < WITHIN).sum())
        print(f"{name:12}{within} of {len(column)} within {WITHIN} deviations")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target, int(sys.argv[2]) if len(sys.argv) > 2 else 3))
    print(f"picture: {target}")
