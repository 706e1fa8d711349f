"""The report of a part of 20 000 nodes in a browser: it loads, draws, plays and turns."""

from dataclasses import replace

import numpy as np
import pytest
from browser import SOFTWARE_WEBGL, browser, executable
from duhamel import preprocess, solver, superelement, view
from duhamel.results import Results

from .conftest import MODEL, ROOT
from .test_browser import READY, UNTIL

RINGS, AROUND = 200, 100
RADIUS = 0.01
"""of the part [m]"""


@pytest.fixture(scope="module")
def large_file(tmp_path_factory):
    """A page of the swinging beam with a surface of 20 000 nodes, which move as its line does."""
    folder = tmp_path_factory.mktemp("large")
    meshes = ROOT / "meshes/beam"
    text = (meshes / "beam.toml").read_text().replace("beam.msh", str(meshes / "beam.msh"))
    (folder / "beam.toml").write_text(f"{text}\n[recovery]\n")
    beam = preprocess.build(preprocess.read_body(folder / "beam.toml"))
    superelement.write(
        folder / "beam.h5", replace(beam, recovery=tube(beam.recovery), outline=None)
    )
    (folder / "swing.toml").write_text(f"{MODEL}\n[output]\nmodes = true\n")
    results = folder / "swing.h5"
    solver.simulate(solver.read_model(folder / "swing.toml"), output=results)
    page = folder / "large.html"
    view.write_report(Results.read(results), page)
    return page


def tube(line):
    """A tube around a line along x, with stresses that grow with the curvature of the modes."""
    x, phi = line.points[:, 0], line.phi
    along = np.repeat(np.linspace(x.min(), x.max(), RINGS), AROUND)
    angle = np.tile(2.0 * np.pi * np.arange(AROUND) / AROUND, RINGS)
    points = np.column_stack([along, RADIUS * np.cos(angle), RADIUS * np.sin(angle)])
    nearest = np.abs(along[:, None] - x).argmin(axis=1)
    stress = np.zeros((len(points), 6, phi.shape[2]))
    stress[:, 0] = 1e9 * phi[nearest, 1] * np.cos(angle)[:, None]
    first = np.arange((RINGS - 1) * AROUND)
    beside = first - first % AROUND + (first + 1) % AROUND
    cells = np.column_stack([first, beside, beside + AROUND, first + AROUND])
    return superelement.Recovery(points, cells, phi[nearest], stress)


@pytest.mark.skipif(executable() is None, reason="no Chromium")
def test_a_page_of_twenty_thousand_nodes_draws_plays_and_turns(large_file):
    assert large_file.stat().st_size < 15e6
    with browser(*SOFTWARE_WEBGL) as page:
        page.open(large_file)
        assert page.run(READY) == "yes"
        page.run(UNTIL)
        text = page.run("document.querySelector('#motion').textContent")
        assert f" of {RINGS * AROUND + 8} points of the bodies" in text
        assert page.run("document.querySelectorAll('.plot svg.main-svg').length") >= 3
        shown = """(async () => {
          await duhamel.scene.render(true);
          return document.querySelector("#canvas canvas").toDataURL();
        })()"""
        before = page.run(shown)
        page.run("duhamel.clock.set(0.02)")
        camera = "duhamel.scene.getWorld().camera.position.toArray()"
        seen = np.array(page.run(camera))
        left, top = page.run(
            "(() => { const stage = document.getElementById('canvas');"
            "stage.scrollIntoView({behavior: 'instant', block: 'center'});"
            "const box = stage.getBoundingClientRect();"
            "return [box.left + box.width / 2, box.top + box.height / 2]; })()"
        )
        page.drag((left, top), (left + 150.0, top + 40.0))
        page.run(f"until(() => {camera}.join() !== '{','.join(map(repr, seen.tolist()))}')")
        turned = np.array(page.run(camera))
        target = np.array(page.run("duhamel.scene.getWorld().controls.target.toArray()"))
        assert np.linalg.norm(turned - seen) > 0.1 * np.linalg.norm(seen - target)
        assert np.linalg.norm(turned - target) == pytest.approx(np.linalg.norm(seen - target))
        assert page.run(shown) != before
        assert page.errors == []
