"""The drawing of the packages is that of the imports, and none of its words is out of date."""

import xml.etree.ElementTree as ET
from graphlib import TopologicalSorter
from itertools import pairwise

import pytest
from draw_architecture import (
    ABOUT,
    DRAWING,
    Box,
    drawing,
    layers,
    place_rooms,
    reduced,
    room_arrows,
)
from import_order import PACKAGES, ROOMS

WALKS = ("preprocess", "solver")


def test_the_drawing_is_up_to_date():
    """`python tools/draw_architecture.py` draws it again."""
    assert DRAWING.read_text(encoding="utf-8") == drawing()


def test_every_package_and_room_has_its_words():
    rooms = {f"{walk}/{room}" for walk in WALKS for room in ROOMS[walk] if "__" not in room}
    assert set(ABOUT) == set(PACKAGES) | rooms
    texts = {node.text for node in ET.fromstring(drawing()).iter() if node.text}
    assert {name.rpartition("/")[2] for name in ABOUT} <= texts


@pytest.mark.parametrize("walk", WALKS)
def test_rooms_stand_above_what_they_import_and_apart(walk):
    made = layers(walk)
    frame = Box(walk, 0.0, 0.0, made.width() + 36.0, 900.0)
    boxes = place_rooms(made, frame, 90.0)
    for a, b in room_arrows(walk):
        assert boxes[a].bottom < boxes[b].y
    for level in made.levels:
        for left, right in pairwise(level):
            assert boxes[left].right < boxes[right].x
        assert boxes[level[0]].x >= 0.0
        assert boxes[level[-1]].right <= frame.w


@pytest.mark.parametrize("walk", WALKS)
def test_what_is_left_out_follows_from_what_is_drawn(walk):
    drawn = reduced(room_arrows(walk))
    below = {}
    for a, b in drawn:
        below.setdefault(a, set()).add(b)
    reached = {}
    for room in TopologicalSorter(below).static_order():
        others = below.get(room, set())
        reached[room] = others.union(*(reached[other] for other in others))
    assert all(b in reached[a] for a, b in room_arrows(walk))
    assert len(drawn) < len(room_arrows(walk))


def test_an_arrow_that_others_imply_is_left_out():
    assert reduced([("a", "b"), ("b", "c"), ("a", "c")]) == [("a", "b"), ("b", "c")]
    circle = [("a", "b"), ("b", "a"), ("b", "c")]
    assert reduced(circle) == circle
