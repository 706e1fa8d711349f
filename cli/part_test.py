"""The report of a dry run on a part that was tested, and the picture of its fit."""

from collections.abc import Iterator

import numpy as np
from rich.table import Table

from ..files.arrays import Array
from ..preprocess.measured.part import IdentifiedPart
from ..view import FitOfTest
from .tables import Row, sectioned

WORST_SHOWN = 5


def report(part: IdentifiedPart) -> Table:
    """Test, doubts, modes and misfits, a section each."""
    return sectioned(
        part.test.body.name, (_test(part), _modes(part), _misfits(part), _doubts(part))
    )


def picture(part: IdentifiedPart) -> FitOfTest:
    """Measured and fitted responses, misfits, and where sensors and hits are."""
    test, measured, fit = part.test, part.measurement, part.found.fit
    fitted = fit.responses(measured) + measured.H - measured.elastic
    body, hits = test.body, test.hits
    return FitOfTest(
        frequencies=test.data.f,
        measured=1.0 / measured.weights,
        fitted=np.sqrt(np.mean(np.abs(fitted) ** 2, axis=(1, 2))),
        modes=fit.frequencies,
        misfits=_each(part),
        sensors=test.channels.sensors,
        hits=dict(zip(hits.labels, hits.points, strict=True)),
        interfaces={name: np.array(point.at) for name, point in body.interfaces.items()},
        directions=dict(zip(hits.labels, hits.directions, strict=True)),
    )


def _each(part: IdentifiedPart) -> dict[str, float]:
    """The misfit of each channel and of each hit, against their own responses."""
    measured = part.measurement
    errors = part.found.fit.misfits(measured) ** 2
    sizes = np.abs(measured.H * measured.weights[:, None, None]) ** 2

    def over(axes: tuple[int, int]) -> Array:
        return np.asarray(np.sqrt(errors.sum(axis=axes) / sizes.sum(axis=axes)))

    names = (*part.test.channels.names, *part.test.hits.labels)
    values = np.concatenate([over((0, 2)), over((0, 1))])
    return dict(zip(names, values.tolist(), strict=True))


def _test(part: IdentifiedPart) -> Iterator[Row]:
    f, test = part.test.data.f, part.test
    yield "responses", f"{len(test.channels.names)} channels by {len(test.hits.labels)} hits"
    yield "lines", f"{len(f)} from {f[0]:g} to {f[-1]:g} Hz"
    for name, rows in test.coordinates.interfaces.items():
        yield f"  {name}", f"{rows.stop - rows.start} dofs"
    if test.rigid.told:
        yield "rigid motion", test.rigid.told
    if test.coordinates.sensors:
        yield "sensors", ", ".join(test.coordinates.sensors)


def _modes(part: IdentifiedPart) -> Iterator[Row]:
    fit = part.found.fit
    yield "modes", f"{len(fit.omega)}, frequencies and damping ratios, part out of phase"
    for frequency, zeta, share in zip(fit.frequencies, fit.zeta, part.phases.shares, strict=True):
        yield f"  {frequency:.5g} Hz", f"{100.0 * zeta:.3g} %, {100.0 * share:.2g} %"


def _misfits(part: IdentifiedPart) -> Iterator[Row]:
    yield "misfit", f"{part.found.fit.misfit:.3g} of the responses; the worst:"
    worst = sorted(_each(part).items(), key=lambda pair: -pair[1])
    for name, value in worst[:WORST_SHOWN]:
        yield f"  {name}", f"{value:.2g}"


def _doubts(part: IdentifiedPart) -> Iterator[Row]:
    yield "doubts", "none" if not part.doubts else f"{len(part.doubts)}"
    for doubt in part.doubts:
        yield "", doubt
