"""The page of a report in a browser: headless Chromium, without a network."""

import numpy as np
import pytest
from browser import NO_WEBGL, SOFTWARE_WEBGL, browser, executable
from duhamel.view.report import plots

from .conftest import EVIL

pytestmark = pytest.mark.skipif(executable() is None, reason="no Chromium")

READY = """new Promise((resolve) => {
  const look = () => {
    const told = document.documentElement?.dataset.ready;
    if (told) resolve(told); else setTimeout(look, 50);
  };
  look();
})"""
UNTIL = """window.until = async (holds) => {
  const end = performance.now() + 30000;
  while (!(await holds()) && performance.now() < end) {
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
};"""
"""waits until something holds, or too long"""


@pytest.fixture(scope="module")
def opened(page_file):
    with browser(*SOFTWARE_WEBGL) as page:
        page.open(page_file)
        assert page.run(READY) == "yes"
        page.run(UNTIL)
        yield page


def test_the_page_loads_without_an_error(opened):
    assert opened.errors == []


def test_no_request_leaves(opened):
    assert opened.requests
    outside = [r for r in opened.requests if not r.startswith(("file://", "data:", "blob:"))]
    assert outside == []


def test_nothing_runs_that_names_and_texts_hold(opened):
    assert opened.run("document.querySelectorAll('script').length") == 6
    assert opened.run("document.querySelectorAll('main b').length") == 0
    assert opened.run("document.querySelectorAll('img').length") == 1


def test_all_plots_are_drawn(opened, results):
    wanted = sum(len(group) for _, group in plots.plots(results))
    assert opened.run("document.querySelectorAll('.plot svg.main-svg').length") >= wanted
    lines = "document.querySelectorAll('.plot path.js-line').length"
    assert opened.run(lines) >= wanted - 1


def test_no_button_sends_a_plot_away(opened):
    titles = opened.run(
        "[...document.querySelectorAll('.modebar-btn')].map((b) => b.dataset.title).join()"
    )
    assert "Zoom" in titles
    assert "Share" not in titles
    assert "Cloud" not in titles


def test_names_beside_plots_are_those_of_the_model(opened):
    texts = opened.run("[...document.querySelectorAll('.legendtext')].map((t) => t.textContent)")
    assert EVIL in texts


def test_bodies_are_drawn_and_move_with_the_time(opened):
    assert opened.run("document.querySelector('#canvas canvas').width") > 500
    seen = opened.run(
        """(async () => {
          const { scene, clock } = duhamel;
          const look = async (t) => {
            clock.set(t);
            await scene.render(true);
            const gl = document.querySelector("#canvas canvas");
            return [gl.toDataURL(), document.querySelector(".cursor").style.left];
          };
          const names = document.querySelector("#names-of-marks span");
          const first = await look(0);
          let last = first;
          await until(async () => {
            last = await look(0.03);
            return first[0] !== last[0] && first[1] !== last[1];
          });
          return [first[0] !== last[0], first[1] !== last[1], names.textContent];
        })()"""
    )
    assert seen[:2] == [True, True]
    assert seen[2].startswith(EVIL)


def test_bodies_stand_where_the_results_say(opened, results):
    for t in (0.0004, 0.0131, 0.03):
        row = int(np.searchsorted(results.time, t))
        x = results.body("beam").x[row].tolist()
        off = opened.run(
            f"""(async () => {{
              let off = Infinity;
              duhamel.clock.set({t});
              await until(() => {{
                const drawn = duhamel.scene.getWorld().K3DObjects.children;
                const places = drawn.map((c) => [...c.matrixWorld.elements].slice(12, 15));
                const distance = (at) => Math.hypot(...at.map((x, i) => x - {x}[i]));
                off = Math.min(...places.map(distance));
                return off < 1e-4;
              }});
              return off;
            }})()"""
        )
        assert off < 1e-4


def test_the_button_plays_and_stops(opened):
    opened.run("duhamel.clock.set(0); document.getElementById('play').click()")
    opened.run(
        """new Promise((resolve) => {
          const look = () => (duhamel.clock.t > 0 ? resolve() : setTimeout(look, 20));
          look();
        })"""
    )
    opened.run("document.getElementById('play').click()")
    reached = opened.run("duhamel.clock.t")
    assert 0.0 < reached <= 0.03
    assert opened.run("Number(document.getElementById('when').value)") == pytest.approx(
        reached, abs=1e-5
    )


def test_zooming_into_a_plot_zooms_into_all(opened):
    ranges = opened.run(
        """(async () => {
          const all = [...document.querySelectorAll(".plot .drawn")];
          await Plotly.relayout(all[0], { "xaxis.range[0]": 0.01, "xaxis.range[1]": 0.02 });
          const ranges = () => all.map((plot) => plot.layout.xaxis.range.join());
          await until(() => ranges().every((range) => range === "0.01,0.02"));
          return ranges();
        })()"""
    )
    assert set(ranges) == {"0.01,0.02"}


def test_without_webgl_a_picture_stands_in_place_of_the_animation(page_file):
    with browser(*NO_WEBGL) as page:
        page.open(page_file)
        assert page.run(READY) == "yes"
        assert "no WebGL" in page.run("document.getElementById('stage').textContent")
        assert page.run("document.getElementById('still').offsetHeight") > 100
        assert page.run("document.getElementById('bar').offsetHeight") > 100
        assert page.errors == []
