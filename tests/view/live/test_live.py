"""The page that follows a run: what it is told, to whom it is told, and how it looks."""

import base64
import json
import re
import subprocess
import sys
import time
from contextlib import contextmanager
from http.client import HTTPConnection
from pathlib import Path
from socket import create_connection
from urllib.parse import urlsplit

import numpy as np
import pytest
from browser import SOFTWARE_WEBGL, browser, executable
from duhamel import preprocess, solver, superelement
from duhamel.results import RecoveryError, Results
from duhamel.results.excerpt import Excerpt
from duhamel.results.file import FileSource
from duhamel.view.curve import Curve
from duhamel.view.live import watched_run
from duhamel.view.live.follower import RunFollower, plots_and_validity, told
from duhamel.view.live.server import watched
from duhamel.view.report.plots import Plot, drawing
from scipy.spatial.transform import Rotation

from ..report.conftest import EVIL, MODEL

ROOT = Path(__file__).parents[3]
LENGTH = 0.5
"""of the beam [m]"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("live")
    meshes = ROOT / "meshes/beam"
    text = (meshes / "beam.toml").read_text().replace("beam.msh", str(meshes / "beam.msh"))
    (folder / "beam.toml").write_text(f"{text}\n[recovery]\n")
    body = preprocess.read_body(folder / "beam.toml")
    superelement.write(folder / "beam.h5", preprocess.build(body))
    for name, t_end in (("short", 0.06), ("long", 3000.0)):
        text = MODEL.replace("t_end = 0.03", f"t_end = {t_end}")
        (folder / f"{name}.toml").write_text(text)
    solver.simulate(solver.read_model(folder / "short.toml"), output=folder / "short.h5")
    return folder


@pytest.fixture
def results(folder):
    return Results.read(folder / "short.h5")


class Held:
    """A control whose run does not exist, and its orders."""

    def __init__(self, place):
        self.place, self.held, self.orders = place, False, []

    def hold(self):
        self.held = True
        self.orders.append("hold")

    def go_on(self):
        self.held = False
        self.orders.append("go on")

    def stop(self):
        self.orders.append("stop")


@pytest.fixture
def served(folder, monkeypatch):
    control, told = Held(folder / "short.h5"), []
    with watched(control, folder / "short.h5", "a <i>title", 0.06, told.append) as watch:
        yield watch, control, urlsplit(told[0])
        monkeypatch.setattr(watched_run, "SECONDS_UNSEEN", -watched_run.SECONDS_TO_LOAD)


def answer(address, path, method="GET", **headers):
    connection = HTTPConnection(address.hostname, address.port, timeout=30)
    connection.request(method, path, headers={"Host": address.netloc, **headers})
    response = connection.getresponse()
    body = response.read()
    connection.close()
    return response, body


def test_an_excerpt_has_the_first_row_and_the_later_ones(folder, results):
    excerpt = Results(Excerpt(FileSource(folder / "short.h5"), 400, 500))
    rows = np.r_[0, 400:500]
    assert np.array_equal(excerpt.time, results.time[rows])
    assert np.array_equal(excerpt.body("beam").x, results.body("beam").x[rows])
    assert np.array_equal(excerpt.frame("beam.tip").u, results.frame("beam.tip").u[rows])


def test_an_excerpt_has_no_fields_that_need_the_steps_before_it(folder, results):
    assert len(results.displacement("beam", [results.time[-1]])[0]) > 2
    excerpt = Results(Excerpt(FileSource(folder / "short.h5"), 400, 500))
    with pytest.raises(RecoveryError, match="need a run from its start; this one goes on from row"):
        excerpt.displacement("beam", [excerpt.time[-1]])


def unpacked(packed):
    return np.frombuffer(base64.b64decode(packed["data"]), "<f4").reshape(packed["shape"])


def test_the_page_is_told_where_the_bodies_are(folder, results):
    follower = RunFollower()
    motion, rows = follower.motion(folder / "short.h5", 600)
    assert rows == len(results.time) == 1001
    news = json.loads(json.dumps(told(motion)))
    at = np.searchsorted(results.time, news["instants"])
    assert np.array_equal(results.time[at], news["instants"])
    assert at[0] == 600
    assert at[-1] == 1000
    hub = unpacked(news["parts"][0]["matrices"])
    assert np.allclose(hub[:, :3, 3], results.body("hub").x[at], atol=1e-6)
    middles = 0.5 * (results.body("hub").x + results.body("beam").x)[at]
    assert np.allclose(news["middles"], middles, atol=1e-12)
    beam = next(part for part in news["parts"] if part["vertices"])
    places, points = unpacked(beam["matrices"]), unpacked(beam["vertices"])
    seen = places[:, None, :3, :3] @ points[..., None]
    seen = seen[..., 0] + places[:, None, :3, 3]
    # Deformations are drawn enlarged, seen from the root.
    tip, root, turned = (
        results.frame("beam.tip"),
        results.frame("beam.root"),
        results.body("beam").R,
    )
    bent = tip.u[:, :3] - root.u[:, :3] - np.cross(root.u[:, 3:], [LENGTH, 0.0, 0.0])
    enlarged = Rotation.from_quat(np.roll(turned, -1, axis=1)).apply(bent)
    drawn = (tip.position + (news["magnification"] - 1.0) * enlarged)[at]
    assert np.linalg.norm(drawn - tip.position[at], axis=1).max() > 0.02
    # The outline of the section, 1 cm wide, is drawn about it.
    assert np.allclose(np.linalg.norm(seen - drawn[:, None], axis=2).min(axis=1), 0.005, atol=1e-4)
    assert follower.motion(folder / "short.h5", 1001) is None


def test_scales_do_not_go_back_and_forth(folder):
    follower = RunFollower()
    larger = [follower.motion(folder / "short.h5", first)[0].moving.magnification
              for first in (100, 900, 950, 100)]  # fmt: skip
    assert larger[0] >= larger[1] >= larger[2] >= larger[3]
    boxes = [follower.motion(folder / "short.h5", first)[0].box for first in (10, 900)]
    assert (boxes[1][0] <= boxes[0][0]).all()
    assert (boxes[1][1] >= boxes[0][1]).all()


def test_curves_are_those_of_the_whole_run_and_refusals_are_told(folder):
    found = plots_and_validity(folder / "short.h5", ["position:beam.tip:y", "position:nowhere"])
    assert found["plots"][0]["title"] == "beam tip, position along y"
    assert found["plots"][0]["curves"][0]["x"][-1] == 0.06
    assert len(found["refused"]) == 1
    assert "nowhere" in found["refused"][0]
    assert "energy balance error" in found["validity"]


def test_only_who_knows_the_secret_and_the_host_is_answered(served):
    _, control, address = served
    whole = address.path
    assert answer(address, whole)[0].status == 200
    for path in ("/", "/wrong/", f"{whole[:-2]}x/", f"{whole}../"):
        assert answer(address, path)[0].status in (403, 404)
    assert answer(address, whole, Host="evil.example")[0].status == 403
    assert answer(address, f"{whole}stop", "POST")[0].status == 403
    assert answer(address, f"{whole}stop", "POST", **{"X-Duhamel": "no"})[0].status == 403
    assert answer(address, f"{whole}news?first=-1")[0].status == 400
    assert answer(address, f"{whole}passwords")[0].status == 404
    assert control.orders == []


def test_what_is_no_address_is_refused_without_a_word(served, capfd):
    _, _, address = served
    with create_connection((address.hostname, address.port), timeout=30) as connection:
        connection.sendall(f"GET http://[ HTTP/1.1\r\nHost: {address.netloc}\r\n\r\n".encode())
        assert connection.recv(100).startswith(b"HTTP/1.1 403 ")
    assert capfd.readouterr().err == ""


def test_a_question_that_fails_lets_the_run_end(served, monkeypatch):
    watch, _, _ = served

    def fails(first):
        raise ZeroDivisionError

    monkeypatch.setattr(watch, "_motion", fails)
    with pytest.raises(ZeroDivisionError):
        watch.news(0)
    monkeypatch.setattr(watched_run, "SECONDS_UNSEEN", 0.0)
    started = time.monotonic()
    watch.wait_until_closed(60.0)
    assert time.monotonic() - started < 30.0


def test_titles_are_text_and_names_of_curves_are_markup():
    curves = [Curve(("force", name, ""), "N", np.arange(2.0)) for name in ("a&b", "<i>")]
    told = drawing(Plot("of a&b <i>", "N", curves), np.arange(2.0))
    assert told["title"] == "of a&b <i>"
    assert [curve["name"] for curve in told["curves"]] == ["a&amp;b", "&lt;i&gt;"]


def test_orders_are_given(served):
    watch, control, address = served
    for order in ("hold", "go-on", "stop"):
        response, _ = answer(address, address.path + order, "POST", **{"X-Duhamel": watch.token})
        assert response.status == 200
    assert control.orders == ["hold", "go on", "stop"]


def test_the_page_tells_how_the_run_is(served):
    watch, control, address = served
    news = [json.loads(answer(address, f"{address.path}news?first={n}")[1]) for n in (0, 1001)]
    assert news[0]["rows"] == 1001
    assert news[0]["status"] == "running"
    assert "motion" not in news[1]
    control.hold()
    assert watch.news(1001)["status"] == "held"
    watch.end("failed: of <b>all")
    told = watch.news(1001)
    assert told["over"]
    assert told["status"] == "failed: of <b>all"


def test_the_page_holds_no_html_of_names(served):
    _, _, address = served
    response, page = answer(address, address.path)
    assert "a &lt;i&gt;title" in page.decode()
    assert EVIL not in page.decode()
    assert "default-src 'none'" in response.headers["Content-Security-Policy"]
    assert response.headers["Cache-Control"] == "no-store"


def test_a_failure_is_passed_on_and_told(folder):
    control = Held(folder / "short.h5")
    kept = []

    def fail():
        with watched(control, folder / "short.h5", "title", 0.06, lambda address: None) as watch:
            kept.append(watch)
            raise solver.ModelError("no such thing")

    with pytest.raises(solver.ModelError, match="no such thing"):
        fail()
    assert kept[0].news(0)["status"] == "failed: no such thing"


@contextmanager
def run(folder, model):
    command = [sys.executable, "-m", "duhamel", "run", model, "--watch", "-o", f"{model}.h5"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, cwd=folder, text=True, **pipes) as process:
        try:
            yield process
        finally:
            process.kill()


def test_a_run_that_nobody_watches_ends_by_itself(folder):
    with run(folder, "short.toml") as process:
        out, err = process.communicate(timeout=120)
    assert process.returncode == 0
    assert re.search(r"watch the run: http://127\.0\.0\.1:\d+/[\w-]{32}/", err)
    assert "1000 steps" in out


FOLLOWED = """(() => {
  const { motion } = duhamel;
  const { camera, controls } = motion.scene.getWorld();
  const far = [10, 20, -5];
  const apart = () => {
    const half = Math.tan((camera.fov * Math.PI) / 360);
    const seen = camera.position.distanceTo(controls.target) * half;
    return Math.hypot(...controls.target.toArray().map((x, i) => far[i] - x)) / seen;
  };
  const before = apart();
  motion.keepInView(far);
  return [before, apart()];
})()"""
"""how far a place is from what the camera looks at, over half the height of the stage, before and
after the bodies have gone there"""


@pytest.mark.skipif(executable() is None, reason="no Chromium")
def test_a_browser_follows_holds_continues_and_stops_a_run(folder):
    with run(folder, "long.toml") as process:
        line = ""
        while (found := re.search(r"(http://\S+)\s", line)) is None:
            line += process.stderr.read(1)

        def until(page, condition, seconds=120.0):
            end = time.monotonic() + seconds
            while not page.run(condition):
                assert time.monotonic() < end, condition
                time.sleep(0.1)

        status = "document.getElementById('status').textContent"
        with browser(*SOFTWARE_WEBGL) as page:
            page.visit(found[1])
            until(page, "document.documentElement?.dataset.ready === 'yes'")
            until(page, "window.duhamel?.motion.instants.length > 40")
            assert page.run("document.querySelectorAll('.plot svg.main-svg').length") >= 3
            assert page.run("document.querySelector('#validity table') !== null")
            page.run("document.getElementById('hold').click()")
            until(page, f"{status} === 'The run is paused.'")
            apart = page.run(FOLLOWED)
            assert apart[0] > 5.0
            assert apart[1] < 0.5
            page.run("document.getElementById('quantity').value = 'position:beam.tip:y'")
            page.run("document.querySelector('#add button').click()")
            title = "document.querySelector('#plots h3').textContent"
            until(page, f"{title} === 'beam tip, position along y'")
            page.run("document.getElementById('hold').click()")
            until(page, f"{status} === 'The run takes its steps.'")
            page.run("document.getElementById('stop').click()")
            until(page, f"{status} === 'The run was stopped.'")
            assert page.errors == []
            asked = {urlsplit(request).netloc for request in page.requests}
            assert asked <= {urlsplit(found[1]).netloc, ""}
        _, err = process.communicate(timeout=60)
        assert process.returncode == 130
        assert "interrupted at t = " in err
