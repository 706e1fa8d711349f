"""Fields on the bodies of a run: the time and the place of the largest value, and errors."""

from types import SimpleNamespace

import numpy as np
import pytest
from duhamel import view
from duhamel.results.search import Extremes
from duhamel.results.space import Place
from duhamel.superelement import Outline
from duhamel.view.body_fields import draw_body_fields

TIME = np.linspace(0.0, 1.0, 11)
SQUARE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
WORST = {"rod": (0.7, 2, 5e6), "pin": (0.3, 1, 2e6)}
"""of each body the time, the point and the value of its largest stress"""


class Run:
    """Two flexible squares, of which the second lies ten meters away, and a rigid one."""

    time = TIME
    bodies = ("rod", "pin", "block")
    superelement_files = dict.fromkeys(("rod", "pin"))

    def outline(self, body):
        cells = np.array([[0, 1, -1]] if body == "block" else [[0, 1, 2, 3]])
        return Outline(SQUARE, cells)

    def outline_position(self, body, t):
        return SQUARE + np.array([10.0 * (body == "pin"), 0.0, 0.0])

    def outline_source(self, body):
        return "interfaces" if body == "pin" else "recovery"

    def outline_field(self, body, t, name):
        at, point, value = WORST[body]
        far = np.abs(np.asarray(t) - at)[..., None]
        return value * np.maximum(1.0 - far, 0.0) * np.where(np.arange(4) == point, 1.0, 0.5)

    def field_extremes(self, body, name, rows):
        over_time = self.outline_field(body, TIME[rows], name).max(axis=1)
        return Extremes(over_time.max(), rows.start + int(over_time.argmax()), WORST[body][1], 0, 0)

    def place(self, body, point):
        return Place(tuple(SQUARE[point] + 1.0), node=100 + point)


def texts(figure):
    heading = figure.get_suptitle()
    others = [text.get_text() for text in figure.texts]
    return [heading, *(text for text in others if text != heading)]


def test_the_worst_time_is_that_of_the_largest_value_of_all_bodies():
    figure = draw_body_fields(Run(), ["von_mises:*"], title="slider")
    title, line, *_ = texts(figure)
    assert title == "slider"
    assert line.startswith("rod at 0.7 s: 5 MPa at (2, 2, 1) m of the mesh, node 102")
    *views, bar = figure.axes
    assert bar.get_title(loc="left") == "von Mises stress [MPa]"
    assert bar.get_xlim() == pytest.approx((0.0, 5.0))
    marks = [text.get_text() for axes in views for text in axes.texts]
    assert marks.count("5 MPa") == 1


def test_a_field_at_a_time():
    figure = draw_body_fields(Run(), ["von_mises:pin"], 0.4)
    assert figure.get_suptitle() == (
        "pin at 0.4 s: 1.8 MPa at (2, 1, 1) m of the mesh, node 101; "
        "interpolated between the interfaces of pin"
    )


def test_the_worst_within_a_window():
    figure = draw_body_fields(Run(), ["von_mises:rod"], window=(0.0, 0.55))
    assert figure.get_suptitle().startswith("rod at 0.5 s: 4 MPa")


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (["stress:rod"], "stress:rod: expected a field, displacement:BODY, velocity:BODY, von"),
        (["von_mises"], "von_mises: expected a field"),
        (["von_mises:block"], "von_mises:block: no flexible body 'block'; there are: rod, pin"),
        (["velocity:crank"], "velocity:crank: no body 'crank'; there are: rod, pin, block"),
        (["von_mises:rod", "velocity:rod"], "expected one kind of field in a picture, found von"),
    ],
)
def test_a_field_that_is_not_there(fields, message):
    with pytest.raises(view.QuantityError, match=message):
        draw_body_fields(Run(), fields, 0.4)


def test_lines_have_no_surface():
    run = SimpleNamespace(
        outline=Run().outline, bodies=("block",), time=TIME, superelement_files={}
    )
    with pytest.raises(view.QuantityError, match="velocity:block: the body has no surface, lines"):
        draw_body_fields(run, ["velocity:block"], 0.4)
