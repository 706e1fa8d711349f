"""The report of a dry run on a part that was tested, and the picture of its fit."""

import base64
import io
from collections.abc import Iterator
from html import escape

import numpy as np
from rich.console import Console
from rich.table import Table

from ..files.arrays import Array
from ..preprocess.measured.matching import mac
from ..preprocess.measured.part import IdentifiedPart
from ..preprocess.measured.rigidity import rigid_up_to
from ..view import FitOfTest, draw_fit
from .tables import Row, sectioned

WORST_SHOWN = 5
PAGE_LETTERS, PAGE_DOTS_PER_INCH = 100, 130
PAGE_OF_TEST = """<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><title>Test of {name}</title>
<style>{stylesheet} body {{ font-family: sans-serif; }} img {{ max-width: 100%; }}</style></head>
<body><h1>Test of {name}</h1>
<img src="data:image/png;base64,{picture}" alt="responses, misfits, modes and places">
<pre>{code}</pre>
</body>
</html>
"""
"""with the fields of `Console.export_html`, braces doubled for it"""


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
        mac=mac(*[(measured.outputs @ fit.shapes).T] * 2),
        misfits=_each(part),
        sensors=test.channels.sensors,
        hits=dict(zip(hits.labels, hits.points, strict=True)),
        interfaces={name: np.array(point.at) for name, point in body.interfaces.items()},
        directions=dict(zip(hits.labels, hits.directions, strict=True)),
    )


def page_of_test(part: IdentifiedPart, report_of_test: Table) -> str:
    """A page of HTML, for any browser: the picture, and the report below it."""
    image = io.BytesIO()
    draw_fit(picture(part)).savefig(image, format="png", dpi=PAGE_DOTS_PER_INCH)
    # Not to the terminal, which has it already.
    console = Console(record=True, file=io.StringIO(), width=PAGE_LETTERS)
    console.print(report_of_test)
    name = escape(part.test.body.name)
    return console.export_html(
        code_format=PAGE_OF_TEST.replace("{name}", name).replace(
            "{picture}", base64.b64encode(image.getvalue()).decode("ascii")
        )
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
    limits = rigid_up_to(part.measurement, test.coordinates.interfaces)
    for name, rows in test.coordinates.interfaces.items():
        limit = limits[name]
        where = "in the band" if limit > f[-1] else f"up to {limit:.0f} Hz"
        yield f"  {name}", f"{rows.stop - rows.start} dofs, a rigid piece {where}"
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
