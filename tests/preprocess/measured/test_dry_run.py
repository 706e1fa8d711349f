"""The dry run of a tested part: its report, and the picture of its fit."""

import numpy as np
from duhamel import preprocess, view
from duhamel.cli import app
from duhamel.cli.part_test import picture
from duhamel.preprocess.measured.part import identified
from duhamel.preprocess.progress import Stages
from matplotlib.image import imread
from typer.testing import CliRunner

from .hammer_bench import ALL, HITS, SENSORS, measure, replace, with_fault


def fewer(bench):
    return replace(bench, f=bench.f[::4], H=bench.H[::4])


def test_a_dry_run_reports_modes_misfits_and_doubts(tmp_path):
    bench = with_fault(fewer(measure(ALL)), lambda H: H.__imul__(np.where(ONE_CHANNEL, -1.0, 1.0)))
    path = bench.write(tmp_path)
    result = CliRunner().invoke(app, ["preprocess", str(path), "--dry-run"])
    assert result.exit_code == 0, result.output
    for words in (
        "24 channels by 20 hits",
        "186.3",
        "part out of phase",
        "sensor 8: channel z is reversed",
        "8:z",
    ):
        assert words in result.output
    assert imread(path.with_suffix(".png")).shape[2] == 4
    assert not path.with_suffix(".h5").exists()


ONE_CHANNEL = (np.arange(24) == 23)[:, None]


def test_the_picture_has_the_responses_and_the_misfit_of_each_channel_and_hit(tmp_path):
    path = fewer(measure(ALL)).write(tmp_path)
    part = identified(preprocess.read_body(path), Stages())
    shown = picture(part)
    np.testing.assert_allclose(shown.fitted, shown.measured, rtol=0.1)
    assert len(shown.misfits) == 3 * len(SENSORS) + len(HITS)
    assert 0.02 < min(shown.misfits.values()) < part.found.fit.misfit < max(shown.misfits.values())
    figure = view.draw_fit(shown)
    responses, bars, alike, places, _ = figure.axes
    np.testing.assert_allclose(np.diag(alike.images[0].get_array()), 1.0, rtol=1e-9)
    assert len(alike.get_xticklabels()) == len(shown.modes)
    assert len(bars.patches) == len(shown.misfits)
    assert {text.get_text() for text in places.texts} >= {*SENSORS, *HITS, "foot", "top"}
    assert len(responses.lines) == 2 + len(shown.modes)


def test_a_page_has_the_picture_and_the_report(tmp_path):
    path = fewer(measure(ALL)).write(tmp_path)
    text = path.read_text().replace('name = "angle"', 'name = "a <b> & c"')
    path.write_text(text)
    page = tmp_path / "page.html"
    result = CliRunner().invoke(app, ["preprocess", str(path), "--dry-run", "-o", str(page)])
    assert result.exit_code == 0, result.output
    html = page.read_text()
    assert "<h1>Test of a &lt;b&gt; &amp; c</h1>" in html
    assert "24 channels by 20 hits" in html
    assert "data:image/png;base64,iVBOR" in html
