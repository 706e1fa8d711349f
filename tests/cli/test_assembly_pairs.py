"""Which features of a solid are proposed as interfaces, and in what order."""

from duhamel.cad import Feature
from duhamel.cad.feature import FeatureKind
from duhamel.cli.assembly_pairs import is_boss, round_features


def _round(number: int, kind: FeatureKind, radius: float, x: float = 0.0) -> Feature:
    place, along = (x, 0.0, 0.0), (0.0, 0.0, 1.0)
    return Feature(number, kind, place, place, along, radius, 0.02, 1e-3, (number,))


def test_holes_are_proposed_first_and_the_bosses_around_them_last() -> None:
    boss, hole = _round(1, "shaft", 0.01), _round(2, "hole", 0.006)
    pin, other = _round(3, "shaft", 0.005, 0.1), _round(4, "hole", 0.004, 0.2)
    features = (boss, hole, pin, other)
    assert [f.number for f in round_features(features)] == [2, 4, 3, 1]
    assert [is_boss(feature, features) for feature in features] == [True, False, False, False]
    # in a hole that is larger a shaft is a pin, as of another solid
    assert not is_boss(pin, (pin, _round(5, "hole", 0.006, 0.1)))
