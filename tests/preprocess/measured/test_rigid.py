"""Mass, center and inertia of a tested part: by its responses, or of a superelement."""

import numpy as np
import pytest
from duhamel import preprocess, superelement
from duhamel.cli import app
from duhamel.preprocess import BodyError, MeasurementError
from duhamel.preprocess.measured.part_test import read_part_test
from typer.testing import CliRunner

from .hammer_bench import ALL, SENSORS, Errors, measure, replace, truth

BY_RESPONSES = 'from = "frf"'


def rigid_of(bench, folder, rigid=BY_RESPONSES):
    return read_part_test(preprocess.read_body(bench.write(folder, rigid=rigid))).rigid


def errors_of(rigid):
    """Of the mass, of the center [m], and of the inertia over its largest moment."""
    part = truth().element
    return (
        abs(rigid.mass / part.mass - 1.0),
        np.linalg.norm(rigid.center - part.center),
        np.abs(rigid.inertia - part.J_rot).max() / part.J_rot.max(),
    )


@pytest.mark.parametrize(
    ("errors", "limits"),
    [
        (Errors(), (2e-3, 1e-4, 2e-3)),
        (Errors(noise=0.05, floor=1e-2), (2e-3, 2e-4, 3e-3)),
        *((replace(ALL, seed=seed), (0.015, 1e-3, 0.03)) for seed in range(1, 6)),
        (replace(ALL, mass=0.008), (0.015, 1e-3, 0.03)),
        (replace(ALL, window=9.2), (0.015, 1e-3, 0.03)),
    ],
)
def test_the_mass_line_has_the_mass_of_the_bare_part(errors, limits, tmp_path):
    found = errors_of(rigid_of(measure(errors), tmp_path))
    assert all(error < limit for error, limit in zip(found, limits, strict=True))


def test_a_weighed_mass_scales_the_inertia(tmp_path):
    mass = truth().element.mass
    by_responses = rigid_of(measure(ALL), tmp_path)
    scaled = rigid_of(measure(ALL), tmp_path, f"{BY_RESPONSES}\nmass = {mass}")
    assert scaled.mass == mass
    np.testing.assert_allclose(scaled.center, by_responses.center)
    factor = mass / by_responses.mass
    np.testing.assert_allclose(scaled.inertia, by_responses.inertia * factor)
    assert scaled.told.endswith("by the mass line, scaled to the given mass")


def test_a_superelement_gives_the_mass_of_its_part(tmp_path):
    part = truth().element
    superelement.write(part, tmp_path / "cad.h5")
    path = measure(ALL).write(tmp_path, rigid='from = "cad.h5"')
    body = preprocess.read_body(path)
    assert body.files[-1] == tmp_path / "cad.h5"
    assert body.text == path.read_text()
    rigid = read_part_test(body).rigid
    assert rigid.mass == part.mass
    np.testing.assert_array_equal(rigid.center, part.center)
    np.testing.assert_array_equal(rigid.inertia, part.J_rot)


def test_what_was_found_is_printed_and_kept(tmp_path):
    bench = measure(ALL)
    bench = replace(bench, f=bench.f[::4], H=bench.H[::4])
    path = bench.write(tmp_path, rigid=BY_RESPONSES)
    result = CliRunner().invoke(app, ["preprocess", str(path)])
    assert result.exit_code == 0, result.output
    element = superelement.read(tmp_path / "angle.h5")
    told = f"{element.mass:.4g} kg, center and inertia by the mass line"
    assert element.provenance.method.endswith(f"; {told}")
    assert f"; {told}" in result.output
    assert errors_of_element(element) < 0.02


def errors_of_element(element):
    return abs(element.mass / truth().element.mass - 1.0)


@pytest.mark.parametrize(
    ("rigid", "message"),
    [
        ("mass = 2.0", "measured.rigid: expected mass, center and inertia, or from, no center"),
        (f"{BY_RESPONSES}\ncenter = [0.1, 0.0, 0.0]", "from: expected to be alone.*found center"),
        ('from = "cad.h5"\nmass = 2.0', "from: expected to be alone.*found mass too"),
        ('from = "cad.h5"', "cad.h5: no such file"),
        ('from = "channels.csv"', "channels.csv: "),
        ("from = 3", 'expected "frf" or the path of a superelement, found 3'),
    ],
)
def test_contradictory_sources_are_refused(rigid, message, tmp_path):
    with pytest.raises((BodyError, MeasurementError), match=message):
        rigid_of(measure(ALL), tmp_path, rigid)


def test_hits_that_do_not_turn_the_part_do_not_tell_its_inertia(tmp_path):
    path = measure(ALL).write(tmp_path, rigid=BY_RESPONSES)
    # All hits along x, none of which turns the part about that axis.
    lines = (tmp_path / "hits.csv").read_text().splitlines()
    along = [",".join([*line.split(",")[:4], "1,0,0"]) for line in lines[1:]]
    (tmp_path / "hits.csv").write_text("\n".join([lines[0], *along]))
    with pytest.raises(MeasurementError, match=r"hits.csv: .*the wrenches of its hits do not tell"):
        read_part_test(preprocess.read_body(path))


def test_a_band_without_a_mass_line_does_not_tell_the_mass(tmp_path):
    path = measure(ALL).write(tmp_path, rigid=BY_RESPONSES)
    path.write_text(path.read_text().replace("band = [20, 5000]", "band = [160, 5000]"))
    with pytest.raises(MeasurementError, match="too few lines below the first resonance, at 18"):
        read_part_test(preprocess.read_body(path))


def test_responses_of_no_body_are_refused(tmp_path):
    bench = measure(Errors())
    signs = np.repeat(np.where(np.arange(len(SENSORS)) % 2, 1.0, -1.0), 3)
    with pytest.raises(MeasurementError, match=r"principal moments .* which no body has"):
        rigid_of(replace(bench, H=bench.H * signs[:, None]), tmp_path)
